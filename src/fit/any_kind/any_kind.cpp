#include "any_kind.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <span>

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include <darboux/error.h>
#include <darboux/forms.h>
#include <darboux/project.h>

#include "../../text.h"
#include "../compressed.h"
#include "../kinds.h"
#include "../manifolds.h"
#include "../parameter_jet.h"
#include "../scaled.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using Positions = std::vector<Eigen::Vector3d>;

// The surface where it is supposed to be; the points are centred, not scaled.
struct Shape {
  AnySurface surface;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
};

std::vector<double> values_of(const AnySurface& surface) {
  std::vector<double> result;
  for (const ParameterValue& p : surface.parameters()) result.push_back(p.value);
  return result;
}

// Which parameters are lengths: those that scale the surface when they are scaled together, P = sum p_k dP/dp_k (Euler).
// Empty where the surface has a size of its own.
std::vector<bool> lengths_of(const AnySurface& surface) {
  const std::vector<double> values = values_of(surface);
  const std::size_t n = values.size();
  for (unsigned set = 1U << n; set-- > 1;) {
    double error = 0, size = 0;
    for (const double u : {0.13, 0.41, 0.77})
      for (const double v : {0.22, 0.58, 0.91}) {
        const ParameterJet by = parameter_jet(surface, {u, v});
        const Vec3<double> p = surface.jet(u, v).position;
        Vec3<double> sum{};
        for (std::size_t k = 0; k < n; ++k)
          if (set >> k & 1U) sum += values[k] * by.position[k];
        error += norm(sum - p);
        size += norm(p);
      }
    // A parameter that is zero may be in or out; with all sets tried from the fullest on, it is in.
    if (error <= 1e-9 * size) {
      std::vector<bool> result;
      for (std::size_t k = 0; k < n; ++k) result.push_back(set >> k & 1U);
      return result;
    }
  }
  return {};
}

// Unknowns of one solve, from the shape at hand: (rotation vector about the points' origin, translation, parameters), in
// units that make them about equally large.
struct Unknowns {
  Eigen::VectorXd units;
};

Unknowns unknowns(const Shape& shape, const std::vector<double>& typical, double size) {
  const std::vector<double> values = values_of(shape.surface);
  Unknowns result{Eigen::VectorXd(6 + static_cast<Eigen::Index>(values.size()))};
  result.units.head<3>().setOnes();
  result.units.segment<3>(3).setConstant(size);
  for (std::size_t k = 0; k < values.size(); ++k)
    result.units[6 + static_cast<Eigen::Index>(k)] = std::fmax(std::fabs(values[k]), 0.1 * typical[k]);
  return result;
}

// The shape moved by δ; nothing where a parameter leaves its range.
std::optional<Shape> moved(const Shape& shape, const Eigen::VectorXd& delta) {
  std::vector<double> values = values_of(shape.surface);
  const std::vector<ParameterValue> parameters = shape.surface.parameters();
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] += delta[6 + static_cast<Eigen::Index>(k)];
    if (!parameters[k].permitted.contains(values[k])) return std::nullopt;
  }
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translation() = delta.segment<3>(3);
  const double angle = delta.head<3>().norm();
  if (angle > 0) motion.linear() = Eigen::AngleAxisd(angle, delta.head<3>() / angle).toRotationMatrix();
  try {
    return Shape{shape.surface.with(values), motion * shape.placement};
  } catch (const ParameterError&) {  // parameters that do not go together
    return std::nullopt;
  }
}

// The derivative of exp(ω) is exp(ω) turned by this.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
  const Eigen::Matrix3d m = fit::cross_matrix(omega);
  const double angle = omega.norm();
  // Series where the closed form cancels.
  const double first = angle < 1e-4 ? 0.5 : (1 - std::cos(angle)) / (angle * angle);
  const double second =
      angle < 1e-2 ? 1.0 / 6 - angle * angle / 120 : (angle - std::sin(angle)) / (angle * angle * angle);
  return Eigen::Matrix3d::Identity() + first * m + second * m * m;
}

struct Feet {
  std::vector<Vec2<double>> uv;
  std::vector<double> distance, curvature;  // signed; k1 + k2 of the surface's n
};

// Where points have their feet, by the placement turned round.
class Feeler {
 public:
  explicit Feeler(const Shape& shape) : projector_(shape.surface), inverse_(shape.placement.inverse()) {}
  Projection search(const Eigen::Vector3d& x) const { return projector_(from_eigen(inverse_ * x)); }
  Projection follow(const Eigen::Vector3d& x, const Vec2<double>& start) const {
    return projector_(from_eigen(inverse_ * x), start);
  }

 private:
  Projector projector_;
  Eigen::Isometry3d inverse_;
};

// The feet of all points, from those of a shape nearby, or searched for where there are none.
Feet feet_of(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts) {
  const Feeler feeler(shape);
  Feet result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Projection f = starts.empty() ? feeler.search(points[i]) : feeler.follow(points[i], starts[i]);
    const Sample<double> s = shape.surface.sample(f.uv.x, f.uv.y);
    const ShapeOperator<double> form = shape_operator(s.jet, s.frame);
    result.uv.push_back(f.uv);
    result.distance.push_back(f.distance);
    result.curvature.push_back(std::isfinite(form.a + form.c) ? form.a + form.c : 0);
  }
  return result;
}

// In units of the unknowns, of the distance over the size.
using Row = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6 + most_parameters, 1>;

// Derivatives of the distance of a point: -n · (velocity of the foot's point), the foot's own way being orthogonal to n.
class DistanceRow {
 public:
  // At the shape moved by δ.
  DistanceRow(const Shape& shape, const Eigen::VectorXd& delta, const Unknowns& unknowns, double size)
      : shape_(shape),
        by_turn_(-left_jacobian(delta.head<3>()).transpose()),
        shift_(delta.segment<3>(3)),
        units_(unknowns.units / size),
        size_(size) {}

  Row operator()(const Projection& f, const Eigen::Vector3d& x) const {
    const Eigen::Vector3d place = shape_.placement * to_eigen(f.position);
    Eigen::Vector3d n = shape_.placement.linear() * to_eigen(f.normal);
    // Also right at borders and apexes; on the surface the direction is all rounding.
    if (!(std::fabs(f.distance) <= 1e-8 * size_)) n = (x - place) / f.distance;
    const ParameterJet by = parameter_jet(shape_.surface, f.uv);
    Row row(6 + by.count);
    row.head<3>() = by_turn_ * (place - shift_).cross(n);
    row.segment<3>(3) = -n;
    const Eigen::Vector3d local = shape_.placement.linear().transpose() * n;
    for (int k = 0; k < by.count; ++k)
      row[6 + k] = -local.dot(to_eigen(by.position[static_cast<std::size_t>(k)]));
    return row.cwiseProduct(units_);
  }

 private:
  const Shape& shape_;
  Eigen::Matrix3d by_turn_;
  Eigen::Vector3d shift_;
  Row units_;
  double size_;
};

struct Weighted {
  std::vector<double> weight, bias;  // 0 <= weight; the mean distance that noise makes of none
};

// What the points do not tell: directions along which no weighted distance changes. Their squared share of the best known
// direction is below this; rounding leaves some 1e-30, and a ratio of 1e-6 of standard deviations is still told.
constexpr double unknown_below = 1e-12;
using Compressed = fit::Compressed<Eigen::Dynamic>;

struct Normal {
  Eigen::MatrixXd h;  // J^T W J
  Eigen::VectorXd g;  // J^T W r

  explicit Normal(Eigen::Index n) : h(Eigen::MatrixXd::Zero(n, n)), g(Eigen::VectorXd::Zero(n)) {}
  void add(const Row& row, double weight, double r) {
    h.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    g += weight * r * row;
  }
  void mirror() { h.triangularView<Eigen::StrictlyUpper>() = h.transpose(); }
};

// All points as one cost of n + 1 residuals. Feet follow those of the last accepted shape.
class BatchedCost final : public ceres::CostFunction {
 public:
  BatchedCost(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts,
              const Weighted& weighted, const Unknowns& unknowns, double size)
      : shape_(shape),
        points_(points),
        weighted_(weighted),
        unknowns_(unknowns),
        size_(size),
        accepted_(starts),
        tried_(starts) {
    const auto n = static_cast<int>(unknowns.units.size());
    set_num_residuals(n + 1);
    mutable_parameter_block_sizes()->push_back(n);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index n = unknowns_.units.size();
    const Eigen::VectorXd delta =
        Eigen::Map<const Eigen::VectorXd>(parameters[0], n).cwiseProduct(unknowns_.units);
    const std::optional<Shape> shape = moved(shape_, delta);
    if (!shape) return false;
    Eigen::Map<Eigen::VectorXd> r(residuals, n + 1);
    const bool rows = jacobians && jacobians[0];
    // Ceres asks for the cost of a step, and for its Jacobian once it is accepted: the feet are those found then.
    if (rows && delta == tried_at_) accepted_ = tried_;
    tried_ = accepted_;
    tried_at_ = delta;
    Normal normal(n);
    double squares = 0;
    if (!sums(*shape, delta, rows ? &normal : nullptr, squares)) return false;
    r.setZero();
    if (rows) {
      const Compressed compressed(normal.h, unknown_below);
      r.head(n) = compressed(normal.g);
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> j(jacobians[0],
                                                                                           n + 1, n);
      j << compressed.jacobian(), Eigen::RowVectorXd::Zero(n);
      accepted_ = tried_;
    }
    r[n] = fit::rest(squares, r.head(n));
    return true;
  }

  // How far the first Newton step moves the surface: the root of the weighted sum of squares of its movements at the points.
  double first_step() const {
    const Eigen::Index n = unknowns_.units.size();
    Normal normal(n);
    double squares = 0;
    if (!sums(shape_, Eigen::VectorXd::Zero(n), &normal, squares)) return infinity;
    return size_ * Compressed(normal.h, unknown_below)(normal.g).norm();
  }

 private:
  // The weighted squares of the distances over the size and, where they are asked for, the normal equations. False where
  // something is not finite.
  bool sums(const Shape& shape, const Eigen::VectorXd& delta, Normal* normal, double& squares) const {
    const Feeler feeler(shape);
    const DistanceRow row_of(shape, delta, unknowns_, size_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double w = weighted_.weight[i];
      if (w == 0) continue;
      const Projection f = feeler.follow(points_[i], tried_[i]);
      tried_[i] = f.uv;
      const double r = (f.distance - weighted_.bias[i]) / size_;
      if (!std::isfinite(r)) return false;
      squares += w * r * r;
      if (!normal) continue;
      const Row row = row_of(f, points_[i]);
      // Where the surface has no derivatives the point pulls at nothing, so that Ceres has a Jacobian wherever it has a cost.
      if (row.allFinite()) normal->add(row, w, r);
    }
    if (normal) normal->mirror();
    return std::isfinite(squares);
  }

  const Shape& shape_;
  const Positions& points_;
  const Weighted& weighted_;
  const Unknowns& unknowns_;
  double size_;
  // Ceres calls from one thread.
  mutable std::vector<Vec2<double>> accepted_, tried_;
  mutable Eigen::VectorXd tried_at_;
};

// The mixture of inliers and uniform outliers along the distance.
struct Mixture {
  double sigma, outlier_share, window;  // outliers lie within ±window/2
  bool sigma_known = false;

  double inlier(double e) const {
    const double r = e / sigma;
    return (1 - outlier_share) * std::exp(-0.5 * r * r) / (sigma * std::sqrt(2 * std::numbers::pi));
  }
  double outlier() const { return outlier_share / window; }
};

std::vector<double> sizes(const std::vector<double>& distance) {
  std::vector<double> result;
  for (const double d : distance) result.push_back(std::isfinite(d) ? std::fabs(d) : infinity);
  return result;
}

struct Estimate {
  Shape shape;
  Feet feet;
  Weighted weighted;
  Mixture mixture;
  double log_likelihood = -infinity;
  bool converged = false;
  int iterations = 0;
};

// Weights and noise from the distances, repeatedly; then the likelihood.
void expect(Estimate& e, double size) {
  const std::size_t n = e.feet.distance.size();
  e.weighted.weight.assign(n, 0);
  e.weighted.bias.assign(n, 0);
  Mixture& m = e.mixture;
  for (int step = 0; step < 10; ++step) {
    double inliers = 0, squares = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double bias = -0.5 * m.sigma * m.sigma * e.feet.curvature[i];  // convex towards n: k < 0 here
      e.weighted.bias[i] = std::fabs(bias) < m.sigma ? bias : 0;
      const double r = e.feet.distance[i] - e.weighted.bias[i], p = m.inlier(r);
      const double w = std::isfinite(r) ? p / (p + m.outlier()) : 0;
      e.weighted.weight[i] = w;
      inliers += w;
      squares += w > 0 ? w * r * r : 0;
    }
    if (!(inliers > 0)) break;
    if (!m.sigma_known) m.sigma = std::fmax(std::sqrt(squares / inliers), 1e-15 * size);
    m.outlier_share = std::clamp(1 - inliers / static_cast<double>(n), 1e-6, 0.9);
  }
  e.log_likelihood = 0;
  for (std::size_t i = 0; i < n; ++i)
    e.log_likelihood +=
        std::log((std::isfinite(e.feet.distance[i]) ? m.inlier(e.feet.distance[i] - e.weighted.bias[i]) : 0) +
                 m.outlier());
}

using Progress = std::function<void(double)>;

// Ceres with the weights held, then new feet and weights, until the next step would be a small part of the standard errors.
// Feet are searched for, and once more where they have been followed to the end. A draft stops early and only follows them.
void refine(Estimate& e, const Positions& points, const std::vector<double>& typical, double size, bool draft,
            const Progress& progress) {
  e.feet = feet_of(e.shape, points, {});
  if (!e.mixture.sigma_known) e.mixture.sigma = std::fmax(1.5 * median(sizes(e.feet.distance)), 1e-15 * size);
  e.mixture.window = 2 * size;
  e.mixture.outlier_share = 0.2;
  expect(e, size);
  bool searched = true;
  const int rounds = draft ? 3 : 20, steps = draft ? 8 : 30;
  for (int round = 0; round < rounds; ++round) {
    const Unknowns u = unknowns(e.shape, typical, size);
    BatchedCost cost(e.shape, points, e.feet.uv, e.weighted, u, size);
    bool follow = draft;
    if (!draft) {
      progress(static_cast<double>(round) / rounds);
      const double inliers = std::accumulate(e.weighted.weight.begin(), e.weighted.weight.end(), 0.0),
                   step = cost.first_step();
      if (step <= 1e-3 * e.mixture.sigma + 1e-14 * size * std::sqrt(inliers)) {
        e.converged = searched;
        if (searched) return;
        e.feet = feet_of(e.shape, points, {});
        expect(e, size);
        searched = true;
        continue;
      }
      follow = step <= 1e-2 * size * std::sqrt(inliers);
    }
    std::vector<double> x(static_cast<std::size_t>(u.units.size()), 0);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    problem.AddResidualBlock(&cost, nullptr, x.data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = steps;
    options.max_num_consecutive_invalid_steps = 10;
    options.function_tolerance = 1e-14;
    options.gradient_tolerance = 1e-16;
    options.parameter_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    e.iterations += static_cast<int>(summary.iterations.size());
    if (!summary.IsSolutionUsable()) return;
    const Eigen::VectorXd delta = Eigen::Map<Eigen::VectorXd>(x.data(), u.units.size());
    const std::optional<Shape> next = moved(e.shape, delta.cwiseProduct(u.units));
    if (!next) return;
    e.shape = *next;
    e.feet = feet_of(e.shape, points, follow ? e.feet.uv : std::vector<Vec2<double>>{});
    searched = !follow;
    expect(e, size);
  }
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

struct Principal {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;
  double size;       // rms distance from the centre
  double thickness;  // rms distance from the plane of the other two axes
  // Axes about which the spread is nearly that of a circle, so that the other two may lie anyhow.
  std::vector<int> round;
};

Principal principal(const Positions& points) {
  Principal result{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), 0, 0, {}};
  for (const Eigen::Vector3d& x : points) result.centre += x / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points)
    spread += (x - result.centre) * (x - result.centre).transpose() / static_cast<double>(points.size());
  result.size = std::sqrt(spread.trace());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  result.axes = solver.eigenvectors();
  // Not the root of the eigenvalue, whose rounding is that of the largest.
  for (const Eigen::Vector3d& x : points) {
    const double off = result.axes.col(0).dot(x - result.centre);
    result.thickness += off * off / static_cast<double>(points.size());
  }
  result.thickness = std::sqrt(result.thickness);
  for (const int axis : {0, 2})
    if (solver.eigenvalues()[2 - axis] > 0.7 * solver.eigenvalues()[1] &&
        0.7 * solver.eigenvalues()[2 - axis] < solver.eigenvalues()[1])
      result.round.push_back(axis);
  if (result.axes.determinant() < 0) result.axes.col(0) *= -1;
  return result;
}

struct Start {
  Shape shape;
  double score;
};

// Parts of the surface, with the parameters as they are and each of them halved or doubled, laid onto the points by their
// principal axes. Score: the 60 % quantile of the distances of a few points.
std::vector<Start> starts_of(const AnySurface& standard, const std::vector<bool>& lengths,
                             const Positions& points) {
  constexpr int grid = 17;
  constexpr double parts[7][2] = {{0, 1}, {0, 0.5}, {0.5, 1}, {0, 0.25}, {0.25, 0.5}, {0.5, 0.75}, {0.75, 1}};
  const Principal of_points = principal(points);
  const Positions some(
      points.begin(), points.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(points.size(), 60)));
  std::vector<AnySurface> variants{standard};
  const std::vector<ParameterValue> parameters = standard.parameters();
  if (parameters.size() <= 5)
    for (std::size_t k = 0; k < parameters.size(); ++k)
      for (const double factor : {0.5, 2.0}) {
        std::vector<double> values = values_of(standard);
        values[k] *= factor;
        if (!parameters[k].permitted.contains(values[k]) || values[k] == 0) continue;
        try {
          variants.push_back(standard.with(values));
        } catch (const ParameterError&) {  // parameters that do not go together
        }
      }
  std::vector<Start> result;
  for (const AnySurface& variant : variants) {
    struct Node {
      Eigen::Vector3d position, normal;
      double u, v;
    };
    std::vector<Node> nodes;
    for (int row = 0; row < grid; ++row)
      for (int column = 0; column < grid; ++column) {
        const double u = column / (grid - 1.0), v = row / (grid - 1.0);
        const Vec3<double> p = variant.jet(u, v).position, n = variant.frame(u, v).n;
        if (detail::finite(p))
          nodes.push_back({to_eigen(p), detail::finite(n) ? to_eigen(n) : Eigen::Vector3d::Zero(), u, v});
      }
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
        std::vector<Eigen::Matrix3d> turns = axis_rotations();
        const auto with_turns_about = [&](const Principal& about, bool of_the_points) {
          for (const int axis : about.round)
            for (const double angle : {std::numbers::pi / 6, std::numbers::pi / 3})
              for (const Eigen::Matrix3d& turn : axis_rotations()) {
                const Eigen::Matrix3d more =
                    Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
                turns.push_back(of_the_points ? Eigen::Matrix3d(more * turn) : Eigen::Matrix3d(turn * more));
              }
        };
        with_turns_about(of_points, true);
        if (of_points.round.empty()) with_turns_about(of_part, false);
        for (const Eigen::Matrix3d& turn : turns) {
          const Eigen::Matrix3d rotation = of_points.axes * turn * of_part.axes.transpose();
          std::vector<double> distance;
          for (const Eigen::Vector3d& x : some) {
            const Eigen::Vector3d q = of_part.centre + rotation.transpose() * (x - of_points.centre) / scale;
            const Node* nearest = &nodes.front();
            double least = infinity;
            for (const Node& node : nodes)
              if (const double d = (node.position - q).squaredNorm(); d < least) least = d, nearest = &node;
            const Eigen::Vector3d way = q - nearest->position;
            distance.push_back(nearest->normal.isZero()
                                   ? way.norm()
                                   : std::fabs(way.dot(nearest->normal)) + 0.1 * way.norm());
          }
          std::vector<double> values = values_of(variant);
          if (!lengths.empty())
            for (std::size_t k = 0; k < values.size(); ++k)
              if (lengths[k]) values[k] *= scale;
          Shape shape{variant.with(values)};
          shape.placement.linear() = rotation;
          shape.placement.translation() = of_points.centre - rotation * of_part.centre * scale;
          result.push_back({std::move(shape), scale * quantile(distance, 0.6)});
        }
      }
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Start& a, const Start& b) { return a.score < b.score; });
  return result;
}

bool is_flat(const AnySurface& surface) {
  Positions nodes;
  for (const double u : {0.0, 0.2, 0.45, 0.7, 0.9})
    for (const double v : {0.1, 0.3, 0.55, 0.8, 1.0}) nodes.push_back(to_eigen(surface.jet(u, v).position));
  const Principal of_nodes = principal(nodes);
  return !(of_nodes.thickness > 1e-9 * of_nodes.size);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// What the points tell of the unknowns at the estimate.
Compressed information(const Estimate& e, const Positions& points, const Unknowns& u, double size) {
  const DistanceRow row_of(e.shape, Eigen::VectorXd::Zero(u.units.size()), u, size);
  const Feeler feeler(e.shape);
  Normal normal(u.units.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const double w = e.weighted.weight[i]; w > 0)
      if (const Row row = row_of(feeler.follow(points[i], e.feet.uv[i]), points[i]); row.allFinite())
        normal.add(row, w, 0);
  normal.mirror();
  return Compressed(normal.h, unknown_below);
}

// What more the whole patch would tell than the points do, its name; empty where it is nothing: symmetries, and lengths that
// only bound the patch.
std::string not_told(const Shape& shape, const Compressed& told, const Unknowns& u, double size) {
  constexpr int grid = 17;
  constexpr double clearly = 1e-8;  // of the best known direction; far above unknown_below
  const Eigen::Index n = u.units.size();
  const DistanceRow row_of(shape, Eigen::VectorXd::Zero(n), u, size);
  Normal whole(n);
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      Projection f;
      f.uv = {column / (grid - 1.0), row / (grid - 1.0)};
      f.position = shape.surface.jet(f.uv.x, f.uv.y).position;
      f.normal = shape.surface.frame(f.uv.x, f.uv.y).n;
      if (const Row r = row_of(f, Eigen::Vector3d::Zero()); r.allFinite()) whole.add(r, 1, 0);
    }
  whole.mirror();
  const double most =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(whole.h, Eigen::EigenvaluesOnly).eigenvalues()[n - 1];
  for (Eigen::Index k = 0; k < n && !told.is_known(k); ++k) {
    const Eigen::VectorXd direction = told.directions().col(k);
    if (!(direction.dot(whole.h * direction) > clearly * most)) continue;
    Eigen::Index largest;
    direction.cwiseAbs().maxCoeff(&largest);
    return largest < 3 ? "direction"
           : largest < 6
               ? "place"
               : std::string(shape.surface.parameters()[static_cast<std::size_t>(largest - 6)].name);
  }
  return "";
}

// The sum of the directions that are not told, v v^T each.
Eigen::MatrixXd unknown_directions(const Compressed& told) {
  const Eigen::Index n = told.directions().rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n && !told.is_known(k); ++k)
    result += told.directions().col(k) * told.directions().col(k).transpose();
  return result;
}

// Covariance at this noise and standard errors, and what was held.
void add_covariance(const Estimate& e, const Compressed& told, const Unknowns& u, double noise, PointFit& fit,
                    std::string& held) {
  const Eigen::Index n = u.units.size();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    covariance +=
        noise * noise * told.variance(k) * told.directions().col(k) * told.directions().col(k).transpose();
  const Eigen::MatrixXd unknown = unknown_directions(told);
  fit.covariance = u.units.asDiagonal() * covariance * u.units.asDiagonal();
  const std::vector<ParameterValue> parameters = e.shape.surface.parameters();
  std::vector<std::string> alone, combined;
  for (Eigen::Index k = 6; k < n; ++k) {
    const std::string name(parameters[static_cast<std::size_t>(k - 6)].name);
    // The share of the parameter in directions that are not told.
    if (unknown(k, k) > 1 - 1e-6) {
      alone.push_back(name);
      fit.covariance.row(k).setZero();
      fit.covariance.col(k).setZero();
    } else if (unknown(k, k) > 1e-6) {
      combined.push_back(name);
    }
    fit.standard_errors.push_back({name, std::sqrt(std::fmax(fit.covariance(k, k), 0))});
  }
  if (!alone.empty()) held += "; " + joined(alone) + " not told by the points, held";
  if (!combined.empty()) held += "; of " + joined(combined) + " only combinations told by the points";
  const Eigen::Vector3d axis = e.shape.placement.linear().col(2), origin = e.shape.placement.translation();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
  const double turn = (across * fit.covariance.topLeftCorner<3, 3>() * across).trace();
  fit.standard_errors.push_back({"axis_deg", std::sqrt(std::fmax(turn, 0)) * 180 / std::numbers::pi});
  Eigen::Matrix<double, 3, 6> of_origin;
  of_origin << 0, origin.z(), -origin.y(), 1, 0, 0, -origin.z(), 0, origin.x(), 0, 1, 0, origin.y(),
      -origin.x(), 0, 0, 0, 1;
  const double move = (of_origin * fit.covariance.topLeftCorner<6, 6>() * of_origin.transpose()).trace();
  fit.standard_errors.push_back({"centre", std::sqrt(std::fmax(move, 0))});
}

// The patch's lengths that the points do not tell, and those that may grow together without changing the surface, made such
// that the patch just encloses the inliers in the coordinates that end. Parameters are multiplied, by exp(t d) along the
// unknown direction d of their logarithms, unless that moves the surface. Whether anything changed.
bool enclose(Estimate& e, const Compressed& told, const Positions& inliers,
             const std::vector<Vec2<double>>& feet, double size) {
  const auto count = static_cast<Eigen::Index>(values_of(e.shape.surface).size());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_parameters(
      unknown_directions(told).bottomRightCorner(count, count));
  Eigen::MatrixXd unknown = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; k < count; ++k)
    if (const Eigen::VectorXd v = of_parameters.eigenvectors().col(k);
        of_parameters.eigenvalues()[k] > 1 - 1e-6)
      unknown += v * v.transpose();
  // One parameter alone first, then the direction that is left if it is only one.
  std::vector<Eigen::VectorXd> ways;
  for (Eigen::Index k = 0; k < count; ++k)
    if (unknown(k, k) > 1 - 1e-6) {
      ways.push_back(Eigen::VectorXd::Unit(count, k));
      unknown.row(k).setZero();
      unknown.col(k).setZero();
    }
  if (const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> rest(unknown);
      rest.eigenvalues().sum() > 0.5 && rest.eigenvalues().sum() < 1.5)
    ways.push_back(rest.eigenvectors().col(count - 1));

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
  for (const Eigen::VectorXd& way : ways) {
    const auto along = [&](double t) -> std::optional<Shape> {
      std::vector<double> p = values_of(e.shape.surface);
      for (std::size_t k = 0; k < p.size(); ++k) p[k] *= std::exp(t * way[static_cast<Eigen::Index>(k)]);
      try {
        return Shape{e.shape.surface.with(p), e.shape.placement};
      } catch (const ParameterError&) {
        return std::nullopt;
      }
    };
    const auto feet_along = [&](double t) {
      std::vector<Projection> result;
      if (const std::optional<Shape> shape = along(t)) {
        const Feeler feeler(*shape);
        for (const Eigen::Vector3d& x : farthest) result.push_back(feeler.search(x));
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
    // How far the inliers lie beyond [0, 1], negative: within. Not a number where the surface moves.
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

// Why the surface that was found is not told by the points, going on after "the best ... found"; empty where it is.
std::string against(const Estimate& e, const PointFit& fit, const Compressed& told, const Unknowns& u,
                    const std::vector<bool>& lengths, double size) {
  const AnySurface& surface = e.shape.surface;
  const std::vector<ParameterValue> parameters = surface.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double length = std::fabs(parameters[k].value), deviation = fit.standard_errors[k].value;
    if (lengths.empty() || !lengths[k] || fit::may_be_zero(surface.info().name, parameters[k])) continue;
    const std::string name(parameters[k].name);
    if (length < 1e-3 * size) return "has the " + name + " of a line or a point: no fit";
    if (length > 1e3 * size || deviation > 0.5 * length)
      return "has a " + name + " that the points do not tell; points over a larger part of it help";
  }
  if (const std::string what = not_told(e.shape, told, u, size); !what.empty())
    return "is not determined: the points do not tell its " + what + "; points over a larger part of it help";
  return "";
}

// Whether a plane explains the inliers as well, by the criterion that decides between kinds.
bool plane_is_as_good(const Positions& inliers, double rms, double unknowns, double size) {
  const double n = static_cast<double>(inliers.size()), exact = 1e-12 * size,
               gained = std::fmax(principal(inliers).thickness, exact) / std::fmax(rms, exact);
  return 2 * n * std::log(gained) < (unknowns - 3) * std::log(n) + fit::margin;
}

void check(const PointCloud& points, const std::string& kind, const PointFitOptions& options,
           const AnySurface& standard) {
  if (!address(standard)) {
    std::vector<std::string> names;
    for (const AnySurface& surface : all_surfaces())
      if (address(surface)) names.emplace_back(surface.info().name);
    throw ParameterError(kind, "cannot be fitted to points, permitted are " + joined(names));
  }
  if (options.noise && !(*options.noise > 0 && *options.noise < infinity))
    throw ParameterError("noise", "is not positive and finite, permitted is 0 < noise < inf");
  if (options.guess && options.guess->surface.info().name != standard.info().name)
    throw ParameterError("guess", "is " + fit::with_article(options.guess->surface.info().name) +
                                      ", permitted is " + fit::with_article(kind));
  if (options.guess && !options.guess->placement.matrix().allFinite())
    throw ParameterError("guess", "has a placement that is not finite, permitted are finite ones");
  const auto fits = [&](std::size_t n) { return n == 0 || n == points.positions.size(); };
  if (!fits(points.normals.size()))
    throw MeshError("points", "have another number of normals than positions");
  if (!fits(points.uvs.size())) throw MeshError("points", "have another number of uvs than positions");
}

}  // namespace

PointFit fit_any_kind(const PointCloud& cloud, const std::string& kind, const PointFitOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const AnySurface standard = make_surface(SurfaceSpecification{kind, {}});
  check(cloud, kind, options, standard);
  PointFit fit;
  fit.is_inlier.assign(cloud.positions.size(), false);
  const fit::Scaled scaled = fit::scaled(cloud);
  const std::size_t count = scaled.index.size(), unknown_count = 6 + standard.parameters().size();
  const std::string a_kind = fit::with_article(kind);
  fit.ignored = cloud.positions.size() - scaled.finite;
  fit.outliers = scaled.finite;
  const auto done = [&](bool usable, std::string reason) {
    fit.usable = usable;
    fit.reason = std::move(reason);
    if (!usable) fit.surface.reset();
    if (options.progress) options.progress(1);
    fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return fit;
  };
  if (count < unknown_count + 3)
    return done(false, count == 1 ? "all points are at one place"
                                  : std::to_string(count) + (count < scaled.finite ? " different" : "") +
                                        " points, " + a_kind + " needs at least " +
                                        std::to_string(unknown_count + 3));
  const double size = scaled.scale;
  if (const std::string why = fit::unusual_size(size); !why.empty()) return done(false, why);
  fit.centre = scaled.centre;
  // Shuffled, so that the first ones are a fair sample. Those beyond so many times the size start nothing.
  constexpr double far = 20;
  std::mt19937_64 random(options.seed);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  Positions points, near;
  for (const std::size_t i : order) {
    const Eigen::Vector3d x = scaled.cloud.col(static_cast<Eigen::Index>(i));
    points.emplace_back(size * x);
    if (x.norm() < far) near.push_back(points.back());
  }
  const bool flat = is_flat(standard);
  if (fit::on_a_line(Eigen::Matrix3Xd::Map(near.front().data(), 3, static_cast<Eigen::Index>(near.size()))))
    return done(false, "all points lie on one line; points beside it help");
  if (!flat && principal(near).thickness <= 1e-12 * size)
    return done(false, "all points lie in one plane, " + a_kind + " needs points beside it");
  const auto first = [&](std::size_t n) {
    return Positions(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(std::min(near.size(), n)));
  };

  const std::vector<bool> lengths = lengths_of(standard);
  constexpr std::size_t draft_points = 200, trial_points = 2000, most_starts = 40, most_finalists = 3;
  std::vector<Start> starts = starts_of(standard, lengths, first(10000));
  if (starts.size() > most_starts) starts.erase(starts.begin() + most_starts, starts.end());
  if (options.guess) {
    Shape guess{options.guess->surface, options.guess->placement};
    guess.placement.pretranslate(-fit.centre);
    starts.insert(starts.begin(), {std::move(guess), 0});
  }
  if (starts.empty()) return done(false, "no start of " + a_kind + " is near the points");
  const auto begin = [&](const Shape& shape) {
    Estimate e{.shape = shape, .feet = {}, .weighted = {}, .mixture = {size, 0.2, 2 * size}};
    if (options.noise) {
      e.mixture.sigma = *options.noise;
      e.mixture.sigma_known = true;
    }
    return e;
  };
  std::vector<double> typical;
  {
    const std::vector<double> defaults = values_of(standard);
    const double share = lengths.empty()
                             ? 1
                             : values_of(starts.front().shape.surface)[static_cast<std::size_t>(
                                   std::find(lengths.begin(), lengths.end(), true) - lengths.begin())] /
                                   defaults[static_cast<std::size_t>(
                                       std::find(lengths.begin(), lengths.end(), true) - lengths.begin())];
    for (std::size_t k = 0; k < defaults.size(); ++k) {
      const double length = !lengths.empty() && lengths[k] ? std::fabs(share) : 1;
      typical.push_back(length * (defaults[k] == 0 ? 1 : std::fabs(defaults[k])));
    }
  }
  // Of the whole, from one share to another.
  const auto between = [&](double from, double to) {
    return [&options, from, to](double share) {
      if (options.progress) options.progress(from + share * (to - from));
    };
  };
  const Positions few = first(draft_points);
  std::vector<Estimate> estimates;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    Estimate e = begin(starts[k].shape);
    e.mixture.sigma_known = false;  // from afar
    refine(e, few, typical, size, true, {});
    fit.iterations += e.iterations;
    if (std::isfinite(e.log_likelihood)) estimates.push_back(std::move(e));
    between(0, 0.3)(static_cast<double>(k + 1) / static_cast<double>(starts.size()));
  }
  std::stable_sort(estimates.begin(), estimates.end(),
                   [](const Estimate& a, const Estimate& b) { return a.log_likelihood > b.log_likelihood; });
  const Positions trial = first(trial_points);
  std::optional<Estimate> best;
  for (std::size_t k = 0; k < std::min(estimates.size(), most_finalists); ++k) {
    Estimate e = begin(estimates[k].shape);
    const double from = 0.3 + 0.1 * static_cast<double>(k);
    refine(e, trial, typical, size, false, between(from, from + 0.1));
    fit.iterations += e.iterations;
    if (!best || std::pair(e.converged, e.log_likelihood) > std::pair(best->converged, best->log_likelihood))
      best = std::move(e);
    if (best->converged && best->mixture.sigma < 1e-3 * size) break;
  }
  if (!best) return done(false, "no start of " + a_kind + " leads anywhere");
  if (trial.size() < points.size()) {
    Estimate e = begin(best->shape);
    refine(e, points, typical, size, false, between(0.6, 1));
    fit.iterations += e.iterations;
    best = std::move(e);
  }

  double squares = 0;
  Positions inliers;
  std::vector<Vec2<double>> feet;
  for (std::size_t i = 0; i < count; ++i)
    if (best->weighted.weight[i] > 0.5) {
      fit.is_inlier[scaled.index[order[i]]] = true;
      inliers.push_back(points[i]);
      feet.push_back(best->feet.uv[i]);
      squares += best->feet.distance[i] * best->feet.distance[i];
    }
  for (const auto& [i, column] : scaled.others) fit.is_inlier[i] = fit.is_inlier[scaled.index[column]];
  fit.inliers = static_cast<std::size_t>(std::count(fit.is_inlier.begin(), fit.is_inlier.end(), true));
  fit.outliers = scaled.finite - fit.inliers;
  const auto n = static_cast<double>(inliers.size());
  fit.rms = inliers.empty() ? 0 : std::sqrt(squares / n);
  const std::string found = "the best " + kind + " found ";
  const auto unusable = [&](const std::string& reason) { return done(false, reason); };
  if (!flat && plane_is_as_good(inliers, fit.rms, static_cast<double>(unknown_count), size))
    return unusable(found + "is not told from a plane; points over a larger part of it or less noise help");
  if (!best->converged) return unusable("the fit of " + a_kind + " did not converge");
  if (inliers.size() < unknown_count || 2 * inliers.size() < count)
    return unusable("only " + std::to_string(inliers.size()) + " of " + std::to_string(count) +
                    " points lie on " + found.substr(0, found.size() - 1));
  if (const double share = fit.rms / principal(inliers).size; !(share <= 0.05))
    return unusable(found + "leaves distances of " + rounded(share, 2) + " of the points' size");

  Unknowns u = unknowns(best->shape, typical, size);
  Compressed told = information(*best, points, u, size);
  if (enclose(*best, told, inliers, feet, size)) {
    best->feet = feet_of(best->shape, points, {});
    u = unknowns(best->shape, typical, size);
    told = information(*best, points, u, size);
  }
  double numbers = 0;
  for (Eigen::Index k = 0; k < u.units.size(); ++k) numbers += told.is_known(k);
  // The inliers' residuals are smaller by what the unknowns took up.
  fit.sigma = options.noise ? *options.noise : best->mixture.sigma * std::sqrt(n / std::fmax(1, n - numbers));
  fit.candidates.push_back(
      {kind,
       -2 * best->log_likelihood + (numbers + (options.noise ? 1 : 2)) * std::log(static_cast<double>(count)),
       fit.rms});
  std::string held;
  add_covariance(*best, told, u, fit.sigma / size, fit, held);
  if (const std::string why = against(*best, fit, told, u, lengths, size); !why.empty())
    return unusable(found + why);
  fit.surface = PlacedSurface{best->shape.surface, best->shape.placement};
  fit.surface->placement.pretranslate(fit.centre);
  return done(true, a_kind + " within the noise" + held);
}

}  // namespace darboux
