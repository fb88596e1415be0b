// How far rounding may have moved a stored number from the true one.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <darboux/mesh.h>
#include <darboux/vector.h>

namespace darboux {

inline constexpr double single_roundoff = 0x1p-24;

// Half the step in which a component of that size is stored: the file's step, or that of single precision if
// larger.
inline double half_step(double of_file, double size) {
  return std::fmax(of_file, single_roundoff * size);
}

// Whether |a|² is 1, if each component is known up to half a step.
inline bool is_unit(const Vec3<double>& a, double half_step) {
  constexpr double tolerance = 0.0005;  // as the Khronos glTF validator
  const double rounding = 2 * std::numbers::sqrt3 * half_step + 3 * half_step * half_step;
  return std::fabs(1 - dot(a, a)) <= std::fmax(tolerance, rounding);
}

inline HalfSteps larger_of(const HalfSteps& a, const HalfSteps& b) {
  return {std::max(a.position, b.position), std::max(a.normal, b.normal), std::max(a.uv, b.uv),
          std::max(a.tangent, b.tangent)};
}

}  // namespace darboux
