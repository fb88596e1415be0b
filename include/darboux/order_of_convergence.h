/// \file order_of_convergence.h
/// The order of convergence of a sequence of errors, with an interval that covers it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace darboux {

/// Errors at one mesh width.
struct ErrorsAtWidth {
  double h;                    ///< mesh width, > 0
  std::vector<double> errors;  ///< > 0; one of each mesh of that width, at least one
};

/// error = C h^order as h tends to 0.
struct OrderEstimate {
  double order, low, high;  ///< the slope of log error over log h, and its 95 % interval; NaN without a slope
  std::size_t first;        ///< the first width of the asymptotic range; the order is fitted from there on
};

/// The order of errors that are given from the coarsest width to the finest, none of them at the floor of
/// rounding.
///
/// Asymptotic range: while the curvature of log error against log h differs from zero (t test, level 10 %)
/// the coarsest width is left out; three remain. Where several meshes have one width their spread is the
/// noise, and the degrees of freedom are Welch and Satterthwaite's; a width with one mesh has the spread of
/// the last coarser width that has more. With one mesh each, noise is what remains about the line or
/// parabola. [Satterthwaite1946]
///
/// Interval: what noise leaves undetermined (Student's t) and what the rest of the pre-asymptotic terms may
/// do, added in squares. The latter is 1.75 times the difference to the slope of C h^p exp(a h), fitted to
/// the same widths; 1.75 is chosen so that synthetic sequences with known orders are covered in 95 % of all
/// cases.
///
/// Fewer than three widths give NaN. Cost: a few small least-squares problems.
/// \throws ParameterError for widths that do not fall, an error that is not above 0, a width without errors
OrderEstimate estimate_order(std::span<const ErrorsAtWidth> widths);

}  // namespace darboux
