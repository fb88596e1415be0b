/// \file mikktspace_frames.h
/// The results of the method "mikktspace" per corner, in single precision and without the frames.
#pragma once

#include <cstddef>

#include <darboux/mikktspace.h>

#include "mesh/mikktspace/vertex_tangents.h"

namespace darboux {

/// As MeshFrames has them.
struct MikktspaceCounts {
  std::size_t degenerate_triangles = 0, degenerate_uv_triangles = 0, fallback_corners = 0;
};

struct MikktspaceTangents : mikk::VertexTangents {
  MikktspaceCounts counts;
};

/// The t and the raw sign that mesh_frames() gives each corner by "mikktspace", bit for bit after t is
/// rounded to float; stored by corner if corners are the vertices. Takes 16 bytes more than mikktspace() per
/// vertex, or per corner if triangles are degenerate or their uvs have no area; mesh_frames() takes 130 per
/// corner. \param mesh triangles whose numbers are finite, and neither all positions nor all uvs below 2^-100
/// \throws as mikktspace()
MikktspaceTangents mikktspace_tangents(const MikkMesh& mesh, int threads);

}  // namespace darboux
