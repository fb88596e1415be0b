/// \file darboux_frame.h
/// The Darboux frame of a curve on a surface: normal and geodesic curvature, geodesic torsion.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include <darboux/shape_operator.h>

namespace darboux {

/// A curve u(s), v(s) on a surface at one point, given by its first and second derivatives with respect to
/// the parameter s.
template <class S>
struct CurveOnSurface {
  S du, dv, d2u, d2v;
};

/// The Darboux frame of a curve on a surface: T its unit tangent, V = n × T the tangent normal, n the
/// surface normal; κn its normal curvature, κg its geodesic curvature, τg its geodesic torsion (1/length):
///   T' = κg V + κn n,   V' = -κg T + τg n,   n' = -κn T - τg V   (derivatives by arc length)
/// κn is positive if the curve bends towards n, κg if it turns left as seen from the side of n.
/// [doCarmo2016, sec. 4-4]
template <class S>
struct DarbouxFrame {
  Vec3<S> T, V, n;
  S normal_curvature, geodesic_curvature, geodesic_torsion;
  Status status;  ///< the surface frame's; no_frame and NaN where the curve does not move (du = dv = 0, or
                  ///< along a vanishing partial)
};
template <std::floating_point S>
DarbouxFrame<S> darboux_frame(const Jet2<S>& j, const Frame<S>& frame, const ShapeOperator<S>& shape,
                              const CurveOnSurface<S>& curve) {
  const Vec3<S> velocity = curve.du * j.dpdu + curve.dv * j.dpdv;
  const S speed = norm(velocity);
  DarbouxFrame<S> result{unit(velocity), {}, frame.n, {}, {}, {}, frame.status};
  if (!(speed > S(0)) || has(frame.status, Status::no_frame | Status::non_finite_input)) {
    const S nan = std::numeric_limits<S>::quiet_NaN();
    result.T = result.V = detail::nan_vector<S>();
    result.normal_curvature = result.geodesic_curvature = result.geodesic_torsion = nan;
    result.status |= Status::no_frame;
    return result;
  }
  result.V = accurate_cross(frame.n, result.T);
  const S du = curve.du / speed, dv = curve.dv / speed;  // by arc length
  const Vec3<S> bend = du * du * j.d2pdu2 + S(2) * du * dv * j.d2pduv + dv * dv * j.d2pdv2;
  result.normal_curvature = dot(frame.n, bend);
  result.geodesic_curvature =
      dot(result.V, bend + curve.d2u / speed / speed * j.dpdu + curve.d2v / speed / speed * j.dpdv);
  const S x = dot(result.T, frame.t), y = dot(result.T, frame.b);
  result.geodesic_torsion =
      dot(result.V, (shape.a * x + shape.m * y) * frame.t + (shape.m * x + shape.c * y) * frame.b);
  return result;
}
template <std::floating_point S>
DarbouxFrame<S> darboux_frame(const Jet2<S>& j, const Frame<S>& frame, const CurveOnSurface<S>& curve) {
  return darboux_frame(j, frame, shape_operator(j, frame), curve);
}
/// The Darboux frame at (u, v) of a surface, including poles and collapsed edges: see shape_operator().
template <class X, std::floating_point S>
DarbouxFrame<S> darboux_frame(const X& surface, S u, S v, const CurveOnSurface<S>& curve) {
  const Jet2<S> j = detail::jet_of(surface, u, v);
  const Frame<S> f = detail::frame_of(surface, u, v);
  return darboux_frame(j, f, shape_operator(surface, u, v, j, f), curve);
}

template <class X, class U, class V>
requires(detail::MixedCoordinates<U, V>&& std::is_class_v<X>)
    DarbouxFrame<double> darboux_frame(const X& surface, U u, V v, const CurveOnSurface<double>& curve) {
  return darboux_frame(surface, static_cast<double>(u), static_cast<double>(v), curve);
}

}  // namespace darboux
