/// \file superellipsoid.h
#pragma once

#include <vector>

#include <darboux/surface.h>

namespace darboux {

/// Superellipsoid about the origin: an ellipsoid whose meridians and parallels are superellipses.
///   P(u, v) = (a f(sin πv; e1) f(C; e2), b f(sin πv; e1) f(S; e2), -c f(cos πv; e1)),
///     f(x; e) = sgn(x) |x|^e
/// with C, S = cos 2πu, sin 2πu and e1 = exponent_v, e2 = exponent_u: 1 an ellipsoid, towards 0 a box, 2 an
/// octahedron, beyond 2 a star. u runs round the z axis in turns, v from the south pole (0) to the north (1).
/// n points outward,
///   t ∝ (-a f(S; 2 - e2), b f(C; 2 - e2), 0),
///   n ∝ (|sin πv|^(2 - e1) f(C; 2 - e2) / a, |sin πv|^(2 - e1) f(S; 2 - e2) / b, -f(cos πv; 2 - e1) / c)
/// For exponents below 2 this frame is continuous everywhere, except t at the poles, whatever the partials
/// do:
///   poles v = 0, 1: dpdu_zero; the frame is the limit along the meridian of the given u
///   e1 > 1: dpdv_zero at the poles and at the equator cos πv = 0; e1 < 1: dpdv is infinite there (overflow)
///   e2 > 1: dpdu_zero where C or S is 0; e2 < 1: dpdu is infinite there (overflow)
///   e1 >= 2 (e2 >= 2): the equator (the meridians C = 0, S = 0) is an edge, and the status says crease: the
///   frame is the limit from the side where the cosine (sine) is positive
/// All of these frames are limits (limit_frame). Second partials may be infinite there for any exponent
/// but 1. On a meridian C = 0 or S = 0 limits are taken along v first. Frame components err by at most 8u
/// times (1 + condition), u the unit roundoff, for exponents up to 1.75. Unlike other formulas it uses
/// the signs of sines and cosines. [Barr1981]
template <class T = double>
struct Superellipsoid {
  T semi_axis_x{1}, semi_axis_y{1}, semi_axis_z{1}, exponent_v{0.5}, exponent_u{0.5};

  static constexpr SurfaceInfo info{
      "superellipsoid",
      "superellipsoid about the origin, v from pole to pole",
      Coordinate::turn,
      Coordinate::half_turn,
      {"v=0", "v=1", "v=1/2 unless exponent_v = 1", "u=0, 1/4, 1/2, 3/4 unless exponent_u = 1"},
      /* orientable */ true,
      /* euler_characteristic */ std::nullopt,
      /* own_orientation */ false,
      /* frame_error */ 8};
  static constexpr auto parameters() {
    return std::array{
        parameter<&Superellipsoid::semi_axis_x>("semi_axis_x", Range::positive(),
                                                "semi-axis along x, a length"),
        parameter<&Superellipsoid::semi_axis_y>("semi_axis_y", Range::positive(),
                                                "semi-axis along y, a length"),
        parameter<&Superellipsoid::semi_axis_z>("semi_axis_z", Range::positive(),
                                                "semi-axis along z, a length"),
        parameter<&Superellipsoid::exponent_v>("exponent_v", Range::positive(),
                                               "exponent of the meridians, a number", {0.1, 1.75}),
        parameter<&Superellipsoid::exponent_u>("exponent_u", Range::positive(),
                                               "exponent of the parallels, a number", {0.1, 1.75})};
  }

  /// The meridians, the poles and the equator, where a power with an exponent other than 1 is not smooth.
  std::vector<double> breaks(int along) const {
    if (along == 0)
      return exponent_u == T(1) ? std::vector<double>{} : std::vector<double>{0, 0.25, 0.5, 0.75};
    return exponent_v == T(1) ? std::vector<double>{} : std::vector<double>{0, 0.5};
  }

  template <class S>
  Jet2<S> jet(const Turn<S>& u, const Turn<S>& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z), zero = lift<S>(0.0);
    const Power<S> rho(v.sin, v.cos, pi<S>(), exponent_v);  // distance from the axis
    const Power<S> z(v.cos, -v.sin, pi<S>(), exponent_v);   // height, downwards
    const Power<S> x(u.cos, -u.sin, two_pi<S>(), exponent_u), y(u.sin, u.cos, two_pi<S>(), exponent_u);
    const auto product = [](const S& known, const S& p, const S& q) { return known * times(p, q); };
    return {.position = {a * (rho.value * x.value), b * (rho.value * y.value), -(c * z.value)},
            .dpdu = {product(a, rho.value, x.first), product(b, rho.value, y.first), zero},
            .dpdv = {product(a, x.value, rho.first), product(b, y.value, rho.first), -(c * z.first)},
            .d2pdu2 = {a * second_times(rho, x), b * second_times(rho, y), zero},
            .d2pduv = {a * (rho.first * x.first), b * (rho.first * y.first), zero},
            .d2pdv2 = {a * second_times(x, rho), b * second_times(y, rho), -(c * z.second)}};
  }

  template <class S>
  Frame<S> frame(const Turn<S>& u, const Turn<S>& v) const {
    const S zero = lift<S>(0.0), a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z);
    const Weights<S> round(u.cos, u.sin, exponent_u), up(v.sin, v.cos, exponent_v);
    const S &x = round.first, &y = round.second;
    const Vec2<S> along = unit(Vec2<S>{y * (y * a), x * (x * b)});
    const S tx = -(sign(u.sin) * along.x), ty = sign(u.cos) * along.y;
    // The normal's parts away from the axis and along it, each a square.
    const S flat = norm(Vec2<S>{x * (x / a), y * (y / b)}), steep = up.second * round.common;
    Vec2<S> parts = unit(Vec2<S>{up.first * (up.first * flat), steep * (steep / c)});
    const auto nothing = dot(parts, parts) < lift<S>(0.5);
    parts = {select(nothing, lift<S>(1.0), parts.x), select(nothing, zero, parts.y)};
    const S out = sign(v.sin) * parts.x, height = -(sign(v.cos) * parts.y);
    Frame<S> result{
        .t = {tx, ty, zero}, .b = {-(height * ty), height * tx, out}, .n = {out * ty, -(out * tx), height}};
    if (singular(u, v) != Status::regular) result.status = Status::limit_frame;
    return result;
  }

  template <class S>
  Status singular(const Turn<S>& u, const Turn<S>& v) const {
    const bool pole = is_zero(v.sin), equator = is_zero(v.cos), axis = is_zero(u.cos) || is_zero(u.sin);
    const T one{1}, two{2};
    Status result = Status::regular;
    if (pole || (axis && exponent_u > one)) result |= Status::dpdu_zero;
    if ((pole || equator) && exponent_v > one) result |= Status::dpdv_zero;
    if ((axis && !pole && exponent_u < one) || ((pole || equator) && exponent_v < one))
      result |= Status::overflow;
    if ((axis && exponent_u >= two) || (equator && exponent_v >= two)) result |= Status::crease;
    return result;
  }

  /// (G(p) - 1) / |grad G|, where p / G(p) is the point of the surface in the direction of p; at the centre
  /// minus the least semi-axis:
  ///   G = ((|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1))^(e1/2)
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z), one = lift<S>(1.0);
    const Vec3<S> q{p.x / a, p.y / b, p.z / c};
    const S round = gauge<S>(q.x, q.y, exponent_u), G = gauge<S>(round, q.z, exponent_v);
    if (is_zero(G)) return -(a < b ? (a < c ? a : c) : (b < c ? b : c));
    // ∂g/∂x of g = gauge(x, y; e)
    const auto slope = [](const S& x, const S& g, const T& e) {
      using std::abs;
      return is_zero(g) ? g : sign(x) * power(S(abs(x) / g), T(T(2) / e - T(1)));
    };
    const S radial = slope(round, G, exponent_v);
    return (G - one) /
           norm(Vec3<S>{radial * slope(q.x, round, exponent_u) / a,
                        radial * slope(q.y, round, exponent_u) / b, slope(q.z, G, exponent_v) / c});
  }

 private:
  template <class S>
  static S sign(const S& x) {
    const S one = lift<S>(1.0);
    return select(x < lift<S>(0.0), S(-one), one);
  }
  template <class S>
  static bool is_zero(const S& x) {
    using detail::all_zero;
    return all_zero(x);
  }
  template <class S>
  static S abs_of(const S& x) {
    using std::abs;
    return abs(x);
  }
  // x^e, x >= 0
  template <class S>
  static S power(const S& x, const T& e) {
    return e == T(0) ? lift<S>(1.0) : S(pow(x, lift<S>(e)));
  }
  // p q; 0 where p is identically 0 and q infinite: q is not a derivative with respect to p.
  template <class S>
  static S times(const S& p, const S& q) {
    using detail::all_numbers;
    const S product = p * q;
    return all_numbers(product) ? product : lift<S>(0.0);
  }

  // f(g; e) and its derivatives, for g, h with g' = ω h and g'' = -ω² g
  template <class S>
  struct Power {
    S value, first, second;
    S size, side, h, omega;
    T e;
    Power(const S& g, const S& h_, const S& omega_, const T& e_)
        : size(abs_of(g)), side(sign(g)), h(h_), omega(omega_), e(e_) {
      const S k = lift<S>(e);
      value = side * power(size, e);
      first = omega * (k * power(size, T(e - T(1))) * h);
      second = -(omega * (omega * (k * value)));
      if (e != T(1))
        second =
            second + omega * (omega * (k * (k - lift<S>(1.0)) * (side * power(size, T(e - T(2)))) * h * h));
    }
  };
  // p f''. Where either leaves the range and the product does not, f'' is as good as its larger term, and
  // that the square of the root of p times the root of the power.
  template <class S>
  static S second_times(const Power<S>& p, const Power<S>& f) {
    using detail::all_finite;
    const S k = lift<S>(f.e), product = times(p.value, f.second);
    const bool underflow = is_zero(p.value) && !is_zero(p.size);
    if (!underflow && all_finite(product)) return product;
    const S root = power(p.size, T(p.e / T(2))) * power(f.size, T((f.e - T(2)) / T(2)));
    const S in_roots =
        f.omega * (f.omega * (k * (k - lift<S>(1.0)) * (p.side * f.side * (root * root)) * f.h * f.h));
    return all_finite(in_roots) ? in_roots : product;
  }

  // What t and n are made of: |p|^((2 - e)/2), |q|^((2 - e)/2) for a cosine and sine p, q. For e > 2 these
  // are both infinite somewhere, so first and second are those over what they have in common, 1/common.
  template <class S>
  struct Weights {
    S first, second, common = lift<S>(1.0);
    Weights(const S& p, const S& q, const T& e) {
      using std::abs;
      const T half = (T(2) - e) / T(2);
      if (half < T(0)) {
        first = power(S(abs(q)), T(-half));
        second = power(S(abs(p)), T(-half));
        common = first * second;
      } else {
        first = power(S(abs(p)), half);
        second = power(S(abs(q)), half);
      }
    }
  };

  // (|x|^(2/e) + |y|^(2/e))^(e/2), without overflow or underflow of the larger one
  template <class S>
  static S gauge(const S& x, const S& y, const T& e) {
    using std::abs;
    const S p = abs(x), q = abs(y), zero = lift<S>(0.0);
    const S &large = p < q ? q : p, &small = p < q ? p : q;
    if (!(zero < large)) return large;
    return large * power(S(lift<S>(1.0) + power(S(small / large), T(T(2) / e))), T(e / T(2)));
  }
};
Superellipsoid(double, double, double, double, double)->Superellipsoid<double>;

}  // namespace darboux
