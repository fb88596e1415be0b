// What the points' distances from a surface are like, see estimate.h.
#pragma once

namespace darboux::fit {

struct Noise {
  double sigma, outliers;
  bool sigma_known = false;
  double inliers = 1;  // sum of the probabilities
};

}  // namespace darboux::fit
