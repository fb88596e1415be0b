/// \file flat.h
/// Tests for flat texels, which do not change the normal.
#pragma once

#include <cmath>

#include <darboux/vector.h>

namespace darboux::normal_map {

/// Whether a texel, with x and y multiplied by a scale, is (0, 0, 1) to within 8 bits: |x|, |y| <= 1/255 and
/// z >= 1 - 2/255. With two channels z is not read.
inline bool is_flat(const Vec3<double>& n, double scale = 1, bool two_channels = false) {
  constexpr double step = 1.0 / 255, rounding = 1e-12;
  return scale * std::fmax(std::fabs(n.x), std::fabs(n.y)) <= step + rounding &&
         (two_channels || n.z >= 1 - 2 * step - rounding);
}

}  // namespace darboux::normal_map
