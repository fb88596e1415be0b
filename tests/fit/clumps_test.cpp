// Points of a surface beside a clump of others, as clutter is.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/fit_points.h>

#include "fit/primitives/clump.h"
#include "fit_matrix.h"

namespace darboux::clumps_test {
namespace {

Eigen::Matrix3Xd matrix_of(const PointCloud& cloud) {
  Eigen::Matrix3Xd points(3, cloud.positions.size());
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = to_eigen(cloud.positions[i]);
  return points;
}

matrix::Cell cell_named(const std::string& key) {
  for (const matrix::Cell& cell : matrix::cells())
    if (cell.key() == key) return cell;
  throw std::runtime_error("no cell " + key);
}

// Of all kinds, beside a full surface: which points are of the clump. A surface may pass through it.
TEST(Clumps, AreFound) {
  for (const std::string_view kind : matrix::kinds)
    for (const char* points : {"50", "1000"})
      for (const char* share : {"30%", "50%"}) {
        const matrix::Cell cell =
            cell_named(std::string(kind) + "/full/" + points + "/" + share + " cluster/1e-2");
        SCOPED_TRACE(cell.key());
        int found = 0;
        constexpr int runs = 6;
        for (std::uint64_t run = 0; run < runs; ++run) {
          const SyntheticPoints made = matrix::points_of(cell, run);
          const std::vector<bool> clump = fit::dense_clump(matrix_of(made.cloud));
          if (clump.empty()) continue;
          std::size_t wrong = 0;
          for (std::size_t i = 0; i < clump.size(); ++i) wrong += clump[i] == made.is_inlier[i];
          found += 10 * wrong <= clump.size();
        }
        EXPECT_GE(found, runs - 1);
      }
}

// A surface alone has none, nor has one among scattered outliers, however small a patch or thin a strip it
// is.
TEST(Clumps, AreNoSurfaces) {
  int some = 0, all = 0;
  for (const matrix::Cell& cell : matrix::cells()) {
    const matrix::Outliers& o = matrix::outliers[cell.outliers];
    if (matrix::counts[cell.count] != 1000 || (o.share > 0 && o.pattern != OutlierPattern::scattered))
      continue;
    for (std::uint64_t run = 0; run < 2; ++run) {
      const bool has = !fit::dense_clump(matrix_of(matrix::points_of(cell, run).cloud)).empty();
      some += has, ++all;
      EXPECT_FALSE(has && o.share == 0) << cell.key();
    }
  }
  // Wide noise makes a small patch round.
  EXPECT_LE(20 * some, all);
}

// What a clump of half of the points hid: the scale is the median distance, of which it is most.
TEST(Clumps, BesideASurfaceAreLeftOut) {
  for (const std::string_view kind : matrix::kinds) {
    const matrix::Cell cell = cell_named(std::string(kind) + "/full/1000/50% cluster/3e-2");
    SCOPED_TRACE(cell.key());
    int right = 0, usable = 0;
    for (std::uint64_t run = 0; run < 4; ++run) {
      const matrix::Run found = matrix::run_of(cell, run);
      usable += found.usable;
      right += found.found == kind;
      EXPECT_TRUE(found.found.empty() || found.found == kind) << run << ": " << found.found;
      // A chi squared of the plane's 3 degrees of freedom over them is above 8 once in forty thousand, of
      // more less often.
      EXPECT_LT(found.mahalanobis, 8) << run;
    }
    EXPECT_GE(usable, 3);
    EXPECT_GE(right, 3);
  }
}

// Half of a sphere's points in a dense ball about one of its own: they are of it, and count.
TEST(Clumps, OnASurfaceAreOfIt) {
  std::mt19937_64 random(20261127);
  std::normal_distribution<double> normal(0, 1);
  constexpr double radius = 2, sigma = 0.1;
  PointCloud cloud;
  for (int i = 0; i < 600; ++i) {
    Eigen::Vector3d direction(normal(random), normal(random), normal(random));
    if (i % 2 == 1) direction = Eigen::Vector3d(0.12 * direction.x(), 0.12 * direction.y(), 1);
    cloud.positions.push_back(from_eigen((radius + sigma * normal(random)) * direction.normalized()));
  }
  ASSERT_FALSE(fit::dense_clump(matrix_of(cloud)).empty());
  const PointFit fit = fit_points(cloud, {.surface = "sphere"});
  ASSERT_TRUE(fit.usable) << fit.reason;
  EXPECT_GE(fit.inliers, 580U);
  EXPECT_EQ(fit.reason.find("clump"), std::string::npos) << fit.reason;
  EXPECT_NEAR(fit.surface->surface.parameters()[0].value, radius, 5 * sigma / std::sqrt(600.));
}

// A small sphere of most of the points beside a plane is as dense as a clump, but hollow: it is the surface.
TEST(Clumps, SmallSurfacesAreSurfaces) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> anywhere(-2, 2);
  PointCloud cloud;
  constexpr double radius = 0.3, sigma = 0.005;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    const double r = radius + sigma * normal(random);
    cloud.positions.push_back(i % 20 < 11
                                  ? from_eigen(r * direction + Eigen::Vector3d(0.5, 0, 1))
                                  : Vec3<double>{anywhere(random), anywhere(random), sigma * normal(random)});
  }
  ASSERT_FALSE(fit::dense_clump(matrix_of(cloud)).empty());
  for (const char* kind : {"auto", "sphere"}) {
    const PointFit fit = fit_points(cloud, {.surface = kind});
    ASSERT_TRUE(fit.usable) << fit.reason;
    EXPECT_EQ(fit.surface->surface.info().name, "sphere") << fit.reason;
    EXPECT_NEAR(fit.surface->surface.parameters()[0].value, radius, 0.01);
  }
}

// A cap of a sphere, and a spot of it far away that was measured often: the spot is as wide as the noise.
TEST(Clumps, ASpotFarAwayIsOfTheSurface) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> height(0.75, 1), turn(0, 2 * std::numbers::pi);
  PointCloud cloud;
  constexpr double sigma = 0.02;
  for (int i = 0; i < 600; ++i) {
    const double z = height(random), a = turn(random), r = std::sqrt(1 - z * z);
    Eigen::Vector3d p =
        i % 2 == 0 ? Eigen::Vector3d(r * std::cos(a), r * std::sin(a), z) : Eigen::Vector3d(0, 0, -1);
    p += sigma * Eigen::Vector3d(normal(random), normal(random), normal(random));
    cloud.positions.push_back(from_eigen(p));
  }
  const PointFit fit = fit_points(cloud, {.surface = "sphere"});
  ASSERT_TRUE(fit.usable) << fit.reason;
  EXPECT_GE(fit.inliers, 580U) << fit.reason;
  EXPECT_NEAR(fit.surface->surface.parameters()[0].value, 1, 5 * sigma / std::sqrt(300.));
}

// Points at the ends of the range of numbers, which have no size.
TEST(Clumps, OfPointsWithoutASizeAreNotLookedFor) {
  PointCloud cloud;
  for (int i = 0; i < 40; ++i)
    cloud.positions.push_back({i % 2 == 0 ? 1.7e308 : -1.7e308, 1e300 * i, 1.6e308 * (i % 3 - 1)});
  const PointFit fit = fit_points(cloud, {.surface = "sphere"});
  EXPECT_FALSE(fit.usable);
  EXPECT_FALSE(fit.reason.empty());
}

// Every point is counted once, each inlier is one of the others, and the share done never falls.
TEST(Clumps, ArePointsOfTheInput) {
  const SyntheticPoints made = matrix::points_of(cell_named("torus/full/1000/30% cluster/1e-2"), 0);
  PointCloud cloud = made.cloud;
  cloud.positions.insert(cloud.positions.begin() + 10, Vec3<double>{std::nan(""), 0, 0});
  double done = 0;
  const PointFit fit = fit_points(cloud, {.progress = [&](double share) {
                                    EXPECT_GE(share, done);
                                    done = share;
                                  }});
  EXPECT_EQ(done, 1);
  ASSERT_TRUE(fit.usable) << fit.reason;
  EXPECT_NE(fit.reason.find("clump"), std::string::npos) << fit.reason;
  EXPECT_EQ(fit.ignored, 1U);
  EXPECT_EQ(fit.inliers + fit.outliers, made.cloud.positions.size());
  ASSERT_EQ(fit.is_inlier.size(), cloud.positions.size());
  EXPECT_FALSE(fit.is_inlier[10]);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < made.is_inlier.size(); ++i)
    wrong += fit.is_inlier[i < 10 ? i : i + 1] != made.is_inlier[i];
  EXPECT_LE(wrong, 30U);
}

}  // namespace
}  // namespace darboux::clumps_test
