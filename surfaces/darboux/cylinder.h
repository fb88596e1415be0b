/// \file cylinder.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Circular cylinder about the z axis, open at both ends.
///   P(u, v) = (r cos 2πu, r sin 2πu, h v)
/// u runs round the axis in turns, v from the bottom (0) to the top (1). n points outward. Regular
/// everywhere. Frame components err by at most 2u, u the unit roundoff, for every radius and height.
/// [doCarmo2016, sec. 2-3]
template <class T = double>
struct Cylinder {
  T radius{1}, height{1};

  static constexpr SurfaceInfo info{"cylinder", "open circular cylinder about z", Coordinate::turn,
                                    Coordinate::linear};
  static constexpr auto parameters() {
    return std::array{parameter<&Cylinder::radius>("radius", Range::positive(), "radius"),
                      parameter<&Cylinder::height>("height", Range::positive(), "length along the axis")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S r = lift<S>(radius), h = lift<S>(height), zero = lift<S>(0.0), full = two_pi<S>() * r;
    return {.position = {r * u.cos, r * u.sin, h * v},
            .dpdu = {-(full * u.sin), full * u.cos, zero},
            .dpdv = {zero, zero, h},
            .d2pdu2 = {-(two_pi<S>() * (full * u.cos)), -(two_pi<S>() * (full * u.sin)), zero},
            .d2pduv = {zero, zero, zero},
            .d2pdv2 = {zero, zero, zero}};
  }

  template <class S>
  constexpr Frame<S> frame(const Turn<S>& u, const S&) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    return {.t = {-u.sin, u.cos, zero}, .b = {zero, zero, one}, .n = {u.cos, u.sin, zero}};
  }

  /// sqrt(x² + y²) - r
  template <class S>
  S implicit(const Vec3<S>& p) const {
    using std::sqrt;
    const S r = lift<S>(radius), x = p.x / r, y = p.y / r;
    return r * (sqrt(x * x + y * y) - lift<S>(1.0));
  }

  /// K = 0
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>&, const S&) const {
    return lift<S>(0.0);
  }
};
Cylinder(double, double)->Cylinder<double>;

}  // namespace darboux
