#include "intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace darboux::fit {
namespace {

// For the mean of `dimensions` squares of normal numbers over their estimated variance: F, or chi squared
// over its dimensions if the variance is known.
double quantile_of_mean_square(double dimensions, double degrees_of_freedom, double level) {
  // Beyond, F equals that limit to six digits, and computing its own quantile is slow.
  if (degrees_of_freedom > 1e7)
    return boost::math::quantile(boost::math::chi_squared(dimensions), level) / dimensions;
  return boost::math::quantile(boost::math::fisher_f(dimensions, degrees_of_freedom), level);
}

}  // namespace

Intervals::Intervals(PointFit& fit, double degrees_of_freedom)
    : fit_(fit), degrees_of_freedom_(std::max(1.0, degrees_of_freedom)) {
  fit_.interval_method = std::isinf(degrees_of_freedom) ? "linear" : "t";
}

void Intervals::add_number(std::string name, double value, double variance) const {
  const double deviation = std::sqrt(std::fmax(variance, 0));
  const double half = deviation * std::sqrt(quantile_of_mean_square(1, degrees_of_freedom_, fit_.level));
  fit_.standard_errors.push_back({name, deviation});
  fit_.intervals.push_back({std::move(name), value - half, value + half});
}

void Intervals::add_length(std::string name, const Eigen::MatrixXd& covariance, double unit) const {
  const double sum = std::fmax(covariance.trace(), 0), squares = covariance.squaredNorm();
  const double dimensions = squares > 0 ? sum * sum / squares : 1;
  const double bound = std::sqrt(sum * quantile_of_mean_square(dimensions, degrees_of_freedom_, fit_.level));
  fit_.standard_errors.push_back({name, unit * std::sqrt(sum)});
  fit_.intervals.push_back({std::move(name), 0, unit * bound});
}

double Intervals::widening() const {
  return quantile_of_mean_square(2, degrees_of_freedom_, fit_.level) /
         quantile_of_mean_square(2, std::numeric_limits<double>::infinity(), fit_.level);
}

double greatest_sigma_ratio(double degrees_of_freedom) {
  return std::sqrt(degrees_of_freedom /
                   boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), 0.05));
}

double students_t(double level, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), level);
}

double chance_of_ratio(double ratio, double freedom_of_one, double freedom_of_other) {
  return cdf(complement(boost::math::fisher_f(freedom_of_one, freedom_of_other), ratio));
}

}  // namespace darboux::fit
