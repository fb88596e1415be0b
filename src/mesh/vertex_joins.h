// Which vertices are the same, computed once for all users; the body is in mesh_classes.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <darboux/mesh_classes.h>

namespace darboux {

// For each vertex, the first that counts as the same, in the sense of MeshClasses. Vertices that no triangle
// uses stand alone.
struct VertexJoins {
  std::vector<std::uint32_t> position;
  std::vector<std::uint32_t> position_and_normal;
};

VertexJoins join_vertices(const Mesh& mesh);

// The public classify() with data that are already known. \param signs triangle_signs() \param joins
// join_vertices()
MeshClasses classify(const Mesh& mesh, const std::vector<bool>& is_pole, std::span<const signed char> signs,
                     const VertexJoins& joins);

}  // namespace darboux
