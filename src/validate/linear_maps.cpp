#include "linear_maps.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <darboux/frame.h>

#include "base/degrees.h"
#include "base/linear_algebra.h"
#include "base/text.h"

namespace darboux::diagnosis {
namespace {

// A description of a map's effect on positions. \param of_normals m maps normals, by the inverse transpose
std::string text_of_map(const Eigen::Matrix3d& m, Eigen::Index dimensions, bool of_normals) {
  const Eigen::Vector3d singular = singular_value_decomposition(m).values,
                        scale = singular / singular[dimensions - 1];
  const std::string mirrors = dimensions == 3 && m.determinant() < 0 ? " and mirrors" : "";
  if (scale[0] < 1.01) return ": by a map that turns" + mirrors;
  constexpr double along_axes = 0.01;
  Eigen::Array3d diagonal = m.diagonal().array().abs();
  if (dimensions == 3 &&
      (m - Eigen::Matrix3d(m.diagonal().asDiagonal())).norm() < along_axes * diagonal.minCoeff()) {
    if (of_normals) diagonal = diagonal.inverse();
    diagonal /= diagonal.minCoeff();
    return ": by a map that scales x : y : z as " + rounded(diagonal[0], 3) + " : " +
           rounded(diagonal[1], 3) + " : " + rounded(diagonal[2], 3) + mirrors;
  }
  return ": by a map that scales as " + rounded(scale[0], 3) +
         (dimensions == 3 ? " : " + rounded(scale[1], 3) : "") + " : 1" + mirrors;
}

}  // namespace

double angle_deg(const Vec3<double>& a, const Vec3<double>& b) {
  return degrees_per_radian * angle_between(a, b);
}

Eigen::MatrixXd span_of(const std::vector<Pair>& samples) {
  constexpr double flat = 1e-6;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Pair& s : samples) moments += to_eigen(s.stored) * to_eigen(s.stored).transpose();
  const auto [values, vectors] = symmetric_eigen(moments);
  if (values[0] > flat * values.sum()) return Eigen::Matrix3d::Identity();
  return vectors.rightCols<2>();
}

std::size_t different_off(const std::vector<Pair>& samples) {
  constexpr double same_deg = 1;
  std::vector<Vec3<double>> different;
  for (const Pair& s : samples) {
    if (different.size() == least_different) break;
    if (!s.within(angle_deg(s.stored, s.t)) &&
        std::none_of(different.begin(), different.end(),
                     [&](const Vec3<double>& d) { return angle_deg(d, s.stored) < same_deg; }))
      different.push_back(s.stored);
  }
  return different.size();
}

std::optional<std::string> linear_map_of(const std::vector<Pair>& samples, double limit, bool of_normals,
                                         double least_ratio) {
  const Eigen::MatrixXd span = span_of(samples);
  const Eigen::Index d = span.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * d, 3 * d);
  for (const Pair& s : samples) {
    const Eigen::VectorXd t = span.transpose() * to_eigen(s.stored);
    const Eigen::Vector3d to = to_eigen(s.t);
    Eigen::Matrix3d across;
    across << 0, -to.z(), to.y(), to.z(), 0, -to.x(), -to.y(), to.x(), 0;
    Eigen::MatrixXd by(3, 3 * d);  // of M's columns
    for (Eigen::Index k = 0; k < d; ++k) by.middleCols<3>(3 * k) = t[k] * across;
    sum += by.transpose() * by / static_cast<double>(samples.size());
  }
  const auto [least, maps] = symmetric_eigen(sum);
  // Collinear vectors do not determine M, nor do coplanar references. Where many different normals are off,
  // as those of roofs whose ridges are parallel, it is the one nearest to the identity.
  constexpr double identifiable = 1e-3;
  Eigen::VectorXd column = maps.col(0);
  if (!(least[1] > identifiable)) {
    if (!of_normals || different_off(samples) < least_different) return std::nullopt;
    const Eigen::VectorXd identity = span.reshaped();
    column.setZero();
    for (Eigen::Index k = 0; k < least.size() && least[k] <= identifiable; ++k)
      column += maps.col(k).dot(identity) * maps.col(k);
    column.normalize();
  }
  Eigen::Matrix3d m = Eigen::Map<const Eigen::MatrixXd>(column.data(), 3, d) * span.transpose();
  double along = 0;
  for (const Pair& s : samples) along += to_eigen(s.t).dot(m * to_eigen(s.stored));
  if (along < 0) m = -m;
  std::size_t within = 0;
  for (const Pair& s : samples)
    within += angle_deg(s.t, from_eigen(Eigen::Vector3d(m * to_eigen(s.stored)))) <= limit + s.rounding;
  if (static_cast<double>(within) < explains_most * static_cast<double>(samples.size())) return std::nullopt;
  const Eigen::Vector3d singular = singular_value_decomposition(m).values, scale = singular / singular[d - 1];
  if (!(scale[0] < 1e3 && scale[0] >= least_ratio)) return std::nullopt;
  return text_of_map(m, d, of_normals);
}

std::optional<std::string> rotation_of(const std::vector<Pair>& samples) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero(), moments = Eigen::Matrix3d::Zero();
  for (const Pair& s : samples) {
    sum += to_eigen(s.t) * to_eigen(s.stored).transpose();
    moments += to_eigen(s.stored) * to_eigen(s.stored).transpose();
  }
  constexpr double spans = 0.05;
  if (!(symmetric_eigen(moments).values[0] > spans * static_cast<double>(samples.size())))
    return std::nullopt;
  const auto [u, values, v] = singular_value_decomposition(sum);
  const Eigen::Matrix3d r = u * v.transpose();
  if (r.determinant() < 0) return std::nullopt;
  const double share =
      share_within(samples, [&](const Pair& s) { return from_eigen(r.transpose() * to_eigen(s.t)); });
  if (share < explains_most) return std::nullopt;
  return ": by a map that turns";
}

}  // namespace darboux::diagnosis
