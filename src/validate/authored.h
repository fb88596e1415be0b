// Where deviations from a recognised surface may be deliberate.
#pragma once

#include <vector>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

// Vertices at borders, seams and creases, and vertices beyond their limit that a path of triangle edges joins
// to a border or crease, if along it, from there on, the normals come nearer to the surface's by at least a
// tenth at each step: people blend the normals of what comes next into a surface, as the ground's into a
// rock's.
std::vector<bool> may_be_authored(const MeshUnderTest& under_test, const Accurate& accurate);

}  // namespace darboux
