// Evaluation is total: limits at the poles, statuses, and NaN where nothing can be said.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include <darboux/evaluate.h>

#include "every_surface.h"

namespace darboux::test {
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

// ---- limits ---------------------------------------------------------------------------------------------------

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
      // 8u: both frames' own errors, and the step as it is rounded when added to the pole, u times the turning.
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

// ---- the spindle torus states its own orientation ---------------------------------------------------------------

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

// ---- parametric frame --------------------------------------------------------------------------------------------

template <class X>
class Evaluate : public ::testing::Test {};
TYPED_TEST_SUITE(Evaluate, EveryCatalogueSurface, SurfaceNames);

TYPED_TEST(Evaluate, ParametricFrameIsAlongTheCoordinateCurves) {
  Random random(1);
  const TypeParam surface;
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform(), v = random.uniform();
    const ParametricFrame<double> f = parametric_frame(surface, u, v);
    const Jet2<double> j = jet(surface, u, v);
    EXPECT_LE(norm(f.t - unit(j.dpdu)), 8 * roundoff);
    EXPECT_EQ(f.b, unit(j.dpdv));
    EXPECT_EQ(f.n, frame(surface, u, v).n);
  }
}

// ---- statuses ------------------------------------------------------------------------------------------------------

TYPED_TEST(Evaluate, SeamsCloseToTheBit) {
  const TypeParam surface;
  for (const double v : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(jet(surface, 0.0, v).position, jet(surface, 1.0, v).position);
    EXPECT_EQ(distance(frame(surface, 0.0, v), frame(surface, 1.0, v)), 0);
    EXPECT_EQ(distance(frame(surface, 0.25, v), frame(surface, -7.75, v)), 0);
  }
}

TYPED_TEST(Evaluate, OnlyANonPeriodicCoordinateIsEverOutside) {
  const TypeParam surface;
  constexpr bool periodic = TypeParam::info.v == Coordinate::turn;
  EXPECT_FALSE(has(frame(surface, -5.3, 0.3).status, Status::outside_domain));
  for (const double v : {-1e-9, 1 + 1e-9, -3.3, 7.2}) {
    const Sample<double> s = sample(surface, 0.3, v);
    EXPECT_EQ(has(s.frame.status, Status::outside_domain), !periodic) << v;
    EXPECT_FALSE(all_nan(s.frame.n)) << "the analytic extension is given, at v = " << v;
  }
  for (const double v : {0.0, 1.0, 5e-324})
    EXPECT_FALSE(has(frame(surface, 0.3, v).status, Status::outside_domain)) << v;
}

TYPED_TEST(Evaluate, NotFiniteInputGivesFlaggedNan) {
  const auto expect_nan = [](const TypeParam& surface, double u, double v) {
    const Frame<double> f = frame(surface, u, v);
    EXPECT_TRUE(has(f.status, Status::non_finite_input)) << u << ' ' << v;
    EXPECT_TRUE(all_nan(f.t) && all_nan(f.b) && all_nan(f.n)) << u << ' ' << v;
    const ParametricFrame<double> p = parametric_frame(surface, u, v);
    EXPECT_TRUE(all_nan(p.t) && all_nan(p.b) && all_nan(p.n)) << u << ' ' << v;
    EXPECT_FALSE(has(sample(surface, u, v).frame.status, Status::overflow)) << u << ' ' << v;
  };
  for (const double bad : {nan_value, infinity, -infinity}) {
    expect_nan(TypeParam{}, bad, 0.3);
    expect_nan(TypeParam{}, 0.3, bad);
    for_each_parameter<TypeParam>([&](const auto& p) {
      TypeParam surface;
      p.of(surface) = bad;
      expect_nan(surface, 0.3, 0.3);
    });
  }
}

TYPED_TEST(Evaluate, OverflowIsFlaggedAndTheFrameStaysRight) {
  TypeParam surface;
  for_each_parameter<TypeParam>([&](const auto& p) { p.of(surface) = 1e308; });
  const Sample<double> s = sample(surface, 0.1, 0.3);
  EXPECT_TRUE(has(s.frame.status, Status::overflow));
  EXPECT_EQ(distance(s.frame, frame(TypeParam{}, 0.1, 0.3)), 0);
  EXPECT_FALSE(has(sample(TypeParam{}, 0.1, 0.3).frame.status, Status::overflow));
}

TYPED_TEST(Evaluate, FloatIsEvaluatedInFloat) {
  const TypeParam surface;
  const Sample<float> s = sample(surface, 0.3F, 0.6F);
  const Sample<double> d = sample(surface, static_cast<double>(0.3F), static_cast<double>(0.6F));
  EXPECT_EQ(s.frame.status, d.frame.status);
  for (const auto& [f, e] : {std::pair{s.frame.t, d.frame.t}, {s.frame.b, d.frame.b}, {s.frame.n, d.frame.n}})
    EXPECT_LE(std::fabs(f.x - e.x) + std::fabs(f.y - e.y) + std::fabs(f.z - e.z), 3 * 4 * 0x1p-24);
}

// ---- a surface without a closed-form frame -----------------------------------------------------------------------

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

// A user's cone over partials only: at its apex there is no frame, and none is made up.
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

TEST(WithoutClosedFrame, AnApexHasNone) {
  const Sample<double> s = sample(BareCone{}, 0.3, 0.0);
  EXPECT_EQ(s.frame.status, Status::dpdu_zero | Status::no_frame);
  EXPECT_TRUE(all_nan(s.frame.t) && all_nan(s.frame.n));
  const ParametricFrame<double> p = parametric_frame(BareCone{}, 0.3, 0.0);
  EXPECT_TRUE(all_nan(p.t) && all_nan(p.b));
  EXPECT_EQ(frame(BareCone{}, 0.3, 1e-300).status, Status::regular);
}

}  // namespace
}  // namespace darboux::test
