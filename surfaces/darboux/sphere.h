/// \file sphere.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Sphere about the origin.
///   P(u, v) = r (sin πv cos 2πu, sin πv sin 2πu, -cos πv)
/// u runs round the z axis in turns (counter-clockwise from +x), v from the south pole (0) to the north (1).
/// n points outward. The chart is singular at the poles, where dpdu vanishes; there the frame is the limit
/// along the meridian of the given u: t = (-sin 2πu, cos 2πu, 0), n = (0, 0, ±1). In the angles of
/// spherical coordinates, u = φ/2π and v = (π - θ)/π. Frame components err by at most 4u, u the unit
/// roundoff, for every radius. [doCarmo2016, sec. 2-2]
template <class T = double>
struct Sphere {
  T radius{1};

  static constexpr SurfaceInfo info{"sphere",
                                    "sphere about the origin, v from pole to pole",
                                    Coordinate::turn,
                                    Coordinate::half_turn,
                                    {"v=0", "v=1"},
                                    /* orientable */ true,
                                    /* euler_characteristic */ 2};
  static constexpr auto parameters() {
    return std::array{parameter<&Sphere::radius>("radius", Range::positive(), "radius")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const Turn<S>& v) const {
    const S r = lift<S>(radius), zero = lift<S>(0.0), half = pi<S>() * r, full = two_pi<S>() * r;
    const S s = v.sin, c = -v.cos;  // distance from the axis and height, over r
    return {.position = {r * (s * u.cos), r * (s * u.sin), r * c},
            .dpdu = {-(full * (s * u.sin)), full * (s * u.cos), zero},
            .dpdv = {-(half * (c * u.cos)), -(half * (c * u.sin)), half * s},
            .d2pdu2 = {-(two_pi<S>() * (full * (s * u.cos))), -(two_pi<S>() * (full * (s * u.sin))), zero},
            .d2pduv = {two_pi<S>() * (half * (c * u.sin)), -(two_pi<S>() * (half * (c * u.cos))), zero},
            .d2pdv2 = {-(pi<S>() * (half * (s * u.cos))), -(pi<S>() * (half * (s * u.sin))),
                       -(pi<S>() * (half * c))}};
  }

  template <class S>
  constexpr Frame<S> frame(const Turn<S>& u, const Turn<S>& v) const {
    const S s = v.sin, c = -v.cos;
    return {.t = {-u.sin, u.cos, lift<S>(0.0)},
            .b = {-(c * u.cos), -(c * u.sin), s},
            .n = {s * u.cos, s * u.sin, c}};
  }

  constexpr bool tangent_depends_on_u_alone() const { return true; }

  template <class S>
  constexpr Status singular(const Turn<S>&, const Turn<S>& v) const {
    return v.sin == lift<S>(0.0) ? Status::dpdu_zero : Status::regular;
  }

  /// |p| - r
  template <class S>
  S implicit(const Vec3<S>& p) const {
    using std::sqrt;
    const Vec3<S> q = p / lift<S>(radius);
    return lift<S>(radius) * (sqrt(dot(q, q)) - lift<S>(1.0));
  }

  /// K = 1/r²
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>&, const Turn<S>&) const {
    const S k = lift<S>(1.0) / lift<S>(radius);
    return k * k;
  }
};
Sphere(double)->Sphere<double>;

}  // namespace darboux
