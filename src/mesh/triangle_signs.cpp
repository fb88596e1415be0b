#include "triangle_signs.h"

#include <darboux/triangle.h>

namespace darboux {

std::vector<signed char> triangle_signs(const Mesh& mesh) {
  std::vector<signed char> signs(mesh.triangles.size(), 0);
  if (mesh.uvs.empty()) return signs;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (!is_degenerate(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]))
      signs[t] = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) > 0 ? 1 : -1;
  }
  return signs;
}

}  // namespace darboux
