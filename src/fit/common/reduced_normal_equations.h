// Normal equations of any number of points as a least-squares problem of a few rows: the one batched cost
// that Ceres sees in every fit.
#pragma once

#include <Eigen/Core>

namespace darboux::fit {

// With H = V D V^T, the Gauss-Newton matrix, and g, the gradient of half a sum of squares: the residuals
// D^(-1/2) V^T g and one for the rest of the sum, with the Jacobian D^(1/2) V^T and 0, have the same cost,
// gradient and Gauss-Newton matrix. Directions that are not identifiable, their d below `least` of the
// largest, are held: rows of zeros.
class ReducedNormalEquations {
 public:
  ReducedNormalEquations() = default;
  explicit ReducedNormalEquations(const Eigen::MatrixXd& h, double least = 1e-15);

  // D^(-1/2) V^T x: of g the residuals, whose length is that of the Newton step as the weighted points feel
  // it; of the matrix of other normal equations, with these V and D kept, their Jacobian.
  Eigen::VectorXd operator()(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& x) const;

  // D^(1/2) V^T
  Eigen::MatrixXd jacobian() const;

  // One direction per column, in ascending order of information.
  const Eigen::MatrixXd& directions() const { return vectors_; }
  bool is_identifiable(Eigen::Index k) const { return roots_[k] > 0; }
  // Its variance at unit noise; 0 where it is held.
  double variance(Eigen::Index k) const { return inverses_[k] * inverses_[k]; }

 private:
  Eigen::MatrixXd vectors_;
  Eigen::VectorXd roots_, inverses_;
};

// The residual for what these leave of the sum of squares.
double remaining_residual(double squares, const Eigen::VectorXd& residuals);

}  // namespace darboux::fit
