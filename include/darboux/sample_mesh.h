/// \file sample_mesh.h
/// Reference meshes: triangulated surfaces with exact positions, normals, uvs and tangents, and with defects
/// on request.
#pragma once

#include <cstdint>

#include <darboux/any_surface.h>
#include <darboux/frame.h>
#include <darboux/mesh.h>

namespace darboux {

/// How the surface is triangulated.
enum class MeshTopology {
  grid,       ///< columns × rows cells of the uv square, two triangles each
  icosphere,  ///< 20 n² triangles: an icosahedron's, each edge cut into n = subdivisions, two corners at the
              ///< poles
  cube_sphere,  ///< 12 n² triangles: a cube's, each edge cut into n equal angles, n even, the poles amid two
                ///< faces
  lantern,      ///< Schwarz's lantern: a grid in which every second row is turned by half a cell
};

/// The u of the vertices at a pole. A pole is an end of v that is a single point.
enum class PolePlacement {
  per_column,  ///< one vertex per column, u = i/n, as the rows have it: its triangle is askew in uv
  half_cell,   ///< one vertex per triangle, in the middle of its column, u = (i + 1/2)/n
  shared,      ///< one vertex for all, u = 1/2 (each half of a mirrored mesh has its own)
};

/// The layout and the defects of a reference mesh.
struct SampleMeshOptions {
  MeshTopology topology = MeshTopology::grid;
  int columns = 32, rows = 16;  ///< grid and lantern: segments along u and v, each at least 1 (3 columns of a
                                ///< lantern; 3 along a shared periodic direction)
  int subdivisions = 8;         ///< icosphere and cube_sphere: segments per edge, at least 1, at most 2000
  PolePlacement pole = PolePlacement::per_column;
  bool shared_seam = false;  ///< both sides of a seam share vertices: uvs jump back within a triangle
  /// In [0, 0.5): interior vertices are displaced by up to ± this share of a cell in u and in v; those on
  /// the fold of a mirrored mesh in v only.
  double jitter = 0;
  bool random_diagonals = false;
  /// In [0, 1): the coordinates x of a grid are replaced by x + grading sin(2πx)/2π, so cells are 1 +
  /// grading times as wide as the average at the ends of u and v, and 1 - grading times in the middle.
  double grading = 0;
  std::uint64_t seed = 1;          ///< of jitter and diagonals
  double shear = 0;                ///< K: stores (u + K v, v), |K| <= 1000
  bool mirror = false;             ///< stores 1 - |2u - 1|; columns even; vertices on the fold are doubled
  double v_first = 0, v_last = 1;  ///< the rows span [v_first, v_last]
  SignConvention sign = SignConvention::gltf;
  Vec3<double> scale{1, 1, 1};  ///< along x, y, z, baked: see below
  int degenerate = 0;      ///< triangles without area that are added, at most as many as there are others
  int degenerate_uvs = 0;  ///< triangles that lose their area in uv, at most all
};

/// Makes the mesh. Positions, normals and tangents are those of the surface at the (u, v) of each vertex, in
/// double; the tangent is the direction of the derivative by the *stored* u. Triangles are counter-clockwise
/// as seen from the side to which n points.
///
/// grid: each column has its own vertex at a pole, with the limit frame of its u, unless `pole` says
/// otherwise. Triangles without area (two corners at the same position, up to 8 ulps of the triangle's
/// largest coordinate) are omitted, and so is the vertex that no triangle uses. A shared pole has the frame
/// of u = 1/2 only (at the apex of a cone, the normal of that side).
///
/// icosphere, cube_sphere: for surfaces whose u is a turn and whose v a half turn with a pole at each end:
/// sphere, ellipsoid, superellipsoid. Each vertex of the unit sphere's mesh gives the (u, v) of its
/// direction, rounded to multiples of 2^-23, so that a file of floats holds them exactly. No triangle's uvs
/// jump: one that crosses the seam has vertices of its own with u up to 1.5. A pole's vertex belongs to one
/// triangle and has the mean u of its other two.
///
/// lantern: for surfaces whose u is a turn, v linear, without a pole. Rows 1, 3, ... have u = (i +
/// 1/2)/columns. On a cylinder of radius r and height h with m columns and n rows all triangles are
/// congruent, and
///   area = 2 m n r sin(π/m) sqrt((h/n)² + r² (1 - cos(π/m))²)
/// tends to the cylinder's 2πrh only if n/m² -> 0; for n = m² it tends to 2πr sqrt(h² + π⁴r²/4).
/// In that case quantities computed from the triangles do not converge, although the stored normals and
/// tangents are those of the cylinder. [Schwarz1890]
///
/// shear: at the largest |K|, a float of u + K v resolves u to 2^-15.
///
/// scale, M = diag(x, y, z), each 1e-30 to 1e30 in size, none more than 1e12 times another: positions and
/// tangents by M, normals by its inverse transpose, w by the sign of det M; a mirror (det M < 0) reverses the
/// winding, so that it agrees with n.
///
/// degenerate: spread over the mesh, of three alternating kinds, each along the shortest edge (a, b) of a
/// regular triangle:
///   (a, m, b)   collinear: m is a vertex of its own in the middle of the chord, off the surface by its sag,
///               with the surface's normal and tangent at the edge's middle uv
///   (a, b, a')  three vertices, two of them in one place: a' is a copy of a
///   (a, b, b)   one vertex twice
/// They have no area in uv either. So that middles are exact, in float files too, all (u, v) are rounded to
/// multiples of 2^-20 before anything is computed there (exact with shears that are multiples of 1/4), and
/// afterwards positions to multiples of 2^-22 of the power of two below the largest coordinate: by at most
/// one unit of the last digit of a float of that size.
///
/// degenerate_uvs: spread likewise, of two alternating kinds: all three corners get the uv of the first; the
/// third gets that of the first. Such a triangle has its own vertices: positions, normals and tangents are
/// unchanged, but the uvs no longer correspond to them.
///
/// \param dropped_cells receives the number of incomplete cells of a grid: a triangle of the cell has a
/// corner at infinity, as at a pole of a formula, and is left out; or no triangle of the cell has area
///
/// Cost: linear in the triangles; three evaluations per triangle and one per vertex. Options that do not
/// apply to a topology are an error: pole, jitter, random_diagonals, grading, mirror for all but grid,
/// shared_seam and a part of v for the two spheres. \throws ParameterError naming the option, what was
/// expected and what was given; also for a grid without any triangle with area, such as 1x1 on a torus
Mesh sample_mesh(const AnySurface& surface, const SampleMeshOptions& options,
                 std::size_t* dropped_cells = nullptr);

}  // namespace darboux
