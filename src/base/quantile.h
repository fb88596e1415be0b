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

inline double median(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  return ranked(std::move(values), middle);
}

inline double quantile(std::vector<double> values, double share) {
  const auto k = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return ranked(std::move(values), k);
}

}  // namespace darboux
