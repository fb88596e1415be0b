#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include <darboux/error.h>
#include <darboux/local_jets.h>

#include "base/linear_algebra.h"
#include "base/neighbours.h"
#include "base/parallel.h"
#include "base/text.h"
#include "batch.h"
#include "uv_fit.h"

namespace darboux {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The result if the neighbours determine nothing.
LocalJet no_local_jet(Status why, double condition) {
  const Vec3<double> none = detail::nan_vector<double>();
  return {.position = none,
          .n = none,
          .curvature = {nan, nan, {nan, nan}, {none, none}, why},
          .normal_error = nan,
          .principal_error = {nan, nan},
          .direction_error = nan,
          .condition = condition,
          .residual_rms = nan,
          .status = why};
}
UvJet no_uv_jet(Status why, double condition) {
  const Vec3<double> none = detail::nan_vector<double>();
  return {
      {none, none, none, none, none, none}, {none, none, none, 1, why}, nan, nan, nan, nan, condition, nan};
}
constexpr Status non_finite = Status::no_frame | Status::non_finite_input;

// The side of n that the options ask for.
bool on_other_side(const Vec3<double>& n, const Vec3<double>& side) {
  const double d = dot(n, detail::scaled_by_power_of_two(side, -detail::scale_exponent(side)));
  if (d < 0 || d > 0) return d < 0;
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  return (x >= y && x >= z ? n.x : y >= z ? n.y : n.z) < 0;
}

template <int degree>
class LocalFit {
 public:
  LocalJet operator()(std::span<const Vec3<double>> neighbours, const Vec3<double>& at,
                      std::span<const double> weights, const Vec3<double>& side) {
    const auto n = static_cast<Eigen::Index>(neighbours.size());
    if (!detail::finite(at)) return no_local_jet(non_finite, infinite);
    double radius = 0;
    for (const Vec3<double>& p : neighbours) {
      const Vec3<double> d = p - at;
      if (!detail::finite(d)) return no_local_jet(non_finite, infinite);
      radius = std::fmax(radius, detail::largest_component(d));
    }
    if (!(radius > 0) || n < Fit::N) return no_local_jet(Status::no_frame, infinite);
    points_.resize(n, 3);
    for (Eigen::Index i = 0; i < n; ++i)
      points_.row(i) = to_eigen((neighbours[static_cast<std::size_t>(i)] - at) / radius);
    const double size = std::sqrt(points_.rowwise().squaredNorm().maxCoeff());
    points_ /= size;
    radius *= size;

    // The least-squares plane: the covariance is smallest across it.
    weights_.setOnes(n);
    if (!weights.empty()) weights_ = Eigen::Map<const Eigen::VectorXd>(weights.data(), n);
    weights_ /= weights_.maxCoeff();
    const Eigen::RowVector3d mean = weights_.transpose() * points_ / weights_.sum();
    Eigen::Matrix3d covariance;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j)
        covariance(i, j) = covariance(j, i) =
            (weights_.array() * (points_.col(i).array() - mean(i)) * (points_.col(j).array() - mean(j)))
                .sum();
    const Eigen::Vector3d up = closed_form_symmetric_eigen(covariance).vectors.col(0).normalized();
    Eigen::Index least = 0;
    up.cwiseAbs().minCoeff(&least);
    const Eigen::Vector3d e1 = up.cross(Eigen::Vector3d::Unit(least)).normalized(), e2 = up.cross(e1);

    auto* const given = fit_.resize(neighbours.size());
    for (Eigen::Index i = 0; i < n; ++i)
      given[i] = {weights.empty() ? 1 : std::sqrt(weights_(i)),
                  points_.row(i).dot(e1),
                  points_.row(i).dot(e2),
                  {points_.row(i).dot(up)}};
    fit_.solve(static_cast<double>(n), weights_.sum());
    if (!(fit_.condition() < Fit::worst_condition)) return no_local_jet(Status::no_frame, fit_.condition());

    double c[Fit::jet];
    for (int k = 0; k < Fit::jet; ++k) c[k] = fit_.coefficient(k, 0);
    const Vec3<double> z = from_eigen(up), x = from_eigen(e1), y = from_eigen(e2);
    const Jet2<double> jet{at + radius * c[0] * z, x + c[1] * z,      y + c[2] * z,
                           2 * c[3] / radius * z,  c[4] / radius * z, 2 * c[5] / radius * z};
    Frame<double> frame = frame_from_partials(jet.dpdu, jet.dpdv);
    if (on_other_side(frame.n, side)) frame = {frame.t, -frame.b, -frame.n, -1, frame.status};
    LocalJet result{.position = jet.position,
                    .n = frame.n,
                    .curvature = curvature(jet, frame),
                    .condition = fit_.condition(),
                    .residual_rms = radius * fit_.residual_rms()};

    // To first order, with the slope against the plane small: δn = -(δc1, δc2)/w, δκ = δII(d, d), and
    // the principal directions turn by δII(d1, d2)/(κ1 - κ2).
    const double w = std::sqrt(1 + c[1] * c[1] + c[2] * c[2]);
    const auto error = [&](const typename Fit::Functional& f) {
      constexpr double along[] = {1};
      return fit_.error(fit_.gain(f), along);
    };
    result.normal_error = std::sqrt(error({{0, 1, 0, 0, 0, 0}}) + error({{0, 0, 1, 0, 0, 0}})) / w;
    const auto second_form_error = [&](const Vec3<double>& p, const Vec3<double>& q) {
      const double px = dot(p, x), py = dot(p, y), qx = dot(q, x), qy = dot(q, y);
      return std::sqrt(error({{0, 0, 0, 2 * px * qx, px * qy + py * qx, 2 * py * qy}})) / (w * radius);
    };
    const auto& [d1, d2] = result.curvature.directions;
    result.principal_error[0] = second_form_error(d1, d1);
    result.principal_error[1] = second_form_error(d2, d2);
    result.direction_error =
        second_form_error(d1, d2) / (result.curvature.principal[0] - result.curvature.principal[1]);
    if (has(result.curvature.status, Status::umbilic)) result.direction_error = infinite;
    return result;
  }

 private:
  using Fit = LeastSquares<degree, 1, double>;
  Fit fit_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> points_;
  Eigen::VectorXd weights_;
};

template <int degree>
class OneUvFit {
 public:
  UvJet operator()(std::span<const Vec2<double>> uvs, std::span<const Vec3<double>> positions,
                   const Vec2<double>& at, std::span<const double> weights, bool u_periodic,
                   bool v_periodic) {
    const std::size_t n = positions.size();
    if (n < static_cast<std::size_t>(Fit::N)) return no_uv_jet(Status::no_frame, infinite);
    const double largest = weights.empty() ? 1 : *std::max_element(weights.begin(), weights.end());
    double total = weights.empty() ? static_cast<double>(n) : 0;
    auto* const given = fit_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3<double> p = positions[i] - positions[0];
      Vec2<double> d = uvs[i] - at;
      if (!detail::finite(p) || !std::isfinite(d.x) || !std::isfinite(d.y))
        return no_uv_jet(non_finite, infinite);
      if (u_periodic) d.x -= std::round(d.x);
      if (v_periodic) d.y -= std::round(d.y);
      given[i] = {1, d.x, d.y, {p.x, p.y, p.z}};
      if (weights.empty()) continue;
      given[i].root_of_weight = std::sqrt(weights[i] / largest);
      total += weights[i] / largest;
    }
    const UvFitResult<double> fitted = fit_.solve(static_cast<double>(n), total);
    if (!(fitted.sized > 0)) return no_uv_jet(Status::no_frame, infinite);
    if (!(fitted.condition < Fit::worst_condition)) return no_uv_jet(Status::no_frame, fitted.condition);
    UvJet result{fitted.jet,           fitted.frame,        fitted.dpdu_error, fitted.dpdv_error,
                 fitted.tangent_error, fitted.normal_error, fitted.condition,  fitted.residual_rms};
    result.jet.position = fitted.jet.position + positions[0];
    if (has(result.frame.status, Status::no_frame)) result.tangent_error = result.normal_error = nan;
    return result;
  }

 private:
  using Fit = typename UvFit<degree, double>::Fit;
  UvFit<degree, double> fit_;
};

// f(an integral constant of the degree).
template <class F>
auto with_degree(int degree, const F& f) {
  switch (degree) {
    case 2:
      return f(std::integral_constant<int, 2>());
    case 3:
      return f(std::integral_constant<int, 3>());
    case 4:
      return f(std::integral_constant<int, 4>());
    default:
      throw ParameterError("degree", expected_got("2 to 4", std::to_string(degree)));
  }
}

void check_weights(std::span<const double> weights, std::size_t n) {
  if (weights.empty()) return;
  if (weights.size() != n)
    throw ParameterError("weights",
                         expected_got("none or one for each of " + std::to_string(n) + " neighbours",
                                      std::to_string(weights.size())));
  for (const double w : weights)
    if (!(w > 0 && w < infinite)) throw_out_of_range("weights", "weight", w, Range::positive());
}

void check_length(std::size_t size, const char* attribute, const PointCloud& cloud) {
  if (size != 0 && size != cloud.positions.size())
    throw MeshError("points", expected_got("no " + std::string(attribute) + " or one per position, " +
                                               std::to_string(cloud.positions.size()),
                                           std::to_string(size)));
}

// Calls fit(some points, the indices of the `count` nearest neighbours of each, the results of all) for every
// point of a cloud; `make()` makes a fit, once per piece.
template <class Result, class Make>
std::vector<Result> at_every_point(const PointCloud& cloud, const CloudJetOptions& options,
                                   const Result& none, const Make& make) {
  check_length(cloud.normals.size(), "normals", cloud);
  check_length(cloud.uvs.size(), "uvs", cloud);
  if (options.threads < 0)
    throw ParameterError("threads", expected_got("0 (all) or more", std::to_string(options.threads)));
  const std::size_t least = jet_coefficients(options.degree),
                    wanted = options.neighbours == 0 ? 2 * jet_coefficients(options.degree + 1)
                                                     : options.neighbours;
  if (wanted < least)
    throw ParameterError("neighbours", expected_got(std::to_string(least) + " or more for degree " +
                                                        std::to_string(options.degree),
                                                    std::to_string(wanted)));
  const Neighbours tree(cloud.positions);
  const std::size_t k = std::min(wanted, tree.size());
  std::vector<Result> results(cloud.positions.size(), none);
  parallel_ranges(
      results.size(), thread_count(options.threads),
      [&](std::size_t begin, std::size_t end) {
        auto fit = make();
        std::vector<std::size_t> points;
        std::vector<std::uint32_t> near(k * jets_at_once);
        std::vector<double> squared(k);
        for (std::size_t i = begin; i < end; ++i) {
          if (detail::finite(cloud.positions[i])) {
            tree.nearest(cloud.positions[i], std::span(near).subspan(k * points.size(), k), squared);
            points.push_back(i);
          }
          if (points.size() < jets_at_once && i + 1 < end) continue;
          fit(points, near, k, results);
          points.clear();
        }
      },
      256);
  return results;
}

}  // namespace

LocalJet local_jet(std::span<const Vec3<double>> neighbours, const Vec3<double>& at,
                   const JetOptions& options) {
  check_weights(options.weights, neighbours.size());
  return with_degree(options.degree, [&](auto degree) {
    return LocalFit<degree>()(neighbours, at, options.weights, options.side);
  });
}

UvJet uv_jet(std::span<const Vec2<double>> uvs, std::span<const Vec3<double>> positions,
             const Vec2<double>& at, const JetOptions& options) {
  check_weights(options.weights, positions.size());
  if (uvs.size() != positions.size())
    throw ParameterError("uvs", expected_got("one per position, " + std::to_string(positions.size()),
                                             std::to_string(uvs.size())));
  return with_degree(options.degree, [&](auto degree) {
    return OneUvFit<degree>()(uvs, positions, at, options.weights, options.u_periodic, options.v_periodic);
  });
}

void uv_jets(std::span<const kernels::UvNeighbours> of, int degree, bool u_periodic, bool v_periodic,
             std::span<UvJet> results, InstructionSet set) {
  const kernels::UvJetTable* const table = kernels::find_uv_jets(set);
  with_degree(degree, [&](auto constant) {
    std::optional<OneUvFit<constant>> by_itself;
    std::vector<Vec2<double>> near_uvs;
    std::vector<Vec3<double>> near_positions;
    for (std::size_t first = 0; first < of.size(); first += jets_at_once) {
      const auto some = of.subspan(first, std::min(jets_at_once, of.size() - first));
      bool done[jets_at_once] = {};
      if (table)
        table->of_degree[constant - 2](
            {some.data(), some.size(), u_periodic, v_periodic, &results[first], done});
      for (std::size_t k = 0; k < some.size(); ++k) {
        if (done[k]) continue;
        if (!by_itself) by_itself.emplace();
        const auto& [uvs, positions, near, count, at] = some[k];
        near_uvs.clear(), near_positions.clear();
        for (const std::uint32_t i : std::span(near, count))
          near_uvs.push_back(uvs[i]), near_positions.push_back(positions[i]);
        results[first + k] = (*by_itself)(near_uvs, near_positions, at, {}, u_periodic, v_periodic);
      }
    }
  });
}

std::vector<LocalJet> local_jets(const PointCloud& cloud, const CloudJetOptions& options) {
  return with_degree(options.degree, [&](auto degree) {
    return at_every_point(cloud, options, no_local_jet(non_finite, infinite), [&] {
      return [&cloud, fit = LocalFit<degree>(), near = std::vector<Vec3<double>>()](
                 std::span<const std::size_t> points, std::span<const std::uint32_t> indices,
                 std::size_t count, std::span<LocalJet> results) mutable {
        for (std::size_t k = 0; k < points.size(); ++k) {
          near.clear();
          for (const std::uint32_t j : indices.subspan(k * count, count)) near.push_back(cloud.positions[j]);
          const std::size_t i = points[k];
          results[i] =
              fit(near, cloud.positions[i], {}, cloud.normals.empty() ? Vec3<double>{} : cloud.normals[i]);
        }
      };
    });
  });
}

std::vector<UvJet> uv_jets(const PointCloud& cloud, const CloudJetOptions& options) {
  if (cloud.uvs.empty() && !cloud.positions.empty())
    throw MeshError("points", expected_got("one uv per position", "none"));
  with_degree(options.degree, [](auto) {});
  return at_every_point(cloud, options, no_uv_jet(non_finite, infinite), [&] {
    return [&](std::span<const std::size_t> points, std::span<const std::uint32_t> indices, std::size_t count,
               std::span<UvJet> results) {
      std::vector<kernels::UvNeighbours> of;
      std::vector<UvJet> some(points.size());
      for (std::size_t k = 0; k < points.size(); ++k)
        of.push_back(
            {cloud.uvs.data(), cloud.positions.data(), &indices[k * count], count, cloud.uvs[points[k]]});
      uv_jets(of, options.degree, options.u_periodic, options.v_periodic, some);
      for (std::size_t k = 0; k < points.size(); ++k) results[points[k]] = some[k];
    };
  });
}

}  // namespace darboux
