/// \file fragments.h
/// Frames inside a triangle, as fragment shaders and software rasterisers make them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <darboux/mesh_frames.h>
#include <darboux/vector.h>

namespace darboux {

/// The frame of a fragment, as the tinyrenderer course computes it (lesson 6bis), first form: with A the
/// matrix of rows p1 - p0, p2 - p0, n it solves A i = (Δu1, Δu2, 0), A j = (Δv1, Δv2, 0). i and j are the
/// gradients of u and v in the plane across n (i·dpdu = 1, i·dpdv = 0), not dpdu and dpdv: their directions
/// agree with solve_triangle's only where the chart is orthogonal and n is the face normal. Not normalised.
/// [Sokolov2016]
/// \param n the interpolated normal, of any length
/// \returns nothing where A is singular
std::optional<TangentPair> fragment_gradients(const std::array<Vec3<double>, 3>& p,
                                              const std::array<Vec2<double>, 3>& uv, const Vec3<double>& n);

/// What a fragment shader can make of a triangle at a point inside.
enum class FragmentForm : std::uint8_t {
  gradient,      ///< fragment_gradients with the interpolated normal, normalised
  solve,         ///< solve_triangle's T and B, normalised, beside the interpolated normal
  projected,     ///< T made perpendicular to the interpolated normal, b = sign n × t
  interpolated,  ///< the corners' t interpolated, then as T in `projected`
  /// The corners' t and n interpolated and left as they are, b = sign n × t: what MikkTSpace asks of
  /// shaders. Not unit, not orthogonal; a normal map's vector is normalised after.
  interpolated_raw,
};

/// A triangle with the frames of its corners.
struct TriangleFrames {
  std::array<Vec3<double>, 3> p;
  std::array<Vec2<double>, 3> uv;
  std::array<CornerFrame, 3> frames;  ///< `gradient`, `solve` and `projected` read n only
};

/// The frame at the point Σ weights[k] p[k]. The interpolated normal is Σ weights[k] n[k], normalised but
/// for interpolated_raw; the sign is that of the uvs' winding, but the first corner's for the interpolated
/// forms. On a smooth surface with exact frames at the corners, t errs by order 1 for the first three forms
/// (`gradient`: on orthogonal charts only), by order 2 for the interpolated ones; n by order 2. \param
/// weights barycentric coordinates, of sum 1 \returns a frame with `fallback` where the triangle or the
/// interpolated directions give none: where a sum of the corners' unit vectors, or the part of t
/// perpendicular to n, is below 16u (u = 2^-53), which rounding alone may leave
CornerFrame fragment_frame(FragmentForm form, const TriangleFrames& triangle,
                           const std::array<double, 3>& weights);

}  // namespace darboux
