#include "normalised_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include <darboux/vector.h>

#include "base/quantile.h"
#include "base/text.h"
#include "kinds.h"

namespace darboux::fit {
namespace {

// The first of the points that lies where this one does, for each.
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

// By medians: no outlier moves it.
Eigen::Vector3d middle_of(const PointCloud& points, const std::vector<std::size_t>& finite) {
  Eigen::Vector3d middle;
  std::vector<double> values(finite.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < finite.size(); ++i) values[i] = to_eigen(points.positions[finite[i]])[axis];
    middle[axis] = median(values);
  }
  return middle;
}

// How many of the digits, counted from the one of 10^first down, a number needs, at most `most`; one more
// where it needs more. Products with powers of ten are off by some roundings of theirs.
int digits_needed(double x, int first, int least, int most) {
  for (int k = least; k <= most; ++k) {
    const double y = x * std::pow(10, k - 1 - first);
    if (std::fabs(y - std::rint(y)) <= 1e-4 + 0x1p-50 * std::fabs(y)) return k;
  }
  return most + 1;
}

// The greatest error that the last digit of the coordinates leaves. It is told by their values: floats, also
// where nine of their digits are written; three to eight decimals; four to eight significant digits. The
// coarsest counts. Multiples of 2^-12, and what has fewer digits, may as well be exact.
// \param limit coordinates beyond are outliers', and do not say how large the others are
double stored_error(const std::vector<Vec3<double>>& points, const std::vector<std::size_t>& used,
                    double limit) {
  constexpr int few_decimals = 2, few_digits = 3, most = 8;
  bool is_dyadic = true, is_float = true;
  int decimals = few_decimals, digits = few_digits;
  double largest = 0;
  for (const std::size_t i : used)
    for (const double x : {points[i].x, points[i].y, points[i].z}) {
      if (x == 0 || std::fabs(x) > limit) continue;
      largest = std::fmax(largest, std::fabs(x));
      constexpr double of_nine_digits = 5e-9;
      is_dyadic = is_dyadic && std::rint(0x1p12 * x) == 0x1p12 * x;
      is_float = is_float &&
                 std::fabs(x - static_cast<double>(static_cast<float>(x))) <= of_nine_digits * std::fabs(x);
      const int first = static_cast<int>(std::floor(std::log10(std::fabs(x))));
      if (decimals <= most) decimals = digits_needed(x, -1, decimals, most);
      if (digits <= most) digits = digits_needed(x, first, digits, most);
    }
  if (is_dyadic) return 0;
  double error = is_float ? 0x1p-24 * largest : 0;
  if (decimals > few_decimals && decimals <= most) error = std::fmax(error, 0.5 * std::pow(10, -decimals));
  if (digits > few_digits && digits <= most) {
    const int of_largest = digits - 1 - static_cast<int>(std::floor(std::log10(largest)));  // decimals
    // So many digits, not decimals, are also written of floats.
    const double of_float = digits == most && decimals > of_largest ? 0x1p-24 * largest : 0;
    error = std::fmax(error, of_float + 0.5 * std::pow(10, -of_largest));
  }
  return error;
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
  std::erase(distances, 0.0);  // more than half of the points may be one and the same
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
    const double limit = result.centre.cwiseAbs().maxCoeff() + 8 * size;
    result.rounding =
        std::fmax(result.rounding, 0.5 * stored_error(points.positions, result.index, limit) / result.scale);
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
