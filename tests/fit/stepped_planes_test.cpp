// Planes parallel to an axis, of rounded coordinates: all points lie on few levels.
#include <cmath>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include <darboux/fit_points.h>

#include "fit/common/normalised_points.h"
#include "synthetic_points.h"

namespace darboux::stepped_planes_test {
namespace {

struct Steps {
  double step;
  bool floats;
  double operator()(double x) const {
    const double rounded = std::round(x / step) * step;
    return floats ? static_cast<double>(static_cast<float>(rounded)) : rounded;
  }
};
constexpr Steps all_steps[] = {{0.001, false}, {0.001, true}, {0.00254, false}, {0x1p-10, false}};

double standard_error(const PointFit& fit, const std::string& name) {
  for (const StandardError& error : fit.standard_errors)
    if (error.name == name) return error.value;
  return 0;
}

// One level was the plane, without noise, and the next ones outliers; or a sphere could not be excluded.
TEST(SteppedPlanes, AreFound) {
  PortableRandom random(256);
  std::cout << "seed 256\n";
  for (const Steps& steps : all_steps)
    for (const double noise : {0.3, 0.7})
      for (const bool is_named : {false, true})
        for (int repeat = 0; repeat < (is_named ? 5 : 1); ++repeat) {
          const int count = is_named ? 1000 : 200;
          const double height = 1.5 + steps.step * random.uniform();
          PointCloud cloud;
          for (int i = 0; i < count; ++i) {
            const Eigen::Vector3d p = Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), height) +
                                      noise * steps.step * random.normals();
            cloud.positions.push_back({steps(p.x()), steps(p.y()), steps(p.z())});
          }
          PointFitOptions options;
          if (is_named) options.surface = "plane";
          const PointFit fit = fit_points(cloud, options);
          SCOPED_TRACE("step " + std::to_string(steps.step) + ", noise " + std::to_string(noise) + ", of " +
                       std::to_string(count) + ", repeat " + std::to_string(repeat));
          ASSERT_TRUE(fit.usable) << fit.reason;
          ASSERT_EQ(fit.surface->surface.info().name, "plane");
          EXPECT_GE(fit.inliers, static_cast<std::size_t>(count) * 97 / 100);
          EXPECT_NEAR(fit.surface->placement.translation().z(), height, 4 * standard_error(fit, "centre"));
          EXPECT_LE(fit.sigma, 1.15 * std::hypot(noise, 0.5) * steps.step);
        }
}

// Neither points that are not rounded, nor those of one level, nor a grid's that a surface of any height is
// over, nor a shape's own steps.
TEST(SteppedPlanes, OtherPointsHaveNoSteps) {
  PortableRandom random(257);
  std::cout << "seed 257\n";
  PointCloud doubles, one_level, over_a_grid, coarse;
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    doubles.positions.push_back({x, y, 1 + 1e-4 * random.normal()});
    one_level.positions.push_back({std::round(1024 * x) / 1024, std::round(1024 * y) / 1024, 1.5});
    over_a_grid.positions.push_back({i % 40 * 1.0, i / 40 * 1.0, 0.01 * random.normal()});
    coarse.positions.push_back({std::round(10 * x), std::round(10 * y), std::floor(random.uniform(0, 2))});
  }
  for (const PointCloud* cloud : {&doubles, &one_level, &over_a_grid, &coarse})
    EXPECT_EQ(fit::normalised(*cloud).half_step, 0);
  for (Vec3<double>& p : one_level.positions)
    if (random.uniform() < 0.2) p.z += 0x1p-10;
  const fit::NormalisedPoints two_levels = fit::normalised(one_level);
  EXPECT_EQ(two_levels.half_step * two_levels.scale, 0x1p-11);
}

// Of a tilted plane in coarse steps, half of the points lie on one plane of the lattice to all digits: that
// was the plane, known to 1e-13 degrees, and some degrees off.
TEST(SteppedPlanes, TiltedOnesAreNotOnePlaneOfTheLattice) {
  PortableRandom random(257);
  std::cout << "seed 257\n";
  PointFitOptions options;
  options.surface = "plane";
  for (const double step : {1.0, 0.05, 0.0625})
    for (const double noise : {0.05, 0.3})
      for (int repeat = 0; repeat < 4; ++repeat) {
        const Eigen::Matrix3d turn = random.rotation();
        PointCloud cloud;
        for (int i = 0; i < 1000; ++i) {
          const Eigen::Vector3d p = turn * Eigen::Vector3d(random.uniform(-10, 10), random.uniform(-6, 6),
                                                           noise * random.normals().x());
          cloud.positions.push_back(
              {step * std::round(p.x()), step * std::round(p.y()), step * std::round(p.z())});
        }
        const PointFit fit = fit_points(cloud, options);
        ASSERT_TRUE(fit.usable) << fit.reason;
        const double cosine = std::fabs(fit.surface->placement.linear().col(2).dot(turn.col(2)));
        // The standard error about the long axis is hypot(0.29, noise) / (6 / sqrt(3) sqrt(1000)), 0.22
        // degrees.
        EXPECT_LT(std::acos(std::fmin(cosine, 1)) * 180 / M_PI, 1) << step << ' ' << noise << ' ' << repeat;
        EXPECT_GT(fit.inliers, 900u);
      }
}

// Exact points of a plane of the lattice, among scattered ones, stay exact.
TEST(SteppedPlanes, ExactOnesAreExact) {
  PortableRandom random(258);
  std::cout << "seed 258\n";
  PointCloud cloud;
  const auto whole = [&] { return std::floor(random.uniform(-20, 21)); };
  for (int i = 0; i < 400; ++i) {
    const double x = whole(), y = whole();
    cloud.positions.push_back({x, y, i < 300 ? -x - y : whole()});
  }
  PointFitOptions options;
  options.surface = "plane";
  const PointFit fit = fit_points(cloud, options);
  ASSERT_TRUE(fit.usable) << fit.reason;
  EXPECT_LT(fit.sigma, 1e-9);
}

}  // namespace
}  // namespace darboux::stepped_planes_test
