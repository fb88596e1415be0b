#include "triangles_beside.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace darboux {
namespace {

constexpr std::size_t most_sharing = 8;

using Place = std::array<std::uint64_t, 6>;  // the bits of a position and a normal

struct Hash {
  std::size_t operator()(const Place& place) const {
    std::uint64_t hash = 0;
    for (const std::uint64_t x : place) {
      hash = (hash ^ x) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

Place place_of(const Mesh& mesh, std::uint32_t v) {
  const Vec3<double>&p = mesh.positions[v], &n = mesh.normals[v];
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };  // -0 is 0
  return {bits(p.x), bits(p.y), bits(p.z), bits(n.x), bits(n.y), bits(n.z)};
}

// Some triangles of a mesh, with the vertices that they use.
class Excerpt {
 public:
  Excerpt(const Mesh& from, Mesh& to) : from_(from), to_(to) {}
  void add(const Triangle& triangle) {
    Triangle& taken = to_.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) taken[k] = vertex(triangle[k]);
  }

 private:
  std::uint32_t vertex(std::uint32_t v) {
    const auto [at, is_new] = number_.try_emplace(v, static_cast<std::uint32_t>(to_.positions.size()));
    if (!is_new) return at->second;
    to_.positions.push_back(from_.positions[v]);
    to_.normals.push_back(from_.normals[v]);
    if (!from_.uvs.empty()) to_.uvs.push_back(from_.uvs[v]);
    if (!from_.tangents.empty()) to_.tangents.push_back(from_.tangents[v]);
    return at->second;
  }

  const Mesh& from_;
  Mesh& to_;
  std::unordered_map<std::uint32_t, std::uint32_t> number_;
};

bool are_of_one_mesh(const Primitive& a, const Primitive& b) {
  return a.mesh == b.mesh || (!a.name.empty() && a.name == b.name && a.instances == b.instances);
}

bool have_same_attributes(const Mesh& a, const Mesh& b) {
  return a.uvs.empty() == b.uvs.empty() && a.tangents.empty() == b.tangents.empty();
}

// \param group primitives of one mesh, with the same attributes
void add_triangles(std::span<const Primitive> primitives, std::span<const std::size_t> group,
                   std::vector<Mesh>& beside) {
  std::unordered_map<Place, std::vector<std::size_t>, Hash>
      sharing;  // of each place its primitives, ascending
  for (const std::size_t i : group) {
    const Mesh& mesh = primitives[i].data;
    std::vector<bool> seen(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) {
        if (seen[v]) continue;
        seen[v] = true;
        std::vector<std::size_t>& those = sharing[place_of(mesh, v)];
        if (those.size() <= most_sharing && (those.empty() || those.back() != i)) those.push_back(i);
      }
  }
  for (const std::size_t i : group) {
    const Mesh& mesh = primitives[i].data;
    std::map<std::size_t, Excerpt> excerpts;
    for (const Triangle& triangle : mesh.triangles) {
      std::vector<std::size_t> others;
      for (const std::uint32_t v : triangle) {
        const std::vector<std::size_t>& those = sharing[place_of(mesh, v)];
        if (those.size() > 1 && those.size() <= most_sharing)
          others.insert(others.end(), those.begin(), those.end());
      }
      std::sort(others.begin(), others.end());
      others.erase(std::unique(others.begin(), others.end()), others.end());
      for (const std::size_t other : others)
        if (other != i) excerpts.try_emplace(other, mesh, beside[other]).first->second.add(triangle);
    }
  }
}

}  // namespace

std::vector<Mesh> triangles_beside(std::span<const Primitive> primitives) {
  std::vector<Mesh> result(primitives.size());
  std::map<std::tuple<std::size_t, bool, bool>, std::vector<std::size_t>> groups;
  std::map<std::string, std::size_t> named;  // the first of each name
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Primitive& p = primitives[i];
    if (p.data.normals.empty()) continue;
    const std::size_t first = p.name.empty() ? i : named.try_emplace(p.name, i).first->second;
    const bool same = first != i && are_of_one_mesh(primitives[first], p);
    groups[{same ? primitives[first].mesh : p.mesh, p.data.uvs.empty(), p.data.tangents.empty()}].push_back(
        i);
  }
  for (const auto& [key, group] : groups)
    if (group.size() > 1) add_triangles(primitives, group, result);
  return result;
}

}  // namespace darboux
