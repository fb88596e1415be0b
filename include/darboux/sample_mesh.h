/// \file sample_mesh.h
/// Reference meshes: a grid over a surface with exact positions, normals, uvs and tangents.
#pragma once

#include <cstdint>

#include <darboux/any_surface.h>
#include <darboux/frame.h>
#include <darboux/mesh.h>

namespace darboux {

/// How a reference mesh is laid over the uv square.
struct SampleMeshOptions {
  int columns = 32,
      rows = 16;  ///< segments along u and v, each at least 1 (3 along a shared periodic direction)
  bool shared_seam =
      false;          ///< vertices of a periodic direction are shared, their uv jumps back inside a triangle
  double jitter = 0;  ///< interior vertices move by up to ± this share of a cell in u and in v, in [0, 0.5)
  bool random_diagonals = false;
  std::uint64_t seed = 1;          ///< of jitter and diagonals
  double shear = 0;                ///< K: stores (u + K v, v)
  bool mirror = false;             ///< stores 1 - |2u - 1|; columns even; vertices on the fold are doubled
  double v_first = 0, v_last = 1;  ///< the rows span [v_first, v_last]
  SignConvention sign = SignConvention::gltf;
};

/// The mesh. Positions, normals and tangents are the surface's own at each vertex's (u, v), in double; the
/// tangent is the direction of the derivative by the *stored* u. At a pole each column has its own vertex
/// with the limit frame of its u, triangles without area are left out, and so is the vertex that none of them
/// uses.
/// \throws ParameterError naming the option and what is permitted
Mesh sample_mesh(const AnySurface& surface, const SampleMeshOptions& options);

}  // namespace darboux
