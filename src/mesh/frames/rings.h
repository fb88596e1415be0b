// The vertices about a vertex, ring by ring.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <darboux/mesh_frames.h>

namespace darboux {

using Index = std::uint32_t;

// For each vertex, the first with the same position, normal and, if requested, uv.
std::vector<Index> join_equal_vertices(const Mesh& mesh, bool by_uvs = true);

// A node is one or more vertices that agree in position, uv and normal. Such vertices make two nodes if their
// triangles' uvs wind differently (without uvs all wind alike), and one node per fan of triangles connected
// by edges: charts, such as the six of a cube, may have equal uvs where they meet.
class Rings {
 public:
  explicit Rings(const Mesh& mesh) : Rings(mesh, join_equal_vertices(mesh)) {}
  // \param joined join_equal_vertices() \param by_uvs whether the mesh has uvs that are to be used
  Rings(const Mesh& mesh, std::span<const Index> joined, bool by_uvs = true);

  std::size_t size() const { return wound() + split_from_.size(); }
  bool used(Index node) const { return begin_[node] != begin_[node + 1]; }
  Index vertex(Index node) const { return whole(node) / 2; }  // the first of the joined vertices
  const Vec3<double>& position(Index node) const { return mesh_.positions[vertex(node)]; }
  const Vec2<double>& uv(Index node) const { return mesh_.uvs[vertex(node)]; }
  double sign(Index node) const { return whole(node) % 2 == 1 ? 1 : -1; }

  // Nodes up to a number of edges away from `near.front()`, appended ring by ring; ends[r] is where ring r
  // ends.
  // The first ring is complete. Later ones stop at most_nodes, and continue from a node over at most
  // most_triangles of its triangles, spread evenly: every vertex on the rim of a fan reaches its centre,
  // which would cost the square of its triangles.
  struct Walk {
    std::vector<Index> near;
    std::vector<std::size_t> ends;
    std::vector<Index> seen;  // per node: the last start that reached it
    Index starts = 0;
  };
  void start(Index node, Walk& walk) const;
  // From now on, walks end at edges that creases.h calls sharp; do not start one there.
  void stop_at_creases();
  bool at_crease(Index node) const { return !at_crease_.empty() && at_crease_[node]; }
  void grow(Walk& walk) const;
  static constexpr std::size_t most_nodes = 128, most_triangles = 32;

  MeshFrames frames;  // counts and of_corner; the frames of nodes are to be filled in

 private:
  std::size_t wound() const { return 2 * mesh_.positions.size(); }
  Index whole(Index node) const { return node < wound() ? node : split_from_[node - wound()]; }
  void list_triangles(const std::vector<bool>& good);
  void split_fans(const std::vector<bool>& good);

  const Mesh& mesh_;
  std::vector<Index> split_from_;         // per further node of a vertex and winding: the first one
  std::vector<Index> begin_, triangles_;  // per node: its triangles
  std::vector<Triangle> nodes_;           // of each triangle
  std::vector<bool> at_crease_;           // of each node
};

}  // namespace darboux
