// What curves, splines and the surfaces made of them refuse, and how they say it.
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/curve.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/extrusion.h>
#include <darboux/graph.h>
#include <darboux/ruled_surface.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/tube.h>

#include "refusal_of.h"

namespace darboux::test {
namespace {

using Vec = Vec3<double>;

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Refusals, OfDegreesKnotsPointsAndWeights) {
  struct Wrong {
    int degree;
    std::vector<double> knots;
    int points;
    std::vector<double> weights;
    std::string why;
  };
  const std::vector<double> good{0, 0, 0, 0.5, 1, 1, 1};
  const std::vector<Wrong> all{
      {2, good, 4, {}, ""},
      {2, good, 4, {1, 2, 3, 4}, ""},
      {0, good, 4, {}, "degree = 0 must be from 1 to 15"},
      {-1, good, 4, {}, "degree = -1 must be from 1 to 15"},
      {16, good, 4, {}, "degree = 16 must be from 1 to 15"},
      {2, {}, 0, {}, "0 knots: too few control points, degree 2 needs 3 and 6 knots"},
      {2, {0, 0, 0, 1, 1}, 2, {}, "5 knots: too few control points, degree 2 needs 3 and 6 knots"},
      {2, {0, 0, 0, nan_value, 1, 1, 1}, 4, {}, "knot 3 is not finite"},
      {2, {0, 0, 0, 0.5, 1, 1, infinity}, 4, {}, "knot 6 is not finite"},
      {2, {-infinity, 0, 0, 0.5, 1, 1, 1}, 4, {}, "knot 0 is not finite"},
      {2,
       {0, 0, 0, 0.75, 0.5, 1, 1, 1},
       5,
       {},
       "knot 4 = 0.5 is less than knot 3 = 0.75, knots must not decrease"},
      {2, {0, 0, 0, 0.5, 0.5, 0.5, 0.5, 1, 1, 1}, 7, {}, "knot 0.5 has a multiplicity above degree + 1 = 3"},
      {2, {0, 0, 0, 0, 1, 1, 1}, 4, {}, "knot 0 has a multiplicity above degree + 1 = 3"},
      {2, {0, 0.5, 1, 1, 1.5, 2}, 3, {}, "the knots enclose no interval"},
      {2, good, 3, {}, "3 control points, there must be 4"},
      {2, good, 5, {}, "5 control points, there must be 4"},
      {2, good, 0, {}, "0 control points, there must be 4"},
      {2, good, 4, {1, 1, 1}, "3 weights, there must be 4 or none"},
      {2,
       good,
       4,
       {1, 1, 0, 1},
       "weight 2 = 0 must be positive and finite, and not vanish beside the largest"},
      {2, good, 4, {-1, 1, 1, 1}, "weight 0 = -1 must be positive and finite"},
      {2, good, 4, {1, nan_value, 1, 1}, "weight 1 = nan must be positive and finite"},
      {2, good, 4, {1, 1, 1, infinity}, "weight 3 = inf must be positive and finite"}};
  const std::vector<double> line{0, 0, 1, 1};
  for (const Wrong& w : all) {
    const std::vector<Vec> points(w.points, Vec{1, 2, 3}), twice(2 * w.points, Vec{1, 2, 3});
    const std::string accepted = "accepted";
    EXPECT_EQ(refusal_of([&] { BSplineCurve<double>(w.degree, w.knots, points, w.weights); }),
              w.why.empty() ? accepted : "b-spline curve: " + w.why);
    // In a patch beside a line, with every point twice.
    const bool of_knots =
        w.why.starts_with("knot") || w.why.starts_with("degree") || w.why.find("knots") != std::string::npos;
    if (of_knots || w.why.empty()) {
      EXPECT_EQ(refusal_of([&] { BSplinePatch<double>(w.degree, 1, w.knots, line, twice); }),
                w.why.empty() ? accepted : "bspline-patch: along u: " + w.why);
      EXPECT_EQ(refusal_of([&] { BSplinePatch<double>(1, w.degree, line, w.knots, twice); }),
                w.why.empty() ? accepted : "bspline-patch: along v: " + w.why);
    } else {
      const std::vector<double> half{0, 0, 1, 1};
      EXPECT_EQ(refusal_of([&] { BSplinePatch<double>(1, 1, half, half, points, w.weights); }),
                "bspline-patch: " + w.why);
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(1, 1, points, w.weights); }), "bezier-patch: " + w.why);
    }
    if (w.why.starts_with("degree")) {
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(w.degree, 1, points); }), "bezier-patch: " + w.why);
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(1, w.degree, points); }), "bezier-patch: " + w.why);
    }
  }
}

TEST(Refusals, OfPointsThatAreNotFinite) {
  for (const double bad : {nan_value, infinity, -infinity})
    for (const Vec& point : {Vec{bad, 0, 0}, Vec{0, bad, 0}, Vec{0, 0, bad}}) {
      const std::vector<Vec> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, point};
      const std::string why = "control point 3 is not finite";
      EXPECT_EQ(refusal_of([&] { BSplineCurve<double>(3, clamped_knots(3, 4), points); }),
                "b-spline curve: " + why);
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(1, 1, points); }), "bezier-patch: " + why);
      EXPECT_EQ(refusal_of([&] {
                  BSplinePatch<double>(1, 1, {0, 0, 1, 1}, {0, 0, 1, 1}, points);
                }),
                "bspline-patch: " + why);
    }
}

TEST(Refusals, OfCurvesAndWhatIsMadeOfThem) {
  const Vec o{0, 0, 0}, x{1, 0, 0};
  const BSplineCurve<double> spatial(1, {0, 0, 1, 1}, {{0, 0, 0}, {1, 1, 1}});
  const auto check = [](const auto& surface) { return refusal_of([&] { checked(surface); }); };
  EXPECT_EQ(check(Extrusion<>{}), "accepted");
  EXPECT_EQ(check(Extrusion{LineSegment{o, x}, o}), "extrusion: the direction must not be zero");
  EXPECT_EQ(check(Extrusion{LineSegment{o, Vec{nan_value, 0, 0}}, x}),
            "extrusion: an end of the line segment is not finite");
  EXPECT_EQ(check(Tube{CircleCurve{0.0}, 0.1}),
            "tube: circle_radius = 0 is out of range, permitted is 0 < circle_radius < inf");
  EXPECT_EQ(check(Extrusion{CircleCurve{-1.0}, x}),
            "extrusion: the circle's radius must be positive and finite");
  EXPECT_EQ(check(Extrusion{HelixCurve{0.0, 1.0, 1.0}, x}),
            "extrusion: the helix's radius must be positive and finite");
  EXPECT_EQ(check(Extrusion{HelixCurve{1.0, infinity, 1.0}, x}),
            "extrusion: the helix's pitch must be finite");
  EXPECT_EQ(check(Extrusion{HelixCurve{1.0, 1.0, 0.0}, x}),
            "extrusion: the helix's number of turns must be positive and finite");
  EXPECT_EQ(check(Tube{LineSegment{o, x}, -1.0}),
            "tube: radius = -1 is out of range, permitted is 0 < radius < inf");
  EXPECT_EQ(check(Tube{PlanarCurve{spatial}, 0.1}), "tube: the curve does not lie in a plane z = constant");
  EXPECT_EQ(check(Tube{UprightCurve{spatial, o}, 0.1}), "tube: the direction `up` must not be zero");
  EXPECT_EQ(check(Tube{RotationMinimisingCurve<BSplineCurve<double>>{spatial, x, 0}, 0.1}),
            "tube: panels = 0 must be positive");
  EXPECT_EQ(check(Tube{RotationMinimisingCurve{spatial, o}, 0.1}),
            "tube: the direction `up` must not be zero");
  EXPECT_EQ(check(SurfaceOfRevolution{spatial}),
            "surface-of-revolution: the profile does not lie in the plane y = 0");
  EXPECT_EQ(check(RuledSurface{CircleCurve{0.0}, CircleCurve{1.0}}),
            "ruled-surface: the first curve: the circle's radius must be positive and finite");
  EXPECT_EQ(check(RuledSurface{CircleCurve{1.0}, CircleCurve{nan_value}}),
            "ruled-surface: the second curve: the circle's radius must be positive and finite");
  EXPECT_EQ(check(Graph{RoundHill<double>{}, 1.0, 0.5, 0.0, 1.0}), "graph: x0 = 1 must be below x1 = 0.5");
  EXPECT_EQ(check(Graph{RoundHill<double>{}, 0.0, 1.0, 2.0, 2.0}), "graph: y0 = 2 must be below y1 = 2");
}

}  // namespace
}  // namespace darboux::test
