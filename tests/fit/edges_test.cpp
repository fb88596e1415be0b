// The edge of what was measured: where points get sparse, where a surface is joined by another, and where a
// patch is too small to tell a cylinder from a long paraboloid.
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <darboux/fit_points.h>

#include "synthetic_points.h"

namespace darboux::edges_test {
namespace {

PointFit fit_named(const PointCloud& cloud, const std::string& kind) {
  PointFitOptions options;
  options.surface = kind;
  return fit_points(cloud, options);
}

double radius_of(const PointFit& fit) {
  return parameter_of(fit.surface->surface, "radius");
}

double stated_error_of_radius(const PointFit& fit) {
  for (const StandardError& e : fit.standard_errors)
    if (e.name == "radius") return e.value;
  return 0;
}

bool names_the_edge(const PointFit& fit) {
  return fit.reason.find("without the points at its edge the radius is") != std::string::npos;
}

// Densities of 4 (1 - x)^3 and 3 (1 - y)^2 over two coordinates. The support was the dense part: standard
// errors were 1.7 to 3.4 times those of least squares of all points, which have no outlier.
TEST(Edges, SparsePointsCount) {
  PortableRandom random(270);
  std::cout << "seed 270\n";
  constexpr double sigma = 0.01;
  for (const std::string kind : {"sphere", "cylinder"})
    for (int repeat = 0; repeat < 5; ++repeat) {
      const Eigen::Matrix3d turn = random.rotation();
      PointCloud cloud;
      const int unknowns = kind == "sphere" ? 4 : 5;
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
      for (int i = 0; i < 400; ++i) {
        const double u = 2 * std::numbers::pi * (1 - std::pow(1 - random.uniform(), 1.0 / 4)),
                     z = 2 * (1 - std::pow(1 - random.uniform(), 1.0 / 3)) - 1,
                     r = kind == "sphere" ? std::sqrt(1 - z * z) : 1;
        const Eigen::Vector3d p(r * std::cos(u), r * std::sin(u), z);
        cloud.positions.push_back(from_eigen(turn * p + sigma * random.normals()));
        Eigen::VectorXd row(unknowns);  // derivatives of the distance: of the radius, then of place and axis
        if (kind == "sphere")
          row << 1, p;
        else
          row << 1, p.x(), p.y(), z * p.x(), z * p.y();
        normal += row * row.transpose();
      }
      const double least = sigma * std::sqrt(normal.inverse()(0, 0));
      const PointFit fit = fit_named(cloud, kind);
      ASSERT_TRUE(fit.usable) << kind << ": " << fit.reason;
      const double stated = stated_error_of_radius(fit);
      EXPECT_LT(stated, 1.25 * least) << kind;
      EXPECT_LT(std::fabs(radius_of(fit) - 1), 4 * stated) << kind;
      EXPECT_FALSE(names_the_edge(fit)) << kind << ": " << fit.reason;
    }
}

// A quarter of a cylinder between the planes that are tangent to it: those of their points that are near pull
// at its radius, by up to ten of its standard errors.
TEST(Edges, PlanesBesideAFilletAreNamed) {
  PortableRandom random(271);
  std::cout << "seed 271\n";
  int spoken_of = 0;
  for (int repeat = 0; repeat < 6; ++repeat) {
    const Eigen::Matrix3d turn = random.rotation();
    PointCloud fillet, cylinder;
    for (int i = 0; i < 1400; ++i) {
      const double z = random.uniform(-10, 10), length = random.uniform();
      const double u = 0.5 * std::numbers::pi * length;
      const Eigen::Vector3d noise = 0.01 * random.normals(), on(std::cos(u), std::sin(u), z);
      const Eigen::Vector3d beside =
          i % 2 == 0 ? Eigen::Vector3d(1, -0.7 * length, z) : Eigen::Vector3d(-0.7 * length, 1, z);
      cylinder.positions.push_back(from_eigen(turn * on + noise));
      fillet.positions.push_back(from_eigen(turn * (i < 1000 ? on : beside) + noise));
    }
    const PointFit of_fillet = fit_named(fillet, "cylinder");
    std::cout << of_fillet.reason << '\n';
    spoken_of += names_the_edge(of_fillet) || !of_fillet.usable ||
                 of_fillet.reason.find("correlated") != std::string::npos;
    if (of_fillet.reason == "converged") {
      EXPECT_LT(std::fabs(radius_of(of_fillet) - 1), 5 * stated_error_of_radius(of_fillet));
    }
    const PointFit of_cylinder = fit_named(cylinder, "cylinder");
    ASSERT_TRUE(of_cylinder.usable) << of_cylinder.reason;
    EXPECT_FALSE(names_the_edge(of_cylinder)) << of_cylinder.reason;
  }
  EXPECT_GE(spoken_of, 4);
}

// The planes beside a fillet, sparser than it: where they are near, they lie within the noise and have no
// outliers beside them, but the fit of the fillet does not explain them.
TEST(Edges, SparsePlanesBesideAFilletDoNotCount) {
  PortableRandom random(275);
  std::cout << "seed 275\n";
  int off = 0;
  for (int repeat = 0; repeat < 10; ++repeat) {
    const Eigen::Matrix3d turn = random.rotation();
    PointCloud cloud;
    for (int i = 0; i < 2150; ++i) {
      const double z = random.uniform(-5, 5), x = random.uniform(), u = std::numbers::pi / 3 * x;
      Eigen::Vector3d p(std::cos(u), std::sin(u), z);
      if (i >= 2000 && i % 2 == 0) p = {1, -0.5 * x, z};
      if (i >= 2000 && i % 2 == 1)
        p = Eigen::Vector3d(0.5, std::sqrt(0.75), z) + 0.5 * x * Eigen::Vector3d(-std::sqrt(0.75), 0.5, 0);
      cloud.positions.push_back(from_eigen(turn * p + 0.02 * random.normals()));
    }
    const PointFit fit = fit_named(cloud, "cylinder");
    ASSERT_TRUE(fit.usable) << fit.reason;
    const double deviations = (radius_of(fit) - 1) / stated_error_of_radius(fit);
    std::cout << deviations << ": " << fit.reason << '\n';
    off += std::fabs(deviations) > 2;
  }
  EXPECT_LE(off, 3);  // of ten; all are if sparse points count unasked
}

// The caps of a can, at its rims: a radius seven standard errors too small was "converged".
TEST(Edges, CapsOfACanAreNamed) {
  PortableRandom random(272);
  std::cout << "seed 272\n";
  int named = 0;
  for (int repeat = 0; repeat < 4; ++repeat) {
    const Eigen::Matrix3d turn = random.rotation();
    PointCloud can;
    for (int i = 0; i < 3000; ++i) {
      const double u = random.uniform(0, 2 * std::numbers::pi), x = random.uniform();
      const double r = i < 1500 ? 1 : std::sqrt(x), z = i < 1500 ? x : i % 2;
      can.positions.push_back(
          from_eigen(turn * Eigen::Vector3d(r * std::cos(u), r * std::sin(u), z) + 0.02 * random.normals()));
    }
    const PointFit fit = fit_named(can, "cylinder");
    ASSERT_TRUE(fit.usable) << fit.reason;
    named += names_the_edge(fit);
    std::cout << radius_of(fit) << ": " << fit.reason << '\n';
  }
  EXPECT_GE(named, 3);
}

// Far from its vertex a paraboloid is a cylinder. Of 30 such patches 22 were "cylinder or
// elliptic-paraboloid".
TEST(Edges, ACylinderIsALimitOfParaboloids) {
  PortableRandom random(273);
  std::cout << "seed 273\n";
  int usable = 0, patches = 0;
  for (const double sigma : {2e-4, 6e-4, 2e-3})
    for (const int count : {300, 2000})
      for (int repeat = 0; repeat < 2; ++repeat) {
        const Eigen::Matrix3d turn = random.rotation();
        PointCloud cloud;
        for (int i = 0; i < count; ++i) {
          const double u = random.uniform(0, std::numbers::pi / 6), z = random.uniform(-1, 1);
          cloud.positions.push_back(
              from_eigen(turn * Eigen::Vector3d(std::cos(u), std::sin(u), z) + sigma * random.normals()));
        }
        const PointFit fit = fit_points(cloud);
        ++patches;
        if (!fit.usable) continue;
        ++usable;
        EXPECT_EQ(fit.surface->surface.info().name, "cylinder");
      }
  std::cout << usable << " of " << patches << " usable\n";
  EXPECT_GE(4 * usable, 3 * patches);
}

// With a tenth of the noise: "an ellipsoid did not converge".
TEST(Edges, NoiseThatCannotBeIsNamed) {
  PortableRandom random(274);
  std::cout << "seed 274\n";
  PointCloud cloud;
  for (int i = 0; i < 500; ++i)
    cloud.positions.push_back(from_eigen(random.normals().normalized() + 0.01 * random.normals()));
  for (const std::string kind : {"auto", "sphere"})
    for (const double noise : {1e-3, 3e-3, 0.01, 0.05, 1.0, 100.0}) {
      PointFitOptions options;
      if (kind != "auto") options.surface = kind;
      options.noise = noise;
      const PointFit fit = fit_points(cloud, options);
      EXPECT_EQ(fit.reason.find("may be too small: if it is estimated, a sphere with noise 0.0") !=
                    std::string::npos,
                noise < 0.01)
          << kind << ", " << noise << ": " << fit.reason;
      EXPECT_EQ(fit.reason.find("may be too large") != std::string::npos, noise > 0.01)
          << kind << ", " << noise << ": " << fit.reason;
      EXPECT_EQ(fit.usable && fit.inliers > 450, noise == 0.01 || noise == 0.05);
    }
}

}  // namespace
}  // namespace darboux::edges_test
