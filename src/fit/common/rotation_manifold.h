// Rotation vectors, and Ceres manifolds whose tangent vectors have a stated length. Those of Ceres 2.1 halve
// the step, and so double standard errors.
#pragma once

#include <cmath>

#include <Eigen/Geometry>
#include <ceres/manifold.h>

namespace darboux::fit {

// a x, as a matrix.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

// A unit quaternion (x, y, z, w) as a rotation; the tangent vector is a rotation vector in radians along the
// rotated axes: Plus(q, r) = q exp(r / 2).
class RotationManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 3; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Map<const Eigen::Vector3d> r(delta);
    const double angle = r.norm();
    // sin(angle / 2) / angle, to the last bits where the angle vanishes
    const double k = angle > 1e-8 ? std::sin(angle / 2) / angle : 0.5;
    Eigen::Quaterniond step;
    step.vec() = k * r;
    step.w() = std::cos(angle / 2);
    Eigen::Map<Eigen::Quaterniond> result(x_plus_delta);
    result = (Eigen::Map<const Eigen::Quaterniond>(x) * step).normalized();
    return true;
  }

  // d(q exp(r / 2)) / dr at 0: half the products of q with i, j and k. Row by row.
  bool PlusJacobian(const double* x, double* jacobian) const override {
    const double qx = x[0], qy = x[1], qz = x[2], qw = x[3];
    Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> j(jacobian);
    j << qw, -qz, qy, qz, qw, -qx, -qy, qx, qw, -qx, -qy, -qz;
    j *= 0.5;
    return true;
  }

  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Quaterniond step =
        Eigen::Map<const Eigen::Quaterniond>(x).conjugate() * Eigen::Map<const Eigen::Quaterniond>(y);
    if (step.w() < 0) step.coeffs() *= -1;
    const double sine = step.vec().norm();
    const double k = sine > 1e-8 ? 2 * std::atan2(sine, step.w()) / sine : 2;
    Eigen::Map<Eigen::Vector3d> result(y_minus_x);
    result = k * step.vec();
    return true;
  }

  // d(Minus) / dy at y = x: the columns of PlusJacobian are orthogonal of length 1/2.
  bool MinusJacobian(const double* x, double* jacobian) const override {
    Eigen::Matrix<double, 4, 3, Eigen::RowMajor> plus;
    PlusJacobian(x, plus.data());
    Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> j(jacobian);
    j = 4 * plus.transpose();
    return true;
  }
};

}  // namespace darboux::fit
