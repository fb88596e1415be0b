/// \file vertex_tangents.h
/// MikkTSpace's tangents of an indexed mesh, by vertex: nearly all corners at a vertex have the same tangent.
#pragma once

#include <vector>

#include <darboux/mikktspace.h>
#include <darboux/vector.h>

#include "buffer.h"
#include "lanes.h"

namespace darboux::mikk {

struct CornerTangent {
  Index corner;
  Vec4<float> tangent;
};

// x, y, z of t and the raw sign, bit for bit as mikktspace() gives them.
struct VertexTangents {
  Buffer<Vec4<float>> of_vertices;    // of the first corner at each vertex; w is 0 if there is none
  std::vector<CornerTangent> others;  // corners with other bits than their vertex, ascending
  // All corners instead, if triangles are degenerate or their uvs have no area; else empty.
  Buffer<Vec4<float>> of_corners;
};
// For indexed triangles. Takes 16 bytes more than mikktspace() per vertex, or per corner for of_corners.
VertexTangents vertex_tangents(const MikkMesh& mesh, const MikkOptions& options);

}  // namespace darboux::mikk
