#include "lack_of_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "intervals.h"

namespace darboux::fit {
namespace {

constexpr Eigen::Index largest_group = 16;
constexpr double least_correlation = 0.25, chance_of_groups = 1e-6, chance_of_polynomials = 1e-5;
constexpr std::size_t enough_points = 256;                        // for polynomials
constexpr int highest_degree = 6, highest_degree_of_vectors = 4;  // these have three times the columns

// The number of directions in which the errors scatter: 1 for distances, 3 for vectors with equal noise in
// all directions; in general the degrees of freedom of a sum of squares [Satterthwaite1946].
double directions(const Eigen::MatrixXd& errors) {
  const Eigen::MatrixXd spread = errors * errors.transpose();
  return std::pow(spread.trace(), 2) / spread.squaredNorm();
}

// Orders point numbers so that 2, 4, ... consecutive ones, starting at a multiple of their count, are
// neighbours: halves the points across the longest side of their box.
template <class Iterator>
void order_by_place(const Eigen::Matrix3Xd& places, Iterator begin, Iterator end) {
  const std::ptrdiff_t count = end - begin;
  if (count <= 2) return;
  std::ptrdiff_t unit = 2;  // halves are multiples of this
  while (unit < largest_group && 2 * unit < count) unit *= 2;
  Eigen::AlignedBox3d box;
  for (auto i = begin; i != end; ++i) box.extend(places.col(*i));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto middle = begin + (count / 2 + unit - 1) / unit * unit;
  std::nth_element(begin, middle, end,
                   [&](Eigen::Index a, Eigen::Index b) { return places(axis, a) < places(axis, b); });
  order_by_place(places, begin, middle);
  order_by_place(places, middle, end);
}

// One-way analysis of variance of whole groups of consecutive errors.
bool groups_differ(const Eigen::MatrixXd& errors, Eigen::Index size) {
  const Eigen::Index groups = errors.cols() / size;
  if (groups < 3) return false;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(errors.rows());
  double squares = 0, of_means = 0;
  for (Eigen::Index i = 0; i < groups; ++i) {
    const auto group = errors.middleCols(i * size, size);
    const Eigen::VectorXd in_group = group.rowwise().sum();
    squares += group.squaredNorm();
    sum += in_group;
    of_means += in_group.squaredNorm() / static_cast<double>(size);
  }
  const auto m = static_cast<double>(size), g = static_cast<double>(groups);
  const double each = directions(errors), of_groups = each * (g - 1), in_groups = each * g * (m - 1);
  const double between = (of_means - sum.squaredNorm() / (g * m)) / of_groups,
               within = (squares - of_means) / in_groups;
  if (!(within > 0)) return between > 0;
  if (!(between - within > least_correlation * (between + (m - 1) * within))) return false;
  return chance_of_ratio(between / within, of_groups, in_groups) < chance_of_groups;
}

// Splits a sum of squares among orthonormal columns, one after the other.
class Regression {
 public:
  explicit Regression(Eigen::VectorXd errors) : left_(std::move(errors)), columns_(left_.size(), 0) {}

  void add(Eigen::VectorXd column) {
    const double length = column.norm();
    for (int twice = 0; twice < 2; ++twice) column -= columns_ * (columns_.transpose() * column).eval();
    const double own = column.norm();
    if (!(own > 1e-6 * length)) return;  // earlier columns explain it
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

// Whether polynomials explain the errors, and derivatives with respect to the surface's parameters do not.
bool polynomials_explain(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& derivatives,
                         const Eigen::Matrix3Xd& places) {
  const auto count = static_cast<double>(errors.size());
  Regression regression(errors.reshaped());
  for (Eigen::Index k = 0; k < derivatives.cols(); ++k) regression.add(derivatives.col(k));
  const double before = regression.squares(), free_before = count - regression.rank();
  const Eigen::AlignedBox3d box(places.rowwise().minCoeff(), places.rowwise().maxCoeff());
  const double unit = std::max(0.5 * box.sizes().maxCoeff(), 1e-300);
  const Eigen::Array3Xd at = (places.colwise() - box.center()) / unit;
  const auto coordinates = static_cast<double>(errors.rows());
  const double independent = directions(errors) / coordinates;
  const int highest = coordinates > 1 ? highest_degree_of_vectors : highest_degree;
  for (int degree = 0; degree <= highest; ++degree) {
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j) {
        const Eigen::ArrayXd monomial = at.row(0).pow(i) * at.row(1).pow(j) * at.row(2).pow(degree - i - j);
        for (Eigen::Index row = 0; row < errors.rows(); ++row) {
          Eigen::MatrixXd column = Eigen::MatrixXd::Zero(errors.rows(), errors.cols());
          column.row(row) = monomial;
          regression.add(column.reshaped());
        }
      }
    const double left = regression.squares(), free = count - regression.rank(), taken = free_before - free;
    if (taken < 1) continue;
    if (free < 1) return false;
    // The explained share of the variance, estimated without bias.
    if (!(left / free < (1 - least_correlation) * before / free_before)) continue;
    if (!(left > 0) || chance_of_ratio((before - left) / taken / (left / free), independent * taken,
                                       independent * free) < chance_of_polynomials)
      return true;
  }
  return false;
}

// Whether each coordinate takes few values, as in a grid: mirror images have the same rounding, so their
// errors are not independent.
bool is_grid(const Eigen::Matrix3Xd& points) {
  const auto takes_few_values = [&](Eigen::Index axis) {
    std::vector<double> values(points.row(axis).begin(), points.row(axis).end());
    std::sort(values.begin(), values.end());
    return 2 * std::distance(values.begin(), std::unique(values.begin(), values.end())) < points.cols();
  };
  return takes_few_values(0) && takes_few_values(1) && takes_few_values(2);
}

}  // namespace

bool neighbours_are_alike(const Leftovers& leftovers) {
  const auto& [errors, points, places, derivatives] = leftovers;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(errors.cols()));
  std::iota(order.begin(), order.end(), 0);
  order_by_place(places, order.begin(), order.end());
  const Eigen::MatrixXd in_order = errors(Eigen::all, order);
  for (Eigen::Index size = 2; size <= largest_group; size *= 2)
    if (groups_differ(in_order, size)) return true;
  std::vector<Eigen::Index> some;
  const std::size_t step = (order.size() + enough_points - 1) / enough_points;
  for (std::size_t i = 0; i < order.size(); i += step) some.push_back(order[i]);
  if (is_grid(points(Eigen::all, some))) return false;
  return polynomials_explain(errors(Eigen::all, some), derivatives(some), places(Eigen::all, some));
}

}  // namespace darboux::fit
