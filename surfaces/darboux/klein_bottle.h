/// \file klein_bottle.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Klein bottle as an immersion: a figure 8 that makes half a turn while its centre goes round the z axis
/// once.
///   P(u, v) = (ρ cos x, ρ sin x, z),   x = 2πu,   y = 2πv
///   ρ = R + r (cos(x/2) sin y - sin(x/2) sin 2y),   z = r (sin(x/2) sin y + cos(x/2) sin 2y)
/// u runs round the axis, v along the figure 8, both in turns. P(u + 1, v) = P(u, 1 - v), and n changes
/// sign there: the surface has one side, the frame two values per point, and u is reduced modulo 2. v = 0 and
/// v = 1/2 are one circle, the double points of the figures: self_intersecting. For R <= 1.25 r the figures
/// reach the axis; where ρ <= 0 the status is self_intersecting too. Regular except at points of the axis
/// where the figure is at an extreme distance from its centre, ρ = 0 and (1 + 4 cos 2y) sin 2y = 0: there
/// dpdu and dpdv are parallel, and the limit of n depends on the direction; no_frame. For R = r these points
/// only touch the axis, and the frame is the limit along the given v. With the unit tangent τ of the figure,
/// its normal ν in the half-plane of the axis, e_t = (-sin x, cos x, 0):
///   n = (2ρ ν + f e_t) / sqrt(4ρ² + f²),   f = r sin 2y (1 + 4 cos 2y) / (2 g),
///     g = sqrt(cos² y + 4 cos² 2y)
/// Frame components err by at most 4u times (1 + condition), u the unit roundoff, the condition being that of
/// x and y in u and v and of ρ where it cancels. [Gray2006]
template <class T = double>
struct KleinBottle {
  T radius{2}, tube_radius{T(0.7)};

  static constexpr SurfaceInfo info{
      .name = "klein-bottle",
      .summary = "Klein bottle, a figure 8 making half a turn round z",
      .u = Coordinate::twisted_turn,
      .v = Coordinate::turn,
      .singular =
          {"where the tube touches the axis at an extreme of the figure 8 (radius <= 1.25 tube_radius)"},
      .orientable = false,
      .euler_characteristic = 0};
  static constexpr auto parameters() {
    return std::array{
        parameter<&KleinBottle::radius>("radius", Range::positive(),
                                        "distance of the figure's centre from the axis, a length"),
        parameter<&KleinBottle::tube_radius>("tube_radius", Range::positive(),
                                             "half the width of the figure 8, a length")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const Turn<S>& v) const {
    const S zero = lift<S>(0.0), two = lift<S>(2.0), four = lift<S>(4.0), half = pi<S>(), tau = two_pi<S>();
    const S R = lift<S>(radius), r = lift<S>(tube_radius);
    const Turn<S> x = detail::doubled(u), y2 = detail::doubled(v);
    // The figure and its derivatives with respect to y, turned by x/2: x away from the axis, y up.
    const Vec2<S> p = r * turned<S>(u, {v.sin, y2.sin}), dp = r * turned<S>(u, {v.cos, two * y2.cos}),
                  d2p = r * turned<S>(u, {-v.sin, -(four * y2.sin)});
    const S rho = R + p.x;
    return {.position = {rho * x.cos, rho * x.sin, p.y},
            .dpdu = half * cartesian<S>(x, {-p.y, two * rho, p.x}),
            .dpdv = tau * cartesian<S>(x, {dp.x, zero, dp.y}),
            .d2pdu2 = -(half * (half * cartesian<S>(x, {p.x + four * rho, four * p.y, p.y}))),
            .d2pduv = half * (tau * cartesian<S>(x, {-dp.y, two * dp.x, dp.x})),
            .d2pdv2 = tau * (tau * cartesian<S>(x, {d2p.x, zero, d2p.y}))};
  }

  template <class S>
  constexpr Frame<S> frame(const Turn<S>& u, const Turn<S>& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), two = lift<S>(2.0), r = lift<S>(tube_radius);
    const Turn<S> x = detail::normalised(detail::doubled(u));
    const S rho = axis_distance(u, v), g = speed(v);
    const Vec2<S> along = unit(turned<S>(u, {v.cos, two * detail::doubled(v).cos}));  // τ
    const Vec2<S> across{radial(v), two * rho};
    Vec2<S> a = unit(across);  // n = a.x e_t + a.y ν
    Status status = Status::regular;
    if (dot(a, a) < lift<S>(0.5)) {
      if (radius < tube_radius || tube_radius < radius) {
        a = a / zero;
        status = Status::no_frame;
      } else {
        a.y = one;
      }
    }
    // t = c.x τ + c.y (a.y e_t - a.x ν)
    const Vec2<S> c = unit(Vec2<S>{-(two * (r * (v.sin * v.sin * v.sin / g))), norm(across)});
    const Vec2<S>&k = along, normal{k.y, -k.x};
    const S d = a.x * c.y, e = a.x * c.x;
    return {
        .t = cartesian<S>(x, unit(Vec3<S>{c.x * k.x - d * normal.x, a.y * c.y, c.x * k.y - d * normal.y})),
        .b = cartesian<S>(x, unit(Vec3<S>{c.y * k.x + e * normal.x, -(a.y * c.x), c.y * k.y + e * normal.y})),
        .n = cartesian<S>(x, unit(Vec3<S>{a.y * normal.x, a.x, a.y * normal.y})),
        .handedness = one,
        .status = status};
  }

  template <class S>
  constexpr Status singular(const Turn<S>& u, const Turn<S>& v) const {
    const S zero = lift<S>(0.0), rho = axis_distance(u, v);
    Status result = v.sin == zero || rho <= zero ? Status::self_intersecting : Status::regular;
    if (rho == zero && radial(v) == zero) result |= Status::parallel;
    return result;
  }

  /// f / |grad f| with f = b² - 4 a² (1 - a²), Gerono's equation of the figure 8, in which r (a, b) is the
  /// point in the half-plane of the axis turned back by half its azimuth; 0 on the double circle, where the
  /// gradient vanishes too. If the figures cross the axis (R < 1.25 r), the value for the figure of the other
  /// side is taken where that is nearer.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    using std::abs;
    const S zero = lift<S>(0.0), R = lift<S>(radius), r = lift<S>(tube_radius), d = norm(Vec2<S>{p.x, p.y});
    const Vec2<S> half = unit(p.x < zero ? Vec2<S>{p.y, d - p.x} : Vec2<S>{d + p.x, p.y});
    const Vec2<S> outer{(d - R) / r, p.z / r}, inner{-((d + R) / r), p.z / r};
    const S near =
        r * gerono<S>({half.x * outer.x + half.y * outer.y, half.x * outer.y - half.y * outer.x}, d / r);
    const S far =
        r * gerono<S>({half.x * inner.y - half.y * inner.x, -(half.x * inner.x + half.y * inner.y)}, d / r);
    return lift<S>(4.0) * R < lift<S>(5.0) * r && abs(far) < abs(near) ? far : near;
  }

  /// K from the invariants of the figure, not from the jet: with primes for d/dy, (a, b) = (sin y, sin 2y)
  /// the figure over r, and z' for its derivative upwards, ρ' away from the axis, over r,
  ///   p = a b' - b a',  f = a a' + b b',  g² = a'² + b'²,  c = b' a'' - a' b'',  W = 4ρ² g² + r² f²
  ///   K = -((2 r ρ p + 8 ρ² z' + 4 r z f) 2 ρ c / r + (2 r p z' + 2 R g²)²) / W²
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>& u, const Turn<S>& v) const {
    const S two = lift<S>(2.0), four = lift<S>(4.0), eight = lift<S>(8.0);
    const S size = lift<S>(radius) + lift<S>(tube_radius), r = lift<S>(tube_radius) / size;
    const S rho = axis_distance(u, v) / size, &s = v.sin, &c = v.cos;
    const S cos2 = c * c - s * s, sin2 = two * s * c;
    const S z = r * turned<S>(u, {s, sin2}).y;
    const Vec2<S> slope = turned<S>(u, {c, two * cos2});
    const S p = -(two * s * s * s), f = sin2 * (lift<S>(0.5) + two * cos2), g2 = c * c + four * cos2 * cos2;
    const S bend = four * c * sin2 - two * s * cos2;
    const S W = four * rho * rho * g2 + r * f * r * f;
    const S M = -(two * (r * p * slope.y + lift<S>(radius) / size * g2));
    const S L = two * r * rho * p + eight * rho * rho * slope.y + four * r * z * f;
    return -((L / W) * (two * rho * bend / W) / r + (M / W) * (M / W)) / size / size;
  }

  /// The figure 8 drawn in the plane y = 0, turned about the y axis by half the azimuth, shifted by R along
  /// x, turned about the z axis twice by half the azimuth.
  template <class S>
  constexpr Vec3<S> second_formula(const Turn<S>& u, const Turn<S>& v) const {
    const S zero = lift<S>(0.0), r = lift<S>(tube_radius);
    const S a = r * v.sin, b = lift<S>(2.0) * (a * v.cos);
    Vec3<S> p{u.cos * a - u.sin * b + lift<S>(radius), zero, u.sin * a + u.cos * b};
    for (int i = 0; i < 2; ++i) p = {u.cos * p.x - u.sin * p.y, u.sin * p.x + u.cos * p.y, p.z};
    return p;
  }

 private:
  // ρ, negative beyond the axis. Where the figure points at it R - r and 1 + cos(x/2) sin y, whose product
  // with 1 - cos(x/2) sin y is sin²(x/2) + cos²(x/2) cos² y, keep their digits, R + r cos(x/2) sin y does
  // not.
  template <class S>
  constexpr S axis_distance(const Turn<S>& u, const Turn<S>& v) const {
    const S one = lift<S>(1.0), R = lift<S>(radius), r = lift<S>(tube_radius);
    const S inward = -(u.cos * v.sin), sideways = u.sin * detail::doubled(v).sin, c = u.cos * v.cos;
    return select(inward < lift<S>(0.5), S(R + r * (-inward - sideways)),
                  S((R - r) + r * ((u.sin * u.sin + c * c) / (one + inward) - sideways)));
  }
  // f: half the derivative of the squared distance from the figure's centre along its length, over r
  template <class S>
  constexpr S radial(const Turn<S>& v) const {
    const Turn<S> y2 = detail::doubled(v);
    return lift<S>(tube_radius) * (y2.sin * (lift<S>(0.5) + lift<S>(2.0) * y2.cos) / speed(v));
  }
  // g: the length of the figure's tangent over r
  template <class S>
  static constexpr S speed(const Turn<S>& v) {
    using std::sqrt;
    const S c2 = lift<S>(2.0) * detail::doubled(v).cos;
    return sqrt(S(v.cos * v.cos + c2 * c2));
  }
  // a, turned
  template <class S>
  static constexpr Vec2<S> turned(const Turn<S>& by, const Vec2<S>& a) {
    return {by.cos * a.x - by.sin * a.y, by.sin * a.x + by.cos * a.y};
  }
  // a.x e_r + a.y e_t + a.z e_z
  template <class S>
  static constexpr Vec3<S> cartesian(const Turn<S>& x, const Vec3<S>& a) {
    return {a.x * x.cos - a.y * x.sin, a.x * x.sin + a.y * x.cos, a.z};
  }
  // f / |grad f| at (a, b), at the distance d from the axis, all over r. Divided by the size of (1, a, b) to
  // the fourth, the third power: far away nothing overflows.
  template <class S>
  static S gerono(const Vec2<S>& q, const S& d) {
    using std::abs;
    const S zero = lift<S>(0.0), one = lift<S>(1.0), two = lift<S>(2.0), four = lift<S>(4.0);
    const S size = one + S(abs(q.x)) + S(abs(q.y)), a = q.x / size, b = q.y / size, i = one / size;
    const S f = i * i * (b * b - four * a * a) + four * (a * a) * (a * a);
    const S fa = four * (four * (a * a) * a - two * (i * i * a)), fb = two * (i * i * b);
    // The figure turns back by half the azimuth.
    const S gradient = norm(Vec3<S>{fa, fb, (fa * q.y - fb * q.x) / (two * d)});
    return gradient == zero ? zero : S(size * (f / gradient));
  }
};
KleinBottle(double, double)->KleinBottle<double>;

}  // namespace darboux
