// local_truth() for vertices that are already joined.
#pragma once

#include <darboux/local_truth.h>

#include "mesh/frames/rings.h"

namespace darboux {

// Whether uvs determine a direction anywhere. \param signs of the triangles
bool has_uv_area(std::span<const signed char> signs);

// The public one. \param joined join_equal_vertices() \param by_uvs has_uv_area()
std::vector<Truth> local_truth(const Mesh& mesh, std::span<const Index> joined, bool by_uvs);

}  // namespace darboux
