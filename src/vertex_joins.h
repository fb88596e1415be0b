// Which vertices are the same, found once for all that ask; mesh_classes.cpp has the body.
#pragma once

#include <cstdint>
#include <vector>

#include <darboux/mesh.h>

namespace darboux {

// For each vertex the first that counts as the same, in the sense of MeshClasses. Vertices that no triangle uses stand alone.
struct VertexJoins {
  std::vector<std::uint32_t> position;
  std::vector<std::uint32_t> position_and_normal;
};

}  // namespace darboux
