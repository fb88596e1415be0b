/// \file vector.h
/// The plain small vectors of the library, over any scalar, and their bridge to Eigen.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>

#include <Eigen/Core>

namespace darboux {

/// A point of the uv square.
template <class S>
struct Vec2 {
  S x{}, y{};
  friend constexpr bool operator==(const Vec2&, const Vec2&) = default;
};

/// A point or direction in space. Only + - * / of the scalar are used, so that S may be a dual number, a SIMD
/// batch or a many-digit number.
template <class S>
struct Vec3 {
  S x{}, y{}, z{};

  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
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
  friend constexpr bool operator==(const Vec4&, const Vec4&) = default;
};

/// a · b
template <class S>
constexpr S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// a × b, each component rounded as written. For nearly parallel vectors see frame.h's accurate_cross.
template <class S>
constexpr Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
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

template <std::floating_point S>
constexpr Vec3<S> nan_vector() {
  constexpr S nan = std::numeric_limits<S>::quiet_NaN();
  return {nan, nan, nan};
}

template <std::floating_point S>
bool finite(const Vec3<S>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace detail

}  // namespace darboux
