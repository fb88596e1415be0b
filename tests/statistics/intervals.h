// What a finite number of runs tells.
#pragma once

#include <cmath>
#include <limits>
#include <span>

#include <boost/math/distributions/binomial.hpp>

namespace darboux {

struct Estimate {
  double value, low, high;  // with its 95 % confidence interval
};

// The square root of the mean of `squares`; the interval from their scatter.
inline Estimate root_mean(std::span<const double> squares) {
  const auto n = static_cast<double>(squares.size());
  if (n < 2) return {std::numeric_limits<double>::quiet_NaN(), 0, std::numeric_limits<double>::infinity()};
  double sum = 0, scatter = 0;
  for (const double x : squares) sum += x;
  for (const double x : squares) scatter += (x - sum / n) * (x - sum / n);
  const double half = 1.96 * std::sqrt(scatter / (n - 1) / n);
  return {std::sqrt(sum / n), std::sqrt(std::max(0.0, sum / n - half)), std::sqrt(sum / n + half)};
}

// k of n, with the interval of Clopper and Pearson.
inline Estimate share(std::size_t k, std::size_t n) {
  if (n == 0) return {std::numeric_limits<double>::quiet_NaN(), 0, 1};
  using Binomial = boost::math::binomial_distribution<>;
  const auto of = static_cast<double>(n), hits = static_cast<double>(k);
  return {hits / of, Binomial::find_lower_bound_on_p(of, hits, 0.025),
          Binomial::find_upper_bound_on_p(of, hits, 0.025)};
}

}  // namespace darboux
