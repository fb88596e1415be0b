// The cone of the normals about a vertex.
#pragma once

#include <vector>

#include <darboux/mesh.h>

#include "mesh/vertex_joins.h"

namespace darboux {

// Whether the normals of vertices that are asked about lie in the cone of their own triangles' normals:
// whether they are an average of these with positive weights, whatever these are. Blender weighs a quad's
// normal by its angle, which no weights of its two triangles do. At sharp ridges an average may be far from
// each of the triangles; a normal that was turned is none.
std::vector<bool> lie_in_normal_cones(const Mesh& mesh, const VertexJoins& joins,
                                      const std::vector<bool>& vertices);

}  // namespace darboux
