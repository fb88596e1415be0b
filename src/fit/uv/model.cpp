#include "model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <ceres/ceres.h>

#include "base/linear_algebra.h"
#include "fit/common/reduced_normal_equations.h"
#include "fit/common/rotation_manifold.h"
#include "fit/common/solve_quietly.h"

namespace darboux {

using namespace fit;

namespace {

constexpr std::size_t block_size = 64;

// The mixture's exponent for a squared distance.
double exponent(const Mixture& mixture, double square) {
  return 0.5 * square / (mixture.sigma * mixture.sigma);
}

// The sums of all points as one Ceres cost function whose size does not grow with them.
class SummedCost final : public ceres::CostFunction {
 public:
  SummedCost(const UvModel& model, const Mixture& mixture, const UvState& start)
      : model_(model), mixture_(mixture), state_(start), columns_(model.columns()) {
    set_num_residuals(columns_ + 1);
    *mutable_parameter_block_sizes() = {4, 3};
    if (columns_ > 6) mutable_parameter_block_sizes()->push_back(columns_ - 6);
  }

  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    std::vector<double> x(blocks[0], blocks[0] + 4);
    x.insert(x.end(), blocks[1], blocks[1] + 3);
    if (columns_ > 6) x.insert(x.end(), blocks[2], blocks[2] + columns_ - 6);
    // Ceres requests the cost of a step first and its Jacobian later: one pass computes both.
    if (x != at_) {
      at_ = x;
      reduce(state_of(model_, state_, x));
    }
    if (!residuals_.allFinite() || !root_.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, columns_ + 1) = residuals_;
    if (!jacobians) return true;
    if (jacobians[0]) {
      Eigen::Matrix<double, 3, 4, Eigen::RowMajor> minus;
      RotationManifold().MinusJacobian(blocks[0], minus.data());
      store(jacobians[0], root_.leftCols<3>() * minus);
    }
    if (jacobians[1]) store(jacobians[1], root_.middleCols<3>(3));
    if (columns_ > 6 && jacobians[2]) store(jacobians[2], root_.rightCols(columns_ - 6));
    return true;
  }

  static UvState state_of(const UvModel& model, UvState state, const std::vector<double>& x) {
    state.rotation.coeffs() = Eigen::Map<const Eigen::Vector4d>(x.data());
    state.translation = Eigen::Map<const Eigen::Vector3d>(x.data() + 4);
    std::size_t next = 7;
    for (const int k : model.free_parameters()) state.parameters[static_cast<std::size_t>(k)] = x[next++];
    for (const int k : model.free_affine) state.affine[static_cast<std::size_t>(k)] = x[next++];
    return state;
  }

 private:
  void reduce(const UvState& state) const {
    const UvSums sums = model_.sums(state, mixture_);
    const ReducedNormalEquations reduced(sums.hessian);
    residuals_ = Eigen::VectorXd(columns_ + 1);
    residuals_.head(columns_) = reduced(sums.gradient);
    residuals_[columns_] = remaining_residual(2 * sums.cost, residuals_.head(columns_));
    root_ = Eigen::MatrixXd::Zero(columns_ + 1, columns_);
    root_.topRows(columns_) = reduced.jacobian();
  }

  template <class Matrix>
  static void store(double* target, const Matrix& m) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(target, m.rows(),
                                                                                       m.cols()) = m;
  }

  const UvModel& model_;
  const Mixture& mixture_;
  const UvState& state_;
  int columns_;
  mutable std::vector<double> at_;
  mutable Eigen::VectorXd residuals_;
  mutable Eigen::MatrixXd root_;
};

// Infinite if a uv far from the patch leads out of the range of numbers: such a point is not near the
// surface.
double square_of(const Eigen::Vector3d& residual) {
  const double square = residual.squaredNorm();
  return std::isnan(square) ? std::numeric_limits<double>::infinity() : square;
}

// A value slightly inside an open bound: at the bound the surface is a line or a point.
double least(const Range& permitted) {
  return permitted.minimum_included ? permitted.minimum : permitted.minimum + 1e-12;
}

}  // namespace

std::vector<int> UvModel::free_parameters() const {
  std::vector<int> list;
  for (int k = 0; k < kind->parameter_count(); ++k)
    if (!held[static_cast<std::size_t>(k)]) list.push_back(k);
  return list;
}

UvConvention UvModel::whole_convention(const UvState& state) const {
  if (state.affine == identity_map) return convention;
  const auto& a = state.affine;
  const auto& c = convention.affine;
  return {"affine",
          {a[0] * c[0] + a[1] * c[2], a[0] * c[1] + a[1] * c[3], a[2] * c[0] + a[3] * c[2],
           a[2] * c[1] + a[3] * c[3], a[0] * c[4] + a[1] * c[5] + a[4], a[2] * c[4] + a[3] * c[5] + a[5]}};
}

UvSpread UvModel::spread(const UvState& state, const UvSums& sums) const {
  const int count = kind->parameter_count();
  std::vector<Eigen::Index> open, place;  // columns of the sums that are estimated, and theirs in the result
  const auto estimated = [&](Eigen::Index column, Eigen::Index in_result) {
    open.push_back(column);
    place.push_back(in_result);
  };
  if (!placement_held)
    for (int k = 0; k < 6; ++k) estimated(k, k);
  Eigen::Index next = 6;
  for (const int k : free_parameters()) {
    const auto p = static_cast<std::size_t>(k);
    const Range& permitted = kind->parameters[p].permitted;
    const bool at_bound = permitted.minimum_included && state.parameters[p] <= permitted.minimum;
    if (!at_bound) estimated(next, 6 + k);
    ++next;
  }
  for (const int k : free_affine) estimated(next++, 6 + count + k);
  UvSpread result{Eigen::MatrixXd::Zero(12 + count, 12 + count)};
  if (open.empty()) return result;
  // Inverse of the information, scaled to a unit diagonal.
  const Eigen::MatrixXd information = sums.hessian(open, open);
  const Eigen::VectorXd scale =
      information.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  const auto [values, vectors] =
      symmetric_eigen(Eigen::MatrixXd(scale.asDiagonal() * information * scale.asDiagonal()));
  if (!(values[0] > 1e-13)) {
    Eigen::Index most = 0;
    vectors.col(0).cwiseAbs().maxCoeff(&most);
    const Eigen::Index what = place[static_cast<std::size_t>(most)];
    result.undetermined = what < 3   ? "direction"
                          : what < 6 ? "place"
                          : what < 6 + count
                              ? std::string(kind->parameters[static_cast<std::size_t>(what - 6)].name)
                              : "uv map";
    return result;
  }
  const Eigen::MatrixXd root = scale.asDiagonal() * vectors * values.cwiseSqrt().cwiseInverse().asDiagonal();
  result.covariance(place, place) = root * root.transpose();
  return result;
}

SurfaceUncertainty UvModel::uncertainty(const UvState& state, const Eigen::MatrixXd& covariance,
                                        const Eigen::Vector3d& about) const {
  const int count = kind->parameter_count(), dimension = 6 + count + (free_affine.empty() ? 0 : 6);
  // From (rotation in the body's axes, translation, ...) to (ω, τ, ...) about the centre.
  const Eigen::Matrix3d rotation = state.rotation.toRotationMatrix();
  const Eigen::Vector3d arm = state.translation - about;
  Eigen::MatrixXd to = Eigen::MatrixXd::Identity(dimension, dimension);
  to.topLeftCorner<3, 3>() = rotation;
  to.block<3, 3>(3, 0) = points->scale * cross_matrix(arm) * rotation;  // τ = δt - ω x arm
  to.block<3, 3>(3, 3) *= points->scale;
  for (int k = 0; k < count; ++k)
    if (kind->length[static_cast<std::size_t>(k)]) to(6 + k, 6 + k) = points->scale;
  if (!free_affine.empty()) {
    // From the affine map to the whole one, affine(convention(stored)), in which it is linear.
    const auto& c = convention.affine;
    for (int row = 0; row < 2; ++row) {
      const int m = 6 + count + 2 * row, o = 6 + count + 4 + row;
      to.block<2, 2>(m, m) << c[0], c[2], c[1], c[3];
      to.block<1, 2>(o, m) << c[4], c[5];
    }
  }
  return {to * covariance.topLeftCorner(dimension, dimension) * to.transpose(),
          points->scale * about + points->centre};
}

UvState UvModel::moved(const UvState& state, const Eigen::VectorXd& step) const {
  UvState result = state;
  RotationManifold().Plus(state.rotation.coeffs().data(), step.data(), result.rotation.coeffs().data());
  result.rotation.normalize();
  result.translation += step.segment<3>(3);
  Eigen::Index next = 6;
  for (const int k : free_parameters()) {
    const Range& permitted = kind->parameters[static_cast<std::size_t>(k)].permitted;
    double& p = result.parameters[static_cast<std::size_t>(k)];
    p = std::clamp(p + step[next++], least(permitted), permitted.maximum);
  }
  for (const int k : free_affine) result.affine[static_cast<std::size_t>(k)] += step[next++];
  return result;
}

struct UvModel::Rows {
  std::vector<Vec2<double>> uvs;
  UvBlock block;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;  // without rows if not requested
};

// Residuals and Jacobian of a block of points in the body's axes; the translation's columns are the body's
// too.
void UvModel::fill(const UvState& state, std::size_t first, std::size_t count, bool derivatives,
                   Rows& to) const {
  const auto rows = static_cast<Eigen::Index>(3 * count);
  if (to.residual.size() != rows) {
    const Eigen::Index of_jacobian = derivatives ? rows : 0;
    to.residual.resize(rows);
    to.jacobian = Eigen::MatrixXd::Zero(of_jacobian, columns());
    to.block = {Eigen::VectorXd(rows), Eigen::MatrixXd(of_jacobian, kind->parameter_count()),
                Eigen::MatrixXd(free_affine.empty() ? 0 : of_jacobian, 2)};
  }
  const UvConvention affine{"", state.affine};
  to.uvs.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    to.uvs[i] = affine.surface_uv(convention.surface_uv(points->uvs[first + i]));
  kind->evaluate(state.parameters.data(), to.uvs, to.block);
  const Eigen::Matrix3d inverse = state.rotation.toRotationMatrix().transpose();
  Eigen::MatrixXd& jacobian = to.jacobian;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    const Eigen::Vector3d p = to.block.position.segment<3>(row);
    to.residual.segment<3>(row) =
        p + inverse * (state.translation - points->cloud.col(static_cast<Eigen::Index>(first + i)));
    if (!derivatives) continue;
    jacobian(row + 1, 0) = -p.z(), jacobian(row + 2, 0) = p.y();
    jacobian(row, 1) = p.z(), jacobian(row + 2, 1) = -p.x();
    jacobian(row, 2) = -p.y(), jacobian(row + 1, 2) = p.x();
    jacobian(row, 3) = jacobian(row + 1, 4) = jacobian(row + 2, 5) = 1;
  }
  if (!derivatives) return;
  Eigen::Index next = 6;
  for (const int k : free_parameters()) jacobian.col(next++) = to.block.by_parameter.col(k);
  for (const int k : free_affine) {
    const int along = k == 0 || k == 1 || k == 4 ? 0 : 1;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2<double> uv = convention.surface_uv(points->uvs[first + i]);
      const double factor = k > 3 ? 1 : k % 2 == 0 ? uv.x : uv.y;
      const auto row = static_cast<Eigen::Index>(3 * i);
      jacobian.block<3, 1>(row, next) = factor * to.block.by_uv.block<3, 1>(row, along);
    }
    ++next;
  }
}

template <class Each>
void UvModel::for_each_block(const UvState& state, bool derivatives, Each each) const {
  Rows rows;
  for (std::size_t first = 0; first < points->count(); first += block_size) {
    const std::size_t count = std::min(block_size, points->count() - first);
    fill(state, first, count, derivatives, rows);
    each(first, count, rows);
  }
}

UvSums UvModel::sums(const UvState& state, const Mixture& mixture, std::vector<double>* squares) const {
  const int m = columns();
  UvSums result{0, Eigen::VectorXd::Zero(m), Eigen::MatrixXd::Zero(m, m)};
  if (squares) squares->resize(points->count());
  const double precision = 1 / (mixture.sigma * mixture.sigma);
  for_each_block(state, true, [&](std::size_t first, std::size_t count, Rows& rows) {
    Eigen::MatrixXd& jacobian = rows.jacobian;
    Eigen::VectorXd& residual = rows.residual;
    double cost = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = static_cast<Eigen::Index>(3 * i);
      const double square = square_of(residual.segment<3>(row)), half = 0.5 * precision * square;
      if (squares) (*squares)[first + i] = square;
      cost -= mixture.log_likelihood_ratio(half);
      if (mixture.outliers == 0) continue;
      const double weight = mixture.inlier_probability(half);  // the derivative of the cost by `half`
      if (weight > 1e-30) {
        const double root = std::sqrt(weight);
        residual.segment<3>(row) *= root;
        jacobian.middleRows<3>(row) *= root;
      } else {
        residual.segment<3>(row).setZero();
        jacobian.middleRows<3>(row).setZero();
      }
    }
    result.cost += cost;
    for (int k = 0; k < m; ++k) {
      for (int l = k; l < m; ++l) result.hessian(l, k) += jacobian.col(k).dot(jacobian.col(l));
      result.gradient[k] += jacobian.col(k).dot(residual);
    }
  });
  result.hessian.triangularView<Eigen::StrictlyUpper>() = result.hessian.transpose();
  result.hessian *= precision;
  result.gradient *= precision;
  // The translation's columns from the body's axes to those of the points.
  const Eigen::Matrix3d rotation = state.rotation.toRotationMatrix();
  result.gradient.segment<3>(3) = rotation * result.gradient.segment<3>(3);
  result.hessian.middleCols<3>(3) *= rotation.transpose();
  result.hessian.middleRows<3>(3) = rotation * result.hessian.middleRows<3>(3).eval();
  return result;
}

std::vector<double> UvModel::squares(const UvState& state) const {
  std::vector<double> result(points->count());
  for_each_block(state, false, [&](std::size_t first, std::size_t count, const Rows& rows) {
    for (std::size_t i = 0; i < count; ++i)
      result[first + i] = square_of(rows.residual.segment<3>(static_cast<Eigen::Index>(3 * i)));
  });
  return result;
}

UvModel::Residuals UvModel::residuals(const UvState& state) const {
  const auto n = static_cast<Eigen::Index>(points->count());
  Residuals result{Eigen::Matrix3Xd(3, n), Eigen::Matrix3Xd(3, n)};
  for_each_block(state, false, [&](std::size_t first, std::size_t count, Rows& rows) {
    const auto at = static_cast<Eigen::Index>(first), size = static_cast<Eigen::Index>(count);
    result.errors.middleCols(at, size) = rows.residual.reshaped(3, size);
    result.places.middleCols(at, size) = rows.block.position.reshaped(3, size);
  });
  return result;
}

Eigen::MatrixXd UvModel::jacobian(const UvState& state, std::size_t most) const {
  Rows rows;
  fill(state, 0, std::min(most, points->count()), true, rows);
  return rows.jacobian;
}

Solved UvModel::solve(UvState& state, const Mixture& mixture, double tolerance, int most_steps) const {
  const std::vector<int> free = free_parameters();
  std::vector<double> rest;
  for (const int k : free) {
    const Range& permitted = kind->parameters[static_cast<std::size_t>(k)].permitted;
    rest.push_back(
        std::clamp(state.parameters[static_cast<std::size_t>(k)], least(permitted), permitted.maximum));
  }
  for (const int k : free_affine) rest.push_back(state.affine[static_cast<std::size_t>(k)]);
  double* const rotation = state.rotation.coeffs().data();
  double* const translation = state.translation.data();
  if (placement_held && rest.empty()) return {true, 0};

  std::vector<double*> blocks{rotation, translation};
  if (!rest.empty()) blocks.push_back(rest.data());
  const UvState start = state;
  SummedCost cost(*this, mixture, start);
  RotationManifold manifold;
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, blocks);
  problem.SetManifold(rotation, &manifold);
  if (placement_held) {
    problem.SetParameterBlockConstant(rotation);
    problem.SetParameterBlockConstant(translation);
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    const Range& permitted = kind->parameters[static_cast<std::size_t>(free[i])].permitted;
    if (std::isfinite(permitted.minimum))
      problem.SetParameterLowerBound(rest.data(), static_cast<int>(i), least(permitted));
    if (std::isfinite(permitted.maximum))
      problem.SetParameterUpperBound(rest.data(), static_cast<int>(i), permitted.maximum);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = most_steps;
  options.function_tolerance = tolerance * tolerance;
  options.gradient_tolerance = 1e-16;
  options.parameter_tolerance = tolerance;
  // Steps are cut at the bounds; a search along each of them costs more than it gains.
  options.max_num_line_search_step_size_iterations = 0;
  const ceres::Solver::Summary summary = solve_quietly(options, problem);
  std::vector<double> x(rotation, rotation + 4);
  x.insert(x.end(), translation, translation + 3);
  x.insert(x.end(), rest.begin(), rest.end());
  state = SummedCost::state_of(*this, start, x);
  state.rotation.normalize();
  return {summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE,
          static_cast<int>(summary.iterations.size())};
}

void UvModel::polish(UvState& state, MixtureInVolume& mixture, int most) const {
  const std::vector<int> free = free_parameters();
  constexpr double last_digits = 1e-13;
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most; ++i) {
    std::vector<double> squares;
    UvSums sums = this->sums(state, mixture, &squares);
    // Parameters that are held, or press against their bounds, stay.
    std::vector<Eigen::Index> still;
    if (placement_held) still = {0, 1, 2, 3, 4, 5};
    for (std::size_t k = 0; k < free.size(); ++k) {
      const auto p = static_cast<std::size_t>(free[k]);
      const auto column = static_cast<Eigen::Index>(6 + k);
      if (state.parameters[p] <= least(kind->parameters[p].permitted) && sums.gradient[column] >= 0)
        still.push_back(column);
    }
    for (const Eigen::Index k : still) {
      sums.hessian.row(k).setZero();
      sums.hessian.col(k).setZero();
      sums.gradient[k] = 0;
    }
    const Eigen::VectorXd scale =
        sums.hessian.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
    const Eigen::MatrixXd scaled = scale.asDiagonal() * sums.hessian * scale.asDiagonal();
    const Eigen::VectorXd step =
        -(scale.asDiagonal() * solve_least_norm(scaled, Eigen::VectorXd(scale.asDiagonal() * sums.gradient)));
    const double length = step.norm();
    if (!(length < last)) return;  // only rounding is left
    state = moved(state, step);
    if (mixture.outliers > 0) update(mixture, squares, *points);
    double next = length;
    if (mixture.outliers == 0) {  // about this step times it and the residuals
      const double rms = std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) /
                                   static_cast<double>(squares.size()));
      next = length * std::fmin(1, 10 * (length + rms));
    }
    if (next < last_digits) return;
    last = length;
  }
}

Solved UvModel::maximise(UvState& state, MixtureInVolume& mixture) const {
  Solved result;
  for (int round = 0; round < 20; ++round) {
    const MixtureInVolume before = mixture;
    const Solved solved = solve(state, mixture, round == 0 ? 1e-6 : 1e-8);
    result = {solved.converged, result.iterations + solved.iterations};
    update(mixture, squares(state), *points);
    if (!solved.converged) break;
    if (std::fabs(mixture.sigma - before.sigma) < 1e-3 * mixture.sigma &&
        std::fabs(mixture.share - before.share) < 1e-3)
      break;
  }
  return result;
}

double inlier_probability(const Mixture& mixture, double square) {
  return mixture.inlier_probability(exponent(mixture, square));
}

double log_likelihood(const MixtureInVolume& mixture, const std::vector<double>& squares) {
  double sum = 0;
  for (const double s : squares) sum += mixture.log_likelihood(exponent(mixture, s));
  return sum;
}

void update(MixtureInVolume& mixture, const std::vector<double>& squares, const NormalisedPoints& points) {
  const auto n = static_cast<double>(squares.size());
  for (int round = 0; round < 50; ++round) {
    const MixtureInVolume before = mixture;
    ExpectedInliers expected;
    double spread = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const double w = inlier_probability(mixture, squares[i]);
      if (!(w > 1e-30)) continue;
      const auto p = points.cloud.col(static_cast<Eigen::Index>(i));
      expected.add(w, w * squares[i]);
      mean += w * p;
      spread += w * p.squaredNorm();
    }
    if (!(expected.count > 0)) return;  // no point is near: left unchanged
    mean /= expected.count;
    const double extent = std::sqrt(std::fmax(spread / expected.count - mean.squaredNorm(), 1e-20));
    mixture.volume = 4.0 / 3 * std::numbers::pi * std::pow(2 * extent, 3);
    mixture.share = (n - expected.count + 0.5) / (n + 1);
    expected.estimate_sigma(mixture, 3, points.least_sigma());
    mixture.compare_densities();
    if (std::fabs(mixture.sigma - before.sigma) < 1e-15 * mixture.sigma &&
        std::fabs(mixture.share - before.share) < 1e-15)
      return;
    if (round >= 3 && std::fabs(mixture.sigma - before.sigma) < 1e-6 * mixture.sigma) return;
  }
}

}  // namespace darboux
