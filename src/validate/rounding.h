// How far rounding of the stored numbers may have moved things.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <darboux/mesh.h>
#include <darboux/triangle.h>

#include "base/degrees.h"
#include "mesh/stored_rounding.h"

namespace darboux {

inline double largest_coordinate(const std::array<Vec2<double>, 3>& uv) {
  double size = 0;
  for (const Vec2<double>& a : uv) size = std::fmax(size, std::fmax(std::fabs(a.x), std::fabs(a.y)));
  return size;
}

// Radians by which rounding to the file's numbers may have turned the tangent of a vertex.
inline double tangent_rounding(const Mesh& mesh, std::uint32_t v) {
  return std::numbers::sqrt3 * half_step(mesh.half_steps.tangent, 1) / norm(mesh.tangents[v].xyz());
}

// Degrees by which rounding of the positions may have turned the plane of a triangle; 180 without one.
inline double plane_rounding_deg(const Mesh& mesh, const Triangle& triangle) {
  using Numbers = std::array<double, 3>;
  std::array<Numbers, 3> p;
  Numbers largest{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3<double>& a = mesh.positions[triangle[k]];
    p[k] = {a.x, a.y, a.z};
    for (std::size_t c = 0; c < 3; ++c) largest[c] = std::fmax(largest[c], std::fabs(p[k][c]));
  }
  const double size = std::max({largest[0], largest[1], largest[2]});
  if (!(size > 0) || !std::isfinite(size)) return 180;
  Numbers step, edges{};  // relative to the size: no product leaves the range
  for (std::size_t c = 0; c < 3; ++c) {
    step[c] = half_step(mesh.half_steps.position, largest[c]) / size;
    for (Numbers& a : p) a[c] /= size;
    for (std::size_t k = 0; k < 3; ++k) edges[c] += std::fabs(p[(k + 1) % 3][c] - p[k][c]);
  }
  const Vec3<double> e1{p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]},
      e2{p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]}, area = cross(e1, e2);
  const double twice_area = norm(area);
  if (!(twice_area > 0)) return 180;
  // What each component of the area may have changed by, as far as it turns the plane.
  double sine = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
    const double along = (c == 0 ? area.x : c == 1 ? area.y : area.z) / twice_area;
    sine += (step[d] * edges[e] + step[e] * edges[d] + 6 * step[d] * step[e]) *
            std::sqrt(std::fmax(0.0, 1 - along * along)) / twice_area;
  }
  return sine < 1 ? degrees_per_radian * std::asin(sine) : 180;
}

// The sign of the uv area; 0 if rounding of the uvs may have changed it. \param half_step of the uvs
inline int certain_sign(const std::array<Vec2<double>, 3>& uv, double half_step) {
  const Vec2<double> a = uv[1] - uv[0], b = uv[2] - uv[0];
  const auto error = [&](double sizes) {
    return 2 * std::numbers::sqrt2 * half_step * sizes + 8 * half_step * half_step;
  };
  // Plain arithmetic decides for nearly all triangles.
  const double plain = a.x * b.y - a.y * b.x;
  if (std::fabs(plain) > 2 * error(std::fabs(a.x) + std::fabs(a.y) + std::fabs(b.x) + std::fabs(b.y)))
    return plain > 0 ? 1 : -1;
  const double area = signed_uv_area2(uv[0], uv[1], uv[2]);
  return std::fabs(area) <= error(std::hypot(a.x, a.y) + std::hypot(b.x, b.y)) ? 0 : area > 0 ? 1 : -1;
}
// \param of_file the half step of the file's uvs; 0: only single precision counts
inline int certain_sign(const Mesh& mesh, const Triangle& t, double of_file) {
  const std::array<Vec2<double>, 3> uv{mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]};
  return certain_sign(uv, half_step(of_file, largest_coordinate(uv)));
}

}  // namespace darboux
