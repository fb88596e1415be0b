// Where a primitive may lie: surfaces through small random samples, the best of them descended to a maximum
// of the likelihood over part of the points.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include <Eigen/Core>

#include "primitive.h"

namespace darboux::fit {

// What is asked of the search: points that are centred and scaled to size 1.
enum class Effort {
  full,
  plain  // for points that lie on the surface to rounding, or on none: such a surface is found at once
};

struct SearchProblem {
  const Eigen::Matrix3Xd& cloud;
  const OrientedPoints& oriented;
  std::optional<double> sigma;  // where it is known
  std::optional<GeometricParameters> guess;
  std::uint64_t seed;
  Effort effort;
  std::function<void(double)> progress;  // with the share of the work that is done, 0 to 1
};

// A surface that some of the points suggest.
struct Hypothesis {
  const Primitive* primitive;
  double log_likelihood_ratio;  // over points spread evenly; see search.cpp
  GeometricParameters surface;
  Vector3d at;  // a point of it, next to inliers
  Mixture mixture;
  int iterations = 0;  // of Ceres
};

// Nothing where no start leads to a surface.
std::optional<Hypothesis> search(const SearchProblem& problem, const Primitive& primitive);

}  // namespace darboux::fit
