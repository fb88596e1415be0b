/// \file monkey_saddle.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Monkey saddle over the square [-1, 1]²: three valleys, for two legs and a tail.
///   P(u, v) = (s, t, h (s³ - 3 s t²)),   s = 2u - 1,   t = 2v - 1
/// s and t are lengths. n points up (n_z > 0). Regular everywhere; the centre u = v = 1/2 is a planar point,
/// so an umbilic. Frame components err by at most 4u times (1 + condition), u the unit roundoff, for every
/// height; the condition is that of the slopes 3h (s² - t²) and -6h s t in u and v. [doCarmo2016, sec. 3-3]
template <class T = double>
struct MonkeySaddle {
  T height{1};

  static constexpr SurfaceInfo info{"monkey-saddle", "graph of height (s³ - 3 s t²) over a square",
                                    Coordinate::linear, Coordinate::linear};
  static constexpr auto parameters() {
    return std::array{
        parameter<&MonkeySaddle::height>("height", Range{}, "height at u = 1, v = 1/2, a length")};
  }

  template <class S>
  constexpr Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), two = lift<S>(2.0), three = lift<S>(3.0), h = lift<S>(height);
    const S s = centred(u), t = centred(v), curl = lift<S>(24.0) * h;
    const Vec2<S> rise = slope(u, v);
    return {.position = {s, t, h * (s * (s * s - three * (t * t)))},
            .dpdu = {two, zero, two * rise.x},
            .dpdv = {zero, two, two * rise.y},
            .d2pdu2 = {zero, zero, curl * s},
            .d2pduv = {zero, zero, -(curl * t)},
            .d2pdv2 = {zero, zero, -(curl * s)}};
  }

  template <class S>
  constexpr Frame<S> frame(const S& u, const S& v) const {
    const Vec2<S> rise = slope(u, v);
    const Vec2<S> along{rise.x, lift<S>(1.0)};
    const Vec2<S> a = unit(along), c = unit(Vec2<S>{rise.y, norm(along)});
    return {.t = {a.y, lift<S>(0.0), a.x},
            .b = {-(a.x * c.x), c.y, a.y * c.x},
            .n = {-(a.x * c.y), -c.x, a.y * c.y}};
  }

  /// (z - h x (x² - 3y²)) / sqrt(1 + 9 h² (x² + y²)²), the height above the surface over the length of
  /// its gradient.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S h = lift<S>(height);
    const S three = lift<S>(3.0), one = lift<S>(1.0), xx = p.x * p.x, yy = p.y * p.y;
    return (p.z - h * (p.x * (xx - three * yy))) / norm(Vec2<S>{one, three * (h * (xx + yy))});
  }

  /// K = -36 h² r² / (1 + 9 h² r⁴)², r² = s² + t²
  template <class S>
  constexpr S gaussian_curvature(const S& u, const S& v) const {
    const S s = centred(u), t = centred(v), W = steepness(s, t);
    const S k = lift<S>(6.0) * lift<S>(height) / W / W;
    return -(k * k * (s * s + t * t));
  }

  /// H = -27 h³ r² s (s² - 3t²) / (1 + 9 h² r⁴)^(3/2)
  template <class S>
  constexpr S mean_curvature(const S& u, const S& v) const {
    const S three = lift<S>(3.0), s = centred(u), t = centred(v),
            k = three * lift<S>(height) / steepness(s, t);
    return -(k * k * k * ((s * s + t * t) * (s * (s * s - three * (t * t)))));
  }

 private:
  // s of u, t of v
  template <class S>
  static constexpr S centred(const S& x) {
    return lift<S>(2.0) * x - lift<S>(1.0);
  }
  // dz/ds = 3h (s - t)(s + t) and dz/dt = -6h s t. s + t = 2 (u + v - 1), including the rounding error of u +
  // v.
  template <class S>
  constexpr Vec2<S> slope(const S& u, const S& v) const {
    const S one = lift<S>(1.0), h = lift<S>(height);
    const S sum = u + v, rest = sum - u, lost = (u - (sum - rest)) + (v - rest);
    return {lift<S>(12.0) * h * ((u - v) * ((sum - one) + lost)),
            -(lift<S>(6.0) * h * (centred(u) * centred(v)))};
  }
  // sqrt(1 + 9 h² r⁴), the area over its projection
  template <class S>
  constexpr S steepness(const S& s, const S& t) const {
    return norm(Vec2<S>{lift<S>(1.0), lift<S>(3.0) * lift<S>(height) * (s * s + t * t)});
  }
};
MonkeySaddle(double)->MonkeySaddle<double>;

}  // namespace darboux
