#include <darboux/vertex_normals.h>

#include "triangle.h"

namespace darboux {

std::vector<Vec3<double>> vertex_normals(const Mesh& mesh, NormalWeight weight) {
  check_consistent(mesh, "mesh");
  check_finite(mesh, "mesh");
  std::vector<Vec3<double>> normals(mesh.positions.size());
  for (const Triangle& triangle : mesh.triangles) {
    std::array<Vec3<double>, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = mesh.positions[triangle[k]];
    if (is_degenerate(p[0], p[1], p[2])) continue;
    const Vec3<double> n = face_normal(p);
    for (int k = 0; k < 3; ++k)
      normals[triangle[k]] += (weight == NormalWeight::area    ? triangle_area(p)
                               : weight == NormalWeight::angle ? corner_angle(p, k)
                               : weight == NormalWeight::max   ? corner_max_weight(p, k)
                                                               : 1.0) *
                              n;
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (Vec3<double>& n : normals) n = n == Vec3<double>{} ? Vec3<double>{nan, nan, nan} : unit(n);
  return normals;
}

}  // namespace darboux
