// The cone of the normals about a vertex.
#pragma once

#include <span>
#include <vector>

#include <darboux/mesh.h>

#include "mesh/vertex_joins.h"

namespace darboux {

// Whether the normals of vertices that are asked about are averages of their own triangles' normals: with any
// positive weights, or within a degree of each alike, by area, by angle, by both, or by sin(angle)/(|e1|
// |e2|) as [Max1999]. \param within_deg what to allow instead of that degree, per vertex, besides the cone;
// empty: a degree
std::vector<bool> are_average_normals(const Mesh& mesh, const VertexJoins& joins,
                                      const std::vector<bool>& vertices,
                                      std::span<const double> within_deg = {});

// How far from an average a normal may be that follows its triangles rather than a reference that it is
// deg from: half as far, 1 to 30 degrees.
double followed_deg(double deg);

}  // namespace darboux
