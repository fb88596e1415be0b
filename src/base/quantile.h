// Order statistics of a list of values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace darboux {

// The k-th smallest, counted from 0.
inline double ranked(std::vector<double> values, std::size_t k) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(k);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The upper one if two are in the middle.
inline double median(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  return ranked(std::move(values), middle);
}

// Interpolates linearly between the two ranks next to share (n - 1): at 0.5 the mean of the two in the
// middle.
inline double quantile(std::vector<double> values, double share) {
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double low = ranked(values, below);
  if (static_cast<double>(below) == at) return low;
  return low + (at - static_cast<double>(below)) * (ranked(std::move(values), below + 1) - low);
}

}  // namespace darboux
