/// \file tube.h
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <darboux/framed_curve.h>
#include <darboux/surface.h>

namespace darboux {

/// Tube of constant radius r about a curve K with its moving frame (T, N, B), B = T × N.
///   P(u, v) = K(u) + r (cos 2πv N(u) - sin 2πv B(u))
/// u runs along the curve, v round the tube in turns. n = cos 2πv N - sin 2πv B points out of the tube
/// everywhere. The curve provides its frame: CircleCurve, HelixCurve (Frenet's), LineSegment, PlanarCurve for
/// any planar curve; for a curve in space UprightCurve (closed form) or RotationMinimisingCurve (with the
/// error it states). With Frenet's frame and κ the curve's curvature, dpdu = speed (1 - r κ cos 2πv) T + r
/// twist (sin 2πv N + cos 2πv B). Where r κ cos 2πv = 1 the tube reaches its focal curve: dpdu is zero
/// (dpdu_zero, without torsion there) or parallel to dpdv (parallel), and the frame is the limit from
/// outside. Beyond it, where r κ cos 2πv > 1, the status is self_intersecting, n stays the same and the
/// handedness is -1. Other contacts between turns of the tube are not detected. Where the curve's speed is
/// zero there is no frame. Frame components err by at most 8u (1 + condition), u the unit roundoff; the
/// condition is that of 1 - r κ cos 2πv and, for a helix, 2π turns u. [doCarmo2016, sec. 2-4, exercise 10]
template <class Curve = HelixCurve<double>>
struct Tube {
  using scalar = typename Curve::scalar;
  Curve curve{};
  scalar radius{scalar(1) / scalar(10)};

  static constexpr SurfaceInfo info{"tube",
                                    "tube of constant radius about a curve, v round the tube",
                                    Curve::kind,
                                    Coordinate::turn,
                                    {"radius = curvature radius/cos 2πv"},
                                    /* orientable */ true,
                                    /* euler_characteristic */ std::nullopt,
                                    /* own_orientation */ true,
                                    /* frame_error */ 8};
  static constexpr auto parameters() {
    constexpr auto radius_ =
        parameter<&Tube::radius>("radius", Range::positive(), "radius of the tube; length");
    if constexpr (std::same_as<Curve, HelixCurve<scalar>>)
      return std::array{
          radius_,
          parameter<&Tube::curve, &Curve::radius>("helix_radius", Range::positive(),
                                                  "distance of the centre curve from its axis; length"),
          parameter<&Tube::curve, &Curve::pitch>("helix_pitch", Range{},
                                                 "rise of the centre curve per radian; length"),
          parameter<&Tube::curve, &Curve::turns>("helix_turns", Range::positive(),
                                                 "how often it goes round; number", {0.01, 100})};
    else if constexpr (std::same_as<Curve, CircleCurve<scalar>>)
      return std::array{radius_,
                        parameter<&Tube::curve, &Curve::radius>("circle_radius", Range::positive(),
                                                                "radius of the centre circle; length")};
    else
      return std::array{radius_};
  }
  std::string refusal() const { return detail::curve_refusal(curve); }

  /// The interior knots of the curve, along u (0).
  std::vector<double> breaks(int along) const {
    return along == 0 ? detail::curve_breaks(curve) : std::vector<double>{};
  }

  template <class P, class S>
  Jet2<S> jet(const P& u, const Turn<S>& v) const {
    const S r = lift<S>(radius), tau = two_pi<S>();
    const CurveFrame<S> f = curve.moving_frame(u);
    const Vec3<S> out = v.cos * f.N - v.sin * f.B, round = v.sin * f.N + v.cos * f.B;
    const S along = remaining_speed(u, v, f), twisted = r * f.twist;
    const S speed_rate = f.speed_rate - r * (f.bend_rate * v.cos - f.side_rate * v.sin);
    const S turning = f.bend * v.sin + f.side * v.cos;  // round' = -turning T - twist out
    return {.position = curve.jet(u).position + r * out,
            .dpdu = along * f.T + twisted * round,
            .dpdv = -((tau * r) * round),
            .d2pdu2 = (speed_rate - twisted * turning) * f.T + along * (f.bend * f.N + f.side * f.B) +
                      (r * f.twist_rate) * round - (twisted * f.twist) * out,
            .d2pduv = (tau * (r * turning)) * f.T + (tau * twisted) * out,
            .d2pdv2 = -((tau * (tau * r)) * out)};
  }

  template <class P, class S>
  Frame<S> frame(const P& u, const Turn<S>& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    const CurveFrame<S> f = curve.moving_frame(u);
    if (detail::is_zero(f.speed) || detail::vanishes(f.N)) return detail::no_frame<S>();
    const S along = remaining_speed(u, v, f), twisted = lift<S>(radius) * f.twist;
    const Turn<S> y = detail::normalised(v);
    const Vec3<S> round = y.sin * f.N + y.cos * f.B;
    const bool pinched = detail::is_zero(along) && detail::is_zero(twisted);
    const Vec2<S> d = pinched ? Vec2<S>{one, zero} : unit(Vec2<S>{along, twisted});
    return {.t = unit(d.x * f.T + d.y * round),
            .b = unit(d.y * f.T - d.x * round),
            .n = y.cos * f.N - y.sin * f.B,
            .handedness = select(along < zero, S(-one), one)};
  }

  template <class P, class S>
  Status singular(const P& u, const Turn<S>& v) const {
    const S zero = lift<S>(0.0);
    const CurveFrame<S> f = curve.moving_frame(u);
    Status result = detail::curve_status(curve, u);
    const S along = remaining_speed(u, v, f);
    if (detail::is_zero(f.speed)) return result | Status::dpdu_zero;
    if (detail::is_zero(along))
      return result | (detail::is_zero(f.twist) ? Status::dpdu_zero : Status::parallel);
    if (along < zero) result |= Status::self_intersecting;
    return result;
  }

  /// K = -k/(r (1 - r k)), k = κ cos 2πv: the curvature of the centre curve towards n. [doCarmo2016, sec.
  /// 5-7]
  template <class P, class S>
  S gaussian_curvature(const P& u, const Turn<S>& v) const {
    const S r = lift<S>(radius), k = curvature_towards_normal(u, v);
    return -(k / r / (lift<S>(1.0) - r * k));
  }
  /// H = -(1 - 2 r k)/(2 r (1 - r k)): the mean of -1/r and k/(1 - r k)
  template <class P, class S>
  S mean_curvature(const P& u, const Turn<S>& v) const {
    const S r = lift<S>(radius), k = curvature_towards_normal(u, v), two = lift<S>(2.0), one = lift<S>(1.0);
    return -((one - two * (r * k)) / (two * r) / (one - r * k));
  }

  /// The same tube over another scalar.
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(curve);
    return Tube<decltype(rebound)>{std::move(rebound), lift<To>(radius)};
  }

 private:
  // speed (1 - r κ cos 2πv). Near a focal curve speed - r bend and 1 - cos = sin²/(1 + cos) keep their
  // digits.
  template <class P, class S>
  S remaining_speed(const P& u, const Turn<S>& v, const CurveFrame<S>& f) const {
    const S r = lift<S>(radius), one = lift<S>(1.0), far = f.speed - r * (f.bend * v.cos - f.side * v.sin);
    if constexpr (requires { curve.remaining_speed(u, r); })
      return select(lift<S>(0.0) < v.cos,
                    S(curve.remaining_speed(u, r) + (r * f.bend) * (v.sin * v.sin / (one + v.cos))), far);
    else
      return far;
  }
  // From the curve's closed form, or from its own derivatives: K'' · n / |K'|².
  template <class P, class S>
  S curvature_towards_normal(const P& u, const Turn<S>& v) const {
    if constexpr (requires { curve.curvature(u); }) {
      return S(curve.curvature(u)) * v.cos;
    } else {
      const CurveJet<S> k = curve.jet(u);
      const CurveFrame<S> f = curve.moving_frame(u);
      const S speed = norm(k.first);
      return dot(v.cos * f.N - v.sin * f.B, k.second / speed) / speed;
    }
  }
};
template <class Curve, class T>
Tube(Curve, T) -> Tube<Curve>;
template <class Curve>
Tube(Curve) -> Tube<Curve>;

}  // namespace darboux
