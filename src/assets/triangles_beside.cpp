#include "triangles_beside.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "mesh/quads.h"
#include "mesh/stored_rounding.h"

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

// Some triangles of a mesh with their vertices, to be appended to another mesh.
class Excerpt {
 public:
  Excerpt(const Mesh& from, Mesh& to) : from_(from), to_(to) {
    to.half_steps = larger_of(to.half_steps, from.half_steps);
  }
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

// Primitives of one mesh with the same attributes, and where they meet.
class Group {
 public:
  Group(std::span<const Primitive> primitives, std::span<const std::size_t> group)
      : primitives_(primitives), group_(group), places_(group.size()), whole_(group.size()) {
    std::unordered_map<Place, std::uint32_t, Hash> numbers;
    for (std::uint32_t i = 0; i < group.size(); ++i) {
      const Mesh& mesh = mesh_of(i);
      places_[i].assign(mesh.positions.size(), none);
      for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t v : triangle) {
          if (places_[i][v] != none) continue;
          places_[i][v] = numbers.try_emplace(place_of(mesh, v), static_cast<std::uint32_t>(numbers.size()))
                              .first->second;
          note(places_[i][v], i);
        }
    }
    for (std::uint32_t i = 0; i < group.size(); ++i)
      for (const Triangle& triangle : mesh_of(i).triangles)
        if (const Triangle at = sorted_places(i, triangle);
            sharing_.count(at[0]) > 0 && sharing_.count(at[1]) > 0 && sharing_.count(at[2]) > 0)
          whole_[i].insert(at);
  }

  void add_to(std::vector<Mesh>& beside) const {
    for (std::uint32_t i = 0; i < group_.size(); ++i) {
      const std::vector<Triangle>& triangles = mesh_of(i).triangles;
      std::map<std::uint32_t, Excerpt> excerpts;
      for (std::size_t t = 0; t < triangles.size(); ++t) {
        // Both halves of a quad: normals and tangents may be averaged over quads.
        const bool quad = t + 1 < triangles.size() && quad_of(triangles[t], triangles[t + 1]);
        const auto face = std::span(triangles).subspan(t, quad ? 2 : 1);
        for (const std::uint32_t other : others_at(i, face)) {
          Excerpt& excerpt = excerpts.try_emplace(other, mesh_of(i), beside[group_[other]]).first->second;
          for (const Triangle& triangle : face)
            if (whole_[other].count(sorted_places(i, triangle)) == 0) excerpt.add(triangle);
        }
        t += quad;
      }
    }
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  const Mesh& mesh_of(std::uint32_t i) const { return primitives_[group_[i]].data; }

  void note(std::uint32_t place, std::uint32_t i) {
    if (place == first_.size()) {
      first_.push_back(i);
    } else if (first_[place] != i) {
      std::vector<std::uint32_t>& those = sharing_.try_emplace(place, 1, first_[place]).first->second;
      if (those.size() <= most_sharing && those.back() != i) those.push_back(i);
    }
  }

  Triangle sorted_places(std::uint32_t i, const Triangle& triangle) const {
    Triangle at{places_[i][triangle[0]], places_[i][triangle[1]], places_[i][triangle[2]]};
    std::sort(at.begin(), at.end());
    return at;
  }

  std::vector<std::uint32_t> others_at(std::uint32_t i, std::span<const Triangle> face) const {
    std::vector<std::uint32_t> others;
    for (const Triangle& triangle : face)
      for (const std::uint32_t v : triangle)
        if (const auto at = sharing_.find(places_[i][v]);
            at != sharing_.end() && at->second.size() <= most_sharing)
          others.insert(others.end(), at->second.begin(), at->second.end());
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    others.erase(std::remove(others.begin(), others.end(), i), others.end());
    return others;
  }

  std::span<const Primitive> primitives_;
  std::span<const std::size_t> group_;
  std::vector<std::vector<std::uint32_t>>
      places_;                        // of each member's vertices: numbers of position and normal
  std::vector<std::uint32_t> first_;  // of each place, the first member there
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> sharing_;  // places of several: all members
  std::vector<std::set<Triangle>> whole_;  // of each member its triangles between such places, sorted
};

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
    if (group.size() > 1) Group(primitives, group).add_to(result);
  return result;
}

}  // namespace darboux
