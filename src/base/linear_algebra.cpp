#include "linear_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace darboux {
namespace {

template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

template <int N>
SymmetricEigen<N> result_of(const Eigen::SelfAdjointEigenSolver<Matrix<N>>& solver) {
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template <int N>
SymmetricEigen<N> symmetric_eigen_of(const Matrix<N>& a) {
  return result_of<N>(Eigen::SelfAdjointEigenSolver<Matrix<N>>(a));
}

template <int N>
Eigen::Matrix<double, N, 1> symmetric_eigenvalues_of(const Matrix<N>& a) {
  return Eigen::SelfAdjointEigenSolver<Matrix<N>>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& a) {
  return symmetric_eigen_of<3>(a);
}
SymmetricEigen<Eigen::Dynamic> symmetric_eigen(const Eigen::MatrixXd& a) {
  return symmetric_eigen_of<Eigen::Dynamic>(a);
}

Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d& a) {
  return symmetric_eigenvalues_of<3>(a);
}
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a) {
  return symmetric_eigenvalues_of<Eigen::Dynamic>(a);
}

SymmetricEigen<3> closed_form_symmetric_eigen(const Eigen::Matrix3d& a) {
  return result_of<3>(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>().computeDirect(a));
}

SymmetricEigen<Eigen::Dynamic> generalised_symmetric_eigen(const Eigen::MatrixXd& a,
                                                           const Eigen::MatrixXd& b) {
  return result_of<Eigen::Dynamic>(Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(a, b));
}

template <int N>
Eigen::Matrix<double, N, 1> solve_symmetric(const Eigen::Matrix<double, N, N>& a,
                                            const Eigen::Matrix<double, N, 1>& b) {
  return a.ldlt().solve(b);
}
template Eigen::Vector3d solve_symmetric<3>(const Eigen::Matrix3d&, const Eigen::Vector3d&);
template Eigen::Vector4d solve_symmetric<4>(const Eigen::Matrix4d&, const Eigen::Vector4d&);
template Eigen::Matrix<double, 10, 1> solve_symmetric<10>(const Eigen::Matrix<double, 10, 10>&,
                                                          const Eigen::Matrix<double, 10, 1>&);

Eigen::Matrix3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return a.ldlt().solve(b);
}

Eigen::VectorXd solve_least_norm(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                 std::optional<double> threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(a.rows(), a.cols());
  if (threshold) decomposition.setThreshold(*threshold);
  return decomposition.compute(a).solve(b);
}
Eigen::MatrixXd solve_least_norm(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

std::optional<Eigen::MatrixXd> solve_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  if (qr.rank() < a.cols()) return std::nullopt;
  return qr.solve(b);
}

std::optional<Eigen::Vector3d> solve_regular(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(a);
  if (lu.rank() < 3) return std::nullopt;
  return lu.solve(b);
}

SingularValues singular_value_decomposition(const Eigen::Matrix3d& a) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

bool is_rigid(const Eigen::Isometry3d& placement, double tolerance) {
  const Eigen::Matrix3d r = placement.linear();
  return placement.matrix().allFinite() && placement.matrix().row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
         (r.transpose() * r - Eigen::Matrix3d::Identity()).norm() < tolerance && r.determinant() > 0;
}

}  // namespace darboux
