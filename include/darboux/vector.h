/// \file vector.h
/// The small vector types of the library, over any scalar, and their conversion to Eigen.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

// The library's own structs hold Eigen's: they must be laid out, and freed, as it was compiled.
#if EIGEN_MAX_ALIGN_BYTES != 16 || EIGEN_MAX_STATIC_ALIGN_BYTES != 16 || !EIGEN_MALLOC_ALREADY_ALIGNED
#error "expected -DEIGEN_MAX_ALIGN_BYTES=16 -DEIGEN_MALLOC_ALREADY_ALIGNED=1, no EIGEN_DONT_VECTORIZE"
#endif

#include <darboux/scalar.h>

namespace darboux {

/// A point of the uv square.
template <class S>
struct Vec2 {
  S x{}, y{};
  friend bool operator==(const Vec2&, const Vec2&) = default;
  friend constexpr Vec2 operator+(const Vec2& a, const Vec2& b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(const Vec2& a, const Vec2& b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator*(const S& k, const Vec2& a) { return {k * a.x, k * a.y}; }
  friend constexpr Vec2 operator/(const Vec2& a, const S& k) { return {a.x / k, a.y / k}; }
};

/// A point or direction in space. Uses only + - * / of the scalar, so S may be a dual number, a SIMD batch or
/// a multiprecision number.
template <class S>
struct Vec3 {
  S x{}, y{}, z{};

  friend bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(const S& k, const Vec3& a) { return {k * a.x, k * a.y, k * a.z}; }
  friend constexpr Vec3 operator*(const Vec3& a, const S& k) { return k * a; }
  friend constexpr Vec3 operator/(const Vec3& a, const S& k) { return {a.x / k, a.y / k, a.z / k}; }
  friend constexpr Vec3& operator+=(Vec3& a, const Vec3& b) { return a = a + b; }
};

/// A stored tangent: direction and sign, as glTF's TANGENT.
template <class S>
struct Vec4 {
  S x{}, y{}, z{}, w{};
  constexpr Vec3<S> xyz() const { return {x, y, z}; }
  friend bool operator==(const Vec4&, const Vec4&) = default;
};

/// a · b
template <class S>
constexpr S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// a × b, each component rounded as written. For nearly parallel vectors see accurate_cross() below.
template <class S>
constexpr Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class S>
constexpr S dot(const Vec2<S>& a, const Vec2<S>& b) {
  return a.x * b.x + a.y * b.y;
}

namespace detail {

// The same angle with sin² + cos² = 1 to within a rounding: frames need it, partials do not.
template <class S>
constexpr Turn<S> normalised(const Turn<S>& a) {
  const S half = lift<S>(0.5), excess = half * ((a.cos * a.cos - half) + (a.sin * a.sin - half));
  return {a.sin - a.sin * excess, a.cos - a.cos * excess};
}
// Twice the angle.
template <class S>
constexpr Turn<S> doubled(const Turn<S>& a) {
  return {lift<S>(2.0) * (a.sin * a.cos), (a.cos - a.sin) * (a.cos + a.sin)};
}

// The magnitude of a number as a double, for scaling only; 1 if its type provides none (it then needs no
// scaling).
template <class S>
double size_of(const S& x) {
  static_assert(!Lanewise<S>, "lanes have no common size: see ordinary_square");
  if constexpr (std::floating_point<S>)
    return std::fabs(static_cast<double>(x));
  else if constexpr (requires { Scalar<S>::value(x); })
    return size_of(Scalar<S>::value(x));
  else
    return 1;
}
template <class S>
double largest_component(const Vec2<S>& a) {
  return std::fmax(size_of(a.x), size_of(a.y));
}
template <class S>
double largest_component(const Vec3<S>& a) {
  return std::fmax(size_of(a.x), std::fmax(size_of(a.y), size_of(a.z)));
}

// The relative rounding error of the type of x; 0 if unknown.
template <class S>
double rounding_of() {
  static_assert(!Lanewise<S>, "ask for that of Element<S>");
  if constexpr (requires(const S& x) { Scalar<S>::value(x); })
    return rounding_of<std::remove_cvref_t<decltype(Scalar<S>::value(std::declval<const S&>()))>>();
  else if constexpr (std::numeric_limits<S>::is_specialized)
    return static_cast<double>(std::numeric_limits<S>::epsilon());
  else
    return 0;
}

// The exponent of the greatest power of two not above the largest component; 0 for a zero or non-finite
// vector.
template <class V>
int exponent(const V& a) {
  const double m = largest_component(a);
  return m > 0 && std::isfinite(m) ? std::ilogb(m) : 0;
}

// Components between small and 1/small have squares that neither overflow nor underflow: no scaling needed.
template <class S>
constexpr double small_component = std::same_as<S, float> ? 0x1p-38 : 0x1p-450;

// The same, but 0 where there is nothing to scale.
template <template <class> class V, class S>
int scale_exponent(const V<S>& a) {
  const double m = largest_component(a);
  return small_component<S> < m && m < 1 / small_component<S> ? 0 : exponent(a);
}

// Whether a · a proves that no scaling is needed, that is, that scale_exponent is 0.
template <Binary S>
auto is_ordinary(const S& square) {
  using T = Element<S>;
  constexpr T small = static_cast<T>(4 * small_component<T> * small_component<T>), large = T(4) / small;
  return S(small) < square && square < S(large);
}
// a · a for lanes that are all ordinary; others diverge.
template <template <class> class V, Lanewise S>
S ordinary_square(const V<S>& a) {
  const S square = dot(a, a);
  if (!is_ordinary(square)) S::diverge();
  return square;
}

template <class S>
S scaled_by_power_of_two(const S& x, int exponent) {
  if constexpr (std::floating_point<S>)
    return std::scalbn(x, exponent);
  else  // in two steps: each factor is a normal number
    return x * lift<S>(std::scalbn(1.0, exponent / 2)) * lift<S>(std::scalbn(1.0, exponent - exponent / 2));
}
template <class S>
Vec2<S> scaled_by_power_of_two(const Vec2<S>& a, int exponent) {
  return {scaled_by_power_of_two(a.x, exponent), scaled_by_power_of_two(a.y, exponent)};
}
template <class S>
Vec3<S> scaled_by_power_of_two(const Vec3<S>& a, int exponent) {
  return {scaled_by_power_of_two(a.x, exponent), scaled_by_power_of_two(a.y, exponent),
          scaled_by_power_of_two(a.z, exponent)};
}

}  // namespace detail

/// The length of a, without overflow or underflow in between. Any scalar.
template <template <class> class V, class S>
requires(std::same_as<V<S>, Vec2<S>> || std::same_as<V<S>, Vec3<S>>) S norm(const V<S>& a) {
  using std::sqrt;
  if constexpr (detail::Lanewise<S>) {
    return sqrt(detail::ordinary_square(a));
  } else {
    if constexpr (std::floating_point<S>)
      if (const S square = dot(a, a); detail::is_ordinary(square)) return sqrt(square);
    const int e = detail::scale_exponent(a);
    if (e == 0) return sqrt(dot(a, a));
    const V<S> scaled = detail::scaled_by_power_of_two(a, -e);
    return detail::scaled_by_power_of_two(S(sqrt(dot(scaled, scaled))), e);
  }
}

/// a / |a|, each component within 2 ulp; the zero vector for a zero one. Any scalar.
template <template <class> class V, class S>
requires(std::same_as<V<S>, Vec2<S>> || std::same_as<V<S>, Vec3<S>>) V<S> unit(const V<S>& a) {
  using std::sqrt;
  if constexpr (detail::Lanewise<S>) {
    return a / sqrt(detail::ordinary_square(a));
  } else {
    if constexpr (std::floating_point<S>)
      if (const S square = dot(a, a); detail::is_ordinary(square)) return a / sqrt(square);
    const int e = detail::scale_exponent(a);
    const V<S> scaled = e == 0 ? a : detail::scaled_by_power_of_two(a, -e);
    const S length = sqrt(dot(scaled, scaled));
    return detail::size_of(length) == 0 ? scaled : scaled / length;
  }
}

/// a b - c d. For floating-point scalars, the error is at most 2 ulp of the result, even under cancellation,
/// since both products are computed exactly; they must neither overflow nor underflow. [Jeannerod2013] has
/// the fma form. Other scalars: as written.
template <class S>
S difference_of_products(const S& a, const S& b, const S& c, const S& d) {
  if constexpr (detail::Binary<S>) {
    const detail::HighLow<S> ab = detail::exact_product(a, b), cd = detail::exact_product(c, d);
    return (ab.high - cd.high) + (ab.low - cd.low);
  } else {
    return a * b - c * d;
  }
}

/// a × b for vectors of ordinary size (scale first), each component a difference of products.
template <class S>
Vec3<S> accurate_cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

/// The same vector, for Eigen.
template <class S>
Eigen::Matrix<S, 3, 1> to_eigen(const Vec3<S>& a) {
  return {a.x, a.y, a.z};
}

/// The same vector, from any three-component Eigen expression.
template <class Derived>
Vec3<typename Derived::Scalar> from_eigen(const Eigen::MatrixBase<Derived>& a) {
  EIGEN_STATIC_ASSERT_VECTOR_SPECIFIC_SIZE(Derived, 3)
  return {a[0], a[1], a[2]};
}

namespace detail {

template <class S>
constexpr Vec3<S> nan_vector() {
  const S nan = lift<S>(std::numeric_limits<double>::quiet_NaN());
  return {nan, nan, nan};
}

template <std::floating_point S>
bool finite(const Vec2<S>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y);
}
template <std::floating_point S>
bool finite(const Vec3<S>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace detail

}  // namespace darboux
