#include "normal_cones.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>

#include <darboux/frame.h>
#include <darboux/mesh_frames.h>

#include "angles.h"

namespace darboux {
namespace {

using Normals = std::vector<Vec3<double>>;

constexpr double tolerance = 1e-3;  // the sine of how far outside the cone rounding may leave a normal
// Of normals each three are looked at: where many meet at a tip, then of those that are apart.
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

// A point of a cone lies in that of three of its directions, or on the arc of two, by Caratheodory. Of a
// sheet with a back the cone is everything, and tells nothing.
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

}  // namespace

std::vector<bool> lie_in_normal_cones(const Mesh& mesh, const VertexJoins& joins,
                                      const std::vector<bool>& vertices) {
  struct Group {
    Normals normals{};
    std::optional<bool> between{};
  };
  std::map<std::uint32_t, Group> groups;  // by what joins vertices of one place and normal
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    if (vertices[v]) groups[joins.position_and_normal[v]];
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      const auto found = groups.find(joins.position_and_normal[v]);
      if (found == groups.end() || found->second.normals.size() >= most_normals) continue;
      Normals& kept = found->second.normals;
      const Vec3<double>& p = mesh.positions[t[0]];
      const Vec3<double> plane = unit(accurate_cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p));
      const double as_near = kept.size() < many ? alike : near;
      if (dot(plane, plane) > 0.5 && std::none_of(kept.begin(), kept.end(), [&](const auto& other) {
            return dot(other, plane) > as_near;
          }))
        kept.push_back(plane);
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

}  // namespace darboux
