// The parts of a mesh: what a crease or a border of the chart cuts off.
#pragma once

#include "mesh_under_test.h"

namespace darboux {

// Triangles joined over edges whose vertices agree in position, normal and uv to the bit; those whose uvs
// wind differently apart, those without area in uv with what they touch. \param at_creases also cut at edges
// that are sharp by creases.h, though the vertices agree. Parts are in the order of their first triangles.
std::vector<std::vector<std::uint32_t>> parts_of(const Mesh& mesh, bool at_creases);

using UvSets = std::vector<std::pair<int, std::vector<Vec2<double>>>>;

// Triangles of a mesh with the vertices they use.
struct Part {
  Mesh mesh;
  std::vector<std::uint32_t> vertices, triangles;  // of the whole mesh
};
Part part_of(const Mesh& whole, std::vector<std::uint32_t> triangles);

// What is known of the whole, for the part.
MeshUnderTest restrict_to(const MeshUnderTest& whole, const Part& part);

// The uv sets of the whole, at the part's vertices.
UvSets restrict_to(std::span<const UvSets::value_type> whole, const Part& part);

}  // namespace darboux
