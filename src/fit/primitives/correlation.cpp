#include "correlation.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include <Eigen/Geometry>

#include "fit/common/intervals.h"

namespace darboux::fit {
namespace {

constexpr std::ptrdiff_t largest_group = 16;
constexpr double least_correlation = 0.25, chance_of_groups = 1e-6, chance_of_polynomials = 1e-5;
constexpr std::size_t enough_points = 256;  // for polynomials
constexpr int highest_degree = 6;

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
  return chance_of_ratio(between / within, g - 1, g * (m - 1)) < chance_of_groups;
}

// A sum of squares that is split among orthonormal columns, one after the other.
class Regression {
 public:
  explicit Regression(Eigen::VectorXd errors) : left_(std::move(errors)), columns_(left_.size(), 0) {}

  void add(Eigen::VectorXd column) {
    const double length = column.norm();
    for (int twice = 0; twice < 2; ++twice) column -= columns_ * (columns_.transpose() * column).eval();
    const double own = column.norm();
    if (!(own > 1e-6 * length)) return;  // the columns before explain it
    column /= own;
    left_ -= column.dot(left_) * column;
    columns_.conservativeResize(Eigen::NoChange, columns_.cols() + 1);
    columns_.rightCols<1>() = column;
  }
  double rank() const { return static_cast<double>(columns_.cols()); }
  double squares() const { return left_.squaredNorm(); }

 private:
  Eigen::VectorXd left_;
  Eigen::MatrixXd columns_;
};

// Whether polynomials explain the errors, and derivatives by the surface's parameters do not.
bool polynomials_explain(const Eigen::VectorXd& errors, const Eigen::MatrixXd& derivatives,
                         const Eigen::Matrix3Xd& places) {
  const auto points = static_cast<double>(errors.size());
  Regression regression(errors);
  for (Eigen::Index k = 0; k < derivatives.cols(); ++k) regression.add(derivatives.col(k));
  const double before = regression.squares(), free_before = points - regression.rank();
  const Eigen::AlignedBox3d box(places.rowwise().minCoeff(), places.rowwise().maxCoeff());
  const double unit = std::max(0.5 * box.sizes().maxCoeff(), 1e-300);
  const Eigen::Array3Xd at = (places.colwise() - box.center()) / unit;
  for (int degree = 0; degree <= highest_degree; ++degree) {
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j)
        regression.add(at.row(0).pow(i) * at.row(1).pow(j) * at.row(2).pow(degree - i - j));
    const double left = regression.squares(), free = points - regression.rank(), taken = free_before - free;
    if (taken < 1) continue;
    if (free < 1) return false;
    // The share of the variance that is explained, as estimated without bias.
    if (!(left / free < (1 - least_correlation) * before / free_before)) continue;
    if (!(left > 0) ||
        chance_of_ratio((before - left) / taken / (left / free), taken, free) < chance_of_polynomials)
      return true;
  }
  return false;
}

// Whether each coordinate takes few values, as in a grid: points that mirror each other have one rounding,
// and their errors are not independent.
bool is_grid(const Eigen::Matrix3Xd& points) {
  const auto takes_few_values = [&](Eigen::Index axis) {
    std::vector<double> values(points.row(axis).begin(), points.row(axis).end());
    std::sort(values.begin(), values.end());
    return 2 * std::distance(values.begin(), std::unique(values.begin(), values.end())) < points.cols();
  };
  return takes_few_values(0) && takes_few_values(1) && takes_few_values(2);
}

}  // namespace

bool neighbours_are_alike(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                          const std::vector<bool>& is_inlier) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) order.push_back(i);
  const LocalModel model = fit.primitive->localise(fit.surface, fit.reference);
  // Places on the surface: the noise across it must not choose who is a neighbour.
  Eigen::Matrix3Xd feet;
  fit.primitive->distance.foot_points(cloud, model, feet);
  order_by_place(feet, order.begin(), order.end());
  std::vector<double> errors;
  for (const std::size_t i : order) errors.push_back(fit.error[i]);
  for (std::size_t size = 2; size <= largest_group; size *= 2)
    if (groups_differ(errors, size)) return true;
  std::vector<Eigen::Index> some;
  const std::size_t step = (order.size() + enough_points - 1) / enough_points;
  for (std::size_t i = 0; i < order.size(); i += step) some.push_back(static_cast<Eigen::Index>(order[i]));
  const Eigen::Matrix3Xd points = cloud(Eigen::all, some);
  if (is_grid(points)) return false;
  const auto all = Eigen::Map<const Eigen::VectorXd>(fit.error.data(), cloud.cols());
  Eigen::MatrixXd derivatives;
  fit.primitive->distance.jacobian(points, model, derivatives);
  return polynomials_explain(all(some), derivatives, feet(Eigen::all, some));
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
