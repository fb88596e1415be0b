/// \file bilinear_patch.h
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include <darboux/spline_patch.h>
#include <darboux/surface.h>

namespace darboux {

/// Bilinear patch over four corners, a piece of a hyperbolic paraboloid (or plane).
///   P(u, v) = (1 - u)(1 - v) p00 + u (1 - v) p10 + (1 - u) v p01 + u v p11
/// p10 is the corner at u = 1, v = 0. n = dpdu × dpdv / |.|: towards the viewer where p00, p10, p11, p01 run
/// counter-clockwise. Singular where two corners coincide (the partial along that edge is zero: dpdu_zero or
/// dpdv_zero) and where dpdu and dpdv are parallel. Partials err by at most 4u of the largest corner's
/// coordinates, u the unit roundoff; the frame is that of the partials. [doCarmo2016, sec. 3-5]
template <class T = double>
struct BilinearPatch {
  using scalar = T;
  Vec3<T> p00{T(0), T(0), T(0)}, p10{T(1), T(0), T(0)}, p01{T(0), T(1), T(0)}, p11{T(1), T(1), T(1)};

  static constexpr bool curvature_in_lanes = false;  // its facts scale by the sizes of one point
  static constexpr SurfaceInfo info{"bilinear-patch",
                                    "bilinear patch over four corners",
                                    Coordinate::linear,
                                    Coordinate::linear,
                                    {"two corners equal", "dpdu parallel to dpdv"}};
  static constexpr auto parameters() {
    using X = BilinearPatch;
    using V = Vec3<T>;
    constexpr std::string_view at00 = "corner u = 0, v = 0; length", at10 = "corner u = 1, v = 0; length",
                               at01 = "corner u = 0, v = 1; length", at11 = "corner u = 1, v = 1; length";
    constexpr Range any{};
    return std::array{
        parameter<&X::p00, &V::x>("p00_x", any, at00), parameter<&X::p00, &V::y>("p00_y", any, at00),
        parameter<&X::p00, &V::z>("p00_z", any, at00), parameter<&X::p10, &V::x>("p10_x", any, at10),
        parameter<&X::p10, &V::y>("p10_y", any, at10), parameter<&X::p10, &V::z>("p10_z", any, at10),
        parameter<&X::p01, &V::x>("p01_x", any, at01), parameter<&X::p01, &V::y>("p01_y", any, at01),
        parameter<&X::p01, &V::z>("p01_z", any, at01), parameter<&X::p11, &V::x>("p11_x", any, at11),
        parameter<&X::p11, &V::y>("p11_y", any, at11), parameter<&X::p11, &V::z>("p11_z", any, at11)};
  }

  template <class S>
  constexpr Jet2<S> jet(const S& u, const S& v) const {
    const S one = lift<S>(1.0), zero = lift<S>(0.0), ru = one - u, rv = one - v;
    const auto [a, b, c, d] = corners<S>();
    const Vec3<S> nothing{zero, zero, zero};
    return {.position = rv * (ru * a + u * b) + v * (ru * c + u * d),
            .dpdu = rv * (b - a) + v * (d - c),
            .dpdv = ru * (c - a) + u * (d - b),
            .d2pdu2 = nothing,
            .d2pduv = (d - c) - (b - a),
            .d2pdv2 = nothing};
  }

  template <class S>
  Status singular(const S& u, const S& v) const {
    const Jet2<S> j = jet(u, v);
    return (detail::vanishes(j.dpdu) ? Status::dpdu_zero : Status::regular) |
           (detail::vanishes(j.dpdv) ? Status::dpdv_zero : Status::regular);
  }

  /// K = -(D/|N|²)², D = det(p10 - p00, p01 - p00, p11 - p00) six times the volume of the corners'
  /// tetrahedron, N the cross product of the sides of the parallelogram cut out at (u, v). [doCarmo2016, sec.
  /// 3-5, ruled surfaces]
  template <class S>
  S gaussian_curvature(const S& u, const S& v) const {
    const Measures<S> m = measures(u, v);
    const S k = detail::scaled_by_power_of_two(S(m.volume / m.area / m.area), -m.exponent);
    return -(k * k);
  }
  /// H = -D (dpdu · dpdv) / |N|³
  template <class S>
  S mean_curvature(const S& u, const S& v) const {
    const Measures<S> m = measures(u, v);
    return -detail::scaled_by_power_of_two(S(m.volume * (m.F / m.area) / m.area / m.area), -m.exponent);
  }
  /// p00 + u a + v b + uv c with a = p10 - p00, b = p01 - p00, c = p11 - p10 - p01 + p00
  template <class S>
  constexpr Vec3<S> second_formula(const S& u, const S& v) const {
    const auto [p, q, r, s] = corners<S>();
    return p + u * (q - p) + v * (r - p) + (u * v) * ((s - q) - (r - p));
  }

  /// The same patch over another scalar.
  template <class To>
  auto rebind() const {
    return BilinearPatch<To>{detail::lift_vector<To>(p00), detail::lift_vector<To>(p10),
                             detail::lift_vector<To>(p01), detail::lift_vector<To>(p11)};
  }

 private:
  template <class S>
  constexpr std::array<Vec3<S>, 4> corners() const {
    return {detail::lift_vector<S>(p00), detail::lift_vector<S>(p10), detail::lift_vector<S>(p01),
            detail::lift_vector<S>(p11)};
  }
  // Volume (over 2^3e), |N| (over 2^2e) and dpdu · dpdv (over 2^2e), the lengths having been divided by 2^e.
  template <class S>
  struct Measures {
    S volume, area, F;
    int exponent;
  };
  template <class S>
  Measures<S> measures(const S& u, const S& v) const {
    const auto [p, q, r, s] = corners<S>();
    const int e = std::max({detail::exponent(q - p), detail::exponent(r - p), detail::exponent(s - p)});
    const Vec3<S> a = detail::scaled_by_power_of_two(q - p, -e),
                  b = detail::scaled_by_power_of_two(r - p, -e),
                  d = detail::scaled_by_power_of_two(s - p, -e);
    const Vec3<S> twist = (d - a) - b, along_u = a + v * twist, along_v = b + u * twist;
    return {dot(d, cross(a, b)), norm(cross(along_u, along_v)), dot(along_u, along_v), e};
  }
};
template <class T>
BilinearPatch(Vec3<T>, Vec3<T>, Vec3<T>, Vec3<T>) -> BilinearPatch<T>;

}  // namespace darboux
