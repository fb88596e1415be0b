// Which way a triangle's uvs wind, found once for all that ask; mesh_classes.cpp has the bodies.
#pragma once

#include <span>
#include <vector>

#include <darboux/mesh_classes.h>

#include "vertex_joins.h"

namespace darboux {

// The raw sign of each triangle, 0 without uv area.
std::vector<signed char> triangle_signs(const Mesh& mesh);

// The public one, with the signs at hand. \param joins what it joins on the way is put there
MeshClasses classify(const Mesh& mesh, const std::vector<bool>& is_pole, std::span<const signed char> signs,
                     VertexJoins& joins);

}  // namespace darboux
