/// \file estimate_quality.h
/// How good error estimates are: what the tests of differentiate.h share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <iostream>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "roundoff.h"
#include "thinning.h"

namespace darboux::test {

constexpr double tau = 2 * std::numbers::pi;
template <int n>
using Order = std::integral_constant<int, n>;

inline constexpr int many_points = slow_build ? 100'000 : 1'000'000;  // few per million are bounded

struct OrderNames {
  template <class T>
  static std::string GetName(int) {
    return "order" + std::to_string(T::value);
  }
};

/// What the truth is computed in, from the same double parameters.
using Wide = long double;
constexpr Wide wide_tau = 2 * std::numbers::pi_v<Wide>;

/// Typed tests over the orders of central differences.
using EvenOrders = ::testing::Types<Order<2>, Order<4>, Order<6>, Order<8>>;

/// Of many estimates, how many are below half of the true error; estimate / error in the median and in the
/// 99th percentile.
class Quality {
 public:
  void add(double error, double estimate, double derivative) {
    // Written so that NaN counts.
    if (!(estimate >= error / 2)) ++below_half_;
    worst_ = std::fmax(worst_, error / estimate);
    ratio_.push_back(estimate / std::fmax(error, roundoff * std::fabs(derivative)));
  }
  double below_half_per_million() const { return 1e6 * below_half_ / static_cast<double>(ratio_.size()); }
  double percentile(double p) {
    const auto at =
        ratio_.begin() + static_cast<std::ptrdiff_t>(p / 100 * static_cast<double>(ratio_.size()));
    std::nth_element(ratio_.begin(), at, ratio_.end());
    return *at;
  }
  void print(const std::string& what) {
    std::cout << std::setw(14) << what << std::fixed << std::setprecision(1) << ": below half "
              << below_half_per_million() << " of 10^6, worst error/estimate " << worst_
              << ", estimate/error median " << percentile(50) << ", 99% " << percentile(99) << '\n';
  }
  std::size_t points() const { return ratio_.size(); }

 private:
  std::vector<double> ratio_;
  int below_half_ = 0;
  double worst_ = 0;
};

}  // namespace darboux::test
