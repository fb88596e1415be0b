#include "normal_cones.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>

#include <darboux/frame.h>
#include <darboux/mesh_frames.h>

#include "angles.h"

namespace darboux {
namespace {

using Normals = std::vector<Vec3<double>>;

constexpr double tolerance = 1e-3;        // the sine of how far outside the cone rounding may leave a normal
constexpr std::size_t most_normals = 40;  // of which each three are looked at
constexpr double alike = 1 - 1e-6, opposite = 1 - 1e-4;  // cosines of 0.08 degrees and, of the rest, 0.8

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
      if (dot(of[i], of[j]) < -opposite) return false;
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
  std::map<std::uint32_t, Normals> normals;  // by what joins vertices of one place and normal
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    if (vertices[v]) normals[joins.position_and_normal[v]];
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      const auto about = normals.find(joins.position_and_normal[v]);
      if (about == normals.end() || about->second.size() >= most_normals) continue;
      const Vec3<double>& p = mesh.positions[t[0]];
      const Vec3<double> plane = unit(accurate_cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p));
      Normals& kept = about->second;
      if (dot(plane, plane) > 0.5 && std::none_of(kept.begin(), kept.end(), [&](const auto& other) {
            return dot(other, plane) > alike;
          }))
        kept.push_back(plane);
    }
  std::vector<bool> result(vertices.size(), false);
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    if (vertices[v]) result[v] = is_in_cone(unit(mesh.normals[v]), normals[joins.position_and_normal[v]]);
  return result;
}

}  // namespace darboux
