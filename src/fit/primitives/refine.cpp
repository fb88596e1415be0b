#include "refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "base/linear_algebra.h"
#include "cost.h"
#include "determinacy.h"
#include "fit/common/kinds.h"
#include "geometry.h"
#include "support.h"

namespace darboux::fit {
namespace {

using Eigen::Matrix3Xd;

// The rotation vector from the frame before to the frame after, as far as the primitive has an orientation.
Vector3d turn_between(Orientation orientation, const Vector3d& axis, const Matrix3d& before,
                      const Matrix3d& after) {
  switch (orientation) {
    case Orientation::none:
      return Vector3d::Zero();
    case Orientation::axis:
      return axis.cross(after.col(2) - before.col(2));  // a turn about the axis means nothing
    case Orientation::frame:
      break;
  }
  const Eigen::AngleAxisd rotation(Matrix3d(after * before.transpose()));
  return rotation.angle() * rotation.axis();
}

// Refines over all points: updates mixture, bias and support from the last estimate, then makes a step or
// two, until nothing moves. First the robust phase, then the root of the likelihood's gradient.
class Refinement {
 public:
  Refinement(const SearchProblem& problem, const Hypothesis& hypothesis)
      : problem_(problem),
        primitive_(*hypothesis.primitive),
        states_(static_cast<std::size_t>(problem.cloud.cols())),
        mixture_(hypothesis.mixture),
        model_(primitive_.localise(hypothesis.surface, hypothesis.at)),
        has_outliers_(hypothesis.mixture.outliers > 0),
        hessian_(
            Eigen::MatrixXd::Zero(3 + primitive_.distance.parameters, 3 + primitive_.distance.parameters)) {
    if (problem.sigma) mixture_.sigma = *problem.sigma, mixture_.sigma_known = true;
    primitive_.distance.measure(problem.cloud, model_, states_);
  }

  void run() {
    double share = 0;
    for (int round = 0; round < 100; ++round) {
      problem_.progress(share += 0.1 * (1 - share));
      if (!step()) return;
    }
  }

  PrimitiveFit result() {
    PrimitiveFit fit;
    fit.primitive = &primitive_;
    fit.converged = converged_;
    fit.iterations = iterations_;
    fit.surface = primitive_.geometric(model_);
    fit.sigma = mixture_.sigma;
    fit.sigma_known = mixture_.sigma_known;
    // Noise too small to be measured does not dither.
    fit.rounding = mixture_.sigma > mixture_.least_sigma ? problem_.rounding : mixture_.least_sigma;
    fit.outliers = mixture_.outliers;
    fit.doubles_itself = doubles_itself(primitive_, fit.surface, problem_.cloud, fit.sigma);
    const std::vector<double> weights = inlier_probabilities(states_, mixture_);
    fit.circle_deviation = algebraic_circle(problem_.cloud, weights).deviation;
    fit.error.resize(states_.d.size());
    for (std::size_t i = 0; i < fit.error.size(); ++i) fit.error[i] = states_.error(i);
    fit.in_support = std::move(states_.in_support);
    fit.reference = model_.origin;
    return fit;
  }

  // Only for refined fits.
  void add_covariance(PrimitiveFit& fit) const {
    // Leaves out the turn about the normal if that changes nothing.
    const int all = 3 + primitive_.distance.parameters;
    std::vector<int> free;
    for (int k = 0; k < all; ++k)
      if (primitive_.unknowns == all || k != 2) free.push_back(k);
    const auto [values, vectors] = symmetric_eigen(Eigen::MatrixXd(hessian_(free, free)));
    // Smaller values are rounding: the turn of an ellipsoid of revolution would spoil everything else.
    const double rounding = std::max(0x1p-52 * values.maxCoeff(), 1e-300);
    const Eigen::VectorXd inverse = values.cwiseMax(rounding).cwiseInverse();
    fit.largest_deviation = std::sqrt(inverse[0]);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(all, all);
    covariance(free, free) =
        mixture_.sigma * mixture_.sigma * vectors * inverse.asDiagonal() * vectors.transpose();
    const GeometricDerivatives by = geometric_derivatives(primitive_, model_, fit.reference);
    fit.covariance = by * covariance * by.transpose();
  }

 private:
  // \returns false at the end.
  bool step() {
    if (supports_ == 0) states_.in_support = states_.regular;
    update_bias(mixture_, states_);
    const Mixture mixture_before = mixture_;
    update(mixture_, states_, phase_ == Phase::robust);
    if (mixture_.inliers < primitive_.unknowns && have_before_) {  // the last step failed, in a long valley
      model_ = before_;
      hessian_ = hessian_before_;
      mixture_ = mixture_before;
      primitive_.distance.measure(problem_.cloud, model_, states_);
      states_.in_support = states_.regular;
      const bool was_newton = std::exchange(phase_, Phase::robust) == Phase::score;
      near_ *= 0.1;
      return was_newton;
    }
    if (phase_ == Phase::robust) weights_ = inlier_probabilities(states_, mixture_);
    BatchedCost cost(primitive_, phase_, problem_.cloud, model_.origin, mixture_, states_, weights_);
    before_ = model_;
    const Solved solved = solve(cost, model_, phase_ == Phase::score ? 1 : 12, 1e-15,
                                phase_ == Phase::robust && near_ == 1 ? 1e-7 : 1e-20);
    iterations_ += solved.iterations;
    if (!solved.usable) return false;
    hessian_before_ = have_before_ ? hessian_ : cost.hessian();
    hessian_ = cost.hessian();
    have_before_ = true;
    return decide(cost.first_step() / std::sqrt(mixture_.inliers), solved.moved);
  }

  // Decides what to do after a step from before_ with this first movement. \returns false if it converged
  bool decide(double movement, bool moved) {
    // Rounding of the distances moves the surface by at most 1e-14.
    const double standard_error = mixture_.sigma * std::sqrt(primitive_.unknowns / mixture_.inliers);
    const bool small = movement <= 3 * standard_error + 1e-14;
    since_support_ += movement / (standard_error + 1e-14);
    if (phase_ == Phase::score && !small) {  // too far for a root to be trusted
      model_ = before_;
      primitive_.distance.measure(problem_.cloud, model_, states_);
      phase_ = Phase::robust;
      near_ *= 0.1;
    } else if (small && has_outliers_ && since_support_ > 0.1 && supports_ < 8) {
      sparse_ = find_support(primitive_, problem_.cloud, primitive_.geometric(model_), mixture_, states_);
      if (sparse_points_count_) take_sparse_points();
      ++supports_;
      since_support_ = 0;
    } else if (movement <= 1e-15 + (phase_ == Phase::score ? 1e-9 : 1e-6) * standard_error) {
      if (!sparse_points_count_ && are_on_the_surface(sparse_)) {
        sparse_points_count_ = true;
        take_sparse_points();
        phase_ = Phase::robust;
        return true;
      }
      converged_ = true;
      return false;
    } else if (phase_ == Phase::score && !moved) {
      phase_ = Phase::robust;
      near_ *= 1e-3;
    }
    if (phase_ == Phase::robust && movement <= near_ * standard_error + 1e-14) phase_ = Phase::score;
    // At the bottom of a long valley, as far as rounding permits steps.
    without_a_step_ = moved || phase_ == Phase::score ? 0 : without_a_step_ + 1;
    return without_a_step_ < 4;
  }

  void take_sparse_points() {
    for (const Eigen::Index i : sparse_) states_.in_support[static_cast<std::size_t>(i)] = 1;
  }

  // Whether the fit of the others explains these points, as far as it is known: a score test [Rao1948]. With
  // J the derivatives of their distances e, J'e has the covariance sigma^2 (H + H C H), H = J'J, sigma^2 C
  // that of the fit.
  bool are_on_the_surface(const std::vector<Eigen::Index>& points) const {
    if (points.empty()) return false;
    const auto count = static_cast<Eigen::Index>(points.size());
    Matrix3Xd cloud(3, count);
    Eigen::VectorXd errors(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto i = points[static_cast<std::size_t>(k)];
      const double e = states_.error(static_cast<std::size_t>(i));
      cloud.col(k) = problem_.cloud.col(i);
      errors[k] = inlier_probability(e, mixture_) * e;
    }
    Eigen::MatrixXd jacobian;
    primitive_.distance.jacobian(cloud, model_, jacobian);
    const Eigen::MatrixXd h = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * errors / mixture_.sigma;
    const auto [values, vectors] = symmetric_eigen(Eigen::MatrixXd(h + h * determined_inverse(hessian_) * h));
    double sum = 0, rank = 0;
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      if (!(values[k] > 1e-12 * values.maxCoeff())) continue;
      const double along = vectors.col(k).dot(gradient);
      sum += along * along / values[k];
      ++rank;
    }
    return sum < rank + 2 * std::sqrt(2 * rank);  // chi^2: about one in twenty is more
  }

  const SearchProblem& problem_;
  const Primitive& primitive_;
  PointStates states_;
  Mixture mixture_;
  LocalModel model_, before_;
  bool has_outliers_;  // else all points are in the support
  Eigen::MatrixXd hessian_, hessian_before_;
  Phase phase_ = Phase::robust;
  std::vector<double> weights_;
  std::vector<Eigen::Index> sparse_;  // of the last support: see find_support
  bool sparse_points_count_ = false;
  int supports_ = 0, iterations_ = 0, without_a_step_ = 0;
  // Movements since the support was last found, in standard errors.
  double since_support_ = std::numeric_limits<double>::infinity();
  // How near to the root the search must end, in standard errors. A root that cannot be reached is left to
  // the robust phase.
  double near_ = 1;
  bool converged_ = false, have_before_ = false;
};

// The same surface through all points, none an outlier.
PrimitiveFit with_all_points(const SearchProblem& problem, Hypothesis hypothesis, const PrimitiveFit& fit) {
  double squares = 0;
  for (const double e : fit.error) squares += e * e;
  hypothesis.surface = fit.surface;
  hypothesis.mixture.sigma = std::sqrt(squares / static_cast<double>(fit.error.size()));
  hypothesis.mixture.outliers = 0;
  Refinement refinement(problem, hypothesis);
  refinement.run();
  PrimitiveFit all = refinement.result();
  refinement.add_covariance(all);
  return all;
}

}  // namespace

GeometricDerivatives geometric_derivatives(const Primitive& primitive, const LocalModel& model,
                                           const Vector3d& reference) {
  const int n = 3 + primitive.distance.parameters;
  GeometricDerivatives by(9, n);
  const GeometricParameters centre = primitive.geometric(model);
  for (int k = 0; k < n; ++k) {
    double size = 1e-5;
    // The step of a curvature is relative: radii may be large.
    if (k == 4 && primitive.second_parameter_is_curvature) size *= std::min(1.0, std::fabs(model.s[1]));
    std::array<GeometricParameters, 2> moved;
    for (int side = 0; side < 2; ++side) {
      LocalModel m = model;
      const double step = (side == 0 ? -1 : 1) * size;
      if (k < 3)
        m.rotation = m.rotation * Eigen::Quaterniond(Eigen::AngleAxisd(step, Vector3d::Unit(k)));
      else
        m.s[static_cast<std::size_t>(k - 3)] += step;
      moved[static_cast<std::size_t>(side)] = primitive.geometric(m);
    }
    const Vector3d turn =
        turn_between(primitive.orientation, centre.axes.col(2), moved[0].axes, moved[1].axes) / (2 * size);
    const Vector3d shift = (moved[1].centre - moved[0].centre) / (2 * size);
    by.col(k).head<3>() = turn;
    by.col(k).segment<3>(3) = shift - turn.cross(centre.centre - reference);
    for (std::size_t l = 0; l < 3; ++l)
      by(6 + static_cast<Eigen::Index>(l), k) = (moved[1].lengths[l] - moved[0].lengths[l]) / (2 * size);
  }
  return by;
}

PrimitiveFit refine(const SearchProblem& problem, const Hypothesis& hypothesis, bool give_up) {
  // In larger sets with uniform noise, no part lies this close to a surface by chance.
  constexpr std::size_t few_points = 100;
  Refinement refinement(problem, hypothesis);
  if (!give_up) refinement.run();
  PrimitiveFit fit = refinement.result();
  fit.iterations += hypothesis.iterations;
  fit.given_up = give_up;
  if (give_up) return fit;
  refinement.add_covariance(fit);
  if (problem.sigma || fit.error.size() > few_points || count_inliers(fit) == std::ssize(fit.error))
    return fit;
  // The likelihood of a mixture has a second maximum where a part of the points, up to half, lies close to
  // one surface by chance: their distances are taken for the noise, and the other points for outliers. So
  // outliers are assumed only if they make the points likelier than noise alone does.
  PrimitiveFit all = with_all_points(problem, hypothesis, fit);
  all.iterations += fit.iterations;
  return log_likelihood_ratio(fit) - log_likelihood_ratio(all) > 0.5 * margin ? fit : all;
}

}  // namespace darboux::fit
