// The batched cost of a primitive over all points, and Ceres on it.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <ceres/cost_function.h>

#include "fit/common/reduced_normal_equations.h"
#include "primitive.h"

namespace darboux::fit {

// A cost function of all points that Ceres sees as few residuals, those of ReducedNormalEquations over the
// tangent (rotation vector, parameters). In the score phase V and D stay those of the first evaluation.
class BatchedCost final : public ceres::CostFunction {
 public:
  BatchedCost(const Primitive& primitive, Phase phase, const Eigen::Matrix3Xd& cloud, const Vector3d& origin,
              const Mixture& mixture, PointStates& states, const std::vector<double>& weights);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

  // Updates the states to the model; false if there is no such surface.
  bool evaluate_at(const LocalModel& model) const;
  Phase phase() const { return phase_; }
  int parameters() const { return parameters_; }
  const Eigen::MatrixXd& hessian() const { return sums_.hessian; }
  // How far the first Newton step moves the surface: the root of the weighted sum of squares of its movements
  // at the points.
  double first_step() const { return first_step_; }

 private:
  bool accumulate(const double* quaternion, const double* s) const;
  void accumulate_at(const LocalModel& model) const;

  const Primitive& primitive_;
  int parameters_;
  Phase phase_;
  const Eigen::Matrix3Xd& cloud_;
  Vector3d origin_;
  const Mixture& mixture_;
  PointStates& states_;
  const std::vector<double>& weights_;
  // Ceres calls from one thread; the last evaluation is kept.
  mutable std::array<double, 4 + LocalModel::most_parameters> at_{std::numeric_limits<double>::quiet_NaN()};
  mutable NormalEquations sums_;
  mutable std::optional<ReducedNormalEquations> reduced_;
  mutable double first_step_ = -1;
  mutable bool convex_ = false;
};

// Radius of Ceres' trust region that leaves Gauss-Newton's step unchanged up to rounding.
inline constexpr double wide_trust = 1e4;

struct Solved {
  bool usable = false, moved = false;
  int iterations = 0;
  double trust = wide_trust;  // radius at the end
};

// The score phase has no trust region: it is near the root, and damping would slow it in long valleys.
Solved solve(BatchedCost& cost, LocalModel& model, int most_iterations, double parameter_tolerance,
             double function_tolerance, double trust = wide_trust);

}  // namespace darboux::fit
