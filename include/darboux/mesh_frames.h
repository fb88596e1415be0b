/// \file mesh_frames.h
/// Tangent frames of triangle meshes by the methods people use, each under its name.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <darboux/mesh.h>
#include <darboux/triangle.h>
#include <darboux/vector.h>

namespace darboux {

/// A frame that a method gives to corners of triangles.
struct CornerFrame {
  Vec3<double> t, b, n;   ///< unit, of MikkTSpace to 3e-7; orthogonality is the method's
  double sign = 1;        ///< MikkTSpace's raw sign, ±1
  bool fallback = false;  ///< no triangle served, or none gave a direction: t is an arbitrary one
};

/// The result of a method. Corner c (of triangle c / 3) has frames[of_corner[c]].
struct MeshFrames {
  std::vector<CornerFrame> frames;
  std::vector<std::uint32_t> of_corner;
  std::size_t degenerate_triangles = 0;     ///< no area in space
  std::size_t degenerate_uv_triangles = 0;  ///< no area in uv, area in space
  std::size_t fallback_corners = 0;

  const CornerFrame& corner(std::size_t c) const { return frames[of_corner[c]]; }
};

/// The charts (surfaces with their uvs) on which a direction converges to the truth: all; those whose dpdu
/// and dpdv are orthogonal; those where they are also of equal length.
enum class Chart : std::uint8_t { any, orthogonal, conformal };

/// Orders of an error in the mesh width, in the interior of a smooth surface.
struct ExpectedOrders {
  double regular;   ///< on grids whose errors on opposite sides cancel
  double jittered;  ///< on irregular meshes, and at borders and seams
};

/// The same at vertices that share a triangle with a pole, a point with dpdu = 0; 0: does not converge.
/// Measured on spheres, ellipsoids, paraboloids, disks and cones: the least of them.
struct PoleOrders {
  ExpectedOrders tangent{1, 1}, bitangent{1, 1}, normal{1, 1};
};

/// A named method.
struct FrameMethod {
  std::string_view name;
  std::string_view summary;  ///< for readers who do not know the formula
  std::string_view formula;
  MeshFrames (*compute)(const Mesh& mesh, int threads);
  bool needs_normals = true;         ///< its n are then the mesh's own; the others make theirs
  bool single_precision = false;     ///< computes in float: errors below about 1e-6 of a radian are rounding
  ExpectedOrders direction{2, 1};    ///< of t and b, and of n where the method makes it
  PoleOrders at_poles{};             ///< next to a pole
  Chart tangent_chart = Chart::any;  ///< t converges on these
  Chart bitangent_chart = Chart::orthogonal;  ///< b does
  int reach = 1;                              ///< how many edges away vertices still matter
  std::string_view source;                    ///< a key of docs/references.bib, or the program that does it
  std::string_view cost;                      ///< of one thread, measured on a torus of 10^6 triangles
};

/// All of them:
///   mikktspace             MikkTSpace to the bit (mikktspace.h), b = sign unit(n × t). A t that is not unit
///                          is replaced by a fallback. If no triangle serves the corner, t is a fallback
///                          too; it is perpendicular to n, as the original's (1, 0, 0) need not be. Where
///                          dpdu is along n, t is rounding error, of any direction
///   mikktspace-bitangent   the same with its own b
///   face                   the 2x2 solve of each triangle, unit(T), unit(B), face normal
///   average                sums of T and B over a vertex's triangles (lengths included), Gram-Schmidt
///                          against its normal
///   unit                   the same of unit(T), unit(B)
///   area, angle, max       the same of unit(T), unit(B) weighted by the triangle's area, by its angle at the
///                          vertex, by sin(angle)/(|e1| |e2|), e1 and e2 its edges there, as [Max1999]
///                          weights normals
///   fragment-gradient      the tinyrenderer fragment frame, first form (fragment_gradients), at the corners
///   fragment-solve         its second form, T = E U^-1 with the interpolated normal, at the corners
///   procrustes             the rotation that best takes the uvs about a vertex to the positions there
///                          [Choi2024]
///   quadratic, cubic       the derivatives of the polynomial P(u, v) through the vertex that is nearest to
///                          the vertices up to two edges away, in the mean square; cubic is the estimate of
///                          the truth among them
///
/// `procrustes`, `quadratic` and `cubic` join vertices that agree in position, uv and normal, and keep
/// triangles apart whose uvs wind differently. If the vertices within two edges do not determine the
/// polynomial, those within three and four are taken, then the next lower degree. `quadratic` and `cubic` do
/// not depend on affine changes of the uvs. All neighbours of a vertex count. Of the vertices farther away
/// about 128 count, and of a neighbour with more than 32 triangles only 32 of its triangles, spread evenly.
/// So the time is linear even where 10^5 triangles meet.
std::span<const FrameMethod> frame_methods();

/// \throws ParameterError listing the known names
const FrameMethod& find_frame_method(std::string_view name);

/// Frames of every corner by one method. Degenerate triangles are counted and left out; corners no triangle
/// serves are flagged `fallback`. Cost: linear in the triangles, FrameMethod::cost.
/// \param threads 0: all; used by mikktspace, procrustes, quadratic and cubic; results do not depend on it
/// \throws MeshError when the mesh is inconsistent, has numbers that are not finite, or lacks uvs or, where
/// the method needs them, normals; by mikktspace and mikktspace-bitangent ParameterError as
/// chosen_instruction_set()
MeshFrames mesh_frames(const Mesh& mesh, const FrameMethod& method, int threads = 1);

}  // namespace darboux
