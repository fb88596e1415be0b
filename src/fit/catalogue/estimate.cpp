#include "estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <ceres/ceres.h>

#include "base/quantile.h"
#include "fit/common/noise_bias.h"
#include "fit/common/solve_quietly.h"

namespace darboux::fit::catalogue {
namespace {

// All points as one cost of n + 1 residuals. FootPoints follow those of the last accepted shape.
class BatchedCost final : public ceres::CostFunction {
 public:
  BatchedCost(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts,
              const Weighted& weighted, const Eigen::VectorXd& units, double size)
      : shape_(shape),
        points_(points),
        weighted_(weighted),
        units_(units),
        size_(size),
        accepted_(starts),
        tried_(starts),
        tried_at_(Eigen::VectorXd::Zero(units.size())) {
    const auto n = static_cast<int>(units.size());
    set_num_residuals(n + 1);
    mutable_parameter_block_sizes()->push_back(n);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index n = units_.size();
    const Eigen::VectorXd delta = Eigen::Map<const Eigen::VectorXd>(parameters[0], n).cwiseProduct(units_);
    const std::optional<Shape> shape = moved(shape_, delta);
    if (!shape) return false;
    Eigen::Map<Eigen::VectorXd> r(residuals, n + 1);
    const bool rows = jacobians && jacobians[0];
    // Ceres first requests the cost of a step, and its Jacobian once the step is accepted: the feet found
    // then are kept.
    if (rows && delta == tried_at_) accepted_ = tried_;
    tried_ = accepted_;
    tried_at_ = delta;
    Normal normal(n);
    double squares = 0;
    if (!sums(*shape, delta, rows ? &normal : nullptr, squares)) return false;
    r.setZero();
    if (rows) {
      const ReducedNormalEquations reduced = normal.reduced();
      r.head(n) = reduced(normal.g);
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> j(jacobians[0],
                                                                                           n + 1, n);
      j << reduced.jacobian(), Eigen::RowVectorXd::Zero(n);
      accepted_ = tried_;
    }
    r[n] = remaining_residual(squares, r.head(n));
    return true;
  }

  // How far the first Newton step moves the surface: the root of the weighted sum of squares of its movements
  // at the points.
  double first_step() const {
    const Eigen::Index n = units_.size();
    Normal normal(n);
    double squares = 0;
    if (!sums(shape_, Eigen::VectorXd::Zero(n), &normal, squares)) return infinity;
    return size_ * normal.reduced()(normal.g).norm();
  }

 private:
  // The weighted squares of the distances over the size and, if requested, the normal equations. False if
  // something is not finite.
  bool sums(const Shape& shape, const Eigen::VectorXd& delta, Normal* normal, double& squares) const {
    const FootFinder finder(shape);
    const DistanceRow row_of(shape, delta, units_, size_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double w = weighted_.weight[i];
      if (w == 0) continue;
      const Projection f = finder.follow(points_[i], tried_[i]);
      tried_[i] = f.uv;
      const double r = (f.distance - weighted_.bias[i]) / size_;
      if (!std::isfinite(r)) return false;
      squares += w * r * r;
      if (!normal) continue;
      const Row row = row_of(f, points_[i]);
      // If the surface has no derivatives there, the point does not contribute: Ceres then has a Jacobian
      // wherever it has a cost.
      if (row.allFinite()) normal->add(row, w, r);
    }
    return std::isfinite(squares);
  }

  const Shape& shape_;
  const Positions& points_;
  const Weighted& weighted_;
  const Eigen::VectorXd& units_;
  double size_;
  // Ceres calls from one thread.
  mutable std::vector<Vec2<double>> accepted_, tried_;
  mutable Eigen::VectorXd tried_at_;
};

// Uses the densities along the distance, not their ratio: the last bits of the likelihoods decide which of
// several equivalent poses is found.
double inlier_density(const MixtureInVolume& m, double error) {
  const double r = error / m.sigma;
  return (1 - m.share) * std::exp(-0.5 * r * r) / (m.sigma * std::sqrt(2 * std::numbers::pi));
}

double outlier_density(const MixtureInVolume& m) {
  return m.share / m.volume;
}

// Weights and noise from the distances, repeatedly; then the likelihood.
void expect(Estimate& e, double size) {
  const std::size_t n = e.feet.distance.size();
  e.weighted.weight.assign(n, 0);
  e.weighted.bias.assign(n, 0);
  MixtureInVolume& m = e.mixture;
  for (int step = 0; step < 10; ++step) {
    ExpectedInliers expected;
    for (std::size_t i = 0; i < n; ++i) {
      e.weighted.bias[i] = bias(m.sigma, e.feet.curvature[i]);
      const double r = e.feet.distance[i] - e.weighted.bias[i], p = inlier_density(m, r);
      const double w = std::isfinite(r) ? p / (p + outlier_density(m)) : 0;
      e.weighted.weight[i] = w;
      if (w > 0) expected.add(w, w * r * r);
    }
    if (!(expected.count > 0)) break;
    expected.estimate_sigma(m, 1, 1e-15 * size);
    m.share = std::clamp(1 - expected.count / static_cast<double>(n), 1e-6, 0.9);
  }
  e.log_likelihood = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double inlier =
        std::isfinite(e.feet.distance[i]) ? inlier_density(m, e.feet.distance[i] - e.weighted.bias[i]) : 0;
    e.log_likelihood += std::log(inlier + outlier_density(m));
  }
}

double median_size(const std::vector<double>& distance) {
  std::vector<double> sizes;
  for (const double d : distance) sizes.push_back(std::isfinite(d) ? std::fabs(d) : infinity);
  return median(std::move(sizes));
}

}  // namespace

void refine(Estimate& e, const Positions& points, const std::vector<double>& typical, double size, bool draft,
            const Progress& progress) {
  e.feet = feet_of(e.shape, points, {});
  if (!e.mixture.sigma_known) e.mixture.sigma = std::fmax(1.5 * median_size(e.feet.distance), 1e-15 * size);
  e.mixture.volume = 2 * size;
  e.mixture.share = 0.2;
  expect(e, size);
  bool searched = true;
  const int rounds = draft ? 3 : 20, steps = draft ? 8 : 30;
  for (int round = 0; round < rounds; ++round) {
    const Eigen::VectorXd units = units_of(e.shape, typical, size);
    BatchedCost cost(e.shape, points, e.feet.uv, e.weighted, units, size);
    bool follow = draft;
    if (!draft) {
      progress(static_cast<double>(round) / rounds);
      const double inliers = std::accumulate(e.weighted.weight.begin(), e.weighted.weight.end(), 0.0),
                   step = cost.first_step();
      if (step <= 1e-3 * e.mixture.sigma + 1e-14 * size * std::sqrt(inliers)) {
        e.converged = searched;
        if (searched) return;
        e.feet = feet_of(e.shape, points, {});
        expect(e, size);
        searched = true;
        continue;
      }
      follow = step <= 1e-2 * size * std::sqrt(inliers);
    }
    std::vector<double> x(static_cast<std::size_t>(units.size()), 0);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    problem.AddResidualBlock(&cost, nullptr, x.data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = steps;
    options.max_num_consecutive_invalid_steps = 10;
    options.function_tolerance = 1e-14;
    options.gradient_tolerance = 1e-16;
    options.parameter_tolerance = 1e-10;
    const ceres::Solver::Summary summary = solve_quietly(options, problem);
    e.iterations += static_cast<int>(summary.iterations.size());
    if (!summary.IsSolutionUsable()) return;
    const Eigen::VectorXd delta = Eigen::Map<Eigen::VectorXd>(x.data(), units.size());
    const std::optional<Shape> next = moved(e.shape, delta.cwiseProduct(units));
    if (!next) return;
    e.shape = *next;
    e.feet = feet_of(e.shape, points, follow ? e.feet.uv : std::vector<Vec2<double>>{});
    searched = !follow;
    expect(e, size);
  }
}

}  // namespace darboux::fit::catalogue
