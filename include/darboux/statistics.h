/// \file statistics.h
/// Summaries of samples, and straight lines through them.
#pragma once

#include <span>
#include <vector>

namespace darboux {

/// Largest, root mean square and 95th percentile (nearest rank) of a sample; zeros for an empty one.
struct Statistics {
  double max = 0, rms = 0, p95 = 0;
};
/// Reorders `values`.
Statistics summarise(std::vector<double>& values);

/// The least-squares line y = intercept + slope x, with the 95 % confidence interval of the slope from
/// Student's t. The interval is infinite for fewer than three points.
struct Line {
  double slope, intercept, slope_low, slope_high;
};
Line fit_line(std::span<const double> x, std::span<const double> y);

}  // namespace darboux
