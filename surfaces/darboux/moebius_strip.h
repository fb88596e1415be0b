/// \file moebius_strip.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Möbius strip about the z axis: a segment that makes half a turn while its centre goes round once.
///   P(u, v) = (ρ cos x, ρ sin x, s sin(x/2)),   x = 2πu,   s = width (v - 1/2),   ρ = R + s cos(x/2)
/// u runs round the centre circle in turns, v across the strip. P(u + 1, v) = P(u, 1 - v), and n changes
/// sign there: the strip has one side, the frame two values per point, and u is reduced modulo 2. With the
/// unit vectors e_r, e_t, e_z of cylindrical coordinates and q = sqrt(ρ² + s²/4),
///   n = (ρ sin(x/2) e_r + (s/2) e_t - ρ cos(x/2) e_z) / q,   b = cos(x/2) e_r + sin(x/2) e_z
/// Regular everywhere. Up to width < 4 R the strip is embedded (from 2 R on it crosses the axis); from 4 R on
/// the rulings of x and x + π meet where s cos x = -2 R cos(x/2), and there the status is self_intersecting.
/// Frame components err by at most 4u times (1 + condition), u the unit roundoff, the condition being that of
/// x in u and of ρ where R and s cos(x/2) cancel. [doCarmo2016, sec. 2-6]
template <class T = double>
struct MoebiusStrip {
  T radius{1}, width{0.5};

  static constexpr SurfaceInfo info{.name = "moebius-strip",
                                    .summary = "Möbius strip about z, u along, v across",
                                    .u = Coordinate::twisted_turn,
                                    .v = Coordinate::linear,
                                    .singular = {},
                                    .orientable = false};
  static constexpr auto parameters() {
    return std::array{
        parameter<&MoebiusStrip::radius>("radius", Range::positive(),
                                         "radius of the centre circle, a length"),
        parameter<&MoebiusStrip::width>("width", Range::positive(), "width of the strip, a length")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S zero = lift<S>(0.0), two = lift<S>(2.0), four = lift<S>(4.0), tau = two_pi<S>();
    const S w = lift<S>(width), &k = u.cos, &m = u.sin;
    const S s = across(v), rho = axis_distance(u, s);
    const Turn<S> x = detail::doubled(u);
    return {.position = {rho * x.cos, rho * x.sin, s * m},
            .dpdu = tau * cartesian<S>(x, {-(s * m / two), rho, s * k / two}),
            .dpdv = w * cartesian<S>(x, {k, zero, m}),
            .d2pdu2 = -(tau * (tau * cartesian<S>(x, {s * k / four + rho, s * m, s * m / four}))),
            .d2pduv = tau * (w * cartesian<S>(x, {-(m / two), k, k / two})),
            .d2pdv2 = {zero, zero, zero}};
  }

  template <class S>
  constexpr Frame<S> frame(const Turn<S>& u, const S& v) const {
    const Turn<S> h = detail::normalised(u), x = detail::normalised(detail::doubled(u));
    const S s = across(v), &k = h.cos, &m = h.sin;
    const Vec2<S> tilt = unit(Vec2<S>{s / lift<S>(2.0), axis_distance(u, s)});
    return {.t = cartesian<S>(x, {-(tilt.x * m), tilt.y, tilt.x * k}),
            .b = {k * x.cos, k * x.sin, m},
            .n = cartesian<S>(x, {tilt.y * m, tilt.x, -(tilt.y * k)})};
  }

  template <class S>
  constexpr Status singular(const Turn<S>& u, const S& v) const {
    const S two_r = lift<S>(2.0) * lift<S>(radius), half_width = lift<S>(width) / lift<S>(2.0);
    const S c = detail::doubled(u).cos, zero = lift<S>(0.0);
    const auto reaches = [&](const S& half_cosine) {
      const S need = two_r * half_cosine, have = half_width * c;
      return need * need <= have * have;
    };
    // The double curve of the whole ruled surface, and both of its rulings long enough to reach it.
    const bool meet = across(v) * c + two_r * u.cos == zero && reaches(u.cos) && reaches(u.sin);
    return meet ? Status::self_intersecting : Status::regular;
  }

  /// The distance f from the ruling in the half-plane of the axis through the point, z cos(x/2) - (d - R)
  /// sin(x/2), with d = sqrt(x² + y²) and x the azimuth: the factor that vanishes of the cubic -R² y + x² y +
  /// y³ - 2 R x z - 2 x² z - 2 y² z + y z²; over sqrt(1 + f'²/d²), f' its derivative with respect to the
  /// azimuth. For a strip that crosses the axis (width > 2 R) f may be the distance from the ruling that
  /// comes from the other side, z sin(x/2) - (d + R) cos(x/2), whichever is less.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    using std::abs;
    const S zero = lift<S>(0.0), two = lift<S>(2.0), R = lift<S>(radius), d = norm(Vec2<S>{p.x, p.y});
    // (cos, sin) of half the azimuth, up to a common sign
    const Vec2<S> half = unit(p.x < zero ? Vec2<S>{p.y, d - p.x} : Vec2<S>{d + p.x, p.y});
    const S near = p.z * half.x - (d - R) * half.y, far = p.z * half.y - (d + R) * half.x;
    const bool other = two * R < lift<S>(width) && abs(far) < abs(near);
    const S turned = other ? p.z * half.x + (d + R) * half.y : p.z * half.y + (d - R) * half.x;  // 2 |f'|
    return (other ? far : near) / norm(Vec2<S>{lift<S>(1.0), turned / (two * d)});
  }

  /// K = -R²/(4 q⁴)
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>& u, const S& v) const {
    const S two = lift<S>(2.0), s = across(v), q = norm(Vec2<S>{axis_distance(u, s), s / two});
    const S k = lift<S>(radius) / q / q / two;
    return -(k * k);
  }

  /// H = -sin(x/2) (ρ² + s²/2) / (2 q³)
  template <class S>
  constexpr S mean_curvature(const Turn<S>& u, const S& v) const {
    const S two = lift<S>(2.0), s = across(v), rho = axis_distance(u, s), q = norm(Vec2<S>{rho, s / two});
    const S a = rho / q, c = s / q;
    return -(u.sin * (a * a + c * c / two) / (two * q));
  }

 private:
  // s
  template <class S>
  constexpr S across(const S& v) const {
    return lift<S>(width) * (v - lift<S>(0.5));
  }
  // ρ, negative beyond the axis
  template <class S>
  constexpr S axis_distance(const Turn<S>& u, const S& s) const {
    return lift<S>(radius) + s * u.cos;
  }
  // a.x e_r + a.y e_t + a.z e_z
  template <class S>
  static constexpr Vec3<S> cartesian(const Turn<S>& x, const Vec3<S>& a) {
    return {a.x * x.cos - a.y * x.sin, a.x * x.sin + a.y * x.cos, a.z};
  }
};
MoebiusStrip(double, double)->MoebiusStrip<double>;

}  // namespace darboux
