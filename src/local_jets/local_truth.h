// local_truth() of vertices that are joined already.
#pragma once

#include <darboux/local_truth.h>

#include "mesh/frames/rings.h"

namespace darboux {

// The public one. \param joined join_equal_vertices() \param by_uvs whether the mesh has uvs, and they count
std::vector<Truth> local_truth(const Mesh& mesh, std::span<const Index> joined, bool by_uvs);

}  // namespace darboux
