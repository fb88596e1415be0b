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
#include <darboux/affine_map.h>

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

  AffineMap<T> affine_map() const { return {A, translation}; }

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
    const AffineMap<T> map = affine_map();
    for (auto* p : {&j.dpdu, &j.dpdv, &j.d2pdu2, &j.d2pduv, &j.d2pdv2}) *p = map.linear(*p);
    j.position = map.point(j.position);
    return j;
  }

  template <class PU, class PV>
  auto frame(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(base.jet(u, v).position.x)>;
    const Frame<S> f = detail::frame_at<S>(base, u, v, detail::declared(base, u, v));
    if (has(f.status, Status::no_frame)) return f;
    const AffineMap<T> map = affine_map();
    Frame<S> result = map.frame(f, map.template of_normals<S>());
    // For a singular A, which checked() rejects, nothing may remain.
    if (result.n == Vec3<S>{} || result.t == Vec3<S>{}) {
      const bool is_zero = map.linear(f.t) == Vec3<S>{};
      result = detail::no_frame<S>();
      result.status |= (f.status & detail::degenerate) | (is_zero ? Status::dpdu_zero : Status::parallel);
    }
    return result;
  }
  template <class PU, class PV>
  auto normal(const PU& u, const PV& v) const {
    const auto n = detail::normal_of(base, u, v);
    return affine_map().template of_normals<std::remove_cvref_t<decltype(n.x)>>()(n);
  }
  /// As for the base (detail::limit_direction).
  static constexpr bool limits_by_series = detail::limits_by_series<X>;
  template <class PU, class PV, class S>
  Vec3<S> limit_direction(const PU& u, const PV& v, const S& x, const S& y) const requires limits_by_series {
    return unit(affine_map().linear(detail::limit_direction(base, u, v, x, y)));
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
};
template <class X>
Placed(X, std::array<double, 9>, Vec3<double>) -> Placed<X>;

}  // namespace darboux
