// The parts of a mesh, cut at creases and at the borders of charts.
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
  // uvs wind differently are kept apart; those without uv area join a neighbour. Pieces are in the order of
  // their first triangles. \param at_creases also cut at edges that creases.h calls sharp, even if the
  // vertices agree \param triangles of the whole, ascending
  std::vector<Triangles> pieces(const Triangles& triangles, bool at_creases);

  // Makes a mesh of some triangles.
  MeshPart part(Triangles triangles);

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  // The number of a vertex, counted in order of appearance since the last forget().
  std::uint32_t number(std::uint32_t vertex);
  void forget();

  const MeshUnderTest& whole_;
  std::vector<std::uint32_t> joined_;     // if the whole has none
  std::span<const std::uint32_t> equal_;  // join_equal_vertices()
  std::vector<std::uint32_t> number_;     // per vertex that was seen, else none
  std::vector<std::uint32_t> seen_;
};

using UvSets = std::vector<std::pair<int, std::vector<Vec2<double>>>>;

// The uv sets of the whole, at the part's vertices.
UvSets restrict_to(std::span<const UvSets::value_type> whole, const MeshPart& part);

// Vertices that belong to two parts whose frames differ: no single normal, or no single tangent, is right for
// both. Vertices of two parts are the same if their positions and normals are; uvs may differ, and so may the
// indices, as in files with one vertex per corner. \param parts the recognised ones and the rest
std::vector<bool> between_parts(const MeshUnderTest& whole, std::span<const MeshPart> parts,
                                double max_angle_deg);

}  // namespace darboux
