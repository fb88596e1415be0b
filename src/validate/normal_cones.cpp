#include "normal_cones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <span>

#include <darboux/frame.h>

#include "angles.h"
#include "base/degrees.h"
#include "mesh/quads.h"

namespace darboux {
namespace {

using Normals = std::vector<Vec3<double>>;

constexpr double average_deg = 1;   // from an average by a usual weighting
constexpr double tolerance = 1e-3;  // the sine of how far outside the cone rounding may leave a normal
// All triples of normals are tried. If very many meet at a tip, only clearly different ones are used.
constexpr std::size_t many = 40, most_normals = 100;
// Cosines: of 0.08 degrees, of 5 degrees, and 0.8 degrees from -1.
constexpr double alike = 1 - 1e-6, near = 0.9962, opposite = -1 + 1e-4;

// On the arc from a to b.
bool is_on_arc(const Vec3<double>& n, const Vec3<double>& a, const Vec3<double>& b) {
  const Vec3<double> across = cross(a, b);
  return std::fabs(dot(n, across)) <= tolerance * norm(across) && dot(cross(a, n), across) >= 0 &&
         dot(cross(n, b), across) >= 0 && norm(across) > 0;
}

// In the cone that a, b and c span.
bool is_in_cone(const Vec3<double>& n, const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const Vec3<double> faces[]{cross(b, c), cross(c, a), cross(a, b)};
  const double volume = dot(a, faces[0]), side = volume > 0 ? 1 : -1;
  constexpr double flat = 1e-9;
  return std::fabs(volume) > flat && std::all_of(std::begin(faces), std::end(faces), [&](const auto& face) {
           return side * dot(n, face) >= -tolerance * norm(face);
         });
}

// By Caratheodory's theorem a direction in a cone lies in the cone of three of those that span it, or on the
// arc of two. For a sheet with a back the cone is the whole sphere and proves nothing, so the answer is no.
bool is_in_cone(const Vec3<double>& n, const Normals& of) {
  for (std::size_t i = 0; i < of.size(); ++i)
    for (std::size_t j = i + 1; j < of.size(); ++j)
      if (dot(of[i], of[j]) < opposite) return false;
  for (std::size_t i = 0; i < of.size(); ++i)
    for (std::size_t j = i + 1; j < of.size(); ++j) {
      if (is_on_arc(n, of[i], of[j])) return true;
      for (std::size_t k = j + 1; k < of.size(); ++k)
        if (is_in_cone(n, of[i], of[j], of[k])) return true;
    }
  return false;
}

// Whether the normals of requested vertices lie in the cone of their own triangles' normals, that is, are
// averages of these with any positive weights. Blender averages the normals of quads, which are no weighted
// average over the triangles at a corner, so a quad's own normal counts at its four corners. At sharp ridges
// an average may be far from each of the triangles; a normal that was turned is no average.
std::vector<bool> lie_in_normal_cones(const Mesh& mesh, const VertexJoins& joins,
                                      const std::vector<bool>& vertices) {
  struct Group {
    Normals normals{};
    std::optional<bool> between{};
  };
  std::map<std::uint32_t, Group> groups;  // by the join of vertices of one place and normal
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    if (vertices[v]) groups[joins.position_and_normal[v]];
  const auto add = [&](std::uint32_t v, const Vec3<double>& plane) {
    const auto found = groups.find(joins.position_and_normal[v]);
    if (found == groups.end() || found->second.normals.size() >= most_normals) return;
    Normals& kept = found->second.normals;
    const double as_near = kept.size() < many ? alike : near;
    if (dot(plane, plane) > 0.5 && std::none_of(kept.begin(), kept.end(), [&](const auto& other) {
          return dot(other, plane) > as_near;
        }))
      kept.push_back(plane);
  };
  const auto across = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    return unit(accurate_cross(mesh.positions[b] - mesh.positions[a], mesh.positions[d] - mesh.positions[c]));
  };
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) add(v, across(t[0], t[1], t[0], t[2]));
  for (std::size_t t = 1; t < mesh.triangles.size(); ++t)
    if (const auto quad = quad_of(mesh.triangles[t - 1], mesh.triangles[t])) {
      const auto& [a, b, c, d] = *quad;
      for (const std::uint32_t v : *quad) add(v, across(a, c, b, d));
      ++t;
    }
  std::vector<bool> result(vertices.size(), false);
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    if (!vertices[v]) continue;
    Group& group = groups[joins.position_and_normal[v]];
    if (!group.between) group.between = is_in_cone(unit(mesh.normals[v]), group.normals);
    result[v] = *group.between;
  }
  return result;
}

}  // namespace

std::vector<bool> are_average_normals(const Mesh& mesh, const VertexJoins& joins,
                                      const std::vector<bool>& vertices, std::span<const double> within_deg) {
  const std::size_t n = mesh.positions.size();
  constexpr std::uint32_t none = ~0U;
  std::vector<std::uint32_t> sum_of_group(n, none);
  using Sums = std::array<Vec3<double>, 5>;  // equal weights, area, angle, both, and [Max1999]
  std::vector<Sums> sums;
  for (std::uint32_t v = 0; v < n; ++v)
    if (std::uint32_t& sum = sum_of_group[joins.position_and_normal[v]]; vertices[v] && sum == none) {
      sum = static_cast<std::uint32_t>(sums.size());
      sums.push_back({});
    }
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t sum = sum_of_group[joins.position_and_normal[t[k]]];
      if (sum == none) continue;
      const Vec3<double>&p = mesh.positions[t[k]], a = mesh.positions[t[(k + 1) % 3]] - p,
            b = mesh.positions[t[(k + 2) % 3]] - p;
      const Vec3<double> twice_area = accurate_cross(a, b), plane = unit(twice_area);
      if (!has_direction(plane)) continue;
      const double angle = angle_between(a, b);
      Sums& s = sums[sum];
      s[0] += plane, s[1] += twice_area, s[2] += angle * plane, s[3] += angle * twice_area;
      s[4] += twice_area / (dot(a, a) * dot(b, b));
    }
  std::vector<bool> result = lie_in_normal_cones(mesh, joins, vertices);
  for (std::uint32_t v = 0; v < n; ++v)
    if (vertices[v]) {
      const double limit = (within_deg.empty() ? average_deg : within_deg[v]) / degrees_per_radian;
      for (const Vec3<double>& sum : sums[sum_of_group[joins.position_and_normal[v]]])
        if (has_direction(sum) && angle_between(mesh.normals[v], sum) <= limit) result[v] = true;
    }
  return result;
}

double followed_deg(double deg) {
  return std::clamp(0.5 * deg, 1.0, 30.0);
}

}  // namespace darboux
