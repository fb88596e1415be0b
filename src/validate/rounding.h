// What rounding of the stored numbers allows.
#pragma once

#include <cmath>

namespace darboux {

inline constexpr double single_roundoff = 0x1p-24;

// Half of the step in which a component of a size is stored: the file's, or single precision's where that is
// larger.
inline double half_step(double of_file, double size) {
  return std::fmax(of_file, single_roundoff * size);
}

}  // namespace darboux
