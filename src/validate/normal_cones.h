// The cone of the normals about a vertex.
#pragma once

#include <span>
#include <vector>

#include <darboux/mesh.h>

#include "mesh/vertex_joins.h"

namespace darboux {

// Whether the normals of requested vertices are averages of their own triangles' normals: with any positive
// weights, or within a degree of an average by a usual weighting: equal weights, area, angle, both, or
// sin(angle)/(|e1| |e2|) as in [Max1999]. \param within_deg the limit per vertex in place of that degree; the
// cone is tested in any case; empty: a degree
std::vector<bool> are_average_normals(const Mesh& mesh, const VertexJoins& joins,
                                      const std::vector<bool>& vertices,
                                      std::span<const double> within_deg = {});

// How far from an average a normal may be that follows its triangles rather than a reference that it is
// deg from: half as far, 1 to 30 degrees.
double followed_deg(double deg);

}  // namespace darboux
