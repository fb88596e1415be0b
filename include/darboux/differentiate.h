/// \file differentiate.h
/// Numerical differentiation of functions of one variable, each derivative with an estimate of its error:
/// central and one-sided differences, Ridders' extrapolation, dual numbers and second derivatives.
/// derivative.h chooses the cheapest of them that is accurate enough.
///
///     const auto d = darboux::central_difference<8>([](double x) { return std::exp(x); }, 0.5);
///     d.value, d.error
///
/// f takes a double (for dual numbers: a dual number) and returns a number or a Vec3. Errors are absolute;
/// for a Vec3, the length of the error vector. u = 2^-53.
///
/// *Length.* L says how fast f varies: |f⁽ⁿ⁾| is about (2π/L)ⁿ |f| for n up to the order of the
/// method. It is the period of a sine, 2π/k for exp(kx), about 1.5 times the distance to the nearest pole of
/// a rational function, and 1 for a surface that makes one turn; a helicoid of 10^6 turns has 10^-6. Steps
/// are proportional to L. Too large an L increases the truncation error, too small an L the rounding error;
/// the estimate covers both as long as the stencil stays within a tenth of the true length.
///
/// *Rounding.* The rounding error of f cannot be seen from a single value. The overloads with a step assume a
/// few roundings of |f| and of the argument, which holds for positions of surfaces. The overloads with a
/// Behaviour, which behaviour() measures with 20 evaluations of f, use the measured rounding error and adapt
/// the step to it: for sums that cancel, polynomials, and noise of any kind.
///
/// *Reliability of the estimate*, for smooth f with the right length and a measured behaviour: at no more
/// than 10 of 10^6 points is the estimate below half the true error. The ratio of the estimate to the true
/// error is at most 10 in the median and at most 100 at the 99th percentile (true errors below u|f'| count as
/// u|f'|). tests/surface/differentiate_test.cpp tests this; docs/theory/differentiation.md derives it and
/// names the exceptions. It is an estimate, not a bound.
///
/// If a value of f is not finite, or the step is too small for x, the value is NaN and the error infinite.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>
#include <utility>

#include <darboux/scalar.h>
#include <darboux/vector.h>

namespace darboux {

/// A derivative and an estimate of its absolute error.
template <class V = Vec3<double>>
struct DerivativeEstimate {
  V value;
  double error;
};

/// The closed interval [lo, hi] in which a function may be evaluated.
struct Interval {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
};

/// The local properties of f from which the step and the rounding error are derived.
struct Behaviour {
  double length;    ///< L, as above
  double size;      ///< |f| or |f'| L/2π, whichever is larger
  double rounding;  ///< rms error of f's values, absolute
};

namespace detail::difference {

constexpr double unit_roundoff = 0x1p-53;
constexpr double tau = 6.283185307179586;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The weights in an error estimate of the truncation error seen by the next higher order, and of the rms
// rounding error. Fitted to the reliability stated above.
constexpr double truncation_share = 2.5;
constexpr double rounding_share = 3.5;
constexpr double one_sided_rounding_share = 3.2;
constexpr double ridders_rounding_share = 4.2;  // higher, as the smallest of many estimates is chosen

// The rms error of one rounding of x, averaged over a binade, is 0.41 u |x|.
constexpr double one_rounding = 0.41 * unit_roundoff;

// Steps, as multiples of the length, at which the truncation error for a sine is 10 times the error from one
// rounding of each value: C θ^(p+1) = 10 A one_rounding for h = θ L/2π, C the coefficient of the first
// neglected term, A the amplification.
constexpr std::array<double, 9> central_steps{0, 0, 0x1p-19, 0, 0x1.1p-12, 0, 0x1.1p-9, 0, 0x1.ap-8};
constexpr std::array<double, 9> one_sided_steps{0,          0x1.88p-28, 0x1.4p-19, 0x1.8p-15, 0x1.1p-12,
                                                0x1.bcp-11, 0x1p-9,     0x1.dp-9,  0x1.8p-8};
constexpr std::array<double, 9> second_steps{0, 0, 0x1.cp-15, 0, 0x1.28p-10, 0, 0x1.44p-8, 0, 0x1.84p-7};

template <class V>
concept Differentiable = std::same_as<V, double> || std::same_as<V, Vec3<double>>;
template <class F>
using Value = std::remove_cvref_t<std::invoke_result_t<F&, double>>;

inline double size(double x) {
  return std::fabs(x);
}
inline double size(const Vec3<double>& a) {
  return norm(a);
}

template <class V>
DerivativeEstimate<V> no_estimate() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if constexpr (std::same_as<V, double>)
    return {nan, infinity};
  else
    return {V{nan, nan, nan}, infinity};
}
template <class V>
DerivativeEstimate<V> finite_or_none(const V& value, double error) {
  return std::isfinite(size(value)) && std::isfinite(error) ? DerivativeEstimate<V>{value, error}
                                                            : no_estimate<V>();
}

// t_k = k^power, k = 1 ... n
template <int n, int power>
constexpr std::array<double, n> abscissae() {
  std::array<double, n> t{};
  for (int k = 0; k < n; ++k) t[k] = power == 1 ? k + 1.0 : (k + 1.0) * (k + 1.0);
  return t;
}

// ℓ_k: the value at t = 0 of the polynomial through (t_k, q_k) is Σ ℓ_k q_k. Integers until the one
// division.
template <int n, int power>
constexpr std::array<double, n> weights_at_zero() {
  const std::array<double, n> t = abscissae<n, power>();
  std::array<double, n> result{};
  for (int k = 0; k < n; ++k) {
    double numerator = 1, denominator = 1;
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      numerator *= t[i];
      denominator *= t[i] - t[k];
    }
    result[k] = numerator / denominator;
  }
  return result;
}

// A: the rms error of Σ ℓ_k q_k, times h (second: h²), where f's values err independently by 1.
//   quotients   2 k h q_k = f_k - f_-k (central), k h q_k = f_k - f_0 (one_sided),
//               (k h)² q_k = f_k - 2 f_0 + f_-k (second)
enum class Quotient { central, one_sided, second };
template <Quotient quotient, int n>
double amplification() {
  constexpr auto l = weights_at_zero < n, quotient == Quotient::one_sided ? 1 : 2 > ();
  double squares = 0, centre = 0;
  for (int k = 1; k <= n; ++k) {
    const double weight = quotient == Quotient::central     ? l[k - 1] / (2 * k)
                          : quotient == Quotient::one_sided ? l[k - 1] / k
                                                            : l[k - 1] / (k * k);
    const int values = quotient == Quotient::one_sided ? 1 : 2;
    squares += values * weight * weight;
    centre += quotient == Quotient::central ? 0 : values * weight;
  }
  return std::sqrt(squares + centre * centre);
}

// h rounded down to so few digits that x ± k h is exact for all k up to `reach`, unless a power of two lies
// between the nodes. A node rounded by e h leaves an error of about e times the leading term, which no higher
// order removes.
inline double exact_step(double x, double h, int reach) {
  const double farthest = std::fabs(x) + reach * std::fabs(h);
  double exact = (farthest + h) - farthest;
  if (std::fabs(exact) > std::fabs(h))
    exact -= std::copysign(std::nextafter(farthest, infinity) - farthest, h);
  return exact == 0 || !std::isfinite(exact) ? h : exact;
}

// The assumed rms error of f's values if it was not measured: one or two roundings of the magnitude of f
// within a length (taken from its derivatives where f itself happens to be small), and one of its argument.
//   slope, bend, third  sizes of the first derivative, and of the second and third over omega², so that no
//                       power of a length is taken; omega = 2π/L
inline double usual_rounding(double largest, double x, double slope, double bend, double third,
                             double omega) {
  const double envelope = std::hypot(largest, slope / omega, std::hypot(bend, third / omega));
  if (envelope == 0) return 0;
  if (!std::isfinite(envelope)) return infinity;
  return std::fmax(unit_roundoff * std::hypot(0.6 * envelope, 0.45 * std::fabs(x) * slope),
                   std::numeric_limits<double>::denorm_min());
}

// Σ ℓ_k q_k over the first n quotients; one more serves the estimate.
//   rounding  its rms error from the rounding of f's values
//   angle     2π h / L
template <int n, int power, class V>
DerivativeEstimate<V> extrapolate(const std::array<V, n + 1>& q, double rounding, double angle) {
  constexpr auto used = weights_at_zero<n, power>();
  constexpr auto all = weights_at_zero<n + 1, power>();
  V value{}, higher_order = all[n] * q[n];
  double squares = 0;
  for (int k = n - 1; k >= 0; --k) {  // small weights first
    value = value + used[k] * q[k];
    higher_order = higher_order + all[k] * q[k];
    squares += used[k] * used[k];
  }
  double truncation = truncation_share * size(higher_order - value);
  if constexpr (power == 1 && n > 1) {
    // Where the leading term of the error changes sign, the next term remains, n angle / 2 times as large.
    constexpr auto fewer = weights_at_zero<n - 1, power>();
    V lower_order{};
    for (int k = n - 2; k >= 0; --k) lower_order = lower_order + fewer[k] * q[k];
    truncation = std::fmax(truncation, 0.12 * angle * size(value - lower_order));
  }
  constexpr double share = power == 1 ? one_sided_rounding_share : rounding_share;
  return finite_or_none(
      value, truncation + share * std::hypot(rounding, one_rounding * size(value) * std::sqrt(squares)));
}

// The step of a method for a measured behaviour: longer if the noise of f exceeds one rounding. The whole
// stencil stays within a tenth of the length.
template <int exponent>
double step(double step_of_one_rounding, int reach, const Behaviour& b) {
  const double roughness = std::fmax(b.rounding / (one_rounding * b.size), 1);
  return b.length * std::fmin(step_of_one_rounding * std::pow(roughness * 5, 1.0 / exponent), 0.1 / reach);
}

constexpr double unknown = -1;  // a rounding that was not measured

template <int order, class F>
auto central(F& f, double x, double h, double rounding) {
  using V = Value<F>;
  static_assert(Differentiable<V>, "f must return double or Vec3<double>");
  static_assert(order == 2 || order == 4 || order == 6 || order == 8);
  constexpr int n = order / 2;
  h = exact_step(x, h, n + 1);
  std::array<V, n + 1> q, sum;
  double largest = 0;
  for (int k = 1; k <= n + 1; ++k) {
    const double right = x + k * h, left = x - k * h;
    const V above = f(right), below = f(left);
    q[k - 1] = (above - below) / (right - left);
    sum[k - 1] = above + below;
    largest = std::fmax(largest, std::fmax(size(above), size(below)));
  }
  if (rounding == unknown) {
    constexpr double angle = tau * central_steps[order], square = angle * angle;
    rounding = usual_rounding(largest, x, size(q[0]), size(sum[1] - sum[0]) / (3 * square),
                              2 * size(q[1] - q[0]) / square, angle / std::fabs(h));
  }
  return extrapolate<n, 2>(q, amplification<Quotient::central, n>() * rounding / std::fabs(h), 0);
}

template <int order, class F>
auto one_sided(F& f, double x, double h, double rounding, double length = 0) {
  using V = Value<F>;
  static_assert(Differentiable<V>, "f must return double or Vec3<double>");
  static_assert(1 <= order && order <= 8);
  h = exact_step(x, h, order + 1);
  const double angle = tau * (length > 0 ? std::fabs(h) / length : one_sided_steps[order]);
  std::array<V, order + 1> q;
  const V here = f(x);
  double largest = size(here);
  for (int k = 1; k <= order + 1; ++k) {
    const double node = x + k * h;
    const V there = f(node);
    q[k - 1] = (there - here) / (node - x);
    largest = std::fmax(largest, size(there));
  }
  if (rounding == unknown) {
    const double omega = angle / std::fabs(h);
    double third = 0;
    if constexpr (order > 1) third = 3 * size((q[2] - q[1]) - (q[1] - q[0])) / (angle * angle);
    rounding = usual_rounding(largest, x, size(q[0]), 2 * size(q[1] - q[0]) / omega / angle, third, omega);
  }
  return extrapolate<order, 1>(q, amplification<Quotient::one_sided, order>() * rounding / std::fabs(h),
                               angle);
}

template <int order, class F>
auto second(F& f, double x, double h, double rounding) {
  using V = Value<F>;
  static_assert(Differentiable<V>, "f must return double or Vec3<double>");
  static_assert(order == 2 || order == 4 || order == 6 || order == 8);
  constexpr int n = order / 2;
  h = exact_step(x, h, n + 1);
  std::array<V, n + 1> q, slope;
  const V here = f(x);
  double largest = size(here);
  for (int k = 1; k <= n + 1; ++k) {
    const double right = x + k * h, left = x - k * h;
    const V above = f(right), below = f(left);
    const V up = (above - here) / (right - x), down = (here - below) / (x - left);
    q[k - 1] = (up - down) / (0.5 * (right - left));
    slope[k - 1] = (above - below) / (right - left);
    largest = std::fmax(largest, std::fmax(size(above), size(below)));
  }
  if (rounding == unknown) {
    constexpr double angle = tau * second_steps[order];
    const double omega = angle / std::fabs(h);
    rounding = usual_rounding(largest, x, size(slope[0]), size(q[0]) / omega / omega,
                              2 * size(slope[1] - slope[0]) / (angle * angle), omega);
  }
  return extrapolate<n, 2>(q, amplification<Quotient::second, n>() * rounding / (h * h), 0);
}

// \param evaluations  counts
template <class F>
auto ridders(F& f, double x, double h, double rounding, int& evaluations) {
  using V = Value<F>;
  static_assert(Differentiable<V>, "f must return double or Vec3<double>");
  constexpr int rows = 10;
  h = std::ldexp(exact_step(x, std::ldexp(h, 1 - rows), 1 << (rows - 1)), rows - 1);  // the shortest too
  struct Entry {
    V value;
    double rounding, correction;  // correction: of the entry before it
  };
  std::array<Entry, rows> above{}, row{};
  DerivativeEstimate<V> best = no_estimate<V>();
  double largest = 0;
  for (int i = 0; i < rows; ++i, h /= 2) {
    const double right = x + h, left = x - h;
    const V fr = f(right), fl = f(left);
    evaluations += 2;
    largest = std::fmax(largest, std::fmax(size(fr), size(fl)));
    const V quotient = (fr - fl) / (right - left);
    const double value_rounding =
        rounding != unknown ? rounding
                            : unit_roundoff * std::hypot(0.6 * largest, 0.45 * std::fabs(x) * size(quotient));
    row[0] = {quotient, value_rounding / (std::sqrt(2.0) * std::fabs(h)), 0};
    double power = 1, smallest_of_row = infinity;
    for (int j = 1; j <= i; ++j) {
      power *= 4;
      const V correction = (row[j - 1].value - above[j - 1].value) / (power - 1);
      row[j] = {row[j - 1].value + correction,
                (power * row[j - 1].rounding + above[j - 1].rounding) / (power - 1), size(correction)};
    }
    power = 1;
    for (int j = 0; j + 1 < i && i >= 3; ++j) {
      power *= 4;
      // The error of an entry is estimated by the next correction. That may be small by chance, so the
      // corrections at twice the step and of the next order are used as well.
      const double truncation =
          std::max({row[j + 1].correction, above[j + 1].correction / power, row[j + 2].correction});
      const double error =
          truncation_share * truncation +
          ridders_rounding_share * std::hypot(row[j].rounding, 2 * one_rounding * size(row[j].value));
      smallest_of_row = std::fmin(smallest_of_row, error);
      if (error < best.error) best = finite_or_none(row[j].value, error);
    }
    if (!std::isfinite(size(quotient))) return no_estimate<V>();
    if (i > 3 && smallest_of_row > 2 * best.error) break;  // rounding has taken over
    above = row;
  }
  return best;
}

}  // namespace detail::difference

/// The weights w of a central difference of the given order:
///   f'(x) ≈ Σ_k w[k-1] (f(x + k h) - f(x - k h)) / h
/// Exact for polynomials of degree `order`. [Fornberg1988]
template <int order>
constexpr std::array<double, order / 2> central_weights() {
  static_assert(order == 2 || order == 4 || order == 6 || order == 8);
  std::array<double, order / 2> w = detail::difference::weights_at_zero<order / 2, 2>();
  for (int k = 1; k <= order / 2; ++k) w[k - 1] /= 2 * k;
  return w;
}

/// The step of central_difference for a function of the given length whose values are rounded once: about
/// where truncation and rounding errors balance.
template <int order>
constexpr double central_step(double length = 1) {
  return detail::difference::central_steps[order] * length;
}
/// The same for one_sided_difference.
template <int order>
constexpr double one_sided_step(double length = 1) {
  return detail::difference::one_sided_steps[order] * length;
}
/// The same for second_difference.
template <int order>
constexpr double second_step(double length = 1) {
  return detail::difference::second_steps[order] * length;
}

/// Measures the magnitude of f near x and the rms rounding error of its values, by 20 evaluations in two
/// clusters. The points of a cluster are some 10^-8 lengths apart: so close that f is a parabola there, and
/// any deviation from one is rounding [More2011]. The clusters lie 1/24 of a length from x, on both sides
/// where the domain allows. The result has the statistical accuracy of 14 samples, and is at least the error
/// of one rounding of |f|. If values are rounded so coarsely that f is constant in a cluster, no rounding
/// error is found. Measure once and use the result for all points nearby.
template <class F>
Behaviour behaviour(F&& f, double x, double length = 1, const Interval& domain = {}) {
  namespace d = detail::difference;
  using V = d::Value<F>;
  static_assert(d::Differentiable<V>, "f must return double or Vec3<double>");
  constexpr int points = 10;
  // The golden ratio, not a power of two: f(x) must not be rounded alike at all points.
  const double spacing =
      std::fmin(std::fmax(length * 0x1.9e3779b97f4a8p-26, std::fabs(x) * 0x1.9e3779b97f4a8p-48),
                (domain.hi - domain.lo) / (points + 1));
  const double half = spacing * points / 2;
  double residue = 0, size = 0;
  for (const double side : {-1.0, 1.0}) {
    const double centre =
        std::clamp(x + side * length / 24, domain.lo + half, std::fmax(domain.lo + half, domain.hi - half));
    std::array<V, points> y;
    V first{}, slope{}, curvature{};
    V mean{};
    // The three orthogonal polynomials 1, t, t² - m on t = ±1/2, ±3/2, ...
    constexpr double m = (points * points - 1) / 12.0;
    double slope_norm = 0, curvature_norm = 0;
    for (int j = 0; j < points; ++j) {
      const double t = j - (points - 1) / 2.0;
      const V value = f(centre + t * spacing);
      if (j == 0) first = value;
      size = std::fmax(size, d::size(value));
      y[j] = value - first;  // exact or nearly: the values are neighbours
      mean = mean + y[j];
      slope = slope + t * y[j];
      curvature = curvature + (t * t - m) * y[j];
      slope_norm += t * t;
      curvature_norm += (t * t - m) * (t * t - m);
    }
    for (int j = 0; j < points; ++j) {
      const double t = j - (points - 1) / 2.0;
      const double rest = d::size(y[j] - mean / points - (t / slope_norm) * slope -
                                  ((t * t - m) / curvature_norm) * curvature);
      residue = std::hypot(residue, rest);
    }
    size = std::fmax(size, d::size(slope) / slope_norm / spacing * length / d::tau);
  }
  return {length, size, std::hypot(residue / std::sqrt(2.0 * (points - 3)), 0.3 * d::unit_roundoff * size)};
}

/// f'(x) by the central difference of order 2, 4, 6 or 8 at step h, from f at x ± k h, k = 1 ... order/2 +
/// 1. The outermost two are used only for the error estimate: 2.5 |D - D'|, with D' the difference of the
/// next order, plus 3.5 times the rms rounding error. Cost: order + 2 evaluations. On the sphere and the
/// torus it errs by 4e-11, 4e-13, 5e-14, 2e-14 of 2π|f|.
template <int order, class F>
auto central_difference(F&& f, double x, double h = central_step<order>()) {
  return detail::difference::central<order>(f, x, h, detail::difference::unknown);
}
/// The same with step and rounding from a measured behaviour.
template <int order, class F>
auto central_difference(F&& f, double x, const Behaviour& b) {
  namespace d = detail::difference;
  return d::central<order>(f, x, d::step<order + 1>(d::central_steps[order], order / 2 + 1, b), b.rounding);
}

/// f'(x) from one side, for the edges of a domain: the difference of order 1 to 8 from f at x + k h, k = 0
/// ... order + 1. h < 0: from the left. The last point is used only for the error estimate. Cost: order + 2
/// evaluations. Order 8 errs by 1e-12 of 2π|f| at most on the sphere and the torus.
template <int order, class F>
auto one_sided_difference(F&& f, double x, double h = one_sided_step<order>()) {
  return detail::difference::one_sided<order>(f, x, h, detail::difference::unknown);
}
/// The same with step and rounding from a measured behaviour.
/// \param side  +1: from the right, -1: from the left
template <int order, class F>
auto one_sided_difference(F&& f, double x, const Behaviour& b, int side) {
  namespace d = detail::difference;
  return d::one_sided<order>(f, x, side * d::step<order + 1>(d::one_sided_steps[order], order + 1, b),
                             b.rounding, b.length);
}

/// f''(x) by the central difference of order 2, 4, 6 or 8 at step h, from f at x and at x ± k h, k = 1 ...
/// order/2 + 1. Cost: order + 3 evaluations. It errs by 1e-8, 4e-11, 2e-12, 5e-13 of 4π²|f| on the sphere
/// and the torus.
template <int order, class F>
auto second_difference(F&& f, double x, double h = second_step<order>()) {
  return detail::difference::second<order>(f, x, h, detail::difference::unknown);
}
/// The same with step and rounding from a measured behaviour.
template <int order, class F>
auto second_difference(F&& f, double x, const Behaviour& b) {
  namespace d = detail::difference;
  return d::second<order>(f, x, d::step<order + 2>(d::second_steps[order], order / 2 + 1, b), b.rounding);
}

/// f'(x) by Ridders' extrapolation of central differences at h, h/2, h/4, ... to step zero [Ridders1982].
/// Only the first step is chosen, about an eighth of the length. Ridders' error estimate, the difference of
/// neighbouring entries of the tableau, is up to 1000 times too small where rounding makes two agree by
/// chance. Therefore the rounding error is propagated through the tableau and added. Cost: 10 to 20
/// evaluations.
template <class F>
auto ridders(F&& f, double x, double h = 0.125) {
  int evaluations = 0;
  return detail::difference::ridders(f, x, h, detail::difference::unknown, evaluations);
}
/// The same with step and rounding from a measured behaviour.
template <class F>
auto ridders(F&& f, double x, const Behaviour& b) {
  int evaluations = 0;
  return detail::difference::ridders(f, x, b.length / 8, b.rounding, evaluations);
}

namespace detail::difference {

template <class T, int N>
T derivative_part(const Dual<T, N>& x) {
  return x.derivative[0];
}
template <class T, int N>
Vec3<T> derivative_part(const Vec3<Dual<T, N>>& a) {
  return {a.x.derivative[0], a.y.derivative[0], a.z.derivative[0]};
}

// f'(x) (order 1) or f''(x) (order 2) by dual numbers over T.
template <class T>
using Once = Dual<T, 1>;
template <class T>
using Twice = Dual<Dual<T, 1>, 1>;
template <int order, class T, class F>
auto by_duals(F& f, const T& x) {
  if constexpr (order == 1)
    return derivative_part(f(Once<T>::variable(x, 0)));
  else
    return derivative_part(derivative_part(f(Twice<T>::variable(Once<T>::variable(x, 0), 0))));
}
inline double to_double(long double x) {
  return static_cast<double>(x);
}
inline Vec3<double> to_double(const Vec3<long double>& a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}
inline long double widen(double x) {
  return x;
}
inline Vec3<long double> widen(const Vec3<double>& a) {
  return {a.x, a.y, a.z};
}

template <class F, template <class> class D>
concept RunsOn = std::invocable<F&, D<double>>;
template <class F, template <class> class D>
concept RunsWiderOn = std::numeric_limits<long double>::digits > std::numeric_limits<double>::digits &&
                      std::invocable<F&, D<long double>>;

template <int order, template <class> class D, class F>
auto dual(F& f, double x, double length, const Interval& domain) {
  const auto value = by_duals<order>(f, x);
  if constexpr (RunsWiderOn<F, D>) {
    const auto wide = by_duals<order>(f, static_cast<long double>(x));
    return finite_or_none(value, size(to_double(wide - widen(value))) + 0.5 * unit_roundoff * size(value));
  } else {
    const auto derivative = [&](double t) { return by_duals<order>(f, t); };
    return finite_or_none(value, rounding_share * behaviour(derivative, x, length, domain).rounding +
                                     0.5 * unit_roundoff * size(value));
  }
}

}  // namespace detail::difference

/// f'(x) by dual numbers: exact up to rounding, without a step. f takes Dual<double, 1>. If it also takes
/// Dual<long double, 1>, and long double is wider, the estimate is the difference between the two, that is,
/// the error itself. Otherwise behaviour() measures the rounding error of the derivative. Cost: 2
/// evaluations, or 21. [Griewank2008]
template <class F>
requires detail::difference::RunsOn<F, detail::difference::Once>
auto dual_derivative(F&& f, double x, double length = 1, const Interval& domain = {}) {
  return detail::difference::dual<1, detail::difference::Once>(f, x, length, domain);
}
/// f''(x) by nested dual numbers, likewise.
template <class F>
requires detail::difference::RunsOn<F, detail::difference::Twice>
auto second_dual_derivative(F&& f, double x, double length = 1, const Interval& domain = {}) {
  return detail::difference::dual<2, detail::difference::Twice>(f, x, length, domain);
}

}  // namespace darboux
