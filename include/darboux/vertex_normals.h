/// \file vertex_normals.h
/// Vertex normals of triangle meshes, as tools compute them if a file has none.
#pragma once

#include <cstdint>
#include <vector>

#include <darboux/mesh.h>
#include <darboux/vector.h>

namespace darboux {

/// How the normals of the triangles at a vertex are weighted.
enum class NormalWeight : std::uint8_t {
  uniform,
  area,   ///< order 2 on regular grids, 1 elsewhere, as uniform and angle; the safe choice on slivers
  angle,  ///< by the angle at the vertex
  max,    ///< by sin(angle)/(|e1| |e2|) [Max1999]: exact where the vertices lie on a sphere
};

/// Unit vertex normals: unit(Σ weight unit((p1 - p0) × (p2 - p0))) over the triangles that use the vertex.
/// Vertices at the same position with different indices have separate normals. NaN if a vertex has no
/// triangle with area, or if the weighted normals cancel to below 16u of the sum of the weights (u = 2^-53),
/// as for two triangles back to back. Weights neither underflow nor overflow: positions are scaled by a power
/// of two. Cost: linear, one pass over the triangles. \throws MeshError as mesh_frames does; uvs are not
/// needed
std::vector<Vec3<double>> vertex_normals(const Mesh& mesh, NormalWeight weight);

}  // namespace darboux
