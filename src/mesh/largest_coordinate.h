#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include <darboux/vector.h>

namespace darboux {

// The largest magnitude of a coordinate among finite points; 0 if there are none.
inline double largest_coordinate(std::span<const Vec3<double>> points) {
  double largest = 0;
  for (const Vec3<double>& p : points)
    if (detail::finite(p)) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return largest;
}

}  // namespace darboux
