/// \file catenoid.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Catenoid about the z axis, the minimal surface of revolution.
///   P(u, v) = c (cosh w cos 2πu, cosh w sin 2πu, w),   w = extent (2v - 1)
/// u runs round the axis in turns, v upwards; the waist, of radius c, is at v = 1/2. n = (cos 2πu / cosh w,
/// sin 2πu / cosh w, -tanh w) points away from the axis. Regular everywhere. Frame components err by at most
/// 4u times (1 + condition), u the unit roundoff, the condition being that of cosh w (at most |w|); if cosh w
/// overflows, position and partials are lost, but not the frame. [doCarmo2016, sec. 3-5]
template <class T = double>
struct Catenoid {
  T waist_radius{1}, extent{1};

  static constexpr SurfaceInfo info{"catenoid", "catenoid about z, v upwards", Coordinate::turn,
                                    Coordinate::linear};
  static constexpr auto parameters() {
    return std::array{
        parameter<&Catenoid::waist_radius>("waist_radius", Range::positive(),
                                           "radius of the waist, a length"),
        parameter<&Catenoid::extent>("extent", Range::positive(),
                                     "half the height over the waist radius, a number", {1e-6, 40})};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S c = lift<S>(waist_radius), zero = lift<S>(0.0), tau = two_pi<S>(), w = height(v);
    const S rate = lift<S>(2.0) * lift<S>(extent);  // dw/dv
    const S rho = c * cosh(w), drho = rate * (c * sinh(w));
    return {.position = {rho * u.cos, rho * u.sin, c * w},
            .dpdu = {-(tau * (rho * u.sin)), tau * (rho * u.cos), zero},
            .dpdv = {drho * u.cos, drho * u.sin, rate * c},
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))), zero},
            .d2pduv = {-(tau * (drho * u.sin)), tau * (drho * u.cos), zero},
            .d2pdv2 = {rate * (rate * (rho * u.cos)), rate * (rate * (rho * u.sin)), zero}};
  }

  template <class S>
  constexpr Frame<S> frame(const Turn<S>& u, const S& v) const {
    const S w = height(v), sech = lift<S>(1.0) / cosh(w), th = tanh(w);
    return {.t = {-u.sin, u.cos, lift<S>(0.0)},
            .b = {th * u.cos, th * u.sin, sech},
            .n = {sech * u.cos, sech * u.sin, -th}};
  }

  /// The distance from the surface to first order, sqrt(x² + y²) / cosh(z/c) - c.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S c = lift<S>(waist_radius);
    return norm(Vec2<S>{p.x, p.y}) / cosh(S(p.z / c)) - c;
  }

  /// K = -1/(c² cosh⁴ w)
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>&, const S& v) const {
    const S ch = cosh(height(v)), k = lift<S>(1.0) / lift<S>(waist_radius) / ch / ch;
    return -(k * k);
  }

  /// H = 0
  template <class S>
  constexpr S mean_curvature(const Turn<S>&, const S&) const {
    return lift<S>(0.0);
  }

  /// The catenary as the mean of two exponential curves, w between its ends -extent and extent.
  template <class S>
  constexpr Vec3<S> second_formula(const Turn<S>& u, const S& v) const {
    const S c = lift<S>(waist_radius), e = lift<S>(extent), w = v * e - (lift<S>(1.0) - v) * e;
    const S rho = lift<S>(0.5) * (c * exp(w) + c * exp(S(-w)));
    return {rho * u.cos, rho * u.sin, c * w};
  }

 private:
  // w = z/c
  template <class S>
  constexpr S height(const S& v) const {
    return lift<S>(extent) * (lift<S>(2.0) * v - lift<S>(1.0));
  }
};
Catenoid(double, double)->Catenoid<double>;

}  // namespace darboux
