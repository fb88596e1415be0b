// The paraboloid of revolution: found among the primitives, and only where the points tell it from the
// others.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/ellipsoid.h>
#include <darboux/elliptic_paraboloid.h>
#include <darboux/fit_mesh.h>
#include <darboux/fit_points.h>
#include <darboux/sample_mesh.h>
#include <darboux/sphere.h>

namespace darboux::test::paraboloid_test {
namespace {

constexpr std::uint64_t seed = 20;

// Sums of twelve uniform numbers: the same on every standard library.
double normal(std::mt19937_64& random) {
  double sum = -6;
  for (int k = 0; k < 12; ++k) sum += static_cast<double>(random() >> 11) * 0x1p-53;
  return sum;
}

Eigen::Isometry3d somewhere() {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  at.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.2, -0.5, 0.8).normalized()).toRotationMatrix();
  at.translation() = Eigen::Vector3d(3, -7, 2);
  return at;
}

// Points at u up to a turn, v from `least` to `most`, with this noise; the first `outliers` of them anywhere
// near.
PointCloud points_of(const AnySurface& surface, int count, double turn, double least, double most,
                     double noise, int outliers = 0) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const Eigen::Isometry3d at = somewhere();
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    // Even over the area of a disk.
    const double v = std::sqrt(least * least + (most * most - least * least) * uniform());
    Eigen::Vector3d p = to_eigen(surface.jet(turn * uniform(), v).position);
    if (i < outliers) p = Eigen::Vector3d(4 * uniform() - 2, 4 * uniform() - 2, 4 * uniform() - 1);
    p += noise * Eigen::Vector3d(normal(random), normal(random), normal(random));
    cloud.positions.push_back(from_eigen(at * p));
  }
  return cloud;
}

double value(const PointFit& fit, std::size_t k) {
  return fit.surface->surface.parameters()[k].value;
}

std::string kind_of(const PointFit& fit) {
  return fit.usable ? std::string(fit.surface->surface.info().name) : "none: " + fit.reason;
}

// z = h (r/a)^2 has the radius of curvature a^2 / 2h at its vertex.
void expect_paraboloid(const PointFit& fit, double radius, double vertex_tolerance) {
  ASSERT_EQ(kind_of(fit), "elliptic-paraboloid") << "seed " << seed;
  EXPECT_EQ(value(fit, 0), value(fit, 1));
  ASSERT_EQ(fit.standard_errors[0].name, "semi_axis_x");
  // The radius has twice the relative error of the semi-axis, at a height that is held.
  const double relative = 2 * fit.standard_errors[0].value / value(fit, 0);
  EXPECT_NEAR(value(fit, 0) * value(fit, 0) / (2 * value(fit, 2)), radius, 5 * relative * radius + 1e-12);
  EXPECT_LT((fit.surface->placement.translation() - somewhere().translation()).norm(), vertex_tolerance);
}

TEST(Paraboloid, IsFoundAmongOutliers) {
  const PointFit fit = fit_points(points_of(EllipticParaboloid{1.0, 1.0, 0.9}, 2000, 1, 0, 1, 0.01, 300));
  expect_paraboloid(fit, 1 / 1.8, 0.02);
  EXPECT_NEAR(fit.sigma, 0.01, 0.002);
}

// Long ellipsoids fit as well, and are no other surface where the points are.
TEST(Paraboloid, IsTheLimitOfLongEllipsoids) {
  const PointFit fit = fit_points(points_of(EllipticParaboloid{1.0, 1.0, 0.9}, 2000, 1, 0, 1, 0.01, 300));
  EXPECT_EQ(fit.reason, "converged; an ellipsoid cannot be excluded") << "seed " << seed;
}

TEST(Paraboloid, IsFoundInAPatchBesideTheVertex) {
  const PointFit fit = fit_points(points_of(EllipticParaboloid{1.0, 1.0, 1.2}, 2000, 0.4, 0.3, 1, 0.002));
  expect_paraboloid(fit, 1 / 2.4, 0.05);
}

// By name two more lengths are sought, from the round paraboloid on: of exact points none lay on what was
// found.
TEST(Paraboloid, IsFoundByNameInExactPatches) {
  for (const double height : {0.5, 1.0})
    for (const double turn : {0.1, 0.25}) {
      SCOPED_TRACE(testing::Message() << height << ' ' << turn);
      const PointFit fit = fit_points(points_of(EllipticParaboloid{1.0, 1.0, height}, 300, turn, 0, 1, 0),
                                      {.surface = "elliptic-paraboloid"});
      EXPECT_EQ(kind_of(fit), "elliptic-paraboloid");
      if (!fit.usable) continue;
      EXPECT_EQ(fit.outliers, 0u);
      for (const std::size_t k : {0u, 1u})
        EXPECT_NEAR(value(fit, k) * value(fit, k) / (2 * value(fit, 2)), 0.5 / height, 1e-6);
    }
}

TEST(Paraboloid, IsExactWithoutNoise) {
  const PointFit fit = fit_points(points_of(EllipticParaboloid{1.0, 1.0, 0.9}, 300, 1, 0, 1, 0));
  expect_paraboloid(fit, 1 / 1.8, 1e-11);
}

// Sphere and paraboloid of one curvature part by r^4 / 8R^3: 2e-4 at the rim of this cap, a fiftieth of the
// noise.
TEST(Paraboloid, ACapWithinTheNoiseIsNotTakenForOne) {
  const PointFit fit = fit_points(points_of(EllipticParaboloid{1.0, 1.0, 0.5}, 400, 1, 0, 0.2, 0.01));
  EXPECT_NE(kind_of(fit), "elliptic-paraboloid") << "seed " << seed;
}

TEST(Paraboloid, OtherSurfacesStayWhatTheyAre) {
  EXPECT_EQ(kind_of(fit_points(points_of(Sphere{1.0}, 1000, 1, 0, 0.5, 0.005))), "sphere");
  EXPECT_EQ(kind_of(fit_points(points_of(Ellipsoid{1.5, 1.0, 0.7}, 2000, 1, 0, 1, 0.003))), "ellipsoid");
}

TEST(Paraboloid, IsRecognisedFromPositions) {
  Mesh mesh = sample_mesh(EllipticParaboloid{1.0, 1.0, 0.8}, {.columns = 33, .rows = 17});
  mesh.uvs.clear();
  const auto fit = fit_positions(mesh);
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->surface.surface.info().name, "elliptic-paraboloid");
  EXPECT_LT(fit->rms_relative, 1e-6);
}

// The foot is where the normal through the point meets the surface.
TEST(Paraboloid, FeetInClosedForm) {
  PointFit fit;
  fit.surface = PlacedSurface{EllipticParaboloid{1.0, 1.0, 0.8}};
  fit.covariance = Eigen::MatrixXd::Zero(9, 9);
  for (const double r : {0.0, 0.1, 0.7, 3.0})
    for (const double z : {-2.0, 0.0, 0.3, 1.5}) {
      if (r == 0 && z > 0.3) continue;  // above the focal point there are many
      const Vec3<double> p{r * 0.6, r * 0.8, z};
      const UncertainFrame at = frame_near(fit, p);
      const Vec3<double> way = p - at.position;
      EXPECT_LT(norm(cross(way, at.n)), 1e-13 * (1 + norm(way))) << r << " " << z;
      EXPECT_NEAR(at.position.z, 0.8 * (at.position.x * at.position.x + at.position.y * at.position.y),
                  1e-13);
    }
}

}  // namespace
}  // namespace darboux::test::paraboloid_test
