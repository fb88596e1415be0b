// Points without noise, but for the digits of a file, among outliers.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include <darboux/fit_points.h>

#include "fit/common/normalised_points.h"
#include "synthetic_points.h"

namespace darboux::exact_points_test {
namespace {

// As a file has it; null: the double itself.
double written(double x, const char* format) {
  if (!format) return x;
  char text[64];
  std::snprintf(text, sizeof text, format, x);
  return std::strtod(text, nullptr);
}
// Half a unit of the last place of a number up to `largest`.
double error_of(const std::string& format, double largest) {
  const int digits = std::stoi(format.substr(2));
  return 0.5 * std::pow(10, format.back() == 'f' ? -digits : std::floor(std::log10(largest)) - digits + 1);
}

// Of points at random places, uvs too, which are no grid's, although the few small ones have most decimals.
TEST(ExactPoints, DigitsAreTold) {
  std::cout << "seeds 0 to 9\n";
  for (const char* format : {"%.6g", "%.7g", "%.10g", "%.12g", "%.3f", "%.9f", "%.12f"})
    for (const std::size_t n : {40, 400, 2000})
      for (std::uint64_t seed = 0; seed < 10; ++seed) {
        PortableRandom random(seed);
        PointCloud cloud;
        double largest = 0;
        for (std::size_t i = 0; i < n; ++i) {
          Vec3<double> p{random.uniform(-20, 30), random.uniform(-20, 30), random.uniform(-20, 30)};
          for (double* c : {&p.x, &p.y, &p.z})
            *c = written(*c, format), largest = std::fmax(largest, std::fabs(*c));
          cloud.positions.push_back(p);
          cloud.uvs.push_back({written(random.uniform(), format), written(random.uniform(), format)});
        }
        const fit::NormalisedPoints points = fit::normalised(cloud, true);
        SCOPED_TRACE(std::string(format) + ", seed " + std::to_string(seed) + ", " + std::to_string(n));
        EXPECT_NEAR(2 * points.roundings[0] * points.scale, error_of(format, largest),
                    1e-9 * error_of(format, largest));
        EXPECT_GE(2 * points.uv_roundings[0], error_of(format, 0.99) * (1 - 1e-9));
      }
}
TEST(ExactPoints, DoublesHaveNoDigits) {
  std::cout << "seed 249\n";
  PortableRandom random(249);
  for (const double far : {0.0, 1.0, 1000.0, 1e4, 1e6}) {
    PointCloud cloud;
    for (int i = 0; i < 200; ++i)
      cloud.positions.push_back(from_eigen(random.normals().normalized() + Eigen::Vector3d(2, 3, 4) * far));
    EXPECT_EQ(fit::normalised(cloud).roundings[0], 0) << far;
  }
}

// Of numbers in so many digits small ones err less: larger ones were outliers, or the fit did not converge.
TEST(ExactPoints, DigitsOfDoublesAreNoOutliers) {
  PortableRandom random(247);
  std::cout << "seed 247\n";
  for (const char* format : {"%.9g", "%.10g", "%.12g", "%.9f", "%.12f"})
    for (int repeat = 0; repeat < 5; ++repeat) {
      const Eigen::Vector3d axes(2, 1, random.uniform(0.3, 0.5));
      const Eigen::Matrix3d turn = random.rotation();
      const double scale = std::pow(10, random.uniform(-1, 2));
      double largest = 0;
      PointCloud cloud;
      for (int i = 0; i < 600; ++i) {
        const double u = 2.2 * random.uniform(), z = random.uniform(-1, 1), r = std::sqrt(1 - z * z);
        Eigen::Vector3d x = axes.cwiseProduct(Eigen::Vector3d(r * std::cos(u), r * std::sin(u), z));
        if (i % 10 == 0)
          for (double& c : x) c = random.uniform(-1.5, 1.5);
        x = scale * (turn * x);
        for (double& c : x) c = written(c, format), largest = std::fmax(largest, std::fabs(c));
        cloud.positions.push_back(from_eigen(x));
      }
      const PointFit fit = fit_points(cloud);
      SCOPED_TRACE(std::string(format) + ", repeat " + std::to_string(repeat));
      ASSERT_TRUE(fit.usable) << fit.reason;
      ASSERT_EQ(fit.surface->surface.info().name, "ellipsoid");
      EXPECT_GE(fit.inliers, 530U);
      const std::vector<ParameterValue> found = fit.surface->surface.parameters();
      for (Eigen::Index k = 0; k < 3; ++k) {  // in falling order
        const double error = fit.standard_errors[static_cast<std::size_t>(k)].value;
        EXPECT_NEAR(found[static_cast<std::size_t>(k)].value, scale * axes[k], 5 * error);
        EXPECT_LE(error, 60 * error_of(format, largest));
      }
    }
}

// Searches of other kinds end nearer to points that are exact: a sphere that is not refined was an ellipsoid.
TEST(ExactPoints, ExactSpheresAmongOutliersAreNoEllipsoids) {
  PortableRandom random(248);
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
      x = scale * (turn * x);
      for (double& c : x)
        c = written(c, std::array{static_cast<const char*>(nullptr), "%.12g", "%.9g"}[repeat % 3]);
      cloud.positions.push_back(from_eigen(x));
    }
    const PointFit fit = fit_points(cloud);
    ASSERT_TRUE(fit.usable) << fit.reason << ", repeat " << repeat;
    EXPECT_EQ(fit.surface->surface.info().name, "sphere") << repeat;
  }
}

}  // namespace
}  // namespace darboux::exact_points_test
