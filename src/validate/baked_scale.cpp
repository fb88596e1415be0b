#include "baked_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include <Eigen/Core>

#include "angles.h"
#include "base/degrees.h"
#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "consistent.h"
#include "mesh/frames/corner.h"

namespace darboux {
namespace {

constexpr std::size_t most_samples = 2000;
// A scale has five unknowns: so many pairs of a direction and a normal must tell the same one.
constexpr std::size_t least_pairs = 12;
constexpr double same_pair_deg = 5;
constexpr double explained = 0.9;        // share of the tangents that a scale changes
constexpr double least_ratio = 0.97;     // of the smallest to the largest scale: else there is none
constexpr double smallest_ratio = 0.05;  // a choice

// At a vertex where a dpdu leans from the plane of the normal: the average of its triangles' dpdu, the normal
// and the stored tangent, unit.
struct Leaning {
  Eigen::Vector3d d, n, t;
};

std::vector<Leaning> samples_of(const Mesh& mesh, std::span<const signed char> raw_sign,
                                const std::vector<bool>& has_area) {
  const auto for_each_corner = [&](auto f) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (raw_sign[t] == 0 || !has_area[t]) continue;
      const Vec3<double> d = direction_of_dpdu(mesh, mesh.triangles[t], raw_sign[t]);
      for (int k = 0; k < 3; ++k) f(mesh.triangles[t], k, raw_sign[t], d);
    }
  };
  std::vector<std::size_t> places;  // of signed_index()
  for_each_corner([&](const Triangle& triangle, int k, int sign, const Vec3<double>& d) {
    const std::uint32_t v = triangle[static_cast<std::size_t>(k)];
    if (leans(d, mesh.normals[v])) places.push_back(signed_index(v, sign));
  });
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  std::vector<std::size_t> chosen;
  for (const std::size_t i : evenly_chosen(places.size(), most_samples)) chosen.push_back(places[i]);
  std::vector<Vec3<double>> sum(chosen.size());
  for_each_corner([&](const Triangle& triangle, int k, int sign, const Vec3<double>& d) {
    const std::uint32_t v = triangle[static_cast<std::size_t>(k)];
    const auto at = std::lower_bound(chosen.begin(), chosen.end(), signed_index(v, sign));
    if (at == chosen.end() || *at != signed_index(v, sign)) return;
    // As averages weigh them: by the angle, with the projection made unit.
    const double length = norm(square_to(d, mesh.normals[v]));
    if (!(length > 1e-9 * norm(d))) return;
    const std::array<Vec3<double>, 3> p{mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                                        mesh.positions[triangle[2]]};
    sum[static_cast<std::size_t>(at - chosen.begin())] += (corner_angle(p, k) / length) * d;
  });
  std::vector<Leaning> samples;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Vec3<double>&n = mesh.normals[chosen[i] / 2], t = mesh.tangents[chosen[i] / 2].xyz();
    if (has_direction(sum[i]) && has_direction(n) && has_direction(t) && leans(sum[i], n))
      samples.push_back({to_eigen(unit(sum[i])), to_eigen(unit(n)), to_eigen(unit(t))});
  }
  return samples;
}

// The number of different pairs of d and n, up to least_pairs.
std::size_t different_pairs(const std::vector<Leaning>& samples) {
  static const double same = std::cos(same_pair_deg / degrees_per_radian);
  std::vector<const Leaning*> pairs;
  for (const Leaning& s : samples) {
    if (pairs.size() == least_pairs) break;
    const auto is_same = [&](const Leaning* p) {
      return std::fabs(p->d.dot(s.d)) > same && std::fabs(p->n.dot(s.n)) > same;
    };
    if (std::none_of(pairs.begin(), pairs.end(), is_same)) pairs.push_back(&s);
  }
  return pairs.size();
}

// The angle of the stored tangent from the average before the scale, transformed by it.
double error_deg(const Leaning& s, const Eigen::Matrix3d& g) {
  const Eigen::Vector3d gn = g * s.n, predicted = s.d - s.n.dot(s.d) / s.n.dot(gn) * gn;
  return degrees_per_radian * std::atan2(predicted.cross(s.t).norm(), predicted.dot(s.t));
}

std::size_t count_within(const std::vector<Leaning>& samples, const Eigen::Matrix3d& g, double limit_deg) {
  return static_cast<std::size_t>(std::count_if(
      samples.begin(), samples.end(), [&](const Leaning& s) { return error_deg(s, g) <= limit_deg; }));
}

// G of trace 3 by least squares; none that is positive definite and within the range of scales: the identity.
Eigen::Matrix3d metric_of(const std::vector<const Leaning*>& samples) {
  std::array<Eigen::Matrix3d, 5> basis;
  basis[0] = Eigen::Vector3d(1, -1, 0).asDiagonal();
  basis[1] = Eigen::Vector3d(1, 1, -2).asDiagonal();
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix3d& b = basis[static_cast<std::size_t>(k) + 2] = Eigen::Matrix3d::Zero();
    b(k, (k + 1) % 3) = b((k + 1) % 3, k) = 1;
  }
  const auto residual = [](const Leaning& s, const Eigen::Matrix3d& g) -> Eigen::Vector3d {
    const Eigen::Vector3d gn = g * s.n;
    return s.t.cross(s.n.dot(gn) * s.d - s.n.dot(s.d) * gn);
  };
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(5, 5);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(5);
  for (const Leaning* s : samples) {
    Eigen::Matrix<double, 3, 5> columns;
    for (int k = 0; k < 5; ++k) columns.col(k) = residual(*s, basis[static_cast<std::size_t>(k)]);
    a += columns.transpose() * columns;
    b -= columns.transpose() * residual(*s, Eigen::Matrix3d::Identity());
  }
  const Eigen::VectorXd x = solve_least_norm(a, b);
  Eigen::Matrix3d g = Eigen::Matrix3d::Identity();
  for (int k = 0; k < 5; ++k) g += x[k] * basis[static_cast<std::size_t>(k)];
  const Eigen::Vector3d values = symmetric_eigenvalues(g);
  return values[0] > smallest_ratio * smallest_ratio * values[2] ? g : Eigen::Matrix3d::Identity();
}

// The G within whose limit most tangents are: of three samples at random many times, then of those within.
Eigen::Matrix3d fitted_metric(const std::vector<Leaning>& samples, double limit_deg) {
  constexpr int trials = 100, refinements = 5;
  std::mt19937_64 random(1);
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  std::size_t within = count_within(samples, best, limit_deg);
  const auto keep_if_better = [&](const Eigen::Matrix3d& g) {
    if (const std::size_t count = count_within(samples, g, limit_deg); count > within)
      best = g, within = count;
  };
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<const Leaning*> three;
    for (int k = 0; k < 3; ++k) three.push_back(&samples[random() % samples.size()]);
    keep_if_better(metric_of(three));
  }
  for (int k = 0; k < refinements; ++k) {
    std::vector<const Leaning*> inliers;
    for (const Leaning& s : samples)
      if (error_deg(s, best) <= limit_deg) inliers.push_back(&s);
    keep_if_better(metric_of(inliers));
  }
  return best;
}

}  // namespace

std::optional<Mesh> before_baked_scale(const Mesh& mesh, std::span<const signed char> raw_sign,
                                       const std::vector<bool>& has_area, double max_angle_deg) {
  const std::vector<Leaning> samples = samples_of(mesh, raw_sign, has_area);
  if (different_pairs(samples) < least_pairs) return std::nullopt;
  const Eigen::Matrix3d g = fitted_metric(samples, max_angle_deg);
  const SymmetricEigen<3> eigen = symmetric_eigen(g);
  if (std::sqrt(eigen.values[0] / eigen.values[2]) > least_ratio) return std::nullopt;
  const auto beyond = [&](const Eigen::Matrix3d& m) {
    return static_cast<double>(samples.size() - count_within(samples, m, max_angle_deg));
  };
  if (beyond(g) > (1 - explained) * static_cast<double>(samples.size()) ||
      2 * beyond(g) > beyond(Eigen::Matrix3d::Identity()))
    return std::nullopt;
  const Eigen::Vector3d scale = eigen.values.cwiseSqrt();
  const Eigen::Matrix3d forth = eigen.vectors * scale.asDiagonal() * eigen.vectors.transpose(),
                        back = eigen.vectors * scale.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
  Mesh result = mesh;
  for (Vec3<double>& p : result.positions) p = from_eigen(back * to_eigen(p));
  for (Vec3<double>& n : result.normals) n = unit(from_eigen(forth * to_eigen(n)));
  for (Vec4<double>& t : result.tangents) {
    const Vec3<double> direction = unit(from_eigen(back * to_eigen(t.xyz())));
    t = {direction.x, direction.y, direction.z, t.w};
  }
  result.half_steps.position /= scale[0];
  for (double* step : {&result.half_steps.normal, &result.half_steps.tangent}) *step *= scale[2] / scale[0];
  return result;
}

}  // namespace darboux
