// The bounding box of points.
#pragma once

#include <cmath>
#include <limits>

#include <darboux/vector.h>

namespace darboux {

struct Bounds {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3<double> low{infinity, infinity, infinity}, high = -low;  // of no points

  // Coordinates that are NaN are ignored.
  void add(const Vec3<double>& p) {
    low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y), std::fmin(low.z, p.z)};
    high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y), std::fmax(high.z, p.z)};
  }
  double diagonal() const { return norm(high - low); }
  double longest_side() const { return std::fmax(high.x - low.x, std::fmax(high.y - low.y, high.z - low.z)); }
};

}  // namespace darboux
