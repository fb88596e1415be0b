#include "determinacy.h"

#include <algorithm>
#include <cmath>

#include "base/degrees.h"
#include "base/linear_algebra.h"
#include "base/text.h"
#include "fit/common/intervals.h"
#include "fit/common/kinds.h"
#include "principal.h"

namespace darboux::fit::catalogue {
namespace {

// The name of a parameter that points over the whole patch would identify but these points do not; empty if
// there is none. Symmetries, and lengths that only bound the patch, do not count.
std::string unidentifiable_parameter(const Shape& shape, const ReducedNormalEquations& known,
                                     const Eigen::VectorXd& units, double size) {
  constexpr int grid = 17;
  constexpr double clearly = 1e-8;  // of the best known direction; far above unidentifiable_below
  const Eigen::Index n = units.size();
  const DistanceRow row_of(shape, Eigen::VectorXd::Zero(n), units, size);
  Normal whole(n);
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      Projection f;
      f.uv = {column / (grid - 1.0), row / (grid - 1.0)};
      f.position = shape.surface.jet(f.uv.x, f.uv.y).position;
      f.normal = shape.surface.frame(f.uv.x, f.uv.y).n;
      if (const Row r = row_of(f, Eigen::Vector3d::Zero()); r.allFinite()) whole.add(r, 1, 0);
    }
  const double most = symmetric_eigenvalues(whole.h)[n - 1];
  for (Eigen::Index k = 0; k < n && !known.is_identifiable(k); ++k) {
    const Eigen::VectorXd direction = known.directions().col(k);
    if (!(direction.dot(whole.h.selfadjointView<Eigen::Lower>() * direction) > clearly * most)) continue;
    Eigen::Index largest;
    direction.cwiseAbs().maxCoeff(&largest);
    return largest < 3 ? "direction"
           : largest < 6
               ? "place"
               : std::string(shape.surface.parameters()[static_cast<std::size_t>(largest - 6)].name);
  }
  return "";
}

// The sum of the directions that are not identifiable, v v^T each.
Eigen::MatrixXd unidentifiable_directions(const ReducedNormalEquations& known) {
  const Eigen::Index n = known.directions().rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n && !known.is_identifiable(k); ++k)
    result += known.directions().col(k) * known.directions().col(k).transpose();
  return result;
}

// Directions in which the parameters are not identifiable, whatever the motion: single parameters first, then
// the rest if it is only one direction.
std::vector<Eigen::VectorXd> unidentifiable_parameters(const ReducedNormalEquations& known) {
  const Eigen::Index count = known.directions().rows() - 6;
  const auto [shares, directions] =
      symmetric_eigen(Eigen::MatrixXd(unidentifiable_directions(known).bottomRightCorner(count, count)));
  Eigen::MatrixXd unknown = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; k < count; ++k)
    if (shares[k] > 1 - 1e-6) unknown += directions.col(k) * directions.col(k).transpose();
  std::vector<Eigen::VectorXd> result;
  for (Eigen::Index k = 0; k < count; ++k)
    if (unknown(k, k) > 1 - 1e-6) {
      result.push_back(Eigen::VectorXd::Unit(count, k));
      unknown.row(k).setZero();
      unknown.col(k).setZero();
    }
  if (const auto rest = symmetric_eigen(unknown); rest.values.sum() > 0.5 && rest.values.sum() < 1.5)
    result.push_back(rest.vectors.col(count - 1));
  return result;
}

}  // namespace

ReducedNormalEquations information(const Estimate& e, const Positions& points, const Eigen::VectorXd& units,
                                   double size) {
  const DistanceRow row_of(e.shape, Eigen::VectorXd::Zero(units.size()), units, size);
  const FootFinder finder(e.shape);
  Normal normal(units.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const double w = e.weighted.weight[i]; w > 0)
      if (const Row row = row_of(finder.follow(points[i], e.feet.uv[i]), points[i]); row.allFinite())
        normal.add(row, w, 0);
  return normal.reduced();
}

std::string add_covariance(const Estimate& e, const ReducedNormalEquations& known,
                           const Eigen::VectorXd& units, double noise, double degrees_of_freedom,
                           PointFit& fit) {
  const Intervals intervals(fit, degrees_of_freedom);
  const Eigen::Index n = units.size();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    covariance +=
        noise * noise * known.variance(k) * known.directions().col(k) * known.directions().col(k).transpose();
  const Eigen::MatrixXd unknown = unidentifiable_directions(known);
  fit.covariance = units.asDiagonal() * covariance * units.asDiagonal();
  const std::vector<ParameterValue> parameters = e.shape.surface.parameters();
  std::vector<std::string> alone, combined;
  for (Eigen::Index k = 6; k < n; ++k) {
    const std::string name(parameters[static_cast<std::size_t>(k - 6)].name);
    // The share of the parameter in directions that are not identifiable.
    if (unknown(k, k) > 1 - 1e-6) {
      alone.push_back(name);
      fit.covariance.row(k).setZero();
      fit.covariance.col(k).setZero();
    } else if (unknown(k, k) > 1e-6) {
      combined.push_back(name);
    }
    intervals.add_number(name, parameters[static_cast<std::size_t>(k - 6)].value, fit.covariance(k, k));
  }
  std::string held;
  if (!alone.empty()) held += "; " + joined(alone) + " not determined by the points, held fixed";
  if (!combined.empty()) held += "; of " + joined(combined) + " the points determine only combinations";
  const Eigen::Vector3d axis = e.shape.placement.linear().col(2), origin = e.shape.placement.translation();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
  intervals.add_length("axis_deg", across * fit.covariance.topLeftCorner<3, 3>() * across,
                       degrees_per_radian);
  Eigen::Matrix<double, 3, 6> of_origin;
  of_origin << 0, origin.z(), -origin.y(), 1, 0, 0, -origin.z(), 0, origin.x(), 0, 1, 0, origin.y(),
      -origin.x(), 0, 0, 0, 1;
  intervals.add_length("centre", of_origin * fit.covariance.topLeftCorner<6, 6>() * of_origin.transpose(), 1);
  fit.covariance *= intervals.widening();
  return held;
}

// Multiplies parameters by exp(t d), along the unknown direction d of their logarithms, unless that moves the
// surface.
bool enclose(Estimate& e, const ReducedNormalEquations& known, const Positions& inliers,
             const std::vector<Vec2<double>>& feet, double size) {
  const SurfaceInfo& info = e.shape.surface.info();
  std::vector<double Vec2<double>::*> ending;
  if (info.u == Coordinate::linear) ending.push_back(&Vec2<double>::x);
  if (info.v == Coordinate::linear) ending.push_back(&Vec2<double>::y);
  std::vector<Eigen::Vector3d> farthest;
  for (const auto c : ending) {
    const auto [low, high] = std::minmax_element(feet.begin(), feet.end(),
                                                 [&](const auto& a, const auto& b) { return a.*c < b.*c; });
    farthest.push_back(inliers[static_cast<std::size_t>(low - feet.begin())]);
    farthest.push_back(inliers[static_cast<std::size_t>(high - feet.begin())]);
  }
  bool changed = false;
  for (const Eigen::VectorXd& way : unidentifiable_parameters(known)) {
    const auto along = [&](double t) -> std::optional<Shape> {
      std::vector<double> p = values_of(e.shape.surface);
      for (std::size_t k = 0; k < p.size(); ++k) p[k] *= std::exp(t * way[static_cast<Eigen::Index>(k)]);
      if (const std::optional<AnySurface> surface = with_values(e.shape.surface, p))
        return Shape{*surface, e.shape.placement};
      return std::nullopt;
    };
    const auto feet_along = [&](double t) {
      std::vector<Projection> result;
      if (const std::optional<Shape> shape = along(t)) {
        const FootFinder finder(*shape);
        for (const Eigen::Vector3d& x : farthest) result.push_back(finder.search(x));
      }
      return result;
    };
    const std::vector<Projection> now = feet_along(0), slightly = feet_along(0.01);
    if (slightly.empty()) continue;
    std::vector<double Vec2<double>::*> affected;
    for (const auto c : ending)
      for (std::size_t i = 0; i < now.size(); ++i)
        if (std::fabs(slightly[i].uv.*c - now[i].uv.*c) > 1e-4) {
          affected.push_back(c);
          break;
        }
    // How far the inliers lie beyond [0, 1]; negative: within. NaN if the surface moves.
    const auto beyond = [&](const std::vector<Projection>& at) {
      double result = at.empty() ? std::nan("") : -infinity;
      for (std::size_t i = 0; i < at.size(); ++i) {
        if (!(norm(at[i].position - now[i].position) <= 1e-6 * size)) return std::nan("");
        for (const auto c : affected) result = std::fmax(result, std::fmax(-(at[i].uv.*c), at[i].uv.*c - 1));
      }
      return result;
    };
    const auto within = [&](double t) { return beyond(feet_along(t)) <= 0; };
    const double inwards = beyond(slightly) < beyond(now) ? 1 : -1;
    double inside = 0, outside = 0;
    for (double step = 0.05; step < 8 && !within(inside); step *= 2) inside += inwards * step;
    for (double step = 0.05; step < 8 && within(outside); step *= 2) outside -= inwards * step;
    if (affected.empty() || !within(inside) || !(beyond(feet_along(outside)) > 0)) continue;
    for (int k = 0; k < 30; ++k) {
      const double middle = 0.5 * (inside + outside);
      (within(middle) ? inside : outside) = middle;
    }
    e.shape = *along(inside);
    changed = true;
  }
  return changed;
}

std::string against(const Estimate& e, const PointFit& fit, const ReducedNormalEquations& known,
                    const Eigen::VectorXd& units, const std::vector<bool>& lengths, double size) {
  const AnySurface& surface = e.shape.surface;
  const std::vector<ParameterValue> parameters = surface.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double length = std::fabs(parameters[k].value), deviation = fit.standard_errors[k].value;
    if (lengths.empty() || !lengths[k] || may_be_zero(surface, k)) continue;
    const std::string name(parameters[k].name);
    if (length < 1e-3 * size) return "has the " + name + " of a line or a point: no fit";
    if (length > 1e3 * size || deviation > 0.5 * length)
      return "has a " + name + " that the points do not tell; points over a larger part of it help";
  }
  if (const std::string what = unidentifiable_parameter(e.shape, known, units, size); !what.empty())
    return "is not determined: the points do not tell its " + what + "; points over a larger part of it help";
  return "";
}

bool plane_is_as_good(const Positions& inliers, double rms, double unknowns, double size) {
  const double n = static_cast<double>(inliers.size()), exact = 1e-12 * size,
               gained = std::fmax(principal(inliers).thickness, exact) / std::fmax(rms, exact);
  return 2 * n * std::log(gained) < (unknowns - 3) * std::log(n) + margin;
}

}  // namespace darboux::fit::catalogue
