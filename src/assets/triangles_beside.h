// Finds adjacent triangles where a surface is divided into primitives, as at the borders of materials.
#pragma once

#include <span>
#include <vector>

#include <darboux/io.h>

namespace darboux {

// For each primitive, the triangles of other primitives that share a vertex with it, by position and normal.
// Considered are primitives with the same attributes of the same mesh, or of meshes with the same name and
// placement, as formats other than glTF divide them. Positions shared by more than 8 primitives are not
// borders and are ignored. Cost: linear; zero if each mesh has one primitive.
std::vector<Mesh> triangles_beside(std::span<const Primitive> primitives);

}  // namespace darboux
