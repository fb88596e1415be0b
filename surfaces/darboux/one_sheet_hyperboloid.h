/// \file one_sheet_hyperboloid.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// Hyperboloid of revolution of one sheet about the z axis: (x² + y²)/a² - (z/c)² = 1, open at both ends.
///   P(u, v) = (ρ cos 2πu, ρ sin 2πu, z),   z = h (v - 1/2),   ρ = a sqrt(1 + (z/c)²)
/// u runs round the axis in turns (counter-clockwise from +x), v from the lower rim (0) to the upper (1), the
/// waist being at v = 1/2.
///   n = unit(cos 2πu, sin 2πu, -ρ'),   ρ' = dρ/dz = a z / (c² sqrt(1 + (z/c)²))
/// points outward. Regular everywhere. Frame components err by at most 4u, partials by at most 8u of their
/// scale, d2pdv2 by 12u, u the unit roundoff. [doCarmo2016, sec. 2-2 and 3-3]
template <class T = double>
struct OneSheetHyperboloid {
  T waist_radius{1}, semi_axis_z{1}, height{2};

  static constexpr SurfaceInfo info{"one-sheet-hyperboloid", "hyperboloid of revolution of one sheet about z",
                                    Coordinate::turn, Coordinate::linear};
  static constexpr auto parameters() {
    using X = OneSheetHyperboloid;
    // d2pdv2 has the size a (h/c)², which has to be representable
    constexpr Magnitudes lengths_along_axis{.smallest = 1e-35, .largest = 1e35};
    return std::array{
        parameter<&X::waist_radius>("waist_radius", Range::positive(),
                                    "least distance from the axis, a length"),
        parameter<&X::semi_axis_z>("semi_axis_z", Range::positive(),
                                   "length c along the axis at which the radius is sqrt(2) that of the waist",
                                   lengths_along_axis),
        parameter<&X::height>("height", Range::positive(), "length along the axis from rim to rim",
                              lengths_along_axis)};
  }

  template <class S>
  constexpr Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S a = lift<S>(waist_radius), h = lift<S>(height), zero = lift<S>(0.0), tau = two_pi<S>();
    const auto [zeta, w] = section(v);
    const S k = h / lift<S>(semi_axis_z);                                               // dζ/dv
    const S rho = a * w, drho = a * k * (zeta / w), d2rho = a * (k / w) * (k / w) / w;  // with respect to v
    return {.position = {rho * u.cos, rho * u.sin, h * (v - lift<S>(0.5))},
            .dpdu = {-(tau * (rho * u.sin)), tau * (rho * u.cos), zero},
            .dpdv = {drho * u.cos, drho * u.sin, h},
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))), zero},
            .d2pduv = {-(tau * (drho * u.sin)), tau * (drho * u.cos), zero},
            .d2pdv2 = {d2rho * u.cos, d2rho * u.sin, zero}};
  }

  template <class S>
  Frame<S> frame(const Turn<S>& u, const S& v) const {
    const auto [zeta, w] = section(v);
    const S slope = lift<S>(waist_radius) / lift<S>(semi_axis_z) * (zeta / w);  // ρ'
    const Vec2<S> n = unit(Vec2<S>{lift<S>(1.0), -slope});                      // across and along the axis
    return {.t = {-u.sin, u.cos, lift<S>(0.0)},
            .b = {-(n.y * u.cos), -(n.y * u.sin), n.x},
            .n = {n.x * u.cos, n.x * u.sin, n.y}};
  }

  /// f / |grad f| with f = a (d/a - sqrt(1 + (z/c)²)), d the distance from the axis: to first order the
  /// distance, positive outside.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S a = lift<S>(waist_radius), c = lift<S>(semi_axis_z), one = lift<S>(1.0);
    const S zeta = p.z / c, w = norm(Vec2<S>{one, zeta});
    return a * (norm(Vec2<S>{p.x, p.y}) / a - w) / norm(Vec2<S>{one, (a / c) * (zeta / w)});
  }

  /// K = -(d² / (a² c))² with d = 1/sqrt((x² + y²)/a⁴ + z²/c⁴), the distance of the tangent plane
  /// from the centre.
  template <class S>
  S gaussian_curvature(const Turn<S>&, const S& v) const {
    const S N = axis_over_distance(v), root = lift<S>(1.0) / N / lift<S>(semi_axis_z) / N;
    return -(root * root);
  }

  /// H = d³ (a² - c² - ζ² (a² + c²)) / (2 a⁴ c²), d as in K, ζ = z/c.
  template <class S>
  S mean_curvature(const Turn<S>&, const S& v) const {
    const S a = lift<S>(waist_radius), c = lift<S>(semi_axis_z), N = axis_over_distance(v);
    const S zeta = section(v).x, far = zeta * (norm(Vec2<S>{lift<S>(1.0), a / c}) / N);
    return lift<S>(0.5) * (((a - c) / c / N / a) * ((a + c) / c / N) - far / a * far) / N;
  }

 private:
  // ζ = z/c and sqrt(1 + ζ²) = ρ/a
  template <class S>
  Vec2<S> section(const S& v) const {
    const S zeta = lift<S>(height) * (v - lift<S>(0.5)) / lift<S>(semi_axis_z);
    return {zeta, norm(Vec2<S>{lift<S>(1.0), zeta})};
  }
  // a/d, d the distance of the tangent plane from the centre
  template <class S>
  S axis_over_distance(const S& v) const {
    const auto [zeta, w] = section(v);
    return norm(Vec2<S>{w, lift<S>(waist_radius) / lift<S>(semi_axis_z) * zeta});
  }
};
OneSheetHyperboloid(double, double, double)->OneSheetHyperboloid<double>;

}  // namespace darboux
