// From a hypothesis to the maximum of the likelihood over all points, with its uncertainty.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "search.h"

namespace darboux::fit {

using Covariance = Eigen::Matrix<double, 9, 9>;

// A surface with its uncertainty and its residual at every point.
struct PrimitiveFit {
  const Primitive* primitive;
  bool given_up = false;  // another kind explains far more; only measured, not refined
  bool converged = false;
  GeometricParameters surface;
  double sigma = 0, outliers = 0;  // see fit/common/mixture.h
  bool sigma_known = false;
  double rounding = 0;  // half of the greatest error of a coordinate by how it was stored
  Covariance covariance = Covariance::Zero();  // of (rotation vector, movement of `reference`, lengths)
  Vector3d reference;
  double largest_deviation = 0;  // standard deviation in the least identifiable direction, at unit noise
  // Distance of the inliers from one circle, root mean square, of each of its two directions.
  double circle_deviation = 0;
  bool doubles_itself = false;  // see primitive.h
  std::vector<double> error;    // signed distance less its bias
  std::vector<unsigned char> in_support;
  int iterations = 0;
};

// The derivatives of (rotation vector, movement of `reference`, lengths) with respect to the model's
// (rotation vector, parameters), a column each. By central differences.
using GeometricDerivatives = Eigen::Matrix<double, 9, Eigen::Dynamic>;
GeometricDerivatives geometric_derivatives(const Primitive& primitive, const LocalModel& model,
                                           const Vector3d& reference);

// \param give_up only measures the surface
PrimitiveFit refine(const SearchProblem& problem, const Hypothesis& hypothesis, bool give_up);

}  // namespace darboux::fit
