// Where deviations from a recognised surface may be meant.
#pragma once

#include <vector>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

// Vertices at borders, seams and creases; and those beyond their limit that a way over edges of triangles
// joins to a border or crease, where normals are nearer to the surface's, by a tenth at least, at each step:
// people blend the normals of what comes next into a surface, as the ground's into a rock's.
std::vector<bool> may_be_authored(const MeshUnderTest& under_test, const Accurate& accurate);

}  // namespace darboux
