// Decompositions of small matrices. Eigen's take seconds to compile: here they are compiled once.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace darboux {

// The eigenvalues of a symmetric matrix in ascending order, and unit eigenvectors, one per column.
template <int N>
struct SymmetricEigen {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};

// These read the lower triangle only.
SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& a);
SymmetricEigen<Eigen::Dynamic> symmetric_eigen(const Eigen::MatrixXd& a);
Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d& a);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

// By the roots of the characteristic polynomial: faster, with half the digits where eigenvalues are close.
SymmetricEigen<3> closed_form_symmetric_eigen(const Eigen::Matrix3d& a);

// a x = value b x, with b positive definite; eigenvectors have length 1 in the sense of b.
SymmetricEigen<Eigen::Dynamic> generalised_symmetric_eigen(const Eigen::MatrixXd& a,
                                                           const Eigen::MatrixXd& b);

// The solution of a x = b for a symmetric and semidefinite, by LDLT.
template <int N>  // 3, 4 or 10
Eigen::Matrix<double, N, 1> solve_symmetric(const Eigen::Matrix<double, N, N>& a,
                                            const Eigen::Matrix<double, N, 1>& b);
Eigen::Matrix3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

// The x of least norm among those that minimise |a x - b|. \param threshold pivots below this share of the
// largest count as zero; Eigen's default if none is given
Eigen::VectorXd solve_least_norm(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                 std::optional<double> threshold = std::nullopt);
Eigen::MatrixXd solve_least_norm(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The x that minimises |a x - b|; none if the columns of a are linearly dependent.
std::optional<Eigen::MatrixXd> solve_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The solution of a x = b; none if a is singular.
std::optional<Eigen::Vector3d> solve_regular(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);

// a = u diag(values) v^T, values in descending order.
struct SingularValues {
  Eigen::Matrix3d u;
  Eigen::Vector3d values;
  Eigen::Matrix3d v;
};
SingularValues singular_value_decomposition(const Eigen::Matrix3d& a);

// Whether this is a rotation R and a translation: |R^T R - 1| is below the tolerance. Matrices come from
// files and command lines, with at least five decimals.
bool is_rigid(const Eigen::Isometry3d& placement, double tolerance = 1e-4);

}  // namespace darboux
