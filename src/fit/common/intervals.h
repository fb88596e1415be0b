// Standard errors and confidence intervals of the numbers that a fit states.
#pragma once

#include <string>

#include <Eigen/Core>

#include <darboux/fit_points.h>

namespace darboux::fit {

// Adds standard errors and intervals to a fit. The noise has degrees of freedom: the number of the inliers'
// residuals minus the unknowns; infinite if the noise was given.
class Intervals {
 public:
  Intervals(PointFit& fit, double degrees_of_freedom);

  // A number with its variance, by Student's t.
  void add_number(std::string name, double value, double variance) const;

  // The length of a vector that is zero at the truth, times a unit. The sum of squares l1 x1^2 + l2 x2^2 +
  // ... with l the eigenvalues of its covariance is approximated by (sum l) / h times a chi squared of h =
  // (sum l)^2 / sum l^2 degrees of freedom, which has the same mean and variance [Satterthwaite1946]; divided
  // by the estimated variance, this is an F.
  void add_length(std::string name, const Eigen::MatrixXd& covariance, double unit) const;

  // The factor for a covariance with which the two-dimensional normal region of a direction keeps its level
  // although sigma is estimated.
  double widening() const;

 private:
  PointFit& fit_;
  double degrees_of_freedom_;
};

// The factor by which the noise may exceed its estimate, at 95 % confidence. The estimate is the root of: the
// distances' sum of squares over the degrees of freedom.
double greatest_sigma_ratio(double degrees_of_freedom);

// The quantile of Student's t.
double students_t(double level, double degrees_of_freedom);

// The probability that noise makes the ratio of two estimates of a variance this large, with these degrees of
// freedom.
double chance_of_ratio(double ratio, double freedom_of_one, double freedom_of_other);

}  // namespace darboux::fit
