// What a surface is like about a point, and the tori that are like it.
#include "fit/primitives/osculation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fit/primitives/list.h"

namespace darboux::fit::osculation_test {
namespace {

// A random pose of a torus, and a point on it at the angle phi of the tube.
struct TorusPoint {
  GeometricParameters torus;
  Vector3d at, outward;
};

TorusPoint torus_point(double major, double minor, double phi, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
  TorusPoint p{{vector(),
                Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), vector()).toRotationMatrix(),
                {major, minor}},
               {},
               {}};
  const double u = 2 * std::numbers::pi * std::uniform_real_distribution<double>()(random);
  const Vector3d e = p.torus.axes * Vector3d(std::cos(u), std::sin(u), 0);
  p.outward = std::cos(phi) * e + std::sin(phi) * p.torus.axes.col(2);
  p.at = p.torus.centre + major * e + minor * p.outward;
  return p;
}

bool includes(const std::vector<GeometricParameters>& tori, const GeometricParameters& torus,
              double tolerance) {
  return std::any_of(tori.begin(), tori.end(), [&](const GeometricParameters& n) {
    return (n.centre - torus.centre).norm() < tolerance &&
           n.axes.col(2).cross(torus.axes.col(2)).norm() < tolerance &&
           std::fabs(n.lengths[0] - torus.lengths[0]) < tolerance &&
           std::fabs(n.lengths[1] - torus.lengths[1]) < tolerance;
  });
}

const Circle3 no_strip{Vector3d::Zero(), Vector3d::UnitZ(), 1, 1e300};

// Curvatures of a torus: 1 / r, and cos(phi) / (R + r cos(phi)). They are of differences over 1e-4.
TEST(Osculation, HasTheCurvatures) {
  constexpr std::uint64_t seed = 5;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (const double phi : {0., 0.7, 1.4, 2., 3.1, -1., -2.5}) {
    const TorusPoint p = torus_point(2, 0.6, phi, random);
    const auto o = osculation(torus_primitive, torus_primitive.localise(p.torus, p.at), p.at, no_strip);
    ASSERT_TRUE(o) << phi;
    EXPECT_LT((o->at - p.at).norm(), 1e-12);
    const double side = o->frame.col(2).dot(p.outward) > 0 ? -1 : 1;
    std::array<double, 2> expected{side / 0.6, side * std::cos(phi) / (2 + 0.6 * std::cos(phi))};
    std::sort(expected.begin(), expected.end());
    EXPECT_NEAR(o->curvatures[0], expected[0], 1e-3) << phi;
    EXPECT_NEAR(o->curvatures[1], expected[1], 1e-3) << phi;
  }
}

// A torus is among those that are like it, if its ratio of radii is one that is tried, or on its equators.
TEST(Osculation, LeadsBackToATorus) {
  constexpr std::uint64_t seed = 6;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  const auto expect = [&](double ratio, double phi) {
    const TorusPoint p = torus_point(0.6 * ratio, 0.6, phi, random);
    const auto o = osculation(torus_primitive, torus_primitive.localise(p.torus, p.at), p.at, no_strip);
    ASSERT_TRUE(o);
    EXPECT_TRUE(includes(torus_primitive.osculating(*o), p.torus, 0.02)) << ratio << ' ' << phi;
  };
  for (const double ratio : {1.2, 2., 3.5, 6.})
    for (const double phi : {0.5, 1.3, 2., 2.7, -0.4, -1.2, -2.2}) expect(ratio, phi);
  for (const double ratio : {1.5, 2.7, 9.})
    for (const double phi : {0., std::numbers::pi}) expect(ratio, phi);
}

// From a strip along a parallel, on the outer side and the inner, whatever its curvature across.
TEST(Osculation, LeadsFromAStripToATorus) {
  constexpr std::uint64_t seed = 7;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (const double phi : {0.2, 1., 1.5, 2., 2.9, -0.7, -1.4, -2.4}) {
    const double minor = 0.7, parallel = 2,
                 major = parallel - minor * std::cos(phi);  // minor / parallel: 0.35
    const TorusPoint p = torus_point(major, minor, phi, random);
    const Vector3d axis = p.torus.axes.col(2),
                   centre = p.torus.centre + axis.dot(p.at - p.torus.centre) * axis;
    const Vector3d along = axis.cross(p.at - centre).normalized();
    Osculation o{p.at, {}, {0, 0}, {centre, axis, (p.at - centre).norm(), 0.01}};
    o.frame << along, p.outward.cross(along), p.outward;
    EXPECT_TRUE(includes(torus_primitive.osculating(o), p.torus, 1e-12)) << phi;
  }
}

}  // namespace
}  // namespace darboux::fit::osculation_test
