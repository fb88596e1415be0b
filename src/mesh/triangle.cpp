#include <cmath>
#include <limits>

#include <darboux/frame.h>
#include <darboux/triangle.h>

#include "triangle_signs.h"

namespace darboux {
namespace {

constexpr double parallel_below = 8 * 0x1p-53;

}  // namespace

bool is_degenerate(const Vec3<double>& p0, const Vec3<double>& p1, const Vec3<double>& p2) {
  const Vec3<double> a = p1 - p0, b = p2 - p0, plain = cross(a, b);
  // The plain product errs by a few u |a| |b|: where it is above 2^-30 |a| |b|, as nearly always, its sign is
  // right. The bound is 0 or infinite where the squares under- or overflow.
  const double bound = 0x1p-60 * dot(a, a) * dot(b, b);
  if (bound > std::numeric_limits<double>::min() && dot(plain, plain) > bound) return false;
  return !(norm(accurate_cross(unit(a), unit(b))) > parallel_below);
}

bool is_degenerate(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2) {
  if (plain_sign(uv0, uv1, uv2) != 0) return false;
  return is_degenerate(Vec3<double>{uv0.x, uv0.y, 0}, {uv1.x, uv1.y, 0}, {uv2.x, uv2.y, 0});
}

double signed_uv_area2(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2) {
  return difference_of_products(uv1.x - uv0.x, uv2.y - uv0.y, uv2.x - uv0.x, uv1.y - uv0.y);
}

std::optional<TangentPair> solve_triangle(const std::array<Vec3<double>, 3>& p,
                                          const std::array<Vec2<double>, 3>& uv) {
  if (is_degenerate(p[0], p[1], p[2]) || is_degenerate(uv[0], uv[1], uv[2])) return std::nullopt;
  const Vec3<double> e1 = p[1] - p[0], e2 = p[2] - p[0];
  const double du1 = uv[1].x - uv[0].x, dv1 = uv[1].y - uv[0].y;
  const double du2 = uv[2].x - uv[0].x, dv2 = uv[2].y - uv[0].y;
  const double det = difference_of_products(du1, dv2, du2, dv1);
  if (det == 0 || !std::isfinite(det)) return std::nullopt;
  return TangentPair{(dv2 / det) * e1 - (dv1 / det) * e2, (du1 / det) * e2 - (du2 / det) * e1};
}

}  // namespace darboux
