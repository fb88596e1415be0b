/// \file order_of_convergence.h
/// Estimates the order of convergence of a sequence of errors, with a confidence interval.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace darboux {

/// Errors at one mesh width.
struct ErrorsAtWidth {
  double h;                    ///< mesh width, > 0
  std::vector<double> errors;  ///< > 0; one per mesh of that width, at least one
};

/// error = C h^order as h tends to 0.
struct OrderEstimate {
  double order, low, high;  ///< the slope of log error over log h, and its 95 % interval; NaN without a slope
  std::size_t first;        ///< the first width of the asymptotic range; the order is fitted from there on
};

/// Estimates the order. Widths are given from the coarsest to the finest; no error may be at rounding level.
///
/// Asymptotic range: while the curvature of log error against log h differs significantly from zero (t test,
/// level 10 %), the coarsest width is excluded; at least three remain. If there are several meshes per width,
/// their spread is the noise, with Welch-Satterthwaite degrees of freedom; a width with one mesh has the
/// spread of the last coarser width with more. With one mesh per width, the noise is the residual from the
/// line or parabola. [Satterthwaite1946]
///
/// Interval: the uncertainty from noise (Student's t) and from the remaining pre-asymptotic terms, added in
/// quadrature. The latter is 1.75 times the difference from the slope of C h^p exp(a h), fitted to the same
/// widths; 1.75 is calibrated so that the intervals cover the order of synthetic sequences in 95 % of all
/// cases.
///
/// Fewer than three widths give NaN. Cost: a few small least-squares problems.
/// \throws ParameterError for widths that do not decrease, an error that is not above 0, or a width without
/// errors
OrderEstimate estimate_order(std::span<const ErrorsAtWidth> widths);

}  // namespace darboux
