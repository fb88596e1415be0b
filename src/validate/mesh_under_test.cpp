#include "mesh_under_test.h"

#include <cstdint>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <darboux/error.h>

#include "base/text.h"
#include "local_jets/local_truth.h"
#include "mesh/stored_rounding.h"
#include "mesh/triangle_signs.h"
#include "rounding.h"

namespace darboux {

const VertexJoins& joins_of(const MeshUnderTest& under_test, VertexJoins& of_part) {
  if (!under_test.joins.position.empty()) return under_test.joins;
  return of_part = join_vertices(under_test.mesh);
}

namespace {

// Finds the vertices that have triangles with uv area, and those that have such triangles of both windings.
// Both halves of a quad have the winding that MikkTSpace gives them.
void find_mirrors(MeshUnderTest& under_test) {
  const Mesh& mesh = under_test.mesh;
  const MikktspaceReference& mikktspace = under_test.mikktspace;
  const bool by_quads = !mikktspace.empty() && mikktspace.faces() == MikktspaceFaces::quads;
  under_test.across_mirror.assign(mesh.positions.size(), false);
  under_test.has_uv_area.assign(mesh.positions.size(), false);
  std::vector<signed char> winds(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (under_test.raw_sign[t] == 0 || certain_sign(mesh, mesh.triangles[t], 0) == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      const float of_quad = by_quads ? mikktspace.at(3 * t + k, v).w : 0;
      const int sign = of_quad > 0 ? 1 : of_quad < 0 ? -1 : under_test.raw_sign[t];
      if (sign * winds[v] < 0) under_test.across_mirror[v] = true;
      winds[v] = static_cast<signed char>(sign);
      under_test.has_uv_area[v] = true;
    }
  }
}

}  // namespace

MeshUnderTest prepare(const Mesh& mesh, const ValidateOptions& options) {
  if (!(options.max_angle_deg > 0 && options.max_angle_deg <= 180))
    throw ParameterError("max_angle_deg",
                         expected_got("0 < degrees <= 180", shortest(options.max_angle_deg)));
  for (const auto& [set, uvs] : options.other_uvs)
    if (uvs.size() != mesh.positions.size())
      throw MeshError("mesh", "uv set " + std::to_string(set) + " has " + std::to_string(uvs.size()) +
                                  " uvs for " + std::to_string(mesh.positions.size()) +
                                  " vertices, expected one per vertex");
  if (const Mesh* beside = options.beside; beside && !beside->triangles.empty()) {
    check_consistent(*beside, "mesh beside");
    if (beside->normals.empty() != mesh.normals.empty() || beside->uvs.empty() != mesh.uvs.empty() ||
        beside->tangents.empty() != mesh.tangents.empty())
      throw MeshError("mesh beside", "expected the attributes that the mesh has, got others");
  }
  return prepare_with_uvs_of(
      mesh, {.mesh = mesh, .has_area = triangles_with_area(mesh), .joins = join_vertices(mesh)});
}

MeshUnderTest prepare_with_uvs_of(const Mesh& mesh, MeshUnderTest other) {
  MeshUnderTest under_test{.mesh = mesh,
                           .raw_sign = triangle_signs(mesh),
                           .has_area = std::move(other.has_area),
                           .joins = std::move(other.joins)};
  find_mirrors(under_test);
  return under_test;
}

void add_references(MeshUnderTest& under_test, const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  if (options.references.mikktspace && !mesh.triangles.empty() && !mesh.tangents.empty() &&
      !mesh.normals.empty() && !mesh.uvs.empty())
    under_test.mikktspace = mikktspace_reference(mesh, mesh.uvs, options.threads);
  if (under_test.mikktspace.faces() == MikktspaceFaces::quads) find_mirrors(under_test);
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

MeshUnderTest restrict_to(const MeshUnderTest& whole, const Mesh& part,
                          std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> triangles,
                          double max_angle_deg) {
  MeshUnderTest under_test{.mesh = part};
  under_test.normals.all_oppose = whole.normals.all_oppose;
  under_test.cones = whole.cones.restricted_to(vertices, max_angle_deg);
  under_test.mikktspace = whole.mikktspace.restricted_to(part, vertices, triangles);
  const bool normals = !whole.mesh.normals.empty();
  for (const std::uint32_t v : vertices) {
    under_test.classes.of_vertex.push_back(whole.classes.of_vertex[v]);
    under_test.across_mirror.push_back(whole.across_mirror[v]);
    under_test.has_uv_area.push_back(whole.has_uv_area[v]);
    if (normals) {
      under_test.normals.unsupported.push_back(whole.normals.unsupported[v]);
      under_test.normals.side.push_back(whole.normals.side[v]);
      under_test.normals.may_be_meant.push_back(whole.normals.may_be_meant[v]);
      under_test.normals.departing.push_back(whole.normals.departing[v]);
      under_test.normals.drawn.push_back(whole.normals.drawn[v]);
      under_test.normals.faceted_vertices.push_back(whole.normals.faceted_vertices[v]);
    }
    if (!whole.local.empty()) under_test.local.push_back(whole.local[v]);
    if (!whole.between_parts.empty()) under_test.between_parts.push_back(whole.between_parts[v]);
  }
  std::unordered_map<std::int32_t, std::int32_t> island;
  for (const std::uint32_t t : triangles) {
    under_test.raw_sign.push_back(whole.raw_sign[t]);
    under_test.has_area.push_back(whole.has_area[t]);
    if (normals) {
      under_test.normals.faceted.push_back(whole.normals.faceted[t]);
      under_test.normals.opposing += whole.normals.opposes[t] ? 3 : 0;
      under_test.normals.opposes.push_back(whole.normals.opposes[t]);
    }
    const std::int32_t of_whole = whole.classes.island_of_triangle[t];
    const auto next = static_cast<std::int32_t>(island.size());
    under_test.classes.island_of_triangle.push_back(
        of_whole < 0 ? -1 : island.try_emplace(of_whole, next).first->second);
  }
  under_test.classes.islands = static_cast<std::int32_t>(island.size());
  return under_test;
}

namespace {

void append(const Mesh& other, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  const auto add = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  add(other.positions, mesh.positions);
  add(other.normals, mesh.normals);
  add(other.uvs, mesh.uvs);
  add(other.tangents, mesh.tangents);
  mesh.half_steps = larger_of(mesh.half_steps, other.half_steps);
}

// MikkTSpace may have been run over the mesh alone, or together with adjacent triangles: the reference that
// reproduces more of the mesh's stored tangents.
MikktspaceReference reference_of_both(const Mesh& mesh, const MikktspaceReference& own, const Mesh& both,
                                      int threads) {
  const std::size_t given = stored_corners(mesh, own);
  if (given < mesh.corners()) {
    MikktspaceReference of_both = mikktspace_reference(both, both.uvs, threads);
    if (stored_corners(mesh, of_both) > given) return of_both;  // the mesh's corners come first
  }
  std::vector<Vec4<float>> of_corner(both.corners(), Vec4<float>{0, 0, 0, 0});
  for (std::size_t c = 0; c < mesh.corners(); ++c) of_corner[c] = own.at(c, mesh.triangles[c / 3][c % 3]);
  return {both, of_corner, own.faces()};
}

// Runs the checks that need averages over the adjacent triangles, too. The classes stay those of the mesh:
// less is claimed at its border.
void check_with_those_beside(MeshUnderTest& under_test, const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  Mesh both = mesh;
  append(*options.beside, both);
  MeshUnderTest extended = prepare_with_uvs_of(
      both, {.mesh = both, .has_area = triangles_with_area(both), .joins = join_vertices(both)});
  if (!under_test.mikktspace.empty())
    extended.mikktspace = reference_of_both(mesh, under_test.mikktspace, both, options.threads);
  ValidateOptions alone = options;
  alone.beside = nullptr;
  classify_vertices(extended, {}, alone);
  std::vector<std::uint32_t> vertices(mesh.positions.size()), triangles(mesh.triangles.size());
  std::iota(vertices.begin(), vertices.end(), 0U);
  std::iota(triangles.begin(), triangles.end(), 0U);
  MeshUnderTest own = restrict_to(extended, mesh, vertices, triangles, options.max_angle_deg);
  // If one of the two is inside out and the other is not, the mesh is judged alone.
  if (own.normals.all_oppose == under_test.normals.all_oppose) under_test.normals = std::move(own.normals);
  under_test.cones = std::move(own.cones);
  under_test.mikktspace = std::move(own.mikktspace);
}

}  // namespace

void classify_vertices(MeshUnderTest& under_test, const std::vector<bool>& is_pole,
                       const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  const VertexJoins& joins = under_test.joins;
  under_test.classes = classify(mesh, is_pole, under_test.raw_sign, joins);
  under_test.normals = check_normals(mesh, under_test.has_area, joins);
  if (options.beside && !options.beside->triangles.empty()) {
    check_with_those_beside(under_test, options);
    return;
  }
  if (!options.references.triangles || mesh.tangents.empty() || mesh.normals.empty() || mesh.uvs.empty())
    return;
  std::vector<double> limit_deg(mesh.positions.size(), options.max_angle_deg);
  for (std::size_t v = 0; v < limit_deg.size(); ++v)
    if (under_test.classes.of_vertex[v] == VertexClass::border) limit_deg[v] *= 3;
  under_test.cones = Cones(mesh, under_test.raw_sign, under_test.has_area, joins, under_test.mikktspace,
                           limit_deg, options.max_angle_deg);
}

}  // namespace darboux
