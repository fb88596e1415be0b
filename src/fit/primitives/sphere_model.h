// The distance from a sphere, and so from a cylinder across its axis.
#pragma once

#include <algorithm>
#include <cmath>

#include "distance_model.h"

namespace darboux::fit {

// rho, kappa: d = |p - c| - 1/kappa for c = (0, 0, rho + 1/kappa), as Q / (1 + sqrt(1 + kappa Q)),
// Q = kappa |q|^2 - 2 q_z, q = p - (0, 0, rho). Exact at kappa = 0 too.
class SphereModel {
 public:
  static constexpr int parameters = 2;
  explicit SphereModel(const double* s) : rho_(s[0]), kappa_(s[1]) {}
  double distance(const Vector3d& p) const {
    const double zeta = p.z() - rho_;
    const double q = kappa_ * (p.x() * p.x() + p.y() * p.y() + zeta * zeta) - 2 * zeta;
    return q / (1 + std::sqrt(std::max(0.0, 1 + kappa_ * q)));
  }
  void at(const Vector3d& p, LocalDistance<parameters>& out) const {
    const double zeta = p.z() - rho_;
    const double square = p.x() * p.x() + p.y() * p.y() + zeta * zeta, q = kappa_ * square - 2 * zeta;
    const double root = std::max(std::sqrt(std::max(0.0, 1 + kappa_ * q)), 1e-150);
    out.d = q / (1 + root);
    out.gradient = Vector3d(kappa_ * p.x(), kappa_ * p.y(), kappa_ * zeta - 1) / root;
    out.by = {-out.gradient.z(), (square + zeta * out.d) / ((1 + root) * root)};
    out.curvature = 2 * kappa_;
    out.metric_ratio = root;
  }

 private:
  double rho_, kappa_;
};

}  // namespace darboux::fit
