#include "mesh_under_test.h"

#include <darboux/error.h>

#include "base/text.h"
#include "local_jets/local_truth.h"
#include "mesh/triangle_signs.h"
#include "rounding.h"

namespace darboux {

const VertexJoins& joins_of(const MeshUnderTest& under_test, VertexJoins& of_part) {
  if (!under_test.joins.position.empty()) return under_test.joins;
  return of_part = join_vertices(under_test.mesh);
}

MeshUnderTest prepare(const Mesh& mesh, const ValidateOptions& options) {
  if (!(options.max_angle_deg > 0 && options.max_angle_deg <= 180))
    throw ParameterError("max_angle_deg",
                         expected_got("0 < degrees <= 180", shortest(options.max_angle_deg)));
  for (const auto& [set, uvs] : options.other_uvs)
    if (uvs.size() != mesh.positions.size())
      throw MeshError("mesh", "uv set " + std::to_string(set) + " has " + std::to_string(uvs.size()) +
                                  " uvs for " + std::to_string(mesh.positions.size()) +
                                  " vertices, expected one per vertex");
  return prepare_with_uvs_of(
      mesh, {.mesh = mesh, .has_area = triangles_with_area(mesh), .joins = join_vertices(mesh)});
}

MeshUnderTest prepare_with_uvs_of(const Mesh& mesh, MeshUnderTest other) {
  MeshUnderTest under_test{.mesh = mesh,
                           .raw_sign = triangle_signs(mesh),
                           .has_area = std::move(other.has_area),
                           .joins = std::move(other.joins)};
  under_test.across_mirror.assign(mesh.positions.size(), false);
  under_test.has_uv_area.assign(mesh.positions.size(), false);
  std::vector<signed char> winds(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (under_test.raw_sign[t] == 0 || certain_sign(mesh, mesh.triangles[t], 0) == 0) continue;
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (under_test.raw_sign[t] * winds[v] < 0) under_test.across_mirror[v] = true;
      winds[v] = under_test.raw_sign[t];
      under_test.has_uv_area[v] = true;
    }
  }
  return under_test;
}

void add_references(MeshUnderTest& under_test, const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  if (options.references.mikktspace && !mesh.triangles.empty() && !mesh.tangents.empty() &&
      !mesh.normals.empty() && !mesh.uvs.empty())
    under_test.mikktspace = mikktspace_reference(mesh, mesh.uvs, options.threads);
  const bool by_uvs = has_uv_area(under_test.raw_sign);
  if (!options.references.local || (!by_uvs && mesh.normals.empty())) return;
  if (by_uvs) under_test.equal = join_equal_vertices(mesh);
  under_test.local = by_uvs ? local_truth(mesh, under_test.equal, true)
                            : local_truth(mesh, join_equal_vertices(mesh, false), false);
}

std::vector<bool> poles(std::span<const Truth> truth) {
  std::vector<bool> result;
  for (const Truth& t : truth) result.push_back(t.pole);
  return result;
}

void classify_vertices(MeshUnderTest& under_test, const std::vector<bool>& is_pole,
                       const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  const VertexJoins& joins = under_test.joins;
  under_test.classes = classify(mesh, is_pole, under_test.raw_sign, joins);
  under_test.normals = check_normals(mesh, under_test.has_area, joins);
  if (!options.references.triangles || mesh.tangents.empty() || mesh.normals.empty() || mesh.uvs.empty())
    return;
  std::vector<double> limit_deg(mesh.positions.size(), options.max_angle_deg);
  for (std::size_t v = 0; v < limit_deg.size(); ++v)
    if (under_test.classes.of_vertex[v] == VertexClass::border) limit_deg[v] *= 3;
  under_test.cones = Cones(mesh, under_test.raw_sign, under_test.has_area, joins, under_test.mikktspace,
                           limit_deg, options.max_angle_deg);
}

}  // namespace darboux
