// The uncertainty of a fitted surface's frames against fits that are really moved.
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/fit_points.h>
#include <darboux/project.h>
#include <darboux/shape_operator.h>

#include "every_surface.h"
#include "random.h"
#include "random_pose.h"

namespace darboux::test::frame_uncertainty_test {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

const std::vector<std::string>& kinds() {
  static const std::vector<std::string> list{"plane",
                                             "sphere",
                                             "cylinder",
                                             "cone",
                                             "torus",
                                             "ellipsoid",
                                             "disk:inner_radius=0.2",
                                             "elliptic-paraboloid",
                                             "hyperbolic-paraboloid",
                                             "one-sheet-hyperboloid",
                                             "two-sheet-hyperboloid",
                                             "helicoid",
                                             "catenoid",
                                             "moebius-strip",
                                             "klein-bottle",
                                             "enneper",
                                             "monkey-saddle",
                                             "pseudosphere:turns=0.8",
                                             "tube",
                                             "bilinear-patch",
                                             "graph"};
  return list;
}

PointFit fit_of(const AnySurface& surface, const Eigen::Isometry3d& placement) {
  PointFit fit;
  fit.usable = true;
  fit.surface = PlacedSurface{surface, placement};
  fit.centre = placement * Eigen::Vector3d(0.3, -0.2, 0.1);
  const auto n = static_cast<Eigen::Index>(6 + surface.parameters().size());
  fit.covariance = Eigen::MatrixXd::Zero(n, n);
  return fit;
}

// The fit after the motion and change of parameters δ = (ω, τ, δp).
PointFit moved(const PointFit& fit, const Eigen::VectorXd& delta) {
  PointFit result = fit;
  const Eigen::Vector3d omega = delta.head<3>();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(fit.centre + delta.segment<3>(3));
  if (omega.norm() > 0) motion.rotate(Eigen::AngleAxisd(omega.norm(), omega.normalized()));
  motion.translate(-fit.centre);
  result.surface->placement = motion * fit.surface->placement;
  std::vector<double> values;
  for (const ParameterValue& p : fit.surface->surface.parameters())
    values.push_back(p.value + delta[static_cast<Eigen::Index>(6 + values.size())]);
  result.surface->surface = fit.surface->surface.with(values);
  return result;
}

Eigen::Matrix3d axes(const UncertainFrame& f) {
  Eigen::Matrix3d m;
  m << to_eigen(f.t), to_eigen(f.b), to_eigen(f.n);
  return m;
}

// The rotation vector that takes one frame to the other.
Eigen::Vector3d rotation(const UncertainFrame& from, const UncertainFrame& to) {
  const Eigen::AngleAxisd turn(axes(to) * axes(from).transpose());
  return turn.angle() * turn.axis();
}

Eigen::VectorXd random_vector(Eigen::Index n, Random& random) {
  Eigen::VectorXd result(n);
  for (Eigen::Index k = 0; k < n; ++k) result[k] = random.uniform(-1, 1);
  return result;
}

// A surface of the kind with parameters off their defaults by up to a tenth.
AnySurface varied(const std::string& kind, Random& random) {
  const AnySurface standard = make_surface(kind);
  std::vector<double> values;
  for (const ParameterValue& p : standard.parameters()) values.push_back(p.value * random.uniform(0.9, 1.1));
  return standard.with(values);
}

// With Σ = s² δ δ^T the stated covariance is s² θ θ^T, θ the rotation by δ, here of fits moved by
// ±h δ. h = 1e-5 leaves errors of h² times third derivatives, which grow towards poles and edges, and
// of 1e-16 / h; s is so small that no pole is in reach.
TEST(FrameUncertainty, IsTheFirstOrderOfRealMotions) {
  Random random(1);
  std::mt19937_64 engine(1);
  constexpr double h = 1e-5, s = 1e-9;
  for (const std::string& kind : kinds())
    for (int k = 0; k < 40; ++k) {
      PointFit fit = fit_of(varied(kind, random), random_pose(engine, 2));
      const Vec2<double> uv{random.uniform(0.05, 0.95), random.uniform(0.1, 0.9)};
      const AnySurface& surface = fit.surface->surface;
      const Sample<double> sample = surface.sample(uv.x, uv.y);
      const ShapeOperator<double> shape = shape_operator(sample.jet, sample.frame);
      const double curvature =
          std::fabs((shape.a + shape.c) / 2) + std::hypot((shape.a - shape.c) / 2, shape.m);
      const double distance = random.uniform(-0.2, 0.2) * std::fmin(1 / curvature, 0.2);
      const Vec3<double> p =
          from_eigen(fit.surface->placement * to_eigen(sample.jet.position + distance * sample.frame.n));
      const Eigen::VectorXd delta = random_vector(fit.covariance.rows(), random);
      fit.covariance = s * s * delta * delta.transpose();
      const PointFit plus = moved(fit, h * delta), minus = moved(fit, -h * delta);
      const auto check = [&](const char* what, const UncertainFrame& frame, const UncertainFrame& after,
                             const UncertainFrame& before) {
        const Eigen::Vector3d theta = axes(frame).transpose() * rotation(before, after) / (2 * h);
        const Eigen::Matrix3d expected = theta * theta.transpose();
        EXPECT_LE((frame.covariance / (s * s) - expected).norm(),
                  1e-7 * (1 + theta.squaredNorm() * theta.norm()))
            << what << " " << surface.specification() << " at " << uv.x << ", " << uv.y << "\nstated\n"
            << frame.covariance / (s * s) << "\nmeasured\n"
            << expected;
        EXPECT_NEAR(frame.normal_deg / degrees, s * std::hypot(theta[0], theta[1]),
                    1e-6 * s * (1 + theta.squaredNorm()));
        EXPECT_NEAR(frame.tangent_deg / degrees, s * std::hypot(theta[1], theta[2]),
                    1e-6 * s * (1 + theta.squaredNorm()));
      };
      check("at", frame_at(fit, uv), frame_at(plus, uv), frame_at(minus, uv));
      const UncertainFrame near = frame_near(fit, p);
      // On the few that come near themselves another foot may be nearer.
      if (kind != "klein-bottle" && kind != "tube") {
        EXPECT_LE(norm(near.uv - uv), 1e-12) << kind;
      }
      EXPECT_LE(
          (to_eigen(near.position) +
           (to_eigen(p) - to_eigen(near.position)).dot(to_eigen(near.n)) * to_eigen(near.n) - to_eigen(p))
              .norm(),
          1e-12);
      check("near", near, frame_near(plus, p), frame_near(minus, p));
    }
}

// The covariance of the frames of 20000 fits drawn around one. Its sampling error is 1/100 in a variance;
// five of these.
TEST(FrameUncertainty, IsTheSpreadOfRandomFits) {
  Random random(2);
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  constexpr int draws = 20000;
  for (const char* kind : {"sphere", "cylinder", "cone", "torus", "ellipsoid", "plane"}) {
    PointFit fit = fit_of(varied(kind, random), random_pose(engine, 2));
    const Eigen::Index n = fit.covariance.rows();
    Eigen::MatrixXd root(n, n);
    for (Eigen::Index c = 0; c < n; ++c) root.col(c) = 3e-4 * random_vector(n, random);
    fit.covariance = root * root.transpose();
    const Vec2<double> uv{0.3, 0.4};
    const Sample<double> s = fit.surface->surface.sample(uv.x, uv.y);
    const Vec3<double> p = from_eigen(fit.surface->placement * to_eigen(s.jet.position + 0.05 * s.frame.n));
    const UncertainFrame near = frame_near(fit, p), at = frame_at(fit, uv);
    Eigen::Matrix3d of_near = Eigen::Matrix3d::Zero(), of_at = Eigen::Matrix3d::Zero();
    for (int k = 0; k < draws; ++k) {
      Eigen::VectorXd z(n);
      for (Eigen::Index i = 0; i < n; ++i) z[i] = normal(engine);
      const PointFit other = moved(fit, root * z);
      const Eigen::Vector3d a = axes(near).transpose() * rotation(near, frame_near(other, p));
      const Eigen::Vector3d b = axes(at).transpose() * rotation(at, frame_at(other, uv));
      of_near += a * a.transpose() / draws;
      of_at += b * b.transpose() / draws;
    }
    EXPECT_LE((of_near - near.covariance).norm(), 0.05 * near.covariance.norm()) << kind;
    EXPECT_LE((of_at - at.covariance).norm(), 0.05 * at.covariance.norm()) << kind;
  }
}

// A sphere whose centre is uncertain by sigma in each direction: at an angle theta from its pole t turns by
// sigma / (r sin theta), n by sigma / r in each direction.
TEST(FrameUncertainty, TangentIsUnknownWithinReachOfAPole) {
  constexpr double sigma = 1e-3;
  const double nowhere = HUGE_VAL;
  PointFit fit = fit_of(make_surface("sphere"), Eigen::Isometry3d::Identity());
  fit.covariance.block<3, 3>(3, 3) = sigma * sigma * Eigen::Matrix3d::Identity();
  const auto at_angle = [&](double theta) { return frame_near(fit, {std::sin(theta), 0, std::cos(theta)}); };
  const double n_deg = std::sqrt(2) * sigma * degrees;
  const UncertainFrame far = at_angle(0.5);
  EXPECT_NEAR(far.normal_deg, n_deg, 1e-9);
  EXPECT_NEAR(far.tangent_deg, degrees * sigma * std::hypot(1, 1 / std::tan(0.5)), 1e-9);
  // dpdu changes by its own length in 3 (2)^(1/2) sigma: it turns across, and shrinks along the meridian.
  EXPECT_LT(at_angle(1.01 * 3 * std::sqrt(2) * sigma).tangent_deg, 20);
  for (const double theta : {0.99 * 3 * std::sqrt(2) * sigma, sigma, 1e-6, 1e-12, 0.0}) {
    const UncertainFrame near = at_angle(theta);
    EXPECT_EQ(near.tangent_deg, nowhere) << theta;
    EXPECT_NEAR(near.normal_deg, n_deg, 1e-5 * n_deg) << theta;
    EXPECT_EQ(near.covariance(2, 2), nowhere);
    EXPECT_TRUE(near.covariance.topLeftCorner(2, 2).allFinite());
  }
  // At a fixed (u, v) the pole moves with the chart, and t is unknown at the pole alone.
  EXPECT_NEAR(frame_at(fit, {0.1, 1e-4}).tangent_deg, 0, 1e-9);
  EXPECT_EQ(frame_at(fit, {0.1, 0}).tangent_deg, nowhere);
  EXPECT_NEAR(frame_at(fit, {0.1, 0}).normal_deg, 0, 1e-9);
  for (const char* flat : {"disk:inner_radius=0.2", "elliptic-paraboloid"}) {
    PointFit cup = fit_of(make_surface(flat), Eigen::Isometry3d::Identity());
    cup.covariance.block<3, 3>(3, 3) = sigma * sigma * Eigen::Matrix3d::Identity();
    EXPECT_EQ(frame_near(cup, {sigma, 0, 0}).tangent_deg, nowhere) << flat;
    EXPECT_LT(frame_near(cup, {sigma, 0, 0}).normal_deg, 1) << flat;
  }
}

TEST(FrameUncertainty, NormalIsUnknownAtAnApex) {
  constexpr double sigma = 1e-3;
  for (const char* kind : {"cone:radius=1,height=1", "cone:radius=1,height=0.01"}) {
    const AnySurface cone = make_surface(kind);
    PointFit fit = fit_of(cone, Eigen::Isometry3d::Identity());
    fit.covariance.block<3, 3>(3, 3) = sigma * sigma * Eigen::Matrix3d::Identity();
    for (const double v : {1.0, 1 - sigma}) {
      const UncertainFrame near = frame_near(fit, cone.jet(0.2, v).position);
      EXPECT_EQ(near.normal_deg, HUGE_VAL) << kind << " at " << v;
      EXPECT_EQ(near.tangent_deg, HUGE_VAL) << kind << " at " << v;
    }
    EXPECT_LT(frame_near(fit, cone.jet(0.2, 0.5).position).normal_deg, 1);
    EXPECT_LT(frame_near(fit, cone.jet(0.2, 0.5).position).tangent_deg, 1);
  }
}

// At the centre of a sphere every point is nearest.
TEST(FrameUncertainty, IsInfiniteInFocalPoints) {
  const PointFit fit = fit_of(make_surface("sphere"), Eigen::Isometry3d::Identity());
  EXPECT_EQ(frame_near(fit, {0, 0, 0}).normal_deg, HUGE_VAL);
  EXPECT_EQ(frame_near(fit, {0, 0, 0}).tangent_deg, HUGE_VAL);
}

TEST(FrameUncertainty, IsTotalForBadPoints) {
  const PointFit fit = fit_of(make_surface("torus"), Eigen::Isometry3d::Identity());
  const double nan = std::nan("");
  for (const UncertainFrame& frame : {frame_near(fit, {nan, 0, 0}), frame_at(fit, {0, nan})}) {
    EXPECT_TRUE(has(frame.status, Status::non_finite_input));
    EXPECT_EQ(frame.normal_deg, HUGE_VAL);
  }
}

TEST(FrameUncertainty, RefusesWhatHasNoCovariance) {
  EXPECT_THROW(frame_near(PointFit{}, {0, 0, 0}), ParameterError);
  PointFit fit = fit_of(make_surface("sphere"), Eigen::Isometry3d::Identity());
  fit.covariance.setZero(6, 6);
  EXPECT_THROW(frame_at(fit, {0.1, 0.2}), ParameterError);
  fit = fit_of(make_surface("superellipsoid"), Eigen::Isometry3d::Identity());
  EXPECT_THROW(frame_at(fit, {0.1, 0.2}), ParameterError);
}

// Feet in closed form are those of the search.
TEST(FrameUncertainty, FeetAreTheNearestPoints) {
  Random random(3);
  for (const char* kind :
       {"sphere", "cylinder", "cone", "torus", "plane", "ellipsoid", "torus:major_radius=0.5,minor_radius=1",
        "ellipsoid:semi_axis_x=1,semi_axis_y=1,semi_axis_z=0.3",
        "ellipsoid:semi_axis_x=0.2,semi_axis_y=1,semi_axis_z=1"}) {
    const PointFit fit = fit_of(make_surface(kind), Eigen::Isometry3d::Identity());
    const Projector search(fit.surface->surface);
    for (int k = 0; k < 200; ++k) {
      Vec3<double> p = random.uniform(0, 2) * random.direction();
      if (k % 10 == 0) p.x = 0;
      if (k % 10 == 1) p.y = 0;
      if (k % 10 == 2) p.z = 0;
      if (k % 10 == 3) p.x *= 1e-17;
      if (k % 10 == 4) p.y *= 1e-17;
      if (k % 10 == 5) p.z *= 1e-17;
      if (k % 10 == 6) p.z *= 1e-300;
      const double found = norm(frame_near(fit, p).position - p), searched = std::fabs(search(p).distance);
      EXPECT_NEAR(found, searched, 1e-13) << kind << " from " << p.x << ", " << p.y << ", " << p.z;
    }
  }
}

}  // namespace
}  // namespace darboux::test::frame_uncertainty_test
