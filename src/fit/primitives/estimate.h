// The estimate of maximum likelihood of one shape from a start, with Ceres.
//
// Model: a point's distance d from the surface is N(sigma^2 H, sigma^2) for an inlier, H = (k1 + k2) / 2 at
// the foot (isotropic noise moves the mean distance from a curved surface by that much), and of constant
// density for an outlier. With e = d - sigma^2 H, E = exp(-e^2 / 2 sigma^2) and the density `outliers` of
// outliers relative to the inliers' at e = 0, a point is an inlier with probability w = E / (E + outliers).
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include "fit/common/bias.h"
#include "fit/common/compressed.h"
#include "fit/common/manifolds.h"
#include "model.h"
#include "noise.h"

namespace darboux::fit {

// Rounding of points scaled to size 1.
inline constexpr double least_sigma = 1e-15;

// What is known of each point at the current estimate.
struct PointStates {
  std::vector<double> d, curvature;    // signed distance, k1 + k2
  std::vector<double> bias;            // sigma^2 H: what the distance of an inlier is on average
  std::vector<unsigned char> regular;  // not near where distances have a kink, which would hold the estimate
  std::vector<unsigned char> kept;     // by the gate

  explicit PointStates(std::size_t n) : d(n), curvature(n), bias(n, 0), regular(n, 1), kept(n, 1) {}
  template <int S>
  void set(std::size_t i, const Local<S>& local) {
    d[i] = local.d;
    curvature[i] = local.curvature;
    regular[i] = local.stretch > 0.2;
  }
  double error(std::size_t i) const { return d[i] - bias[i]; }
};

inline double inlier_probability(double error, const Noise& noise) {
  const double r = error / noise.sigma;
  if (!(std::fabs(r) < 12)) return 0;  // less than 1e-20 of any density of outliers
  const double likelihood = std::exp(-0.5 * r * r);
  return likelihood / (likelihood + noise.outliers);
}

// Noise at fixed distances. The outliers' density is counted where it cannot be mistaken for the inliers', in
// windows (1 - x^2)^3 some nine sigma to either side, with a tenth of a point more so that it is never zero.
// It is relative to the inliers; from afar to all points nearby, so that a sigma that is too small, with
// inliers in the windows, grows. Sigma is found by expectation and maximisation: two steps, and on to where
// they lead, as each gains about the same factor.
inline void update(Noise& noise, const PointStates& points, bool afar) {
  constexpr double middle = 9, half_width = 4;
  // The windows' integral over that of exp(-r^2 / 2): 2 half_width 32 / 35 / sqrt(2 pi).
  constexpr double windows = 2 * half_width * 32 / 35 / 2.506628274631001;
  std::vector<double> near;
  for (std::size_t i = 0; i < points.d.size(); ++i)
    if (points.kept[i] && std::fabs(points.error(i)) < 40 * noise.sigma) near.push_back(points.error(i));
  if (near.empty()) return;
  const auto count = [&](Noise& at) {
    double others = 0.1;
    for (const double e : near) {
      const double x = (std::fabs(e / at.sigma) - middle) / half_width, y = 1 - x * x;
      if (y > 0) others += y * y * y;
    }
    at.outliers = others / (windows * (afar ? static_cast<double>(near.size()) : at.inliers));
  };
  const auto step = [&](Noise at) {
    count(at);
    double squares = 0;
    at.inliers = 0;
    for (const double e : near) {
      const double w = inlier_probability(e, at);
      at.inliers += w;
      squares += w * e * e;
    }
    if (!at.sigma_known && at.inliers > 0) at.sigma = std::max(std::sqrt(squares / at.inliers), least_sigma);
    at.inliers = std::max(at.inliers, 1.0);
    return at;
  };
  const Noise once = step(noise), twice = step(once);
  const double first = std::log(once.sigma / noise.sigma), second = std::log(twice.sigma / once.sigma);
  const double ratio = second / first;
  noise = twice;
  if (ratio > -0.8 && ratio < 0.8)
    noise.sigma = std::max(noise.sigma * std::exp(ratio / (1 - ratio) * second), least_sigma);
  count(noise);
}

inline void update_bias(const Noise& noise, PointStates& points) {
  for (std::size_t i = 0; i < points.d.size(); ++i) points.bias[i] = bias(noise.sigma, points.curvature[i]);
}

inline double root_mean_square_of_bias(const PointStates& points) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < points.bias.size(); ++i)
    if (points.kept[i]) sum += points.bias[i] * points.bias[i], count += 1;
  return count > 0 ? std::sqrt(sum / count) : 0;
}

// A cost function of all points that Ceres sees as few residuals, those of compressed.h over the tangent
// (rotation vector, shape's parameters).
//   descend: the weights are fixed: robust, from afar
//   score: the gradient is that of the likelihood, and V, D stay those of the first evaluation: a root, found
//   to the last digits, where differences of the likelihood would drown in its rounding
enum class Phase { descend, score };

template <class Shape>
class BatchedCost final : public ceres::CostFunction {
 public:
  static constexpr int S = Shape::size, N = 3 + S;
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  BatchedCost(Phase phase, const Eigen::Matrix3Xd& cloud, const Vector3d& origin, const Noise& noise,
              PointStates& states, const std::vector<double>& weights)
      : phase_(phase), cloud_(cloud), origin_(origin), noise_(noise), states_(states), weights_(weights) {
    set_num_residuals(phase == Phase::descend ? N + 1 : N);
    mutable_parameter_block_sizes()->push_back(4);
    mutable_parameter_block_sizes()->push_back(S);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    if (!accumulate(parameters[0], parameters[1])) return false;
    if (phase_ == Phase::descend || !compressed_) compressed_ = Compressed<N>(hessian_);
    const Vector r = (*compressed_)(gradient_);
    Eigen::Map<Vector>(residuals, N) = r;
    if (first_step_ < 0) first_step_ = r.norm();
    if (phase_ == Phase::descend) residuals[N] = rest(squares_, r);
    if (jacobians != nullptr) {
      const Matrix j = (*compressed_)(hessian_);
      if (jacobians[0] != nullptr) {
        // Over the ambient quaternion: tangent derivatives times the left inverse of PlusJacobian.
        Eigen::Matrix<double, 3, 4, Eigen::RowMajor> minus;
        RotationManifold().MinusJacobian(parameters[0], minus.data());
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>> to(jacobians[0],
                                                                                 num_residuals(), 4);
        to.setZero();
        to.topRows(N) = j.template leftCols<3>() * minus;
      }
      if (jacobians[1] != nullptr) {
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, S, S == 1 ? Eigen::ColMajor : Eigen::RowMajor>> to(
            jacobians[1], num_residuals(), S);
        to.setZero();
        to.topRows(N) = j.template rightCols<S>();
      }
    }
    return true;
  }

  // Leaves the states as they are at the model; false where that is none.
  bool settle(const Model<Shape>& model) const {
    return accumulate(model.rotation.coeffs().data(), model.s.data());
  }
  Phase phase() const { return phase_; }
  const Matrix& hessian() const { return hessian_; }
  // How far the first Newton step moves the surface: the root of the weighted sum of squares of its movements
  // at the points.
  double first_step() const { return first_step_; }

 private:
  // Leaves the distances and curvatures in the states; false where the parameters are not permitted.
  bool accumulate(const double* quaternion, const double* s) const {
    if constexpr (requires { Shape::permitted(s); })
      if (!Shape::permitted(s)) return false;
    if (!std::equal(quaternion, quaternion + 4, at_.begin()) || !std::equal(s, s + S, at_.begin() + 4)) {
      std::copy(quaternion, quaternion + 4, at_.begin());
      std::copy(s, s + S, at_.begin() + 4);
      accumulate_at(Eigen::Map<const Eigen::Quaterniond>(quaternion).conjugate().toRotationMatrix(), s);
    }
    return gradient_.allFinite() && hessian_.allFinite();
  }

  void accumulate_at(const Matrix3d& to_local, const double* s) const {
    hessian_.setZero();
    gradient_.setZero();
    squares_ = 0;
    const Shape shape(s);
    Local<S> local;
    constexpr int block = 64;  // points at a time, so that sums run over vectors
    Eigen::Matrix<double, block, N> rows;
    Eigen::Matrix<double, block, 1> slopes, curvatures;
    int filled = 0;
    const auto add = [&] {
      rows.bottomRows(block - filled).setZero();
      slopes.tail(block - filled).setZero();
      curvatures.tail(block - filled).setZero();
      for (int k = 0; k < N; ++k) {
        const Eigen::Matrix<double, block, 1> scaled = curvatures.cwiseProduct(rows.col(k));
        for (int l = k; l < N; ++l) hessian_(l, k) += scaled.dot(rows.col(l));
        gradient_[k] += slopes.dot(rows.col(k));
      }
      filled = 0;
    };
    for (std::size_t i = 0; i < states_.d.size(); ++i) {
      const Vector3d p = to_local * (cloud_.col(static_cast<Eigen::Index>(i)) - origin_);
      shape.at(p, local);
      states_.set(i, local);
      double w, curvature;
      const double e = states_.error(i);
      if (phase_ == Phase::descend) {
        w = curvature = weights_[i];
      } else {
        const double r = e / noise_.sigma;
        if (!states_.kept[i]) continue;
        w = inlier_probability(e, noise_);
        curvature = convex_ ? w : w - w * (1 - w) * r * r;
      }
      if (w < 1e-12) continue;
      squares_ += w * e * e;
      slopes[filled] = w * e;
      curvatures[filled] = curvature;
      // Turning the frame by r moves the local point by p x r.
      const Vector3d turn = local.gradient.cross(p);
      for (int k = 0; k < 3; ++k) rows(filled, k) = turn[k];
      for (int k = 0; k < S; ++k) rows(filled, 3 + k) = local.by[static_cast<std::size_t>(k)];
      if (++filled == block) add();
    }
    add();
    hessian_.template triangularView<Eigen::StrictlyUpper>() = hessian_.transpose();
    // Far from the maximum the likelihood may curve the wrong way; the weighted squares never do.
    if (!convex_ && phase_ == Phase::score &&
        Eigen::SelfAdjointEigenSolver<Matrix>(hessian_, Eigen::EigenvaluesOnly).eigenvalues()[0] <
            -1e-9 * hessian_.trace()) {
      convex_ = true;
      accumulate_at(to_local, s);
    }
  }

  Phase phase_;
  const Eigen::Matrix3Xd& cloud_;
  Vector3d origin_;
  const Noise& noise_;
  PointStates& states_;
  const std::vector<double>& weights_;
  // Ceres calls from one thread; the last evaluation is kept.
  mutable std::array<double, 4 + S> at_{std::numeric_limits<double>::quiet_NaN()};
  mutable Matrix hessian_;
  mutable Vector gradient_;
  mutable std::optional<Compressed<N>> compressed_;
  mutable double squares_ = 0, first_step_ = -1;
  mutable bool convex_ = false;
};

struct Solved {
  bool usable = false, moved = false;
  int iterations = 0;
};

template <class Shape>
Solved solve(BatchedCost<Shape>& cost, Model<Shape>& model, int most_iterations, double parameter_tolerance,
             double function_tolerance) {
  if (!cost.settle(model)) return {};
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
  // Near the root the damping would show in long valleys.
  options.initial_trust_region_radius = cost.phase() == Phase::score ? 1e16 : 1e4;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {cost.settle(model) && summary.IsSolutionUsable(), summary.num_successful_steps > 1,
          static_cast<int>(summary.iterations.size())};
}

}  // namespace darboux::fit
