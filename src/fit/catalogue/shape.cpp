#include "shape.h"

#include <cmath>

#include <darboux/error.h>
#include <darboux/shape_operator.h>

#include "fit/common/rotation_manifold.h"

namespace darboux::fit::catalogue {
namespace {

// The derivative of exp(ω) is exp(ω) turned by this.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
  const Eigen::Matrix3d m = cross_matrix(omega);
  const double angle = omega.norm();
  // Series where the closed form cancels.
  const double first = angle < 1e-4 ? 0.5 : (1 - std::cos(angle)) / (angle * angle);
  const double second =
      angle < 1e-2 ? 1.0 / 6 - angle * angle / 120 : (angle - std::sin(angle)) / (angle * angle * angle);
  return Eigen::Matrix3d::Identity() + first * m + second * m * m;
}

}  // namespace

std::vector<double> values_of(const AnySurface& surface) {
  std::vector<double> result;
  for (const ParameterValue& p : surface.parameters()) result.push_back(p.value);
  return result;
}

std::optional<AnySurface> with_values(const AnySurface& surface, const std::vector<double>& values) {
  try {
    return surface.with(values);
  } catch (const ParameterError&) {
    return std::nullopt;
  }
}

std::vector<bool> lengths_of(const AnySurface& surface) {
  const std::vector<double> values = values_of(surface);
  const std::size_t n = values.size();
  for (unsigned set = 1U << n; set-- > 1;) {
    double error = 0, size = 0;
    for (const double u : {0.13, 0.41, 0.77})
      for (const double v : {0.22, 0.58, 0.91}) {
        const ParameterJet by = parameter_jet(surface, {u, v});
        const Vec3<double> p = surface.jet(u, v).position;
        Vec3<double> sum{};
        for (std::size_t k = 0; k < n; ++k)
          if (set >> k & 1U) sum += values[k] * by.position[k];
        error += norm(sum - p);
        size += norm(p);
      }
    // A zero parameter may or may not count; the fullest sets are tried first, so it counts.
    if (error <= 1e-9 * size) {
      std::vector<bool> result;
      for (std::size_t k = 0; k < n; ++k) result.push_back(set >> k & 1U);
      return result;
    }
  }
  return {};
}

Eigen::VectorXd units_of(const Shape& shape, const std::vector<double>& typical, double size) {
  const std::vector<double> values = values_of(shape.surface);
  Eigen::VectorXd result(6 + static_cast<Eigen::Index>(values.size()));
  result.head<3>().setOnes();
  result.segment<3>(3).setConstant(size);
  for (std::size_t k = 0; k < values.size(); ++k)
    result[6 + static_cast<Eigen::Index>(k)] = std::fmax(std::fabs(values[k]), 0.1 * typical[k]);
  return result;
}

std::optional<Shape> moved(const Shape& shape, const Eigen::VectorXd& delta) {
  std::vector<double> values = values_of(shape.surface);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] += delta[6 + static_cast<Eigen::Index>(k)];
  const std::optional<AnySurface> surface = with_values(shape.surface, values);
  if (!surface) return std::nullopt;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translation() = delta.segment<3>(3);
  const double angle = delta.head<3>().norm();
  if (angle > 0) motion.linear() = Eigen::AngleAxisd(angle, delta.head<3>() / angle).toRotationMatrix();
  return Shape{*surface, motion * shape.placement};
}

FootPoints feet_of(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts) {
  const FootFinder finder(shape);
  FootPoints result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Projection f = starts.empty() ? finder.search(points[i]) : finder.follow(points[i], starts[i]);
    const Sample<double> s = shape.surface.sample(f.uv.x, f.uv.y);
    const ShapeOperator<double> form = shape_operator(s.jet, s.frame);
    result.uv.push_back(f.uv);
    result.distance.push_back(f.distance);
    result.curvature.push_back(-(form.a + form.c));
  }
  return result;
}

DistanceRow::DistanceRow(const Shape& shape, const Eigen::VectorXd& delta, const Eigen::VectorXd& units,
                         double size)
    : shape_(shape),
      by_turn_(-left_jacobian(delta.head<3>()).transpose()),
      shift_(delta.segment<3>(3)),
      units_(units / size),
      size_(size) {}

Row DistanceRow::operator()(const Projection& foot, const Eigen::Vector3d& x) const {
  const Eigen::Vector3d place = shape_.placement * to_eigen(foot.position);
  Eigen::Vector3d n = shape_.placement.linear() * to_eigen(foot.normal);
  // Also right at borders and apexes, but on the surface this direction is mere rounding.
  if (!(std::fabs(foot.distance) <= 1e-8 * size_)) n = (x - place) / foot.distance;
  const ParameterJet by = parameter_jet(shape_.surface, foot.uv);
  Row row(6 + by.count);
  row.head<3>() = by_turn_ * (place - shift_).cross(n);
  row.segment<3>(3) = -n;
  const Eigen::Vector3d local = shape_.placement.linear().transpose() * n;
  for (int k = 0; k < by.count; ++k)
    row[6 + k] = -local.dot(to_eigen(by.position[static_cast<std::size_t>(k)]));
  return row.cwiseProduct(units_);
}

}  // namespace darboux::fit::catalogue
