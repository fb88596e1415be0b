#include "blends.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace darboux {

std::vector<bool> blended_vertices(const MeshUnderTest& under_test, const Accurate& accurate) {
  const Mesh& mesh = under_test.mesh;
  std::vector<bool> blended(mesh.positions.size(), false);
  const auto is_beyond = [&](std::uint32_t v) { return accurate.normal(v) == Claim::beyond; };
  const auto off = [&](std::uint32_t v) { return accurate.angles(v).normal; };
  bool any = false;
  for (std::uint32_t v = 0; v < blended.size(); ++v) {
    blended[v] = ends_at(under_test.classes.of_vertex[v]);
    any = any || (!blended[v] && is_beyond(v));
  }
  if (!any) return blended;
  VertexJoins of_part;
  const std::vector<std::uint32_t>& first = joins_of(under_test, of_part).position_and_normal;
  constexpr double step = 1.1;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> steps;  // from the vertex that is farther off
  const auto look = [&](std::uint32_t v, std::uint32_t w) {
    if (blended[v]) blended[first[v]] = true;
    if ((blended[v] || is_beyond(v)) && is_beyond(w) && off(v) >= step * off(w))
      steps.emplace_back(first[v], first[w]);
  };
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) look(t[k], t[(k + 1) % 3]), look(t[(k + 1) % 3], t[k]);
  std::sort(steps.begin(), steps.end(), [&](const auto& a, const auto& b) {
    return off(a.first) != off(b.first) ? off(a.first) > off(b.first) : a < b;
  });
  for (const auto& [v, w] : steps)
    if (blended[v]) blended[w] = true;
  for (std::uint32_t v = 0; v < blended.size(); ++v)
    blended[v] = blended[v] || (blended[first[v]] && is_beyond(v));
  return blended;
}

}  // namespace darboux
