/// \file extrusion.h
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <darboux/curve.h>
#include <darboux/surface.h>

namespace darboux {

/// Extrusion of a curve along a direction (a general cylinder).
///   P(u, v) = K(u) + v d
/// u runs along the curve, v from the curve (0) to its copy at d (1). n = K' × d / |.|: outward for a curve
/// that runs counter-clockwise as seen from the tip of d. Where the curve stops (K' = 0) the status is
/// dpdu_zero; the frame is the limit from above (at u = 1 from below) by the first derivative that does not
/// vanish, with crease where the curve turns back. At a corner of the curve the status is crease, and the
/// frame is that from above. Where d is tangent to the curve the status is parallel; n is the limit by the
/// first of K'' × d and the third derivative × d that does not vanish, with crease where n turns over. t
/// errs by at most 2u (1 + condition), u the unit roundoff, the condition being that of K'; n errs by that
/// over the sine of the angle between K' and d. [doCarmo2016, sec. 3-3]
template <class Curve = BSplineCurve<double>>
struct Extrusion {
  using scalar = typename Curve::scalar;
  static constexpr int curve_along = 0;
  Curve curve{};
  Vec3<scalar> direction{scalar(0), scalar(0), scalar(1)};

  static constexpr SurfaceInfo info{"extrusion",
                                    "extrusion of a curve along a direction",
                                    Curve::kind,
                                    Coordinate::linear,
                                    {"direction tangent to the curve", "corners of the curve"}};
  static constexpr auto parameters() {
    using V = Vec3<scalar>;
    return std::array{
        parameter<&Extrusion::direction, &V::x>("direction_x", Range{}, "from the curve to its copy; length"),
        parameter<&Extrusion::direction, &V::y>("direction_y", Range{}, "from the curve to its copy; length"),
        parameter<&Extrusion::direction, &V::z>("direction_z", Range{},
                                                "from the curve to its copy; length")};
  }
  std::string refusal() const {
    if (detail::vanishes(direction)) return "the direction: expected one that is not zero, got zero";
    return detail::curve_refusal(curve);
  }

  /// The interior knots of the curve, along u (0).
  std::vector<double> breaks(int along) const {
    return along == 0 ? detail::curve_breaks(curve) : std::vector<double>{};
  }

  template <class P, class S>
  Jet2<S> jet(const P& u, const S& v) const {
    const S zero = lift<S>(0.0);
    const Vec3<S> nothing{zero, zero, zero}, d = detail::lift_vector<S>(direction);
    const CurveJet<S> k = curve.jet(u);
    return {.position = k.position + v * d,
            .dpdu = k.first,
            .dpdv = d,
            .d2pdu2 = k.second,
            .d2pduv = nothing,
            .d2pdv2 = nothing};
  }

  template <class P, class S>
  Frame<S> frame(const P& u, const S&) const {
    const CurveJet<S> k = curve.jet(u);
    const auto way = detail::passage<Curve::kind>(k, u), across = passage_across(k, u);
    if (across.order == 0) return detail::no_frame<S>();
    const Vec3<S>& n = across.direction;
    return {.t = way.direction, .b = accurate_cross(n, way.direction), .n = n};
  }

  template <class P, class S>
  Status singular(const P& u, const S&) const {
    const CurveJet<S> k = curve.jet(u);
    const auto way = detail::passage<Curve::kind>(k, u), across = passage_across(k, u);
    Status result =
        detail::curve_status(curve, u) | detail::passage_status<Curve::kind>(way, u, Status::dpdu_zero);
    if (across.order != way.order) result |= detail::passage_status<Curve::kind>(across, u, Status::parallel);
    return result;
  }

  /// The same surface where its curve is at u, with derivatives to an order.
  template <int order, class P>
  auto with_curve_at(const P& u) const {
    auto at = detail::curve_at_place<order>(curve, u);
    using S = typename decltype(at)::scalar;
    return Extrusion<decltype(at)>{at, detail::lift_vector<S>(direction)};
  }

  /// K = 0
  template <class P, class S>
  S gaussian_curvature(const P&, const S&) const {
    return lift<S>(0.0);
  }
  /// The curve's point by its other formula, and v d.
  template <class P, class S>
  Vec3<S> second_formula(const P& u, const S& v) const requires requires(const Curve& c) {
    c.second_formula(u);
  }
  { return curve.second_formula(u) + v * detail::lift_vector<S>(direction); }

  /// The same extrusion over another scalar.
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(curve);
    return Extrusion<decltype(rebound)>{std::move(rebound), detail::lift_vector<To>(direction)};
  }

 private:
  // How K × d passes u: along n.
  template <class S, class P>
  detail::Passage<S> passage_across(const CurveJet<S>& k, const P& u) const {
    const Vec3<S> d = unit(detail::lift_vector<S>(direction));
    if constexpr (detail::Lanewise<S>) {  // those that run along d go by themselves
      const Vec3<S> c = accurate_cross(unit(k.first), d);
      using T = typename S::Element;
      const S rest(static_cast<T>(32 * detail::rounding_of<T>()));
      if ((abs(c.x) <= rest && abs(c.y) <= rest && abs(c.z) <= rest).any()) S::diverge();
      return {unit(c), 1};
    } else {
      // What rounding leaves of a cross that vanishes is below some units of this and the derivatives before
      // it.
      double size = 0;
      const auto across = [&](const Vec3<S>& x) {
        const Vec3<S> c = accurate_cross(unit(x), d);
        const S zero = lift<S>(0.0);
        const double own = detail::largest_component(x);
        size = std::fmax(size, own);
        const double rest = 32 * detail::rounding_of<S>() * (size / own);
        const auto vanishes = [&](const S& part) { return detail::size_of(part) <= rest; };  // NaN does not
        return vanishes(c.x) && vanishes(c.y) && vanishes(c.z) ? Vec3<S>{zero, zero, zero} : c;
      };
      const Vec3<S> first = across(k.first), second = across(k.second), third = across(k.third);
      return detail::passage<Curve::kind>(CurveJet<S>{k.position, first, second, third}, u);
    }
  }
};
template <class Curve, class T>
Extrusion(Curve, Vec3<T>) -> Extrusion<Curve>;
template <class Curve>
Extrusion(Curve) -> Extrusion<Curve>;

}  // namespace darboux
