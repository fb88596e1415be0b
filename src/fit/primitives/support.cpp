#include "support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "base/quantile.h"
#include "fit/common/intervals.h"

namespace darboux::fit {
namespace {

constexpr int most = 64;  // cells along a coordinate

// Points further off than this many standard deviations of the noise are not near.
constexpr double near_deviations = 20;

struct NearPoint {
  std::size_t point;
  double weight;
  SupportCoordinates at;
  int cell;
};

struct Moments {
  Vector3d mean;
  Matrix3d scatter;
};

Moments moments(const std::vector<NearPoint>& near, const Eigen::Matrix3Xd& cloud, double total) {
  Moments m{Vector3d::Zero(), Matrix3d::Zero()};
  for (const NearPoint& x : near) m.mean += x.weight * cloud.col(static_cast<Eigen::Index>(x.point));
  m.mean /= total;
  for (const NearPoint& x : near) {
    const Vector3d q = cloud.col(static_cast<Eigen::Index>(x.point)) - m.mean;
    m.scatter += (x.weight * q) * q.transpose();
  }
  return m;
}

// The value up to which the sorted (value, weight) pairs have this total weight.
double weighted_quantile(const std::vector<std::pair<double, double>>& sorted, double weight) {
  for (const auto& [value, w] : sorted)
    if ((weight -= w) <= 0) return value;
  return sorted.back().first;
}

// The cells along one coordinate, `count` of them over the range of the points: that of the middle 70 %,
// extended as for evenly spread points. Angles are counted from where most points are, and the range is the
// whole turn if it is nearly all of it.
class Cells {
 public:
  Cells(const std::vector<NearPoint>& near, double SupportCoordinates::*coordinate, double range,
        double total, int count)
      : turn_(range == turn) {
    if (turn_) {
      double cosines = 0, sines = 0;
      for (const NearPoint& x : near) {
        cosines += x.weight * std::cos(x.at.*coordinate);
        sines += x.weight * std::sin(x.at.*coordinate);
      }
      zero_ = std::atan2(sines, cosines);
    }
    std::vector<std::pair<double, double>> values;
    for (const NearPoint& x : near) values.emplace_back(from_zero(x.at.*coordinate), x.weight);
    std::sort(values.begin(), values.end());
    const double low = weighted_quantile(values, 0.15 * total),
                 high = weighted_quantile(values, 0.85 * total);
    double length = (high - low) / 0.7;
    begin_ = low - 0.15 * length;
    if (turn_ && length > 0.8 * turn) begin_ = -0.5 * turn, length = turn;
    width_ = length > 0 ? length / count : 1;
  }
  double operator()(double x) const { return std::floor((from_zero(x) - begin_) / width_) + first; }

 private:
  static constexpr double turn = 2 * std::numbers::pi;
  static constexpr int first = most / 3;  // the cell at the begin: coordinates below it have cells too

  double from_zero(double x) const { return turn_ ? std::remainder(x - zero_, turn) : x; }

  bool turn_;
  double zero_ = 0, begin_, width_;
};

// \return the points of clean sparse cells
std::vector<Eigen::Index> keep_dense_cells(const Primitive& primitive, const Eigen::Matrix3Xd& cloud,
                                           const GeometricParameters& surface, std::vector<NearPoint>& near,
                                           double total, double sigma, double least_sigma,
                                           PointStates& states) {
  const int cells = std::min(12, static_cast<int>(std::sqrt(total / 60)));
  const Moments m = moments(near, cloud, total);
  const GeometricParameters frame = primitive.support.frame(surface, m.mean, m.scatter);
  const Matrix3d to_frame = frame.axes.transpose();
  for (NearPoint& x : near)
    x.at = primitive.support.coordinates(
        frame, to_frame * (cloud.col(static_cast<Eigen::Index>(x.point)) - frame.centre));
  const Cells along_a(near, &SupportCoordinates::a, primitive.support.range_a, total, cells),
      along_b(near, &SupportCoordinates::b, primitive.support.range_b, total, cells);
  std::vector<double> count(most * most, 0), area(most * most, 0), squares(most * most, 0);
  std::vector<int> points(most * most, 0), within(most * most, 0), beside(most * most, 0);
  for (NearPoint& x : near) {
    const double a = along_a(x.at.a), b = along_b(x.at.b);
    x.cell = a >= 0 && a < most && b >= 0 && b < most ? static_cast<int>(a) * most + static_cast<int>(b) : -1;
    if (x.cell < 0) continue;
    const auto cell = static_cast<std::size_t>(x.cell);
    count[cell] += x.weight;
    squares[cell] += x.weight * states.error(x.point) * states.error(x.point);
    area[cell] += x.at.area;
    ++points[cell];
    ++(std::fabs(states.error(x.point)) <= 3 * sigma ? within : beside)[cell];
  }
  std::vector<double> density(most * most, 0), variances;
  std::vector<std::pair<double, double>> densities;  // with the points that have it
  for (std::size_t c = 0; c < count.size(); ++c) {
    if (points[c] == 0) continue;
    density[c] = count[c] * points[c] / area[c];
    densities.emplace_back(density[c], count[c]);
    if (count[c] >= 8) variances.push_back(squares[c] / count[c]);
  }
  if (densities.empty()) return {};
  std::sort(densities.begin(), densities.end());
  // A clump: cells twice as dense as those of the sparsest third of the points, whose distances are neither
  // the others' noise nor rounding; adjoining cells with wider distances belong to it too.
  const double sparse = weighted_quantile(densities, 0.3 * total),
               variance = variances.empty() ? std::numeric_limits<double>::infinity()
                                            : std::fmax(median(variances), least_sigma * least_sigma);
  const auto is_wider = [&](std::size_t c, double factor, double chance) {
    const double ratio = squares[c] / (variance * count[c]);
    return count[c] >= 2 && ratio > factor && chance_of_ratio(ratio, count[c], total) < chance;
  };
  std::vector<unsigned char> is_clump(most * most, 0);
  for (int a = 0; a < most; ++a) {
    for (int b = 0; b < most; ++b) {
      const auto c = static_cast<std::size_t>(a * most + b);
      if (!(density[c] > 2 * sparse) || !is_wider(c, 1.5, 1e-6)) continue;
      is_clump[c] = 1;
      for (int i = std::max(a - 1, 0); i <= std::min(a + 1, most - 1); ++i) {
        for (int j = std::max(b - 1, 0); j <= std::min(b + 1, most - 1); ++j) {
          const auto near_it = static_cast<std::size_t>(i * most + j);
          if (is_wider(near_it, 1.15, 0.01)) is_clump[near_it] = 1;
        }
      }
    }
  }
  densities.clear();
  total = 0;
  for (std::size_t c = 0; c < count.size(); ++c) {
    if (points[c] == 0 || is_clump[c]) continue;
    densities.emplace_back(density[c], count[c]);
    total += count[c];
  }
  std::sort(densities.begin(), densities.end());
  const double typical = densities.empty() ? 0 : weighted_quantile(densities, 0.5 * total);
  // Sparse points are not outliers if hardly any lie just outside the noise band: outliers would be as dense
  // there. Three more than were found may be expected. All lengths are relative to the size of the points,
  // which is 1.
  const auto is_clean = [&](std::size_t c) {
    constexpr double few = 0.1, band = 3, beyond = near_deviations - band;
    return near_deviations * sigma < 1 && (beside[c] + 3) * band / beyond < few * within[c];
  };
  std::vector<Eigen::Index> sparse_points;
  for (const NearPoint& x : near) {
    const auto c = static_cast<std::size_t>(x.cell);
    const bool may_be = x.cell >= 0 && !is_clump[c], is_dense = may_be && density[c] >= 0.3 * typical;
    states.in_support[x.point] = is_dense;
    if (may_be && !is_dense && is_clean(c)) sparse_points.push_back(static_cast<Eigen::Index>(x.point));
  }
  return sparse_points;
}

// For too few points for cells: uses the distance within which the other points weigh `enough`.
void keep_points_with_neighbours(const Eigen::Matrix3Xd& cloud, const std::vector<NearPoint>& near,
                                 double total, double least_sigma, PointStates& states) {
  constexpr double enough = 4,
                   furthest = 2.9;  // times the median: half as dense at an edge, a quarter at a corner
  std::vector<std::pair<double, double>> reach;  // squared, with the point's weight
  std::vector<std::pair<double, double>> others;
  for (const NearPoint& x : near) {
    others.clear();
    for (const NearPoint& y : near)
      if (y.point != x.point)
        others.emplace_back(
            (cloud.col(static_cast<Eigen::Index>(x.point)) - cloud.col(static_cast<Eigen::Index>(y.point)))
                .squaredNorm(),
            y.weight);
    std::sort(others.begin(), others.end());
    reach.emplace_back(weighted_quantile(others, enough), x.weight);
  }
  auto sorted = reach;
  std::sort(sorted.begin(), sorted.end());
  // A clump: points with a reach below two fifths of that of the sparsest third, with distances wider than
  // noise.
  const double sparse = weighted_quantile(sorted, 0.7 * total);
  const auto is_dense = [&](std::size_t k) { return reach[k].first < 0.16 * sparse; };
  double count[2]{}, squares[2]{};
  for (std::size_t k = 0; k < near.size(); ++k) {
    const double e = states.error(near[k].point);
    count[is_dense(k)] += near[k].weight, squares[is_dense(k)] += near[k].weight * e * e;
  }
  const double variance = std::fmax(squares[0] / count[0], least_sigma * least_sigma),
               ratio = count[1] > 4 ? squares[1] / (variance * count[1]) : 0;
  const bool clump = ratio > 1.5 && chance_of_ratio(ratio, count[1], count[0]) < 1e-3;
  const double typical = weighted_quantile(sorted, clump ? count[1] + 0.5 * count[0] : 0.5 * total);
  for (std::size_t k = 0; k < near.size(); ++k)
    states.in_support[near[k].point] =
        reach[k].first <= furthest * furthest * typical && !(clump && is_dense(k));
}

}  // namespace

std::vector<Eigen::Index> find_support(const Primitive& primitive, const Eigen::Matrix3Xd& cloud,
                                       const GeometricParameters& surface, const Mixture& mixture,
                                       PointStates& states) {
  std::vector<NearPoint> near;
  double total = 0;
  for (std::size_t i = 0; i < states.d.size(); ++i) {
    if (!states.regular[i] || std::fabs(states.error(i)) > near_deviations * mixture.sigma) continue;
    near.push_back({i, inlier_probability(states.error(i), mixture), {}, 0});
    total += near.back().weight;
  }
  states.in_support = states.regular;
  if (total >= 240)
    return keep_dense_cells(primitive, cloud, surface, near, total, mixture.sigma, mixture.least_sigma,
                            states);
  if (total >= 16) keep_points_with_neighbours(cloud, near, total, mixture.least_sigma, states);
  return {};
}

}  // namespace darboux::fit
