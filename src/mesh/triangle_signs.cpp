#include "triangle_signs.h"

#include <darboux/triangle.h>

namespace darboux {

signed char triangle_sign(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2) {
  if (const int sign = plain_sign(uv0, uv1, uv2)) return static_cast<signed char>(sign);
  return is_degenerate(uv0, uv1, uv2) ? 0 : signed_uv_area2(uv0, uv1, uv2) > 0 ? 1 : -1;
}

std::vector<signed char> triangle_signs(const Mesh& mesh) {
  std::vector<signed char> signs(mesh.triangles.size(), 0);
  if (mesh.uvs.empty()) return signs;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    signs[t] = triangle_sign(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]);
  }
  return signs;
}

std::vector<bool> triangles_with_area(const Mesh& mesh) {
  std::vector<bool> result(mesh.triangles.size());
  for (std::size_t t = 0; t < result.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    result[t] = !is_degenerate(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
  }
  return result;
}

}  // namespace darboux
