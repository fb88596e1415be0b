// Normals that are blended from where a recognised surface ends into the surface, as those of a rock are into
// the ground's.
#pragma once

#include <vector>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

// Which vertices lie at a border, seam or crease, or are beyond their limit and have a way there, over edges
// of triangles, along which normals are ever farther from the surface's, by a tenth at each step.
std::vector<bool> blended_vertices(const MeshUnderTest& under_test, const Accurate& accurate);

// Where people give a surface the normals of what comes next.
inline bool ends_at(VertexClass c) {
  return c == VertexClass::border || c == VertexClass::seam || c == VertexClass::crease;
}

}  // namespace darboux
