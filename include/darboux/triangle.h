/// \file triangle.h
/// A triangle with uvs: degeneracy, uv winding, and the linear map from uv to space.
#pragma once

#include <array>
#include <optional>

#include <darboux/vector.h>

namespace darboux {

/// Whether a triangle has no area, in space or in uv. A cross product below 8u times the product of the two
/// edge lengths counts as zero (u = 2^-53), since rounding of the edges alone can cause it.
bool is_degenerate(const Vec3<double>& p0, const Vec3<double>& p1, const Vec3<double>& p2);
bool is_degenerate(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2);

/// Twice the signed area of a triangle in uv: positive where the winding is counter-clockwise there. Its sign
/// is MikkTSpace's raw sign of the triangle.
double signed_uv_area2(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2);

/// The linear map of a triangle from uv to space, [p1 - p0, p2 - p0] = [T B] [[Δu1, Δu2], [Δv1, Δv2]]:
/// T and B approximate dpdu and dpdv, lengths included.
/// \returns empty if the triangle is degenerate in space or uv, or if the determinant in uv, of the order of
/// the squared edges, under- or overflows
struct TangentPair {
  Vec3<double> t, b;
};
std::optional<TangentPair> solve_triangle(const std::array<Vec3<double>, 3>& p,
                                          const std::array<Vec2<double>, 3>& uv);

}  // namespace darboux
