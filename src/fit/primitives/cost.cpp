#include "cost.h"

#include <algorithm>

#include <ceres/problem.h>
#include <ceres/solver.h>

#include "base/linear_algebra.h"
#include "fit/common/rotation_manifold.h"
#include "fit/common/solve_quietly.h"

namespace darboux::fit {

BatchedCost::BatchedCost(const Primitive& primitive, Phase phase, const Eigen::Matrix3Xd& cloud,
                         const Vector3d& origin, const Mixture& mixture, PointStates& states,
                         const std::vector<double>& weights)
    : primitive_(primitive),
      parameters_(primitive.distance.parameters),
      phase_(phase),
      cloud_(cloud),
      origin_(origin),
      mixture_(mixture),
      states_(states),
      weights_(weights) {
  set_num_residuals(3 + parameters_ + (phase == Phase::robust ? 1 : 0));
  *mutable_parameter_block_sizes() = {4, parameters_};
}

bool BatchedCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  if (!accumulate(parameters[0], parameters[1])) return false;
  if (phase_ == Phase::robust || !reduced_) reduced_ = ReducedNormalEquations(sums_.hessian);
  const Eigen::VectorXd r = (*reduced_)(sums_.gradient);
  const Eigen::Index n = r.size();
  Eigen::Map<Eigen::VectorXd>(residuals, n) = r;
  if (first_step_ < 0) first_step_ = r.norm();
  if (phase_ == Phase::robust) residuals[n] = remaining_residual(sums_.squares, r);
  if (jacobians == nullptr) return true;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd j = (*reduced_)(sums_.hessian);
  if (jacobians[0] != nullptr) {
    // Over the ambient quaternion: tangent derivatives times the left inverse of PlusJacobian.
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> minus;
    RotationManifold().MinusJacobian(parameters[0], minus.data());
    Eigen::Map<RowMajor> to(jacobians[0], num_residuals(), 4);
    to.setZero();
    to.topRows(n) = j.leftCols<3>() * minus;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<RowMajor> to(jacobians[1], num_residuals(), parameters_);
    to.setZero();
    to.topRows(n) = j.rightCols(parameters_);
  }
  return true;
}

bool BatchedCost::evaluate_at(const LocalModel& model) const {
  return accumulate(model.rotation.coeffs().data(), model.s.data());
}

bool BatchedCost::accumulate(const double* quaternion, const double* s) const {
  if (!primitive_.distance.in_range(s)) return false;
  if (!std::equal(quaternion, quaternion + 4, at_.begin()) ||
      !std::equal(s, s + parameters_, at_.begin() + 4)) {
    std::copy(quaternion, quaternion + 4, at_.begin());
    std::copy(s, s + parameters_, at_.begin() + 4);
    LocalModel model;
    model.origin = origin_;
    model.rotation = Eigen::Map<const Eigen::Quaterniond>(quaternion);
    std::copy(s, s + parameters_, model.s.begin());
    accumulate_at(model);
  }
  return sums_.gradient.allFinite() && sums_.hessian.allFinite();
}

void BatchedCost::accumulate_at(const LocalModel& model) const {
  const auto sum = [&] {
    primitive_.distance.accumulate(cloud_, model, {phase_, mixture_, weights_, convex_}, states_, sums_);
  };
  sum();
  // Far from the maximum the likelihood may be non-convex; the weighted squares never are.
  if (!convex_ && phase_ == Phase::score &&
      symmetric_eigenvalues(sums_.hessian)[0] < -1e-9 * sums_.hessian.trace()) {
    convex_ = true;
    sum();
  }
}

Solved solve(BatchedCost& cost, LocalModel& model, int most_iterations, double parameter_tolerance,
             double function_tolerance, double trust) {
  if (!cost.evaluate_at(model)) return {};
  static const RotationManifold manifold;
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  double* rotation = model.rotation.coeffs().data();
  problem.AddResidualBlock(&cost, nullptr, rotation, model.s.data());
  problem.SetManifold(rotation, const_cast<RotationManifold*>(&manifold));
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = function_tolerance;  // Ceres does not take the step that meets it
  options.gradient_tolerance = 1e-30;
  options.parameter_tolerance = parameter_tolerance;
  options.initial_trust_region_radius = cost.phase() == Phase::score ? 1e16 : trust;
  const ceres::Solver::Summary summary = solve_quietly(options, problem);
  return {cost.evaluate_at(model) && summary.IsSolutionUsable(), summary.num_successful_steps > 1,
          static_cast<int>(summary.iterations.size()),
          summary.iterations.empty() ? trust : summary.iterations.back().trust_region_radius};
}

}  // namespace darboux::fit
