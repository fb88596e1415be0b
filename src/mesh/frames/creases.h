// Edges that two triangles share, and which of them are sharp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <darboux/mesh.h>

#include "mesh/edges.h"

namespace darboux {

// Faces that meet at a larger angle than this count as two surfaces. Neighbouring faces of an eight-sided
// tube, at 45 degrees, do not.
inline constexpr double crease_deg = 50;

struct SharedEdge {
  std::uint32_t triangle[2];
  std::uint32_t node[2];
  bool turned;  // both triangles pass it in the same direction: one is turned over
};

// Whether the faces meet at more than crease_deg. An edge of a triangle without area is not sharp.
bool is_sharp(const Mesh& mesh, const SharedEdge& edge);

// For each edge between two nodes, calls f(SharedEdge) for successive triangles of its list; node(t, k) is
// the node of corner k of triangle t.
template <class Node, class F>
void for_each_shared_edge(std::size_t triangles, std::size_t nodes, const Node& node, F f) {
  struct Edge {
    std::uint32_t greater, triangle;
    bool up;  // from the smaller node to the greater
  };
  const EdgesByNode by_node(triangles, nodes, node);
  std::vector<Edge> edges;
  for (std::uint32_t smaller = 0; smaller < by_node.nodes(); ++smaller) {
    edges.clear();
    for (const std::uint32_t edge : by_node[smaller]) {
      const std::uint32_t t = edge / 3, a = node(t, edge % 3), b = node(t, (edge + 1) % 3);
      if (a != b) edges.push_back({std::max(a, b), t, a < b});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return a.greater != b.greater ? a.greater < b.greater : a.triangle < b.triangle;
    });
    for (std::size_t i = 1; i < edges.size(); ++i) {
      const Edge &a = edges[i - 1], &b = edges[i];
      if (a.greater == b.greater) f(SharedEdge{{a.triangle, b.triangle}, {smaller, a.greater}, a.up == b.up});
    }
  }
}

}  // namespace darboux
