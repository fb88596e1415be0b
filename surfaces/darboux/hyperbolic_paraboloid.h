/// \file hyperbolic_paraboloid.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Hyperbolic paraboloid, the saddle z/h = (x/a)² - (y/b)² over a rectangle.
///   P(u, v) = (a s, b t, h (s² - t²)),   s = 2u - 1, t = 2v - 1
/// u runs along x from -a to a, v along y from -b to b. The saddle rises along x and falls along y.
///   n = unit(-2 h s / a, 2 h t / b, 1)
/// points up. Regular everywhere; not orthogonal. Frame components err by at most 4u, partials by at most 8u
/// of their scale, u the unit roundoff, for all sizes, also very different ones. [doCarmo2016, sec. 2-2]
template <class T = double>
struct HyperbolicParaboloid {
  T semi_axis_x{1}, semi_axis_y{1}, height{1};

  static constexpr SurfaceInfo info{"hyperbolic-paraboloid", "saddle, rising along x and falling along y",
                                    Coordinate::linear, Coordinate::linear};
  static constexpr auto parameters() {
    using X = HyperbolicParaboloid;
    return std::array{parameter<&X::semi_axis_x>("semi_axis_x", Range::positive(), "half the length along x"),
                      parameter<&X::semi_axis_y>("semi_axis_y", Range::positive(), "half the length along y"),
                      parameter<&X::height>("height", Range::positive(),
                                            "height of the saddle at x = ±a, y = 0, a length")};
  }

  template <class S>
  constexpr Jet2<S> jet(const S& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), h = lift<S>(height), zero = lift<S>(0.0);
    const S two = lift<S>(2.0), four = lift<S>(4.0), eight = lift<S>(8.0);
    const auto [s, t] = centred(u, v);
    return {.position = {a * s, b * t, h * ((s - t) * (s + t))},
            .dpdu = {two * a, zero, four * (h * s)},
            .dpdv = {zero, two * b, -(four * (h * t))},
            .d2pdu2 = {zero, zero, eight * h},
            .d2pduv = {zero, zero, zero},
            .d2pdv2 = {zero, zero, -(eight * h)}};
  }

  template <class S>
  Frame<S> frame(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    const Vec2<S> slope = gradient(u, v), along_u = unit(Vec2<S>{one, slope.x});
    const Vec3<S> t{along_u.x, zero, along_u.y}, n = unit(Vec3<S>{-slope.x, -slope.y, one});
    return {.t = t, .b = unit(cross(n, t)), .n = n};  // nothing cancels: nz tx and -nx tz have one sign
  }

  /// f / |grad f| with f = z - h ((x/a)² - (y/b)²): to first order the distance, positive above.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), h = lift<S>(height), two = lift<S>(2.0);
    const Vec2<S> q{p.x / a, p.y / b};
    return (p.z - h * (q.x * q.x - q.y * q.y)) /
           norm(Vec3<S>{two * ((h / a) * q.x), two * ((h / b) * q.y), lift<S>(1.0)});
  }

  /// K = fxx fyy / W⁴ of the graph z = f(x, y), W² = 1 + fx² + fy². [doCarmo2016, sec. 3-3]
  template <class S>
  S gaussian_curvature(const S& u, const S& v) const {
    const S h = lift<S>(height), W = stretch(u, v);
    const S root = lift<S>(2.0) * ((h / lift<S>(semi_axis_x)) / W / lift<S>(semi_axis_y) / W);
    return -(root * root);
  }

  /// H = ((1 + fy²) fxx + (1 + fx²) fyy) / (2 W³) of the same graph, as
  /// h ((b² - a²) + 4 h² (t² - s²)) / (a² b² W³). [doCarmo2016, sec. 3-3]
  template <class S>
  S mean_curvature(const S& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), h = lift<S>(height), two = lift<S>(2.0);
    const auto [s, t] = centred(u, v);
    const S least = a < b ? a : b, most = a < b ? b : a, W = stretch(u, v);
    const S bend = (h / least) / W / least / W;
    const S of_axes = (b - a) / most * bend * ((b + a) / most / W);
    const S of_place = two * (h / most) * (t - s) * bend * (two * (h / most) * (t + s) / W);
    return of_axes + of_place;
  }

  /// Between the ends -a and a, -b and b; the height by s² = 1 - 4u (1 - u), t² = 1 - 4v (1 - v).
  template <class S>
  constexpr Vec3<S> second_formula(const S& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), one = lift<S>(1.0), ru = one - u,
            rv = one - v;
    return {u * a - ru * a, v * b - rv * b, lift<S>(4.0) * (lift<S>(height) * (v * rv - u * ru))};
  }

 private:
  template <class S>
  static constexpr Vec2<S> centred(const S& u, const S& v) {
    return {(u + u) - lift<S>(1.0), (v + v) - lift<S>(1.0)};
  }
  // (∂z/∂x, ∂z/∂y)
  template <class S>
  constexpr Vec2<S> gradient(const S& u, const S& v) const {
    const S h = lift<S>(height), two = lift<S>(2.0);
    const auto [s, t] = centred(u, v);
    return {two * (h / lift<S>(semi_axis_x) * s), -(two * (h / lift<S>(semi_axis_y) * t))};
  }
  template <class S>
  S stretch(const S& u, const S& v) const {
    const Vec2<S> slope = gradient(u, v);
    return norm(Vec3<S>{slope.x, slope.y, lift<S>(1.0)});
  }
};
HyperbolicParaboloid(double, double, double)->HyperbolicParaboloid<double>;

}  // namespace darboux
