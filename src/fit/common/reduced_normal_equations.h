// Normal equations of any number of points as a least-squares problem with few rows: the one cost that Ceres
// sees in every fit.
#pragma once

#include <Eigen/Core>

namespace darboux::fit {

// With H = V D V^T, the Gauss-Newton matrix, and g, the gradient of half a sum of squares: the residuals
// D^(-1/2) V^T g and one for the rest of the sum, with the Jacobian D^(1/2) V^T and 0, have the same cost,
// gradient and Gauss-Newton matrix. Directions that are not identifiable (d below `least` of the largest) are
// held: their rows are zero.
class ReducedNormalEquations {
 public:
  ReducedNormalEquations() = default;
  explicit ReducedNormalEquations(const Eigen::MatrixXd& h, double least = 1e-15);

  // D^(-1/2) V^T x. For x = g these are the residuals, whose length is that of the Newton step in the metric
  // of the weighted points. For the matrix of other normal equations, with V and D kept, it is their
  // Jacobian.
  Eigen::VectorXd operator()(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& x) const;

  // D^(1/2) V^T
  Eigen::MatrixXd jacobian() const;

  // One direction per column, in ascending order of information.
  const Eigen::MatrixXd& directions() const { return vectors_; }
  bool is_identifiable(Eigen::Index k) const { return roots_[k] > 0; }
  // The variance of direction k at unit noise; 0 if it is held.
  double variance(Eigen::Index k) const { return inverses_[k] * inverses_[k]; }

 private:
  Eigen::MatrixXd vectors_;
  Eigen::VectorXd roots_, inverses_;
};

// The residual that accounts for the rest of the sum of squares.
double remaining_residual(double squares, const Eigen::VectorXd& residuals);

}  // namespace darboux::fit
