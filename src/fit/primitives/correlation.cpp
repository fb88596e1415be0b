#include "correlation.h"

#include <array>
#include <cstddef>
#include <utility>

#include "fit/common/lack_of_fit.h"

namespace darboux::fit {

bool neighbours_are_alike(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                          const std::vector<bool>& is_inlier) {
  std::vector<Eigen::Index> inliers;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) inliers.push_back(static_cast<Eigen::Index>(i));
  const Eigen::Matrix3Xd points = cloud(Eigen::all, inliers);
  const LocalModel model = fit.primitive->localise(fit.surface, fit.reference);
  Eigen::Matrix3Xd feet;
  fit.primitive->distance.foot_points(points, model, feet);
  const auto all = Eigen::Map<const Eigen::RowVectorXd>(fit.error.data(), cloud.cols());
  const auto derivatives = [&](const std::vector<Eigen::Index>& some) {
    Eigen::MatrixXd result;
    fit.primitive->distance.jacobian(points(Eigen::all, some), model, result);
    return result;
  };
  return neighbours_are_alike({all(inliers), points, std::move(feet), derivatives});
}

std::optional<double> distance_of_groups(const PrimitiveFit& fit, const std::vector<bool>& is_inlier) {
  constexpr double fewest = 50, two_groups = 1.5;
  double n = 0, sum = 0;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) n += 1, sum += fit.error[i];
  if (n < fewest) return std::nullopt;
  const double mean = sum / n;
  double squares = 0, fourth = 0;
  std::array<double, 2> of_side{}, count{};
  for (std::size_t i = 0; i < is_inlier.size(); ++i) {
    if (!is_inlier[i]) continue;
    const double d = fit.error[i] - mean;
    squares += d * d, fourth += d * d * d * d;
    of_side[d > 0] += d, count[d > 0] += 1;
  }
  if (!(n * fourth < two_groups * squares * squares)) return std::nullopt;
  return of_side[1] / count[1] - of_side[0] / count[0];
}

}  // namespace darboux::fit
