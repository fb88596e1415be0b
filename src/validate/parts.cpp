#include "parts.h"

#include <unordered_map>

#include "base/disjoint_sets.h"
#include "mesh/frames/creases.h"
#include "mesh/frames/rings.h"
#include "mesh/triangle_signs.h"

namespace darboux {

std::vector<std::vector<std::uint32_t>> parts_of(const Mesh& mesh, bool at_creases) {
  const std::vector<Index> joined = join_equal_vertices(mesh);
  const std::vector<signed char> sign = triangle_signs(mesh);
  DisjointSets sets(mesh.triangles.size());
  // First those with area in uv; then each of the others with one of its neighbours, so that it joins no two
  // of them.
  std::vector<bool> placed(mesh.triangles.size(), false);
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    sets.join(a, b);
    placed[a] = placed[b] = true;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> without_area;
  for_each_shared_edge(
      mesh.triangles.size(), mesh.positions.size(),
      [&](std::uint32_t t, std::uint32_t k) { return joined[mesh.triangles[t][k]]; },
      [&](const SharedEdge& e) {
        const auto [a, b] = e.triangle;
        if (at_creases && is_sharp(mesh, e)) return;
        if (!mesh.uvs.empty() && (sign[a] == 0 || sign[b] == 0))
          without_area.emplace_back(a, b);
        else if (sign[a] == sign[b])
          join(a, b);
      });
  for (const auto& [a, b] : without_area)
    if (!(sign[a] == 0 && placed[a]) && !(sign[b] == 0 && placed[b])) join(a, b);
  std::vector<std::vector<std::uint32_t>> parts;
  std::unordered_map<std::uint32_t, std::size_t> number;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [place, is_new] = number.try_emplace(sets.find(t), parts.size());
    if (is_new) parts.emplace_back();
    parts[place->second].push_back(t);
  }
  return parts;
}

Part part_of(const Mesh& whole, std::vector<std::uint32_t> triangles) {
  Part part;
  part.triangles = std::move(triangles);
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t t : part.triangles) {
    Triangle& triangle = part.mesh.triangles.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = whole.triangles[t][k];
      const auto [place, is_new] = number.try_emplace(v, static_cast<std::uint32_t>(part.vertices.size()));
      if (is_new) part.vertices.push_back(v);
      triangle[k] = place->second;
    }
  }
  const auto take = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(part.vertices.size());
    for (const std::uint32_t v : part.vertices) to.push_back(from[v]);
  };
  take(whole.positions, part.mesh.positions);
  take(whole.normals, part.mesh.normals);
  take(whole.uvs, part.mesh.uvs);
  take(whole.tangents, part.mesh.tangents);
  part.mesh.half_steps = whole.half_steps;
  return part;
}

MeshUnderTest restrict_to(const MeshUnderTest& whole, const Part& part) {
  MeshUnderTest under_test{.mesh = part.mesh};
  under_test.normals.all_oppose = whole.normals.all_oppose;
  under_test.cones = whole.cones.restricted_to(part.vertices);
  const bool normals = !whole.mesh.normals.empty();
  for (const std::uint32_t v : part.vertices) {
    under_test.classes.of_vertex.push_back(whole.classes.of_vertex[v]);
    under_test.across_mirror.push_back(whole.across_mirror[v]);
    under_test.has_uv_area.push_back(whole.has_uv_area[v]);
    if (normals) {
      under_test.normals.unsupported.push_back(whole.normals.unsupported[v]);
      under_test.normals.drawn.push_back(whole.normals.drawn[v]);
      under_test.normals.faceted_vertices.push_back(whole.normals.faceted_vertices[v]);
    }
    if (!whole.local.empty()) under_test.local.push_back(whole.local[v]);
    if (!whole.between_parts.empty()) under_test.between_parts.push_back(whole.between_parts[v]);
  }
  std::unordered_map<std::int32_t, std::int32_t> island;
  for (const std::uint32_t t : part.triangles) {
    under_test.raw_sign.push_back(whole.raw_sign[t]);
    if (normals) {
      under_test.normals.faceted.push_back(whole.normals.faceted[t]);
      under_test.normals.opposing += whole.normals.opposes[t] ? 3 : 0;
      under_test.normals.opposes.push_back(whole.normals.opposes[t]);
    }
    const std::int32_t of_whole = whole.classes.island_of_triangle[t];
    const auto next = static_cast<std::int32_t>(island.size());
    under_test.classes.island_of_triangle.push_back(
        of_whole < 0 ? -1 : island.try_emplace(of_whole, next).first->second);
    if (!whole.mikktspace.empty())
      for (std::size_t k = 0; k < 3; ++k) under_test.mikktspace.push_back(whole.mikktspace[3 * t + k]);
  }
  under_test.classes.islands = static_cast<std::int32_t>(island.size());
  return under_test;
}

UvSets restrict_to(std::span<const UvSets::value_type> whole, const Part& part) {
  UvSets sets;
  for (const auto& [set, uvs] : whole) {
    sets.emplace_back(set, std::vector<Vec2<double>>{});
    for (const std::uint32_t v : part.vertices) sets.back().second.push_back(uvs[v]);
  }
  return sets;
}

}  // namespace darboux
