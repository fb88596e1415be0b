#pragma once

#include <vector>

#include <darboux/mesh.h>

namespace darboux {

// Whether any triangle uses the vertex, per vertex.
inline std::vector<bool> used_vertices(const Mesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) used[v] = true;
  return used;
}

}  // namespace darboux
