#include "principal.h"

#include <cmath>

#include <Eigen/LU>

#include "base/linear_algebra.h"

namespace darboux::fit::catalogue {

Principal principal(const std::vector<Eigen::Vector3d>& points) {
  Principal result{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), 0, 0, {}};
  for (const Eigen::Vector3d& x : points) result.centre += x / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points)
    spread += (x - result.centre) * (x - result.centre).transpose() / static_cast<double>(points.size());
  result.size = std::sqrt(spread.trace());
  const auto [values, vectors] = symmetric_eigen(spread);
  result.axes = vectors;
  // Not the root of the eigenvalue, which has the rounding error of the largest one.
  for (const Eigen::Vector3d& x : points) {
    const double off = result.axes.col(0).dot(x - result.centre);
    result.thickness += off * off / static_cast<double>(points.size());
  }
  result.thickness = std::sqrt(result.thickness);
  for (const int axis : {0, 2})
    if (values[2 - axis] > 0.7 * values[1] && 0.7 * values[2 - axis] < values[1])
      result.round.push_back(axis);
  if (result.axes.determinant() < 0) result.axes.col(0) *= -1;
  return result;
}

}  // namespace darboux::fit::catalogue
