/// \file mesh_frames.h
/// Tangent frames of triangle meshes by the methods people use, each under its name.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <darboux/mesh.h>
#include <darboux/vector.h>

namespace darboux {

/// The two triangles a method cannot use: no area in space, no area in uv. A cross product below 8u of the
/// product of the two edge lengths counts as zero (u = 2^-53): what rounding the edges leaves of it.
bool is_degenerate(const Vec3<double>& p0, const Vec3<double>& p1, const Vec3<double>& p2);
bool is_degenerate(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2);

/// Twice the signed area of a triangle in uv: positive where the winding is counter-clockwise there. Its sign
/// is MikkTSpace's raw sign of the triangle.
double signed_uv_area2(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2);

/// The linear map of a triangle from uv to space, [p1 - p0, p2 - p0] = [T B] [[Δu1, Δu2], [Δv1, Δv2]]:
/// T and B approximate dpdu and dpdv, lengths included.
/// \returns nothing where either triangle is degenerate
struct TangentPair {
  Vec3<double> t, b;
};
std::optional<TangentPair> solve_triangle(const std::array<Vec3<double>, 3>& p,
                                          const std::array<Vec2<double>, 3>& uv);

/// The frame of a fragment, as the tinyrenderer course computes it (lesson 6bis), first form: with A the
/// matrix of rows p1 - p0, p2 - p0, n it solves A i = (Δu1, Δu2, 0), A j = (Δv1, Δv2, 0). i and j are the
/// gradients of u and v in the plane across n (i·dpdu = 1, i·dpdv = 0), not dpdu and dpdv: their directions
/// agree with solve_triangle's only where the chart is orthogonal and n is the face normal. Not normalised.
/// [Sokolov2016]
/// \param n the interpolated normal, of any length
/// \returns nothing where A is singular
std::optional<TangentPair> fragment_gradients(const std::array<Vec3<double>, 3>& p,
                                              const std::array<Vec2<double>, 3>& uv, const Vec3<double>& n);

/// A frame that a method gives to corners of triangles.
struct CornerFrame {
  Vec3<double> t, b, n;   ///< unit; orthogonality is the method's
  double sign = 1;        ///< MikkTSpace's raw sign, ±1
  bool fallback = false;  ///< no triangle served: t is an arbitrary direction across n
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

/// A named method. The expected orders are those of the tangent's error in the mesh width on a smooth
/// surface.
struct FrameMethod {
  std::string_view name;
  std::string_view summary;  ///< for people who do not know the formula
  std::string_view formula;
  bool needs_normals;
  int order_regular;            ///< interior of a regular grid
  int order_jittered;           ///< interior of an irregular mesh
  int tangent_order_oblique;    ///< of t on a regular chart that is not orthogonal; 0: does not converge
  int bitangent_order_oblique;  ///< of b against dpdv there
  MeshFrames (*compute)(const Mesh& mesh);
};

/// All of them:
///   face               the 2x2 solve of each triangle, unit(T), unit(B), face normal
///   average            sums of T and B over a vertex's triangles (uniform weights, lengths included), Gram-Schmidt
///                      against the vertex's normal
///   unit               the same of unit(T), unit(B)
///   area, angle        the same of unit(T), unit(B) weighted by the triangle's area, by its angle at the vertex
///   fragment-gradient  the tinyrenderer fragment frame, first form (fragment_gradients), at the corners
///   fragment-solve     its second form, T = E U^-1 with the interpolated normal, at the corners
std::span<const FrameMethod> frame_methods();

/// \throws ParameterError listing the known names
const FrameMethod& find_frame_method(std::string_view name);

/// Frames of every corner by one method. Degenerate triangles are counted and left out; corners no triangle
/// serves are flagged `fallback`. Cost: linear in the triangles.
/// \throws MeshError when the mesh is
/// inconsistent or lacks uvs or, where the method needs them, normals
MeshFrames mesh_frames(const Mesh& mesh, const FrameMethod& method);

}  // namespace darboux
