#include "fit_matrix.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/LU>

namespace darboux::matrix {
namespace {

// The largest bound of a standard error of lengths and, in radians, of angles.
double largest_standard_error(const SyntheticPoints& points) {
  const Eigen::MatrixXd covariance = unit_information(points).inverse();
  const double sigma = points.sigma / points.scale;
  const double largest = covariance.diagonal().maxCoeff();
  return std::isfinite(largest) && largest > 0 && covariance.diagonal().minCoeff() > 0
             ? sigma * std::sqrt(largest)
             : std::numeric_limits<double>::infinity();
}

const ConfidenceInterval* interval_named(const PointFit& fit, std::string_view name) {
  for (const ConfidenceInterval& i : fit.intervals)
    if (i.name == name) return &i;
  return nullptr;
}

// Of the true surface as the fit names it: its axes in another order or direction are the same surface.
struct TrueQuantities {
  std::vector<double> parameters;   // those that the points determine, in the fit's order; else NaN
  double axis_deg = 0, centre = 0;  // how far the fit is off
};

TrueQuantities true_quantities(const SyntheticPoints& points, const PlacedSurface& fit) {
  const TrueShape shape(points);
  const Eigen::Isometry3d& truth = points.truth.placement;
  const Eigen::Matrix3d turn = truth.linear().transpose() * fit.placement.linear();
  const Eigen::Vector3d at = truth.inverse() * fit.placement.translation();
  std::vector<double> values;
  for (const double x : shape.values) values.push_back(x * points.scale);
  constexpr double degrees = 180 / std::numbers::pi;
  TrueQuantities q;
  Eigen::Vector3d axis = turn.col(2);
  const double off = std::atan2(axis.head<2>().norm(), shape.kind == "cone" ? axis.z() : std::fabs(axis.z()));
  q.axis_deg = degrees * off;
  q.centre = at.norm();
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  if (shape.kind == "plane") {
    q.parameters = {unknown, unknown};
    q.centre = std::fabs(at.z());
  } else if (shape.kind == "cylinder") {
    q.parameters = {values[0], unknown};
    q.centre = at.head<2>().norm();
  } else if (shape.kind == "cone") {
    const double height = parameter_of(fit.surface, "height");
    q.parameters = {height * values[0] / values[1], unknown};
    q.centre = (at - Eigen::Vector3d(0, 0, values[1] - height)).norm();
  } else if (shape.kind == "ellipsoid") {
    Eigen::Matrix3d nearest = Eigen::Matrix3d::Identity();
    for (const Eigen::Matrix3d& cube : cube_turns())
      if ((turn * cube).trace() > (turn * nearest).trace()) nearest = cube;
    const Eigen::Vector3d named = (nearest * Eigen::Vector3d(values[0], values[1], values[2])).cwiseAbs();
    q.parameters = {named[0], named[1], named[2]};
    const Eigen::Vector3d z = turn.col(2);
    q.axis_deg = degrees * std::acos(std::min(1.0, z.cwiseAbs().maxCoeff()));
  } else {
    q.parameters = values;
  }
  return q;
}

void judge_intervals(const SyntheticPoints& points, const PointFit& fit, std::uint64_t seed, Run& run) {
  const TrueQuantities truth = true_quantities(points, *fit.surface);
  const auto names = fit.surface->surface.parameters();
  for (std::size_t k = 0; k < names.size(); ++k)
    if (const ConfidenceInterval* i = interval_named(fit, names[k].name)) {
      ++run.parameters;
      run.covered += i->low <= truth.parameters[k] && truth.parameters[k] <= i->high;
    }
  if (const ConfidenceInterval* i = interval_named(fit, "axis_deg")) run.axis = truth.axis_deg <= i->high;
  if (const ConfidenceInterval* i = interval_named(fit, "centre")) run.centre = truth.centre <= i->high;
  PortableRandom random(seed);
  const Eigen::Vector3d foot = points.feet[random.below(points.feet.size())];
  const Eigen::Matrix3d frame_of_truth = true_frame(points, *fit.surface, foot);
  const UncertainFrame found = frame_near(fit, from_eigen(points.truth.placement * (points.scale * foot)));
  Eigen::Matrix3d frame;
  frame << to_eigen(found.t), to_eigen(found.b), to_eigen(found.n);
  const Eigen::Vector3d n = frame.transpose() * frame_of_truth.col(2);
  const Eigen::Vector2d tilt(n.y(), -n.x());
  if (std::isfinite(found.normal_deg))
    run.normal = tilt.dot(found.covariance.topLeftCorner<2, 2>().inverse() * tilt) <= 5.991464547107979;
}

}  // namespace

Run run_of(const Cell& cell, std::uint64_t number, const Asked& asked) {
  SyntheticPoints points = points_of(cell, number);
  const std::string kind(kinds[cell.kind]);
  Run run;
  run.largest_bound = largest_standard_error(points);
  const PointFit fit = fit_points(points.cloud, {.surface = kind, .seed = number + 1});
  run.usable = fit.usable;
  run.reason = fit.reason;
  run.seconds = fit.seconds;
  if (fit.usable) {
    run.mahalanobis = mahalanobis_per_parameter(points, *fit.surface);
    const Outliers& o = outliers[cell.outliers];
    // Where two surfaces have as many points each and the named kind may be either, either is right: the fit
    // is judged by the nearer one.
    if (o.pattern == OutlierPattern::second_surface && o.share >= 0.5 &&
        (kind == "sphere" || kind == "ellipsoid")) {
      SyntheticPoints second = with_second_as_truth(points, kind);
      const double of_second = mahalanobis_per_parameter(second, *fit.surface);
      if (of_second < run.mahalanobis) {
        run.is_second = true;
        run.mahalanobis = of_second;
        run.largest_bound = largest_standard_error(second);
        points = std::move(second);
      }
    }
    judge_intervals(points, fit, number, run);
  }
  run.automatic = asked.automatic;
  if (asked.automatic) {
    const PointFit found = fit_points(points.cloud, {.seed = number + 1});
    if (found.usable) run.found = found.surface->surface.info().name;
    run.auto_reason = found.reason;
    run.seconds += found.seconds;
  }
  if (asked.told && fit.usable) {
    PointCloud inliers;
    for (std::size_t i = 0; i < points.is_inlier.size(); ++i)
      if (points.is_inlier[i]) inliers.positions.push_back(points.cloud.positions[i]);
    const PointFit told = fit_points(
        inliers, {.surface = kind, .noise = points.sigma, .guess = points.truth, .seed = number + 1});
    if (told.usable) run.told = mahalanobis_per_parameter(points, *told.surface);
  }
  return run;
}

}  // namespace darboux::matrix
