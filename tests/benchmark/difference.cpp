#include "difference.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>

#include <darboux/vector.h>

namespace darboux::bench {
namespace {

double degrees_between(const Vec3<double>& a, const Vec3<double>& b) {
  const double across = norm(cross(a, b)), along = dot(a, b);
  if (!(std::hypot(across, along) > 0) || !std::isfinite(along)) return 180;
  return std::atan2(across, along) * 180 / std::numbers::pi;
}

}  // namespace

Difference difference(const std::vector<float>& ours, const std::vector<float>& theirs,
                      const MeshArrays& torus) {
  Difference d{.corners = torus.corner_count()};
  if (ours.size() != 4 * d.corners || theirs.size() != 4 * d.corners)
    throw std::runtime_error("tangents of another number of corners");
  for (std::size_t c = 0; c < d.corners; ++c) {
    const float *a = &ours[4 * c], *b = &theirs[4 * c], *p = &torus.positions[3 * torus.vertex(c)];
    d.same_bits += std::memcmp(a, b, 4 * sizeof(float)) == 0;
    d.other_signs += a[3] != b[3];
    const Vec3<double> t{b[0], b[1], b[2]};
    const double angle = degrees_between(t, {a[0], a[1], a[2]}), error = degrees_between(t, {-p[1], p[0], 0});
    d.far += angle > 0.1;
    d.largest = std::max(d.largest, angle);
    d.from_dpdu = std::max(d.from_dpdu, error);
    d.rms_from_dpdu += error * error / static_cast<double>(d.corners);
  }
  d.rms_from_dpdu = std::sqrt(d.rms_from_dpdu);
  return d;
}

}  // namespace darboux::bench
