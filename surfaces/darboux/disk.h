/// \file disk.h
#pragma once

#include <charconv>
#include <string>

#include <darboux/surface.h>

namespace darboux {

/// Disk about the origin in the plane z = 0, or an annulus where the inner radius is positive.
///   P(u, v) = (ρ cos 2πu, ρ sin 2πu, 0),   ρ = outer (1 - v) + inner v
/// u runs round the z axis in turns (counter-clockwise from +x), v from the outer rim (0) inward to the inner
/// rim or the centre (1). n = (0, 0, 1), t = (-sin 2πu, cos 2πu, 0), b = (-cos 2πu, -sin 2πu, 0). The
/// chart is singular at the centre, v = 1 where inner = 0: there dpdu vanishes and the frame is the limit
/// along the radius of the given u. Frame components err by at most 2u, u the unit roundoff, for every pair
/// of radii; partials by at most 8u of their scale, dpdv and d2pduv times (outer + inner)/(outer - inner) in
/// a number type coarser than that of the radii. [doCarmo2016, sec. 2-2]
template <class T = double>
struct Disk {
  T outer_radius{1}, inner_radius{0};

  static constexpr SurfaceInfo info{"disk",
                                    "disk or annulus in the plane z = 0, v runs inward",
                                    Coordinate::turn,
                                    Coordinate::linear,
                                    {"v=1 if inner_radius=0"}};
  static constexpr auto parameters() {
    return std::array{
        parameter<&Disk::outer_radius>("outer_radius", Range::positive(),
                                       "radius of the rim at v = 0, a length"),
        parameter<&Disk::inner_radius>("inner_radius", Range::not_negative(),
                                       "radius of the hole, a length below outer_radius; 0: no hole")};
  }

  /// What is wrong with the two radii together; empty if nothing is.
  std::string refusal() const {
    if (inner_radius < outer_radius) return {};
    const auto text = [](const T& x) {
      std::array<char, 32> digits{};
      const auto end =
          std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<double>(x)).ptr;
      return std::string(digits.data(), end);
    };
    return "inner_radius: expected less than outer_radius = " + text(outer_radius) + ", got " +
           text(inner_radius);
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S zero = lift<S>(0.0), tau = two_pi<S>();
    const S rho = axis_distance(v), drho = lift<S>(inner_radius) - lift<S>(outer_radius);
    return {.position = {rho * u.cos, rho * u.sin, zero},
            .dpdu = {-(tau * (rho * u.sin)), tau * (rho * u.cos), zero},
            .dpdv = {drho * u.cos, drho * u.sin, zero},
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))), zero},
            .d2pduv = {-(tau * (drho * u.sin)), tau * (drho * u.cos), zero},
            .d2pdv2 = {zero, zero, zero}};
  }

  template <class S>
  constexpr Frame<S> frame(const Turn<S>& u, const S&) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    return {.t = {-u.sin, u.cos, zero}, .b = {-u.cos, -u.sin, zero}, .n = {zero, zero, one}};
  }

  template <class S>
  constexpr Status singular(const Turn<S>&, const S& v) const {
    return axis_distance(v) == lift<S>(0.0) ? Status::dpdu_zero : Status::regular;
  }

  /// The height z above the annulus; beside it the distance from its border.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S zero = lift<S>(0.0), d = norm(Vec2<S>{p.x, p.y});
    const S beyond = d - lift<S>(outer_radius), within = lift<S>(inner_radius) - d;
    const S beside = beyond > within ? beyond : within;
    return beside > zero ? norm(Vec2<S>{beside, p.z}) : p.z;
  }

  /// K = 0
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>&, const S&) const {
    return lift<S>(0.0);
  }

  /// H = 0
  template <class S>
  constexpr S mean_curvature(const Turn<S>&, const S&) const {
    return lift<S>(0.0);
  }

  /// From the circle half-way between the rims, (1/2 - v) times the width of the annulus outward.
  template <class S>
  constexpr Vec3<S> second_formula(const Turn<S>& u, const S& v) const {
    const S R = lift<S>(outer_radius), r = lift<S>(inner_radius), half = lift<S>(0.5);
    const Vec3<S> outward{u.cos, u.sin, lift<S>(0.0)};
    return (half * (R + r)) * outward + ((half - v) * (R - r)) * outward;
  }

 private:
  template <class S>
  constexpr S axis_distance(const S& v) const {
    return lift<S>(outer_radius) * (lift<S>(1.0) - v) + lift<S>(inner_radius) * v;
  }
};
Disk(double, double)->Disk<double>;

}  // namespace darboux
