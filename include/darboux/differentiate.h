/// \file differentiate.h
/// Numerical differentiation of functions of one variable, with an error estimate.
#pragma once

#include <array>
#include <cmath>

#include <darboux/frame.h>
#include <darboux/vector.h>

namespace darboux {

/// A derivative and an estimate of its absolute error.
struct DerivativeEstimate {
  Vec3<double> value;
  double error;
};

/// The weights w of a central difference of the given order: f'(x) ≈ Σ_k w[k-1] (f(x + k h) - f(x - k h)) /
/// h. Exact for polynomials of degree `order`. [Fornberg1988]
template <int order>
constexpr std::array<double, order / 2> central_weights() {
  static_assert(order == 2 || order == 4 || order == 6 || order == 8);
  if constexpr (order == 2) return {1.0 / 2};
  if constexpr (order == 4) return {2.0 / 3, -1.0 / 12};
  if constexpr (order == 6) return {3.0 / 4, -3.0 / 20, 1.0 / 60};
  if constexpr (order == 8) return {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
}

/// The step near which truncation and rounding balance for a function that varies over a unit of x like sin
/// 2πx: a power of two, so that x ± k h is exact for x in [2^-20, 1].
template <int order>
constexpr double central_step() {
  if constexpr (order == 2) return 0x1p-19;
  if constexpr (order == 4) return 0x1p-12;
  if constexpr (order == 6) return 0x1p-9;
  if constexpr (order == 8) return 0x1p-8;
}

/// f'(x) by the central difference of the given order (2, 4, 6 or 8) at step h, from values of f at x ± k h
/// and x ± 2 k h, k up to order/2. The error estimate is the sum of
///   truncation  |D(h) - D(2h)| / (2^order - 1), Richardson's estimate of the error of D(h), and
///   rounding    8u max|f| Σ|w| 2 / h, for values of f that err by up to 8u of their largest, and
///   abscissae   |f'| u max|x ± k h| Σ|w| 2 / h, only where some x ± k h is not exact.
/// f: double -> Vec3<double>. Cost: 4 evaluations of f at order 2, 6 at 4, 10 at 6, 12 at 8.
template <int order, class F>
DerivativeEstimate central_difference(F&& f, double x, double h = central_step<order>()) {
  constexpr auto weights = central_weights<order>();
  constexpr double unit_roundoff = 0x1p-53;
  constexpr int half = order / 2;
  std::array<Vec3<double>, 2 * half + 1> difference;  // f(x + k h) - f(x - k h)
  double largest = 0, weight_sum = 0;
  bool exact = true;
  for (int k = 1; k <= 2 * half; ++k) {
    if (k > half && k % 2 != 0) continue;  // only even multiples serve D(2h) beyond order/2
    const Vec3<double> above = f(x + k * h), below = f(x - k * h);
    difference[k] = above - below;
    exact = exact && (x + k * h) - x == k * h && x - (x - k * h) == k * h;
    largest = std::fmax(largest, std::fmax(norm(above), norm(below)));
  }
  Vec3<double> fine{}, coarse{};
  for (int k = 1; k <= half; ++k) {
    fine += weights[k - 1] / h * difference[k];
    coarse += weights[k - 1] / (2 * h) * difference[2 * k];
    weight_sum += std::fabs(weights[k - 1]);
  }
  const double truncation = norm(fine - coarse) / ((1 << order) - 1);
  const double rounding = 8 * unit_roundoff * largest * weight_sum * 2 / h;
  const double abscissae =
      exact ? 0 : norm(fine) * unit_roundoff * (std::fabs(x) + 2 * half * h) * weight_sum * 2 / h;
  return {fine, truncation + rounding + abscissae};
}

}  // namespace darboux
