#include "point_states.h"

#include <algorithm>
#include <cmath>

#include "fit/common/noise_bias.h"

namespace darboux::fit {
namespace {

double root_mean_square_of_bias(const PointStates& points) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < points.bias.size(); ++i)
    if (points.in_support[i]) sum += points.bias[i] * points.bias[i], count += 1;
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

// The outliers' density is counted where inliers do not contribute, in windows (1 - x^2)^3 some seven sigma
// to either side, plus a tenth of a point so that it is never zero. Sigma is found by expectation and
// maximisation: two steps, then an extrapolation to their limit, as each gains about the same factor.
void update(Mixture& mixture, const PointStates& points, bool robust_phase) {
  constexpr double middle = 7, half_width = 3;
  // The windows' integral over that of exp(-r^2 / 2): 2 half_width 32 / 35 / sqrt(2 pi).
  constexpr double windows = 2 * half_width * 32 / 35 / 2.506628274631001;
  std::vector<double> near;
  for (std::size_t i = 0; i < points.d.size(); ++i)
    if (points.in_support[i] && std::fabs(points.error(i)) < 40 * mixture.sigma)
      near.push_back(points.error(i));
  if (near.empty()) {
    mixture.inliers = 0;
    return;
  }
  const auto count = [&](Mixture& at) {
    if (at.outliers == 0) return;
    double others = 0.1;
    for (const double e : near) {
      const double x = (std::fabs(e / at.sigma) - middle) / half_width, y = 1 - x * x;
      if (y > 0) others += y * y * y;
    }
    at.outliers = others / (windows * (robust_phase ? static_cast<double>(near.size()) : at.inliers));
  };
  const auto step = [&](Mixture at) {
    count(at);
    ExpectedInliers expected;
    for (const double e : near) {
      const double w = inlier_probability(e, at);
      expected.add(w, w * e * e);
    }
    expected.estimate_sigma(at, 1, at.least_sigma);
    at.inliers = std::max(at.inliers, 1.0);
    return at;
  };
  const Mixture once = step(mixture), twice = step(once);
  const double first = std::log(once.sigma / mixture.sigma), second = std::log(twice.sigma / once.sigma);
  const double ratio = second / first;
  mixture = twice;
  if (ratio > -0.8 && ratio < 0.8)
    mixture.sigma = std::max(mixture.sigma * std::exp(ratio / (1 - ratio) * second), mixture.least_sigma);
  // The biases belong to the previous sigma; they change with it, and the distances by the same amount.
  if (!mixture.sigma_known) mixture.sigma = std::max(mixture.sigma, root_mean_square_of_bias(points));
  count(mixture);
}

void update_bias(const Mixture& mixture, PointStates& points) {
  for (std::size_t i = 0; i < points.d.size(); ++i) points.bias[i] = bias(mixture.sigma, points.curvature[i]);
}

std::vector<double> inlier_probabilities(const PointStates& points, const Mixture& mixture) {
  std::vector<double> w(points.d.size());
  for (std::size_t i = 0; i < w.size(); ++i)
    w[i] = points.in_support[i] ? inlier_probability(points.error(i), mixture) : 0;
  return w;
}

}  // namespace darboux::fit
