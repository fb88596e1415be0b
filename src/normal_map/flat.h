/// \file flat.h
/// Which texels are flat: they leave the normal as it is.
#pragma once

#include <cmath>

#include <darboux/vector.h>

namespace darboux::normal_map {

/// Whether a texel is (0, 0, 1) as far as 8 bits can tell, its x and y times a scale: |x|, |y| <= 1/255 and z
/// >= 1 - 2/255. Of two channels z is not read.
inline bool is_flat(const Vec3<double>& n, double scale = 1, bool two_channels = false) {
  constexpr double step = 1.0 / 255, rounding = 1e-12;
  return scale * std::fmax(std::fabs(n.x), std::fabs(n.y)) <= step + rounding &&
         (two_channels || n.z >= 1 - 2 * step - rounding);
}

}  // namespace darboux::normal_map
