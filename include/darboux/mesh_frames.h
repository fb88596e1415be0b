/// \file mesh_frames.h
/// Tangent frames of triangle meshes, by the methods in common use.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <darboux/mesh.h>
#include <darboux/triangle.h>
#include <darboux/vector.h>

namespace darboux {

/// The frame that a method computes for a triangle corner.
struct CornerFrame {
  Vec3<double> t, b, n;   ///< unit, for MikkTSpace within 3e-7; orthogonal only if the method makes them so
  double sign = 1;        ///< MikkTSpace's raw sign, ±1
  bool fallback = false;  ///< no triangle determines a direction: t is arbitrary
};

/// The result of a method. Corner c (of triangle c / 3) has frames[of_corner[c]].
struct MeshFrames {
  std::vector<CornerFrame> frames;
  std::vector<std::uint32_t> of_corner;
  std::size_t degenerate_triangles = 0;     ///< no area in space
  std::size_t degenerate_uv_triangles = 0;  ///< no area in uv, but area in space
  std::size_t fallback_corners = 0;

  const CornerFrame& corner(std::size_t c) const { return frames[of_corner[c]]; }
};

/// The charts on which a direction converges to the exact one: all charts; orthogonal ones (dpdu · dpdv =
/// 0); conformal ones (also |dpdu| = |dpdv|).
enum class Chart : std::uint8_t { any, orthogonal, conformal };

/// Orders of convergence in the mesh width, in the interior of a smooth surface.
struct ExpectedOrders {
  double regular;   ///< on regular grids, where errors on opposite sides cancel
  double jittered;  ///< on irregular meshes, and at borders and seams
};

/// Orders of convergence at vertices that share a triangle with a pole (a point with dpdu = 0). 0: does not
/// converge. The lowest order measured on spheres, ellipsoids, paraboloids, disks and cones.
struct PoleOrders {
  ExpectedOrders tangent{1, 1}, bitangent{1, 1}, normal{1, 1};
};

/// A method for the tangent frames of a mesh.
struct FrameMethod {
  std::string_view name;
  std::string_view summary;  ///< for readers who do not know the formula
  std::string_view formula;
  MeshFrames (*compute)(const Mesh& mesh, int threads);
  bool needs_normals = true;         ///< uses the normals of the mesh as n; other methods compute n
  bool single_precision = false;     ///< computes in float: errors below about 1e-6 radians are rounding
  ExpectedOrders direction{2, 1};    ///< for t and b, and for n if the method computes it
  PoleOrders at_poles{};             ///< next to a pole
  Chart tangent_chart = Chart::any;  ///< charts on which t converges
  Chart bitangent_chart = Chart::orthogonal;  ///< charts on which b converges
  int reach = 1;                              ///< radius of the stencil, in edges
  std::string_view source;                    ///< a key of docs/references.bib, or the program that uses it
  std::string_view cost;                      ///< in one thread, measured on a torus of 10^6 triangles
};

/// All methods:
///   mikktspace             MikkTSpace, bit for bit (mikktspace.h), with b = sign unit(n × t). A fallback
///                          replaces t if t is not unit, or if no triangle determines a direction at the
///                          corner. It is perpendicular to n; (1, 0, 0) of the original need not be. Where
///                          dpdu is parallel to n, the direction of t is rounding error
///   mikktspace-bitangent   the same, with the b of MikkTSpace
///   face                   unit(T) and unit(B) of each triangle, from its 2x2 system, and the face normal
///   average                sums of T and B over a vertex's triangles (lengths included), Gram-Schmidt
///                          against its normal
///   unit                   the same of unit(T), unit(B)
///   area, angle, max       the same with unit(T), unit(B) weighted by the area of the triangle; by its angle
///                          at the vertex; by sin(angle)/(|e1| |e2|), with e1 and e2 the edges at the vertex,
///                          as [Max1999] weights normals
///   fragment-gradient      the tinyrenderer fragment frame, first form (fragment_gradients), at the corners
///   fragment-solve         its second form, T = E U^-1 with the interpolated normal, at the corners
///   procrustes             the rotation that best maps the uvs around a vertex to the positions [Choi2024]
///   quadratic, cubic       the derivatives of a polynomial P(u, v) through the vertex, fitted by least
///                          squares to the vertices up to two edges away. `cubic` serves as the estimate of
///                          the exact frame
///
/// `procrustes`, `quadratic` and `cubic` weld vertices that agree in position, uv and normal, and separate
/// triangles whose uvs wind differently. If the vertices within two edges do not determine the polynomial,
/// those within three, then four edges are used, then the next lower degree. `quadratic` and `cubic` are
/// invariant under affine maps of the uvs. All direct neighbours of a vertex are used. Of the vertices
/// farther away, about 128 are used; of a neighbour with more than 32 triangles, only 32 of these, evenly
/// spaced. So the time is linear even where 10^5 triangles meet.
std::span<const FrameMethod> frame_methods();

/// \throws ParameterError listing the known names
const FrameMethod& find_frame_method(std::string_view name);

/// Computes the frame of every corner by one method. Degenerate triangles are counted and ignored. Corners
/// without a usable triangle are flagged `fallback`. Cost: linear in the triangles; see FrameMethod::cost.
/// \param threads 0: all; used by mikktspace, procrustes, quadratic and cubic; results do not depend on it
/// \throws MeshError if the mesh is inconsistent, has values that are not finite, or lacks uvs or, if the
/// method needs them, normals; for mikktspace and mikktspace-bitangent also what chosen_instruction_set()
/// throws
MeshFrames mesh_frames(const Mesh& mesh, const FrameMethod& method, int threads = 1);

}  // namespace darboux
