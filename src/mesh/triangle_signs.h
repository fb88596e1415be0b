// Which triangles have area and which way their uvs wind, computed once for all users.
#pragma once

#include <limits>
#include <vector>

#include <darboux/mesh.h>

namespace darboux {

// 1 if the uvs run counter-clockwise, -1 if clockwise. Plain arithmetic decides for nearly all triangles: the
// product errs by a few u |a| |b|, and is above 2^-30 |a| |b|. Else 0, also where squares under- or overflow:
// the caller then needs a more exact test.
inline int plain_sign(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2) {
  const Vec2<double> a = uv1 - uv0, b = uv2 - uv0;
  const double plain = a.x * b.y - a.y * b.x, bound = 0x1p-60 * dot(a, a) * dot(b, b);
  const bool clear = bound > std::numeric_limits<double>::min() && plain * plain > bound;
  return !clear ? 0 : plain > 0 ? 1 : -1;
}

// The raw sign of a triangle, 0 without uv area.
signed char triangle_sign(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2);

// The raw sign of each triangle of a mesh; all 0 without uvs.
std::vector<signed char> triangle_signs(const Mesh& mesh);

// Whether each triangle has area in space.
std::vector<bool> triangles_with_area(const Mesh& mesh);

}  // namespace darboux
