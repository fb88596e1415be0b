// Where deviations from a recognised surface may be deliberate.
#pragma once

#include <vector>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

// Vertices at borders, seams and creases. Also vertices beyond their limit that a path of triangle edges
// connects to a border or crease, if the deviation of the normals falls by at least a tenth at each step away
// from there: people blend the normals of the adjoining surface into a surface, such as the ground's into a
// rock's.
std::vector<bool> may_be_authored(const MeshUnderTest& under_test, const Accurate& accurate);

}  // namespace darboux
