/// \file connectivity.h
/// MikkTSpace's internal mesh: vertices welded, degenerate triangles separated, links across edges, and the
/// contribution of each corner to the sums.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <darboux/instruction_set.h>
#include <darboux/mikktspace.h>

#include "arithmetic.h"
#include "base/parallel.h"
#include "buffer.h"
#include "input.h"
#include "lanes.h"

namespace darboux::mikk {

constexpr Index none = ~Index{0};

// The size of a hash table with room for all vertices.
constexpr std::size_t weld_places(std::size_t vertices) {
  return std::bit_ceil(vertices + vertices / 2 + 1);
}

// A second thread is used from this number on: of vertices to weld, triangles, vertices to compute, vertices
// whose corners are counted.
constexpr std::size_t least_welded = 4096, least_triangles = 2048, least_served = 1024,
                      least_counted = 1 << 14;

// Ids are assigned to each range of vertices a few at a time, so some stay unused.
constexpr Index ids_at_a_time = 256;
constexpr std::size_t most_ids(std::size_t vertices, std::size_t threads) {
  return vertices + ids_at_a_time * range_count(vertices, threads, least_welded);
}

// In a run of equal edges, each takes the first remaining edge after it that passes the other way: pair(i,
// j). Edges leave a vertex or arrive there.
template <class Leaves, class Pair>
void pair_up(std::size_t run, const Leaves& leaves, const Pair& pair, std::vector<std::uint8_t>& taken) {
  if (run < 2) return;
  if (run == 2) {  // nearly always
    if (leaves(0) != leaves(1)) pair(0, 1);
    return;
  }
  taken.assign(run, 0);
  std::array<std::size_t, 2> ahead{0, 0};  // per direction, the first that may remain
  for (std::size_t i = 0; i < run; ++i) {
    if (taken[i] != 0) continue;
    std::size_t& j = ahead[leaves(i) ? 1 : 0];
    for (j = std::max(j, i + 1); j < run && (leaves(j) == leaves(i) || taken[j] != 0);) ++j;
    if (j == run) continue;
    taken[i] = taken[j] = 1;
    pair(i, j);
  }
}

// The hash of a vertex, also for tests: the search in the table begins at its low bits.
std::uint64_t weld_hash(const MikkMesh& mesh, std::size_t v);

// The kernels of an instruction set; for `points`, those of the baseline.
const LaneKernels& lanes_of(InstructionSet set);

// Complete when the constructor returns; read only from then on.
struct Connectivity {
  // `lengths` says whether these are requested. All arrays are in `memory`.
  Connectivity(const MikkMesh& mesh, const Range& range, const LaneKernels& lanes, const MikkOptions& options,
               bool lengths, Memory& memory);

  Index vertex(std::size_t corner) const {
    return mesh_.corners.empty() ? static_cast<Index>(corner) : mesh_.corners[corner];
  }
  Vector position(Index v) const {
    const float* p = &mesh_.positions[3 * std::size_t{v}];
    return {p[0], p[1], p[2]};
  }
  // `at` is 3 t + k for the k-th corner of the t-th triangle, in the order in which the original works on
  // them.
  std::size_t corner(std::size_t at) const { return corner_.empty() ? at : corner_[at]; }
  Index welded(std::size_t at) const { return welded_[at]; }
  // The vertex whose values a corner takes: the representative of all vertices welded to it. Signs of zeros
  // may differ.
  Index source(std::size_t at) const { return mixed_zeros_ ? stands_for_[welded(at)] : vertex(corner(at)); }
  std::size_t face(std::size_t triangle) const { return face_.empty() ? triangle : face_[triangle]; }
  static std::size_t next(std::size_t at) { return at % 3 == 2 ? at - 2 : at + 1; }
  static std::size_t previous(std::size_t at) { return at % 3 == 0 ? at + 2 : at - 1; }
  std::span<const Index> corners_at(Index id) const {
    return {at_vertex_.data() + begin_[id], at_vertex_.data() + begin_[id + 1]};
  }
  Index corner_at(Index id, Index triangle) const {
    const Index at = 3 * triangle;
    return welded(at) == id ? at : welded(at + 1) == id ? at + 1 : at + 2;
  }
  // The place of a corner among those of its vertex.
  Index place_at(Index id, Index at) const {
    const std::span<const Index> corners = corners_at(id);
    return static_cast<Index>(std::lower_bound(corners.begin(), corners.end(), at) - corners.begin());
  }
  std::size_t listed(std::size_t entry) const { return cut_.empty() ? entry : cut_[entry]; }

  void weld();
  template <class Access>
  bool weld_with(std::span<std::uint64_t> table, std::size_t most_steps);
  void list_triangles();
  void set_degenerate_apart();
  void weld_corners();
  void list_corners();
  // Triangles are linked at a vertex across an edge that they pass in opposite directions; if there are more
  // than two, each takes the first that remains, in the order of the triangles.
  struct Links {
    std::vector<Index> after, before;  // of each corner at the vertex, the place of that across the edge that
                                       // begins there and across that which ends there; or none
    std::vector<std::uint64_t> keys;
    std::vector<std::uint8_t> taken;
  };
  void find_links(Index id, Links& links) const;
  // An edge in the last run. It replaces what find_links() would find.
  struct LastEdge {
    Index at, neighbour;  // the corner where it begins; the triangle across, or none
  };
  bool is_at_last_edge(Index id) const;
  void link_last_edges(Index id, Links& links) const;
  void find_representatives(std::span<const Index> wanted);
  void take_values_of_representatives();
  void bound_representatives(std::span<Index> first, std::span<Index> last) const;
  std::vector<Index> candidates_for_the_last_run();
  void find_last_edges();
  void differentiate(bool lengths);
  void orient_any();
  // Parts of the corners at one vertex. `parts` may have room for more.
  void find_parts(std::span<const Index> corners, std::vector<Part>& parts) const;

  const MikkMesh& mesh_;
  Range range_;
  std::size_t threads_;
  const LaneKernels& lanes_;
  Memory& memory_;
  std::span<std::byte> scratch_;    // of the welding, then of the corners, then of the representatives, then
                                    // of the directions
  std::size_t ids_ = 0;             // some may be unused
  bool joined_ = false;             // some vertices are welded
  bool mixed_zeros_ = false;        // some of the vertices with one id have zeros of other signs
  bool any_ = false;                // some triangle is `any`
  std::span<Index> id_;             // per vertex: equal for equal vertices; its value affects no result
  std::span<Index> stands_for_;     // per id: a vertex with it, whose values count
  std::span<Index> corner_;         // of the triangles; empty: in order
  std::span<Index> face_;           // of the triangles; empty: in order
  std::span<Index> face_begin_;     // the first corner of each face; empty: all are triangles
  std::span<Index> cut_;            // the corners of the triangles in the order of the faces; empty: in order
  std::size_t all_ = 0, good_ = 0;  // triangles; the degenerate ones come last
  std::span<std::uint8_t> alone_;  // of each triangle: whether it is one of a quad of which one is degenerate
  std::span<Index>
      representative_;  // of each id, while that is needed: the corner by which the original knows it
  std::span<const Index> welded_;       // the id of each corner
  std::span<Index> begin_, at_vertex_;  // of each id: its corners in good triangles, ascending
  std::vector<LastEdge> last_edges_;    // ascending; few
  std::vector<Index> last_ids_;         // at their ends, ascending
  std::span<Directions> directions_;    // of the good triangles
  std::span<Orientation> orientation_;  // of the good triangles
  std::span<Lengths> lengths_;          // of the good triangles, if wanted
  std::span<Index> label_;              // of corners at vertices of `any` triangles: the first of their group
  std::span<std::uint8_t> labelled_;    // of ids: whether their corners have labels
};

}  // namespace darboux::mikk
