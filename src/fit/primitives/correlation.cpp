#include "correlation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "determinacy.h"
#include "fit/common/lack_of_fit.h"
#include "geometry.h"

namespace darboux::fit {
namespace {

std::vector<Eigen::Index> indices_of(const std::vector<bool>& is_inlier) {
  std::vector<Eigen::Index> inliers;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) inliers.push_back(static_cast<Eigen::Index>(i));
  return inliers;
}

// The two coordinates of the points' feet, a row each. Those of the points depend on their errors.
Eigen::Matrix2Xd coordinates_of_feet(Eigen::Matrix3Xd points, const PrimitiveFit& fit,
                                     const LocalModel& model) {
  Eigen::Matrix3Xd feet;
  fit.primitive->distance.foot_points(points, model, feet);
  points = (model.rotation.toRotationMatrix() * feet).colwise() + model.origin;
  const Vector3d mean = points.rowwise().mean();
  const Eigen::Matrix3Xd q = points.colwise() - mean;
  const SupportChart& chart = fit.primitive->support;
  const GeometricParameters frame = chart.frame(fit.surface, mean, q * q.transpose());
  Eigen::Matrix2Xd result(2, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const SupportCoordinates at =
        chart.coordinates(frame, frame.axes.transpose() * (points.col(i) - frame.centre));
    result.col(i) << at.a, at.b;
  }
  return result;
}

int count_numbers(const Primitive& primitive) {
  const auto& names = primitive.length_names;
  return static_cast<int>(
      std::count_if(names.begin(), names.end(), [](std::string_view name) { return !name.empty(); }));
}

}  // namespace

bool neighbours_are_alike(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                          const std::vector<bool>& is_inlier) {
  const std::vector<Eigen::Index> inliers = indices_of(is_inlier);
  const Eigen::Matrix3Xd points = cloud(Eigen::all, inliers);
  const LocalModel model = fit.primitive->localise(fit.surface, fit.reference);
  Eigen::Matrix3Xd feet;
  fit.primitive->distance.foot_points(points, model, feet);
  const auto all = Eigen::Map<const Eigen::RowVectorXd>(fit.error.data(), cloud.cols());
  const auto derivatives = [&](const std::vector<Eigen::Index>& some) {
    Eigen::MatrixXd result;
    fit.primitive->distance.jacobian(points(Eigen::all, some), model, result);
    return result;
  };
  return neighbours_are_alike({all(inliers), points, std::move(feet), derivatives});
}

std::optional<double> distance_of_groups(const PrimitiveFit& fit, const std::vector<bool>& is_inlier) {
  constexpr double fewest = 50, two_groups = 1.5;
  double n = 0, sum = 0;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) n += 1, sum += fit.error[i];
  if (n < fewest) return std::nullopt;
  const double mean = sum / n;
  double squares = 0, fourth = 0;
  std::array<double, 2> of_side{}, count{};
  for (std::size_t i = 0; i < is_inlier.size(); ++i) {
    if (!is_inlier[i]) continue;
    const double d = fit.error[i] - mean;
    squares += d * d, fourth += d * d * d * d;
    of_side[d > 0] += d, count[d > 0] += 1;
  }
  if (!(n * fourth < two_groups * squares * squares)) return std::nullopt;
  return of_side[1] / count[1] - of_side[0] / count[0];
}

std::optional<EdgeEffect> edge_effect(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                                      const std::vector<bool>& is_inlier) {
  constexpr std::size_t fewest = 100;
  constexpr double edge = 0.1, of_difference = 5, of_length = 3, whole = 0.8;
  const std::vector<Eigen::Index> inliers = indices_of(is_inlier);
  if (inliers.size() < fewest || count_numbers(*fit.primitive) == 0) return std::nullopt;
  const Eigen::Matrix3Xd points = cloud(Eigen::all, inliers);
  const Eigen::VectorXd errors = Eigen::Map<const Eigen::VectorXd>(fit.error.data(), cloud.cols())(inliers);
  const LocalModel model = fit.primitive->localise(fit.surface, fit.reference);
  Eigen::MatrixXd jacobian;
  fit.primitive->distance.jacobian(points, model, jacobian);
  const Eigen::MatrixXd of_lengths = geometric_derivatives(*fit.primitive, model, fit.reference)
                                         .middleRows(6, count_numbers(*fit.primitive)),
                        covariance = determined_inverse(jacobian.transpose() * jacobian);
  // Least squares of the inliers are not quite the fit: it has weights, and allows for the bias by curvature.
  const Eigen::VectorXd of_all = covariance * (jacobian.transpose() * errors);
  const Eigen::Matrix2Xd at = coordinates_of_feet(points, fit, model);
  const SupportChart& chart = fit.primitive->support;
  const double sigma = noise_and_rounding(fit);
  std::optional<EdgeEffect> result;
  double most = of_length;
  for (Eigen::Index along = 0; along < 2; ++along) {
    std::vector<double> sorted(at.row(along).begin(), at.row(along).end());
    std::sort(sorted.begin(), sorted.end());
    const double range = along == 0 ? chart.range_a : chart.range_b;
    if (range > 0 && sorted.back() - sorted.front() > whole * range) continue;
    const auto tenth = static_cast<std::size_t>(edge * static_cast<double>(sorted.size()));
    const double low = along == 1 && chart.b_begins_at_a_point ? sorted.front() : sorted[tenth],
                 high = sorted[sorted.size() - 1 - tenth];
    std::vector<Eigen::Index> inner;
    for (Eigen::Index i = 0; i < at.cols(); ++i)
      if (at(along, i) >= low && at(along, i) <= high) inner.push_back(i);
    const Eigen::MatrixXd of_inner = jacobian(inner, Eigen::all);
    const Eigen::MatrixXd inner_covariance = determined_inverse(of_inner.transpose() * of_inner);
    const Eigen::VectorXd change =
        of_lengths * (of_all - inner_covariance * (of_inner.transpose() * errors(inner)));
    for (Eigen::Index j = 0; j < change.size(); ++j) {
      const double difference =
                       sigma * std::sqrt(std::fmax(of_lengths.row(j) * (inner_covariance - covariance) *
                                                       of_lengths.row(j).transpose(),
                                                   0)),
                   deviations = std::fabs(change[j]) / deviation(fit, static_cast<std::size_t>(j));
      // A difference of 0: the inner points do not determine it.
      if (!(difference > 0 && std::fabs(change[j]) > of_difference * difference && deviations > most))
        continue;
      most = deviations;
      const double length = fit.surface.lengths[static_cast<std::size_t>(j)];
      result = EdgeEffect{static_cast<std::size_t>(j), length, length + change[j]};
    }
  }
  return result;
}

}  // namespace darboux::fit
