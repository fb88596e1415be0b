/// \file surface_of_revolution.h
#pragma once

#include <concepts>
#include <string>
#include <utility>
#include <vector>

#include <darboux/curve.h>
#include <darboux/surface.h>

namespace darboux {

/// Surface of revolution about the z axis.
///   P(u, v) = (ρ(v) cos 2πu, ρ(v) sin 2πu, z(v))
/// The profile is a curve in the xz plane: its x is ρ, its z is z, its y must be 0. u runs round the axis in
/// turns, v along the profile.
///   n = (z' cos 2πu, z' sin 2πu, -ρ')/sqrt(ρ'² + z'²)
/// points outward where z' > 0. Where the profile is beyond the axis (ρ < 0), t and n are both reversed, as
/// by the cross product. Where ρ = 0, dpdu vanishes (dpdu_zero); the frame is the limit from above (at v = 1
/// from below) at the given u, t = ±(-sin 2πu, cos 2πu, 0), with crease where the profile crosses the
/// axis. Where the profile stops (ρ' = z' = 0) the status is dpdv_zero; the frame is the limit from the same
/// side by the first derivative that does not vanish, with crease where the profile turns back. At a corner
/// of the profile the status is crease, and the frame is that from above. Frame components err by at most 4u
/// (1 + condition), u the unit roundoff, the condition being that of the profile's derivatives. [doCarmo2016,
/// sec. 2-3 and 3-3]
template <class Curve = BSplineCurve<double>>
struct SurfaceOfRevolution {
  using scalar = typename Curve::scalar;
  static constexpr int curve_along = 1;
  Curve profile = example();

  static constexpr SurfaceInfo info{"surface-of-revolution",
                                    "surface of revolution of a profile curve about z",
                                    Coordinate::turn,
                                    Curve::kind,
                                    {"profile meets the axis", "corners of the profile"}};
  std::string refusal() const {
    if constexpr (requires { profile.control_points(); })
      for (const auto& p : profile.control_points())
        if (!(p.y == scalar(0)))
          return "the profile: expected a curve in the plane y = 0, got one that leaves it";
    return detail::curve_refusal(profile);
  }

  /// The interior knots of the profile, along v (1).
  std::vector<double> breaks(int along) const {
    return along == 1 ? detail::curve_breaks(profile) : std::vector<double>{};
  }

  template <class S, class P>
  Jet2<S> jet(const Turn<S>& u, const P& v) const {
    const S zero = lift<S>(0.0), tau = two_pi<S>();
    const CurveJet<S> k = profile.jet(v);
    const S rho = k.position.x, d = k.first.x, dd = k.second.x;
    return {.position = {rho * u.cos, rho * u.sin, k.position.z},
            .dpdu = {-(tau * (rho * u.sin)), tau * (rho * u.cos), zero},
            .dpdv = {d * u.cos, d * u.sin, k.first.z},
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))), zero},
            .d2pduv = {-(tau * (d * u.sin)), tau * (d * u.cos), zero},
            .d2pdv2 = {dd * u.cos, dd * u.sin, k.second.z}};
  }

  template <class S, class P>
  Frame<S> frame(const Turn<S>& u, const P& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    const CurveJet<S> k = in_plane(profile.jet(v));
    const auto [way, order] = detail::passage<Curve::kind>(k, v);
    if (order == 0) return detail::no_frame<S>();
    const S side = select(axis_side(k, v).first < zero, S(-one), one);
    return {.t = {-(side * u.sin), side * u.cos, zero},
            .b = {way.x * u.cos, way.x * u.sin, way.z},
            .n = {side * (way.z * u.cos), side * (way.z * u.sin), -(side * way.x)}};
  }

  template <class S, class P>
  Status singular(const Turn<S>&, const P& v) const {
    const CurveJet<S> k = in_plane(profile.jet(v));
    Status result =
        detail::curve_status(profile, v) |
        detail::passage_status<Curve::kind>(detail::passage<Curve::kind>(k, v), v, Status::dpdv_zero);
    if (detail::is_zero(k.position.x)) {
      result |= Status::dpdu_zero;
      if (axis_side(k, v).second && detail::within<Curve::kind>(v)) result |= Status::crease;
    }
    return result;
  }

  /// The same surface where its profile is at v, with derivatives to an order.
  template <int order, class P>
  auto with_curve_at(const P& v) const {
    auto at = detail::curve_at_place<order>(profile, v);
    return SurfaceOfRevolution<decltype(at)>{at};
  }

  /// K = -z' (ρ'' z' - ρ' z'') / (ρ (ρ'² + z'²)²) [doCarmo2016, sec. 3-3]
  template <class S, class P>
  S gaussian_curvature(const Turn<S>&, const P& v) const {
    const Bending<S> b = bending(v);
    return -(b.slope_z / b.rho * b.profile);
  }
  /// H = ((ρ'' z' - ρ' z'')/q³ - z'/(ρ q))/2 with q = sqrt(ρ'² + z'²), for ρ > 0;
  /// the opposite for ρ < 0.
  template <class S, class P>
  S mean_curvature(const Turn<S>&, const P& v) const {
    const Bending<S> b = bending(v);
    const S h = (b.profile - b.slope_z / b.rho) / lift<S>(2.0);
    return select(b.rho < lift<S>(0.0), S(-h), h);
  }
  /// The profile's point by its other formula, turned round the axis.
  template <class S, class P>
  Vec3<S> second_formula(const Turn<S>& u, const P& v) const requires requires(const Curve& c) {
    c.second_formula(v);
  }
  {
    const Vec3<S> p = profile.second_formula(v);
    return {u.cos * p.x, u.sin * p.x, p.z};
  }

  /// The same surface over another scalar.
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(profile);
    return SurfaceOfRevolution<decltype(rebound)>{std::move(rebound)};
  }

 private:
  static Curve example() {
    if constexpr (std::same_as<Curve, BSplineCurve<scalar>>)
      return Curve::vase();
    else
      return Curve{};
  }
  template <class S>
  static CurveJet<S> in_plane(CurveJet<S> k) {
    k.position.y = k.first.y = k.second.y = k.third.y = lift<S>(0.0);
    return k;
  }
  // The side of the axis, a number of the sign of ρ: where ρ = 0 that of the frames above (at the upper end
  // below), and whether the profile crosses the axis there.
  template <class S, class P>
  static std::pair<S, bool> axis_side(const CurveJet<S>& k, const P& v) {
    if (!detail::is_zero(k.position.x)) return {k.position.x, false};
    if constexpr (!detail::Lanewise<S>) {
      const auto [way, order] = detail::passage<Curve::kind>(k, v);
      if (order > 0 && detail::size_of(way.x) > 16 * detail::rounding_of<S>())
        return {detail::at_upper_end<Curve::kind>(v) ? -way.x : way.x, order != 2};
    }
    return {k.second.x, false};
  }
  // ρ, z'/q and the profile's curvature (ρ'' z' - ρ' z'')/q³
  template <class S>
  struct Bending {
    S rho, slope_z, profile;
  };
  template <class P>
  auto bending(const P& v) const {
    const auto k = profile.jet(v);
    using S = std::remove_cvref_t<decltype(k.first.x)>;
    const S q = norm(Vec2<S>{k.first.x, k.first.z}), x = k.first.x / q, z = k.first.z / q;
    return Bending<S>{k.position.x, z, (k.second.x / q * z - x * (k.second.z / q)) / q};
  }
};
template <class Curve>
SurfaceOfRevolution(Curve) -> SurfaceOfRevolution<Curve>;

}  // namespace darboux
