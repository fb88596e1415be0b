#include "averages.h"

#include "normal_cones.h"

namespace darboux {

Averages::Averages(const MeshUnderTest& under_test, const Accurate& accurate,
                   std::span<const VertexChecks> checks, std::span<const std::uint32_t> corners_of) {
  if (!accurate.known() || accurate.declared()) return;
  const Mesh& mesh = under_test.mesh;
  const std::size_t n = mesh.positions.size();
  std::vector<bool> tangents(n, false), normals(n, false);
  bool any_tangent = false, any_normal = false;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (corners_of[v] == 0 || !checks[v].has_normal) continue;
    if (accurate.normal(v) == Claim::beyond) normals[v] = any_normal = true;
    if (accurate.tangent(v) == Claim::beyond) tangents[v] = any_tangent = true;
  }
  if (!any_tangent && !any_normal) return;
  VertexJoins of_part;
  const VertexJoins& joins = joins_of(under_test, of_part);
  if (any_tangent) {
    OwnDirections own = own_directions(mesh, under_test.raw_sign, joins, tangents);
    tangents_ = std::move(own.average);
    for (std::size_t k = 0; k < own.all_round.size(); ++k)
      if (own.all_round[k]) tangents_[k] = true;
  }
  if (!any_normal) return;
  // Relief on a surface, such as a groove round a shaft, has exact normals that follow the triangles: they
  // deviate from the surface's up to twice as far as an average over the triangles does. At a border that
  // average deviates by half a triangle's turn, whatever the surface.
  std::vector<double> within_deg(n, 1);
  for (std::uint32_t v = 0; v < n; ++v)
    if (normals[v] && under_test.classes.of_vertex[v] != VertexClass::border)
      within_deg[v] = followed_deg(accurate.angles(v).normal);
  normals_ = are_average_normals(mesh, joins, normals, within_deg);
  std::size_t beyond = 0, averages = 0;
  for (std::size_t v = 0; v < n; ++v) {
    beyond += normals[v] ? corners_of[v] : 0;
    averages += normals_[v] ? corners_of[v] : 0;
  }
  explain_normals_ = averages > 0 && 2 * averages >= beyond;
}

bool Averages::tangent(std::uint32_t v, int sign) const {
  if (tangents_.empty()) return false;
  if (sign != 0) return tangents_[signed_index(v, sign)];
  return tangents_[signed_index(v, -1)] || tangents_[signed_index(v, 1)];
}

}  // namespace darboux
