/// \file statistics.h
/// Summaries of samples, and straight lines through them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace darboux {

/// Largest, root mean square and 95th percentile (nearest rank) of a sample; zeros for an empty one.
struct Statistics {
  double max = 0, rms = 0, p95 = 0;
};
/// Reorders `values`.
Statistics summarise(std::vector<double>& values);

/// A value that stands for `count` equal ones.
struct Counted {
  double value;
  std::uint32_t count;
};
/// The same for counted values, also in linear time.
Statistics summarise(std::vector<Counted>& values);

/// Maximum and rms of standard deviations. An infinite one makes the maximum infinite and is counted; the rms
/// covers the others.
class Spread {
 public:
  void add(double deviation, std::size_t times = 1) {
    max_ = std::max(max_, deviation);
    if (!std::isfinite(deviation)) {
      infinite_ += times;
      return;
    }
    sum_of_squares_ += static_cast<double>(times) * deviation * deviation;
    finite_ += times;
  }
  double max() const { return max_; }
  double rms() const { return std::sqrt(sum_of_squares_ / static_cast<double>(finite_)); }  ///< NaN of none
  std::size_t finite() const { return finite_; }
  std::size_t infinite() const { return infinite_; }

 private:
  double max_ = 0, sum_of_squares_ = 0;
  std::size_t finite_ = 0, infinite_ = 0;
};

/// The least-squares line y = intercept + slope x, with the 95 % confidence interval of the slope from
/// Student's t. The interval is infinite for fewer than three points. \throws ParameterError for other than
/// one y per x
struct Line {
  double slope, intercept, slope_low, slope_high;
};
Line fit_line(std::span<const double> x, std::span<const double> y);

}  // namespace darboux
