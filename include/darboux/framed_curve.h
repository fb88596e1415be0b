/// \file framed_curve.h
/// Curves with a moving frame, as tubes require: planar curves, curves with a fixed up direction, and
/// rotation-minimising frames.
#pragma once

#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include <darboux/curve.h>

namespace darboux {

/// A curve that lies in a plane z = constant, with the moving frame T, N = (-T_y, T_x, 0), B = +z: the bend
/// is positive where the curve turns left. Use it for a tube around any planar curve.
template <class Curve = BSplineCurve<double>>
struct PlanarCurve {
  using scalar = typename Curve::scalar;
  static constexpr Coordinate kind = Curve::kind;
  Curve curve{};

  template <class P>
  auto jet(const P& t) const {
    return curve.jet(t);
  }
  template <class P>
  auto moving_frame(const P& t) const {
    const auto j = curve.jet(t);
    using S = std::remove_cvref_t<decltype(j.first.x)>;
    const S zero = lift<S>(0.0), speed = norm(Vec2<S>{j.first.x, j.first.y});
    const Vec2<S> T = unit(Vec2<S>{j.first.x, j.first.y});
    const Vec3<S> along{T.x, T.y, zero}, left{-T.y, T.x, zero}, up{zero, zero, lift<S>(1.0)};
    CurveFrame<S> f{along, left, up, speed, zero, zero, zero, zero, zero, zero, zero};
    f.speed_rate = dot(f.T, j.second);
    const auto to_n = detail::tangent_rates(f.N, j, speed, f.speed_rate);
    f.bend = to_n.first;
    f.bend_rate = to_n.second;
    return f;
  }
  /// (x' y'' - y' x'') / (x'² + y'²)^(3/2) [doCarmo2016, sec. 1-5]
  template <class P>
  auto curvature(const P& t) const {
    const auto j = curve.jet(t);
    using S = std::remove_cvref_t<decltype(j.first.x)>;
    const S speed = norm(Vec2<S>{j.first.x, j.first.y});
    return S(((j.first.x / speed) * (j.second.y / speed) - (j.first.y / speed) * (j.second.x / speed)) /
             speed);
  }
  template <class P>
  auto second_formula(const P& t) const requires requires(const Curve& c) {
    c.second_formula(t);
  }
  { return curve.second_formula(t); }
  template <class P>
  Status singular(const P& t) const {
    return detail::curve_status(curve, t);
  }
  std::string refusal() const {
    if constexpr (requires { curve.control_points(); })
      for (const auto& p : curve.control_points())
        if (!(p.z == curve.control_points().front().z))
          return "expected a curve in a plane z = constant, got one that leaves it";
    return detail::curve_refusal(curve);
  }
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(curve);
    return PlanarCurve<decltype(rebound)>{std::move(rebound)};
  }
};
template <class Curve>
PlanarCurve(Curve) -> PlanarCurve<Curve>;

/// A curve in space with N in the plane of T and a fixed direction `up`, on the side of `up`: N = unit(up -
/// (up · T) T). In closed form; the twist is not zero in general. There is no frame where the curve is
/// parallel to `up`.
template <class Curve = HelixCurve<double>>
struct UprightCurve {
  using scalar = typename Curve::scalar;
  static constexpr Coordinate kind = Curve::kind;
  Curve curve{};
  Vec3<scalar> up{scalar(0), scalar(0), scalar(1)};

  template <class P>
  auto jet(const P& t) const {
    return curve.jet(t);
  }
  template <class P>
  auto moving_frame(const P& t) const {
    const auto j = curve.jet(t);
    using S = std::remove_cvref_t<decltype(j.first.x)>;
    const Vec3<S> d = unit(detail::lift_vector<S>(up));
    CurveFrame<S> f{};
    f.speed = norm(j.first);
    f.T = unit(j.first);
    const Vec3<S> across = d - dot(d, f.T) * f.T;
    f.N = unit(across);
    f.B = accurate_cross(f.T, f.N);
    const S along = dot(d, f.T) / norm(across);  // cotangent of the angle of T and up
    f.speed_rate = dot(f.T, j.second);
    const auto to_n = detail::tangent_rates(f.N, j, f.speed, f.speed_rate);
    const auto to_b = detail::tangent_rates(f.B, j, f.speed, f.speed_rate);
    f.bend = to_n.first;
    f.side = to_b.first;
    f.twist = -(along * f.side);
    f.bend_rate = to_n.second + f.twist * f.side;
    f.side_rate = to_b.second - f.twist * f.bend;
    f.twist_rate = -(along * f.side_rate) - (lift<S>(1.0) + along * along) * (f.bend * f.side);
    return f;
  }
  template <class P>
  auto second_formula(const P& t) const requires requires(const Curve& c) {
    c.second_formula(t);
  }
  { return curve.second_formula(t); }
  template <class P>
  Status singular(const P& t) const {
    return detail::curve_status(curve, t);
  }
  std::string refusal() const {
    if (detail::vanishes(up)) return "the direction `up`: expected one that is not zero, got zero";
    return detail::curve_refusal(curve);
  }
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(curve);
    return UprightCurve<decltype(rebound)>{std::move(rebound), detail::lift_vector<To>(up)};
  }
};
template <class Curve>
UprightCurve(Curve) -> UprightCurve<Curve>;
template <class Curve, class T>
UprightCurve(Curve, Vec3<T>) -> UprightCurve<Curve>;

/// A curve in space with a rotation-minimising frame: N and B do not rotate about T. It is the frame of
/// UprightCurve rotated by φ(t) = -∫ twist dt from 0 to t, so at t = 0 the two agree and N leans towards
/// `up` [Bishop1975]. The integral is computed by four-point Gauss quadrature on each of `panels` equal
/// subintervals of [0, t]; turning_error() estimates its error. T and the rates are in closed form. The
/// quadrature error rotates N and B, and displaces the points of a tube by the error times the radius; the
/// derivatives do not include this. Cost: 4 panels evaluations of the curve. Not for closed curves: the frame
/// does not return to itself. There is no frame if the curve is parallel to `up` anywhere; choose `up`
/// accordingly.
template <class Curve = HelixCurve<double>>
struct RotationMinimisingCurve {
  static_assert(Curve::kind == Coordinate::linear, "a rotation-minimising frame does not close");
  using scalar = typename Curve::scalar;
  static constexpr Coordinate kind = Curve::kind;
  Curve curve{};
  Vec3<scalar> up{scalar(0), scalar(0), scalar(1)};
  int panels = 32;

  template <class S>
  CurveJet<S> jet(const S& t) const {
    return curve.jet(t);
  }
  template <class S>
  CurveFrame<S> moving_frame(const S& t) const {
    const CurveJet<S> j = curve.jet(t);
    const CurveFrame<S> g = upright().moving_frame(t);
    const Turn<S> phi = sincos_turns(S(turning(t, panels) / two_pi<S>()));
    CurveFrame<S> f = g;
    f.N = phi.cos * g.N + phi.sin * g.B;
    f.B = phi.cos * g.B - phi.sin * g.N;
    const auto to_n = detail::tangent_rates(f.N, j, f.speed, f.speed_rate);
    const auto to_b = detail::tangent_rates(f.B, j, f.speed, f.speed_rate);
    f.bend = to_n.first;
    f.side = to_b.first;
    f.bend_rate = to_n.second;
    f.side_rate = to_b.second;
    f.twist = f.twist_rate = lift<S>(0.0);
    return f;
  }
  /// An estimate of the error of φ in radians: the largest difference from the integral with half as many
  /// panels, at 16 values of t. The rounding error is about 1e-15.
  double turning_error() const {
    double worst = 0;
    for (int i = 1; i <= 16; ++i) {
      const double t = i / 16.0;
      worst = std::fmax(worst, std::fabs(turning(t, panels) - turning(t, (panels + 1) / 2)));
    }
    return worst;
  }
  template <class S>
  auto second_formula(const S& t) const requires requires(const Curve& c) {
    c.second_formula(t);
  }
  { return curve.second_formula(t); }
  template <class S>
  Status singular(const S& t) const {
    return detail::curve_status(curve, t);
  }
  std::string refusal() const {
    if (panels < 1) return "panels: expected 1 or more, got " + std::to_string(panels);
    return upright().refusal();
  }
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(curve);
    return RotationMinimisingCurve<decltype(rebound)>{std::move(rebound), detail::lift_vector<To>(up),
                                                      panels};
  }

 private:
  UprightCurve<Curve> upright() const { return {curve, up}; }
  // -∫ twist from 0 to t
  template <class S>
  S turning(const S& t, int pieces) const {
    using std::sqrt;
    const UprightCurve<Curve> base = upright();
    const S root = lift<S>(2.0) / lift<S>(7.0) * S(sqrt(lift<S>(6.0) / lift<S>(5.0)));
    const S inner = sqrt(lift<S>(3.0) / lift<S>(7.0) - root),
            outer = sqrt(lift<S>(3.0) / lift<S>(7.0) + root);
    const S tilt = S(sqrt(lift<S>(30.0))) / lift<S>(36.0), half = lift<S>(0.5);
    const S count = lift<S>(static_cast<double>(pieces));
    S sum = lift<S>(0.0);
    for (int i = 0; i < pieces; ++i) {
      const S middle = lift<S>(i + 0.5);
      const auto twist = [&](const S& x) {
        return base.moving_frame(S((middle + half * x) / count * t)).twist;
      };
      sum = sum + (half + tilt) * (twist(inner) + twist(-inner)) +
            (half - tilt) * (twist(outer) + twist(-outer));
    }
    return -(sum * half * t / count);
  }
};
template <class Curve>
RotationMinimisingCurve(Curve) -> RotationMinimisingCurve<Curve>;
template <class Curve, class T>
RotationMinimisingCurve(Curve, Vec3<T>) -> RotationMinimisingCurve<Curve>;

}  // namespace darboux
