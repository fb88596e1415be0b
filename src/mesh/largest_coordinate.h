#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include <darboux/vector.h>

namespace darboux {

// The largest size of a coordinate, of finite points only; 0 where there are none.
inline double largest_coordinate(std::span<const Vec3<double>> points) {
  double largest = 0;
  for (const Vec3<double>& p : points)
    if (detail::finite(p)) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return largest;
}

}  // namespace darboux
