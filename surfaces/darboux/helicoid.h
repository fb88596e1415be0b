/// \file helicoid.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Right helicoid about the z axis, a minimal surface ruled by horizontal lines.
///   P(u, v) = (s cos x, s sin x, p x),   x = 2π turns u,   s = inner_radius + width v
/// u climbs along the helices, v runs outward along the rulings; s may be negative (the other side of the
/// axis). n = (-p sin x, p cos x, -s) / sqrt(s² + p²). Regular for p ≠ 0. For p = 0 it is the plane swept
/// by a rotating line. Then n is -z where s > 0 and +z where s < 0, and dpdu vanishes on the axis, s = 0.
/// There the frame is the limit from s > 0 (from s < 0 if s = 0 is the outer end, inner_radius + width = 0).
/// Where the line passes both with s and with -s the status is self_intersecting. Frame components err by at
/// most 4u times (1 + condition), u the unit roundoff; the condition is that of x in turns · u and of s
/// where inner_radius and width v cancel. [doCarmo2016, sec. 3-5]
template <class T = double>
struct Helicoid {
  T pitch{0.25}, turns{1}, inner_radius{-0.5}, width{1};

  static constexpr SurfaceInfo info{"helicoid",
                                    "right helicoid about z, u along the helices, v along the rulings",
                                    Coordinate::linear,
                                    Coordinate::linear,
                                    {"pitch = 0 and inner_radius + width v = 0"}};
  static constexpr auto parameters() {
    return std::array{parameter<&Helicoid::pitch>("pitch", Range{}, "rise per radian, a length"),
                      parameter<&Helicoid::turns>("turns", Range::positive(), "number of turns", {1e-3, 1e3}),
                      parameter<&Helicoid::inner_radius>("inner_radius", Range{},
                                                         "signed distance from the axis at v = 0, a length"),
                      parameter<&Helicoid::width>("width", Range::positive(), "length of the rulings")};
  }

  template <class S>
  constexpr Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), p = lift<S>(pitch), s = axis_distance(v), w = lift<S>(width);
    const S rate = two_pi<S>() * lift<S>(turns);  // dx/du
    const Turn<S> x = azimuth(u);
    return {.position = {s * x.cos, s * x.sin, p * (rate * u)},
            .dpdu = {-(rate * (s * x.sin)), rate * (s * x.cos), rate * p},
            .dpdv = {w * x.cos, w * x.sin, zero},
            .d2pdu2 = {-(rate * (rate * (s * x.cos))), -(rate * (rate * (s * x.sin))), zero},
            .d2pduv = {-(rate * (w * x.sin)), rate * (w * x.cos), zero},
            .d2pdv2 = {zero, zero, zero}};
  }

  template <class S>
  constexpr Frame<S> frame(const S& u, const S& v) const {
    const Turn<S> x = azimuth(u);
    Vec2<S> slope = unit(Vec2<S>{axis_distance(v), lift<S>(pitch)});
    if (dot(slope, slope) < lift<S>(0.5)) slope.x = lift<S>(ends_at_axis() ? -1.0 : 1.0);
    const S &s = slope.x, &p = slope.y;
    return {.t = {-(s * x.sin), s * x.cos, p},
            .b = {x.cos, x.sin, lift<S>(0.0)},
            .n = {-(p * x.sin), p * x.cos, -s}};
  }

  template <class S>
  constexpr Status singular(const S&, const S& v) const {
    const S zero = lift<S>(0.0);
    if (!(lift<S>(pitch) == zero)) return Status::regular;
    const S s = axis_distance(v), a = lift<S>(inner_radius), b = a + lift<S>(width);
    if (s == zero) return Status::dpdu_zero;
    const bool twice = a <= -s && -s <= b && lift<S>(0.5) <= lift<S>(turns);
    return twice ? Status::self_intersecting : Status::regular;
  }

  /// (y cos θ - x sin θ) p / sqrt(x² + y² + p²) with θ = z/p; for p = 0 the depth, and beyond the outer
  /// end, which rulings reach from the other side only, the height. That the surface goes on beyond its edges
  /// does not matter here.
  template <class S>
  S implicit(const Vec3<S>& q) const {
    const S p = lift<S>(pitch);
    if (p == lift<S>(0.0)) {
      const S outer = lift<S>(inner_radius) + lift<S>(width);
      return outer < norm(Vec2<S>{q.x, q.y}) ? q.z : -q.z;
    }
    const Turn<S> theta = sincos_turns<S>(q.z / p / two_pi<S>());
    return (q.y * theta.cos - q.x * theta.sin) * (p / norm(Vec3<S>{q.x, q.y, p}));
  }

  /// K = -p²/(s² + p²)²
  template <class S>
  constexpr S gaussian_curvature(const S&, const S& v) const {
    const S p = lift<S>(pitch), d = norm(Vec2<S>{axis_distance(v), p});
    const S k = p / d / d;
    return -(k * k);
  }

  /// H = 0
  template <class S>
  constexpr S mean_curvature(const S&, const S&) const {
    return lift<S>(0.0);
  }

  /// The ruling at u = 0 carried along by the screw motion, which turns it twice by half the angle.
  template <class S>
  constexpr Vec3<S> second_formula(const S& u, const S& v) const {
    const S two = lift<S>(2.0), inner = lift<S>(inner_radius), outer = inner + lift<S>(width);
    const S s = (lift<S>(1.0) - v) * inner + v * outer;
    const Turn<S> half = sincos_half_turns<S>(lift<S>(turns) * u);
    const S rise_per_turn = two_pi<S>() * lift<S>(pitch);
    return {s - two * (s * half.sin * half.sin), two * (s * half.sin * half.cos),
            rise_per_turn * (lift<S>(turns) * u)};
  }

 private:
  template <class S>
  constexpr Turn<S> azimuth(const S& u) const {
    return sincos_turns<S>(lift<S>(turns) * u);
  }
  // s, negative on the other side of the axis
  template <class S>
  constexpr S axis_distance(const S& v) const {
    return lift<S>(inner_radius) + lift<S>(width) * v;
  }
  constexpr bool ends_at_axis() const { return inner_radius + width == T(0); }
};
Helicoid(double, double, double, double)->Helicoid<double>;

}  // namespace darboux
