#include "starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "base/quantile.h"
#include "principal.h"

namespace darboux::fit::catalogue {
namespace {

// A point of the surface; the normal is zero where there is none.
struct Node {
  Eigen::Vector3d position, normal;
  double u, v;
};

std::vector<Node> nodes_of(const AnySurface& surface) {
  constexpr int grid = 17;
  std::vector<Node> result;
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      const double u = column / (grid - 1.0), v = row / (grid - 1.0);
      const Vec3<double> p = surface.jet(u, v).position, n = surface.frame(u, v).n;
      if (detail::finite(p))
        result.push_back({to_eigen(p), detail::finite(n) ? to_eigen(n) : Eigen::Vector3d::Zero(), u, v});
    }
  return result;
}

// About how far a point is from the surface of these nodes.
double distance_from(const std::vector<Node>& nodes, const Eigen::Vector3d& x) {
  const Node* nearest = &nodes.front();
  double least = infinity;
  for (const Node& node : nodes)
    if (const double d = (node.position - x).squaredNorm(); d < least) least = d, nearest = &node;
  const Eigen::Vector3d way = x - nearest->position;
  return nearest->normal.isZero() ? way.norm() : std::fabs(way.dot(nearest->normal)) + 0.1 * way.norm();
}

// The parameters as they are, and each of them halved or doubled where they are few.
std::vector<AnySurface> variants_of(const AnySurface& standard) {
  std::vector<AnySurface> result{standard};
  const std::vector<double> values = values_of(standard);
  if (values.size() > 5) return result;
  for (std::size_t k = 0; k < values.size(); ++k)
    for (const double factor : {0.5, 2.0}) {
      std::vector<double> changed = values;
      changed[k] *= factor;
      if (changed[k] == 0) continue;
      if (const std::optional<AnySurface> variant = with_values(standard, changed))
        result.push_back(*variant);
    }
  return result;
}

// The 24 rotations that take the axes to the axes.
std::vector<Eigen::Matrix3d> axis_rotations() {
  std::vector<Eigen::Matrix3d> result;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) m(order[static_cast<std::size_t>(k)], k) = signs >> k & 1 ? -1 : 1;
      if (m.determinant() > 0) result.push_back(m);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return result;
}

// How the principal axes of a part may be oriented relative to those of the points: aligned, and rotated
// where the spread is nearly circular.
std::vector<Eigen::Matrix3d> turns_between(const Principal& of_points, const Principal& of_part) {
  const std::vector<Eigen::Matrix3d> along = axis_rotations();
  std::vector<Eigen::Matrix3d> result = along;
  const bool about_points = !of_points.round.empty();
  for (const int axis : about_points ? of_points.round : of_part.round)
    for (const double angle : {std::numbers::pi / 6, std::numbers::pi / 3})
      for (const Eigen::Matrix3d& turn : along) {
        const Eigen::Matrix3d more = Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
        result.push_back(about_points ? Eigen::Matrix3d(more * turn) : Eigen::Matrix3d(turn * more));
      }
  return result;
}

}  // namespace

std::vector<Start> starts_of(const AnySurface& standard, const std::vector<bool>& lengths,
                             const Positions& points) {
  constexpr double parts[7][2] = {{0, 1}, {0, 0.5}, {0.5, 1}, {0, 0.25}, {0.25, 0.5}, {0.5, 0.75}, {0.75, 1}};
  const Principal of_points = principal(points);
  const Positions some(
      points.begin(), points.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(points.size(), 60)));
  std::vector<Start> result;
  for (const AnySurface& variant : variants_of(standard)) {
    const std::vector<Node> nodes = nodes_of(variant);
    for (const auto& along_u : parts)
      for (int part_v = 0; part_v < 3; ++part_v) {
        const auto& along_v = parts[part_v];
        Positions part;
        for (const Node& node : nodes)
          if (along_u[0] <= node.u && node.u <= along_u[1] && along_v[0] <= node.v && node.v <= along_v[1])
            part.push_back(node.position);
        if (part.size() < 3) continue;
        const Principal of_part = principal(part);
        const double scale = lengths.empty() ? 1 : of_points.size / of_part.size;
        if (!(0 < scale && scale < infinity)) continue;
        for (const Eigen::Matrix3d& turn : turns_between(of_points, of_part)) {
          const Eigen::Matrix3d rotation = of_points.axes * turn * of_part.axes.transpose();
          std::vector<double> distance;
          for (const Eigen::Vector3d& x : some)
            distance.push_back(
                distance_from(nodes, of_part.centre + rotation.transpose() * (x - of_points.centre) / scale));
          std::vector<double> values = values_of(variant);
          for (std::size_t k = 0; k < lengths.size(); ++k)
            if (lengths[k]) values[k] *= scale;
          Shape shape{variant.with(values)};
          shape.placement.linear() = rotation;
          shape.placement.translation() = of_points.centre - rotation * of_part.centre * scale;
          result.push_back({std::move(shape), scale * ranked(distance, 6 * (distance.size() - 1) / 10)});
        }
      }
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Start& a, const Start& b) { return a.score < b.score; });
  return result;
}

}  // namespace darboux::fit::catalogue
