/// \file two_sheet_hyperboloid.h
#pragma once

#include <darboux/surface.h>

namespace darboux {

/// The upper sheet of a hyperboloid of two sheets: (z/c)² - (x/a)² - (y/b)² = 1, z > 0; a cup about the z
/// axis with its tip at (0, 0, c).
///   P(u, v) = (a sinh w cos 2πu, b sinh w sin 2πu, c cosh w),   w = extent · v
/// u runs round the axis in turns (counter-clockwise from +x), v from the tip (0) to the rim (1).
///   n = unit((c/a) tanh w cos 2πu, (c/b) tanh w sin 2πu, -1),   t = unit(-a sin 2πu, b cos 2πu, 0)
/// n points down and out of the cup. The chart is singular at the tip, where dpdu vanishes; there the frame
/// is the limit along the curve of the given u: t as above, n = (0, 0, -1). Frame components err by at most
/// 4u for all axes, also of very different sizes, and any extent; partials by at most 8u (1 + extent) of
/// their scale, u the unit roundoff. Position and partials use sinh and cosh of elementary.h. [doCarmo2016,
/// sec. 2-2]
template <class T = double>
struct TwoSheetHyperboloid {
  T semi_axis_x{1}, semi_axis_y{1}, semi_axis_z{1}, extent{1};

  static constexpr SurfaceInfo info{"two-sheet-hyperboloid",
                                    "upper sheet of a hyperboloid of two sheets, v from tip to rim",
                                    Coordinate::turn,
                                    Coordinate::linear,
                                    {"v=0"}};
  static constexpr auto parameters() {
    using X = TwoSheetHyperboloid;
    return std::array{
        parameter<&X::semi_axis_x>("semi_axis_x", Range::positive(), "length a along x in the equation"),
        parameter<&X::semi_axis_y>("semi_axis_y", Range::positive(), "length b along y in the equation"),
        parameter<&X::semi_axis_z>("semi_axis_z", Range::positive(),
                                   "height of the tip above the centre, a length"),
        parameter<&X::extent>("extent", Range::positive(),
                              "hyperbolic angle w at the rim, a number: the rim is at height c cosh(extent)",
                              {.smallest = 1e-9, .largest = 8})};
  }

  template <class S>
  Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z), e = lift<S>(extent);
    const S zero = lift<S>(0.0), tau = two_pi<S>();
    const S sh = sinh(e * v), ch = cosh(e * v);
    const S x = a * sh, y = b * sh, dx = e * (a * ch), dy = e * (b * ch);  // semi-axes of the section; by v
    return {.position = {x * u.cos, y * u.sin, c * ch},
            .dpdu = {-(tau * (x * u.sin)), tau * (y * u.cos), zero},
            .dpdv = {dx * u.cos, dy * u.sin, e * (c * sh)},
            .d2pdu2 = {-(tau * (tau * (x * u.cos))), -(tau * (tau * (y * u.sin))), zero},
            .d2pduv = {-(tau * (dx * u.sin)), tau * (dy * u.cos), zero},
            .d2pdv2 = {e * (e * (x * u.cos)), e * (e * (y * u.sin)), e * (e * (c * ch))}};
  }

  template <class S>
  Frame<S> frame(const Turn<S>& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z);
    const S th = tanh(lift<S>(extent) * v);
    const Vec2<S> along_u = unit(Vec2<S>{-(a * u.sin), b * u.cos});
    const Vec3<S> t{along_u.x, along_u.y, lift<S>(0.0)};
    const Vec3<S> n = unit(Vec3<S>{c / a * th * u.cos, c / b * th * u.sin, -lift<S>(1.0)});
    return {.t = t, .b = unit(cross(n, t)), .n = n};  // nothing cancels: nx ty and -ny tx have one sign
  }

  template <class S>
  constexpr Status singular(const Turn<S>&, const S& v) const {
    return v == lift<S>(0.0) ? Status::dpdu_zero : Status::regular;
  }

  /// f / |grad f| with f = c sqrt(1 + (x/a)² + (y/b)²) - z: to first order the distance, positive below and
  /// outside.
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z), one = lift<S>(1.0);
    const Vec2<S> q{p.x / a, p.y / b};
    const S w = norm(Vec3<S>{q.x, q.y, one});
    return (c * w - p.z) / norm(Vec3<S>{c / a * (q.x / w), c / b * (q.y / w), one});
  }

  /// K = (d² / (a b c))² with d = 1/|(x/a², y/b², z/c²)|, the distance of the tangent plane from the
  /// centre.
  template <class S>
  S gaussian_curvature(const Turn<S>& u, const S& v) const {
    const S N = on_unit_hyperboloid(u, v).axis_over_distance;
    const S root = lift<S>(semi_axis_z) / lift<S>(semi_axis_x) / N / lift<S>(semi_axis_y) / N;
    return root * root;
  }

  /// H = -d³ (((x/a)² + (y/b)²)/(a b)² + (1 + (y/b)²)/(a c)² + (1 + (x/a)²)/(b c)²) / 2, d as in K:
  /// half the divergence of the unit normal field of the level sets.
  template <class S>
  S mean_curvature(const Turn<S>& u, const S& v) const {
    const S a = lift<S>(semi_axis_x), b = lift<S>(semi_axis_y), c = lift<S>(semi_axis_z), one = lift<S>(1.0);
    const auto [x, y, N] = on_unit_hyperboloid(u, v);
    const Vec3<S> m{c / a * (norm(Vec2<S>{x, y}) / N) / b, norm(Vec2<S>{one, y}) / N / a,
                    norm(Vec2<S>{one, x}) / N / b};
    return -(lift<S>(0.5) * dot(c / N * m, m));
  }

 private:
  template <class S>
  struct Place {
    S x, y;                // x/a, y/b
    S axis_over_distance;  // c/d, d the distance of the tangent plane from the centre
  };
  template <class S>
  Place<S> on_unit_hyperboloid(const Turn<S>& u, const S& v) const {
    const S w = lift<S>(extent) * v, c = lift<S>(semi_axis_z), x = sinh(w) * u.cos, y = sinh(w) * u.sin;
    return {x, y, norm(Vec3<S>{c / lift<S>(semi_axis_x) * x, c / lift<S>(semi_axis_y) * y, cosh(w)})};
  }
};
TwoSheetHyperboloid(double, double, double, double)->TwoSheetHyperboloid<double>;

}  // namespace darboux
