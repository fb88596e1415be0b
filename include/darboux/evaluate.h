/// \file evaluate.h
/// Evaluates a surface at (u, v): partials, frames, status. Total: nothing here throws or logs.
#pragma once

#include <darboux/frame.h>
#include <darboux/surface.h>

namespace darboux {

/// Position and partials at (u, v), for any scalar the formula compiles with.
template <ParametricSurface X, class S>
Jet2<S> jet(const X& surface, const S& u, const S& v) {
  return surface.jet(prepare<X::info.u>(u), prepare<X::info.v>(v));
}

namespace detail {

template <Coordinate kind, class S>
bool outside(const S& x) {
  if constexpr (kind == Coordinate::linear || kind == Coordinate::half_turn)
    return x < S(0) || x > S(1);
  else
    return false;
}

}  // namespace detail

/// What the surface and the domain say of (u, v), before any frame is made: dpdu_zero, dpdv_zero, parallel,
/// self_intersecting, crease as the surface declares them, outside_domain, non_finite_input (u, v or a
/// parameter).
template <ParametricSurface X, std::floating_point S>
Status status(const X& surface, S u, S v) {
  bool finite = std::isfinite(u) && std::isfinite(v);
  for_each_parameter<X>([&](const auto& p) { finite = finite && std::isfinite(p.of(surface)); });
  if (!finite) return Status::non_finite_input;
  Status result = Status::regular;
  if constexpr (DeclaresSingularPoints<X>)
    result |= surface.singular(prepare<X::info.u>(u), prepare<X::info.v>(v));
  if (detail::outside<X::info.u>(u) || detail::outside<X::info.v>(v)) result |= Status::outside_domain;
  return result;
}

/// The orthonormal frame at (u, v) with its status. In closed form where the surface gives one (about 10 ns),
/// else from the partials (about 90 ns). At a singular point of the chart the closed form is the limit along
/// the given u, flagged limit_frame with the bit that says why; where no limit exists, and for NaN or
/// infinite u, v or parameters, the vectors are NaN. Outside the domain the analytic extension is given:
/// continuous through a pole, where dpdu = -|dpdu| t beyond it.
template <ParametricSurface X, std::floating_point S>
Frame<S> frame(const X& surface, S u, S v) {
  const auto pu = prepare<X::info.u>(u);
  const auto pv = prepare<X::info.v>(v);
  Frame<S> result;
  if constexpr (HasClosedFrame<X>) {
    result = surface.frame(pu, pv);
  } else {
    const Jet2<S> j = surface.jet(pu, pv);
    result = frame_from_partials(j.dpdu, j.dpdv);
    // Partials that are not finite: the input's doing, which status() tells, or overflow.
    if (has(result.status, Status::non_finite_input)) result.status = Status::no_frame | Status::overflow;
  }
  result.status |= status(surface, u, v);
  if constexpr (HasClosedFrame<X>)
    if (has(result.status, Status::dpdu_zero | Status::dpdv_zero | Status::parallel))
      result.status |= Status::limit_frame;
  if (has(result.status, Status::non_finite_input)) {
    result.t = result.b = result.n = detail::nan_vector<S>();
  }
  return result;
}

/// The unit vectors along the coordinate curves. Where dpdu vanishes, t is the limit of frame(); where dpdv
/// vanishes, b is handedness times its b.
template <ParametricSurface X, std::floating_point S>
ParametricFrame<S> parametric_frame(const X& surface, S u, S v) {
  const Frame<S> base = frame(surface, u, v);
  ParametricFrame<S> result{base.t, base.handedness * base.b, base.n, base.handedness, base.status};
  if (!has(base.status, Status::non_finite_input | Status::no_frame)) {
    const Vec3<S> along_v = unit(jet(surface, u, v).dpdv);
    if (detail::finite(along_v) && along_v != Vec3<S>{}) result.b = along_v;
  }
  return result;
}

/// All of it at one point; the status adds `overflow` where a position or partial is not finite for finite
/// input.
template <class S>
struct Sample {
  S u, v;
  Jet2<S> jet;
  Frame<S> frame;  ///< frame.status is the sample's
};
template <ParametricSurface X, std::floating_point S>
Sample<S> sample(const X& surface, S u, S v) {
  Sample<S> result{u, v, jet(surface, u, v), frame(surface, u, v)};
  const Jet2<S>& j = result.jet;
  for (const Vec3<S>& a : {j.position, j.dpdu, j.dpdv, j.d2pdu2, j.d2pduv, j.d2pdv2})
    if (!detail::finite(a) && !has(result.frame.status, Status::non_finite_input))
      result.frame.status |= Status::overflow;
  return result;
}

}  // namespace darboux
