// Normals that were taken from another surface on purpose: leaves and grass lit like the crown or the ground,
// rocks that blend into a terrain.
#pragma once

#include <vector>

#include <darboux/mesh.h>

#include "mesh/vertex_joins.h"

namespace darboux {

// Which of the vertices with unsupported normals may have transferred ones. Two conditions hold. The normals
// continue smoothly to all neighbours of all unsupported vertices around. And the piece is a card, at least
// half of whose vertices lie on its border, or it is curved and its normals turn less than the surface does,
// without being all the same. If the normals of a region are negated, they jump at its edge; if those of a
// whole piece are rotated together, they turn as much as the surface. A curved card whose normals are all
// negated is refused, too; on a flat card nothing shows whether they are negated.
// \param has_area triangles with area \param unsupported of vertices
// \param sheet_border those at the borders of sheets that lie back to back
std::vector<bool> may_be_transferred(const Mesh& mesh, const std::vector<bool>& has_area,
                                     const VertexJoins& joins, const std::vector<bool>& unsupported,
                                     const std::vector<bool>& sheet_border);

}  // namespace darboux
