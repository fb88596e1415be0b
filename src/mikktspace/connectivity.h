/// \file connectivity.h
/// A mesh as MikkTSpace works on it: vertices welded, degenerate triangles apart, derivatives of each triangle, neighbours
/// across edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <darboux/mikktspace.h>

#include "../pieces.h"
#include "arithmetic.h"

namespace darboux::mikk {

using Index = std::uint32_t;
constexpr Index none = ~Index{0};

// What is known of a triangle that is not degenerate.
struct Derivatives {
  Vector s, t;  // unit directions in which u and v grow, unless `any`
  float s_length = 0, t_length = 0;
  bool preserves = false;  // orientation: the uvs wind as the triangle does
  bool any = false;        // joins groups of either orientation: its uvs have no area, or s or t no length
};

// All of it stands when the constructor is done, and is only read then.
struct Connectivity {
  Connectivity(const MikkMesh& mesh, const MikkOptions& options)
      : mesh_(mesh), threads_(thread_count(options.threads)) {
    weld();
    list_triangles();
    name_as_the_original();
    set_degenerate_apart();
    differentiate();
    list_corners();
    find_neighbours();
    if (!options.sort_all_edges && good_ > 0) find_last_neighbours();
    orient_any();
  }

  Index vertex(std::size_t corner) const {
    return mesh_.corners.empty() ? static_cast<Index>(corner) : mesh_.corners[corner];
  }
  static Vector vector(std::span<const float> x, std::size_t i) {
    return {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
  }
  Vector position(Index v) const { return vector(mesh_.positions, v); }
  // `at` is 3 t + k for the k-th corner of the t-th triangle, in the order in which the original works on them.
  std::size_t corner(std::size_t at) const { return corner_.empty() ? at : corner_[at]; }
  Index welded(std::size_t at) const { return same_as_[vertex(corner(at))]; }
  // Whose values a corner has: those of the vertex it is welded to, whose zeros may have other signs.
  Index source(std::size_t at) const { return negative_zeros_ ? welded(at) : vertex(corner(at)); }
  std::size_t face(std::size_t triangle) const { return face_.empty() ? triangle : face_[triangle]; }
  static std::size_t next(std::size_t at) { return at % 3 == 2 ? at - 2 : at + 1; }
  static std::size_t previous(std::size_t at) { return at % 3 == 0 ? at + 2 : at - 1; }

  void weld();
  void list_triangles();
  void set_degenerate_apart();
  void differentiate();
  void list_corners();
  void find_neighbours();
  void orient_any();
  std::size_t listed(std::size_t entry) const { return cut_.empty() ? entry : cut_[entry]; }
  void name(const std::vector<std::uint8_t>* wanted, std::vector<Index>& names) const;
  void name_as_the_original();
  void find_last_neighbours();
  std::span<const Index> corners_at(Index v) const {
    return {at_vertex_.data() + begin_[v], at_vertex_.data() + begin_[v + 1]};
  }
  Index corner_at(Index v, Index triangle) const {
    const Index at = 3 * triangle;
    return welded(at) == v ? at : welded(at + 1) == v ? at + 1 : at + 2;
  }
  bool has_negative_zero(Index v) const;
  std::uint64_t hash(Index v) const;
  bool equal_vertices(Index a, Index b) const;

  const MikkMesh& mesh_;
  std::size_t threads_;
  bool negative_zeros_ = false;
  std::vector<Index> same_as_;      // of each vertex: the one that stands for all equal to it
  std::vector<Index> corner_;       // of the triangles; empty: in order
  std::vector<Index> face_;         // of the triangles; empty: in order
  std::vector<Index> face_begin_;   // the first corner of each face; empty: all are triangles
  std::vector<Index> cut_;          // the corners of the triangles in the order of the faces; empty: in order
  std::size_t all_ = 0, good_ = 0;  // triangles; the degenerate ones come last
  std::vector<std::uint8_t>
      alone_;  // of each triangle: whether it is one of a quad of which one is degenerate
  std::vector<Derivatives> derivatives_;  // of the good triangles
  std::vector<Index> begin_, at_vertex_;  // of each welded vertex: its corners in good triangles, ascending
  std::vector<Index> neighbour_;          // of each good triangle: across the edges that begin at its corners
  std::vector<Index> label_;            // of corners at vertices of `any` triangles: the first of their group
  std::vector<std::uint8_t> labelled_;  // of vertices: whether their corners have labels
};

}  // namespace darboux::mikk
