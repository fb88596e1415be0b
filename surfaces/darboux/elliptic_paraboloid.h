/// \file elliptic_paraboloid.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Elliptic paraboloid, a cup about the z axis with its tip at the origin: z/h = (x/a)² + (y/b)².
///   P(u, v) = (a v cos 2πu, b v sin 2πu, h v²)
/// u runs round the axis in turns (counter-clockwise from +x), v from the tip (0) to the rim (1) at height h.
///   n = unit(2 h v cos 2πu / a, 2 h v sin 2πu / b, -1),   t = unit(-a sin 2πu, b cos 2πu, 0)
/// n points down and out of the cup. The chart is singular at the tip, where dpdu vanishes; there the frame
/// is the limit along the curve of the given u: t as above, n = (0, 0, -1). Frame components err by at most
/// 4u, partials by at most 8u of their scale, u the unit roundoff, for all sizes, also very different ones.
/// [doCarmo2016, sec. 2-2]
template <class T = double>
struct EllipticParaboloid {
  T semi_axis_x{1}, semi_axis_y{1}, height{1};

  static constexpr SurfaceInfo info{"elliptic-paraboloid",
                                    "elliptic cup about z, v from tip to rim",
                                    Coordinate::turn,
                                    Coordinate::linear,
                                    {"v=0"}};
  static constexpr auto parameters() {
    using X = EllipticParaboloid;
    return std::array{
        parameter<&X::semi_axis_x>("semi_axis_x", Range::positive(), "half the length of the rim along x"),
        parameter<&X::semi_axis_y>("semi_axis_y", Range::positive(), "half the length of the rim along y"),
        parameter<&X::height>("height", Range::positive(), "height of the rim above the tip, a length")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), h = lift<S>(height), zero = lift<S>(0.0);
    const S tau = two_pi<S>(), two = lift<S>(2.0);
    const S x = a * v, y = b * v;  // semi-axes of the section at v
    return {.position = {x * u.cos, y * u.sin, h * (v * v)},
            .dpdu = {-(tau * (x * u.sin)), tau * (y * u.cos), zero},
            .dpdv = {a * u.cos, b * u.sin, two * (h * v)},
            .d2pdu2 = {-(tau * (tau * (x * u.cos))), -(tau * (tau * (y * u.sin))), zero},
            .d2pduv = {-(tau * (a * u.sin)), tau * (b * u.cos), zero},
            .d2pdv2 = {zero, zero, two * h}};
  }

  template <class S>
  Frame<S> frame(const Turn<S>& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), zero = lift<S>(0.0);
    const Vec2<S> along_u = unit(Vec2<S>{-(a * u.sin), b * u.cos}), slope = gradient(u, v);
    const Vec3<S> t{along_u.x, along_u.y, zero}, n = unit(Vec3<S>{slope.x, slope.y, -lift<S>(1.0)});
    return {.t = t, .b = unit(cross(n, t)), .n = n};  // nothing cancels: nx ty and -ny tx have one sign
  }

  template <class S>
  constexpr Status singular(const Turn<S>&, const S& v) const {
    return v == lift<S>(0.0) ? Status::dpdu_zero : Status::regular;
  }

  /// f / |grad f| with f = h ((x/a)² + (y/b)²) - z: to first order the distance, positive below and
  /// outside.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), h = lift<S>(height), two = lift<S>(2.0);
    const Vec2<S> q{p.x / a, p.y / b};
    return (h * dot(q, q) - p.z) / norm(Vec3<S>{two * ((h / a) * q.x), two * ((h / b) * q.y), lift<S>(1.0)});
  }

  /// K = fxx fyy / W⁴ of the graph z = f(x, y), W² = 1 + fx² + fy². [doCarmo2016, sec. 3-3]
  template <class S>
  S gaussian_curvature(const Turn<S>& u, const S& v) const {
    const S h = lift<S>(height), W = stretch(u, v);
    const S root = lift<S>(2.0) * ((h / lift<S>(semi_axis_x)) / W / lift<S>(semi_axis_y) / W);
    return root * root;
  }

  /// H = -((1 + fy²) fxx + (1 + fx²) fyy) / (2 W³) of the same graph, n below it. [doCarmo2016, sec. 3-3]
  template <class S>
  S mean_curvature(const Turn<S>& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), h = lift<S>(height), one = lift<S>(1.0);
    const Vec2<S> slope = gradient(u, v);
    const S W = stretch(u, v), p = norm(Vec2<S>{one, slope.x}) / W, q = norm(Vec2<S>{one, slope.y}) / W;
    return -((h / a) / W / a * q * q + (h / b) / W / b * p * p);
  }

 private:
  // (∂z/∂x, ∂z/∂y)
  template <class S>
  constexpr Vec2<S> gradient(const Turn<S>& u, const S& v) const {
    const S h = lift<S>(height), two_v = v + v;
    return {(h / lift<S>(semi_axis_x)) * two_v * u.cos, (h / lift<S>(semi_axis_y)) * two_v * u.sin};
  }
  template <class S>
  S stretch(const Turn<S>& u, const S& v) const {
    const Vec2<S> slope = gradient(u, v);
    return norm(Vec3<S>{slope.x, slope.y, lift<S>(1.0)});
  }
};
EllipticParaboloid(double, double, double)->EllipticParaboloid<double>;

}  // namespace darboux
