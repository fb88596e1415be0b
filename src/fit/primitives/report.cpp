#include "report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/degrees.h"
#include "determinacy.h"
#include "fit/common/intervals.h"

namespace darboux::fit {
namespace {

CatalogueSurface catalogue_surface(const PrimitiveFit& fit, const NormalisedPoints& points,
                                   const std::vector<bool>& inlier) {
  const GeometricParameters& n = fit.surface;
  return fit.primitive->to_catalogue(n, points.scale, [&](const Vector3d& direction) {
    Extent e{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (Eigen::Index i = 0; i < points.cloud.cols(); ++i) {
      if (!inlier[points.index[static_cast<std::size_t>(i)]]) continue;
      const double x = direction.dot(points.cloud.col(i) - n.centre);
      e.low = std::fmin(e.low, x), e.high = std::fmax(e.high, x);
    }
    return e;
  });
}

// From the covariance of (rotation vector, movement of `reference`, parameters) in scaled units.
void state_numbers(const PrimitiveFit& fit, const CatalogueSurface& surface,
                   const Eigen::MatrixXd& covariance, double scale, const Intervals& intervals) {
  const std::vector<ParameterValue> parameters = surface.surface.parameters();
  for (Eigen::Index k = 0; k < surface.by_lengths.rows(); ++k) {
    const ParameterValue& p = parameters[static_cast<std::size_t>(k)];
    if (!surface.by_lengths.row(k).isZero(0))
      intervals.add_number(std::string(p.name), p.value, scale * scale * covariance(6 + k, 6 + k));
  }
  const Vector3d axis = surface.frame.col(2);
  const Matrix3d across = Matrix3d::Identity() - axis * axis.transpose();
  if (fit.primitive->orientation != Orientation::none)
    intervals.add_length("axis_deg", across * covariance.topLeftCorner<3, 3>() * across, degrees_per_radian);
  const Vector3d arm = surface.origin - fit.reference;
  Eigen::Matrix<double, 3, 6> moves;  // turn x arm + movement
  moves << 0, arm.z(), -arm.y(), 1, 0, 0, -arm.z(), 0, arm.x(), 0, 1, 0, arm.y(), -arm.x(), 0, 0, 0, 1;
  if (fit.primitive->slides_along_axis) moves = (across * moves).eval();
  intervals.add_length("centre", moves * covariance.topLeftCorner<6, 6>() * moves.transpose(), scale);
}

}  // namespace

double rms_of(const PrimitiveFit& fit, const std::vector<bool>& is_inlier) {
  double squares = 0;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) squares += fit.error[i] * fit.error[i];
  return std::sqrt(squares /
                   std::max(1.0, static_cast<double>(std::count(is_inlier.begin(), is_inlier.end(), true))));
}

NoiseKnowledge report_points(const PrimitiveFit& best, const NormalisedPoints& points,
                             const std::vector<bool>& is_inlier, bool noise_is_known, PointFit& to) {
  points.spread(is_inlier, to.is_inlier);
  to.inliers = static_cast<std::size_t>(std::count(to.is_inlier.begin(), to.is_inlier.end(), true));
  to.outliers = points.finite - to.inliers;
  to.rms = points.scale * rms_of(best, is_inlier);
  const auto k = static_cast<double>(std::count(is_inlier.begin(), is_inlier.end(), true));
  const double freedom = std::max(1.0, k - best.primitive->unknowns);
  const NoiseKnowledge noise = noise_is_known ? NoiseKnowledge{1, std::numeric_limits<double>::infinity()}
                                              : NoiseKnowledge{k / freedom, freedom};
  to.sigma = points.scale * best.sigma * std::sqrt(noise.squared_factor);
  return noise;
}

void report_surface(const PrimitiveFit& best, const NormalisedPoints& points, const NoiseKnowledge& noise,
                    PointFit& to) {
  const CatalogueSurface surface = catalogue_surface(best, points, to.is_inlier);
  to.surface = PlacedSurface{surface.surface};
  to.surface->placement.linear() = surface.frame;
  to.surface->placement.translation() = points.centre + points.scale * surface.origin;
  const auto parameters = surface.by_lengths.rows();
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(6 + parameters, 9);  // in the scaled units still
  by.topLeftCorner<3, 3>().setIdentity();
  by.block<3, 3>(3, 3).setIdentity();
  by.bottomRightCorner(parameters, 3) = surface.by_lengths / points.scale;
  const double with_rounding = noise_and_rounding(best) / best.sigma;
  const Eigen::MatrixXd covariance =
      noise.squared_factor * with_rounding * with_rounding * by * best.covariance * by.transpose();
  Eigen::VectorXd units = Eigen::VectorXd::Constant(6 + parameters, points.scale);
  units.head<3>().setOnes();
  const Intervals intervals(to, noise.degrees_of_freedom);
  to.covariance = intervals.widening() * (units.asDiagonal() * covariance * units.asDiagonal());
  to.centre = points.centre + points.scale * best.reference;
  state_numbers(best, surface, covariance, points.scale, intervals);
}

}  // namespace darboux::fit
