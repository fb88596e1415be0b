#include "mesh_under_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <darboux/error.h>
#include <darboux/mikktspace.h>

#include "local_jets/local_truth.h"
#include "mesh/triangle_signs.h"

namespace darboux {

std::vector<Vec4<float>> mikktspace_of(const Mesh& mesh, std::span<const Vec2<double>> uvs, int threads,
                                       bool sort_all_edges) {
  const std::size_t n = mesh.positions.size();
  std::vector<float> positions(3 * n), normals(3 * n), texcoords(2 * n);
  std::vector<bool> finite(n);
  for (std::size_t v = 0; v < n; ++v) {
    const Vec3<double>&p = mesh.positions[v], &m = mesh.normals[v];
    bool good = true;
    const auto store = [&good](double x, float& to, float largest) {
      to = static_cast<float>(x);
      good = good && std::fabs(to) <= largest;
    };
    constexpr float any = std::numeric_limits<float>::max(), largest_normal = 0x1p28f;
    const double position[] = {p.x, p.y, p.z}, normal[] = {m.x, m.y, m.z}, uv[] = {uvs[v].x, uvs[v].y};
    for (std::size_t k = 0; k < 3; ++k) {
      store(position[k], positions[3 * v + k], any);
      store(normal[k], normals[3 * v + k], largest_normal);
    }
    for (std::size_t k = 0; k < 2; ++k) store(uv[k], texcoords[2 * v + k], any);
    finite[v] = good;
    if (good) continue;
    std::fill_n(&positions[3 * v], 3, 0.0f);
    std::fill_n(&normals[3 * v], 3, 0.0f);
    std::fill_n(&texcoords[2 * v], 2, 0.0f);
  }
  std::vector<std::uint32_t> corners;
  corners.reserve(mesh.corners());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (finite[a] && finite[b] && finite[c]) corners.insert(corners.end(), {a, b, c});
  }
  std::vector<Vec4<float>> result(mesh.corners(), Vec4<float>{0, 0, 0, 0});
  if (corners.empty()) return result;
  mikktspace(MikkMesh{positions, normals, texcoords, corners, {}},
             std::span<float>(&result[0].x, 4 * corners.size()),
             {.sort_all_edges = sort_all_edges, .unserved_sign = 0, .threads = threads});
  // To their triangles, from the last on, behind those that are left out.
  for (std::size_t t = mesh.triangles.size(), next = corners.size(); next < 3 * t;) {
    const auto& [a, b, c] = mesh.triangles[--t];
    const bool whole = finite[a] && finite[b] && finite[c];
    for (std::size_t k = 3; k-- > 0;) result[3 * t + k] = whole ? result[--next] : Vec4<float>{0, 0, 0, 0};
  }
  return result;
}

MeshUnderTest prepare(const Mesh& mesh, const ValidateOptions& options) {
  for (const auto& [set, uvs] : options.other_uvs)
    if (uvs.size() != mesh.positions.size())
      throw MeshError("mesh", "uv set " + std::to_string(set) + " has " + std::to_string(uvs.size()) +
                                  " uvs for " + std::to_string(mesh.positions.size()) +
                                  " vertices, expected one per vertex");
  return prepare_with_joins(mesh, join_vertices(mesh));
}

MeshUnderTest prepare_with_joins(const Mesh& mesh, VertexJoins joins) {
  MeshUnderTest under_test{.mesh = mesh, .raw_sign = triangle_signs(mesh), .joins = std::move(joins)};
  under_test.across_mirror.assign(mesh.positions.size(), false);
  under_test.has_uv_area.assign(mesh.positions.size(), false);
  std::vector<signed char> winds(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (under_test.raw_sign[t] * winds[v] < 0) under_test.across_mirror[v] = true;
      if (under_test.raw_sign[t] == 0) continue;
      winds[v] = under_test.raw_sign[t];
      under_test.has_uv_area[v] = true;
    }
  return under_test;
}

void add_references(MeshUnderTest& under_test, const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  if (options.references.mikktspace && !mesh.tangents.empty() && !mesh.normals.empty() && !mesh.uvs.empty())
    under_test.mikktspace = mikktspace_of(mesh, mesh.uvs, options.threads);
  if (!options.references.local || mesh.uvs.empty()) return;
  under_test.equal = join_equal_vertices(mesh);
  under_test.local = local_truth(mesh, under_test.equal);
}

void classify_vertices(MeshUnderTest& under_test, const std::vector<bool>& is_pole,
                       const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  const VertexJoins& joins = under_test.joins;
  under_test.classes = classify(mesh, is_pole, under_test.raw_sign, joins);
  under_test.normals = check_normals(mesh, joins);
  if (!options.references.triangles || mesh.tangents.empty() || mesh.normals.empty() || mesh.uvs.empty())
    return;
  std::vector<double> limit_deg(mesh.positions.size(), options.max_angle_deg);
  for (std::size_t v = 0; v < limit_deg.size(); ++v)
    if (under_test.classes.of_vertex[v] == VertexClass::border) limit_deg[v] *= 3;
  under_test.cones = Cones(mesh, under_test.raw_sign, joins, limit_deg, options.max_angle_deg);
}

}  // namespace darboux
