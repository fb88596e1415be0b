// Which way a triangle's uvs wind, found once for all that ask.
#pragma once

#include <vector>

#include <darboux/mesh.h>

namespace darboux {

// The raw sign of each triangle, 0 without uv area.
std::vector<signed char> triangle_signs(const Mesh& mesh);

}  // namespace darboux
