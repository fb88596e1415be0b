// What curves, splines and the surfaces made of them refuse, and how they say it.
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/extrusion.h>
#include <darboux/framed_curve.h>
#include <darboux/graph.h>
#include <darboux/ruled_surface.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/tube.h>

#include "refusal_of.h"

namespace darboux::test::curve_refusals_test {
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
      {0, good, 4, {}, "degree: expected 1 to 15, got 0"},
      {-1, good, 4, {}, "degree: expected 1 to 15, got -1"},
      {16, good, 4, {}, "degree: expected 1 to 15, got 16"},
      {2, {}, 0, {}, "expected at least 6 knots, for 3 control points of degree 2, got 0"},
      {2, {0, 0, 0, 1, 1}, 2, {}, "expected at least 6 knots, for 3 control points of degree 2, got 5"},
      {2, {0, 0, 0, nan_value, 1, 1, 1}, 4, {}, "knot 3: expected a finite number, got NaN or infinity"},
      {2, {0, 0, 0, 0.5, 1, 1, infinity}, 4, {}, "knot 6: expected a finite number, got NaN or infinity"},
      {2, {-infinity, 0, 0, 0.5, 1, 1, 1}, 4, {}, "knot 0: expected a finite number, got NaN or infinity"},
      {2, {0, 0, 0, 0.75, 0.5, 1, 1, 1}, 5, {}, "knot 4: expected at least knot 3, 0.75, got 0.5"},
      {2,
       {0, 0, 0, 0.5, 0.5, 0.5, 0.5, 1, 1, 1},
       7,
       {},
       "knot 0.5: expected a multiplicity of at most degree + 1 = 3, got more"},
      {2,
       {0, 0, 0, 0, 1, 1, 1},
       4,
       {},
       "knot 0: expected a multiplicity of at most degree + 1 = 3, got more"},
      {2, {0, 0.5, 1, 1, 1.5, 2}, 3, {}, "expected knots that enclose an interval, got none that do"},
      {2, good, 3, {}, "expected 4 control points, got 3"},
      {2, good, 5, {}, "expected 4 control points, got 5"},
      {2, good, 0, {}, "expected 4 control points, got 0"},
      {2, good, 4, {1, 1, 1}, "expected 4 weights or none, got 3"},
      {2,
       good,
       4,
       {1, 1, 0, 1},
       "weight 2: expected a positive finite number, not negligible beside the largest, got 0"},
      {2, good, 4, {-1, 1, 1, 1}, "weight 0: expected a positive finite number, got -1"},
      {2, good, 4, {1, nan_value, 1, 1}, "weight 1: expected a positive finite number, got nan"},
      {2, good, 4, {1, 1, 1, infinity}, "weight 3: expected a positive finite number, got inf"}};
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
      const std::string why = "control point 3: expected finite coordinates, got NaN or infinity";
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
  EXPECT_EQ(check(Extrusion{LineSegment{o, x}, o}),
            "extrusion: the direction: expected one that is not zero, got zero");
  EXPECT_EQ(check(Extrusion{LineSegment{o, Vec{nan_value, 0, 0}}, x}),
            "extrusion: line segment: expected finite ends, got NaN or infinity");
  EXPECT_EQ(check(Tube{CircleCurve{0.0}, 0.1}),
            "tube: circle_radius: expected 0 < circle_radius < inf, got 0");
  EXPECT_EQ(check(Extrusion{CircleCurve{-1.0}, x}),
            "extrusion: radius of the circle: expected a positive finite number, got another");
  EXPECT_EQ(check(Extrusion{HelixCurve{0.0, 1.0, 1.0}, x}),
            "extrusion: radius of the helix: expected a positive finite number, got another");
  EXPECT_EQ(check(Extrusion{HelixCurve{1.0, infinity, 1.0}, x}),
            "extrusion: pitch of the helix: expected a finite number, got NaN or infinity");
  EXPECT_EQ(check(Extrusion{HelixCurve{1.0, 1.0, 0.0}, x}),
            "extrusion: turns of the helix: expected a positive finite number, got another");
  EXPECT_EQ(check(Tube{LineSegment{o, x}, -1.0}), "tube: radius: expected 0 < radius < inf, got -1");
  EXPECT_EQ(check(Tube{PlanarCurve{spatial}, 0.1}),
            "tube: expected a curve in a plane z = constant, got one that leaves it");
  EXPECT_EQ(check(Tube{UprightCurve{spatial, o}, 0.1}),
            "tube: the direction `up`: expected one that is not zero, got zero");
  EXPECT_EQ(check(Tube{RotationMinimisingCurve<BSplineCurve<double>>{spatial, x, 0}, 0.1}),
            "tube: panels: expected 1 or more, got 0");
  EXPECT_EQ(check(Tube{RotationMinimisingCurve{spatial, o}, 0.1}),
            "tube: the direction `up`: expected one that is not zero, got zero");
  EXPECT_EQ(
      check(SurfaceOfRevolution{spatial}),
      "surface-of-revolution: the profile: expected a curve in the plane y = 0, got one that leaves it");
  EXPECT_EQ(
      check(RuledSurface{CircleCurve{0.0}, CircleCurve{1.0}}),
      "ruled-surface: the first curve: radius of the circle: expected a positive finite number, got another");
  EXPECT_EQ(check(RuledSurface{CircleCurve{1.0}, CircleCurve{nan_value}}),
            "ruled-surface: the second curve: radius of the circle: expected a positive finite number, got "
            "another");
  EXPECT_EQ(check(Graph{RoundHill<double>{}, 1.0, 0.5, 0.0, 1.0}),
            "graph: x0: expected less than x1 = 0.5, got 1");
  EXPECT_EQ(check(Graph{RoundHill<double>{}, 0.0, 1.0, 2.0, 2.0}),
            "graph: y0: expected less than y1 = 2, got 2");
}

}  // namespace
}  // namespace darboux::test::curve_refusals_test
