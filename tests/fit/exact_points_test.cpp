// Points without noise, but for the digits of a file, among outliers.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include <darboux/fit_points.h>

#include "synthetic_points.h"

namespace darboux {
namespace {

// Of numbers in so many digits small ones err less: larger ones were outliers, or the fit did not converge.
TEST(ExactPoints, DigitsOfDoublesAreNoOutliers) {
  Random random(247);
  std::cout << "seed 247\n";
  for (const char* format : {"%.9g", "%.10g", "%.12g", "%.9f", "%.12f"})
    for (int repeat = 0; repeat < 5; ++repeat) {
      const Eigen::Vector3d axes(2, 1, random.uniform(0.3, 0.5));
      const Eigen::Matrix3d turn = random.rotation();
      const double scale = std::pow(10, random.uniform(-1, 2));
      PointCloud cloud;
      for (int i = 0; i < 600; ++i) {
        const double u = 2.2 * random.uniform(), z = random.uniform(-1, 1), r = std::sqrt(1 - z * z);
        Eigen::Vector3d x = axes.cwiseProduct(Eigen::Vector3d(r * std::cos(u), r * std::sin(u), z));
        if (i % 10 == 0)
          for (double& c : x) c = random.uniform(-1.5, 1.5);
        x = scale * (turn * x);
        char text[64];
        for (double& c : x) std::snprintf(text, sizeof text, format, c), c = std::strtod(text, nullptr);
        cloud.positions.push_back(from_eigen(x));
      }
      const PointFit fit = fit_points(cloud);
      SCOPED_TRACE(std::string(format) + ", repeat " + std::to_string(repeat));
      ASSERT_TRUE(fit.usable) << fit.reason;
      ASSERT_EQ(fit.surface->surface.info().name, "ellipsoid");
      EXPECT_GE(fit.inliers, 530U);
      const std::vector<ParameterValue> found = fit.surface->surface.parameters();
      for (Eigen::Index k = 0; k < 3; ++k)  // in falling order
        EXPECT_NEAR(found[static_cast<std::size_t>(k)].value, scale * axes[k],
                    5 * fit.standard_errors[static_cast<std::size_t>(k)].value);
    }
}

// Searches of other kinds end nearer to points that are exact: a sphere that is not refined was an ellipsoid.
TEST(ExactPoints, ExactSpheresAmongOutliersAreNoEllipsoids) {
  Random random(248);
  std::cout << "seed 248\n";
  for (int repeat = 0; repeat < 12; ++repeat) {
    const double scale = std::pow(10, random.uniform(-3, 3)), top = random.uniform(0.6, 2);
    const Eigen::Matrix3d turn = random.rotation();
    PointCloud cloud;
    for (int i = 0; i < 2000; ++i) {
      const double u = 2.2 * random.uniform(), z = 1 - top * random.uniform(), r = std::sqrt(1 - z * z);
      Eigen::Vector3d x(r * std::cos(u), r * std::sin(u), z);
      if (i % 10 == 0)
        for (double& c : x) c = random.uniform(-1.5, 1.5);
      cloud.positions.push_back(from_eigen(scale * (turn * x)));
    }
    const PointFit fit = fit_points(cloud);
    ASSERT_TRUE(fit.usable) << fit.reason << ", repeat " << repeat;
    EXPECT_EQ(fit.surface->surface.info().name, "sphere") << repeat;
  }
}

}  // namespace
}  // namespace darboux
