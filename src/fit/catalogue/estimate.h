// The estimate of maximum likelihood of a shape from a start, with Ceres.
#pragma once

#include <functional>
#include <vector>

#include "shape.h"

namespace darboux::fit::catalogue {

struct Weighted {
  std::vector<double> weight, bias;  // 0 <= weight; the mean distance that noise makes of none
};

// The mixture of inliers and uniform outliers along the distance.
struct Mixture {
  double sigma = 0, outlier_share = 0, window = 0;  // outliers lie within ±window/2
  bool sigma_known = false;
};

struct Estimate {
  Shape shape;
  FootPoints feet{};
  Weighted weighted{};
  Mixture mixture{};
  double log_likelihood = -infinity;
  bool converged = false;
  int iterations = 0;
};

using Progress = std::function<void(double)>;

// From the shape, and sigma where it is known: Ceres with the weights held, then new feet and weights, until
// the next step would be a small part of the standard errors. FootPoints are searched for, and once more
// where they have been followed to the end. A draft stops early, only follows them, and tells no progress.
void refine(Estimate& e, const Positions& points, const std::vector<double>& typical, double size, bool draft,
            const Progress& progress);

}  // namespace darboux::fit::catalogue
