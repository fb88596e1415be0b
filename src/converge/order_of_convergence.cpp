#include <cmath>
#include <functional>
#include <limits>

#include <Eigen/Core>

#include <darboux/error.h>
#include <darboux/order_of_convergence.h>

#include "base/linear_algebra.h"
#include "base/student_t.h"
#include "base/text.h"

namespace darboux {
namespace {

constexpr std::size_t fit_least = 3;         // widths
constexpr double curvature_level = 0.1;      // of the test
constexpr double bias_of_difference = 1.75;  // see the header

// The mean logarithm of the errors at a width, and the variance of that mean.
struct Point {
  double log_h, h, log_error;
  double variance = 0;
  double freedom = 0;  // degrees of freedom of the variance; 0: one mesh
};

std::vector<Point> points_of(std::span<const ErrorsAtWidth> widths) {
  std::vector<Point> points;
  double spread = 0, freedom = 0;  // per mesh, at the last width with several meshes
  for (const ErrorsAtWidth& w : widths) {
    if (w.errors.empty()) throw ParameterError("errors", "expected at least one per width, got none");
    if (!(w.h > 0) || (!points.empty() && !(w.h < points.back().h)))
      throw ParameterError("h", expected_got("widths above 0 that fall", shortest(w.h)));
    const auto count = static_cast<double>(w.errors.size());
    double mean = 0;
    for (const double error : w.errors) {
      if (!(error > 0)) throw ParameterError("errors", expected_got("numbers above 0", shortest(error)));
      mean += std::log(error) / count;
    }
    if (w.errors.size() > 1) {
      spread = 0;
      freedom = count - 1;
      for (const double error : w.errors) spread += std::pow(std::log(error) - mean, 2) / freedom;
    }
    points.push_back({std::log(w.h), w.h, mean, spread / count, freedom});
  }
  return points;
}

// A coefficient of a least-squares fit, its standard error, and the degrees of freedom of that.
struct Coefficient {
  double value, error, freedom;

  // The quantile of Student's t times the standard error.
  double half_width(double outside) const {
    if (!(freedom > 0)) return std::numeric_limits<double>::infinity();
    if (error == 0) return 0;
    return error * student_t(1 - outside / 2, freedom);
  }
};

using Term = std::function<double(const Point&)>;

// The coefficient c_k of log error = c0 + c1 log h [+ c2 term].
Coefficient fit(std::span<const Point> points, Eigen::Index k, const Term& term = {}) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd design(n, term ? 3 : 2);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Point& p = points[static_cast<std::size_t>(i)];
    design(i, 0) = 1;
    design(i, 1) = p.log_h - points.back().log_h;
    if (term) design(i, 2) = term(p);
    y(i) = p.log_error;
  }
  const Eigen::MatrixXd inverse = solve_least_norm(design, Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  const Eigen::VectorXd c = inverse * y;
  if (points.front().freedom == 0) {
    const auto freedom = static_cast<double>(n - design.cols());
    const double residual = (y - design * c).squaredNorm() / std::fmax(freedom, 1);
    return {c(k), std::sqrt(residual) * inverse.row(k).norm(), freedom};
  }
  double variance = 0, squares = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Point& p = points[static_cast<std::size_t>(i)];
    const double part = inverse(k, i) * inverse(k, i) * p.variance;
    variance += part;
    squares += part * part / p.freedom;
  }
  return {c(k), std::sqrt(variance), squares > 0 ? variance * variance / squares : points.front().freedom};
}

}  // namespace

OrderEstimate estimate_order(std::span<const ErrorsAtWidth> widths) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Point> all = points_of(widths);
  if (all.size() < fit_least) return {nan, nan, nan, 0};
  std::span<const Point> points = all;
  for (; points.size() > fit_least; points = points.subspan(1)) {
    const double finest = points.back().log_h;
    const Coefficient curvature =
        fit(points, 2, [=](const Point& p) { return std::pow(p.log_h - finest, 2); });
    if (!(std::fabs(curvature.value) > curvature.half_width(curvature_level))) break;
  }
  const Coefficient slope = fit(points, 1);
  const double coarsest = points.front().h;
  const double bias = bias_of_difference *
                      (fit(points, 1, [=](const Point& p) { return p.h / coarsest; }).value - slope.value);
  const double half = std::hypot(slope.half_width(0.05), bias);
  return {slope.value, slope.value - half, slope.value + half, all.size() - points.size()};
}

}  // namespace darboux
