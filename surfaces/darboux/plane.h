/// \file plane.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Rectangle about the origin in the plane z = 0.
///   P(u, v) = (w (u - 1/2), d (v - 1/2), 0)
/// u runs along x, v along y. n = (0, 0, 1). Regular everywhere. The frame is exact: the three axes. Position
/// and partials err by at most 2u of their scale, u the unit roundoff. [doCarmo2016, sec. 2-2]
template <class T = double>
struct Plane {
  T width{1}, depth{1};

  static constexpr SurfaceInfo info{"plane", "rectangle about the origin in the plane z = 0",
                                    Coordinate::linear, Coordinate::linear};
  static constexpr auto parameters() {
    return std::array{parameter<&Plane::width>("width", Range::positive(), "length of the sides along x"),
                      parameter<&Plane::depth>("depth", Range::positive(), "length of the sides along y")};
  }

  template <class S>
  constexpr Jet2<S> jet(const S& u, const S& v) const {
    const S w = lift<S>(width), d = lift<S>(depth), zero = lift<S>(0.0), half = lift<S>(0.5);
    return {.position = {w * (u - half), d * (v - half), zero},
            .dpdu = {w, zero, zero},
            .dpdv = {zero, d, zero},
            .d2pdu2 = {zero, zero, zero},
            .d2pduv = {zero, zero, zero},
            .d2pdv2 = {zero, zero, zero}};
  }

  template <class S>
  constexpr Frame<S> frame(const S&, const S&) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    return {.t = {one, zero, zero}, .b = {zero, one, zero}, .n = {zero, zero, one}};
  }

  /// The height z above the rectangle; beside it the distance from its border.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    using std::abs;
    const S zero = lift<S>(0.0), half = lift<S>(0.5);
    const S x = abs(p.x) - half * lift<S>(width), y = abs(p.y) - half * lift<S>(depth);
    if (!(x > zero) && !(y > zero)) return p.z;
    return norm(Vec3<S>{x > zero ? x : zero, y > zero ? y : zero, p.z});
  }

  /// K = 0
  template <class S>
  constexpr S gaussian_curvature(const S&, const S&) const {
    return lift<S>(0.0);
  }

  /// H = 0
  template <class S>
  constexpr S mean_curvature(const S&, const S&) const {
    return lift<S>(0.0);
  }

  /// The bilinear mean of the four corners (±w/2, ±d/2, 0).
  template <class S>
  constexpr Vec3<S> second_formula(const S& u, const S& v) const {
    const S one = lift<S>(1.0), zero = lift<S>(0.0);
    const S x = lift<S>(0.5) * lift<S>(width), y = lift<S>(0.5) * lift<S>(depth);
    const Vec3<S> front = (one - u) * Vec3<S>{-x, -y, zero} + u * Vec3<S>{x, -y, zero};
    const Vec3<S> back = (one - u) * Vec3<S>{-x, y, zero} + u * Vec3<S>{x, y, zero};
    return (one - v) * front + v * back;
  }
};
Plane(double, double)->Plane<double>;

}  // namespace darboux
