// Which part of an unbounded surface the points cover: outliers on its continuation have a long lever, and
// nothing else gives them away. The surface is cut into cells; those with too few points do not count.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "estimate.h"
#include "model.h"

namespace darboux::fit {

// Two coordinates of a surface point and the area of a unit of them.
struct Chart {
  double a, b, area;
};

// Coordinates over the whole surface. The frame comes from the surface and the points, so that a turned cloud
// gets the same cells: z along the axis, x towards the points' centre. Cells lie symmetrically, so that signs
// do not matter.
template <class Shape>
class Charted {
 public:
  Charted(const Natural& n, const Vector3d& mean, const Matrix3d& scatter) : n_(n), axes_(n.axes) {
    const Vector3d q = mean - n.centre;
    if constexpr (std::is_same_v<Shape, PlaneShape> || std::is_same_v<Shape, SphereShape>) {
      const Vector3d z =
          std::is_same_v<Shape, PlaneShape> ? Vector3d(n.axes.col(2)) : Vector3d(q.normalized());
      const Matrix3d across = Matrix3d::Identity() - z * z.transpose();
      const Vector3d x =
          Eigen::SelfAdjointEigenSolver<Matrix3d>(across * scatter * across).eigenvectors().col(2);
      set(x, z);
    } else if constexpr (!std::is_same_v<Shape, EllipsoidShape>) {
      const Vector3d z = n.axes.col(2), x = q - q.dot(z) * z;
      set(x, z);
    }
    if constexpr (std::is_same_v<Shape, PlaneShape> || std::is_same_v<Shape, CylinderShape>) n_.centre = mean;
    if constexpr (std::is_same_v<Shape, CylinderShape>)
      n_.centre = n.centre + q.dot(n.axes.col(2)) * n.axes.col(2);
  }

  Chart at(const Vector3d& x) const {
    const Vector3d p = axes_.transpose() * (x - n_.centre);
    const double turn = std::atan2(p.y(), p.x()), across = std::hypot(p.x(), p.y());
    if constexpr (std::is_same_v<Shape, PlaneShape>) {
      return {p.x(), p.y(), 1};
    } else if constexpr (std::is_same_v<Shape, SphereShape>) {
      return {turn, p.z() / p.norm(), 1};
    } else if constexpr (std::is_same_v<Shape, CylinderShape>) {
      return {turn, p.z(), 1};
    } else if constexpr (std::is_same_v<Shape, ConeShape>) {
      const double along = across * std::sin(n_.lengths[0]) + p.z() * std::cos(n_.lengths[0]);
      return {turn, along, std::fabs(along)};
    } else if constexpr (std::is_same_v<Shape, TorusShape>) {
      const double tube = std::atan2(p.z(), across - n_.lengths[0]);
      return {turn, tube, std::fabs(n_.lengths[0] + n_.lengths[1] * std::cos(tube))};
    } else {
      const Vector3d a(n_.lengths[0], n_.lengths[1], n_.lengths[2]), unit = p.cwiseQuotient(a).normalized();
      return {std::atan2(unit.y(), unit.x()), unit.z(), unit.cwiseQuotient(a).norm()};
    }
  }
  // The whole range of a coordinate that has one; 0 for a length.
  static constexpr double range_a() { return std::is_same_v<Shape, PlaneShape> ? 0 : 2 * std::numbers::pi; }
  static constexpr double range_b() {
    if (std::is_same_v<Shape, TorusShape>) return 2 * std::numbers::pi;
    return std::is_same_v<Shape, SphereShape> || std::is_same_v<Shape, EllipsoidShape> ? 2 : 0;
  }

 private:
  void set(const Vector3d& x, const Vector3d& z) {
    axes_.col(2) = z;
    axes_.col(0) = x.norm() > 0 ? Vector3d(x.normalized()) : z.unitOrthogonal();
    axes_.col(1) = z.cross(axes_.col(0));
  }
  Natural n_;
  Matrix3d axes_;
};

// Sets states.kept. A cell keeps its points where their density is at least 0.3 of the median one, over the
// points. Few points: fewer cells, or none.
template <class Shape>
void gate(const Eigen::Matrix3Xd& cloud, const Natural& surface, const Noise& noise, PointStates& states) {
  constexpr int most = 64;
  struct Near {
    std::size_t point;
    double weight;
    Chart chart;
    int cell;
  };
  std::vector<Near> near;
  double total = 0;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < states.d.size(); ++i) {
    if (!states.regular[i] || std::fabs(states.error(i)) > 20 * noise.sigma) continue;
    near.push_back({i, inlier_probability(states.error(i), noise), {}, 0});
    total += near.back().weight;
    mean += near.back().weight * cloud.col(static_cast<Eigen::Index>(i));
  }
  const int cells = std::min(24, 2 * static_cast<int>(std::sqrt(total / 60)));
  states.kept = states.regular;
  if (cells < 4) return;
  mean /= total;
  Matrix3d scatter = Matrix3d::Zero();
  for (const Near& x : near) {
    const Vector3d q = cloud.col(static_cast<Eigen::Index>(x.point)) - mean;
    scatter += (x.weight * q) * q.transpose();
  }
  const Charted<Shape> charted(surface, mean, scatter);
  double mean_a = 0, mean_b = 0;
  for (Near& x : near) {
    x.chart = charted.at(cloud.col(static_cast<Eigen::Index>(x.point)));
    mean_a += x.weight * x.chart.a / total;
    mean_b += x.weight * x.chart.b / total;
  }
  double square_a = 0, square_b = 0;
  for (const Near& x : near) {
    square_a += x.weight * (x.chart.a - mean_a) * (x.chart.a - mean_a) / total;
    square_b += x.weight * (x.chart.b - mean_b) * (x.chart.b - mean_b) / total;
  }
  // An interval of evenly spread points is sqrt(12) standard deviations long; it gets half the cells, as half
  // a turn does.
  const auto width = [&](double range, double square) {
    return range > 0 ? range / cells : std::sqrt(12 * square) / (cells / 2);
  };
  const double origin_a = charted.range_a() > 0 ? 0 : mean_a;
  const double origin_b = charted.range_b() > 0 ? 0 : mean_b;
  const double width_a = width(charted.range_a(), square_a), width_b = width(charted.range_b(), square_b);
  std::vector<double> count(most * most, 0), area(most * most, 0);
  std::vector<int> points(most * most, 0);
  for (Near& x : near) {
    const double a = std::floor((x.chart.a - origin_a) / width_a) + most / 2;
    const double b = std::floor((x.chart.b - origin_b) / width_b) + most / 2;
    x.cell = a >= 0 && a < most && b >= 0 && b < most ? static_cast<int>(a) * most + static_cast<int>(b) : -1;
    if (x.cell < 0) continue;
    const auto cell = static_cast<std::size_t>(x.cell);
    count[cell] += x.weight;
    area[cell] += x.chart.area;
    ++points[cell];
  }
  std::vector<std::pair<double, double>> densities;  // with the points that have it
  for (std::size_t c = 0; c < count.size(); ++c) {
    if (points[c] == 0) continue;
    count[c] /= area[c] / points[c];
    densities.emplace_back(count[c], count[c] * area[c] / points[c]);
  }
  std::sort(densities.begin(), densities.end());
  double below = 0, median = 0;
  for (const auto& [density, weight] : densities) {
    median = density;
    below += weight;
    if (below >= 0.5 * total) break;
  }
  for (const Near& x : near)
    states.kept[x.point] = x.cell >= 0 && count[static_cast<std::size_t>(x.cell)] >= 0.3 * median;
}

}  // namespace darboux::fit
