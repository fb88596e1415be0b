// Where a file's surface is cut into primitives, as at the borders of materials.
#pragma once

#include <span>
#include <vector>

#include <darboux/io.h>

namespace darboux {

// For each primitive the triangles of others that share a vertex with it, by position and normal: those of
// the same mesh, or of meshes of the same name in the same places, as other formats than glTF cut them. Only
// of primitives with the same attributes. Places that more than 8 primitives share are no border, and are
// left out. Cost: linear, and nothing where each mesh has one primitive.
std::vector<Mesh> triangles_beside(std::span<const Primitive> primitives);

}  // namespace darboux
