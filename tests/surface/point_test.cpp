// Evaluation is total: limits at the poles, statuses, and NaN where nothing can be said.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <type_traits>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>
#include <darboux/curvature.h>
#include <darboux/darboux_frame.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/shape_operator.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test::point_test {
namespace {

constexpr double roundoff = 0x1p-53;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

double distance(const Frame<double>& a, const Frame<double>& b) {
  return std::max({norm(a.t - b.t), norm(a.b - b.b), norm(a.n - b.n)});
}
bool all_nan(const Vec3<double>& a) {
  return std::isnan(a.x) && std::isnan(a.y) && std::isnan(a.z);
}

// ---- limits -----------------------------------------------------------------------------------------------

// b and n turn with v by π (the sphere's meridian) or 2π (the tube) a unit, t not at all for a fixed u.
template <class X>
void expect_limit(const X& surface, double pole, double inward, double turning) {
  for (const double u : {0.0, 0.1, 0.25, 0.7, 1.0}) {
    const Frame<double> at = frame(surface, u, pole);
    EXPECT_EQ(at.status, Status::dpdu_zero | Status::limit_frame);
    for (int k = 1; k <= 18; ++k) {
      const double step = std::pow(10.0, -k);
      const Frame<double> near = frame(surface, u, pole + inward * step);
      EXPECT_EQ(near.t, at.t) << k;
      // 8u: both frames' own errors, and the step as it is rounded when added to the pole, u times the
      // turning.
      EXPECT_LE(distance(near, at), turning * (step + roundoff) + 8 * roundoff) << k;
    }
  }
}

TEST(Limits, SpherePolesAreApproachedAlongTheMeridian) {
  expect_limit(Sphere{3.0}, 0, +1, std::numbers::pi);
  expect_limit(Sphere{3.0}, 1, -1, std::numbers::pi);
  EXPECT_EQ(frame(Sphere{}, 0.25, 0.0).n, (Vec3<double>{0, 0, -1}));
  EXPECT_EQ(frame(Sphere{}, 0.25, 0.0).t, (Vec3<double>{-1, 0, 0}));
  EXPECT_EQ(frame(Sphere{}, 0.7, 1.0).n, (Vec3<double>{0, 0, 1}));
}

// t depends on u alone: all round the pole there is another limit, and each is given.
TEST(Limits, EveryMeridianHasItsOwn) {
  for (int i = 0; i < 64; ++i) {
    const double u = i / 64.0;
    const auto [s, c] = sincos_turns(u);
    const Frame<double> south = frame(Sphere{}, u, 0.0), north = frame(Sphere{}, u, 1.0);
    EXPECT_EQ(south.t, (Vec3<double>{-s, c, 0}));
    EXPECT_EQ(south.b, (Vec3<double>{c, s, 0}));
    EXPECT_EQ(north.b, (Vec3<double>{-c, -s, 0}));
  }
}

TEST(Limits, HornTorusIsApproachedFromBothSides) {
  const Torus horn{0.5, 0.5};
  for (const double side : {1.0, -1.0})
    for (const double u : {0.0, 0.1, 0.7})
      for (int k = 1; k <= 8; ++k) {  // beyond, 1 + cos 2πv is rounded to zero and the point flagged itself
        const double step = std::pow(10.0, -k);
        const Frame<double> at = frame(horn, u, 0.5), near = frame(horn, u, 0.5 + side * step);
        EXPECT_EQ(near.t, at.t);
        EXPECT_LE(distance(near, at), 2 * std::numbers::pi * (step + roundoff) + 8 * roundoff);
      }
  EXPECT_EQ(frame(horn, 0.1, 0.5).status, Status::dpdu_zero | Status::limit_frame);
  EXPECT_EQ(frame(horn, 0.0, 0.5).n, (Vec3<double>{-1, 0, 0}));
}

// ---- the spindle torus states its own orientation ---------------------------------------------------------

TEST(SpindleTorus, IsFlaggedInsideAndKeepsItsNormalOutOfTheTube) {
  const Torus spindle{0.5, 1.0};  // meets the axis at cos 2πv = -1/2: v = 1/3 and 2/3
  for (int i = 0; i <= 1000; ++i) {
    const double u = 0.3, v = i / 1000.0;
    const Frame<double> f = frame(spindle, u, v);
    const bool inside = v > 1.0 / 3 && v < 2.0 / 3;
    EXPECT_EQ(f.handedness, inside ? -1 : 1) << v;
    EXPECT_EQ(f.status, inside ? Status::self_intersecting : Status::regular) << v;
    const Jet2<double> j = jet(spindle, u, v);
    EXPECT_GT(dot(f.t, j.dpdu), 0) << v;
    EXPECT_GT(f.handedness * dot(f.b, j.dpdv), 0) << v;
    const auto [s, c] = sincos_turns(v);
    const auto [su, cu] = sincos_turns(u);
    EXPECT_LE(norm(f.n - Vec3<double>{c * cu, c * su, s}), 4 * roundoff) << v;
    EXPECT_LE(norm(cross(f.n, f.t) - f.b), 8 * roundoff) << v;
  }
}

TEST(SpindleTorus, ParametricFrameFollowsThePartials) {
  const Torus spindle{0.5, 1.0};
  for (const double v : {0.1, 0.45, 0.5, 0.9}) {
    const Jet2<double> j = jet(spindle, 0.3, v);
    const ParametricFrame<double> f = parametric_frame(spindle, 0.3, v);
    EXPECT_LE(norm(f.t - unit(j.dpdu)), 8 * roundoff) << v;
    EXPECT_LE(norm(f.b - unit(j.dpdv)), 8 * roundoff) << v;
    EXPECT_EQ(f.handedness, dot(cross(j.dpdu, j.dpdv), f.n) < 0 ? -1 : 1) << v;
  }
}

// R = 0: the tube's inner half is the outer half again; on the axis the limit from outside.
TEST(SpindleTorus, WithoutMajorRadius) {
  const Torus sphere_twice{0.0, 1.0};
  EXPECT_EQ(frame(sphere_twice, 0.0, 0.25).status, Status::dpdu_zero | Status::limit_frame);
  EXPECT_EQ(frame(sphere_twice, 0.0, 0.25).handedness, 1);
  EXPECT_EQ(frame(sphere_twice, 0.0, 0.25).t, (Vec3<double>{0, 1, 0}));
  EXPECT_EQ(frame(sphere_twice, 0.0, 0.5).handedness, -1);
}

// ---- parametric frame -------------------------------------------------------------------------------------

TEST(ParametricFrame, IsAlongTheCoordinateCurves) {
  Random random(1);
  for (const AnySurface& surface : all_surfaces())
    for (int i = 0; i < 200; ++i) {
      const double u = random.uniform(), v = random.uniform();
      const ParametricFrame<double> f = surface.parametric_frame(u, v);
      const Jet2<double> j = surface.jet(u, v);
      EXPECT_EQ(f.b, unit(j.dpdv)) << surface.info().name;
      EXPECT_EQ(f.n, surface.frame(u, v).n) << surface.info().name;
      // Along dpdu, as far as that has digits: its error over its length.
      EXPECT_LE(norm(f.t - unit(j.dpdu)), 1e-13 * (1 + norm(j.position) / norm(j.dpdu)))
          << surface.info().name;
    }
}

// ---- statuses ---------------------------------------------------------------------------------------------

TEST(Statuses, SeamsCloseToTheBit) {
  for (const AnySurface& surface : all_surfaces()) {
    if (surface.info().u != Coordinate::turn) continue;
    for (const double v : {0.0, 0.3, 1.0}) {
      EXPECT_EQ(surface.jet(0.0, v).position, surface.jet(1.0, v).position) << surface.info().name;
      for (const auto& [u, again] : {std::pair{0.0, 1.0}, {0.25, -7.75}}) {
        const Frame<double> f = surface.frame(u, v), g = surface.frame(again, v);
        EXPECT_TRUE(f.t == g.t && f.b == g.b && f.n == g.n && f.status == g.status)
            << surface.info().name << v;
      }
    }
  }
}

TEST(Statuses, OnlyANonPeriodicCoordinateIsEverOutside) {
  for (const AnySurface& surface : all_surfaces())
    for (const bool along_u : {true, false}) {
      const Coordinate kind = along_u ? surface.info().u : surface.info().v;
      const bool bounded = kind == Coordinate::linear || kind == Coordinate::half_turn;
      const auto at = [&](double x) { return along_u ? surface.sample(x, 0.3) : surface.sample(0.3, x); };
      for (const double x : {-1e-9, 1 + 1e-9, -3.3, 7.2})
        EXPECT_EQ(has(at(x).frame.status, Status::outside_domain), bounded)
            << surface.info().name << ' ' << x;
      for (const double x : {-1e-9, 1 + 1e-9})
        EXPECT_FALSE(all_nan(at(x).frame.n)) << surface.info().name << ": the analytic extension is given";
      for (const double x : {0.0, 1.0, 5e-324})
        EXPECT_FALSE(has(at(x).frame.status, Status::outside_domain)) << surface.info().name << ' ' << x;
    }
}

TEST(Statuses, NotFiniteInputGivesFlaggedNan) {
  Catalogue::for_each([](const auto& standard) {
    using X = std::remove_cvref_t<decltype(standard)>;
    const auto expect_nan = [](const X& surface, double u, double v) {
      const Frame<double> f = frame(surface, u, v);
      EXPECT_TRUE(has(f.status, Status::non_finite_input)) << X::info.name << ' ' << u << ' ' << v;
      EXPECT_TRUE(all_nan(f.t) && all_nan(f.b) && all_nan(f.n)) << X::info.name << ' ' << u << ' ' << v;
      const ParametricFrame<double> p = parametric_frame(surface, u, v);
      EXPECT_TRUE(all_nan(p.t) && all_nan(p.b) && all_nan(p.n)) << X::info.name << ' ' << u << ' ' << v;
      EXPECT_FALSE(has(sample(surface, u, v).frame.status, Status::overflow)) << X::info.name;
    };
    for (const double bad : {nan_value, infinity, -infinity}) {
      expect_nan(X{}, bad, 0.3);
      expect_nan(X{}, 0.3, bad);
      for_each_parameter<X>([&](const auto& p) {
        X surface;
        p.of(surface) = bad;
        expect_nan(surface, 0.3, 0.3);
      });
    }
  });
}

// Sizes whose partials overflow: flagged, and the frame is that of the same shape of ordinary size.
template <class X>
void expect_overflow_and_the_right_frame() {
  X surface;
  const X ordinary;
  for_each_parameter<X>([&](const auto& p) { p.of(surface) = 1e308 * p.of(ordinary); });
  const Sample<double> s = sample(surface, 0.1, 0.3);
  EXPECT_TRUE(has(s.frame.status, Status::overflow)) << X::info.name;
  EXPECT_LE(distance(s.frame, frame(ordinary, 0.1, 0.3)), 8 * roundoff) << X::info.name;
  EXPECT_FALSE(has(sample(ordinary, 0.1, 0.3).frame.status, Status::overflow)) << X::info.name;
}
TEST(Overflow, IsFlaggedAndTheFrameStaysRight) {
  expect_overflow_and_the_right_frame<Sphere<double>>();
  expect_overflow_and_the_right_frame<Torus<double>>();
  expect_overflow_and_the_right_frame<Cylinder<double>>();
  expect_overflow_and_the_right_frame<Cone<double>>();
  expect_overflow_and_the_right_frame<Disk<double>>();
  expect_overflow_and_the_right_frame<Ellipsoid<double>>();
  expect_overflow_and_the_right_frame<MoebiusStrip<double>>();
}

// cosh 800 exceeds double; 1/cosh and tanh do not, and neither does the frame.
TEST(Overflow, OfACatenoidLeavesItsFrame) {
  for (const double v : {0.0, 1.0}) {
    const Sample<double> s = sample(Catenoid{1.0, 800.0}, 0.3, v);
    EXPECT_EQ(s.frame.status, Status::overflow);
    EXPECT_FALSE(detail::finite(s.jet.position));
    const auto [sine, cosine] = sincos_turns(0.3);
    EXPECT_LE(norm(s.frame.t - Vec3<double>{-sine, cosine, 0}), 4 * roundoff);
    EXPECT_LE(norm(s.frame.n - Vec3<double>{0, 0, v == 0 ? 1.0 : -1.0}), 4 * roundoff);
  }
}

// ---- a surface without a closed-form frame ----------------------------------------------------------------

// z = u² + v³ over the square of side 2 about (0.5, 0.5): user code, partials only; v = 1/2 is regular.
struct Graph {
  static constexpr SurfaceInfo info{"graph", "a graph", Coordinate::linear, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), two = lift<S>(2.0), six = lift<S>(6.0);
    return {.position = {u, v, u * u + v * v * v},
            .dpdu = {one, zero, two * u},
            .dpdv = {zero, one, six / two * v * v},
            .d2pdu2 = {zero, zero, two},
            .d2pduv = {zero, zero, zero},
            .d2pdv2 = {zero, zero, six * v}};
  }
};

TEST(WithoutClosedFrame, TheEngineBuildsOne) {
  const Frame<double> f = frame(Graph{}, 0.4, 0.7);
  const double W = std::sqrt(1 + 0.8 * 0.8 + 1.47 * 1.47);
  EXPECT_LE(norm(f.n - Vec3<double>{-0.8 / W, -1.47 / W, 1 / W}), 8 * roundoff);
  EXPECT_EQ(f.status, Status::regular);
  // The chart is sheared: the parametric b is not the orthonormal one.
  const ParametricFrame<double> p = parametric_frame(Graph{}, 0.4, 0.7);
  EXPECT_EQ(p.b, unit(Vec3<double>{0, 1, jet(Graph{}, 0.4, 0.7).dpdv.z}));
  EXPECT_GT(norm(p.b - f.b), 0.1);
}

// A user's cone over first partials only.
struct BareCone {
  static constexpr SurfaceInfo info{"bare_cone", "no closed frame", Coordinate::turn, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S zero = lift<S>(0.0), tau = two_pi<S>();
    return {.position = {v * u.cos, v * u.sin, v},
            .dpdu = {-(tau * v * u.sin), tau * v * u.cos, zero},
            .dpdv = {u.cos, u.sin, lift<S>(1.0)},
            .d2pdu2 = {},
            .d2pduv = {},
            .d2pdv2 = {}};
  }
};

// Its second partials are left out and tell nothing; dual numbers find the limit along the line of the given
// u.
TEST(WithoutClosedFrame, AnApexHasTheLimitOfItsLines) {
  const Sample<double> s = sample(BareCone{}, 0.3, 0.0);
  EXPECT_EQ(s.frame.status, Status::dpdu_zero | Status::limit_frame);
  const Turn<double> u = sincos_turns(0.3);
  EXPECT_LE(norm(s.frame.t - Vec3<double>{-u.sin, u.cos, 0}), 4 * roundoff);
  EXPECT_LE(norm(s.frame.n - std::sqrt(0.5) * Vec3<double>{u.cos, u.sin, -1}), 4 * roundoff);
  const ParametricFrame<double> p = parametric_frame(BareCone{}, 0.3, 0.0);
  EXPECT_LE(norm(p.b - std::sqrt(0.5) * Vec3<double>{u.cos, u.sin, 1}), 4 * roundoff);
  EXPECT_EQ(frame(BareCone{}, 0.3, 1e-300).status, Status::regular);
}

// ---- coordinates and parameters as people write them ------------------------------------------------------

TEST(Points, WholeNumbersAndMixedCoordinatesAreDoubles) {
  const Torus torus{1.0, 0.4};
  EXPECT_EQ(frame(torus, 0, 1).t, frame(torus, 0.0, 1.0).t);
  EXPECT_EQ(frame(torus, 0, 0.3).n, frame(torus, 0.0, 0.3).n);
  EXPECT_EQ(frame(torus, 0.25f, 0.5).n, frame(torus, 0.25, 0.5).n);
  EXPECT_EQ(jet(torus, 1, 0).position, jet(torus, 1.0, 0.0).position);
  EXPECT_EQ(parametric_frame(torus, 0, 1u).b, parametric_frame(torus, 0.0, 1.0).b);
  EXPECT_EQ(sample(Sphere{2.0}, 0, 1).frame.status, sample(Sphere{2.0}, 0.0, 1.0).frame.status);
  EXPECT_EQ(status(Sphere{2.0}, 0, 1), status(Sphere{2.0}, 0.0, 1.0));
  EXPECT_EQ(curvature(torus, 0, 1).mean, curvature(torus, 0.0, 1.0).mean);
  EXPECT_EQ(shape_operator(torus, 0, 1).a, shape_operator(torus, 0.0, 1.0).a);
  const CurveOnSurface<double> along_u{1, 0, 0, 0};
  EXPECT_EQ(darboux_frame(torus, 0, 1, along_u).T, darboux_frame(torus, 0.0, 1.0, along_u).T);
  static_assert(std::is_same_v<decltype(frame(torus, 0.25f, 0.5f)), Frame<float>>);
}

// Without NDEBUG a refused parameter ends the program and says why; with it the formula is evaluated.
TEST(PointsDeathTest, OfRefusedParametersEndADebugProgram) {
  const Torus torus{-2.0, 1.0};
#ifndef NDEBUG
  EXPECT_DEATH(frame(torus, 0.1, 0.2), "major_radius");
  EXPECT_DEATH(sample(torus, 0.1, 0.2), "major_radius");
  std::array<double, 2> uv{0.1, 0.2};
  std::array<Status, 1> status{};
  EXPECT_DEATH(evaluate(torus, Points<double>::interleaved(uv), Outputs<double>().status(status)),
               "major_radius");
  EXPECT_NO_FATAL_FAILURE(frame(Torus{nan_value, 1.0}, 0.1, 0.2));
#else
  EXPECT_EQ(jet(torus, 0.0, 0.0).position.x, -1);
#endif
}

TEST(Points, CheckedRefusesWhatTheCommandLineRefuses) {
  const Torus torus{1.0, 0.4};
  EXPECT_EQ(frame(checked(torus), 0.1, 0.2).t, frame(torus, 0.1, 0.2).t);
  for (const auto& refused :
       {std::function<void()>([] {
          checked(Torus{-2.0, 1.0});
        }),
        std::function<void()>([] { checked(Sphere{nan_value}); }), std::function<void()>([] {
          checked(Disk{1.0, 2.0});
        })})
    EXPECT_THROW(refused(), ParameterError);
  EXPECT_NO_THROW(checked(Torus{0.0, 1.0}));
}

}  // namespace
}  // namespace darboux::test::point_test
