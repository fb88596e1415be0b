// The state of each point at the current estimate of a primitive, and the mixture fitted to it.
//
// A point's distance d from the surface is N(sigma^2 H, sigma^2) for an inlier, H = (k1 + k2) / 2 at the foot
// (isotropic noise shifts the mean distance from a curved surface by that much). The residual of the mixture
// is d - sigma^2 H.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/common/mixture.h"

namespace darboux::fit {

struct PointStates {
  std::vector<double> d, curvature;    // signed distance, k1 + k2
  std::vector<double> bias;            // sigma^2 H: the mean distance of inliers
  std::vector<unsigned char> regular;  // not near a kink of the distance, which would trap the estimate
  std::vector<unsigned char> in_support;

  explicit PointStates(std::size_t n) : d(n), curvature(n), bias(n, 0), regular(n, 1), in_support(n, 1) {}
  double error(std::size_t i) const { return d[i] - bias[i]; }
};

inline double inlier_probability(double error, const Mixture& mixture) {
  const double r = error / mixture.sigma;
  if (!(std::fabs(r) < 12)) return 0;  // less than 1e-20 of any density of outliers
  return mixture.inlier_probability(0.5 * r * r);
}

// The mixture at fixed distances. In the robust phase the outliers' density is relative to all points nearby,
// so that too small a sigma grows. A mixture without outliers stays so. Sigma stays above the biases, which
// the next sigma may remove.
void update(Mixture& mixture, const PointStates& points, bool robust_phase);

void update_bias(const Mixture& mixture, PointStates& points);

std::vector<double> inlier_probabilities(const PointStates& points, const Mixture& mixture);

}  // namespace darboux::fit
