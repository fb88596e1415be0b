/// \file torus.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Torus of revolution about the z axis.
///   P(u, v) = ((R + r cos 2πv) cos 2πu, (R + r cos 2πv) sin 2πu, r sin 2πv)
/// u runs round the axis, v round the tube, both in turns. n = (cos 2πv cos 2πu, cos 2πv sin 2πu, sin 2πv)
/// points out of the tube everywhere. Regular for R > r. At R <= r the surface meets its axis where cos 2πv =
/// -R/r: there dpdu vanishes and the frame is the limit from outside, t = (-sin 2πu, cos 2πu, 0). Beyond (R +
/// r cos 2πv < 0, the lemon inside a spindle torus) t = dpdu/|dpdu| is the opposite of that, the handedness
/// is -1 and the status self_intersecting. Frame components err by at most 4u, u the unit roundoff, for every
/// R and r (on a spindle torus: away from the axis, where the sign of R + r cos 2πv depends on
/// rounding). [doCarmo2016, sec. 2-2]
template <class T = double>
struct Torus {
  T major_radius{1}, minor_radius{0.25};

  static constexpr SurfaceInfo info{"torus",
                                    "torus of revolution about z, v round the tube",
                                    Coordinate::turn,
                                    Coordinate::turn,
                                    {"cos 2πv = -major_radius/minor_radius"},
                                    /* orientable */ true,
                                    /* euler_characteristic */ 0,
                                    /* own_orientation */ true};
  static constexpr auto parameters() {
    return std::array{
        parameter<&Torus::major_radius>("major_radius", Range::not_negative(),
                                        "distance of the tube's centre from the axis"),
        parameter<&Torus::minor_radius>("minor_radius", Range::positive(), "radius of the tube")};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const Turn<S>& v) const {
    const S r = lift<S>(minor_radius), zero = lift<S>(0.0), tau = two_pi<S>();
    const S rho = axis_distance(v);
    const S drho = -(tau * (r * v.sin)), dz = tau * (r * v.cos);  // with respect to v
    return {.position = {rho * u.cos, rho * u.sin, r * v.sin},
            .dpdu = {-(tau * (rho * u.sin)), tau * (rho * u.cos), zero},
            .dpdv = {drho * u.cos, drho * u.sin, dz},
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))), zero},
            .d2pduv = {-(tau * (drho * u.sin)), tau * (drho * u.cos), zero},
            .d2pdv2 = {-(tau * (dz * u.cos)), -(tau * (dz * u.sin)), tau * drho}};
  }

  template <class S>
  constexpr Frame<S> frame(const Turn<S>& u, const Turn<S>& v) const {
    const S one = lift<S>(1.0);
    const S side = is_ring() ? one : select(axis_distance(v) < lift<S>(0.0), S(-one), one);
    return {.t = {-(side * u.sin), side * u.cos, lift<S>(0.0)},
            .b = {-(side * (v.sin * u.cos)), -(side * (v.sin * u.sin)), side * v.cos},
            .n = {v.cos * u.cos, v.cos * u.sin, v.sin},
            .handedness = side};
  }

  constexpr bool tangent_depends_on_u_alone() const { return is_ring(); }

  template <class S>
  constexpr Status singular(const Turn<S>&, const Turn<S>& v) const {
    if (is_ring()) return Status::regular;
    const S rho = axis_distance(v), zero = lift<S>(0.0);
    return rho == zero ? Status::dpdu_zero : rho < zero ? Status::self_intersecting : Status::regular;
  }

  /// The signed distance from the tube: sqrt((d - R)² + z²) - r with d the distance from the axis, or the
  /// same with -d where that is nearer (the inner part of a spindle torus).
  template <class S>
  S implicit(const Vec3<S>& p) const {
    using std::abs, std::sqrt;
    const S size = lift<S>(major_radius) + lift<S>(minor_radius);  // lengths over it are ordinary numbers
    const S R = lift<S>(major_radius) / size, r = lift<S>(minor_radius) / size, z = p.z / size;
    const S d = sqrt((p.x / size) * (p.x / size) + (p.y / size) * (p.y / size));
    const S near = sqrt((d - R) * (d - R) + z * z) - r, far = sqrt((d + R) * (d + R) + z * z) - r;
    return size * (abs(far) < abs(near) ? far : near);
  }

  /// K = cos 2πv / (r (R + r cos 2πv))
  template <class S>
  constexpr S gaussian_curvature(const Turn<S>&, const Turn<S>& v) const {
    return v.cos / (lift<S>(minor_radius) * axis_distance(v));
  }

 private:
  // Whether the tube stays a radius of its own away from the axis.
  constexpr bool is_ring() const { return !(major_radius < minor_radius + minor_radius); }
  // ρ = R + r cos 2πv, negative on the inner part of a spindle torus
  template <class S>
  constexpr S axis_distance(const Turn<S>& v) const {
    const S R = lift<S>(major_radius), r = lift<S>(minor_radius), one = lift<S>(1.0);
    if (is_ring()) return R + r * v.cos;
    // Near the axis of a horn torus R - r and 1 + cos = sin²/(1 - cos) keep their digits, R + r cos does not.
    return select(v.cos < lift<S>(0.0), S((R - r) + r * (v.sin * v.sin / (one - v.cos))), S(R + r * v.cos));
  }
};
Torus(double, double)->Torus<double>;

}  // namespace darboux
