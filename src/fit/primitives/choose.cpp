#include "choose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "estimate.h"
#include "fit/common/kinds.h"

namespace darboux::fit {
namespace {

constexpr double half_turn = std::numbers::pi;

// Roundings are not compared: what fits to this much, of the points' size, fits exactly.
constexpr double exact = 1e-12;

double inliers_of(const Found& f) {
  double inliers = 0;
  for (std::size_t i = 0; i < f.error.size(); ++i)
    if (f.kept[i]) inliers += inlier_probability(f.error[i], {f.sigma, f.outliers});
  return inliers;
}

std::string direction_text(const Vector3d& a) {
  Vector3d unit = positive_side(a.normalized());
  for (double& x : unit)
    if (std::fabs(x) < 5e-4) x = 0;
  return "(" + rounded(unit.x(), 3) + ", " + rounded(unit.y(), 3) + ", " + rounded(unit.z(), 3) + ")";
}

// Its lengths, without a cone's angle.
std::size_t length_count(std::string_view kind) {
  if (kind == "plane" || kind == "cone") return 0;
  return kind == "torus" ? 2 : kind == "ellipsoid" ? 3 : 1;
}

std::string length_name(std::string_view kind, std::size_t k) {
  if (kind == "cone") return "half-angle";
  if (kind == "torus") return k == 0 ? "major radius" : "minor radius";
  return kind == "ellipsoid" ? "semi-axis" : "radius";
}

double deviation(const Found& f, std::size_t k) {
  const auto at = 6 + static_cast<Eigen::Index>(k);
  return std::sqrt(std::fmax(f.covariance(at, at), 0));
}

// The covariance without turns of an ellipsoid: where two semi-axes are equal they change nothing.
Covariance of_the_surface(const Found& f) {
  Covariance c = f.covariance;
  if (f.kind == "ellipsoid") c.topRows<3>().setZero(), c.leftCols<3>().setZero();
  return c;
}

// The movement that the points tell the least about.
std::string least_known(const Found& f) {
  Covariance c = of_the_surface(f);
  c /= c.cwiseAbs().maxCoeff();
  if (!c.allFinite()) return "its size and place";
  const Eigen::Matrix<double, 9, 1> v = Eigen::SelfAdjointEigenSolver<Covariance>(c).eigenvectors().col(8);
  const Vector3d turn = v.head<3>(), shift = v.segment<3>(3), lengths = v.tail<3>();
  const double half_of_most = 0.5 * std::max({turn.norm(), shift.norm(), lengths.norm()});
  if (shift.norm() > half_of_most) return "the centre along " + direction_text(shift);
  if (lengths.norm() > half_of_most) {
    Eigen::Index k;
    lengths.cwiseAbs().maxCoeff(&k);
    return "the " + length_name(f.kind, static_cast<std::size_t>(k));
  }
  return "a turn about " + direction_text(turn);
}

// The radius of the surface's tightest curve, about.
double least_radius(const Found& f) {
  double least = std::numeric_limits<double>::infinity();
  if (f.kind == "cone" || f.kind == "torus")  // about the axis
    least = (f.reference - f.surface.centre).cross(f.surface.axes.col(2)).norm();
  for (std::size_t k = 0; k < length_count(f.kind); ++k) least = std::fmin(least, f.surface.lengths[k]);
  return least;
}

Verdict unsure(std::string why) {
  return {Verdict::Kind::unsure, std::move(why)};
}
Verdict none(std::string why) {
  return {Verdict::Kind::none, std::move(why)};
}

}  // namespace

Vector3d positive_side(const Vector3d& a) {
  Eigen::Index largest;
  a.cwiseAbs().maxCoeff(&largest);
  return a[largest] < 0 ? Vector3d(-a) : a;
}

bool crosses_itself(std::string_view kind, const Natural& surface) {
  return kind == "torus" && surface.lengths[0] < surface.lengths[1];
}

double least_length(const Found& f, std::size_t k) {
  // Of 1 / length the standard deviation is deviation / length^2.
  const double length = f.surface.lengths[k];
  return length / (1 + 3 * deviation(f, k) / length);
}

double evidence(const Found& f) {
  constexpr double band =
      4.132731354122493;  // sqrt(2 pi e): a Gaussian's entropy is that of a band so many sigma wide
  const auto x_log_x = [](double x) { return x > 0 ? x * std::log(x) : 0; };
  const double k = inliers_of(f), n = static_cast<double>(f.error.size());
  // `freedom` of the inliers lie on the surface because it was laid through them.
  return std::max(0.0, k - f.freedom) * std::log(2 / (band * std::max(f.sigma, exact))) + x_log_x(k) +
         x_log_x(std::max(0.0, n - k)) - x_log_x(n);
}

std::vector<double> criteria(const std::vector<Found>& candidates, std::size_t reference) {
  const Found& common = candidates[reference];
  const double sigma = std::max(common.sigma, exact),
               kept = static_cast<double>(std::count(common.kept.begin(), common.kept.end(), 1));
  std::vector<double> result;
  for (const Found& f : candidates) {
    double likelihood = 0;
    for (std::size_t i = 0; i < f.error.size(); ++i) {
      if (!common.kept[i]) continue;
      const double r = f.error[i] / sigma;
      likelihood += std::log((std::exp(-0.5 * r * r) + common.outliers) / (1 + common.outliers));
    }
    result.push_back(-2 * likelihood + f.freedom * std::log(std::max(kept, 1.0)));
  }
  return result;
}

double unlikeness_of_neighbours(const Eigen::Matrix3Xd& cloud, const Found& f,
                                const std::vector<bool>& is_inlier) {
  std::vector<std::size_t> order;
  double mean = 0;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) order.push_back(i), mean += f.error[i];
  mean /= static_cast<double>(order.size());
  double differences = 0, variances = 0;
  const auto at = [&](std::size_t i) { return cloud.col(static_cast<Eigen::Index>(i)); };
  // Halves across the longest side, down to pairs; not where the noise is what parts the points, or it would
  // choose who is alike.
  const auto halve = [&](const auto& self, auto begin, auto end) -> void {
    Eigen::AlignedBox3d box;
    for (auto i = begin; i != end; ++i) box.extend(at(*i));
    Eigen::Index axis = 0;
    if (end - begin < 4 || box.sizes().maxCoeff(&axis) < 30 * f.sigma) {
      for (; end - begin > 1; begin += 2) {
        const double a = f.error[begin[0]] - mean, b = f.error[begin[1]] - mean;
        differences += (a - b) * (a - b);
        variances += a * a + b * b;
      }
      return;
    }
    const auto middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end,
                     [&](std::size_t a, std::size_t b) { return at(a)[axis] < at(b)[axis]; });
    self(self, begin, middle);
    self(self, middle, end);
  };
  halve(halve, order.begin(), order.end());
  return variances > 0 ? differences / variances : 1;
}

Verdict judge(const Found& f) {
  const double k = inliers_of(f), n = static_cast<double>(f.error.size());
  const std::string help = "; points over a larger part of it help";
  if (f.given_up) return none("explains far fewer of the points than another kind");
  if (k < f.freedom + 0.5)
    return none("has only " + std::to_string(std::lround(k)) +
                " of the points, as many lie on one by chance; more points help");
  if (f.sigma > 0.2)
    return none("leaves distances of " + rounded(f.sigma, 3) + " of the points' size: no fit");
  // Curvature and noise are of one size: the model, of first order in their product, and the distances mean
  // nothing.
  if (const double radius = least_radius(f); radius < 5 * f.sigma)
    return none("has a radius of only " + rounded(radius / f.sigma, 3) +
                " times the noise: no fit; less noise helps");
  if (evidence(f) < 0.5 * f.freedom * std::log(n) + margin)
    return none(
        "is no more than points of constant density show by chance: no fit; fewer outliers or less noise "
        "help");
  if (f.outliers > 0.5)
    return none("does not stand out from the outliers: no fit; fewer outliers or less noise help");

  // Movement of the surface at the points, root mean square, by a unit of the direction that they tell the
  // least about. The normal equations know its square but for their rounding. The points' own noise along the
  // surface looks as much like it.
  const Covariance c = of_the_surface(f);
  const double movement =
      f.kind == "ellipsoid"
          ? f.sigma /
                std::sqrt(
                    k * Eigen::SelfAdjointEigenSolver<Covariance>(c, Eigen::EigenvaluesOnly).eigenvalues()[8])
          : 1 / (f.least_known * std::sqrt(k));
  const bool local = f.kind == "plane" || f.kind == "sphere" || f.kind == "cylinder";
  if (!f.covariance.allFinite() || !(movement > 1e-7) || (local && movement < 1.3 * f.sigma))
    return unsure("is not determined: " + least_known(f) + " is not observable" + help);
  for (std::size_t j = 0; j < length_count(f.kind); ++j) {
    const double length = f.surface.lengths[j];
    if (length > 1e3 || deviation(f, j) > 0.5 * length)
      return unsure("has a " + length_name(f.kind, j) + " that is not told from infinity" + help);
    if (length < 1e-3) return none("shrinks to a point or a line: no fit");
  }
  if (f.kind == "cone") {
    const double angle = f.surface.lengths[0], turn = deviation(f, 0);
    if (angle < 1e-3 || turn > 0.5 * angle) return unsure("is not told from a cylinder" + help);
    if (half_turn / 2 - angle < 1e-3 || turn > 0.5 * (half_turn / 2 - angle))
      return unsure("is not told from a plane" + help);
  }
  if (f.kind != "ellipsoid" && std::sqrt(f.covariance.topLeftCorner<3, 3>().trace()) > 0.5)
    return unsure("has an axis that is not observable" + help);
  // Noise about a circle lies near many surfaces: such points are one sigma from it, those of a surface that
  // is determined three at least.
  if (f.kind != "plane" && f.off_a_circle < 2 * f.sigma)
    return unsure("is not determined: the points are no further than their noise from a circle" + help);
  if (!f.converged) return unsure("did not converge");
  return {};
}

}  // namespace darboux::fit
