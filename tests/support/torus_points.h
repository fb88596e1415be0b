/// \file torus_points.h
/// The points of tests/data/torus_points.xyz, made again.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <darboux/vector.h>

namespace darboux::test {

/// 300 points of std::mt19937_64 with seed 1: 270 on a torus (major radius 2, minor radius 0.5, centre (1,
/// -2, 0.5), axis (0.48, 0.6, 0.64)), uniform in both angles, with Gaussian noise of standard deviation 0.02
/// on each coordinate; each tenth point uniform in the cube of side 6 about the centre.
inline std::vector<Vec3<double>> torus_points() {
  std::mt19937_64 random(1);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto angle = [&] { return 2 * std::numbers::pi * uniform(); };
  const auto gauss = [&] {  // Box and Muller
    const double r = std::sqrt(-2 * std::log(1 - uniform()));
    return r * std::cos(angle());
  };
  const Vec3<double> centre{1, -2, 0.5}, axis{0.48, 0.6, 0.64}, e{0.8, 0, -0.6}, f = cross(axis, e);
  std::vector<Vec3<double>> points;
  for (int i = 0; i < 300; ++i) {
    if (i % 10 == 9) {
      const double x = uniform(), y = uniform(), z = uniform();
      points.push_back(centre + Vec3<double>{6 * x - 3, 6 * y - 3, 6 * z - 3});
      continue;
    }
    const double a = angle(), b = angle(), rho = 2 + 0.5 * std::cos(b);
    const double x = gauss(), y = gauss(), z = gauss();
    points.push_back(centre + rho * std::cos(a) * e + rho * std::sin(a) * f + 0.5 * std::sin(b) * axis +
                     0.02 * Vec3<double>{x, y, z});
  }
  return points;
}

}  // namespace darboux::test
