// Intervals, and intervals with a linear form in u and v, as scalar types for the formulas of surfaces. Every
// result contains the results for all numbers in the operands, rounding included.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <darboux/elementary.h>
#include <darboux/scalar.h>

namespace darboux::tiles {

// Thrown by a comparison of intervals that has no definite result.
struct Uncertain : std::domain_error {
  Uncertain() : std::domain_error("a comparison of intervals") {}
};
struct Truth {
  bool may_be_true, may_be_false;
  explicit operator bool() const {
    if (may_be_true && may_be_false) throw Uncertain();
    return may_be_true;
  }
  friend Truth operator!(Truth a) { return {a.may_be_false, a.may_be_true}; }
};

// Minimum of numbers that are not NaN; std::fmin would be a function call.
constexpr double least(double a, double b) {
  return b < a ? b : a;
}
constexpr double most(double a, double b) {
  return a < b ? b : a;
}

struct Interval {
  double lo = 0, hi = 0;

  constexpr Interval() = default;
  constexpr explicit(false) Interval(double x)
      : lo(x), hi(x) {}  // NOLINT: clang-tidy 14 does not know explicit(false)
  constexpr Interval(double from, double to) : lo(from), hi(to) {}

  // [lo, hi], widened by twice the rounding error of an operation (or of a function, given in roundings),
  // since widening itself rounds.
  static Interval rounded(double lo, double hi, double roundings = 1) {
    const double share = roundings * 0x1p-51, least = 0x1p-1070;
    if (std::isnan(lo) || std::isnan(hi))
      return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    return {lo - (std::fabs(lo) * share + least), hi + (std::fabs(hi) * share + least)};
  }
  double mid() const { return 0.5 * lo + 0.5 * hi; }
  // The largest distance of a point of the interval from m.
  double radius(double m) const { return lo == hi && lo == m ? 0 : most(hi - m, m - lo) * (1 + 0x1p-50); }
  double size() const { return most(std::fabs(lo), std::fabs(hi)); }

  friend Interval operator+(const Interval& a, const Interval& b) {
    return rounded(a.lo + b.lo, a.hi + b.hi);
  }
  friend Interval operator-(const Interval& a, const Interval& b) {
    return rounded(a.lo - b.hi, a.hi - b.lo);
  }
  friend Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
  friend Interval operator*(const Interval& a, const Interval& b) {
    const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    if (std::isnan(p + q + r + s)) return rounded(std::nan(""), 0);
    return rounded(least(least(p, q), least(r, s)), most(most(p, q), most(r, s)));
  }
  friend Interval operator/(const Interval& a, const Interval& b) {
    if (!(b.lo > 0 || b.hi < 0)) return rounded(std::nan(""), 0);
    const double p = a.lo / b.lo, q = a.lo / b.hi, r = a.hi / b.lo, s = a.hi / b.hi;
    if (std::isnan(p + q + r + s)) return rounded(std::nan(""), 0);
    return rounded(least(least(p, q), least(r, s)), most(most(p, q), most(r, s)));
  }
  friend Truth operator<(const Interval& a, const Interval& b) { return {a.lo < b.hi, a.hi >= b.lo}; }
  friend Truth operator>(const Interval& a, const Interval& b) { return b < a; }
  friend Truth operator<=(const Interval& a, const Interval& b) { return !(b < a); }
  friend Truth operator>=(const Interval& a, const Interval& b) { return !(a < b); }
  friend Truth operator==(const Interval& a, const Interval& b) {
    return {a.lo <= b.hi && b.lo <= a.hi, !(a.lo == a.hi && b.lo == b.hi && a.lo == b.lo)};
  }
  friend Interval hull(const Interval& a, const Interval& b) { return {least(a.lo, b.lo), most(a.hi, b.hi)}; }
  friend Interval select(const Truth& condition, const Interval& a, const Interval& b) {
    if (condition.may_be_true && condition.may_be_false) return hull(a, b);
    return condition.may_be_true ? a : b;
  }
  friend Interval abs(const Interval& a) {
    if (a.lo >= 0) return a;
    return a.hi <= 0 ? -a : Interval{0, a.size()};
  }
  friend Interval sqrt(const Interval& a) {
    if (!(a.hi >= 0)) return rounded(std::nan(""), 0);
    const Interval root = rounded(std::sqrt(most(a.lo, 0)), std::sqrt(a.hi));
    return {most(root.lo, 0), root.hi};
  }
  friend bool isfinite(const Interval& a) { return std::isfinite(a.lo) && std::isfinite(a.hi); }

  // Monotone functions of elementary.h, whose errors are a few roundings.
  friend Interval exp(const Interval& a) { return rounded(darboux::exp(a.lo), darboux::exp(a.hi), 8); }
  friend Interval log(const Interval& a) { return rounded(darboux::log(a.lo), darboux::log(a.hi), 8); }
  friend Interval sinh(const Interval& a) { return rounded(darboux::sinh(a.lo), darboux::sinh(a.hi), 8); }
  friend Interval tanh(const Interval& a) { return rounded(darboux::tanh(a.lo), darboux::tanh(a.hi), 8); }
  friend Interval cosh(const Interval& a) {
    const Interval b = abs(a);
    return rounded(darboux::cosh(b.lo), darboux::cosh(b.hi), 8);
  }
};

// sin and cos of 2πx/period.
inline Turn<Interval> of_period(const Interval& x, double period) {
  if (!(x.hi - x.lo < period) || !(x.size() < 0x1p40)) return {{-1, 1}, {-1, 1}};
  const auto at = [&](double t) {
    return period == 1 ? darboux::sincos_turns(t) : darboux::sincos_half_turns(t);
  };
  const Turn<double> a = at(x.lo), b = at(x.hi);
  // Whether x contains `first` plus a whole number of periods, widened by the rounding of x itself.
  const auto holds = [&](double first) {
    const double slack = 4 * 0x1p-52 * (x.size() + period);
    return std::floor((x.hi + slack - first * period) / period) >=
           std::ceil((x.lo - slack - first * period) / period);
  };
  const auto range = [&](double p, double q, double top, double bottom) {
    Interval r = Interval::rounded(std::fmin(p, q), std::fmax(p, q), 4);
    return Interval{holds(bottom) ? -1 : std::fmax(r.lo, -1), holds(top) ? 1 : std::fmin(r.hi, 1)};
  };
  return {range(a.sin, b.sin, 0.25, 0.75), range(a.cos, b.cos, 0, 0.5)};
}

// A quantity x over the tile: within `range`, and within mid + u a + v b ± rest, where a and b run over [-1,
// 1] with u and v of the tile. First-order terms in the size of the tile cancel as for numbers, so the
// overestimation is of second order. [Figueiredo2004]
struct Enclosure {
  Interval range;
  double mid = 0, u = 0, v = 0, rest = 0;

  constexpr Enclosure() = default;
  constexpr explicit(false) Enclosure(double x)
      : range(x), mid(x) {}  // NOLINT: clang-tidy 14 does not know explicit(false)
  explicit(false) Enclosure(const Interval& x) : range(x), mid(x.mid()), rest(x.radius(mid)) {
    if (!std::isfinite(rest)) mid = 0, rest = std::numeric_limits<double>::infinity();
  }
  Enclosure(double from, double to) : Enclosure(Interval(from, to)) {}
  // The coordinate u (0) or v (1) of the tile.
  static Enclosure variable(double from, double to, int k) {
    Enclosure x(from, to);
    std::swap(k == 0 ? x.u : x.v, x.rest);
    return x;
  }

  double lo() const { return range.lo; }
  double hi() const { return range.hi; }
  // The largest distance of x from mid.
  double radius() const { return (std::fabs(u) + std::fabs(v) + rest) * (1 + 0x1p-50); }

  // Combines the results of interval arithmetic and of the linear form, whose terms have the given size and
  // up to eight roundings each: the intersection of both.
  static Enclosure made(const Interval& by_interval, double mid, double u, double v, double rest,
                        double size) {
    Enclosure x;
    x.range = by_interval;
    x.mid = mid, x.u = u, x.v = v, x.rest = (rest + size * 0x1p-50 + 0x1p-1060) * (1 + 0x1p-50);
    const double radius = x.radius();
    if (!(std::fabs(mid) + radius < std::numeric_limits<double>::infinity())) return by_interval;
    const Interval by_form = Interval::rounded(mid - radius, mid + radius);
    x.range = {most(x.range.lo, by_form.lo), least(x.range.hi, by_form.hi)};
    if (!(x.range.lo <= x.range.hi)) return by_interval;
    if (!(x.range.hi - x.range.lo > 2 * x.rest)) return x.range;
    return x;
  }
  // f(x) = f(mid) + f'(mid) (x - mid) + half_bend (x - mid)², `all` an enclosure by intervals.
  Enclosure function(const Interval& all, const Interval& at_mid, const Interval& slope,
                     const Interval& half_bend) const {
    const double r = radius();
    const Interval rest_of_it = at_mid + half_bend * Interval(0, Interval::rounded(r * r, r * r).hi);
    const double m = rest_of_it.mid(), s = slope.mid();
    return made(all, m, s * u, s * v, rest_of_it.radius(m) + std::fabs(s) * rest + slope.radius(s) * r,
                std::fabs(m) + std::fabs(s) * r);
  }
  Interval with_mid() const { return hull(range, mid); }

  // Whether x is exactly 0, which is frequent in derivatives.
  bool is_zero() const { return range.lo == 0 && range.hi == 0; }

  friend Enclosure operator+(const Enclosure& a, const Enclosure& b) {
    if (a.is_zero()) return b;
    if (b.is_zero()) return a;
    return made(a.range + b.range, a.mid + b.mid, a.u + b.u, a.v + b.v, a.rest + b.rest,
                std::fabs(a.mid) + std::fabs(b.mid) + a.radius() + b.radius());
  }
  friend Enclosure operator-(const Enclosure& a) {
    Enclosure x = a;
    x.range = -a.range, x.mid = -a.mid, x.u = -a.u, x.v = -a.v;
    return x;
  }
  friend Enclosure operator-(const Enclosure& a, const Enclosure& b) { return a + -b; }
  friend Enclosure operator*(const Enclosure& a, const Enclosure& b) {
    if (a.is_zero() || b.is_zero()) return 0;
    const double ra = a.radius(), rb = b.radius(), m = std::fabs(a.mid), n = std::fabs(b.mid);
    return made(a.range * b.range, a.mid * b.mid, a.mid * b.u + b.mid * a.u, a.mid * b.v + b.mid * a.v,
                m * b.rest + n * a.rest + ra * rb, (m + ra) * (n + rb));
  }
  friend Enclosure operator/(const Enclosure& a, const Enclosure& b) {
    const Interval all = a.range / b.range, c = b.mid, inverse = Interval(1) / c;
    // 1/x - 1/c + (x - c)/c² = (x - c)²/(c² x)
    Enclosure x =
        a * b.function(Interval(1) / b.range, inverse, -(inverse * inverse), inverse * inverse / b.range);
    x.range = {most(x.range.lo, all.lo), least(x.range.hi, all.hi)};
    return x;
  }
  friend Truth operator<(const Enclosure& a, const Enclosure& b) { return a.range < b.range; }
  friend Truth operator>(const Enclosure& a, const Enclosure& b) { return a.range > b.range; }
  friend Truth operator<=(const Enclosure& a, const Enclosure& b) { return a.range <= b.range; }
  friend Truth operator>=(const Enclosure& a, const Enclosure& b) { return a.range >= b.range; }
  friend Truth operator==(const Enclosure& a, const Enclosure& b) { return a.range == b.range; }
  friend Enclosure hull(const Enclosure& a, const Enclosure& b) { return hull(a.range, b.range); }
  friend Enclosure select(const Truth& condition, const Enclosure& a, const Enclosure& b) {
    if (condition.may_be_true && condition.may_be_false) return hull(a, b);
    return condition.may_be_true ? a : b;
  }
  friend Enclosure abs(const Enclosure& a) {
    if (a.range.lo >= 0) return a;
    return a.range.hi <= 0 ? -a : Enclosure(abs(a.range));
  }
  friend Enclosure square(const Enclosure& a) {
    const Interval size = abs(a.range), c = a.mid;
    return a.function(size * size, c * c, Interval(2) * c, 1);
  }
  friend Enclosure sqrt(const Enclosure& a) {
    if (!(a.mid > 0 && a.range.lo > 0)) return sqrt(a.range);
    // √x - √c - (x - c)/(2√c) = -(x - c)²/(2√c (√x + √c)²)
    const Interval c = sqrt(Interval(a.mid)), x = sqrt(a.range), sum = x + c, slope = Interval(0.5) / c;
    return a.function(x, c, slope, -(slope / (sum * sum)));
  }
  // For x >= 0 and a constant exponent.
  friend Enclosure pow(const Enclosure& a, const Enclosure& exponent) {
    const double e = exponent.mid;
    const auto power = [](const Interval& x, double n) {
      const double p = darboux::pow(most(x.lo, 0), n), q = darboux::pow(most(x.hi, 0), n);
      return Interval::rounded(std::fmin(p, q), std::fmax(p, q), 64);
    };
    const Interval all = power(a.range, e);
    if (!(a.mid > 0 && a.range.lo > 0)) return all;
    return a.function(all, power(a.mid, e), Interval(e) * power(a.mid, e - 1),
                      Interval(0.5 * e) * Interval(e - 1) * power(a.with_mid(), e - 2));
  }
  friend bool isfinite(const Enclosure& a) { return isfinite(a.range); }

  friend Enclosure exp(const Enclosure& a) {
    const Interval at = exp(Interval(a.mid));
    return a.function(exp(a.range), at, at, Interval(0.5) * exp(a.with_mid()));
  }
  friend Enclosure log(const Enclosure& a) {
    const Interval c = a.mid, x = a.with_mid();
    return a.function(log(a.range), log(c), Interval(1) / c, Interval(-0.5) / (x * x));
  }
  friend Enclosure sinh(const Enclosure& a) {
    const Interval c = a.mid;
    return a.function(sinh(a.range), sinh(c), cosh(c), Interval(0.5) * sinh(a.with_mid()));
  }
  friend Enclosure cosh(const Enclosure& a) {
    const Interval c = a.mid;
    return a.function(cosh(a.range), cosh(c), sinh(c), Interval(0.5) * cosh(a.with_mid()));
  }
  friend Enclosure tanh(const Enclosure& a) {
    const Interval at = tanh(Interval(a.mid)), t = tanh(a.with_mid());
    return a.function(tanh(a.range), at, Interval(1) - at * at, -(t * (Interval(1) - t * t)));
  }
};

// The predicates on which formulas branch: see scalar.h. The enclosure of NaN is infinite.
inline bool all_zero(const Enclosure& x) {
  return x.is_zero();
}
inline bool all_finite(const Enclosure& x) {
  return isfinite(x);
}
inline bool all_numbers(const Enclosure&) {
  return true;
}
template <int N>
bool all_zero(const Dual<Enclosure, N>& x) {
  return all_zero(x.value);
}
template <int N>
bool all_finite(const Dual<Enclosure, N>& x) {
  return all_finite(x.value);
}
template <int N>
bool all_numbers(const Dual<Enclosure, N>&) {
  return true;
}

// For a tile within a span, the span of its lower end.
inline double span_place(const Enclosure& x) {
  return x.range.lo;
}
template <int N>
double span_place(const Dual<Enclosure, N>& x) {
  return x.value.range.lo;
}

template <int N>
Dual<Enclosure, N> select(const Truth& condition, const Dual<Enclosure, N>& a, const Dual<Enclosure, N>& b) {
  Dual<Enclosure, N> result(select(condition, a.value, b.value));
  for (std::size_t k = 0; k < N; ++k)
    result.derivative[k] = select(condition, a.derivative[k], b.derivative[k]);
  return result;
}

}  // namespace darboux::tiles

template <>
struct darboux::Scalar<darboux::tiles::Enclosure> {
  using Enclosure = tiles::Enclosure;
  static Enclosure pi() { return tiles::Interval::rounded(std::numbers::pi, std::numbers::pi); }
  static Enclosure lift(double x) { return {x}; }
  static Turn<Enclosure> sincos_turns(const Enclosure& u) { return of_period(u, 1); }
  static Turn<Enclosure> sincos_half_turns(const Enclosure& v) { return of_period(v, 2); }

 private:
  static Turn<Enclosure> of_period(const Enclosure& x, double period) {
    using tiles::Interval;
    const Interval omega = pi().range * Interval(2 / period), minus_half = Interval(-0.5) * omega * omega;
    const Turn<Interval> all = tiles::of_period(x.range, period), at = tiles::of_period(x.mid, period),
                         curve = tiles::of_period(x.with_mid(), period);
    return {x.function(all.sin, at.sin, omega * at.cos, minus_half * curve.sin),
            x.function(all.cos, at.cos, -(omega * at.sin), minus_half * curve.cos)};
  }
};
