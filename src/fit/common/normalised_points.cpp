#include "normalised_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>

#include <darboux/vector.h>

#include "base/quantile.h"
#include "base/text.h"
#include "kinds.h"

namespace darboux::fit {
namespace {

// For each point, the first point at the same place.
class Places {
 public:
  explicit Places(const std::vector<Vec3<double>>& points)
      : points_(points), table_(std::bit_ceil(2 * points.size() + 1), none) {}
  std::size_t first_at(std::size_t i) {
    const Vec3<double>& p = points_[i];
    std::uint64_t hash = 0;
    for (const double x : {p.x, p.y, p.z}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15;  // -0 is 0
      hash ^= hash >> 32;
    }
    for (std::size_t at = hash;; ++at) {
      std::size_t& entry = table_[at & (table_.size() - 1)];
      if (entry == none) return entry = i;
      if (points_[entry] == p) return entry;
    }
  }

 private:
  static constexpr std::size_t none = -1;
  const std::vector<Vec3<double>>& points_;
  std::vector<std::size_t> table_;  // at a point's hash or after
};

// The centre, by medians, so that no outlier moves it.
Eigen::Vector3d middle_of(const PointCloud& points, const std::vector<std::size_t>& finite) {
  Eigen::Vector3d middle;
  std::vector<double> values(finite.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < finite.size(); ++i) values[i] = to_eigen(points.positions[finite[i]])[axis];
    middle[axis] = median(values);
  }
  return middle;
}

// How many digits a number needs, counted down from that of 10^first: at most `most`, or most + 1 if it needs
// more or a double has no more. Products with powers of ten err by some roundings of the powers.
int digits_needed(double x, int first, int least, int most) {
  for (int k = least; k <= most; ++k) {
    const double y = x * std::pow(10, k - 1 - first), off = 0x1p-50 * std::fabs(y);
    if (off > 0.1) break;
    if (std::fabs(y - std::rint(y)) <= 1e-4 + off) return k;
  }
  return most + 1;
}

// The greatest error due to the last stored digit. The values show how they were stored: as floats, also if
// nine of their digits are written; with three to twelve decimals; with four to twelve significant digits,
// for floats up to eight. Multiples of 2^-12, and numbers with fewer digits, may just as well be exact.
class StoredDigits {
 public:
  // \param limit larger numbers belong to outliers, and do not show how large the others are
  explicit StoredDigits(double limit) : limit_(limit) {}

  void add(double x) {
    if (x == 0 || std::fabs(x) > limit_) return;
    largest_ = std::fmax(largest_, std::fabs(x));
    constexpr double of_nine_digits = 5e-9;
    is_dyadic_ = is_dyadic_ && std::rint(0x1p12 * x) == 0x1p12 * x;
    const auto as_float = static_cast<float>(x);
    is_float_ = is_float_ && std::fabs(x - static_cast<double>(as_float)) <= of_nine_digits * std::fabs(x);
    needs_last_bit_ = needs_last_bit_ || (std::bit_cast<std::uint32_t>(as_float) & 1) != 0;
    const int first = static_cast<int>(std::floor(std::log10(std::fabs(x))));
    if (decimals_ <= most) decimals_ = digits_needed(x, -1, decimals_, most);
    if (digits_ <= most) digits_ = digits_needed(x, first, digits_, most);
  }
  // The errors of floats, of decimals and of digits, if the values agree with these, in descending order; 0:
  // none.
  // \param decimals whether decimals and digits count
  std::array<double, 3> errors(bool decimals = true) const {
    std::array<double, 3> result{};
    if (is_dyadic_) return result;
    const double of_floats = 0x1p-24 * largest_;
    if (is_float_) result[0] = of_floats;
    const int last = last_told();
    if (decimals && decimals_ > few_decimals && decimals_ <= last) result[1] = 0.5 * std::pow(10, -decimals_);
    if (decimals && digits_ > few_digits && digits_ <= last) {
      const int of_largest = digits_ - 1 - static_cast<int>(std::floor(std::log10(largest_)));  // decimals
      // Floats, too, may be written with this many digits (not decimals).
      result[2] = (digits_ == most_of_floats && decimals_ > of_largest ? of_floats : 0) +
                  0.5 * std::pow(10, -of_largest);
    }
    std::sort(result.rbegin(), result.rend());
    return result;
  }
  // Floats, not only numbers of fewer bits: the probability that none of n floats needs the last bit is 2^-n.
  bool are_floats() const { return is_float_ && needs_last_bit_; }
  // The decimals of the numbers. 0 if there are more than anyone writes on purpose, or if a number of digits
  // describes them better, so that small numbers have more decimals.
  int decimals() const {
    const bool are_digits = digits_ <= most && decimals_ > digits_ - std::floor(std::log10(largest_));
    return decimals_ <= last_told() && !are_digits ? decimals_ : 0;
  }

 private:
  static constexpr int few_decimals = 2, few_digits = 3, most_of_floats = 8, most = 12;
  int last_told() const { return is_float_ ? most_of_floats : most; }

  double limit_, largest_ = 0;
  bool is_dyadic_ = true, is_float_ = true, needs_last_bit_ = false;
  int decimals_ = few_decimals, digits_ = few_digits;
};

// Whether all are multiples of more than one unit of the last decimal, such as 0.025 and 0.075 with unit
// 0.001: these are exact values of a grid.
bool is_lattice(const std::vector<Vec2<double>>& uvs, int decimals) {
  if (decimals == 0) return false;
  std::int64_t common = 0;
  const double units = std::pow(10, decimals);
  for (const Vec2<double>& uv : uvs)
    for (const double x : {uv.x, uv.y})
      if (std::fabs(x) * units < 0x1p53) common = std::gcd(common, std::llrint(x * units));
  return common > 1;
}

// The step to which the coordinates are rounded, if half of the points are within two steps of a plane
// perpendicular to an axis; else 0. The step may have any size, such as fractions of inches or powers of two.
// It is found from the level next to the middle one: all coordinates, of all axes, must be whole steps apart.
// A step of more than a hundredth of the size may belong to the shape. For points on one level the step
// cannot be found, nor that they are rounded.
double step_of_levels(const std::vector<Vec3<double>>& positions, const std::vector<std::size_t>& index,
                      double size) {
  constexpr double largest = 0.01, levels = 2.5, off = 0.01;  // of the size; of a step
  std::vector<double> values(index.size());
  const auto take = [&](int axis) {
    for (std::size_t i = 0; i < index.size(); ++i) values[i] = to_eigen(positions[index[i]])[axis];
  };
  // Each value refines the step for the next ones, as floats near each other determine it badly.
  const auto are_steps = [&](double& step) {
    std::sort(values.begin(), values.end());
    return std::all_of(values.begin(), values.end(), [&](double x) {
      const double from_first = x - values.front(), steps = std::rint(from_first / step);
      if (std::fabs(from_first / step - steps) > off) return false;
      if (steps > 0) step = from_first / steps;
      return true;
    });
  };
  double found = 0;
  for (int axis = 0; axis < 3; ++axis) {
    take(axis);
    const double middle = median(values);
    double step = largest * size;
    for (const double x : values)
      if (const double d = std::fabs(x - middle); d > 1e-9 * size) step = std::fmin(step, d);
    const auto near = std::count_if(values.begin(), values.end(),
                                    [&](double x) { return std::fabs(x - middle) < levels * step; });
    if (2 * near > std::ssize(values) && step < largest * size && are_steps(step))
      found = std::fmax(found, step);
  }
  if (found == 0) return 0;
  for (int axis = 0; axis < 3; ++axis) {
    take(axis);
    if (!are_steps(found)) return 0;
  }
  return found;
}

// The greatest common divisor of all coordinates in this unit; 0 if some are no multiples of it.
std::int64_t common_multiple(const PointCloud& points, const std::vector<std::size_t>& index, double unit) {
  constexpr double largest = 1e9, off = 1e-6;
  std::int64_t result = 0;
  for (const std::size_t i : index)
    for (const double x : {points.positions[i].x, points.positions[i].y, points.positions[i].z}) {
      const double multiple = std::rint(x / unit);
      if (!(std::fabs(multiple) <= largest) || std::fabs(x / unit - multiple) > off) return 0;
      result = std::gcd(result, static_cast<std::int64_t>(multiple));
    }
  return result;
}

// NormalisedPoints::common_step, in the unit of the points: of multiples of 0.01 or of 2^-12.
double common_step_of(const PointCloud& points, const std::vector<std::size_t>& index, double size) {
  constexpr double least = 1e-3;
  for (const double unit : {0.01, 0x1p-12})
    if (const double step = unit * static_cast<double>(common_multiple(points, index, unit));
        step >= least * size)
      return step;
  return 0;
}

double median_size(const std::vector<Vec2<double>>& uvs) {
  std::vector<double> sizes;
  for (const Vec2<double>& uv : uvs) sizes.push_back(std::fmax(std::fabs(uv.x), std::fabs(uv.y)));
  return median(std::move(sizes));
}

}  // namespace

NormalisedPoints normalised(const PointCloud& points, bool with_uv) {
  NormalisedPoints result;
  std::vector<std::size_t> finite;
  for (std::size_t i = 0; i < points.positions.size(); ++i)
    if (detail::finite(points.positions[i]) && (!with_uv || usable_uv(points.uvs[i]))) finite.push_back(i);
  const std::size_t n = result.finite = finite.size();
  if (n == 0) return result;
  result.centre = middle_of(points, finite);
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i)
    values[i] = (to_eigen(points.positions[finite[i]]) - result.centre).stableNorm();
  std::vector<double> distances = values;
  std::erase(distances, 0.0);  // more than half of the points may coincide
  const double size = distances.empty() ? 0 : median(std::move(distances));
  result.scale = size == 0 ? 0 : with_uv ? 2 * size : std::exp2(std::rint(std::log2(size)));
  Places places(points.positions);
  std::vector<std::size_t> column(points.positions.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (!(values[i] <= 1e6 * size)) continue;
    const std::size_t first = with_uv ? finite[i] : places.first_at(finite[i]);
    if (first == finite[i]) {
      column[first] = result.index.size();
      result.index.push_back(first);
    } else {
      result.repeated.emplace_back(finite[i], column[first]);
    }
  }
  const auto columns = static_cast<Eigen::Index>(result.index.size());
  result.cloud.resize(3, columns);
  if (!points.normals.empty()) result.normals.resize(3, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    const std::size_t i = result.index[static_cast<std::size_t>(c)];
    result.cloud.col(c) = to_eigen(points.positions[i]) - result.centre;
    if (!points.normals.empty()) result.normals.col(c) = to_eigen(points.normals[i]);
    if (with_uv) result.uvs.push_back(points.uvs[i]);
  }
  if (result.scale > 0) {
    result.cloud /= result.scale;
    StoredDigits of_positions(result.centre.cwiseAbs().maxCoeff() + 8 * size);
    for (const std::size_t i : result.index)
      for (const double x : {points.positions[i].x, points.positions[i].y, points.positions[i].z})
        of_positions.add(x);
    for (std::size_t k = 0; k < 3; ++k) result.roundings[k] = 0.5 * of_positions.errors()[k] / result.scale;
    result.rounding = std::fmax(result.rounding, result.roundings.front());
    result.are_floats = of_positions.are_floats();
    result.half_step = 0.5 * step_of_levels(points.positions, result.index, size) / result.scale;
    result.rounding = std::fmax(result.rounding, 0.5 * result.half_step);
    result.common_step = common_step_of(points, result.index, size) / result.scale;
  }
  if (with_uv && !result.uvs.empty()) {
    StoredDigits of_uvs(8 * (1 + median_size(result.uvs)));
    for (const Vec2<double>& uv : result.uvs) of_uvs.add(uv.x), of_uvs.add(uv.y);
    result.uv_roundings = of_uvs.errors(!is_lattice(result.uvs, of_uvs.decimals()));
    for (double& rounding : result.uv_roundings) rounding *= 0.5;
  }
  return result;
}

NormalisedPoints NormalisedPoints::part(const std::vector<Eigen::Index>& columns) const {
  NormalisedPoints result;
  result.cloud = cloud(Eigen::all, columns);
  for (const Eigen::Index c : columns)
    if (!uvs.empty()) result.uvs.push_back(uvs[static_cast<std::size_t>(c)]);
  result.centre = centre;
  result.scale = scale;
  result.rounding = rounding;
  result.roundings = roundings;
  result.uv_roundings = uv_roundings;
  result.are_floats = are_floats;
  result.half_step = half_step;
  return result;
}

NormalisedPoints NormalisedPoints::chosen(std::size_t most, std::uint64_t seed) const {
  if (count() <= most) return *this;
  std::vector<Eigen::Index> columns;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t i = 0; i < most; ++i) {
    const double share = (static_cast<double>(i) + uniform(random)) / static_cast<double>(most);
    columns.push_back(
        std::min(cloud.cols() - 1, static_cast<Eigen::Index>(share * static_cast<double>(count()))));
  }
  return part(columns);
}

void NormalisedPoints::spread(const std::vector<bool>& columns, std::vector<bool>& input) const {
  for (std::size_t i = 0; i < columns.size(); ++i) input[index[i]] = columns[i];
  for (const auto& [i, column] : repeated) input[i] = columns[column];
}

std::string against_points(const NormalisedPoints& points, std::size_t fewest, std::string_view kind) {
  const std::size_t count = points.index.size();
  if (points.finite == 0) return "no point is finite";
  if (count == 1 && count < fewest) return "all points are at one place";
  if (count < fewest)
    return "underdetermined: " + std::to_string(count) + (count < points.finite ? " different" : "") +
           " points, " + with_article(kind) + " needs at least " + std::to_string(fewest);
  if (!(points.scale >= 1e-152 && points.scale <= 1e152))
    return "the points are of size " + rounded(points.scale, 3) +
           ", expected 1e-152 to 1e152, whose squares are numbers; other units help";
  if (on_a_line(points.cloud)) return "all points lie on one line; points beside it help";
  return {};
}

bool on_a_line(const Eigen::Matrix3Xd& cloud) {
  const Eigen::Matrix3Xd from_first = cloud.colwise() - cloud.col(0).eval();
  Eigen::Index farthest;
  const double length = from_first.colwise().norm().maxCoeff(&farthest);
  const Eigen::Vector3d along = from_first.col(farthest) / length;
  return (from_first - along * (along.transpose() * from_first)).colwise().norm().maxCoeff() < 1e-14 * length;
}

}  // namespace darboux::fit
