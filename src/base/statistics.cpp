#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <darboux/error.h>
#include <darboux/statistics.h>

#include "base/student_t.h"
#include "base/text.h"

namespace darboux {
namespace {

// The smallest value that at least `rank` elements of the sample do not exceed; reorders the sample.
double value_of_rank(std::span<Counted> values, std::size_t rank) {
  // For many values, first select those with the right leading bits: the bit patterns of non-negative numbers
  // have the order of the numbers.
  constexpr std::size_t many = 20000, groups = 1 << 15;
  if (values.size() > many) {
    const auto group = [](const Counted& x) {
      return std::bit_cast<std::uint64_t>(x.value) >> 48 & (groups - 1);
    };
    std::vector<std::size_t> counts(groups, 0);
    for (const Counted& x : values) counts[group(x)] += x.count;
    std::size_t at = 0;
    for (; rank > counts[at]; ++at) rank -= counts[at];
    values = {values.begin(),
              std::partition(values.begin(), values.end(), [&](const Counted& x) { return group(x) == at; })};
  }
  // Quickselect: repeatedly keep the part that contains the rank.
  auto first = values.begin(), last = values.end();
  while (last - first > 1) {
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last,
                     [](const Counted& a, const Counted& b) { return a.value < b.value; });
    std::size_t below = 0;
    for (auto i = first; i != middle; ++i) below += i->count;
    if (rank <= below) {
      last = middle;
    } else {
      rank -= below;
      first = middle;
    }
  }
  return first->value;
}

}  // namespace

Statistics summarise(std::vector<double>& values) {
  if (values.empty()) return {};
  Statistics s;
  double sum = 0;
  for (const double x : values) {
    s.max = std::max(s.max, x);
    sum += x * x;
  }
  s.rms = std::sqrt(sum / static_cast<double>(values.size()));
  const std::size_t rank = (95 * values.size() + 99) / 100;  // ceil(0.95 n)
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank - 1), values.end());
  s.p95 = values[rank - 1];
  return s;
}

Statistics summarise(std::vector<Counted>& values) {
  Statistics s;
  double sum = 0;
  std::size_t count = 0;
  for (const Counted& x : values) {
    s.max = std::max(s.max, x.value);
    sum += x.count * x.value * x.value;
    count += x.count;
  }
  if (count == 0) return s;
  s.rms = std::sqrt(sum / static_cast<double>(count));
  s.p95 = value_of_rank(values, (95 * count + 99) / 100);  // ceil(0.95 n)
  return s;
}

Line fit_line(std::span<const double> x, std::span<const double> y) {
  const std::size_t n = x.size();
  if (y.size() != n)
    throw ParameterError("y", expected_got("one per x, " + std::to_string(n), std::to_string(y.size())));
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < n; ++i) mean_x += x[i], mean_y += y[i];
  mean_x /= static_cast<double>(n);
  mean_y /= static_cast<double>(n);
  double sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    sxx += (x[i] - mean_x) * (x[i] - mean_x);
    sxy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  const double slope = sxy / sxx, intercept = mean_y - slope * mean_x;
  if (n < 3) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {slope, intercept, -inf, inf};
  }
  double residual = 0;
  for (std::size_t i = 0; i < n; ++i) residual += std::pow(y[i] - intercept - slope * x[i], 2);
  const double half =
      student_t(0.975, static_cast<double>(n - 2)) * std::sqrt(residual / static_cast<double>(n - 2) / sxx);
  return {slope, intercept, slope - half, slope + half};
}

}  // namespace darboux
