#include "enclosed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <darboux/bezier_patch.h>
#include <darboux/bilinear_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/catenoid.h>
#include <darboux/ellipsoid.h>
#include <darboux/elliptic_paraboloid.h>
#include <darboux/enneper.h>
#include <darboux/extrusion.h>
#include <darboux/graph.h>
#include <darboux/helicoid.h>
#include <darboux/hyperbolic_paraboloid.h>
#include <darboux/klein_bottle.h>
#include <darboux/moebius_strip.h>
#include <darboux/monkey_saddle.h>
#include <darboux/one_sheet_hyperboloid.h>
#include <darboux/point.h>
#include <darboux/pseudosphere.h>
#include <darboux/ruled_surface.h>
#include <darboux/superellipsoid.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/torus.h>
#include <darboux/tube.h>
#include <darboux/two_sheet_hyperboloid.h>

namespace darboux::tiles {
namespace {

using E = Enclosure;
using V = Vec3<Enclosure>;

constexpr double infinity = std::numeric_limits<double>::infinity();

V point(const Vec3<double>& a) {
  return {a.x, a.y, a.z};
}
E length(const V& a) {
  return sqrt(square(a.x) + square(a.y) + square(a.z));
}
double over(double a, double least) {
  return least > 0 ? (Interval(a) / least).hi : infinity;
}
// The length of a vector: that of its enclosure, or a bound found by other means.
double length_of(const V& enclosed, const Interval& bound) {
  const double a = length(enclosed).hi();
  return std::isnan(a) ? bound.hi : std::fmin(a, bound.hi);
}

// dpdu × dpdv and its derivatives.
struct Normals {
  V n, n_u, n_v;
  explicit Normals(const Jet2<E>& j)
      : n(cross(j.dpdu, j.dpdv)),
        n_u(cross(j.d2pdu2, j.dpdv) + cross(j.dpdu, j.d2pduv)),
        n_v(cross(j.d2pduv, j.dpdv) + cross(j.dpdu, j.d2pdv2)) {}
};

// ---- derivatives of unit vectors
// ---------------------------------------------------------------------------

// A derivative of n = N/s, s = |N|.
struct Slope {
  V N, n;                  // N_a, n_a
  E s;                     // s_a
  double length, turning;  // |N_a|, |n_a|
};
struct UnitVector {
  V n;
  E s;
  Slope u, v;
  UnitVector(const V& N, const V& N_u, const V& N_v)
      : n(N / length(N)), s(length(N)), u(slope(N_u)), v(slope(N_v)) {}

  // From N_ab = s_ab n + s_a n_b + s_b n_a + s n_ab: the part of n_ab across n; along n it is -n_a·n_b.
  struct Second {
    V n;
    double across, length;  // of the part perpendicular to n, and of all
  };
  Second second(const Slope& a, const Slope& b, const V& N_ab) const {
    const V rest = N_ab - a.s * b.n - b.s * a.n, part = (rest - dot(n, rest) * n) / s;
    const Interval bound =
        length(N_ab).range + Interval(a.length) * b.turning + Interval(b.length) * a.turning;
    const double across = length_of(part, over(bound.hi, s.lo()));
    const Interval along = Interval(a.turning) * b.turning;
    return {part - dot(a.n, b.n) * n, across, sqrt(along * along + Interval(across) * across).hi};
  }

 private:
  Slope slope(const V& N_a) const {
    const E s_a = dot(n, N_a);
    const V n_a = (N_a - s_a * n) / s;
    const double most = length(N_a).hi();
    return {N_a, n_a, s_a, most, length_of(n_a, over(most, s.lo()))};
  }
};

// The second derivatives of n, t and b = n × t from the partials to third order.
struct ThirdPartials {
  V uuu, uuv, uvv, vvv;
};
TileRates second_rates(const Jet2<E>& j, const ThirdPartials& third) {
  const Normals normals(j);
  const UnitVector n(normals.n, normals.n_u, normals.n_v), t(j.dpdu, j.d2pdu2, j.d2pduv);
  const E two(2);
  const std::array n_second{
      n.second(n.u, n.u,
               cross(third.uuu, j.dpdv) + two * cross(j.d2pdu2, j.d2pduv) + cross(j.dpdu, third.uuv)),
      n.second(n.u, n.v, cross(third.uuv, j.dpdv) + cross(j.d2pdu2, j.d2pdv2) + cross(j.dpdu, third.uvv)),
      n.second(n.v, n.v,
               cross(third.uvv, j.dpdv) + two * cross(j.d2pduv, j.d2pdv2) + cross(j.dpdu, third.vvv))};
  const std::array t_second{t.second(t.u, t.u, third.uuu), t.second(t.u, t.v, third.uuv),
                            t.second(t.v, t.v, third.uvv)};
  const V b = cross(n.n, t.n);
  const auto frame = [&](std::size_t k, const Slope& n_a, const Slope& n_b, const Slope& t_a,
                         const Slope& t_b) {
    const V b_ab =
        cross(n_second[k].n, t.n) + cross(n_a.n, t_b.n) + cross(n_b.n, t_a.n) + cross(n.n, t_second[k].n);
    const Interval bound = Interval(n_second[k].length) + t_second[k].length +
                           Interval(n_a.turning) * t_b.turning + Interval(n_b.turning) * t_a.turning;
    return std::fmax(std::fmax(n_second[k].across, t_second[k].across),
                     length_of(b_ab - dot(b, b_ab) * b, bound));
  };
  TileRates r;
  r.frame_uu = frame(0, n.u, n.u, t.u, t.u);
  r.frame_uv = frame(1, n.u, n.v, t.u, t.v);
  r.frame_vv = frame(2, n.v, n.v, t.v, t.v);
  r.normal_uu = n_second[0].across, r.normal_uv = n_second[1].across, r.normal_vv = n_second[2].across;
  return r;
}

// ---- knots
// -------------------------------------------------------------------------------------------------

// Where a surface is only piecewise smooth along u or v, and how many derivatives are continuous there.
struct Break {
  double at;
  int continuous;
};

void add_knots(std::vector<Break>& breaks, const KnotVector<double>& knots, int lost = 0) {
  for (const double at : knots.breaks()) {
    const auto count = std::count(knots.knots().begin(), knots.knots().end(), at);
    breaks.push_back({at, knots.degree() - static_cast<int>(count) - lost});
  }
}
// The breaks of a curve, of whose derivatives `lost` appear in the surface's position.
template <class C>
void add_curve(std::vector<Break>& breaks, const C& curve, int lost = 0) {
  if constexpr (requires { curve.knots(); })
    add_knots(breaks, curve.knots(), lost);
  else if constexpr (requires { curve.curve; })
    add_curve(breaks, curve.curve, lost);
}

template <class X>
std::vector<Break> breaks_of(const X& s, int along) {
  std::vector<Break> result;
  if constexpr (requires { s.knots_u(); }) add_knots(result, along == 0 ? s.knots_u() : s.knots_v());
  if constexpr (requires { s.profile; })
    if (along == 1) add_curve(result, s.profile);
  if constexpr (requires { s.curve; })
    if (along == 0)
      add_curve(
          result, s.curve, requires { s.radius; } ? 1 : 0);
  if constexpr (requires {
                  s.a.jet(0.5);
                  s.b.jet(0.5);
                })
    if (along == 0) {
      add_curve(result, s.a);
      add_curve(result, s.b);
      std::sort(result.begin(), result.end(), [](const Break& x, const Break& y) { return x.at < y.at; });
    }
  return result;
}

// The tile's part of an axis, cut where the surface is not smooth. A crease at its upper end belongs to the
// tile with the frame from above.
struct Cuts {
  std::vector<Interval> pieces;
  int continuous = 2;  // derivatives, 2 standing for more

  Cuts(const std::vector<Break>& breaks, double from, double to) {
    for (const Break& b : breaks) {
      if (b.at <= from || b.at > to || (b.at == to && b.continuous >= 1)) continue;
      if (from < b.at) pieces.push_back({from, b.at});
      from = b.at;
      continuous = std::min(continuous, b.continuous);
    }
    pieces.push_back({from, to});
  }
};

// ---- running formulas
// --------------------------------------------------------------------------------------

// The quantities over a tile from which bounds are computed.
struct Partials {
  Jet2<E> jet;
  ThirdPartials third;

  friend Partials hull(Partials a, const Partials& b) {
    const auto unite = [](V& x, const V& y) { x = {hull(x.x, y.x), hull(x.y, y.y), hull(x.z, y.z)}; };
    for (const auto member : {&Jet2<E>::position, &Jet2<E>::dpdu, &Jet2<E>::dpdv, &Jet2<E>::d2pdu2,
                              &Jet2<E>::d2pduv, &Jet2<E>::d2pdv2})
      unite(a.jet.*member, b.jet.*member);
    for (const auto member :
         {&ThirdPartials::uuu, &ThirdPartials::uuv, &ThirdPartials::uvv, &ThirdPartials::vvv})
      unite(a.third.*member, b.third.*member);
    return a;
  }
};

template <class X>
Partials partials_over(const X& surface, const E& u, const E& v, bool third) {
  const auto jet_at = [&](const auto& x, const auto& y) {
    return surface.jet(prepare<X::info.u>(x), prepare<X::info.v>(y));
  };
  if (!third) return {jet_at(u, v), {}};
  using D = Dual<E, 2>;
  const Jet2<D> j = jet_at(D::variable(u, 0), D::variable(v, 1));
  const auto value = [](const Vec3<D>& a) { return V{a.x.value, a.y.value, a.z.value}; };
  const auto along = [](const Vec3<D>& a, std::size_t k) {
    return V{a.x.derivative[k], a.y.derivative[k], a.z.derivative[k]};
  };
  return {
      {value(j.position), value(j.dpdu), value(j.dpdv), value(j.d2pdu2), value(j.d2pduv), value(j.d2pdv2)},
      {along(j.d2pdu2, 0), along(j.d2pdu2, 1), along(j.d2pdv2, 0), along(j.d2pdv2, 1)}};
}

template <class X>
Enclosed enclose_as(const X& surface, const Tile& tile, TileOrder order) {
  const Cuts u(breaks_of(surface, 0), tile.u0, tile.u1), v(breaks_of(surface, 1), tile.v0, tile.v1);
  const int continuous = std::min(u.continuous, v.continuous);
  const bool second = order == TileOrder::second && continuous >= 2;
  std::optional<Partials> all;
  for (const Interval& piece_u : u.pieces)
    for (const Interval& piece_v : v.pieces) {
      const Partials here = partials_over(surface, E::variable(piece_u.lo, piece_u.hi, 0),
                                          E::variable(piece_v.lo, piece_v.hi, 1), second);
      all = all ? hull(*all, here) : here;
    }
  const Jet2<E>& jet = all->jet;
  const V normal = cross(jet.dpdu, jet.dpdv);
  const Interval area = length(normal).range;
  double side = 1;
  // A smooth n of the surface's own is on one side of dpdu × dpdv as long as that does not vanish.
  if constexpr (X::info.own_orientation)
    side = area.lo > 0 && continuous >= 1
               ? frame(surface, 0.5 * (tile.u0 + tile.u1), 0.5 * (tile.v0 + tile.v1)).handedness
               : 0;
  return {.jet = jet,
          .normal = normal,
          .area = area,
          .side = side,
          .smooth = continuous >= 1,
          .second = second ? second_rates(jet, all->third) : TileRates{}};
}

// Selects the type of the surface.
template <class... X>
std::shared_ptr<const Enclosed> enclose_one_of(const AnySurface& surface, const Tile& tile, TileOrder order) {
  std::shared_ptr<const Enclosed> result;
  const auto attempt = [&](const auto* s) {
    if (s) try {
        result = std::make_shared<const Enclosed>(enclose_as(*s, tile, order));
      } catch (const Uncertain&) {
      }
    return s != nullptr;
  };
  (attempt(surface.get<X>()) || ...);
  return result;
}

}  // namespace

std::shared_ptr<const Enclosed> enclose(const AnySurface& surface, const Tile& tile, TileOrder order) {
  using Spline = BSplineCurve<>;
  // Surfaces without closed-form bounds whose formulas can be evaluated on intervals.
  return enclose_one_of<
      Torus<>, Ellipsoid<>, EllipticParaboloid<>, HyperbolicParaboloid<>, OneSheetHyperboloid<>,
      TwoSheetHyperboloid<>, Helicoid<>, Catenoid<>, MoebiusStrip<>, KleinBottle<>, Enneper<>, MonkeySaddle<>,
      Pseudosphere<>, BilinearPatch<>, Graph<>, Superellipsoid<>, BezierPatch<>, BSplinePatch<>,  //
      Tube<>, Tube<CircleCurve<>>, Tube<LineSegment<>>, Tube<PlanarCurve<>>, Tube<UprightCurve<>>,
      Tube<UprightCurve<Spline>>,                                    //
      SurfaceOfRevolution<>, Extrusion<>, Extrusion<CircleCurve<>>,  //
      RuledSurface<>, RuledSurface<LineSegment<>, LineSegment<>>, RuledSurface<LineSegment<>, Spline>,
      RuledSurface<Spline, Spline>, RuledSurface<CircleCurve<>, CircleCurve<>>>(surface, tile, order);
}

double enclosed_support(const Enclosed& s, const Vec3<double>& direction) {
  return dot(point(direction), s.jet.position).hi();
}

double enclosed_facing(const Enclosed& s, const Vec3<double>& e, double offset) {
  if (s.side == 0) return infinity;
  const V eye = point(e);
  const double g = (E(s.side) * dot(s.normal, offset == 0 ? eye : eye - s.jet.position)).hi();
  return g < 0 ? g / s.area.hi : s.area.lo > 0 ? g / s.area.lo : infinity;
}

TileRates enclosed_rates(const Enclosed& s) {
  if (!s.smooth) return {};
  const auto most = [](const V& a) { return length(a).hi(); };
  const Normals normals(s.jet);
  const double least_du = length(s.jet.dpdu).lo();
  TileRates r = s.second;
  r.position_uu = most(s.jet.d2pdu2), r.position_uv = most(s.jet.d2pduv), r.position_vv = most(s.jet.d2pdv2);
  r.normal_u = over(most(normals.n_u), s.area.lo);
  r.normal_v = over(most(normals.n_v), s.area.lo);
  // The frame turns by |ω|² = |t'|² + (n'·b)².
  const auto turning = [&](double t, double n) { return sqrt(Interval(t) * t + Interval(n) * n).hi; };
  r.frame_u = turning(over(r.position_uu, least_du), r.normal_u);
  r.frame_v = turning(over(r.position_uv, least_du), r.normal_v);
  return r;
}

}  // namespace darboux::tiles
