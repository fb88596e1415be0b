// The parts of a mesh: what a crease or a border of the chart cuts off.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "stages.h"
#include "validate/mesh_under_test.h"

namespace darboux {

// Cuts a mesh without copying it.
class Cutter {
 public:
  using Triangles = std::vector<std::uint32_t>;

  explicit Cutter(const MeshUnderTest& whole);
  Cutter(const Cutter&) = delete;
  Cutter& operator=(const Cutter&) = delete;

  // Triangles joined over edges whose vertices agree in position, normal and uv to the bit. Triangles whose
  // uvs wind differently are kept apart; those without uv area go with what they touch. \param at_creases
  // also cut at edges that are sharp by creases.h, though the vertices agree. Pieces are in the order of
  // their first triangles. \param triangles of the whole, ascending
  std::vector<Triangles> pieces(const Triangles& triangles, bool at_creases);

  // The mesh of some triangles.
  MeshPart part(Triangles triangles);

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  // The number of a vertex, counted in order of appearance since the last forget().
  std::uint32_t number(std::uint32_t vertex);
  void forget();

  const MeshUnderTest& whole_;
  std::vector<std::uint32_t> joined_;     // where the whole has none
  std::span<const std::uint32_t> equal_;  // join_equal_vertices()
  std::vector<std::uint32_t> number_;     // of each vertex that was seen, else none
  std::vector<std::uint32_t> seen_;
};

using UvSets = std::vector<std::pair<int, std::vector<Vec2<double>>>>;

// The uv sets of the whole, at the part's vertices.
UvSets restrict_to(std::span<const UvSets::value_type> whole, const MeshPart& part);

// Vertices that belong to two parts whose frames differ: no one normal, or no one tangent, is right for both.
// A vertex is that of another part where positions and normals are the same; uvs may differ, and so may the
// indices, as in files with one vertex per corner. \param parts those that are recognised and the rest
std::vector<bool> between_parts(const MeshUnderTest& whole, std::span<const MeshPart> parts,
                                double max_angle_deg);

}  // namespace darboux
