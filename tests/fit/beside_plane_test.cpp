// A kind that is asked for, on the ground: a surface of that kind that is nearly a plane explains as many
// points.
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include <darboux/fit_points.h>

#include "synthetic_points.h"

namespace darboux::beside_plane_test {
namespace {

constexpr double noise = 0.01;

// On a sphere, a cylinder or a cone of radius 1, or a torus of radii 1 and 0.4, that stand on z = 0.
Eigen::Vector3d on(const std::string& kind, PortableRandom& random) {
  const double u = 2 * std::numbers::pi * random.uniform(), z = random.uniform();
  const Eigen::Vector3d out(std::cos(u), std::sin(u), 0);
  if (kind == "cylinder") return out + Eigen::Vector3d(0, 0, 3 * z);
  if (kind == "cone") return (1 - 0.8 * z) * out + Eigen::Vector3d(0, 0, 2 * z);
  if (kind == "sphere") return std::sqrt(4 * z * (1 - z)) * out + Eigen::Vector3d(0, 0, 2 * z);
  double v = 0;
  do v = 2 * std::numbers::pi * random.uniform();
  while (1.4 * random.uniform() > 1 + 0.4 * std::cos(v));
  return (1 + 0.4 * std::cos(v)) * out + Eigen::Vector3d(0, 0, 0.4 + 0.4 * std::sin(v));
}

PointCloud on_the_ground(const std::string& kind, int count, int of_ground, PortableRandom& random) {
  const Eigen::Matrix3d turn = random.rotation();
  PointCloud cloud;
  for (int i = 0; i < count + of_ground; ++i) {
    const Eigen::Vector3d p =
        i < count ? on(kind, random) : Eigen::Vector3d(random.uniform(-3, 3), random.uniform(-3, 3), 0);
    cloud.positions.push_back(from_eigen(turn * p + noise * random.normals()));
  }
  return cloud;
}

// All were refused, for "a radius known to 37 % only".
TEST(BesidePlane, NamedKindsAreFoundOnTheGround) {
  PortableRandom random(256);
  std::cout << "seed 256\n";
  for (const std::string kind : {"sphere", "cylinder", "cone", "torus"})
    for (int repeat = 0; repeat < 4; ++repeat) {
      PointFitOptions options;
      options.surface = kind;
      const PointFit fit = fit_points(on_the_ground(kind, 1000, 1100, random), options);
      ASSERT_TRUE(fit.usable) << kind << ": " << fit.reason;
      EXPECT_NE(fit.reason.find("; excluded: "), std::string::npos) << kind << ": " << fit.reason;
      // An eighth of the torus is within three times the noise of the ground.
      EXPECT_GT(fit.inliers, 840U) << kind;
      EXPECT_LT(fit.inliers, 1060U) << kind;
      EXPECT_EQ(fit.inliers + fit.outliers, 2100U);
      if (kind == "cone") {
        const AnySurface& cone = fit.surface->surface;
        EXPECT_NEAR(parameter_of(cone, "radius") / parameter_of(cone, "height"), 0.4, 0.005);
        continue;
      }
      const double truth = 1,
                   radius = parameter_of(fit.surface->surface, kind == "torus" ? "major_radius" : "radius");
      EXPECT_NEAR(radius, truth, 0.005) << kind;
    }
}

// Of a dome and its floor a sphere of some ninety times the radius was found, known to 18 %, and called
// usable. Points of the floor near the rim make the radius too large by a third of the noise.
TEST(BesidePlane, DomesAreFoundOnTheirFloor) {
  PortableRandom random(259);
  std::cout << "seed 259\n";
  for (const double sigma : {0.01, 0.03})
    for (int repeat = 0; repeat < 3; ++repeat) {
      const Eigen::Matrix3d turn = random.rotation();
      PointCloud cloud;
      for (int i = 0; i < 2500; ++i) {
        const double u = 2 * std::numbers::pi * random.uniform(), z = random.uniform(),
                     r = std::sqrt(1 - z * z);
        Eigen::Vector3d p(r * std::cos(u), r * std::sin(u), z);
        if (i >= 1000) p = {random.uniform(-2.5, 2.5), random.uniform(-2.5, 2.5), 0};
        cloud.positions.push_back(from_eigen(turn * p + sigma * random.normals()));
      }
      PointFitOptions options;
      options.surface = "sphere";
      const PointFit fit = fit_points(cloud, options);
      ASSERT_TRUE(fit.usable) << fit.reason;
      EXPECT_NE(fit.reason.find("; excluded: "), std::string::npos) << fit.reason;
      EXPECT_NEAR(parameter_of(fit.surface->surface, "radius"), 1, 0.67 * sigma) << sigma;
    }
}

// A box on the ground is no sphere and no ellipsoid, though these hold most of its points with more noise;
// and a few points of a sphere among scattered ones are none.
TEST(BesidePlane, OtherThingsOnTheGroundAreRefused) {
  PortableRandom random(258);
  std::cout << "seed 258\n";
  for (int repeat = 0; repeat < 3; ++repeat) {
    PointCloud box, few = on_the_ground("sphere", 200, 1000, random);
    const Eigen::Matrix3d turn = random.rotation();
    for (int i = 0; i < 1100; ++i) {
      Eigen::Vector3d p(random.uniform(-3, 3), random.uniform(-3, 3), 0);
      if (i < 500) {  // on its walls and its top
        p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 2)};
        if (i % 5 == 4)
          p.z() = 2;
        else
          p[i % 2] = i % 4 < 2 ? -1 : 1;
      }
      box.positions.push_back(from_eigen(turn * p + noise * random.normals()));
    }
    for (int i = 0; i < 300; ++i)
      few.positions.push_back({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)});
    PointFitOptions options;
    for (const char* kind : {"sphere", "ellipsoid", "cylinder"}) {
      options.surface = kind;
      const PointFit fit = fit_points(box, options);
      EXPECT_FALSE(fit.usable) << kind << ": " << fit.reason << ", sigma " << fit.sigma;
    }
    options.surface = "sphere";
    EXPECT_FALSE(fit_points(few, options).usable);
  }
}

// Where the plane is all there is, its points stay with the kind that was asked for, which is not known.
TEST(BesidePlane, PlaneAloneIsNoSphere) {
  PortableRandom random(257);
  std::cout << "seed 257\n";
  for (int repeat = 0; repeat < 4; ++repeat)
    for (const int scattered : {0, 300}) {
      PointCloud cloud = on_the_ground("sphere", 0, 1000, random);
      for (int i = 0; i < scattered; ++i)
        cloud.positions.push_back({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)});
      PointFitOptions options;
      options.surface = "sphere";
      EXPECT_FALSE(fit_points(cloud, options).usable) << scattered;
    }
}

}  // namespace
}  // namespace darboux::beside_plane_test
