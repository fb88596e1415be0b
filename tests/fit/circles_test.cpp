// Cylinders and cones as measuring machines touch them: in a few circles. Neighbours lie along one curve, so
// that no normals are told; the surface is found by equations.
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <darboux/fit_points.h>
#include <darboux/vector.h>

namespace darboux::circles_test {
namespace {

constexpr unsigned seed = 71;

struct Circles {
  int circles, points;
  bool staggered;
};

// Of radius 10 at the lowest circle, 20 high, somewhere.
PointCloud measured(const Circles& c, double taper, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, noise);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random)).normalized();
  const Eigen::Vector3d shift(20 * uniform(random), 20 * uniform(random), 20 * uniform(random));
  PointCloud cloud;
  for (int i = 0; i < c.circles; ++i)
    for (int k = 0; k < c.points; ++k) {
      const double z = 20.0 * i / (c.circles - 1), r = 10 - taper * z,
                   x = 2 * std::numbers::pi * (k + (c.staggered ? 0.5 * (i % 2) : 0)) / c.points;
      const Eigen::Vector3d error(normal(random), normal(random), normal(random));
      const Eigen::Vector3d p = turn * Eigen::Vector3d(r * std::cos(x), r * std::sin(x), z) + shift + error;
      cloud.positions.push_back(from_eigen(p));
    }
  return cloud;
}

constexpr Circles all_circles[] = {{2, 6, true},    {2, 6, false}, {2, 8, false},  {2, 24, false},
                                   {2, 200, true},  {3, 4, true},  {3, 24, false}, {3, 200, false},
                                   {4, 100, false}, {6, 40, true}};

TEST(FitCircles, CylindersAndConesAreFoundByName) {
  std::mt19937_64 random(seed);
  std::cout << "seed " << seed << '\n';
  for (const Circles& c : all_circles)
    for (const double taper : {0.0, 0.25}) {
      SCOPED_TRACE(std::to_string(c.circles) + " circles of " + std::to_string(c.points) + ", taper " +
                   std::to_string(taper));
      const std::string kind = taper == 0 ? "cylinder" : "cone";
      const PointFit fit = fit_points(measured(c, taper, 1e-3, random), {.surface = kind});
      EXPECT_TRUE(fit.usable) << fit.reason;
      if (!fit.usable) continue;
      const std::size_t n = static_cast<std::size_t>(c.circles) * static_cast<std::size_t>(c.points);
      EXPECT_GE(fit.inliers, n - n / 50) << n;
      EXPECT_NEAR(fit.surface->surface.parameters()[0].value, 10, 10e-3);
    }
}

// Two circles lie on a sphere, and on a torus, as well: then nothing is said.
TEST(FitCircles, NoOtherKindIsClaimed) {
  std::mt19937_64 random(seed);
  for (const Circles& c : all_circles)
    for (const double taper : {0.0, 0.25}) {
      if (c.circles * c.points < 12) continue;
      SCOPED_TRACE(std::to_string(c.circles) + " circles of " + std::to_string(c.points));
      const PointFit fit = fit_points(measured(c, taper, 1e-3, random), {});
      if (c.circles > 3) {
        EXPECT_TRUE(fit.usable) << fit.reason;
      }
      if (fit.usable) {
        EXPECT_EQ(fit.surface->surface.info().name, taper == 0 ? "cylinder" : "cone")
            << fit.reason << ", " << fit.inliers;
      }
    }
}

// Heights that are exact, as of a turning table, make each circle a plane's to the last bit.
TEST(FitCircles, AnExactPlaneOfHalfThePointsIsNoAnswer) {
  std::mt19937_64 random(seed);
  for (const double taper : {0.0, 0.25}) {
    PointCloud cloud = measured({2, 200, false}, taper, 1e-3, random);
    std::normal_distribution<double> normal(0, 1e-3);
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const double x = 2 * std::numbers::pi * static_cast<double>(i % 200) / 200, z = i < 200 ? 0 : 20,
                   r = 10 - taper * z + normal(random);
      cloud.positions[i] = {r * std::cos(x), r * std::sin(x), z};
    }
    const PointFit fit = fit_points(cloud, {});
    EXPECT_FALSE(fit.usable) << fit.reason;
  }
}

// A rim whose height is a thousandth of its radius.
TEST(FitCircles, AShortBandIsACylinder) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  PointCloud cloud;
  for (int k = 0; k < 500; ++k) {
    const double x = 2 * std::numbers::pi * uniform(random);
    cloud.positions.push_back({10 * std::cos(x), 10 * std::sin(x), 0.01 * uniform(random)});
  }
  for (const char* kind : {"cylinder", "auto"}) {
    const PointFit fit = fit_points(cloud, {.surface = kind});
    ASSERT_TRUE(fit.usable) << fit.reason;
    EXPECT_EQ(fit.surface->surface.info().name, "cylinder");
    EXPECT_NEAR(fit.surface->surface.parameters()[0].value, 10, 1e-7);
  }
}

}  // namespace
}  // namespace darboux::circles_test
