#include "corner.h"

#include <algorithm>

#include <darboux/frame.h>

namespace darboux {
namespace {

bool is_direction(const Vec3<double>& a) {
  return detail::finite(a) && !(a == Vec3<double>{});
}

}  // namespace

Vec3<double> any_perpendicular(const Vec3<double>& n) {
  const double ax = std::fabs(n.x), ay = std::fabs(n.y), az = std::fabs(n.z);
  const Vec3<double> axis = ax <= ay && ax <= az ? Vec3<double>{1, 0, 0}
                            : ay <= az           ? Vec3<double>{0, 1, 0}
                                                 : Vec3<double>{0, 0, 1};
  return unit(axis - dot(axis, n) * n);
}

Face::Face(const Mesh& mesh, const Triangle& triangle) {
  for (int k = 0; k < 3; ++k) {
    p[k] = mesh.positions[triangle[k]];
    uv[k] = mesh.uvs[triangle[k]];
  }
  solved = solve_triangle(p, uv);
  sign = signed_uv_area2(uv[0], uv[1], uv[2]) > 0 ? 1 : -1;
}

double scale_below_one(const Mesh& mesh) {
  double largest = 0;
  for (const Vec3<double>& p : mesh.positions)
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return std::ldexp(1.0, -std::clamp(std::ilogb(largest) + 1, -1000, 1024));
}

std::array<Vec3<double>, 3> scaled(const std::array<Vec3<double>, 3>& p, double scale) {
  return {scale * p[0], scale * p[1], scale * p[2]};
}

double corner_angle(const std::array<Vec3<double>, 3>& p, int corner) {
  return angle_between(p[(corner + 1) % 3] - p[corner], p[(corner + 2) % 3] - p[corner]);
}

double corner_max_weight(const std::array<Vec3<double>, 3>& p, int corner) {
  const Vec3<double> a = p[(corner + 1) % 3] - p[corner], b = p[(corner + 2) % 3] - p[corner];
  return norm(accurate_cross(unit(a), unit(b))) / norm(a) / norm(b);
}

double triangle_area(const std::array<Vec3<double>, 3>& p) {
  return norm(accurate_cross(p[1] - p[0], p[2] - p[0])) / 2;
}

Vec3<double> face_normal(const std::array<Vec3<double>, 3>& p) {
  return unit(accurate_cross(unit(p[1] - p[0]), unit(p[2] - p[0])));
}

CornerFrame fallback_frame(const Vec3<double>& n, double sign) {
  const Vec3<double> normal = is_direction(unit(n)) ? unit(n) : Vec3<double>{0, 0, 1};
  const Vec3<double> t = any_perpendicular(normal);
  return {t, sign * cross(normal, t), normal, sign, true};
}

CornerFrame frame_or_fallback(const Vec3<double>& t, const Vec3<double>& b, const Vec3<double>& n,
                              double sign) {
  return is_direction(t) && is_direction(b) && is_direction(n) ? CornerFrame{t, b, n, sign, false}
                                                               : fallback_frame(n, sign);
}

void count_degenerate(const Face& face, MeshFrames& result) {
  if (!face.solved) count_degenerate(face.p, face.uv, result);
}

void count_fallbacks(MeshFrames& result) {
  for (const std::uint32_t f : result.of_corner) result.fallback_corners += result.frames[f].fallback;
}

}  // namespace darboux
