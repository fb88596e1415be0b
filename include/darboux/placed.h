/// \file placed.h
/// Surfaces placed in space by an affine map.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <darboux/adaptor.h>

namespace darboux {

/// A surface transformed by an affine map: P = A base + translation, det A ≠ 0. Tangents are transformed by
/// A, n by the inverse transpose of A, the handedness by the sign of det A. The error of the frame exceeds
/// that of the base by some 12 roundings times the condition number of A. For numerical differentiation,
/// difference the base, never the placed points: far from the origin these have lost the digits that
/// differences need.
template <class X, class T = double>
struct Placed {
  X base;
  std::array<T, 9> A{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
  Vec3<T> translation{};

  static constexpr SurfaceInfo info = detail::moved_info<"placed ", X>(12);

  std::string refusal() const {
    Eigen::Matrix<T, 3, 3> m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = A[static_cast<std::size_t>(k)];
    try {
      FrameTransform<T>{m};
    } catch (const ParameterError&) {
      return "the placement: expected an invertible map, got one that is singular to working precision or "
             "not finite";
    }
    if (!detail::finite(translation)) return "the translation: expected finite numbers, got NaN or infinity";
    return detail::base_refusal(base);
  }

  template <class F>
  void for_each_own_number(const F& f) const {
    for (const T& x : A) f(x);
    for (const T& x : {translation.x, translation.y, translation.z}) f(x);
  }

  template <class PU, class PV>
  auto jet(const PU& u, const PV& v) const {
    auto j = base.jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    for (Vec3<S>* p : {&j.position, &j.dpdu, &j.dpdv, &j.d2pdu2, &j.d2pduv, &j.d2pdv2}) *p = map(*p);
    j.position += Vec3<S>{lift<S>(translation.x), lift<S>(translation.y), lift<S>(translation.z)};
    return j;
  }

  template <class PU, class PV>
  auto frame(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(base.jet(u, v).position.x)>;
    const Frame<S> f = detail::frame_at<S>(base, u, v, detail::declared(base, u, v));
    if (has(f.status, Status::no_frame)) return f;
    const auto [n, sign] = transformed(f.n);
    Frame<S> result{unit(map(f.t)), {}, n, sign * f.handedness, f.status};
    // For a singular A, which checked() rejects, nothing may remain.
    if (result.n == Vec3<S>{} || result.t == Vec3<S>{}) {
      result = detail::no_frame<S>();
      result.status |=
          (f.status & detail::degenerate) | (map(f.t) == Vec3<S>{} ? Status::dpdu_zero : Status::parallel);
      return result;
    }
    result.b = unit(accurate_cross(result.n, result.t));
    return result;
  }
  template <class PU, class PV>
  auto normal(const PU& u, const PV& v) const {
    return transformed(detail::normal_of(base, u, v)).first;
  }
  /// As for the base (detail::limit_direction).
  static constexpr bool limits_by_series = detail::limits_by_series<X>;
  template <class PU, class PV, class S>
  Vec3<S> limit_direction(const PU& u, const PV& v, const S& x, const S& y) const requires limits_by_series {
    return unit(map(detail::limit_direction(base, u, v, x, y)));
  }

  template <class PU, class PV>
  Status singular(const PU& u, const PV& v) const {
    return detail::declared(base, u, v);
  }

  std::vector<double> breaks(int along) const requires requires(const X& x) { x.breaks(0); }
  { return base.breaks(along); }

  template <class To>
  auto rebind() const {
    Placed<decltype(darboux::rebind<To>(base)), To> result{darboux::rebind<To>(base), {}, {}};
    for (std::size_t k = 0; k < 9; ++k) result.A[k] = lift<To>(A[k]);
    result.translation = {lift<To>(translation.x), lift<To>(translation.y), lift<To>(translation.z)};
    return result;
  }

 private:
  template <class S>
  Vec3<S> map(const Vec3<S>& p) const {
    // Skip terms with factor 0: the coordinate may be infinite.
    const auto row = [&](std::size_t k) {
      S sum = lift<S>(0.0);
      if (A[k] != T(0)) sum = sum + lift<S>(A[k]) * p.x;
      if (A[k + 1] != T(0)) sum = sum + lift<S>(A[k + 1]) * p.y;
      if (A[k + 2] != T(0)) sum = sum + lift<S>(A[k + 2]) * p.z;
      return sum;
    };
    return {row(0), row(3), row(6)};
  }
  // n transformed by the inverse transpose, and the sign of det A. The cofactor matrix is det A times the
  // inverse transpose, so its sign is corrected. A is scaled to avoid overflow first.
  template <class S>
  std::pair<Vec3<S>, S> transformed(const Vec3<S>& n) const {
    double largest = 0;
    for (const T& x : A) largest = std::fmax(largest, detail::size_of(x));
    const int e = largest > 0 ? std::ilogb(largest) : 0;
    const auto column = [&](std::size_t k) {
      return detail::scaled_by_power_of_two(Vec3<S>{lift<S>(A[k]), lift<S>(A[k + 3]), lift<S>(A[k + 6])}, -e);
    };
    const Vec3<S> x = accurate_cross(column(1), column(2)), y = accurate_cross(column(2), column(0)),
                  z = accurate_cross(column(0), column(1));
    const Vec3<S> m = unit(n.x * x + n.y * y + n.z * z);
    if (dot(column(0), x) < lift<S>(0.0)) return {-m, lift<S>(-1.0)};
    return {m, lift<S>(1.0)};
  }
};
template <class X>
Placed(X, std::array<double, 9>, Vec3<double>) -> Placed<X>;

}  // namespace darboux
