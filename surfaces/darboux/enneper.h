/// \file enneper.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Enneper's minimal surface, a conformal image of a square.
///   P(u, v) = scale (s - s³/3 + s t², t - t³/3 + t s², s² - t²),   s = extent (2u - 1),
///     t = extent (2v - 1)
/// n = (-2s, 2t, 1 - s² - t²) / (1 + s² + t²), +z at the centre. Regular everywhere; dpdu and dpdv are
/// orthogonal and of equal length. The points (s, t) and (-s, t) with s² = 3 + 3t² coincide, and so do (s,
/// t) and (s, -t) with t² = 3 + 3s². On these curves and beyond them the status is self_intersecting; they
/// are reached if extent >= sqrt 3. Frame components err by at most 4u times (1 + condition), u the
/// unit roundoff, the condition being that of s and t in extent, u, v. [doCarmo2016, sec. 3-5]
template <class T = double>
struct Enneper {
  T extent{1}, scale{1};

  static constexpr SurfaceInfo info{"enneper", "Enneper's minimal surface", Coordinate::linear,
                                    Coordinate::linear};
  static constexpr auto parameters() {
    return std::array{
        parameter<&Enneper::extent>("extent", Range::positive(),
                                    "half the side of the square of (s, t), a number", {1e-6, 1e6}),
        parameter<&Enneper::scale>("scale", Range::positive(), "factor that makes it a length")};
  }

  template <class S>
  constexpr Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), two = lift<S>(2.0), three = lift<S>(3.0);
    const S s = centred(u), t = centred(v), ss = s * s, tt = t * t, a = lift<S>(scale);
    const S first = two * lift<S>(extent) * a;                // ds/du, dt/dv, and the size
    const S second = lift<S>(4.0) * lift<S>(extent) * first;  // 2 (ds/du)², and the size
    return {.position = {a * (s * (one - ss / three + tt)), a * (t * (one - tt / three + ss)),
                         a * ((s - t) * (s + t))},
            .dpdu = {first * (one - ss + tt), first * (two * (s * t)), first * (two * s)},
            .dpdv = {first * (two * (s * t)), first * (one - tt + ss), -(first * (two * t))},
            .d2pdu2 = {-(second * s), second * t, second},
            .d2pduv = {second * t, second * s, zero},
            .d2pdv2 = {second * s, -(second * t), -second}};
  }

  template <class S>
  constexpr Frame<S> frame(const S& u, const S& v) const {
    const S one = lift<S>(1.0), two = lift<S>(2.0), s = centred(u), t = centred(v), ss = s * s, tt = t * t;
    const S length = one + (ss + tt), mixed = two * (s * t) / length;
    return {.t = {(one - ss + tt) / length, mixed, two * s / length},
            .b = {mixed, (one - tt + ss) / length, -(two * t / length)},
            .n = {-(two * s / length), two * t / length, (one - (ss + tt)) / length}};
  }

  template <class S>
  constexpr Status singular(const S& u, const S& v) const {
    const S three = lift<S>(3.0), s = centred(u), t = centred(v), ss = s * s, tt = t * t;
    return ss >= three + three * tt || tt >= three + three * ss ? Status::self_intersecting : Status::regular;
  }

  /// K = -4 / (scale² (1 + s² + t²)⁴)
  template <class S>
  constexpr S gaussian_curvature(const S& u, const S& v) const {
    const S s = centred(u), t = centred(v), length = lift<S>(1.0) + (s * s + t * t);
    const S k = lift<S>(2.0) / lift<S>(scale) / length / length;
    return -(k * k);
  }

  /// H = 0
  template <class S>
  constexpr S mean_curvature(const S&, const S&) const {
    return lift<S>(0.0);
  }

  /// Weierstrass' representation: with ζ = s + i t, scale (Re(ζ - ζ³/3), Im(ζ + ζ³/3), Re ζ²).
  template <class S>
  constexpr Vec3<S> second_formula(const S& u, const S& v) const {
    const S a = lift<S>(scale), e = lift<S>(extent), one = lift<S>(1.0), three = lift<S>(3.0);
    const Vec2<S> z{u * e - (one - u) * e, v * e - (one - v) * e};  // between its ends -e and e
    const auto times = [](const Vec2<S>& p, const Vec2<S>& q) {
      return Vec2<S>{p.x * q.x - p.y * q.y, p.x * q.y + p.y * q.x};
    };
    const Vec2<S> square = times(z, z), cube = times(square, z);
    return {a * (z.x - cube.x / three), a * (z.y + cube.y / three), a * square.x};
  }

 private:
  // s of u, t of v
  template <class S>
  constexpr S centred(const S& x) const {
    return lift<S>(extent) * (lift<S>(2.0) * x - lift<S>(1.0));
  }
};
Enneper(double, double)->Enneper<double>;

}  // namespace darboux
