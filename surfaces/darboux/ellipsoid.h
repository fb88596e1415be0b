/// \file ellipsoid.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Ellipsoid about the origin, its axes along x, y and z.
///   P(u, v) = (a sin πv cos 2πu, b sin πv sin 2πu, -c cos πv)
/// u runs round the z axis in turns (counter-clockwise from +x), v from the south pole (0) to the north (1).
///   n = unit(x/a², y/b², z/c²),   t = unit(-a sin 2πu, b cos 2πu, 0)
/// n points outward. The chart is singular at the poles, where dpdu vanishes; there the frame is the limit
/// along the curve of the given u: t as above, n = (0, 0, ±1). With three equal axes it is the sphere. Frame
/// components err by at most 4u, partials by at most 8u of their scale, u the unit roundoff, for all axes,
/// also of very different sizes. [doCarmo2016, sec. 2-2]
template <class T = double>
struct Ellipsoid {
  T semi_axis_x{1}, semi_axis_y{T(0.7)}, semi_axis_z{T(0.5)};

  static constexpr SurfaceInfo info{"ellipsoid",
                                    "ellipsoid about the origin, v from pole to pole",
                                    Coordinate::turn,
                                    Coordinate::half_turn,
                                    {"v=0", "v=1"},
                                    /* orientable */ true,
                                    /* euler_characteristic */ 2};
  static constexpr auto parameters() {
    return std::array{
        parameter<&Ellipsoid::semi_axis_x>("semi_axis_x", Range::positive(), "half the length along x"),
        parameter<&Ellipsoid::semi_axis_y>("semi_axis_y", Range::positive(), "half the length along y"),
        parameter<&Ellipsoid::semi_axis_z>("semi_axis_z", Range::positive(), "half the length along z")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const Turn<S>& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z), zero = lift<S>(0.0);
    const S tau = two_pi<S>(), half = pi<S>();
    const Vec3<S> q = on_unit_sphere(u, v);
    const S bx = q.z * u.cos, by = q.z * u.sin;  // -∂q/∂v over π
    return {
        .position = {a * q.x, b * q.y, c * q.z},
        .dpdu = {-(tau * (a * q.y)), tau * (b * q.x), zero},
        .dpdv = {-(half * (a * bx)), -(half * (b * by)), half * (c * v.sin)},
        .d2pdu2 = {-(tau * (tau * (a * q.x))), -(tau * (tau * (b * q.y))), zero},
        .d2pduv = {tau * (half * (a * by)), -(tau * (half * (b * bx))), zero},
        .d2pdv2 = {-(half * (half * (a * q.x))), -(half * (half * (b * q.y))), -(half * (half * (c * q.z)))}};
  }

  template <class S>
  Frame<S> frame(const Turn<S>& u, const Turn<S>& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z);
    const Vec3<S> q = on_unit_sphere(u, v);
    const Vec2<S> along_u = unit(Vec2<S>{-(a * u.sin), b * u.cos});
    const Vec3<S> t{along_u.x, along_u.y, lift<S>(0.0)}, n = unit(Vec3<S>{q.x / a, q.y / b, q.z / c});
    return {.t = t, .b = unit(cross(n, t)), .n = n};  // nothing cancels: nx ty and -ny tx have one sign
  }

  constexpr bool tangent_depends_on_u_alone() const { return true; }

  template <class S>
  constexpr Status singular(const Turn<S>&, const Turn<S>& v) const {
    return v.sin == lift<S>(0.0) ? Status::dpdu_zero : Status::regular;
  }

  /// f / |grad f| with f = |(x/a, y/b, z/c)| - 1: to first order the distance, positive outside; at the
  /// centre minus the least semi-axis.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z);
    const Vec3<S> q{p.x / a, p.y / b, p.z / c};
    const S size = norm(q);
    if (size == lift<S>(0.0)) return -(a < b ? (a < c ? a : c) : (b < c ? b : c));
    return (size - lift<S>(1.0)) / norm(Vec3<S>{q.x / a, q.y / b, q.z / c} / size);
  }

  /// K = (d² / (a b c))² with d the distance of the tangent plane from the centre.
  template <class S>
  S gaussian_curvature(const Turn<S>& u, const Turn<S>& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z);
    const S d = tangent_plane_distance(u, v), root = (d / a) * (d / b) / c;
    return root * root;
  }

  /// H = -d³ (a² + b² + c² - |P|²) / (2 (a b c)²), d as in K; the bracket as a sum of squares.
  template <class S>
  S mean_curvature(const Turn<S>& u, const Turn<S>& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z);
    const S d = tangent_plane_distance(u, v);
    const Vec3<S> q = on_unit_sphere(u, v);
    const Vec3<S> m{(d / b) * norm(Vec2<S>{q.y, q.z}) / c, (d / a) * norm(Vec2<S>{q.x, q.z}) / c,
                    (d / a) * norm(Vec2<S>{q.x, q.y}) / b};
    return -(lift<S>(0.5) * dot(d * m, m));
  }

 private:
  // (x/a, y/b, z/c)
  template <class S>
  static constexpr Vec3<S> on_unit_sphere(const Turn<S>& u, const Turn<S>& v) {
    return {v.sin * u.cos, v.sin * u.sin, -v.cos};
  }
  template <class S>
  S tangent_plane_distance(const Turn<S>& u, const Turn<S>& v) const {
    const Vec3<S> q = on_unit_sphere(u, v);
    return lift<S>(1.0) /
           norm(Vec3<S>{q.x / lift<S>(semi_axis_x), q.y / lift<S>(semi_axis_y), q.z / lift<S>(semi_axis_z)});
  }
};
Ellipsoid(double, double, double)->Ellipsoid<double>;

}  // namespace darboux
