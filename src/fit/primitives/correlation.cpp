#include "correlation.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Geometry>

#include "fit/common/intervals.h"

namespace darboux::fit {
namespace {

constexpr std::ptrdiff_t largest_group = 16;
constexpr double least_correlation = 0.25, chance = 1e-6;

// Orders numbers of points so that any 2, 4, ... consecutive ones from a multiple of that many on are
// neighbours: halves across the longest side of their box.
template <class Iterator>
void order_by_place(const Eigen::Matrix3Xd& places, Iterator begin, Iterator end) {
  const auto at = [&](std::size_t i) { return places.col(static_cast<Eigen::Index>(i)); };
  const std::ptrdiff_t count = end - begin;
  if (count <= 2) return;
  std::ptrdiff_t unit = 2;  // what halves are a multiple of
  while (unit < largest_group && 2 * unit < count) unit *= 2;
  Eigen::AlignedBox3d box;
  for (auto i = begin; i != end; ++i) box.extend(at(*i));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto middle = begin + (count / 2 + unit - 1) / unit * unit;
  std::nth_element(begin, middle, end,
                   [&](std::size_t a, std::size_t b) { return at(a)[axis] < at(b)[axis]; });
  order_by_place(places, begin, middle);
  order_by_place(places, middle, end);
}

// One-way analysis of variance of whole groups of consecutive errors.
bool groups_differ(const std::vector<double>& errors, std::size_t size) {
  const std::size_t groups = errors.size() / size;
  if (groups < 3) return false;
  double sum = 0, squares = 0, of_means = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    double in_group = 0;
    for (std::size_t i = g * size; i < (g + 1) * size; ++i)
      in_group += errors[i], squares += errors[i] * errors[i];
    sum += in_group;
    of_means += in_group * in_group / static_cast<double>(size);
  }
  const auto m = static_cast<double>(size), g = static_cast<double>(groups);
  const double between = (of_means - sum * sum / (g * m)) / (g - 1),
               within = (squares - of_means) / (g * (m - 1));
  if (!(within > 0)) return between > 0;
  if (!(between - within > least_correlation * (between + (m - 1) * within))) return false;
  return chance_of_ratio(between / within, g - 1, g * (m - 1)) < chance;
}

}  // namespace

bool neighbours_are_alike(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                          const std::vector<bool>& is_inlier) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) order.push_back(i);
  // Places on the surface: the noise across it must not choose who is a neighbour.
  Eigen::Matrix3Xd feet;
  fit.primitive->distance.foot_points(cloud, fit.primitive->localise(fit.surface, fit.reference), feet);
  order_by_place(feet, order.begin(), order.end());
  std::vector<double> errors;
  for (const std::size_t i : order) errors.push_back(fit.error[i]);
  for (std::size_t size = 2; size <= largest_group; size *= 2)
    if (groups_differ(errors, size)) return true;
  return false;
}

}  // namespace darboux::fit
