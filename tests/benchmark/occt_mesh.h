// OCCT's BRepMesh on its own primitives.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

namespace darboux::bench {

// Of a sphere of radius 1, a torus of radii 1 and 0.25, a cylinder of radius 1 and height 1, and a cone of
// the same: how far a point is from it, and the normal there, by the implicit equation.
struct NearestPoint {
  double distance, normal[3];
};
inline NearestPoint nearest_point(const std::string& surface, double x, double y, double z) {
  const double rho = std::hypot(x, y), radius = std::hypot(rho, z), tube = std::hypot(rho - 1, z);
  if (surface == "sphere") return {std::fabs(radius - 1), {x / radius, y / radius, z / radius}};
  if (surface == "torus") {
    const double out = (rho - 1) / tube / rho;
    return {std::fabs(tube - 0.25), {out * x, out * y, z / tube}};
  }
  if (surface == "cylinder") return {std::fabs(rho - 1), {x / rho, y / rho, 0}};
  const double half = std::sqrt(0.5);
  return {half * std::fabs(rho + z - 1), {half * x / rho, half * y / rho, half}};
}

// The largest of both over points of triangles: the angle is that between the normal there and that
// interpolated.
struct Largest {
  double distance = 0, normal_rad = 0;

  // A point of a triangle by the weights of its corners, each three numbers.
  void add(const std::string& surface, const double (&corners)[3][3], const double (&weights)[3]) {
    double p[3] = {0, 0, 0}, n[3] = {0, 0, 0}, along = 0, across[3];
    for (int k = 0; k < 3; ++k) {
      const NearestPoint at = nearest_point(surface, corners[k][0], corners[k][1], corners[k][2]);
      for (int i = 0; i < 3; ++i) p[i] += weights[k] * corners[k][i], n[i] += weights[k] * at.normal[i];
    }
    const NearestPoint truth = nearest_point(surface, p[0], p[1], p[2]);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, l = (i + 2) % 3;
      along += n[i] * truth.normal[i];
      across[i] = n[j] * truth.normal[l] - n[l] * truth.normal[j];
    }
    distance = std::fmax(distance, truth.distance);
    // NaN at the tip of the cone, which has none.
    normal_rad = std::fmax(normal_rad, std::atan2(std::hypot(across[0], across[1], across[2]), along));
  }
};

struct OcctMesh {
  std::size_t samples = 0, triangles = 0;
  double seconds = 0;
  Largest errors{};
};

// Such a surface without its caps, meshed to a linear deflection. Nothing where OCCT is not there.
std::optional<OcctMesh> occt_mesh(const std::string& surface, double chord, int rounds);

}  // namespace darboux::bench
