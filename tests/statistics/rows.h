// The rows of docs/reports/fit.md: which data sets each takes, what one fit of one set gives, and what is
// required. The program fit_statistics runs them, tests/fit/fit_points_statistics_test.cpp smaller versions.
#pragma once

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <darboux/fit_points.h>

#include "synthetic_points.h"

namespace darboux {

inline constexpr std::array<std::string_view, 6> judged_kinds{"plane", "sphere", "cylinder",
                                                              "cone",  "torus",  "ellipsoid"};
inline constexpr std::array<double, 3> judged_sigmas{0.001, 0.01, 0.03};

// A data set, and as what it is fitted.
struct Case {
  std::string kind, fitted_as, group;
  SyntheticOptions options;
};

inline std::string number(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

// The data set of a row that has that seed: kinds and sizes of noise in turns. Shapes of cone and ellipsoid
// are random; that of the torus where the kind is to be found.
inline Case case_of(std::string_view row, std::uint64_t seed) {
  const std::string kind(judged_kinds[seed % judged_kinds.size()]);
  const std::uint64_t turn = seed / judged_kinds.size();
  Case result{kind, kind, kind, {.sigma = 0.01, .outlier_share = 0.2, .coverage = 0.25}};
  SyntheticOptions& options = result.options;
  options.random_shape = kind == "cone" || kind == "ellipsoid";
  std::uint64_t stream = 0;
  if (row == "efficiency" || row == "success-20") {
    stream = row == "efficiency" ? 1 : 2;
    options.sigma = judged_sigmas[turn % judged_sigmas.size()];
    if (row == "efficiency") result.group += ", " + number(100 * options.sigma) + " %";
  } else if (row == "success-40") {
    stream = 3;
    options.outlier_share = 0.4;
  } else if (row == "frames") {
    stream = 4;
  } else if (row == "auto") {
    stream = 5;
    options.random_shape = true;
    result.fitted_as = "auto";
  } else if (row == "noise-free" || row == "far") {
    stream = row == "far" ? 7 : 6;
    options.sigma = 0;
    if (row == "noise-free") {
      constexpr std::array<double, 9> scales{1e-150, 1e-100, 1e-50, 1e-10, 1, 1e10, 1e50, 1e100, 1e150};
      options.scale = scales[turn % scales.size()];
    } else {
      constexpr std::array<double, 3> offsets{1e3, 1e6, 1e9};
      options.offset = offsets[turn % offsets.size()];
      result.group += ", offset " + number(options.offset);
    }
  } else if (row == "time-uv") {
    stream = 9;
    options.with_uv = true;
  } else {
    stream = 8;  // time
  }
  options.seed = 16 * seed + stream;
  return result;
}

struct Outcome {
  bool usable = false;
  std::string found = {}, reason = {};
  double mahalanobis = std::numeric_limits<double>::infinity();  // squared, over the number of parameters
  double error = std::numeric_limits<double>::infinity();        // the largest of the minimal parameters
  double sigma_ratio = 0;                                        // estimated over true
  // Squared Mahalanobis distance of the true frame at a random true point, under the covariance that the fit
  // gives: of n (two degrees of freedom) and of the whole frame (three; kinds whose t no convention decides).
  // Absent where the fit says that a pole is within the uncertainty.
  std::optional<double> normal = {}, frame = {};

  bool success() const { return usable && mahalanobis < 20; }
};

inline void judge_frame(const SyntheticPoints& points, const PointFit& fit, std::uint64_t seed,
                        Outcome& outcome) {
  PortableRandom random(seed);
  const Eigen::Vector3d foot = points.feet[random.below(points.feet.size())];
  const Eigen::Matrix3d truth = true_frame(points, *fit.surface, foot);
  const UncertainFrame found = frame_near(fit, from_eigen(points.truth.placement * (points.scale * foot)));
  Eigen::Matrix3d frame;
  frame << to_eigen(found.t), to_eigen(found.b), to_eigen(found.n);
  // With omega the turn from the true frame to this one, the true n is (-omega_b, omega_t, 1) in this one.
  const Eigen::Vector3d n = frame.transpose() * truth.col(2);
  const Eigen::Vector2d tilt(
      n.y(), -n.x());  // n = omega x e3 with omega the turn from the true frame to this, reversed
  outcome.normal = tilt.dot(found.covariance.topLeftCorner<2, 2>().inverse() * tilt);
  const std::string_view kind = fit.surface->surface.info().name;
  if (kind == "plane" || kind == "sphere" || !std::isfinite(found.tangent_deg)) return;
  const Eigen::AngleAxisd rotation(Eigen::Matrix3d(truth.transpose() * frame));
  const Eigen::Vector3d omega = rotation.angle() * rotation.axis();
  outcome.frame = omega.dot(found.covariance.inverse() * omega);
}

inline PointFit fit_of(const Case& c, const SyntheticPoints& points) {
  return fit_points(points.cloud,
                    {.surface = c.fitted_as, .with_uv = c.options.with_uv, .seed = c.options.seed});
}

inline Outcome judged(std::string_view row, const SyntheticPoints& points, const PointFit& fit,
                      std::uint64_t seed) {
  Outcome outcome{.usable = fit.usable, .reason = fit.reason};
  if (!fit.usable || !fit.surface) return outcome;
  outcome.found = fit.surface->surface.info().name;
  outcome.error = parameter_error(points, *fit.surface).cwiseAbs().maxCoeff();
  if (points.sigma > 0) {
    outcome.mahalanobis = mahalanobis_per_parameter(points, *fit.surface);
    outcome.sigma_ratio = fit.sigma / points.sigma;
  }
  if (row == "frames" && outcome.success()) judge_frame(points, fit, seed, outcome);
  return outcome;
}

inline Outcome outcome_of(std::string_view row, std::uint64_t seed, std::size_t count) {
  Case c = case_of(row, seed);
  c.options.count = count;
  const SyntheticPoints points = make_points(c.kind, c.options);
  return judged(row, points, fit_of(c, points), c.options.seed);
}

inline Outcome outcome_of(std::string_view row, std::uint64_t seed) {
  return outcome_of(row, seed, case_of(row, seed).options.count);
}

// Of a fit that is told which points are inliers, the noise, and the truth as a start: where it misses the
// bound, the bound is not to be had, as it is that of small errors.
inline Outcome told_outcome_of(std::string_view row, std::uint64_t seed) {
  const Case c = case_of(row, seed);
  const SyntheticPoints points = make_points(c.kind, c.options);
  PointCloud inliers;
  for (std::size_t i = 0; i < points.is_inlier.size(); ++i)
    if (points.is_inlier[i]) inliers.positions.push_back(points.cloud.positions[i]);
  const PointFit fit =
      fit_points(inliers, {.surface = c.kind, .noise = points.sigma, .guess = points.truth, .seed = 1});
  return judged(row, points, fit, c.options.seed);
}

// Quantiles of chi squared at 95 % for one to three degrees of freedom.
inline constexpr std::array<double, 4> chi_squared_95{0, 3.841458820694124, 5.991464547107979,
                                                      7.814727903251178};

// Required of the error in units of the bound.
inline double required_efficiency(std::string_view kind) {
  return kind == "sphere" || kind == "cylinder" || kind == "torus" ? 1.10 : 1.15;
}

// Required of the largest error of noise-free points, before scaling: sizes are about 1, the offset is 10
// where it is not far.
inline double required_exactness(std::string_view row, const SyntheticOptions& options) {
  return row == "far" ? 2 * 0x1p-52 * options.offset : 1e-12;
}

// A file of ../shared/points: its points, what PCL's test expects (absent where it says None) and the
// tolerance of that.
struct PublicPoints {
  PointCloud cloud;
  std::vector<std::optional<double>> expected;
  double tolerance = 0;
  bool found = false;
};

struct PublicFile {
  std::string_view name, kind;
};
inline constexpr std::array<PublicFile, 7> public_files{{{"Cone_RANSAC", "cone"},
                                                         {"Cylinder_RANSAC", "cylinder"},
                                                         {"NormalSphere_RANSAC", "sphere"},
                                                         {"Sphere_RANSAC", "sphere"},
                                                         {"TorusOclusion_RANSAC", "torus"},
                                                         {"TorusRefine_RANSAC", "torus"},
                                                         {"TorusSelfIntersectSpindle_RANSAC", "torus"}}};

inline PublicPoints read_public_points(const std::string& folder, std::string_view name) {
  PublicPoints result;
  std::ifstream file(folder + "/pcl_SampleConsensusModel" + std::string(name) + ".xyz");
  result.found = file.is_open();
  for (std::string line; std::getline(file, line);) {
    if (const std::size_t at = line.find("tol ~"); at != std::string::npos) {
      result.tolerance = std::stod(line.substr(at + 5));
      const std::size_t open = line.find('['), close = line.find(']');
      std::istringstream list(line.substr(open + 1, close - open - 1));
      for (std::string value; std::getline(list, value, ',');)
        result.expected.push_back(value.find("None") != std::string::npos ? std::nullopt
                                                                          : std::optional(std::stod(value)));
    }
    if (line.empty() || line[0] == '#') continue;
    std::istringstream numbers(line);
    Vec3<double> p, n;
    numbers >> p.x >> p.y >> p.z;
    result.cloud.positions.push_back(p);
    if (numbers >> n.x >> n.y >> n.z) result.cloud.normals.push_back(n);
  }
  return result;
}

// A surface's coefficients in PCL's order: sphere centre, radius; cylinder a point of the axis (its x and y
// mean something where the axis is along z), axis, radius; cone apex, axis from it, half-angle; torus both
// radii, centre, axis.
inline std::vector<double> pcl_coefficients(const PlacedSurface& s) {
  const std::string_view kind = s.surface.info().name;
  const Eigen::Vector3d o = s.placement.translation(), w = s.placement.linear().col(2);
  if (kind == "sphere") return {o.x(), o.y(), o.z(), parameter_of(s.surface, "radius")};
  if (kind == "cylinder")
    return {o.x(), o.y(), o.z(), w.x(), w.y(), w.z(), parameter_of(s.surface, "radius")};
  if (kind == "cone") {
    const double r = parameter_of(s.surface, "radius"), h = parameter_of(s.surface, "height");
    const Eigen::Vector3d apex = o + h * w;
    return {apex.x(), apex.y(), apex.z(), -w.x(), -w.y(), -w.z(), std::atan2(r, h)};
  }
  return {parameter_of(s.surface, "major_radius"),
          parameter_of(s.surface, "minor_radius"),
          o.x(),
          o.y(),
          o.z(),
          w.x(),
          w.y(),
          w.z()};
}

// The largest difference from what is expected; the axis of a torus has either sign.
inline double public_error(const std::vector<std::optional<double>>& expected, std::vector<double> found) {
  const auto largest = [&] {
    double error = 0;
    for (std::size_t k = 0; k < expected.size(); ++k)
      if (expected[k]) error = std::max(error, std::abs(*expected[k] - found[k]));
    return error;
  };
  const double error = largest();
  if (found.size() != 8) return error;
  for (std::size_t k = 5; k < 8; ++k) found[k] = -found[k];
  return std::min(error, largest());
}

}  // namespace darboux
