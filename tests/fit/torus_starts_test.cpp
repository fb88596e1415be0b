// Where tori are looked for among outliers: by circles through three points and those around them.
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fit/primitives/list.h"

namespace darboux::fit::torus_starts_test {
namespace {

// Half on a torus of radii 1 and 0.2, half anywhere about it.
Eigen::Matrix3Xd points_of(Eigen::Index n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> anywhere(-1, 1);
  Eigen::Matrix3Xd points(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = std::numbers::pi * anywhere(random), v = std::numbers::pi * anywhere(random);
    const double ring = 1 + 0.2 * std::cos(v);
    points.col(i) << ring * std::cos(u), ring * std::sin(u), 0.2 * std::sin(v);
    if (i % 2 == 1) points.col(i) << anywhere(random), anywhere(random), anywhere(random);
  }
  return points;
}

// The three points that a circle is laid through are no tube: of few points they were.
TEST(TorusStarts, HaveATube) {
  std::mt19937_64 random(20261127);
  for (const Eigen::Index n : {8, 12, 20, 40, 200, 600}) {
    SCOPED_TRACE(std::to_string(n) + " points");
    const std::vector<GeometricParameters> tori =
        torus_primitive.starts_among_outliers(points_of(n, random), random);
    bool found = false;
    for (const GeometricParameters& torus : tori) {
      EXPECT_TRUE(torus.centre.allFinite() && torus.axes.allFinite());
      EXPECT_GT(torus.lengths[1], 1e-6);
      found = found || (torus.centre.norm() < 0.1 && std::fabs(torus.axes(2, 2)) > 0.99 &&
                        std::fabs(torus.lengths[0] - 1) < 0.1 && std::fabs(torus.lengths[1] - 0.2) < 0.06);
    }
    EXPECT_TRUE(found || n < 200);
  }
}

TEST(TorusStarts, OfNoCircleAreNone) {
  std::mt19937_64 random(1);
  Eigen::Matrix3Xd line(3, 60);
  for (Eigen::Index i = 0; i < line.cols(); ++i) line.col(i) << static_cast<double>(i), 0, 0;
  EXPECT_TRUE(torus_primitive.starts_among_outliers(line, random).empty());
  EXPECT_TRUE(torus_primitive.starts_among_outliers(Eigen::Matrix3Xd::Ones(3, 60), random).empty());
}

}  // namespace
}  // namespace darboux::fit::torus_starts_test
