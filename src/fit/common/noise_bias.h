// The effect of noise on the distances of points from a curved surface.
#pragma once

#include <cmath>

namespace darboux::fit {

// The mean distance of points with isotropic noise from a surface whose k1 + k2 is `curvature`, positive
// where it is convex towards the side of positive distances: sigma^2 (k1 + k2) / 2. This is the first order,
// which is meaningless where radii of curvature come near sigma, as at a cone's apex. There the bias fades
// out smoothly, as an estimate that switched it on and off would never converge.
inline double bias(double sigma, double curvature) {
  const double x = 0.5 * sigma * curvature;
  return std::isfinite(x) ? sigma * x / (1 + x * x * x * x) : 0;
}

}  // namespace darboux::fit
