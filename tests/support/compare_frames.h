/// \file compare_frames.h
/// What tests ask of the vectors of frames.
#pragma once

#include <algorithm>
#include <cmath>

#include <darboux/frame.h>

#include "roundoff.h"

namespace darboux::test {

inline bool finite(const Vec3<double>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline bool all_nan(const Vec3<double>& a) {
  return std::isnan(a.x) && std::isnan(a.y) && std::isnan(a.z);
}
inline bool finite(const Frame<double>& f) {
  return finite(f.t) && finite(f.b) && finite(f.n);
}
inline bool all_nan(const Frame<double>& f) {
  return all_nan(f.t) && all_nan(f.b) && all_nan(f.n);
}
inline double distance(const Frame<double>& a, const Frame<double>& b) {
  return std::max({norm(a.t - b.t), norm(a.b - b.b), norm(a.n - b.n)});
}

}  // namespace darboux::test
