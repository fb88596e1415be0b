#include "clump.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"

namespace darboux::fit {
namespace {

constexpr std::size_t looked_at = 512;  // points
// A neighbourhood has this share of those points. In a clump its radius is at most `denser` times the radius
// that a third of the points exceed.
constexpr double neighbourhood = 0.08, denser = 0.4;
constexpr double least_share = 0.1, most_share = 2.0 / 3;
constexpr double furthest = 3.5;      // standard deviations
constexpr double least_round = 0.15;  // the least variance over the greatest

struct Ball {
  Eigen::Vector3d mean;
  double radius;
};

// The ball about the mean of the points within `ball`, with a radius of `furthest` of their standard
// deviations.
Ball next(const Eigen::Matrix3Xd& cloud, const Ball& ball) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0, count = 0;
  for (const auto& x : cloud.colwise())
    if (const Eigen::Vector3d d = x - ball.mean; d.squaredNorm() <= ball.radius * ball.radius)
      sum += d, squares += d.squaredNorm(), ++count;
  sum /= count;
  return {ball.mean + sum, furthest * std::sqrt(std::fmax(squares / count - sum.squaredNorm(), 0) / 3)};
}

}  // namespace

std::vector<bool> dense_clump(const Eigen::Matrix3Xd& cloud) {
  const auto n = static_cast<std::size_t>(cloud.cols());
  constexpr std::size_t fewest = 20;
  if (n < fewest) return {};
  const std::vector<std::size_t> chosen = evenly_chosen(n, looked_at);
  const Eigen::Matrix3Xd some = cloud(Eigen::all, chosen);
  const auto m = static_cast<std::size_t>(some.cols());
  const auto k = std::max<std::size_t>(4, static_cast<std::size_t>(neighbourhood * static_cast<double>(m)));
  std::vector<double> reach(m), squares(m);
  for (std::size_t i = 0; i < m; ++i) {
    const Eigen::Vector3d at = some.col(static_cast<Eigen::Index>(i));
    Eigen::Map<Eigen::RowVectorXd>(squares.data(), some.cols()) =
        (some.colwise() - at).colwise().squaredNorm();
    std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(k), squares.end());
    reach[i] = squares[k];
  }
  const auto densest = std::min_element(reach.begin(), reach.end());
  const Eigen::Vector3d middle = some.col(densest - reach.begin());
  const double least = std::sqrt(*densest);
  const auto sparse = reach.begin() + static_cast<std::ptrdiff_t>(2 * m / 3);
  std::nth_element(reach.begin(), sparse, reach.end());
  Ball ball{middle, denser * std::sqrt(*sparse)};
  if (!(least > 0 && least < ball.radius)) return {};
  for (int round = 0; round < 30; ++round) {
    const Ball grown = next(some, ball);
    const bool stays = std::fabs(grown.radius - ball.radius) <= 1e-6 * ball.radius;
    ball = grown;
    if (stays) break;
  }
  std::vector<bool> clump(n, false);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d d = cloud.col(static_cast<Eigen::Index>(i)) - ball.mean;
    if (!(d.squaredNorm() <= ball.radius * ball.radius)) continue;
    clump[i] = true;
    scatter += d * d.transpose();
    ++count;
  }
  const double share = count / static_cast<double>(n);
  if (!(share >= least_share && share <= most_share)) return {};
  const Eigen::Vector3d variances = closed_form_symmetric_eigen(scatter).values;
  if (!(variances.minCoeff() >= least_round * variances.maxCoeff())) return {};
  return clump;
}

ClumpShape shape_of_clump(const Eigen::Matrix3Xd& cloud, const std::vector<bool>& clump) {
  std::vector<Eigen::Index> columns;
  for (std::size_t i = 0; i < clump.size(); ++i)
    if (clump[i]) columns.push_back(static_cast<Eigen::Index>(i));
  Eigen::Matrix3Xd points = cloud(Eigen::all, columns);
  points.colwise() -= Eigen::Vector3d(points.rowwise().mean());
  const double variance = points.squaredNorm() / (3 * static_cast<double>(points.cols()));
  constexpr double between = 5.7;  // the root of 4 times 8
  constexpr std::size_t fewest = 100;
  if (columns.size() < fewest) return {std::sqrt(variance), false};
  const Eigen::Matrix3Xd some = points(Eigen::all, evenly_chosen(columns.size(), looked_at));
  double within[2]{};
  for (Eigen::Index i = 1; i < some.cols(); ++i)
    for (Eigen::Index k = 0; k < i; ++k) {
      const double square = (some.col(i) - some.col(k)).squaredNorm();
      within[0] += square < 0.25 * variance, within[1] += square < variance;
    }
  return {std::sqrt(variance), within[1] > between * within[0]};
}

}  // namespace darboux::fit
