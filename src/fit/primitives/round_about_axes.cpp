#include "round_about_axes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "geometry.h"

namespace darboux::fit {
namespace {

constexpr std::size_t most_points = 96, most_found = 4, refined = 12;
constexpr int directions = 400;
constexpr double spacing = 0.125;             // radians between directions, about
constexpr double golden = 2.399963229728653;  // the golden angle, radians

// \param centred about their mean
std::optional<RoundAboutAxis> about(const Eigen::Matrix3Xd& centred, const Vector3d& axis, bool tapers) {
  const Matrix3d axes = axes_with_z(axis);
  const Eigen::Matrix3Xd p = axes.transpose() * centred;
  const Eigen::Index unknowns = tapers ? 4 : 3;
  Eigen::MatrixXd rows(p.cols(), unknowns);
  rows.leftCols<2>() = 2 * p.topRows<2>().transpose();
  rows.col(2).setOnes();
  if (tapers) rows.col(3) = p.row(2).transpose();
  const auto factors = rows.colPivHouseholderQr();
  if (factors.rank() < unknowns) return std::nullopt;
  const Eigen::VectorXd squares = p.topRows<2>().colwise().squaredNorm().transpose(),
                        heights = p.row(2).cwiseAbs2().transpose();
  RoundAboutAxis result{{}, axis, 0, 0, 0};
  Eigen::VectorXd right = squares, x;
  for (int k = 0; k < (tapers ? 4 : 1); ++k) {
    right = squares - result.slope * result.slope * heights;
    x = factors.solve(right);
    const double square = x[2] + x.head<2>().squaredNorm();
    if (!(square > 0)) return std::nullopt;
    result.radius = std::sqrt(square);
    if (tapers) result.slope = x[3] / (2 * result.radius);
  }
  result.centre = axes * Vector3d(x[0], x[1], 0);
  result.residual =
      (right - rows * x).norm() / (2 * result.radius * std::sqrt(static_cast<double>(p.cols())));
  return result;
}

}  // namespace

std::vector<RoundAboutAxis> round_about_axes(const Eigen::Matrix3Xd& sample, bool tapers) {
  const auto chosen = evenly_chosen(static_cast<std::size_t>(sample.cols()), most_points);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(chosen.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    points.col(i) = sample.col(static_cast<Eigen::Index>(chosen[static_cast<std::size_t>(i)]));
  if (points.cols() < (tapers ? 6 : 5)) return {};
  const Vector3d mean = points.rowwise().mean();
  points.colwise() -= mean;
  const auto by_residual = [](const RoundAboutAxis& a, const RoundAboutAxis& b) {
    return a.residual < b.residual;
  };

  // The principal axes are tried as well: the minimum of a long tube is narrower than the spacing.
  const Matrix3d principal = symmetric_eigen(Matrix3d(points * points.transpose())).vectors;
  std::vector<RoundAboutAxis> tried;
  const auto try_axis = [&](const Vector3d& axis) {
    if (const auto found = about(points, axis, tapers)) tried.push_back(*found);
  };
  for (int k = 0; k < 3; ++k) try_axis(principal.col(k));
  for (int k = 0; k < directions; ++k) {
    const double z = (k + 0.5) / directions, across = std::sqrt(1 - z * z), turn = golden * k;
    try_axis(principal * Vector3d(across * std::cos(turn), across * std::sin(turn), z));
  }
  std::sort(tried.begin(), tried.end(), by_residual);

  std::vector<RoundAboutAxis> result;
  const auto near = [](const Vector3d& a, const Vector3d& b, double angle) {
    return a.cross(b).norm() < angle;
  };
  std::vector<Vector3d> begun;
  for (RoundAboutAxis best : tried) {
    if (begun.size() == refined) break;
    // Next to a better direction it leads to the same minimum.
    if (std::any_of(begun.begin(), begun.end(),
                    [&](const Vector3d& b) { return near(b, best.axis, 2 * spacing); }))
      continue;
    begun.push_back(best.axis);
    constexpr int most_moves = 100;
    double step = spacing / 2;
    for (int move = 0; move < most_moves && step > 1e-4; ++move) {
      const Matrix3d axes = axes_with_z(best.axis);
      std::optional<RoundAboutAxis> better;
      for (const double side : {-step, step})
        for (int k = 0; k < 2; ++k) {
          const auto there = about(points, (best.axis + side * axes.col(k)).normalized(), tapers);
          if (there && there->residual < (better ? better->residual : best.residual)) better = there;
        }
      if (better)
        best = *better;
      else
        step /= 2;
    }
    if (std::none_of(result.begin(), result.end(),
                     [&](const RoundAboutAxis& r) { return near(r.axis, best.axis, 0.02); }))
      result.push_back(best);
  }
  std::sort(result.begin(), result.end(), by_residual);
  if (result.size() > most_found) result.resize(most_found);
  for (RoundAboutAxis& r : result) r.centre += mean;
  return result;
}

}  // namespace darboux::fit
