/// \file arithmetic.h
/// The arithmetic of the original MikkTSpace: single precision, sums from left to right.
#pragma once

#include <cfloat>
#include <cmath>

#include "lanes.h"

namespace darboux::mikk {

inline bool not_zero(float x) {
  return std::fabs(x) > FLT_MIN;
}
inline bool not_zero(const Vector& a) {
  return not_zero(a.x) || not_zero(a.y) || not_zero(a.z);
}
inline float length_of(const Vector& a) {
  return std::sqrt(dot(a, a));
}
inline Vector normalised(const Vector& a) {
  return not_zero(a) ? 1.0F / length_of(a) * a : a;
}

}  // namespace darboux::mikk
