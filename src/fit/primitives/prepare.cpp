#include "prepare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

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

// A shape about seven times as long as wide.
constexpr double narrow = 0.02;

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

// The principal axes of a point and its neighbours, the point first. If these are not flat, only those near
// one plane are used, so that outliers among them do not turn it.
class LocalPlane {
 public:
  void fit(const Matrix3Xd& points, bool outliers, std::mt19937_64& random) {
    set_axes(points);
    if (outliers && flatness > flat && points.cols() > fewest && find_nearest(points, random))
      set_axes(points(Eigen::all, nearest_));
  }

  Vector3d mean, normal;
  double flatness = 0;  // the least of the scatter's eigenvalues over the middle one
  double width = 0;     // the middle one over the largest: small if all lie along a line

 private:
  // A neighbourhood of 20 degrees of a curve, and more where it is wide.
  static constexpr double flat = 0.03;
  static constexpr Eigen::Index fewest = 6;  // with so few, none can be dropped
  // If half of the neighbours lie on the surface, all pairs fail once in 75 cases.
  static constexpr int tries = 15;

  void set_axes(const Matrix3Xd& points) {
    mean = points.rowwise().mean();
    const Matrix3Xd centred = points.colwise() - mean;
    const auto [values, vectors] = closed_form_symmetric_eigen(Matrix3d(centred * centred.transpose()));
    normal = vectors.col(0);
    flatness = values[0] / std::fmax(values[1], 1e-300);
    width = values[1] / std::fmax(values[2], 1e-300);
  }

  // Among planes through the point and pairs of others, finds the one whose nearest three fifths are closest.
  bool find_nearest(const Matrix3Xd& points, std::mt19937_64& random) {
    const Eigen::Index n = points.cols(), kept = std::max<Eigen::Index>(4, 3 * n / 5);
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < tries; ++k) {
      const auto other = [&] {
        return 1 + static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(n - 1));
      };
      const Vector3d to_a = points.col(other()) - points.col(0), to_b = points.col(other()) - points.col(0);
      const Vector3d across = to_a.cross(to_b).stableNormalized();
      if (across.isZero()) continue;
      distances_.clear();
      for (Eigen::Index j = 0; j < n; ++j)
        distances_.emplace_back(std::fabs(across.dot(points.col(j) - points.col(0))), j);
      std::nth_element(distances_.begin(), distances_.begin() + (kept - 1), distances_.end());
      const double reach = distances_[static_cast<std::size_t>(kept - 1)].first;
      if (!(reach < least)) continue;
      least = reach;
      nearest_.clear();
      for (Eigen::Index j = 0; j < kept; ++j)
        nearest_.push_back(distances_[static_cast<std::size_t>(j)].second);
    }
    return std::isfinite(least);
  }

  std::vector<std::pair<double, Eigen::Index>> distances_;
  std::vector<Eigen::Index> nearest_;
};

OrientedPoints with_estimated_normals(const Matrix3Xd& cloud, bool outliers, std::mt19937_64& random) {
  std::vector<Vec3<double>> chosen;
  for (const Eigen::Index i : evenly_chosen(cloud.cols(), tree_points, random))
    chosen.push_back(from_eigen(cloud.col(i)));
  const auto n = static_cast<Eigen::Index>(chosen.size());
  const Neighbours tree(chosen);
  const std::size_t fewest = std::clamp<std::size_t>(chosen.size() / 80, 6, 30),
                    most = std::max(fewest, chosen.size() / 4);
  std::vector<std::uint32_t> nearest;
  std::vector<double> squares;
  const Eigen::Index m = std::min(n, queries);
  OrientedPoints all{Matrix3Xd(3, m), Matrix3Xd(3, m)};
  std::vector<std::pair<double, Eigen::Index>> flatness;
  LocalPlane plane;
  for (Eigen::Index i = 0; i < m; ++i) {
    const Vec3<double>& at = chosen[static_cast<std::size_t>(i * n / m)];
    // More neighbours if all lie in one row of a grid.
    for (std::size_t count = fewest; count <= most; count *= 3) {
      nearest.resize(count);
      squares.resize(count);
      Matrix3Xd near(3, static_cast<Eigen::Index>(tree.nearest(at, nearest, squares)));
      for (Eigen::Index j = 0; j < near.cols(); ++j)
        near.col(j) = to_eigen(chosen[nearest[static_cast<std::size_t>(j)]]);
      plane.fit(near, outliers, random);
      if (plane.width > narrow) break;
    }
    // The mean has less noise; among few points it is off the surface.
    all.points.col(i) = fewest > 6 ? plane.mean : to_eigen(at);
    all.normals.col(i) = plane.normal;
    flatness.emplace_back(plane.flatness, i);
  }
  // With few points, none can be dropped.
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

OrientedPoints oriented_points(const Matrix3Xd& cloud, const Matrix3Xd& normals, bool outliers,
                               std::mt19937_64& random) {
  if (auto own = with_own_normals(cloud, normals, random)) return std::move(*own);
  return with_estimated_normals(cloud, outliers, random);
}

}  // namespace darboux::fit
