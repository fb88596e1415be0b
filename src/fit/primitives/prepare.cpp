#include "prepare.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <darboux/vector.h>

#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "base/neighbours.h"

namespace darboux::fit {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr Eigen::Index tree_points = 3000, queries = 400;

std::optional<OrientedPoints> with_own_normals(const Matrix3Xd& cloud, const Matrix3Xd& normals,
                                               std::mt19937_64& random) {
  if (normals.cols() != cloud.cols()) return std::nullopt;
  const std::vector<Eigen::Index> chosen = evenly_chosen(cloud.cols(), queries, random);
  OrientedPoints own{cloud(Eigen::all, chosen), normals(Eigen::all, chosen)};
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < own.points.cols(); ++i) {
    const Vector3d n = own.normals.col(i).stableNormalized();
    if (!n.allFinite() || n.isZero()) continue;
    own.points.col(kept) = own.points.col(i);
    own.normals.col(kept++) = n;
  }
  own.points.conservativeResize(3, kept);
  own.normals.conservativeResize(3, kept);
  return kept > 0 ? std::optional(own) : std::nullopt;
}

OrientedPoints with_estimated_normals(const Matrix3Xd& cloud, std::mt19937_64& random) {
  std::vector<Vec3<double>> chosen;
  for (const Eigen::Index i : evenly_chosen(cloud.cols(), tree_points, random))
    chosen.push_back(from_eigen(cloud.col(i)));
  const auto n = static_cast<Eigen::Index>(chosen.size());
  const Neighbours tree(chosen);
  std::vector<std::uint32_t> nearest(std::clamp<std::size_t>(chosen.size() / 80, 6, 30));
  std::vector<double> squares(nearest.size());
  const Eigen::Index m = std::min(n, queries);
  OrientedPoints all{Matrix3Xd(3, m), Matrix3Xd(3, m)};
  std::vector<std::pair<double, Eigen::Index>> flatness;
  for (Eigen::Index i = 0; i < m; ++i) {
    const std::size_t found = tree.nearest(chosen[static_cast<std::size_t>(i * n / m)], nearest, squares);
    Vector3d mean = Vector3d::Zero();
    for (std::size_t j = 0; j < found; ++j) mean += to_eigen(chosen[nearest[j]]);
    mean /= static_cast<double>(found);
    Matrix3d scatter = Matrix3d::Zero();
    for (std::size_t j = 0; j < found; ++j) {
      const Vector3d q = to_eigen(chosen[nearest[j]]) - mean;
      scatter += q * q.transpose();
    }
    const auto [values, vectors] = closed_form_symmetric_eigen(scatter);
    // The mean has less noise; among few points it is off the surface.
    all.points.col(i) = nearest.size() > 6 ? mean : to_eigen(chosen[static_cast<std::size_t>(i * n / m)]);
    all.normals.col(i) = vectors.col(0);
    flatness.emplace_back(values[0] / std::fmax(values[1], 1e-300), i);
  }
  // Of few points none can be spared.
  const Eigen::Index kept = std::max<Eigen::Index>(2 * m / 3 + 1, 20);
  std::nth_element(flatness.begin(), flatness.begin() + std::min(kept, m - 1), flatness.end());
  OrientedPoints result{Matrix3Xd(3, std::min(kept, m)), Matrix3Xd(3, std::min(kept, m))};
  for (Eigen::Index i = 0; i < result.points.cols(); ++i) {
    result.points.col(i) = all.points.col(flatness[static_cast<std::size_t>(i)].second);
    result.normals.col(i) = all.normals.col(flatness[static_cast<std::size_t>(i)].second);
  }
  return result;
}

}  // namespace

OrientedPoints oriented_points(const Matrix3Xd& cloud, const Matrix3Xd& normals, std::mt19937_64& random) {
  if (auto own = with_own_normals(cloud, normals, random)) return std::move(*own);
  return with_estimated_normals(cloud, random);
}

}  // namespace darboux::fit
