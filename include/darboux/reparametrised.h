/// \file reparametrised.h
/// Reparametrised surfaces: flipped, swapped, sheared, or restricted to part of the domain.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <darboux/adaptor.h>

namespace darboux {

/// A surface with other coordinates: (u, v) of the base = M (u, v) + offset, an affine map with det M ≠ 0,
/// as meshes apply to uvs. Both coordinates become linear. If the base is periodic, the image may exceed the
/// unit square.
template <class X, class T = double>
struct Reparametrised {
  X base;
  std::array<T, 4> M{1, 0, 0, 1};  ///< row by row: base u = M[0] u + M[1] v + offset[0]
  std::array<T, 2> offset{0, 0};

  static constexpr SurfaceInfo info{.name = detail::AdaptedName<"reparametrised ", X>::value,
                                    .summary = X::info.summary,
                                    .u = Coordinate::linear,
                                    .v = Coordinate::linear,
                                    .orientable = X::info.orientable,
                                    .own_orientation = true,
                                    .frame_error = X::info.frame_error + 8};

  std::string refusal() const {
    const T determinant = scaled_determinant();
    // An infinite or NaN entry makes the determinant NaN.
    if (!(determinant > 0 || determinant < 0))
      return "the map of (u, v): expected an invertible one, got a singular one";
    if (!std::isfinite(offset[0]) || !std::isfinite(offset[1]))
      return "the offset of (u, v): expected finite numbers, got NaN or infinity";
    return detail::base_refusal(base);
  }

  template <class F>
  void for_each_own_number(const F& f) const {
    for (const T& x : M) f(x);
    for (const T& x : offset) f(x);
  }

  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    const Jet2<S> j = base.jet(pu, pv);
    // Compute products of entries in S, which has more digits than T when curvatures are computed.
    const S a = lift<S>(M[0]), b = lift<S>(M[1]), c = lift<S>(M[2]), d = lift<S>(M[3]);
    // Skip terms with factor 0: the partial may be infinite.
    const auto add = [](Vec3<S>& sum, const S& factor, const Vec3<S>& x) {
      if (!(factor == lift<S>(0.0))) sum = sum + factor * x;
    };
    const auto first = [&](const S& by_u, const S& by_v) {
      const S zero = lift<S>(0.0);
      Vec3<S> sum{zero, zero, zero};
      add(sum, by_u, j.dpdu);
      add(sum, by_v, j.dpdv);
      return sum;
    };
    const auto second = [&](const S& u1, const S& v1, const S& u2, const S& v2) {
      const S zero = lift<S>(0.0);
      Vec3<S> sum{zero, zero, zero};
      add(sum, u1 * u2, j.d2pdu2);
      add(sum, u1 * v2 + u2 * v1, j.d2pduv);
      add(sum, v1 * v2, j.d2pdv2);
      return sum;
    };
    return {.position = j.position,
            .dpdu = first(a, c),
            .dpdv = first(b, d),
            .d2pdu2 = second(a, c, a, c),
            .d2pduv = second(a, c, b, d),
            .d2pdv2 = second(b, d, b, d)};
  }

  template <std::floating_point S>
  Frame<S> frame(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    const Status at = detail::declared(base, pu, pv);
    const Frame<S> f = detail::frame_at<S>(base, pu, pv, at);
    if (has(f.status, Status::no_frame)) return f;
    const T determinant = scaled_determinant();
    if (!(determinant > T(0) || determinant < T(0))) {  // a singular M, which checked() rejects
      Frame<S> none = detail::no_frame<S>();
      const bool u_zero = M[0] == T(0) && M[2] == T(0), v_zero = M[1] == T(0) && M[3] == T(0);
      if (u_zero) none.status |= Status::dpdu_zero;
      if (v_zero) none.status |= Status::dpdv_zero;
      if (!u_zero && !v_zero) none.status |= Status::parallel;
      return none;
    }
    const S a = lift<S>(M[0]), c = lift<S>(M[2]), one = lift<S>(1.0);
    const Jet2<S> j = base.jet(pu, pv);
    Vec3<S> t;
    if (detail::limits_by_series<X> && has(f.status, Status::limit_frame)) {
      if constexpr (detail::limits_by_series<X>) t = detail::limit_direction(base, pu, pv, a, c);
      if (t == Vec3<S>{}) return detail::no_frame<S>();
    } else if (has(at, Status::dpdu_zero) || a == S(0)) {
      // If one partial of the base vanishes, the other one decides; if that one does not enter, the limit
      // does.
      t = c == S(0) ? std::copysign(one, a) * f.t : std::copysign(one, c) * along_v(f, j, at);
    } else if (has(at, Status::dpdv_zero) || c == S(0)) {
      t = a == S(0) ? std::copysign(one, c) * along_v(f, j, at) : std::copysign(one, a) * f.t;
    } else {
      t = unit(a * j.dpdu + c * j.dpdv);
    }
    const Vec3<S> b = t == f.t ? f.b : t == -f.t ? -f.b : unit(accurate_cross(f.n, t));
    return {t, b, f.n, determinant < T(0) ? -f.handedness : f.handedness, mapped_status(f.status)};
  }

  /// As for the base (detail::limit_direction).
  static constexpr bool limits_by_series = detail::limits_by_series<X>;
  template <class S>
  Vec3<S> limit_direction(const S& u, const S& v, const S& x, const S& y) const requires limits_by_series {
    const auto [pu, pv] = inside(u, v);
    return detail::limit_direction(base, pu, pv, S(lift<S>(M[0]) * x + lift<S>(M[1]) * y),
                                   S(lift<S>(M[2]) * x + lift<S>(M[3]) * y));
  }

  template <class S>
  Vec3<S> normal(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    return detail::normal_of(base, pu, pv);
  }

  template <class S>
  Status singular(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    Status result = mapped_status(detail::declared(base, pu, pv));
    const auto [x, y] = mapped(u, v);
    if (detail::outside<X::info.u>(x) || detail::outside<X::info.v>(y)) result |= Status::outside_domain;
    return result;
  }

  template <class S>
  S implicit(const Vec3<S>& p) const requires StatesImplicit<X> {
    return base.implicit(p);
  }
  template <class S>
  S gaussian_curvature(const S& u, const S& v) const requires StatesGaussianCurvature<X> {
    const auto [pu, pv] = inside(u, v);
    return base.gaussian_curvature(pu, pv);
  }
  template <class S>
  S mean_curvature(const S& u, const S& v) const requires StatesMeanCurvature<X> {
    const auto [pu, pv] = inside(u, v);
    return base.mean_curvature(pu, pv);
  }

  /// The coordinates at which the base is only piecewise smooth, if the map takes coordinate lines to
  /// coordinate lines; otherwise empty.
  std::vector<double> breaks(int along) const requires requires(const X& x) { x.breaks(0); }
  {
    std::vector<double> result;
    for (int k = 0; k < 2; ++k) {
      const auto row = static_cast<std::size_t>(k);
      const T by_this = M[2 * row + static_cast<std::size_t>(along)],
              by_other = M[2 * row + static_cast<std::size_t>(1 - along)];
      if (by_this == 0 || by_other != 0) continue;
      for (const double x : base.breaks(k))
        if (const double y = static_cast<double>((x - offset[row]) / by_this); 0 < y && y < 1)
          result.push_back(y);
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  template <class To>
  auto rebind() const {
    Reparametrised<decltype(darboux::rebind<To>(base)), To> result{darboux::rebind<To>(base), {}, {}};
    for (std::size_t k = 0; k < 4; ++k) result.M[k] = lift<To>(M[k]);
    for (std::size_t k = 0; k < 2; ++k) result.offset[k] = lift<To>(offset[k]);
    return result;
  }

 private:
  // The status bits of the base, translated to these coordinates.
  Status mapped_status(Status at) const {
    Status result = detail::without(at, Status::dpdu_zero | Status::dpdv_zero);
    const bool u_zero = has(at, Status::dpdu_zero), v_zero = has(at, Status::dpdv_zero);
    if ((u_zero && M[2] == 0) || (v_zero && M[0] == 0) || (u_zero && v_zero)) result |= Status::dpdu_zero;
    if ((u_zero && M[3] == 0) || (v_zero && M[1] == 0) || (u_zero && v_zero)) result |= Status::dpdv_zero;
    if ((u_zero || v_zero) && !has(result, Status::dpdu_zero | Status::dpdv_zero)) result |= Status::parallel;
    return result;
  }
  // det M with the largest entry scaled to 1, so that no product overflows.
  T scaled_determinant() const {
    T largest = 0;
    for (const T& x : M) largest = std::fmax(largest, std::fabs(x));
    return M[0] / largest * (M[3] / largest) - M[1] / largest * (M[2] / largest);
  }
  template <class S>
  std::pair<S, S> mapped(const S& u, const S& v) const {
    return {lift<S>(M[0]) * u + lift<S>(M[1]) * v + lift<S>(offset[0]),
            lift<S>(M[2]) * u + lift<S>(M[3]) * v + lift<S>(offset[1])};
  }
  template <class S>
  auto inside(const S& u, const S& v) const {
    const auto [x, y] = mapped(u, v);
    return std::pair{prepare<X::info.u>(x), prepare<X::info.v>(y)};
  }
  // The direction of dpdv on the base; where it vanishes, that of ±d2pduv on the side of handedness · b.
  template <class S>
  static Vec3<S> along_v(const Frame<S>& f, const Jet2<S>& j, Status at) {
    if (!has(at, Status::dpdv_zero)) return unit(j.dpdv);
    const Vec3<S> leaning = f.handedness * f.b, limit = unit(j.d2pduv);
    if (!detail::finite(limit) || limit == Vec3<S>{}) return leaning;
    return dot(limit, leaning) < S(0) ? -limit : limit;
  }
};
template <class X>
Reparametrised(X, std::array<double, 4>, std::array<double, 2>) -> Reparametrised<X>;

/// u and v exchanged.
template <ParametricSurface X>
Reparametrised<X> swapped(const X& base) {
  return {base, {0, 1, 1, 0}, {0, 0}};
}
/// u replaced by 1 - u, v by 1 - v.
template <ParametricSurface X>
Reparametrised<X> flipped_u(const X& base) {
  return {base, {-1, 0, 0, 1}, {1, 0}};
}
template <ParametricSurface X>
Reparametrised<X> flipped_v(const X& base) {
  return {base, {1, 0, 0, -1}, {0, 1}};
}
/// The part over [u0, u1] × [v0, v1], reparametrised over the unit square.
template <ParametricSurface X>
Reparametrised<X> sub_rectangle(const X& base, double u0, double u1, double v0, double v1) {
  return {base, {u1 - u0, 0, 0, v1 - v0}, {u0, v0}};
}
/// u replaced by u + k v.
template <ParametricSurface X>
Reparametrised<X> sheared(const X& base, double k) {
  return {base, {1, k, 0, 1}, {0, 0}};
}

}  // namespace darboux
