// Every point that a surface of the catalogue declares singular: the frame there is the limit along the given
// u (or v), with the bits that say why, or there is none and the vectors are NaN.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/evaluate.h>
#include <darboux/framed_curve.h>

#include "every_surface.h"
#include "expect_limit.h"

namespace darboux::test::singular_points_test {
namespace {

using Points = std::vector<Vec2<double>>;
using Vec = Vec3<double>;

// ---- the declared points ----------------------------------------------------------------------------------

// One entry of SurfaceInfo::singular, and what holds there.
struct Declared {
  std::string_view surface, where;
  std::string title;
  std::function<void()> law;
};
void PrintTo(const Declared& declared, std::ostream* out) {
  *out << declared.surface << ", " << declared.where;
}

template <class X>
Declared limit(std::string_view where, std::string title, X surface, Points points, Vec2<double> inward,
               Status expected, Law law = {}) {
  return {X::info.name, where, std::move(title), [=] {
            for (const auto& p : points) expect_limit(surface, p, inward, expected, law);
          }};
}
template <class X>
Declared no_limit(std::string_view where, std::string title, X surface, Points points, Status expected,
                  bool none_near = false) {
  return {X::info.name, where, std::move(title), [=] {
            for (const auto& p : points) expect_no_limit(surface, p, expected, none_near);
          }};
}

// The given u at one v, and the given v at one u.
Points round(double v) {
  return {{0, v}, {0.1, v}, {0.25, v}, {0.5, v}, {0.7, v}, {1, v}};
}
Points inside(double v) {
  return {{0.1, v}, {0.3, v}, {0.5, v}, {0.8, v}};
}
Points beside(double u) {
  return {{u, 0.1}, {u, 0.3}, {u, 0.5}, {u, 0.8}};
}

// A net of (p + 1)(q + 1) points whose first row P_i0 is one point; the others fan out.
std::vector<Vec> fan(int p, int q) {
  std::vector<Vec> net;
  for (int i = 0; i <= p; ++i)
    for (int j = 0; j <= q; ++j) {
      const double angle = 1.5 * i / p, r = 1.0 * j / q;
      net.push_back({r * std::cos(angle) + 3, r * std::sin(angle), 0.2 * r * i - 0.3 * r * r - 1});
    }
  return net;
}
std::vector<double> some_weights(std::size_t count) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < count; ++i) weights.push_back(0.5 + static_cast<double>(i * 7 % 5));
  return weights;
}

// A polyline in the xz plane with corners at the middle and at three quarters.
BSplineCurve<double> broken_line() {
  return {1, {0, 0, 0.5, 0.75, 1, 1}, {{1, 0, 0}, {2, 0, 1}, {1, 0, 2}, {1, 0, 3}}};
}
// Of degree 2, with one corner in the middle.
BSplineCurve<double> two_arcs() {
  return {2, {0, 0, 0, 0.5, 0.5, 1, 1, 1}, {{1, 0, 0}, {2, 0, 0.5}, {2, 0, 1}, {1, 0, 1.5}, {1, 0, 2}}};
}
// The edge of regression of a tangent developable, and its tangent's end.
constexpr auto twisted_cubic = []<class S>(const S& t) { return Vec3<S>{t, t * t, t * t * t}; };
constexpr auto on_its_tangent = []<class S>(const S& t) {
  const S two = lift<S>(2.0), three = lift<S>(3.0);
  return Vec3<S>{t + lift<S>(1.0), t * t + two * t, t * t * t + three * (t * t)};
};

// A profile that touches the axis half way, from ρ < 0.
constexpr auto touching = []<class S>(const S& t) {
  const S x = t - lift<S>(0.5);
  return Vec3<S>{-(x * x), lift<S>(0.0), x};
};

void superellipsoid_poles(double v) {
  for (const double ev : {0.3, 0.5, 1.0, 1.5, 1.75, 2.0, 2.5})
    for (const double eu : {0.5, 1.0, 1.5, 2.0, 2.5}) {
      SCOPED_TRACE(::testing::Message() << "exponent_v " << ev << ", exponent_u " << eu);
      const Superellipsoid surface{1.0, 0.7, 1.2, ev, eu};
      const Status partials = ev > 1 ? dpdu_zero | dpdv_zero : ev < 1 ? dpdu_zero | overflow : dpdu_zero;
      for (const double u : {0.03, 0.1, 0.37, 0.62, 0.9})
        expect_limit(surface, {u, v}, v == 0 ? along_v : against_v, partials | limit_frame,
                     {.rate = ev == 2 ? 1 : std::fabs(2 - ev), .factor = 100});
    }
}
void superellipsoid_equator() {
  for (const double ev : {0.3, 0.5, 1.0, 1.5, 1.75, 2.0, 2.5})
    for (const double eu : {0.5, 1.0, 1.5, 2.5}) {
      SCOPED_TRACE(::testing::Message() << "exponent_v " << ev << ", exponent_u " << eu);
      const Superellipsoid surface{1.0, 0.7, 1.2, ev, eu};
      const Law law{.rate = ev == 2 ? 1 : std::fabs(2 - ev), .factor = 100};
      for (const double u : {0.03, 0.1, 0.37, 0.62, 0.9}) {
        if (ev == 1) {
          expect_status(surface, u, 0.5, regular);
          continue;
        }
        Status expected = limit_frame | (ev > 1 ? dpdv_zero : overflow);
        if (ev >= 2) expected |= crease;  // that of the side where cos πv > 0
        expect_limit(surface, {u, 0.5}, against_v, expected, law);
        if (ev < 2) expect_limit(surface, {u, 0.5}, along_v, expected, law);
        if (ev >= 2) {
          EXPECT_GT(distance(frame(surface, u, 0.5), frame(surface, u, 0.5 + 1e-9)), 0.1);
        }
      }
    }
}
void superellipsoid_meridians() {
  for (const double ev : {0.5, 1.0, 1.5, 2.5})
    for (const double eu : {0.3, 0.5, 1.0, 1.5, 1.75, 2.0, 2.5}) {
      SCOPED_TRACE(::testing::Message() << "exponent_v " << ev << ", exponent_u " << eu);
      const Superellipsoid surface{1.0, 0.7, 1.2, ev, eu};
      const Law law{.rate = eu == 2 ? 1 : std::fabs(2 - eu), .factor = 100};
      for (const double v : {0.1, 0.3, 0.6})
        for (const double u : {0.0, 0.25, 0.5, 0.75}) {
          if (eu == 1) {
            expect_status(surface, u, v, regular);
            continue;
          }
          Status expected = limit_frame | (eu > 1 ? dpdu_zero : overflow);
          if (eu >= 2) expected |= crease;  // that of the side where the cosine or sine is positive
          const bool positive_above = u == 0.0 || u == 0.75;
          if (eu < 2 || positive_above) expect_limit(surface, {u, v}, along_u, expected, law);
          if (eu < 2 || !positive_above) expect_limit(surface, {u, v}, against_u, expected, law);
          if (eu >= 2) {
            const double beyond = positive_above ? u - 1e-9 : u + 1e-9;
            EXPECT_GT(distance(frame(surface, u, v), frame(surface, beyond, v)), 0.1);
          }
        }
    }
}

// A spindle torus meets its axis where R + r cos 2πv is zero to the last bit: outside the limit, inside -t
// and -b.
void spindle_torus() {
  int met = 0;
  for (int i = 0; i < 400; ++i) {
    const double v = 0.25 + i * 0.0005, r = 1.0, R = -r * sincos_turns(v).cos;
    const Torus torus{R + 0.0, r};
    if (!has(status(torus, 0.1, v), dpdu_zero)) continue;
    ++met;
    for (const double u : {0.0, 0.1, 0.7}) {
      expect_limit(torus, {u, v}, against_v, dpdu_zero | limit_frame);
      const Frame<double> at = frame(torus, u, v), within = frame(torus, u, v + 1e-9);
      const auto [s, c] = sincos_turns(u);
      EXPECT_EQ(at.t, (Vec{-s, c, 0}));
      EXPECT_EQ(at.handedness, 1);
      EXPECT_EQ(within.status, self_intersecting);
      EXPECT_EQ(within.handedness, -1);
      EXPECT_EQ(within.t, -at.t);
      EXPECT_LE(norm(within.n - at.n), 1e-8);
    }
  }
  EXPECT_GE(met, 10);
}

// Where the figure 8 is widest it points at the axis: for R = r it touches it, for R < r it goes through.
void klein_bottle_touches() {
  const KleinBottle touching{0.7, 0.7};
  const Status at = self_intersecting | parallel | limit_frame;
  for (const Vec2<double>& p : Points{{1, 0.25}, {0, 0.75}})
    for (const auto& side : {along_u, against_u}) expect_limit(touching, p, side, at);
  int met = 0;
  for (const double u : {0.55, 0.6, 0.625, 0.65}) {
    const double r = 1.0, R = -r * sincos_half_turns(u).cos;
    const KleinBottle through{R, r};
    if (!has(status(through, u, 0.25), parallel)) continue;
    ++met;
    expect_no_limit(through, {u, 0.25}, self_intersecting | parallel);
    // There is none: n turns by a finite angle over a vanishing circle.
    double turned = 0;
    for (const double angle : {0.1, 0.2, 0.4}) {
      const auto [s, c] = sincos_turns(angle);
      const Vec a = frame(through, u + 1e-6 * c, 0.25 + 1e-6 * s).n,
                b = frame(through, u - 1e-6 * c, 0.25 - 1e-6 * s).n;
      turned = std::max(turned, norm(a - b));
    }
    EXPECT_GT(turned, 1);
  }
  EXPECT_GE(met, 2);
}

template <class X>
void both_poles(std::vector<Declared>& all, const X& surface, const std::string& which = {}) {
  all.push_back(limit("v=0", "south pole" + which, surface, round(0), along_v, dpdu_zero | limit_frame));
  all.push_back(limit("v=1", "north pole" + which, surface, round(1), against_v, dpdu_zero | limit_frame));
}

std::vector<Declared> declared_points() {
  std::vector<Declared> all;
  const Status collapsed = dpdu_zero | limit_frame;
  both_poles(all, Sphere{3.0});
  both_poles(all, Ellipsoid{1.0, 0.7, 0.5});
  both_poles(all, Ellipsoid{1.0, 1.2, 3.0}, " of a long one");
  all.push_back(limit("v=1", "apex", Cone{1.0, 2.0}, round(1), against_v, collapsed));
  all.push_back(limit("v=1", "apex, the cone beyond it", Cone{1.0, 2.0}, round(1), along_v, collapsed,
                      {.near = Status::outside_domain}));
  all.push_back(limit("v=1 if inner_radius=0", "centre", Disk{2.0, 0.0}, round(1), against_v, collapsed));
  all.push_back(limit("v=0", "tip", EllipticParaboloid{1.0, 0.7, 0.5}, round(0), along_v, collapsed));
  all.push_back(limit("v=0", "tip", TwoSheetHyperboloid{1.0, 0.7, 0.5, 1.5}, round(0), along_v, collapsed));

  const std::string_view axis = Torus<>::info.singular[0];
  all.push_back(limit(axis, "horn torus from below", Torus{0.5, 0.5}, round(0.5), along_v, collapsed));
  all.push_back(limit(axis, "horn torus from above", Torus{0.5, 0.5}, round(0.5), against_v, collapsed));
  all.push_back(
      limit(axis, "torus without major radius", Torus{0.0, 1.0}, round(0.25), against_v, collapsed));
  all.push_back(
      limit(axis, "torus without major radius, below", Torus{0.0, 1.0}, round(0.75), along_v, collapsed));
  all.push_back({"torus", axis, "spindle torus", spindle_torus});

  const std::string_view flat = Helicoid<>::info.singular[0];
  all.push_back(limit(flat, "axis within", Helicoid{0.0, 1.0, -0.5, 1.0}, round(0.5), along_v, collapsed,
                      {.near = self_intersecting}));  // the line passes twice, with s and with -s
  all.push_back(limit(flat, "axis first", Helicoid{0.0, 2.0, 0.0, 1.0}, round(0), along_v, collapsed));
  all.push_back(limit(flat, "axis last", Helicoid{0.0, 1.0, -1.0, 1.0}, round(1), against_v, collapsed));

  const std::string_view cusp = Pseudosphere<>::info.singular[0];
  const Status edge = dpdv_zero | crease | limit_frame;
  const double half_pi = 1.5707963267948966;
  for (const double pitch : {0.0, 0.3}) {
    const std::string which = pitch == 0.0 ? "" : " of Dini's surface";
    all.push_back(limit(cusp, "cusp within" + which,
                        Pseudosphere{1.0, pitch, 1.0, half_pi / 2, 3 * half_pi / 2}, round(0.5), against_v,
                        edge));
    all.push_back(limit(cusp, "cusp first" + which, Pseudosphere{2.0, pitch, 1.0, half_pi, 2.5}, round(0),
                        along_v, edge));
    all.push_back(limit(cusp, "cusp last" + which, Pseudosphere{2.0, pitch, 1.0, half_pi / 2, half_pi},
                        round(1), against_v, edge));
  }

  const auto& of_superellipsoid = Superellipsoid<>::info.singular;
  all.push_back({"superellipsoid", of_superellipsoid[0], "south pole", [] { superellipsoid_poles(0); }});
  all.push_back({"superellipsoid", of_superellipsoid[1], "north pole", [] { superellipsoid_poles(1); }});
  all.push_back({"superellipsoid", of_superellipsoid[2], "equator", superellipsoid_equator});
  all.push_back({"superellipsoid", of_superellipsoid[3], "meridians", superellipsoid_meridians});
  all.push_back({"klein-bottle", KleinBottle<>::info.singular[0], "axis", klein_bottle_touches});

  const std::string_view focal = Tube<>::info.singular[0];
  for (const auto& side : {along_v, against_v}) {
    const std::string which = side.y > 0 ? ", above" : ", below";
    const Tube round_tube{CircleCurve{1.5}, 1.5};
    all.push_back(limit(focal, "tube of a circle" + which, round_tube, round(0), side, collapsed));
    // Curvature R/(R² + p²) = 1/2; with torsion dpdu does not vanish there but is parallel to dpdv.
    const Tube twisted{HelixCurve{1.0, 1.0, 1.0}, 2.0};
    all.push_back(limit(focal, "tube of a helix" + which, twisted, round(0), side, parallel | limit_frame));
  }

  const auto& of_bilinear = BilinearPatch<>::info.singular;
  const Vec o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, xyz{1, 1, 1};
  all.push_back(
      limit(of_bilinear[0], "edge v = 0", BilinearPatch{o, o, y, xyz}, inside(0), along_v, collapsed));
  all.push_back(
      limit(of_bilinear[0], "edge v = 1", BilinearPatch{o, x, y, y}, inside(1), against_v, collapsed));
  all.push_back(limit(of_bilinear[0], "edge u = 0", BilinearPatch{o, x, o, xyz}, beside(0), along_u,
                      dpdv_zero | limit_frame));
  all.push_back(limit(of_bilinear[0], "edge u = 1", BilinearPatch{o, x, y, x}, beside(1), against_u,
                      dpdv_zero | limit_frame));
  all.push_back(no_limit(of_bilinear[0], "three corners equal", BilinearPatch{o, o, o, xyz}, {{0, 0}},
                         dpdu_zero | dpdv_zero, true));
  const BilinearPatch dart{o, x, y, Vec{-1, -1, 0}};  // folded along u + v = 1/2
  const Status folded = parallel | limit_frame;
  all.push_back(limit(of_bilinear[1], "fold", dart, {{0.25, 0.25}, {0.125, 0.375}, {0.5, 0}}, along_v,
                      folded | crease));

  const auto& of_bezier = BezierPatch<>::info.singular;
  const BezierPatch<double> bezier_fan(3, 2, fan(3, 2), some_weights(12));
  all.push_back(
      limit(of_bezier[0], "collapsed edge", bezier_fan, inside(0), along_v, collapsed, {.factor = 100}));
  // Two neighbouring edges are one point: their common corner has neither partial.
  auto corner_net = fan(2, 2);
  corner_net[1] = corner_net[2] = corner_net[0];
  all.push_back(no_limit(of_bezier[0], "triangular corner", BezierPatch<double>(2, 2, corner_net), {{0, 0}},
                         dpdu_zero | dpdv_zero));
  const std::vector<Vec> flat_corner{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 1}};  // P00, P01, P10, P11
  all.push_back(limit(of_bezier[1], "parallel at a corner", BezierPatch<double>(1, 1, flat_corner), {{0, 0}},
                      along_v, folded | crease));

  const auto& of_bspline = BSplinePatch<>::info.singular;
  const std::vector<double> smooth{0, 0, 0, 0.25, 1, 1, 1}, sharp{0, 0, 0, 0.5, 0.5, 1, 1, 1},
      torn{0, 0, 0.5, 0.5, 1, 1};
  all.push_back(limit(of_bspline[0], "collapsed edge",
                      BSplinePatch<double>(2, 2, smooth, {0, 0, 0, 1, 1, 1}, fan(3, 2), some_weights(12)),
                      inside(0), along_v, collapsed, {.factor = 100}));
  all.push_back(limit(of_bspline[1], "multiplicity 2 of degree 2 along u",
                      BSplinePatch<double>(2, 2, sharp, {-1, -1, -1, 1, 1, 1}, fan(4, 2), some_weights(15)),
                      beside(0.5), along_u, crease, {.factor = 200}));
  all.push_back(limit(of_bspline[1], "multiplicity 2 of degree 2 along v",
                      BSplinePatch<double>(2, 2, {0, 0, 0, 1, 1, 1}, sharp, fan(2, 4), some_weights(15)),
                      inside(0.5), along_v, crease, {.factor = 200}));
  all.push_back(limit(of_bspline[1], "multiplicity 2 of degree 1",
                      BSplinePatch<double>(1, 2, torn, {0, 0, 0, 1, 1, 1}, fan(3, 2), some_weights(12)),
                      beside(0.5), along_u, crease, {.factor = 200}));
  all.push_back(limit(of_bspline[2], "parallel at a corner",
                      BSplinePatch<double>(1, 1, {0, 0, 1, 1}, {0, 0, 1, 1}, flat_corner), {{0, 0}}, along_v,
                      folded | crease));

  const auto& of_revolution = SurfaceOfRevolution<>::info.singular;
  all.push_back(
      limit(of_revolution[0], "bottom of a vase", SurfaceOfRevolution<>{}, round(0), along_v, collapsed));
  const SurfaceOfRevolution ball{BSplineCurve<double>(
      2, {0, 0, 0, 1, 1, 2, 2, 2}, {{0, 0, -1}, {1, 0, -1}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}},
      {1, std::sqrt(0.5), 1, std::sqrt(0.5), 1})};
  all.push_back(limit(of_revolution[0], "south pole of a rational ball", ball, round(0), along_v, collapsed));
  all.push_back(
      limit(of_revolution[0], "north pole of a rational ball", ball, round(1), against_v, collapsed));
  const SurfaceOfRevolution double_cone{LineSegment{Vec{-1, 0, -1}, Vec{1, 0, 1}}};
  all.push_back(limit(of_revolution[0], "profile that crosses the axis", double_cone, round(0.5), along_v,
                      collapsed | crease));
  const SurfaceOfRevolution other_cone{LineSegment{Vec{1, 0, -1}, Vec{-1, 0, 1}}};
  all.push_back(limit(of_revolution[0], "profile that crosses it inwards", other_cone, round(0.5), along_v,
                      collapsed | crease));
  const SurfaceOfRevolution waist{PlanarCurve{PositionCurve{touching}}};
  for (const auto& side : {along_v, against_v})
    all.push_back(limit(of_revolution[0],
                        side.y > 0 ? "profile that touches, above" : "profile that touches, below", waist,
                        round(0.5), side, collapsed));
  const SurfaceOfRevolution beyond{LineSegment{Vec{0, 0, 0}, Vec{-1, 0, 1}}};  // ρ < 0
  all.push_back(
      limit(of_revolution[0], "profile beyond the axis first", beyond, round(0), along_v, collapsed));
  const SurfaceOfRevolution beyond_last{LineSegment{Vec{-1, 0, 1}, Vec{0, 0, 0}}};
  all.push_back(
      limit(of_revolution[0], "profile beyond the axis last", beyond_last, round(1), against_v, collapsed));
  all.push_back(limit(of_revolution[1], "first corner", SurfaceOfRevolution{broken_line()}, round(0.5),
                      along_v, crease));
  all.push_back(limit(of_revolution[1], "second corner", SurfaceOfRevolution{broken_line()}, round(0.75),
                      along_v, crease));
  all.push_back(limit(of_revolution[1], "corner of arcs", SurfaceOfRevolution{two_arcs()}, round(0.5),
                      along_v, crease));

  const auto& of_extrusion = Extrusion<>::info.singular;
  const Vec slanted{1, 2, 3};
  all.push_back({"extrusion", of_extrusion[0], "along the line", [=] {
                   for (const auto& p : Points{{0, 0}, {0.5, 0.5}, {1, 1}})
                     expect_no_limit(Extrusion{LineSegment{o, x}, x}, p, parallel, true);
                   // With other speeds and rounded points, the same.
                   const Extrusion line{BSplineCurve<double>(3, {0, 0, 0, 0, 1, 1, 1, 1},
                                                             {o, 0.3 * slanted, 0.7 * slanted, slanted}),
                                        slanted};
                   for (const double u : {0.0, 0.1, 0.37, 0.5, 0.83, 1.0})
                     expect_no_limit(line, {u, 0.3}, parallel, true);
                 }});
  const Extrusion fold{CircleCurve{1.0}, y};  // flat, and over itself beyond the circle's ends
  all.push_back(limit(of_extrusion[0], "tangent to a circle", fold, {{0, 0.2}, {0.5, 0.3}, {1, 1}}, along_u,
                      folded | crease));
  all.push_back(
      limit(of_extrusion[1], "first corner", Extrusion{broken_line(), y}, beside(0.5), along_u, crease));
  all.push_back(limit(of_extrusion[1], "corner of arcs", Extrusion{two_arcs(), Vec{0, 1, 0.5}}, beside(0.5),
                      along_u, crease));

  const auto& of_ruled = RuledSurface<>::info.singular;
  const RuledSurface wedge{LineSegment{o, x}, LineSegment{o, Vec{0.5, 1, 0.25}}};
  all.push_back(
      limit(of_ruled[0], "curves that meet first", wedge, beside(0), along_u, dpdv_zero | limit_frame));
  const RuledSurface wedge_back{LineSegment{x, o}, LineSegment{Vec{0.5, 1, 0.25}, o}};
  all.push_back(
      limit(of_ruled[0], "curves that meet last", wedge_back, beside(1), against_u, dpdv_zero | limit_frame));
  const RuledSurface tip{LineSegment{o, o}, LineSegment{x, xyz}};
  all.push_back(limit(of_ruled[0], "tip of a cone", tip, inside(0), along_v, collapsed));
  const RuledSurface developable{PositionCurve{twisted_cubic}, PositionCurve{on_its_tangent}};
  all.push_back(limit(of_ruled[1], "edge of regression", developable, inside(0), along_v, folded,
                      {.factor = 100, .decades = 7}));  // the cross errs by u over the way
  const BSplineCurve<double> raised(1, {0, 0, 0.5, 1, 1}, {{1, 1, 0}, {2, 1, 1}, {1, 2, 2}});
  all.push_back(limit(of_ruled[2], "corner of the first curve", RuledSurface{broken_line(), raised},
                      {{0.75, 0.3}, {0.75, 0.8}}, along_u, crease));
  all.push_back(limit(of_ruled[2], "corners of both", RuledSurface{broken_line(), raised}, beside(0.5),
                      along_u, crease));
  return all;
}

class SingularPoint : public ::testing::TestWithParam<Declared> {};
TEST_P(SingularPoint, IsApproachedWithTheGivenCoordinateOrHasNoFrame) {
  GetParam().law();
}
INSTANTIATE_TEST_SUITE_P(Catalogue, SingularPoint, ::testing::ValuesIn(declared_points()),
                         [](const auto& info) {
                           std::string name = std::string(info.param.surface) + "_" + info.param.title;
                           std::string letters;
                           for (const char c : name)
                             if (std::isalnum(static_cast<unsigned char>(c)))
                               letters += c;
                             else if (!letters.empty() && letters.back() != '_')
                               letters += '_';
                           return letters;
                         });

// A surface that declares a place singular has a law for it above: whoever adds one is told here.
TEST(SingularPoints, EveryDeclaredOneIsCovered) {
  const std::vector<Declared> all = declared_points();
  int surfaces = 0;
  Catalogue::for_each([&]<class X>(const X&) {
    surfaces += X::info.singular[0].empty() ? 0 : 1;
    for (const std::string_view where : X::info.singular) {
      if (where.empty()) continue;
      const bool covered = std::any_of(all.begin(), all.end(), [&](const Declared& d) {
        return d.surface == X::info.name && d.where == where;
      });
      EXPECT_TRUE(covered) << X::info.name << ": " << where;
    }
  });
  EXPECT_EQ(surfaces, 18);
  for (const Declared& d : all) {
    bool known = false;
    Catalogue::for_each([&]<class X>(const X&) {
      known =
          known || (d.surface == X::info.name && std::find(X::info.singular.begin(), X::info.singular.end(),
                                                           d.where) != X::info.singular.end());
    });
    EXPECT_TRUE(known) << d.surface << " does not declare " << d.where;
  }
}

// Whoever declares nothing is regular on its whole domain.
TEST(SingularPoints, ThereAreNoneThatNobodyDeclares) {
  const Status harmless = self_intersecting | Status::outside_domain;
  Catalogue::for_each([&]<class X>(const X& surface) {
    for (int i = 0; i <= 32; ++i)
      for (int k = 0; k <= 32; ++k) {
        const double u = i / 32.0, v = k / 32.0;
        const Frame<double> f = frame(surface, u, v);
        const bool exists = finite(f);
        EXPECT_EQ(exists, !has(f.status, no_frame)) << X::info.name << " " << u << " " << v;
        EXPECT_EQ(all_nan(f), !exists) << X::info.name << " " << u << " " << v;
        EXPECT_TRUE(exists) << X::info.name << " " << u << " " << v;
        if (X::info.singular[0].empty()) {
          EXPECT_EQ(without(f.status, harmless), regular) << X::info.name;
        }
      }
  });
}

// ---- double-valued frames ---------------------------------------------------------------------------------

// P(u + 1, v) = P(u, 1 - v), and there t is the same, b and n are opposite: one side, two frames a point.
template <class X>
void expect_one_side(const X& surface, double size) {
  for (int i = 0; i < 64; ++i)
    for (int k = 0; k <= 32; ++k) {
      const double u = i / 64.0, v = k / 32.0;
      const Frame<double> f = frame(surface, u, v), g = frame(surface, u + 1, 1 - v);
      EXPECT_LE(norm(jet(surface, u, v).position - jet(surface, u + 1, 1 - v).position), 8 * roundoff * size);
      EXPECT_LE(norm(f.t - g.t), 16 * roundoff) << u << " " << v;
      EXPECT_LE(norm(f.b + g.b), 16 * roundoff) << u << " " << v;
      EXPECT_LE(norm(f.n + g.n), 16 * roundoff) << u << " " << v;
      EXPECT_LE(norm(cross(f.t, f.b) - f.n), 8 * roundoff) << u << " " << v;
      EXPECT_EQ(f.status, g.status) << u << " " << v;
      EXPECT_EQ(f.handedness, 1);
      EXPECT_EQ(g.handedness, 1);
      const Frame<double> twice = frame(surface, u + 2, v);
      EXPECT_TRUE(twice.t == f.t && twice.b == f.b && twice.n == f.n) << u << " " << v;
    }
}
TEST(OneSided, MoebiusStrip) {
  expect_one_side(MoebiusStrip{1.0, 0.5}, 1.25);
  expect_one_side(MoebiusStrip{1.0, 1.9}, 1.95);
}
TEST(OneSided, KleinBottle) {
  expect_one_side(KleinBottle{2.0, 0.7}, 2.7);
}

// On two rulings at once: the surface is there twice, with other normals.
TEST(SelfIntersection, MoebiusStripOfFourRadii) {
  const MoebiusStrip wide{1.0, 4.0};
  EXPECT_EQ(frame(wide, 0.0, 0.0).status, self_intersecting);
  EXPECT_EQ(frame(wide, 0.5, 0.5).status, self_intersecting);
  EXPECT_LE(norm(jet(wide, 0.0, 0.0).position - jet(wide, 0.5, 0.5).position), 4 * roundoff);
  EXPECT_GT(norm(frame(wide, 0.0, 0.0).n - frame(wide, 0.5, 0.5).n), 0.1);
  EXPECT_EQ(frame(wide, 0.0, 0.25).status, regular);
  const MoebiusStrip embedded{1.0, 3.99};
  for (int i = 0; i <= 64; ++i)
    for (int k = 0; k <= 64; ++k) EXPECT_EQ(frame(embedded, i / 64.0, k / 64.0).status, regular);
}
TEST(SelfIntersection, KleinBottleOnItsDoubleCircle) {
  const KleinBottle bottle{2.0, 0.7};
  for (int i = 0; i < 64; ++i) {
    const double u = i / 64.0;
    EXPECT_LE(norm(jet(bottle, u, 0.0).position - jet(bottle, u, 0.5).position), 4 * roundoff);
    EXPECT_GT(norm(frame(bottle, u, 0.0).n - frame(bottle, u, 0.5).n), 0.1);
    for (const double v : {0.0, 0.5, 1.0})
      EXPECT_EQ(frame(bottle, u, v).status, self_intersecting) << u << " " << v;
    for (const double v : {0.1, 0.25, 0.49, 0.9})
      EXPECT_EQ(frame(bottle, u, v).status, regular) << u << " " << v;
  }
  const KleinBottle thick{1.0, 1.0};  // reaches the axis, beyond it the other side of the figures lies
  EXPECT_EQ(frame(thick, 0.98, 0.2).status, regular);
  EXPECT_EQ(frame(KleinBottle{0.5, 1.0}, 1.0, 0.25).status, self_intersecting);
}
// The turning line of a flat helicoid passes a point with s and with -s; half a turn is needed.
TEST(SelfIntersection, FlatHelicoidWhereTheLinePassesTwice) {
  const Helicoid disk{0.0, 1.0, -0.5, 2.0}, wedge{0.0, 0.25, -0.5, 2.0}, climbing{0.1, 1.0, -0.5, 2.0};
  EXPECT_EQ(frame(disk, 0.3, 0.125).status, self_intersecting);  // s = -0.25
  EXPECT_EQ(frame(disk, 0.3, 0.375).status, self_intersecting);  // s = 0.25
  EXPECT_EQ(frame(disk, 0.3, 0.625).status, regular);            // s = 0.75
  EXPECT_EQ(frame(wedge, 0.3, 0.375).status, regular);
  EXPECT_EQ(frame(climbing, 0.3, 0.375).status, regular);
}

TEST(SelfIntersection, EnneperFromTheSquareRootOfThreeOn) {
  for (const double extent : {1.0, 1.7}) {
    const Enneper small{extent, 1.0};
    for (int i = 0; i <= 32; ++i)
      for (int k = 0; k <= 32; ++k) EXPECT_EQ(frame(small, i / 32.0, k / 32.0).status, regular);
  }
  const Enneper large{2.0, 1.0};
  EXPECT_EQ(frame(large, 1.0, 0.5).status, self_intersecting);
  EXPECT_EQ(frame(large, 0.5, 0.0).status, self_intersecting);
  EXPECT_EQ(frame(large, 0.5, 0.5).status, regular);
}

// The tractrix ends at infinity, outside of the domain. What fuzzing found there: vectors of zeros.
TEST(Pseudosphere, TheEndOfTheTractrixHasALimit) {
  const Pseudosphere surface{1.0, 0.0, 1.0, 0.5, 1.0};
  const Frame<double> at = frame(surface, 0.0, -1.0);  // w = 0
  EXPECT_EQ(at.status, dpdu_zero | limit_frame | Status::outside_domain);
  EXPECT_EQ(at.t, (Vec{0, 1, 0}));
  EXPECT_EQ(at.b, (Vec{0, 0, 1}));
  EXPECT_EQ(at.n, (Vec{1, 0, 0}));
  EXPECT_EQ(frame(Pseudosphere{1.0, 0.5, 1.0, 0.5, 1.0}, 0.0, -1.0).status, Status::outside_domain);
}

// ---- the distance where its gradient is not one -----------------------------------------------------------

TEST(Implicit, IsMinusTheLeastSemiAxisAtTheCentre) {
  for (const Vec& a : {Vec{1, 2, 3}, Vec{2, 1, 3}, Vec{3, 2, 1}, Vec{1, 3, 2}, Vec{2, 3, 1}, Vec{3, 1, 2}}) {
    EXPECT_EQ((Ellipsoid<>{a.x, a.y, a.z}.implicit(Vec{0, 0, 0})), -1);
    EXPECT_EQ((Superellipsoid<>{a.x, a.y, a.z, 0.5, 0.7}.implicit(Vec{0, 0, 0})), -1);
  }
}

// Beside the rectangle the distance from its edges and corners, whatever the quadrant.
TEST(Implicit, OfAPlaneIsTheDistanceFromItsRectangle) {
  const Plane plane{2.0, 6.0};
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-2.0, 0.0, 2.0}) {
        EXPECT_EQ(plane.implicit(Vec{0.5 * x, 2 * y, z}), z);
        EXPECT_EQ(plane.implicit(Vec{2.5 * x, 2 * y, z}), std::hypot(1.5, z));
        EXPECT_EQ(plane.implicit(Vec{0.5 * x, 5 * y, z}), std::hypot(2.0, z));
        EXPECT_DOUBLE_EQ(plane.implicit(Vec{2.5 * x, 5 * y, z}), std::hypot(1.5, 2.0, z));
      }
}

TEST(Implicit, VanishesOnTheDoubleCircleOfAKleinBottle) {
  EXPECT_EQ((KleinBottle<>{2, 0.5}.implicit(Vec{2, 0, 0})), 0);
}

}  // namespace
}  // namespace darboux::test::singular_points_test
