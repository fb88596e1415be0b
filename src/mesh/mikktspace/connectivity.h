/// \file connectivity.h
/// A mesh as MikkTSpace works on it: vertices welded, degenerate triangles apart, neighbours across edges,
/// what each corner adds to the sums.
#pragma once

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

// Of a hash table that has room for all vertices.
constexpr std::size_t weld_places(std::size_t vertices) {
  return std::bit_ceil(vertices + vertices / 2 + 1);
}

// Ids are handed out a few at a time to each range of vertices, so that some are left unused.
constexpr Index ids_at_a_time = 256;
constexpr std::size_t most_ids(std::size_t vertices, std::size_t threads) {
  return vertices + ids_at_a_time * range_count(vertices, threads);
}

// Of a vertex, for its test: its low bits are where the search in the table begins.
std::uint64_t weld_hash(const MikkMesh& mesh, std::size_t v);

// Of `points` those of the baseline.
const LaneKernels& lanes_of(InstructionSet set);

// All of it stands when the constructor is done, and is only read then.
struct Connectivity {
  // `lengths` says whether these are wanted. Everything lies in `memory`.
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
  Index welded(std::size_t at) const { return id_[vertex(corner(at))]; }
  // The vertex whose values a corner has: the one that stands for all welded to it, whose zeros may have
  // other signs.
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
  std::size_t listed(std::size_t entry) const { return cut_.empty() ? entry : cut_[entry]; }

  void weld();
  template <class Access>
  bool weld_with(std::span<std::uint64_t> table, std::size_t most_steps);
  void list_triangles();
  void set_degenerate_apart();
  void list_corners();
  void find_neighbours();
  struct Edge {
    Index other, at;  // the vertex at its other end; the corner where it begins in its triangle
    bool leaves;      // the vertex at this end
  };
  // Each edge of a run of equal ones takes the first after it that is left and passes the other way.
  void pair_up(std::span<const Edge> run);
  void find_representatives(std::span<const Index> wanted);
  void take_values_of_representatives();
  void bound_representatives(std::span<Index> first, std::span<Index> last) const;
  std::vector<Index> candidates_for_the_last_run();
  void find_last_neighbours();
  void differentiate(bool lengths);
  void orient_any();
  // Of corners at one vertex. There may be room for more.
  void find_parts(std::span<const Index> corners, std::vector<Part>& parts) const;

  const MikkMesh& mesh_;
  Range range_;
  std::size_t threads_;
  const LaneKernels& lanes_;
  Memory& memory_;
  std::span<std::byte> scratch_;    // of the welding, then of the corners, then of the representatives, then
                                    // of the directions
  std::size_t ids_ = 0;             // some may not be used
  bool mixed_zeros_ = false;        // some of the vertices with one id have zeros of other signs
  bool any_ = false;                // some triangle is `any`
  std::span<Index> id_;             // of each vertex: equal ones have the same; which, no result depends on
  std::span<Index> stands_for_;     // of each id: a vertex that has it, whose values count
  std::span<Index> corner_;         // of the triangles; empty: in order
  std::span<Index> face_;           // of the triangles; empty: in order
  std::span<Index> face_begin_;     // the first corner of each face; empty: all are triangles
  std::span<Index> cut_;            // the corners of the triangles in the order of the faces; empty: in order
  std::size_t all_ = 0, good_ = 0;  // triangles; the degenerate ones come last
  std::span<std::uint8_t> alone_;  // of each triangle: whether it is one of a quad of which one is degenerate
  std::span<Index>
      representative_;  // of each id, while that is needed: the corner by which the original knows it
  std::span<Index> begin_, at_vertex_;  // of each id: its corners in good triangles, ascending
  std::span<Index> neighbour_;          // of each good triangle: across the edges that begin at its corners
  std::span<Directions> directions_;    // of the good triangles
  std::span<Orientation> orientation_;  // of the good triangles
  std::span<Lengths> lengths_;          // of the good triangles, if wanted
  std::span<Index> label_;              // of corners at vertices of `any` triangles: the first of their group
  std::span<std::uint8_t> labelled_;    // of ids: whether their corners have labels
};

}  // namespace darboux::mikk
