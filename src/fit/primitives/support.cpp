#include "support.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace darboux::fit {
namespace {

constexpr int most = 64;  // cells along a coordinate

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

// The cells along one coordinate. They lie symmetrically, so that signs do not matter. An interval of evenly
// spread points is sqrt(12) standard deviations long; it gets half the cells, as half a turn does.
struct Cells {
  double origin, width;

  Cells(const std::vector<NearPoint>& near, double SupportCoordinates::*coordinate, double range,
        double total, int count) {
    double mean = 0, square = 0;
    for (const NearPoint& x : near) mean += x.weight * x.at.*coordinate / total;
    for (const NearPoint& x : near)
      square += x.weight * (x.at.*coordinate - mean) * (x.at.*coordinate - mean) / total;
    origin = range > 0 ? 0 : mean;
    width = range > 0 ? range / count : std::sqrt(12 * square) / (count / 2);
  }
  double operator()(double x) const { return std::floor((x - origin) / width) + most / 2; }
};

// Over the points.
double median_density(std::vector<std::pair<double, double>> densities, double total) {
  std::sort(densities.begin(), densities.end());
  double below = 0, median = 0;
  for (const auto& [density, weight] : densities) {
    median = density;
    below += weight;
    if (below >= 0.5 * total) break;
  }
  return median;
}

}  // namespace

void find_support(const Primitive& primitive, const Eigen::Matrix3Xd& cloud,
                  const GeometricParameters& surface, const Mixture& mixture, PointStates& states) {
  std::vector<NearPoint> near;
  double total = 0;
  for (std::size_t i = 0; i < states.d.size(); ++i) {
    if (!states.regular[i] || std::fabs(states.error(i)) > 20 * mixture.sigma) continue;
    near.push_back({i, inlier_probability(states.error(i), mixture), {}, 0});
    total += near.back().weight;
  }
  const int cells = std::min(24, 2 * static_cast<int>(std::sqrt(total / 60)));
  states.in_support = states.regular;
  if (cells < 4) return;
  const Moments m = moments(near, cloud, total);
  const GeometricParameters frame = primitive.support.frame(surface, m.mean, m.scatter);
  const Matrix3d to_frame = frame.axes.transpose();
  for (NearPoint& x : near)
    x.at = primitive.support.coordinates(
        frame, to_frame * (cloud.col(static_cast<Eigen::Index>(x.point)) - frame.centre));
  const Cells along_a(near, &SupportCoordinates::a, primitive.support.range_a, total, cells),
      along_b(near, &SupportCoordinates::b, primitive.support.range_b, total, cells);
  std::vector<double> count(most * most, 0), area(most * most, 0);
  std::vector<int> points(most * most, 0);
  for (NearPoint& x : near) {
    const double a = along_a(x.at.a), b = along_b(x.at.b);
    x.cell = a >= 0 && a < most && b >= 0 && b < most ? static_cast<int>(a) * most + static_cast<int>(b) : -1;
    if (x.cell < 0) continue;
    const auto cell = static_cast<std::size_t>(x.cell);
    count[cell] += x.weight;
    area[cell] += x.at.area;
    ++points[cell];
  }
  std::vector<std::pair<double, double>> densities;  // with the points that have it
  for (std::size_t c = 0; c < count.size(); ++c) {
    if (points[c] == 0) continue;
    count[c] /= area[c] / points[c];
    densities.emplace_back(count[c], count[c] * area[c] / points[c]);
  }
  const double median = median_density(std::move(densities), total);
  for (const NearPoint& x : near)
    states.in_support[x.point] = x.cell >= 0 && count[static_cast<std::size_t>(x.cell)] >= 0.3 * median;
}

}  // namespace darboux::fit
