// Normal equations of any number of points as a least-squares problem of a few rows, which is what Ceres
// sees.
#pragma once

#include <cmath>

#include <Eigen/Eigenvalues>

namespace darboux::fit {

// With H = V D V^T, the Gauss-Newton matrix, and g, the gradient of half a sum of squares: the residuals
// D^(-1/2) V^T g and one for the rest of the sum, with the Jacobian D^(1/2) V^T and 0, have the same cost,
// gradient and Gauss-Newton matrix. Directions of which nothing is known, their d below `least` of the
// largest, are held: rows of zeros.
template <int N>
class Compressed {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  Compressed() = default;
  explicit Compressed(const Matrix& h, double least = 1e-15) {
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(h);
    const double largest = eigen.eigenvalues()[h.rows() - 1];
    vectors_ = eigen.eigenvectors();
    roots_ =
        eigen.eigenvalues().unaryExpr([&](double d) { return d > least * largest ? std::sqrt(d) : 0.0; });
    inverses_ = roots_.unaryExpr([](double root) { return root > 0 ? 1 / root : 0.0; });
  }

  // D^(-1/2) V^T x: of g the residuals, whose length is that of the Newton step as the weighted points feel
  // it; of the matrix of other normal equations, with these V and D kept, their Jacobian.
  template <class X>
  auto operator()(const X& x) const {
    return (inverses_.asDiagonal() * (vectors_.transpose() * x)).eval();
  }

  // D^(1/2) V^T
  Matrix jacobian() const { return roots_.asDiagonal() * vectors_.transpose(); }

  // A column a direction, in ascending order of what is known of it.
  const Matrix& directions() const { return vectors_; }
  bool is_known(Eigen::Index k) const { return roots_[k] > 0; }
  // Its variance at unit noise; 0 where it is held.
  double variance(Eigen::Index k) const { return inverses_[k] * inverses_[k]; }

 private:
  Matrix vectors_;
  Vector roots_, inverses_;
};

// The residual for what these leave of the sum of squares.
template <class Residuals>
double rest(double squares, const Residuals& residuals) {
  return std::sqrt(std::fmax(0, squares - residuals.squaredNorm()));
}

}  // namespace darboux::fit
