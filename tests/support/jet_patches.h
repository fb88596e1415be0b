/// \file jet_patches.h
/// Neighbours on known surfaces, for the tests of local fits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/frame.h>
#include <darboux/shape_operator.h>

#include "random.h"

namespace darboux::test {

using Points = std::vector<Vec3<double>>;
constexpr double infinite = std::numeric_limits<double>::infinity();

// A point of a surface and neighbours of it; the point itself is the first.
struct Patch {
  Vec2<double> uv;
  std::vector<Vec2<double>> uvs;
  Points points;
};

// n points of the tangent plane's disk of radius h, taken to the surface along the chart.
inline Patch random_patch(const AnySurface& surface, Random& random, std::size_t n, double h) {
  Patch patch{{random.uniform(0, 1), random.uniform(0.2, 0.8)}, {}, {}};
  const Jet2<double> j = surface.jet(patch.uv.x, patch.uv.y);
  const Frame<double> f = surface.frame(patch.uv.x, patch.uv.y);
  const ShapeOperator<double> s = shape_operator(j, f);
  patch.uvs.push_back(patch.uv);
  while (patch.uvs.size() < n) {
    const double x = random.uniform(-h, h), y = random.uniform(-h, h);
    if (std::hypot(x, y) > h) continue;
    const double dv = y / s.g;
    patch.uvs.push_back(patch.uv + Vec2<double>{(x - s.f * dv) / s.e, dv});
  }
  for (const auto& uv : patch.uvs) patch.points.push_back(surface.jet(uv.x, uv.y).position);
  return patch;
}

inline void add_noise(Patch& patch, Random& random, double sigma) {
  for (auto& p : patch.points) p += sigma * Vec3<double>{random.normal(), random.normal(), random.normal()};
}

inline const std::array<const char*, 3> specifications{
    "torus:major_radius=1,minor_radius=0.4", "ellipsoid:semi_axis_x=1,semi_axis_y=1.3,semi_axis_z=0.8",
    "sphere:radius=1"};

// The angle between two directions without sign.
inline double line_angle(const Vec3<double>& a, const Vec3<double>& b) {
  const double angle = angle_between(a, b);
  return std::min(angle, std::numbers::pi - angle);
}

}  // namespace darboux::test
