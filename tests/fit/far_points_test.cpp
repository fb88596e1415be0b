// Points far from the origin are judged as they are near it, unless floats hold them.
#include <cmath>
#include <iostream>
#include <numbers>

#include <gtest/gtest.h>

#include <darboux/fit_points.h>

#include "fit/common/normalised_points.h"
#include "synthetic_points.h"

namespace darboux::far_points_test {
namespace {

const Eigen::Vector3d on_a_map(450000, 5100000, 200);

PointCloud moved(const PointCloud& cloud, const Eigen::Vector3d& by) {
  PointCloud result = cloud;
  for (Vec3<double>& p : result.positions) p = from_eigen(to_eigen(p) + by);
  return result;
}

template <class Store>
PointCloud stored(const PointCloud& cloud, Store&& store) {
  PointCloud result = cloud;
  for (Vec3<double>& p : result.positions) p = {store(p.x), store(p.y), store(p.z)};
  return result;
}

// A cabinet of 1 m was an ellipsoid with noise of 6 cm, as floats would have such roundings on a map.
TEST(FarPoints, ABoxIsNoEllipsoidAnywhere) {
  PortableRandom random(251);
  std::cout << "seed 251\n";
  for (int repeat = 0; repeat < 4; ++repeat) {
    const Eigen::Matrix3d turn = random.rotation();
    PointCloud box;
    for (int i = 0; i < 900; ++i) {
      Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      p[static_cast<Eigen::Index>(random.below(3))] = random.uniform() < 0.5 ? -1 : 1;
      box.positions.push_back(
          from_eigen(turn * p.cwiseProduct(Eigen::Vector3d(0.5, 0.4, 0.3)) + 0.002 * random.normals()));
    }
    const auto millimetres = [](double x) { return std::round(1e3 * x) / 1e3; };
    for (const PointCloud& cloud : {box, moved(box, on_a_map), stored(moved(box, on_a_map), millimetres)}) {
      const PointFit fit = fit_points(cloud);
      EXPECT_FALSE(fit.usable) << repeat << ": " << fit.surface->surface.specification();
    }
  }
}

TEST(FarPoints, TwoSidesOfAWallAreNoOneSurfaceAnywhere) {
  PortableRandom random(252);
  std::cout << "seed 252\n";
  PointCloud walls;
  for (int i = 0; i < 900; ++i) {
    const double u = 2 * std::numbers::pi * random.uniform(), radius = i < 500 ? 6 : 5.5;
    walls.positions.push_back(
        from_eigen(Eigen::Vector3d(radius * std::cos(u), radius * std::sin(u), random.uniform(-20, 20)) +
                   0.012 * random.normals()));
  }
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3e6, 4e6, 0)})
    EXPECT_NE(fit_points(moved(walls, by)).reason.find("two sides of a wall"), std::string::npos) << by;
}

// Whole numbers, halves and decimals are floats too where these have as many bits, by chance.
TEST(FarPoints, OnlyFloatsAreFloats) {
  PortableRandom random(253);
  std::cout << "seed 253\n";
  PointCloud cloud;
  for (int i = 0; i < 200; ++i)
    cloud.positions.push_back(from_eigen(20 * random.normals().normalized() + Eigen::Vector3d(9e5, 1e6, 50)));
  const auto as_float = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  const auto relative = [](const PointCloud& points) {
    const fit::NormalisedPoints normal = fit::normalised(points);
    return normal.stored_rounding() * normal.scale / to_eigen(points.positions.front()).norm();
  };
  EXPECT_GE(relative(stored(cloud, as_float)), 0x1p-22 * 0.99);
  const auto nine_digits = [&](double x) {
    const double unit = std::pow(10, std::floor(std::log10(std::fabs(x))) - 8);
    return std::round(as_float(x) / unit) * unit;
  };
  EXPECT_GE(relative(stored(cloud, nine_digits)), 0x1p-22 * 0.99);
  constexpr double six_decimals = 1e-5 * 32 / 1e6;  // of the size: a power of two
  EXPECT_LE(relative(cloud), six_decimals);
  EXPECT_LE(relative(stored(cloud, [](double x) { return std::round(x); })), six_decimals);
  EXPECT_LE(relative(stored(cloud, [](double x) { return std::round(2 * x) / 2; })), six_decimals);
}

}  // namespace
}  // namespace darboux::far_points_test
