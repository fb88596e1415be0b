/// \file ruled_surface.h
#pragma once

#include <algorithm>
#include <concepts>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <darboux/curve.h>
#include <darboux/surface.h>

namespace darboux {

/// Ruled surface between two curves.
///   P(u, v) = (1 - v) A(u) + v B(u)
/// u runs along both curves, whose parameters are of one kind, v from A (0) to B (1) on straight lines. n =
/// dpdu × dpdv / |.|. The frame is that of the partials. Where dpdu = (1 - v) A' + v B' vanishes (the tip of
/// a cone, v = 0 if A is a point) the status is dpdu_zero; where A and B meet it is dpdv_zero. Where dpdu and
/// dpdv are parallel (the edge of a tangent developable) it is parallel, and n is the limit along v. At a
/// corner of a curve it is crease, and the frame is that from above. [doCarmo2016, sec. 3-5]
template <class CurveA = LineSegment<double>, class CurveB = HelixCurve<typename CurveA::scalar>>
struct RuledSurface {
  static_assert(CurveA::kind == CurveB::kind, "both curves must have parameters of one kind");
  static_assert(std::same_as<typename CurveA::scalar, typename CurveB::scalar>);
  using scalar = typename CurveA::scalar;
  static constexpr bool curvature_in_lanes = false;  // its fact scales by the sizes of one point
  CurveA a{};
  CurveB b{};

  static constexpr SurfaceInfo info{"ruled-surface",
                                    "ruled surface between two curves",
                                    CurveA::kind,
                                    Coordinate::linear,
                                    {"curves meet", "dpdu parallel to dpdv", "corners of the curves"}};
  std::string refusal() const {
    if (const std::string why = detail::curve_refusal(a); !why.empty()) return "the first curve: " + why;
    if (const std::string why = detail::curve_refusal(b); !why.empty()) return "the second curve: " + why;
    return {};
  }

  /// The interior knots of both curves, along u (0).
  std::vector<double> breaks(int along) const {
    std::vector<double> result;
    if (along != 0) return result;
    const std::vector<double> of_a = detail::curve_breaks(a), of_b = detail::curve_breaks(b);
    std::set_union(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(result));
    return result;
  }

  template <class P, class S>
  Jet2<S> jet(const P& u, const S& v) const {
    const S zero = lift<S>(0.0), rest = lift<S>(1.0) - v;
    const CurveJet<S> p = a.jet(u), q = b.jet(u);
    return {.position = rest * p.position + v * q.position,
            .dpdu = rest * p.first + v * q.first,
            .dpdv = q.position - p.position,
            .d2pdu2 = rest * p.second + v * q.second,
            .d2pduv = q.first - p.first,
            .d2pdv2 = {zero, zero, zero}};
  }

  template <class P, class S>
  Status singular(const P& u, const S& v) const {
    const Jet2<S> j = jet(u, v);
    return detail::curve_status(a, u) | detail::curve_status(b, u) |
           (detail::vanishes(j.dpdu) ? Status::dpdu_zero : Status::regular) |
           (detail::vanishes(j.dpdv) ? Status::dpdv_zero : Status::regular);
  }

  /// K = -(det(A', B', B - A)/|N|²)², N = ((1 - v) A' + v B') × (B - A): zero where the tangents of A and
  /// B and the line lie in one plane. [doCarmo2016, sec. 3-5]
  template <class P, class S>
  S gaussian_curvature(const P& u, const S& v) const {
    const CurveJet<S> p = a.jet(u), q = b.jet(u);
    const int e = std::max(detail::exponent(p.first), detail::exponent(q.first));
    const Vec3<S> line = q.position - p.position;
    const int f = detail::exponent(line);
    const Vec3<S> da = detail::scaled_by_power_of_two(p.first, -e),
                  db = detail::scaled_by_power_of_two(q.first, -e),
                  c = detail::scaled_by_power_of_two(line, -f);
    const S area = norm(cross((lift<S>(1.0) - v) * da + v * db, c));
    const S k = detail::scaled_by_power_of_two(S(dot(da, cross(db, c)) / area / area), -f);
    return -(k * k);
  }
  /// A + v (B - A), with the curves' own other formulas.
  template <class P, class S>
  Vec3<S> second_formula(const P& u, const S& v) const {
    const Vec3<S> p = again<S>(a, u), q = again<S>(b, u);
    return p + v * (q - p);
  }

  /// The same surface over another scalar.
  template <class To>
  auto rebind() const {
    auto first = detail::rebound<To>(a);
    auto second = detail::rebound<To>(b);
    return RuledSurface<decltype(first), decltype(second)>{std::move(first), std::move(second)};
  }

 private:
  template <class S, class C, class P>
  static Vec3<S> again(const C& curve, const P& u) {
    if constexpr (requires { curve.second_formula(u); })
      return curve.second_formula(u);
    else
      return curve.jet(u).position;
  }
};
template <class A, class B>
RuledSurface(A, B) -> RuledSurface<A, B>;

}  // namespace darboux
