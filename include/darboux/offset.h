/// \file offset.h
/// Parallel (offset) surfaces.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <darboux/adaptor.h>
#include <darboux/shape_operator.h>

namespace darboux {

/// The parallel surface P + d n at signed distance d along the normal of the base. n is that of the base; the
/// handedness changes sign beyond a focal point (d κ > 1 for one principal curvature κ). The second
/// partials need third derivatives of the base, which come from nested dual numbers over its normal, at some
/// twenty times the cost. Principal curvatures: κ / (1 - d κ). At a focal point where dpdu = 0 there is no
/// frame (no_frame, dpdu_zero); near it t has lost digits (ill_conditioned if more than half). At a focal
/// point where dpdv = 0 the frame is that of the base (limit_frame, dpdv_zero). At a conical point of the
/// base, n varies with u, and the parallel surface is regular. If the frame of the base is a limit that
/// d2pduv does not determine, there is a position but no frame. [doCarmo2016, sec. 3-5]
template <class X, class T = double>
struct Offset {
  X base;
  T distance{0};

  static constexpr SurfaceInfo info = detail::moved_info<"offset ", X>(12);

  std::string refusal() const {
    if (!std::isfinite(distance)) return "the distance: expected a finite number, got NaN or infinity";
    return detail::base_refusal(base);
  }

  template <class F>
  void for_each_own_number(const F& f) const {
    f(distance);
  }

  template <class PU, class PV>
  auto jet(const PU& u, const PV& v) const {
    auto j = base.jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    const Jet2<S> n = normal_jet<S>(u, v);
    const S d = lift<S>(distance);
    Vec3<S> here = n.position;
    // The limit has a value but no derivatives.
    if constexpr (std::floating_point<S> && std::floating_point<T>)
      if (!detail::finite(here)) here = detail::frame_at<S>(base, u, v, detail::declared(base, u, v)).n;
    return Jet2<S>{.position = j.position + d * here,
                   .dpdu = j.dpdu + d * n.dpdu,
                   .dpdv = j.dpdv + d * n.dpdv,
                   .d2pdu2 = j.d2pdu2 + d * n.d2pdu2,
                   .d2pduv = j.d2pduv + d * n.d2pduv,
                   .d2pdv2 = j.d2pdv2 + d * n.d2pdv2};
  }

  template <class PU, class PV>
  auto frame(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(base.jet(u, v).position.x)>;
    const Frame<S> f = detail::frame_at<S>(base, u, v, detail::declared(base, u, v));
    if (has(f.status, Status::no_frame)) return f;
    const Status at = still_singular(f.status, u, v);
    const Jet2<S> of_base = base.jet(u, v), j = jet(u, v);
    // The normal of the base is a limit of higher order: t is not known here.
    if (!detail::finite(normal(u, v))) {
      Frame<S> none = detail::no_frame<S>();
      none.status |= f.status & detail::degenerate;
      return none;
    }
    // Where a partial vanishes, its direction is that of ±d2pduv, on the base and on the offset surface.
    const auto limit = [&](const Vec3<S>& leaning) {
      return dot(of_base.d2pduv, leaning) < S(0) ? -j.d2pduv : j.d2pduv;
    };
    if (!detail::finite(j.dpdu) || !detail::finite(j.dpdv))
      return Frame<S>{f.t, f.b, f.n, f.handedness, f.status};  // as the base's do
    const bool u_collapsed = has(at, Status::dpdu_zero), v_collapsed = has(at, Status::dpdv_zero);
    const Vec3<S> along_v = v_collapsed ? limit(f.handedness * f.b) : j.dpdv;
    Along<S> along_u = along(of_base, f);
    if (!detail::finite(along_u.direction))
      along_u = u_collapsed ? in_plane(limit(f.t), of_base.d2pduv, f) : in_plane(j.dpdu, of_base.dpdu, f);
    // At a focal point a partial is the difference of equal terms; the rounding error that remains has no
    // direction.
    constexpr S rounding = S(64) * std::numeric_limits<S>::epsilon();
    if (!(along_u.length > rounding * along_u.terms)) {
      Frame<S> none = detail::no_frame<S>();
      none.status |= Status::dpdu_zero;
      return none;
    }
    Frame<S> result{along_u.direction,
                    {},
                    f.n,
                    f.handedness,
                    (at & (detail::degenerate | Status::crease)) | (f.status & Status::ill_conditioned)};
    if (has(at, detail::degenerate)) result.status |= Status::limit_frame;
    const S left = along_u.length / along_u.terms;
    if (left * left < std::numeric_limits<S>::epsilon()) result.status |= Status::ill_conditioned;
    result.b = unit(accurate_cross(result.n, result.t));
    // The handedness of the base, negated at each focal point passed.
    if (has(at, Status::parallel)) {
      if constexpr (std::same_as<PU, S> && std::same_as<PV, S>) {
        Frame<S> limit_of_base = f;
        limit_of_base.status |= Status::limit_frame;
        const ShapeOperator<S> s = shape_operator(base, u, v, of_base, limit_of_base);
        const S d = lift<S>(distance), one = lift<S>(1.0);
        if ((one - d * s.a) * (one - d * s.c) < d * s.m * (d * s.m)) result.handedness = -f.handedness;
      }
    } else {
      const S sine = dot(accurate_cross(result.t, unit(along_v)), f.n);
      result.handedness = sine < S(0) ? S(-1) : S(1);
      if (!v_collapsed &&
          !(norm(j.dpdv) > rounding * norm(of_base.dpdv)))  // the frame is the base's all the same
        result.status |= Status::dpdv_zero | Status::limit_frame;
    }
    return result;
  }

  /// The status of the base, except at its conical points: there n varies with u, and the parallel surface is
  /// regular.
  template <class PU, class PV>
  Status singular(const PU& u, const PV& v) const {
    return still_singular(detail::declared(base, u, v), u, v);
  }

  template <class PU, class PV>
  auto normal(const PU& u, const PV& v) const {
    return detail::normal_of(base, u, v);
  }

  /// K / (1 - 2 d H + d² K), from the curvatures that the base states
  template <class PU, class PV>
  auto gaussian_curvature(const PU& u,
                          const PV& v) const requires StatesGaussianCurvature<X> && StatesMeanCurvature<X> {
    const auto K = base.gaussian_curvature(u, v), H = base.mean_curvature(u, v);
    using S = std::remove_cvref_t<decltype(K)>;
    const S d = lift<S>(distance), one = lift<S>(1.0), two = lift<S>(2.0);
    return S(K / (one - two * d * H + d * d * K));
  }

  std::vector<double> breaks(int along) const requires requires(const X& x) { x.breaks(0); }
  { return base.breaks(along); }

  template <class To>
  auto rebind() const {
    return Offset<decltype(darboux::rebind<To>(base)), To>{darboux::rebind<To>(base), lift<To>(distance)};
  }

 private:
  // The unit vector along dpdu, the ratio of its length to that on the base, and the terms of which it is the
  // sum.
  template <class S>
  struct Along {
    Vec3<S> direction;
    S length, terms;
  };
  // dpdu = e ((1 - d a) t - d m b), from the shape operator of the base: it lies in the tangent plane however
  // much cancels. NaN where the base is singular.
  template <class S>
  Along<S> along(const Jet2<S>& of_base, const Frame<S>& f) const {
    if (has(f.status, detail::degenerate)) return {detail::nan_vector<S>(), S(0), S(0)};
    const ShapeOperator<S> s = shape_operator(of_base, f);
    const S d = lift<S>(distance), side = std::copysign(S(1), s.e);
    const S noise = S(16) * std::numeric_limits<S>::epsilon() * s.m_size;
    const S x = S(1) - d * s.a, y = std::fabs(s.m) <= noise ? S(0) : d * s.m;
    const Vec3<S> sum = x * f.t - y * f.b;
    return {side * unit(sum), norm(sum), S(1) + std::fabs(d) * (s.a_size + s.m_size)};
  }
  // The same from dpdu or its limit, with the rounding error along n removed.
  template <class S>
  static Along<S> in_plane(const Vec3<S>& partial, const Vec3<S>& of_base, const Frame<S>& f) {
    const Vec3<S> sum = dot(partial, f.t) * f.t + dot(partial, f.b) * f.b;
    return {unit(sum), norm(sum), std::fmax(norm(sum), norm(of_base))};
  }
  // What is left of the base's bits.
  template <class PU, class PV>
  Status still_singular(Status at, const PU& u, const PV& v) const {
    if (!has(at, detail::degenerate)) return at;
    const auto j = jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    constexpr S rounding = S(64) * std::numeric_limits<S>::epsilon();
    const auto regular = [&](const Vec3<S>& partial, const Vec3<S>& other) {
      return norm(partial) > rounding * (norm(other) + norm(j.d2pduv));
    };
    Status result = at;
    if (regular(j.dpdu, j.dpdv)) result = detail::without(result, Status::dpdu_zero);
    if (regular(j.dpdv, j.dpdu)) result = detail::without(result, Status::dpdv_zero);
    if (norm(cross(unit(j.dpdu), unit(j.dpdv))) > rounding)
      result = detail::without(result, Status::parallel);
    return result;
  }
  template <class S, class PU, class PV>
  Jet2<S> normal_jet(const PU& u, const PV& v) const {
    return detail::jet_by_duals<X::info.u, X::info.v, S>(
        [this](const auto& a, const auto& b) { return this->normal(a, b); }, u, v);
  }
};
template <class X>
Offset(X, double) -> Offset<X>;

}  // namespace darboux
