// The maximum-likelihood estimate of a shape from a start, with Ceres.
#pragma once

#include <functional>
#include <vector>

#include "fit/common/mixture.h"
#include "shape.h"

namespace darboux::fit::catalogue {

struct Weighted {
  std::vector<double> weight, bias;  // 0 <= weight; the mean distance that noise gives inliers
};

struct Estimate {
  Shape shape;
  FootPoints feet{};
  Weighted weighted{};
  MixtureInVolume mixture{};  // of distances; the outliers lie within ± volume / 2
  double log_likelihood = -infinity;
  bool converged = false;
  int iterations = 0;
};

using Progress = std::function<void(double)>;

// Refines from the shape, and from sigma if it is known: Ceres with the weights held, then new feet and
// weights, until the next step would be a small part of the standard errors. Foot points are searched
// globally at the start, and again after they have been followed to convergence. A draft stops early, only
// follows the feet, and reports no progress.
void refine(Estimate& e, const Positions& points, const std::vector<double>& typical, double size, bool draft,
            const Progress& progress);

}  // namespace darboux::fit::catalogue
