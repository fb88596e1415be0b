#include <limits>

#include <darboux/vertex_normals.h>

#include "corner.h"

namespace darboux {

std::vector<Vec3<double>> vertex_normals(const Mesh& mesh, NormalWeight weight) {
  check_consistent(mesh, "mesh");
  check_finite(mesh, "mesh");
  const double scale = scale_below_one(mesh);
  std::vector<Vec3<double>> normals(mesh.positions.size());
  std::vector<double> weights(mesh.positions.size());
  for (const Triangle& triangle : mesh.triangles) {
    const std::array<Vec3<double>, 3> p = scaled(
        {mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]}, scale);
    if (is_degenerate(p[0], p[1], p[2])) continue;
    const Vec3<double> n = face_normal(p);
    for (int k = 0; k < 3; ++k) {
      const double w = weight == NormalWeight::area    ? triangle_area(p)
                       : weight == NormalWeight::angle ? corner_angle(p, k)
                       : weight == NormalWeight::max   ? corner_max_weight(p, k)
                                                       : 1.0;
      normals[triangle[k]] += w * n;
      weights[triangle[k]] += w;
    }
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double cancelled_below = 16 * 0x1p-53;
  for (std::size_t v = 0; v < normals.size(); ++v)
    normals[v] =
        norm(normals[v]) > cancelled_below * weights[v] ? unit(normals[v]) : Vec3<double>{nan, nan, nan};
  return normals;
}

}  // namespace darboux
