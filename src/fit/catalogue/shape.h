// A placed surface: its unknowns, the feet of points on it, and how their distances change with the unknowns.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/any_surface.h>
#include <darboux/project.h>

#include "fit/common/parameter_jet.h"
#include "fit/common/reduced_normal_equations.h"

namespace darboux::fit::catalogue {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

using Positions = std::vector<Eigen::Vector3d>;

// The surface in its assumed placement; the points are centred, not scaled.
struct Shape {
  AnySurface surface;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
};

// The values of the parameters.
std::vector<double> values_of(const AnySurface& surface);

// The surface with other values; none if one is out of range, or they contradict each other.
std::optional<AnySurface> with_values(const AnySurface& surface, const std::vector<double>& values);

// Which parameters are lengths: those that scale the surface when they are scaled together, P = sum p_k
// dP/dp_k (Euler). Empty if the surface has a fixed size.
std::vector<bool> lengths_of(const AnySurface& surface);

// The unknowns of one solve, relative to the current shape, are a motion δ: (rotation vector about the
// points' origin, translation, parameters), in these units, which make them about equally large.
Eigen::VectorXd units_of(const Shape& shape, const std::vector<double>& typical, double size);

// The shape moved by δ; none if such parameters are not permitted.
std::optional<Shape> moved(const Shape& shape, const Eigen::VectorXd& delta);

// Finds the feet of points.
class FootFinder {
 public:
  explicit FootFinder(const Shape& shape) : projector_(shape.surface), inverse_(shape.placement.inverse()) {}
  Projection search(const Eigen::Vector3d& x) const { return projector_(from_eigen(inverse_ * x)); }
  Projection follow(const Eigen::Vector3d& x, const Vec2<double>& start) const {
    return projector_(from_eigen(inverse_ * x), start);
  }

 private:
  Projector projector_;
  Eigen::Isometry3d inverse_;
};

struct FootPoints {
  std::vector<Vec2<double>> uv;
  std::vector<double> distance, curvature;  // signed; k1 + k2, positive where convex towards the surface's n
};

// The feet of all points, followed from those of a shape nearby or, without these, searched globally.
FootPoints feet_of(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts);

// Derivatives of the distance over the size, in units of the unknowns.
using Row = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6 + most_parameters, 1>;

// Derivatives of the distance of a point: -n · (velocity of the surface at the foot). The foot's own motion
// is orthogonal to n.
class DistanceRow {
 public:
  // At the shape moved by δ.
  DistanceRow(const Shape& shape, const Eigen::VectorXd& delta, const Eigen::VectorXd& units, double size);
  Row operator()(const Projection& foot, const Eigen::Vector3d& x) const;

 private:
  const Shape& shape_;
  Eigen::Matrix3d by_turn_;
  Eigen::Vector3d shift_;
  Row units_;
  double size_;
};

// Directions along which no weighted distance changes are not identifiable: their squared share of the best
// known direction is below this. Rounding leaves some 1e-30; a ratio of 1e-6 of standard deviations is still
// identifiable.
inline constexpr double unidentifiable_below = 1e-12;

// Normal equations.
struct Normal {
  Eigen::MatrixXd h;  // J^T W J, its lower triangle
  Eigen::VectorXd g;  // J^T W r

  explicit Normal(Eigen::Index n) : h(Eigen::MatrixXd::Zero(n, n)), g(Eigen::VectorXd::Zero(n)) {}
  void add(const Row& row, double weight, double r) {
    h.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    g += weight * r * row;
  }
  ReducedNormalEquations reduced() const { return ReducedNormalEquations(h, unidentifiable_below); }
};

}  // namespace darboux::fit::catalogue
