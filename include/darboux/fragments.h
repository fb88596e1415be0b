/// \file fragments.h
/// Frames inside a triangle, as computed by fragment shaders and software rasterisers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <darboux/mesh_frames.h>
#include <darboux/vector.h>

namespace darboux {

/// The frame of a fragment, as the tinyrenderer course computes it (lesson 6bis), first form: with A the
/// matrix of rows p1 - p0, p2 - p0, n it solves A i = (Δu1, Δu2, 0), A j = (Δv1, Δv2, 0). i and j are the
/// gradients of u and v in the plane perpendicular to n (i·dpdu = 1, i·dpdv = 0), not dpdu and dpdv. Their
/// directions agree with those of solve_triangle() only if the chart is orthogonal and n is the face normal.
/// Not normalised. [Sokolov2016]
/// \param n the interpolated normal, of any length
/// \returns empty if A is singular
std::optional<TangentPair> fragment_gradients(const std::array<Vec3<double>, 3>& p,
                                              const std::array<Vec2<double>, 3>& uv, const Vec3<double>& n);

/// The ways in which a fragment shader can compute a frame inside a triangle.
enum class FragmentForm : std::uint8_t {
  gradient,      ///< fragment_gradients with the interpolated normal, normalised
  solve,         ///< solve_triangle's T and B, normalised, beside the interpolated normal
  projected,     ///< T made perpendicular to the interpolated normal, b = sign n × t
  interpolated,  ///< the corners' t interpolated, then as T in `projected`
  /// t and n of the corners interpolated, not normalised, b = sign n × t: what MikkTSpace requires of
  /// shaders. Neither unit nor orthogonal; the vector from the normal map is normalised after the
  /// transformation.
  interpolated_raw,
};

/// A triangle with the frames of its corners.
struct TriangleFrames {
  std::array<Vec3<double>, 3> p;
  std::array<Vec2<double>, 3> uv;
  std::array<CornerFrame, 3> frames;  ///< `gradient`, `solve` and `projected` read n only
};

/// The frame at the point Σ weights[k] p[k]. The interpolated normal is Σ weights[k] n[k], normalised
/// except for interpolated_raw. The sign is that of the winding of the uvs; for the interpolated forms, that
/// of the first corner. On a smooth surface with exact frames at the corners, t converges with order 1 for
/// the first three forms (`gradient`: on orthogonal charts only) and with order 2 for the interpolated ones;
/// n with order 2. \param weights barycentric coordinates, with sum 1 \returns a frame flagged `fallback` if
/// the triangle or the interpolated directions give none: if a weighted sum of unit vectors, or the component
/// of t perpendicular to n, is below 16u (u = 2^-53), which rounding alone may cause
CornerFrame fragment_frame(FragmentForm form, const TriangleFrames& triangle,
                           const std::array<double, 3>& weights);

}  // namespace darboux
