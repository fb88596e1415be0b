/// \file cone.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Circular cone about the z axis, open at its base.
///   P(u, v) = (r (1 - v) cos 2πu, r (1 - v) sin 2πu, h v)
/// u runs round the axis in turns (counter-clockwise from +x), v from the base (0) to the apex (1).
///   n = (h cos 2πu, h sin 2πu, r) / hypot(r, h)
/// points outward. The chart is singular at the apex, where dpdu vanishes; so is the cone itself, whose
/// normal there depends on u. The frame at v = 1 is the limit along the generator of the given u: the same
/// as at every other point of that generator. Frame components err by at most 4u, partials by at most 8u of
/// their scale, u the unit roundoff, for every radius and height. [doCarmo2016, sec. 2-2]
template <class T = double>
struct Cone {
  T radius{1}, height{1};

  static constexpr SurfaceInfo info{"cone",
                                    "open circular cone about z, v from base to apex",
                                    Coordinate::turn,
                                    Coordinate::linear,
                                    {"v=1"}};
  static constexpr auto parameters() {
    return std::array{
        parameter<&Cone::radius>("radius", Range::positive(), "radius of the base, a length"),
        parameter<&Cone::height>("height", Range::positive(), "length of the axis from base to apex")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S r = lift<S>(radius), h = lift<S>(height), zero = lift<S>(0.0), tau = two_pi<S>();
    const S rho = r * (lift<S>(1.0) - v);  // distance from the axis
    return {.position = {rho * u.cos, rho * u.sin, h * v},
            .dpdu = {-(tau * (rho * u.sin)), tau * (rho * u.cos), zero},
            .dpdv = {-(r * u.cos), -(r * u.sin), h},
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))), zero},
            .d2pduv = {tau * (r * u.sin), -(tau * (r * u.cos)), zero},
            .d2pdv2 = {zero, zero, zero}};
  }

  template <class S>
  Frame<S> frame(const Turn<S>& u, const S&) const {
    const Vec2<S> n = normal_in_section<S>();
    return {.t = {-u.sin, u.cos, lift<S>(0.0)},
            .b = {-(n.y * u.cos), -(n.y * u.sin), n.x},
            .n = {n.x * u.cos, n.x * u.sin, n.y}};
  }

  template <class S>
  constexpr Status singular(const Turn<S>&, const S& v) const {
    return v == lift<S>(1.0) ? Status::dpdu_zero : Status::regular;
  }

  /// The signed distance from the generator's line in the plane through the axis and p: n · (p - base
  /// point).
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const Vec2<S> n = normal_in_section<S>();
    return n.x * (norm(Vec2<S>{p.x, p.y}) - lift<S>(radius)) + n.y * p.z;
  }

  /// K = 0
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>&, const S&) const {
    return lift<S>(0.0);
  }

  /// H = -h / (2 ρ hypot(r, h)) with ρ the distance from the axis: half the circle's curvature 1/ρ, taken
  /// along n.
  template <class S>
  S mean_curvature(const Turn<S>&, const S& v) const {
    const S rho = lift<S>(radius) * (lift<S>(1.0) - v);
    return -(normal_in_section<S>().x / (lift<S>(2.0) * rho));
  }

 private:
  // n across and along the axis, in the plane through it
  template <class S>
  Vec2<S> normal_in_section() const {
    return unit(Vec2<S>{lift<S>(height), lift<S>(radius)});
  }
};
Cone(double, double)->Cone<double>;

}  // namespace darboux
