/// \file mikktspace_frames.h
/// What the method "mikktspace" gives corners, in single precision and without the frames.
#pragma once

#include <cstddef>
#include <span>

#include <darboux/mikktspace.h>

namespace darboux {

/// As MeshFrames has them.
struct MikktspaceCounts {
  std::size_t degenerate_triangles = 0, degenerate_uv_triangles = 0, fallback_corners = 0;
};

/// The t and the raw sign that mesh_frames() gives each corner by "mikktspace", t rounded to float: bit for
/// bit. Takes 16 bytes per corner beside mikktspace(), where mesh_frames() takes 130. \param mesh triangles
/// whose numbers are finite, and neither all positions nor all uvs below 2^-100 \param tangent4 four numbers
/// per corner \throws as mikktspace()
MikktspaceCounts mikktspace_tangents(const MikkMesh& mesh, std::span<float> tangent4, int threads);

}  // namespace darboux
