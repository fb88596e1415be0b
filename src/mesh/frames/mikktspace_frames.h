/// \file mikktspace_frames.h
/// What the method "mikktspace" gives corners, in single precision and without the frames.
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

/// The t and the raw sign that mesh_frames() gives each corner by "mikktspace", t rounded to float: bit for
/// bit; by corner where corners are the vertices. Takes 16 bytes per vertex beside mikktspace(), or per
/// corner where triangles are degenerate or their uvs have no area; mesh_frames() takes 130 per corner.
/// \param mesh triangles whose numbers are finite, and neither all positions nor all uvs below 2^-100 \throws
/// as mikktspace()
MikktspaceTangents mikktspace_tangents(const MikkMesh& mesh, int threads);

}  // namespace darboux
