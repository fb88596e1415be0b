#include "reduced_normal_equations.h"

#include <cmath>
#include <utility>

#include "base/linear_algebra.h"

namespace darboux::fit {

ReducedNormalEquations::ReducedNormalEquations(const Eigen::MatrixXd& h, double least) {
  auto [values, vectors] = symmetric_eigen(h);
  const double largest = values[h.rows() - 1];
  vectors_ = std::move(vectors);
  roots_ = values.unaryExpr([&](double d) { return d > least * largest ? std::sqrt(d) : 0.0; });
  inverses_ = roots_.unaryExpr([](double root) { return root > 0 ? 1 / root : 0.0; });
}

Eigen::VectorXd ReducedNormalEquations::operator()(const Eigen::VectorXd& x) const {
  return inverses_.asDiagonal() * (vectors_.transpose() * x);
}

Eigen::MatrixXd ReducedNormalEquations::operator()(const Eigen::MatrixXd& x) const {
  return inverses_.asDiagonal() * (vectors_.transpose() * x);
}

Eigen::MatrixXd ReducedNormalEquations::jacobian() const {
  return roots_.asDiagonal() * vectors_.transpose();
}

double remaining_residual(double squares, const Eigen::VectorXd& residuals) {
  return std::sqrt(std::fmax(0, squares - residuals.squaredNorm()));
}

}  // namespace darboux::fit
