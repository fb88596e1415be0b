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

#include "parameter_jet.h"
#include "quantile.h"

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
  Eigen::Matrix3d m;
  m << 0, -omega.z(), omega.y(), omega.z(), 0, -omega.x(), -omega.y(), omega.x(), 0;
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

Projection foot(const Projector& projector, const Shape& shape, const Eigen::Vector3d& x,
                const Vec2<double>* start) {
  const Vec3<double> p = from_eigen(shape.placement.inverse() * x);
  return start ? projector(p, *start) : projector(p);
}

// The feet of all points, from those of a shape nearby, or searched for.
Feet feet_of(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts) {
  const Projector projector(shape.surface);
  Feet result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Projection f = foot(projector, shape, points[i], starts.empty() ? nullptr : &starts[i]);
    const Sample<double> s = shape.surface.sample(f.uv.x, f.uv.y);
    const ShapeOperator<double> form = shape_operator(s.jet, s.frame);
    result.uv.push_back(f.uv);
    result.distance.push_back(f.distance);
    result.curvature.push_back(std::isfinite(form.a + form.c) ? form.a + form.c : 0);
  }
  return result;
}

// Row of the derivatives of the distance: -n · (velocity of the foot's point), the foot's own way being orthogonal to n.
Eigen::VectorXd distance_row(const Shape& shape, const Projection& f, const Eigen::Vector3d& x,
                             const Eigen::VectorXd& delta, double size) {
  const Eigen::Vector3d place = shape.placement * to_eigen(f.position);
  Eigen::Vector3d n = shape.placement.linear() * to_eigen(f.normal);
  // Also right at borders and apexes; on the surface the direction is all rounding.
  if (!(std::fabs(f.distance) <= 1e-8 * size)) n = (x - place) / f.distance;
  const ParameterJet by = parameter_jet(shape.surface, f.uv);
  Eigen::VectorXd row(6 + by.count);
  row.head<3>() = -left_jacobian(delta.head<3>()).transpose() * (place - delta.segment<3>(3)).cross(n);
  row.segment<3>(3) = -n;
  const Eigen::Vector3d local = shape.placement.linear().transpose() * n;
  for (int k = 0; k < by.count; ++k)
    row[6 + k] = -local.dot(to_eigen(by.position[static_cast<std::size_t>(k)]));
  return row;
}

struct Normal {
  Eigen::MatrixXd h;  // J^T W J
  Eigen::VectorXd g;  // J^T W r
  double squares = 0;
  bool finite = true;
};

struct Weighted {
  std::vector<double> weight, bias;  // 0 <= weight; the mean distance that noise makes of none
};

Normal normal_equations(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts,
                        const Weighted& weighted, const Eigen::VectorXd& delta, const Unknowns& unknowns,
                        double size) {
  const Projector projector(shape.surface);
  const Eigen::Index n = delta.size();
  Normal result{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double w = weighted.weight[i];
    if (w == 0) continue;
    const Projection f = foot(projector, shape, points[i], &starts[i]);
    const Eigen::VectorXd row =
        distance_row(shape, f, points[i], delta, size).cwiseProduct(unknowns.units) / size;
    const double r = (f.distance - weighted.bias[i]) / size;
    if (!row.allFinite() || !std::isfinite(r)) {
      result.finite = false;
      return result;
    }
    result.h.selfadjointView<Eigen::Lower>().rankUpdate(row, w);
    result.g += w * r * row;
    result.squares += w * r * r;
  }
  result.h = result.h.selfadjointView<Eigen::Lower>();
  return result;
}

// What the points do not tell: directions along which no weighted distance changes. Their squared share of the best known
// direction is below this; rounding leaves some 1e-30, and a ratio of 1e-6 of standard deviations is still told.
constexpr double unknown_below = 1e-12;

// All points as one cost that Ceres sees as n + 1 residuals: with J^T W J = V D V^T they are D^(-1/2) V^T g, and what is left
// of the weighted sum of squares; directions without D are held.
class BatchedCost final : public ceres::CostFunction {
 public:
  BatchedCost(const Shape& shape, const Positions& points, const std::vector<Vec2<double>>& starts,
              const Weighted& weighted, const Unknowns& unknowns, double size)
      : shape_(shape),
        points_(points),
        starts_(starts),
        weighted_(weighted),
        unknowns_(unknowns),
        size_(size) {
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
    const Normal normal = normal_equations(*shape, points_, starts_, weighted_, delta, unknowns_, size_);
    if (!normal.finite) return false;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(normal.h);
    const double least = unknown_below * solver.eigenvalues()[n - 1];
    Eigen::Map<Eigen::VectorXd> r(residuals, n + 1);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(n + 1, n);
    r.setZero();
    for (Eigen::Index k = 0; k < n; ++k) {
      const double d = solver.eigenvalues()[k];
      if (!(d > least)) continue;
      r[k] = solver.eigenvectors().col(k).dot(normal.g) / std::sqrt(d);
      jacobian.row(k) = std::sqrt(d) * solver.eigenvectors().col(k).transpose();
    }
    r[n] = std::sqrt(std::fmax(0, normal.squares - r.head(n).squaredNorm()));
    if (jacobians && jacobians[0])
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], n + 1,
                                                                                         n) = jacobian;
    return true;
  }

 private:
  const Shape& shape_;
  const Positions& points_;
  const std::vector<Vec2<double>>& starts_;
  const Weighted& weighted_;
  const Unknowns& unknowns_;
  double size_;
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

// Ceres with the weights held, then new feet and weights, until neither changes. A draft stops early and follows the feet
// that it found first.
void refine(Estimate& e, const Positions& points, const std::vector<double>& typical, double size,
            bool draft) {
  e.feet = feet_of(e.shape, points, {});
  if (!e.mixture.sigma_known)
    e.mixture.sigma = std::fmax(1.5 * quantile(sizes(e.feet.distance), 0.5), 1e-15 * size);
  e.mixture.window = 2 * size;
  e.mixture.outlier_share = 0.2;
  expect(e, size);
  const int rounds = draft ? 3 : 20, steps = draft ? 8 : 30;
  for (int round = 0; round < rounds; ++round) {
    const Unknowns u = unknowns(e.shape, typical, size);
    std::vector<double> x(static_cast<std::size_t>(u.units.size()), 0);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    BatchedCost cost(e.shape, points, e.feet.uv, e.weighted, u, size);
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
    e.feet = feet_of(e.shape, points, draft ? e.feet.uv : std::vector<Vec2<double>>{});
    const double before = e.log_likelihood;
    expect(e, size);
    e.converged = summary.termination_type == ceres::CONVERGENCE &&
                  std::fabs(e.log_likelihood - before) <= 1e-6 * static_cast<double>(points.size());
    if (e.converged) return;
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
  double size;  // rms distance from the centre
  // Axes about which the spread is nearly that of a circle, so that the other two may lie anyhow.
  std::vector<int> round;
};

Principal principal(const Positions& points) {
  Principal result{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), 0, {}};
  for (const Eigen::Vector3d& x : points) result.centre += x / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points)
    spread += (x - result.centre) * (x - result.centre).transpose() / static_cast<double>(points.size());
  result.size = std::sqrt(spread.trace());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  result.axes = solver.eigenvectors();
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

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Covariance, standard errors and what was held, at the estimate.
void add_covariance(const Estimate& e, const Positions& points, const std::vector<double>& typical,
                    double size, PointFit& fit, std::size_t& told, std::string& held) {
  const Unknowns u = unknowns(e.shape, typical, size);
  const Eigen::Index n = u.units.size();
  const Normal normal =
      normal_equations(e.shape, points, e.feet.uv, e.weighted, Eigen::VectorXd::Zero(n), u, size);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(normal.h);
  const double least = unknown_below * solver.eigenvalues()[n - 1], sigma = e.mixture.sigma / size;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd unknown = Eigen::MatrixXd::Zero(n, n);
  told = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::VectorXd direction = solver.eigenvectors().col(k);
    if (solver.eigenvalues()[k] > least) {
      covariance += sigma * sigma / solver.eigenvalues()[k] * direction * direction.transpose();
      ++told;
    } else {
      unknown += direction * direction.transpose();
    }
  }
  fit.covariance = u.units.asDiagonal() * covariance * u.units.asDiagonal();
  const std::vector<ParameterValue> parameters = e.shape.surface.parameters();
  std::vector<std::string> alone, combined;
  for (Eigen::Index k = 6; k < n; ++k) {
    const std::string name(parameters[static_cast<std::size_t>(k - 6)].name);
    // The share of the parameter in directions that are not told.
    const bool is_alone = unknown(k, k) > 1 - 1e-6;
    if (is_alone) {
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
    throw ParameterError(
        "guess", "is a " + std::string(options.guess->surface.info().name) + ", permitted is a " + kind);
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
  std::vector<std::size_t> finite;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    if (detail::finite(cloud.positions[i])) {
      finite.push_back(i);
      box.extend(to_eigen(cloud.positions[i]));
    }
  fit.ignored = cloud.positions.size() - finite.size();
  const std::size_t unknown_count = 6 + standard.parameters().size();
  const auto done = [&](bool usable, std::string reason) {
    fit.usable = usable;
    fit.reason = std::move(reason);
    if (!usable) fit.surface.reset();
    fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return fit;
  };
  if (finite.size() < unknown_count + 3)
    return done(false, std::to_string(finite.size()) + " points, a " + kind + " needs at least " +
                           std::to_string(unknown_count + 3));
  fit.centre = box.center();
  // Shuffled, so that the first ones are a fair sample.
  std::mt19937_64 random(options.seed);
  std::vector<std::size_t> order = finite;
  std::shuffle(order.begin(), order.end(), random);
  Positions points;
  for (const std::size_t i : order) points.push_back(to_eigen(cloud.positions[i]) - fit.centre);
  const double size = principal(points).size;
  if (!(size > 0)) return done(false, "all points are at one place");

  const std::vector<bool> lengths = lengths_of(standard);
  std::vector<Start> starts = starts_of(standard, lengths, points);
  constexpr std::size_t sample_size = 200, most_starts = 40, most_finalists = 3;
  if (starts.size() > most_starts) starts.erase(starts.begin() + most_starts, starts.end());
  if (options.guess) {
    Shape guess{options.guess->surface, options.guess->placement};
    guess.placement.pretranslate(-fit.centre);
    starts.insert(starts.begin(), {std::move(guess), 0});
  }
  if (starts.empty()) return done(false, "no start of a " + kind + " is near the points");
  const Positions sample(points.begin(),
                         points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), sample_size)));
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
  std::vector<Estimate> estimates;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    Estimate e = begin(starts[k].shape);
    e.mixture.sigma_known = false;  // from afar
    refine(e, sample, typical, size, true);
    fit.iterations += e.iterations;
    if (std::isfinite(e.log_likelihood)) estimates.push_back(std::move(e));
    if (options.progress)
      options.progress(0.8 * static_cast<double>(k + 1) / static_cast<double>(starts.size()));
  }
  std::stable_sort(estimates.begin(), estimates.end(),
                   [](const Estimate& a, const Estimate& b) { return a.log_likelihood > b.log_likelihood; });
  std::optional<Estimate> best;
  for (std::size_t k = 0; k < std::min(estimates.size(), most_finalists); ++k) {
    Estimate e = begin(estimates[k].shape);
    refine(e, points, typical, size, false);
    fit.iterations += e.iterations;
    if (!best || std::pair(e.converged, e.log_likelihood) > std::pair(best->converged, best->log_likelihood))
      best = std::move(e);
    if (best->converged && best->mixture.sigma < 1e-3 * size) break;
  }
  if (options.progress) options.progress(1);
  if (!best) return done(false, "no start of a " + kind + " leads anywhere");

  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (best->weighted.weight[i] > 0.5) {
      fit.is_inlier[order[i]] = true;
      ++fit.inliers;
      squares += best->feet.distance[i] * best->feet.distance[i];
    }
  fit.outliers = points.size() - fit.inliers;
  fit.rms = fit.inliers > 0 ? std::sqrt(squares / static_cast<double>(fit.inliers)) : 0;
  std::size_t told = 0;
  std::string held;
  add_covariance(*best, points, typical, size, fit, told, held);
  // The inliers' residuals are smaller by what the unknowns took up.
  fit.sigma = options.noise
                  ? *options.noise
                  : best->mixture.sigma *
                        std::sqrt(static_cast<double>(fit.inliers) /
                                  std::fmax(1, static_cast<double>(fit.inliers) - static_cast<double>(told)));
  fit.candidates.push_back({kind,
                            -2 * best->log_likelihood + static_cast<double>(told + (options.noise ? 1 : 2)) *
                                                            std::log(static_cast<double>(points.size())),
                            fit.rms});
  fit.surface = PlacedSurface{best->shape.surface, best->shape.placement};
  fit.surface->placement.pretranslate(fit.centre);
  if (!best->converged) return done(false, "the fit of a " + kind + " did not converge" + held);
  if (fit.inliers < unknown_count || 2 * fit.inliers < points.size())
    return done(false, "only " + std::to_string(fit.inliers) + " of " + std::to_string(points.size()) +
                           " points lie on the best " + kind + " found" + held);
  if (!(fit.rms <= 0.05 * size))
    return done(false, "the best " + kind + " found leaves distances of " + std::to_string(fit.rms / size) +
                           " of the points' size" + held);
  return done(true, "a " + kind + " within the noise" + held);
}

}  // namespace darboux
