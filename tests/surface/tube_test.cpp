// Tubes about every kind of curve: their distance from it, their frames, and where they have none.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <darboux/evaluate.h>
#include <darboux/framed_curve.h>
#include <darboux/torus.h>
#include <darboux/tube.h>

#include "compare_frames.h"
#include "every_surface.h"

namespace darboux::test::tube_test {
namespace {

using Vec = Vec3<double>;

template <class Curve>
void expect_tube(const Curve& curve, double radius, double turning_error = 0) {
  const Tube<Curve> tube{curve, radius};
  checked(tube);
  const double scale = 1 + radius;
  for (int i = 0; i <= 12; ++i)
    for (int k = 0; k <= 12; ++k) {
      const double u = i / 12.0, v = k / 12.0;
      const auto t = prepare<Curve::kind>(u);
      const CurveJet<double> centre = curve.jet(t);
      const Jet2<double> j = jet(tube, u, v);
      const Frame<double> f = frame(tube, u, v);
      const Vec out = j.position - centre.position;
      EXPECT_NEAR(norm(out), radius, 16 * roundoff * (scale + norm(centre.position)));
      EXPECT_LE(norm(f.n - out / radius), 32 * roundoff * (scale + norm(centre.position)) / radius)
          << u << " " << v;
      EXPECT_NEAR(dot(f.n, unit(centre.first)), 0, 16 * roundoff);
      EXPECT_EQ(f.status, Status::regular) << u << " " << v;
      EXPECT_EQ(f.handedness, 1);
      EXPECT_LE(norm(f.t - unit(j.dpdu)), 1e-13) << u << " " << v;
      EXPECT_LE(norm(f.n - unit(cross(j.dpdu, j.dpdv))), 1e-13) << u << " " << v;
      // The partials against differences of the position.
      const double h = 1e-5;
      if (i == 0 || i == 12) continue;
      const Vec du = (jet(tube, u + h, v).position - jet(tube, u - h, v).position) / (2 * h);
      const Vec dv = (jet(tube, u, v + h).position - jet(tube, u, v - h).position) / (2 * h);
      EXPECT_LE(norm(du - j.dpdu), 1e-6 * (1 + norm(j.dpdu)) + radius * turning_error / h) << u << " " << v;
      EXPECT_LE(norm(dv - j.dpdv), 1e-6 * (1 + norm(j.dpdv))) << u << " " << v;
    }
}

BSplineCurve<double> space_curve() {
  return {3, clamped_knots(3, 4), {{0, 0, 0}, {1, 1, 0.3}, {2, -1, 0.6}, {3, 0, 1}}, {1, 2, 0.7, 1}};
}

TEST(Tubes, KeepTheirDistanceFromEveryKindOfCurve) {
  expect_tube(LineSegment<double>{{1, 2, 3}, {-1, 0.5, 4}}, 0.3);
  expect_tube(CircleCurve{2.0}, 0.5);
  expect_tube(HelixCurve{1.0, 0.25, 2.0}, 0.1);
  expect_tube(HelixCurve{1.0, -0.25, 1.0}, 0.1);
  expect_tube(PlanarCurve<>{}, 0.02);
  expect_tube(
      PlanarCurve{BSplineCurve<double>(2, {0, 0, 0, 1, 1, 1}, {{1, 0, 2}, {1, 1, 2}, {0, 1, 2}}, {1, 1, 2})},
      0.4);
  expect_tube(UprightCurve{HelixCurve{1.0, 0.25, 1.0}}, 0.1);
  expect_tube(UprightCurve{space_curve()}, 0.05);
  const RotationMinimisingCurve helix{HelixCurve{1.0, 0.25, 1.0}};
  const RotationMinimisingCurve spline{space_curve()};
  EXPECT_LT(helix.turning_error(), 1e-12);
  EXPECT_LT(spline.turning_error(), 1e-7);
  expect_tube(helix, 0.1, helix.turning_error());
  expect_tube(spline, 0.05, spline.turning_error());
}

TEST(Tubes, OfACircleIsATorus) {
  const Torus torus{2.0, 0.5};
  const Tube tube{CircleCurve{2.0}, 0.5};
  for (int i = 0; i <= 16; ++i)
    for (int k = 0; k <= 16; ++k) {
      const double u = i / 16.0, v = k / 16.0;
      EXPECT_NEAR(torus.implicit(jet(tube, u, v).position), 0, 8 * roundoff);
      // N is inward: the tube's v begins at the inner equator, and runs downwards there.
      EXPECT_LE(norm(frame(tube, u, v).n - frame(torus, u, v + 0.5).n), 8 * roundoff) << u << " " << v;
      EXPECT_LE(norm(frame(tube, u, v).t - frame(torus, u, v + 0.5).t), 8 * roundoff) << u << " " << v;
    }
}

// The frame of a rotation-minimising curve turns about T not at all: N' has no part along B.
TEST(Tubes, RotationMinimisingFrameDoesNotTwist) {
  const RotationMinimisingCurve curve{HelixCurve{1.0, 0.4, 1.0}};
  const UprightCurve twisting{HelixCurve{1.0, 0.4, 1.0}};
  const double h = 1e-4;
  for (int i = 1; i < 16; ++i) {
    const double t = i / 16.0;
    const auto rate = [&](const auto& c) {
      const CurveFrame<double> f = c.moving_frame(t);
      return dot((c.moving_frame(t + h).N - c.moving_frame(t - h).N) / (2 * h), f.B);
    };
    EXPECT_NEAR(rate(curve), 0, 1e-6) << t;
    EXPECT_NEAR(rate(twisting), twisting.moving_frame(t).twist, 1e-6) << t;
    EXPECT_GT(std::fabs(rate(twisting)), 0.1) << t;
  }
  EXPECT_LE(norm(curve.moving_frame(0.0).N - twisting.moving_frame(0.0).N), 4 * roundoff);
  // Bishop's angle on a helix: φ' = -torsion against Frenet's frame, torsion times length
  // 2π p/sqrt(R² + p²).
  const CurveFrame<double> end = curve.moving_frame(1.0),
                           frenet = HelixCurve{1.0, 0.4, 1.0}.moving_frame(1.0);
  const CurveFrame<double> begin = curve.moving_frame(0.0),
                           first = HelixCurve{1.0, 0.4, 1.0}.moving_frame(0.0);
  const double before = std::atan2(dot(begin.N, first.B), dot(begin.N, first.N));
  const double after = std::atan2(dot(end.N, frenet.B), dot(end.N, frenet.N));
  const double torsion_angle = 2 * std::numbers::pi * 0.4 / std::sqrt(1 + 0.4 * 0.4);
  EXPECT_NEAR(std::remainder(after - before + torsion_angle, 2 * std::numbers::pi), 0, 1e-12);
}

TEST(Tubes, SayWhereTheRadiusReachesTheCurvatureRadius) {
  const Tube touching{CircleCurve{1.0}, 1.0};
  EXPECT_EQ(frame(touching, 0.3, 0.0).status, Status::dpdu_zero | Status::limit_frame);
  EXPECT_EQ(frame(touching, 0.3, 0.25).status, Status::regular);
  const Tube through{CircleCurve{1.0}, 1.5};
  EXPECT_EQ(frame(through, 0.3, 0.0).status, Status::self_intersecting);
  EXPECT_EQ(frame(through, 0.3, 0.0).handedness, -1);
  EXPECT_EQ(frame(through, 0.3, 0.5).status, Status::regular);
  EXPECT_EQ(frame(through, 0.3, 0.5).handedness, 1);
  const Vec out = jet(through, 0.3, 0.0).position - CircleCurve{1.0}.jet(sincos_turns(0.3)).position;
  EXPECT_LE(norm(frame(through, 0.3, 0.0).n - out / 1.5), 8 * roundoff);
  // Curvature radius (R² + p²)/R = 2
  EXPECT_EQ(frame(Tube{HelixCurve{1.0, 1.0, 1.0}, 2.0}, 0.3, 0.0).status,
            Status::parallel | Status::limit_frame);
  EXPECT_EQ(frame(Tube{HelixCurve{1.0, 1.0, 1.0}, 1.99}, 0.3, 0.0).status, Status::regular);
  EXPECT_EQ(frame(Tube{HelixCurve{1.0, 1.0, 1.0}, 2.01}, 0.3, 0.0).status, Status::self_intersecting);
}

TEST(Tubes, HaveNoFrameWhereTheCurveStops) {
  const auto stopping = []<class S>(const S& t) {  // at t = 1/2
    const S x = t - lift<S>(0.5);
    return Vec3<S>{x * x, x * x * x, lift<S>(0.0)};
  };
  const Tube tube{PlanarCurve{PositionCurve{stopping}}, 0.1};
  const Frame<double> f = frame(tube, 0.5, 0.2);
  EXPECT_EQ(f.status, Status::dpdu_zero | Status::no_frame);
  EXPECT_TRUE(all_nan(f));
  EXPECT_TRUE(finite(frame(tube, 0.25, 0.2).n));
}

TEST(Tubes, HaveNoFrameWhereTheCurveRunsAlongUp) {
  const auto arc = []<class S>(const S& t) {  // begins along z
    return Vec3<S>{t * t, lift<S>(0.0), t};
  };
  const Tube tube{UprightCurve{PositionCurve{arc}}, 0.1};
  const Frame<double> f = frame(tube, 0.0, 0.2);
  EXPECT_TRUE(has(f.status, Status::no_frame));
  EXPECT_TRUE(all_nan(f));
  EXPECT_EQ(frame(tube, 0.25, 0.2).status, Status::regular);
}

}  // namespace
}  // namespace darboux::test::tube_test
