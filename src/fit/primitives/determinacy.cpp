#include "determinacy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "base/linear_algebra.h"
#include "base/text.h"
#include "fit/common/intervals.h"
#include "fit/common/kinds.h"
#include "geometry.h"

namespace darboux::fit {
namespace {

double expected_inliers(const PrimitiveFit& f) {
  double inliers = 0;
  for (std::size_t i = 0; i < f.error.size(); ++i)
    if (f.in_support[i]) inliers += inlier_probability(f.error[i], {f.sigma, f.outliers});
  return inliers;
}

// The covariance without turns of a whole frame: if two lengths are equal, a turn changes nothing.
Covariance of_the_surface(const PrimitiveFit& f) {
  Covariance c = f.covariance;
  if (f.primitive->orientation == Orientation::frame) c.topRows<3>().setZero(), c.leftCols<3>().setZero();
  return c;
}

// The name of the movement that the points determine least.
std::string least_identifiable(const PrimitiveFit& f) {
  Covariance c = of_the_surface(f);
  c /= c.cwiseAbs().maxCoeff();
  if (!c.allFinite()) return "its size and place";
  const Eigen::Matrix<double, 9, 1> v = symmetric_eigen(Eigen::MatrixXd(c)).vectors.col(8);
  const Vector3d turn = v.head<3>(), shift = v.segment<3>(3), lengths = v.tail<3>();
  const double half_of_most = 0.5 * std::max({turn.norm(), shift.norm(), lengths.norm()});
  if (shift.norm() > half_of_most) return "the centre along " + direction_text(shift);
  if (lengths.norm() > half_of_most) {
    Eigen::Index k;
    lengths.cwiseAbs().maxCoeff(&k);
    return std::string("the ").append(f.primitive->length_names[static_cast<std::size_t>(k)]);
  }
  return "a turn about " + direction_text(turn);
}

// If the error of a number exceeds this share of it, its interval is not valid: the errors are no longer
// those of a linear model. For an angle, in radians.
constexpr double largest_share = 0.2;

double degrees_of_freedom(const PrimitiveFit& f, double inliers) {
  return std::max(0.5, inliers - f.primitive->unknowns);
}

// Noise makes points on a line or circle look like a strip of a surface: a sigma wide, and wider if outliers
// are taken for noise.
constexpr double least_width_over_sigma = 2.5;

// The greatest ratio of the true standard errors to those of the covariance: few points estimate the noise
// badly, and among many such fits those that underestimate it would pass.
double greatest_error_ratio(const PrimitiveFit& f, double inliers) {
  if (f.sigma_known) return 1;
  const double freedom = degrees_of_freedom(f, inliers);
  return std::sqrt(inliers / freedom) * greatest_sigma_ratio(freedom);
}

Determinacy unsure(std::string why) {
  return {Determinacy::Kind::unsure, std::move(why)};
}
Determinacy unproven(std::string why) {
  return {Determinacy::Kind::unproven, std::move(why)};
}
Determinacy none(std::string why) {
  return {Determinacy::Kind::none, std::move(why)};
}

// Whether the points determine a surface that explains them. k: inliers.
Determinacy identifiability(const PrimitiveFit& f, double k) {
  const Primitive& primitive = *f.primitive;
  const std::string help = "; points over a larger part of it help";
  // Root mean square movement of the surface at the points, for a unit along the direction that they
  // determine least. The normal equations give its square up to their rounding.
  const Covariance c = of_the_surface(f);
  const double movement = primitive.orientation == Orientation::frame
                              ? f.sigma / std::sqrt(k * symmetric_eigenvalues(Eigen::MatrixXd(c))[8])
                              : 1 / (f.largest_deviation * std::sqrt(k));
  if (!f.covariance.allFinite() || !(movement > 1e-7) ||
      (primitive.is_plane && movement < least_width_over_sigma * f.sigma))
    return unsure("is not determined: " + least_identifiable(f) + " is not observable" + help);
  const double ratio = greatest_error_ratio(f, k) / largest_share;
  for (std::size_t j = 0; j < static_cast<std::size_t>(f.primitive->lengths); ++j) {
    const double length = f.surface.lengths[j];
    const std::string name(f.primitive->length_names[j]);
    if (length > 1e3) return unsure("has a " + name + " that cannot be told from infinity" + help);
    if (length < 1e-3) return none("shrinks to a point or a line: no fit");
    if (ratio * deviation(f, j) > length)
      return unsure("has a " + name + " known to " + rounded(100 * deviation(f, j) / length, 2) + " % only" +
                    help);
  }
  if (primitive.at_limit)
    if (const std::string_view why = primitive.at_limit(f.surface, ratio * deviation(f, 0)); !why.empty())
      return unsure("is " + std::string(why) + help);
  if (primitive.orientation != Orientation::frame &&
      ratio * std::sqrt(f.covariance.topLeftCorner<3, 3>().trace()) > 1)
    return unsure("has an axis that is not observable" + help);
  // Noise about a circle lies near many surfaces.
  if (!primitive.is_plane && f.circle_deviation < least_width_over_sigma * f.sigma)
    return unsure(
        "is not determined: the points are no further than their noise, " + rounded(100 * f.sigma, 2) +
        " % of their size, from a circle; another kind, or points over a larger part of it may help");
  if (!f.converged) return unsure("did not converge");
  return {};
}

}  // namespace

std::string direction_text(const Vector3d& direction) {
  Vector3d unit = positive_side(direction.normalized());
  for (double& x : unit)
    if (std::fabs(x) < 5e-4) x = 0;
  return "(" + rounded(unit.x(), 3) + ", " + rounded(unit.y(), 3) + ", " + rounded(unit.z(), 3) + ")";
}

std::vector<bool> inliers_of(const PrimitiveFit& fit) {
  std::vector<bool> is_inlier(fit.error.size());
  for (std::size_t i = 0; i < is_inlier.size(); ++i) {
    // Beyond the support inliers are rare: a point counts as one only if outliers are much rarer still.
    const double outliers = fit.outliers * (fit.in_support[i] ? 1 : 1000);
    is_inlier[i] = inlier_probability(fit.error[i], {fit.sigma, outliers}) > 0.5;
  }
  return is_inlier;
}

double noise_and_rounding(const PrimitiveFit& fit) {
  if (!(fit.rounding > 0)) return fit.sigma;
  return noise_and_rounding(fit.sigma, fit.rounding, expected_inliers(fit));
}

std::ptrdiff_t count_inliers(const PrimitiveFit& fit) {
  const std::vector<bool> is_inlier = inliers_of(fit);
  return std::count(is_inlier.begin(), is_inlier.end(), true);
}

bool explains_enough(const PrimitiveFit& fit) {
  return static_cast<double>(count_inliers(fit)) >= enough_inliers * static_cast<double>(fit.error.size());
}

bool are_same(const PrimitiveFit& a, const PrimitiveFit& b) {
  if (!a.covariance.allFinite() || !b.covariance.allFinite()) return false;
  // Uses the better known of the two: a fit that determines nothing is not the same as every other.
  const auto near = [](double difference, double deviation_a, double deviation_b) {
    constexpr double rounding = 1e-9;
    return std::fabs(difference) <= 6 * std::fmin(deviation_a, deviation_b) + rounding;
  };
  const auto lengths = [](const PrimitiveFit& f) {
    std::array<std::pair<double, double>, 3> list;
    for (std::size_t k = 0; k < 3; ++k) list[k] = {f.surface.lengths[k], deviation(f, k)};
    if (f.primitive->orientation == Orientation::frame) std::sort(list.begin(), list.end());
    return list;
  };
  const auto of_a = lengths(a), of_b = lengths(b);
  for (std::size_t k = 0; k < 3; ++k)
    if (!near(of_a[k].first - of_b[k].first, of_a[k].second, of_b[k].second)) return false;
  if (a.primitive->orientation != Orientation::axis) return true;
  const auto turn = [](const PrimitiveFit& f) {
    return std::sqrt(std::fmax(f.covariance.topLeftCorner<3, 3>().trace(), 0));
  };
  return near(a.surface.axes.col(2).cross(b.surface.axes.col(2)).norm(), turn(a), turn(b));
}

double deviation(const PrimitiveFit& f, std::size_t k) {
  const auto at = 6 + static_cast<Eigen::Index>(k);
  return noise_and_rounding(f) / f.sigma * std::sqrt(std::fmax(f.covariance(at, at), 0));
}

double most_deviations(const PrimitiveFit& f) {
  if (f.sigma_known) return 3;
  const double inliers = std::fmax(expected_inliers(f), f.primitive->unknowns),
               freedom = degrees_of_freedom(f, inliers);
  return std::fmax(3, std::sqrt(inliers / freedom) * students_t(0.99, freedom));
}

double least_length(const PrimitiveFit& f, std::size_t k) {
  // The standard deviation of 1 / length is deviation / length^2.
  const double length = f.surface.lengths[k];
  return length / (1 + most_deviations(f) * deviation(f, k) / length);
}

double range_of_outliers(double mean_distance, double sigma, double share_of_inliers) {
  constexpr double least = 10;
  if (share_of_inliers < enough_inliers || !(mean_distance < 1)) return 1;
  return std::fmin(std::fmax(2 * mean_distance, least * sigma), 1);
}

double log_likelihood_ratio(double k, double n, double sigma, int unknowns, double range) {
  constexpr double band =
      4.132731354122493;  // sqrt(2 pi e): a Gaussian has the entropy of a band this many sigma wide
  const auto x_log_x = [](double x) { return x > 0 ? x * std::log(x) : 0; };
  // `unknowns` of the inliers lie on the surface because it was made to pass through them.
  return std::max(0.0, k - unknowns) * std::log(2 / (band * std::max(sigma, exact))) + x_log_x(k) +
         x_log_x(std::max(0.0, n - k)) - x_log_x(n) - std::max(0.0, n - k) * std::log(range);
}

double log_likelihood_ratio(const PrimitiveFit& f) {
  double sum = 0, count = 1e-300;
  for (std::size_t i = 0; i < f.error.size(); ++i) {
    const double outlier = f.in_support[i] ? 1 - inlier_probability(f.error[i], {f.sigma, f.outliers}) : 1;
    sum += outlier * std::fabs(f.error[i]), count += outlier;
  }
  const double k = expected_inliers(f), n = static_cast<double>(f.error.size());
  return log_likelihood_ratio(k, n, f.sigma, f.primitive->unknowns,
                              range_of_outliers(sum / count, f.sigma, k / n));
}

Determinacy determinacy(const PrimitiveFit& f) {
  const double k = expected_inliers(f), n = static_cast<double>(f.error.size());
  if (f.sigma > largest_sigma)
    return none("leaves distances of " + rounded(f.sigma, 3) + " of the points' size: no fit");
  // If radius of curvature and noise are of similar size, the model (first order in noise times curvature)
  // and the distances mean nothing.
  if (const double radius = least_radius(*f.primitive, f.surface, f.reference);
      radius < least_radius_over_sigma * f.sigma)
    return none("has a radius of only " + rounded(radius / f.sigma, 3) +
                " times the noise: no fit; another kind or less noise helps");
  if (f.doubles_itself)
    return none("crosses itself within the noise: no fit; another kind or less noise helps");
  if (f.given_up) return none("explains far fewer of the points than another kind");
  if (k < f.primitive->unknowns + 0.5)
    return unproven("has only " + std::to_string(std::lround(k)) +
                    " of the points, as many lie on one by chance; more points help");
  // If no outliers are assumed, the points showed that too: share and density of outliers count as unknowns.
  const int unknowns = f.primitive->unknowns + (f.outliers == 0 ? 2 : 0);
  if (log_likelihood_ratio(k, n, f.sigma, f.primitive->unknowns) < 0.5 * unknowns * std::log(n) + margin)
    return unproven(
        "is no more than points of constant density show by chance: no fit; fewer outliers or less noise "
        "help");
  if (f.outliers > 0.5)
    return none("does not stand out from the outliers: no fit; fewer outliers or less noise help");
  return identifiability(f, k);
}

}  // namespace darboux::fit
