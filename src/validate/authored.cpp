#include "authored.h"

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

namespace darboux {
namespace {

// Whether a surface ends there: artists give it the normals of the adjoining surface.
bool ends_at(VertexClass c) {
  return c == VertexClass::border || c == VertexClass::crease;
}

struct Step {
  double off;  // the deviation of the first one's normal, degrees
  std::uint32_t from, to;
};

}  // namespace

std::vector<bool> may_be_authored(const MeshUnderTest& under_test, const Accurate& accurate) {
  const Mesh& mesh = under_test.mesh;
  const std::vector<VertexClass>& classes = under_test.classes.of_vertex;
  const auto is_beyond = [&](std::uint32_t v) { return accurate.normal(v) == Claim::beyond; };
  std::vector<bool> result(classes.size());
  bool any = false;
  for (std::uint32_t v = 0; v < result.size(); ++v) {
    result[v] = ends_at(classes[v]) || classes[v] == VertexClass::seam;
    any = any || (!result[v] && is_beyond(v));
  }
  if (!any) return result;
  VertexJoins of_part;
  const std::vector<std::uint32_t>& group = joins_of(under_test, of_part).position_and_normal;
  std::vector<bool> reached(result.size(), false);
  for (std::uint32_t v = 0; v < result.size(); ++v)
    if (ends_at(classes[v])) reached[group[v]] = true;
  constexpr double most_left = 0.9;
  std::vector<Step> steps;
  const auto look = [&](std::uint32_t v, std::uint32_t w) {
    const double off = accurate.angles(v).normal;
    if ((reached[group[v]] || is_beyond(v)) && is_beyond(w) && accurate.angles(w).normal <= most_left * off)
      steps.push_back({off, group[v], group[w]});
  };
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) look(t[k], t[(k + 1) % 3]), look(t[(k + 1) % 3], t[k]);
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
    return std::tuple(-a.off, a.from, a.to) < std::tuple(-b.off, b.from, b.to);
  });
  for (const Step& s : steps)
    if (reached[s.from]) reached[s.to] = true;
  for (std::uint32_t v = 0; v < result.size(); ++v)
    if (is_beyond(v) && reached[group[v]]) result[v] = true;
  return result;
}

}  // namespace darboux
