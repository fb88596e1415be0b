// Edges that two triangles share, and which of them are sharp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <darboux/frame.h>
#include <darboux/mesh.h>

namespace darboux {

// Faces that meet at a larger angle than this are taken for two surfaces: more than those of a grid of eight around.
inline constexpr double crease_deg = 50;

struct SharedEdge {
  std::uint32_t triangle[2];
  std::uint32_t node[2];
  bool sharp;
};

// Calls f(SharedEdge) for each edge between the same two nodes and the triangles next to each other in its list; node(t, k) is
// that of corner k of triangle t. Triangles without area make no edge sharp.
template <class Node, class F>
void for_each_shared_edge(const Mesh& mesh, Node node, F f) {
  struct Edge {
    std::uint64_t key;
    std::uint32_t triangle;
    bool up;  // from the smaller node to the larger
  };
  std::vector<Edge> edges;
  edges.reserve(mesh.corners());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t a = node(t, k), b = node(t, (k + 1) % 3);
      if (a != b) edges.push_back({std::min(a, b) << 32 | std::max(a, b), t, a < b});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
  });
  const auto face = [&](std::uint32_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
  };
  const double limit = crease_deg * std::numbers::pi / 180;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Edge &a = edges[i - 1], &b = edges[i];
    if (a.key != b.key) continue;
    // Neighbours pass their edge in opposite directions, or one of them is turned over.
    const Vec3<double> n = face(a.triangle), m = a.up != b.up ? face(b.triangle) : -face(b.triangle);
    const bool areas = n != Vec3<double>{} && m != Vec3<double>{} && detail::finite(n) && detail::finite(m);
    f(SharedEdge{{a.triangle, b.triangle},
                 {static_cast<std::uint32_t>(a.key >> 32), static_cast<std::uint32_t>(a.key & 0xffffffffU)},
                 areas && angle_between(n, m) > limit});
  }
}

}  // namespace darboux
