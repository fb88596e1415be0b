// Interval arithmetic on doubles, as a scalar that the formulas of surfaces run on: every result holds all
// results of the numbers in the operands, rounding included.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <darboux/elementary.h>
#include <darboux/scalar.h>

namespace darboux::tiles {

// What a comparison of intervals leaves open.
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

struct Enclosure {
  double lo = 0, hi = 0;

  constexpr Enclosure() = default;
  constexpr explicit(false) Enclosure(double x)
      : lo(x), hi(x) {}  // NOLINT: clang-tidy 14 does not know explicit(false)
  constexpr Enclosure(double from, double to) : lo(from), hi(to) {}

  // [lo, hi] with the rounding of one operation, or of a function within some of them, twice as much:
  // widening rounds too.
  static Enclosure rounded(double lo, double hi, double roundings = 1) {
    const double share = roundings * 0x1p-51, least = 0x1p-1070;
    if (std::isnan(lo) || std::isnan(hi))
      return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    return {lo - (std::fabs(lo) * share + least), hi + (std::fabs(hi) * share + least)};
  }
  double size() const { return std::fmax(std::fabs(lo), std::fabs(hi)); }

  friend Enclosure operator+(const Enclosure& a, const Enclosure& b) {
    return rounded(a.lo + b.lo, a.hi + b.hi);
  }
  friend Enclosure operator-(const Enclosure& a, const Enclosure& b) {
    return rounded(a.lo - b.hi, a.hi - b.lo);
  }
  friend Enclosure operator-(const Enclosure& a) { return {-a.hi, -a.lo}; }
  friend Enclosure operator*(const Enclosure& a, const Enclosure& b) {
    const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    if (std::isnan(p + q + r + s)) return rounded(std::nan(""), 0);
    return rounded(std::fmin(std::fmin(p, q), std::fmin(r, s)), std::fmax(std::fmax(p, q), std::fmax(r, s)));
  }
  friend Enclosure operator/(const Enclosure& a, const Enclosure& b) {
    if (!(b.lo > 0 || b.hi < 0)) return rounded(std::nan(""), 0);
    const double p = a.lo / b.lo, q = a.lo / b.hi, r = a.hi / b.lo, s = a.hi / b.hi;
    return rounded(std::fmin(std::fmin(p, q), std::fmin(r, s)), std::fmax(std::fmax(p, q), std::fmax(r, s)));
  }
  friend Truth operator<(const Enclosure& a, const Enclosure& b) { return {a.lo < b.hi, a.hi >= b.lo}; }
  friend Truth operator>(const Enclosure& a, const Enclosure& b) { return b < a; }
  friend Truth operator<=(const Enclosure& a, const Enclosure& b) { return !(b < a); }
  friend Truth operator>=(const Enclosure& a, const Enclosure& b) { return !(a < b); }
  friend Truth operator==(const Enclosure& a, const Enclosure& b) {
    return {a.lo <= b.hi && b.lo <= a.hi, !(a.lo == a.hi && b.lo == b.hi && a.lo == b.lo)};
  }
  friend Enclosure hull(const Enclosure& a, const Enclosure& b) {
    return {std::fmin(a.lo, b.lo), std::fmax(a.hi, b.hi)};
  }
  friend Enclosure select(const Truth& condition, const Enclosure& a, const Enclosure& b) {
    if (condition.may_be_true && condition.may_be_false) return hull(a, b);
    return condition.may_be_true ? a : b;
  }
  friend Enclosure abs(const Enclosure& a) {
    if (a.lo >= 0) return a;
    return a.hi <= 0 ? -a : Enclosure{0, a.size()};
  }
  friend Enclosure sqrt(const Enclosure& a) {
    if (!(a.hi >= 0)) return rounded(std::nan(""), 0);
    const Enclosure root = rounded(std::sqrt(std::fmax(a.lo, 0)), std::sqrt(a.hi));
    return {std::fmax(root.lo, 0), root.hi};
  }
  friend bool isfinite(const Enclosure& a) { return std::isfinite(a.lo) && std::isfinite(a.hi); }

  // Monotone functions of elementary.h, whose errors are a few roundings.
  friend Enclosure exp(const Enclosure& a) { return rounded(darboux::exp(a.lo), darboux::exp(a.hi), 8); }
  friend Enclosure log(const Enclosure& a) { return rounded(darboux::log(a.lo), darboux::log(a.hi), 8); }
  friend Enclosure sinh(const Enclosure& a) { return rounded(darboux::sinh(a.lo), darboux::sinh(a.hi), 8); }
  friend Enclosure tanh(const Enclosure& a) { return rounded(darboux::tanh(a.lo), darboux::tanh(a.hi), 8); }
  friend Enclosure cosh(const Enclosure& a) {
    const Enclosure b = abs(a);
    return rounded(darboux::cosh(b.lo), darboux::cosh(b.hi), 8);
  }
};

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
  static Enclosure pi() { return Enclosure::rounded(std::numbers::pi, std::numbers::pi); }
  static Enclosure lift(double x) { return {x}; }
  static Turn<Enclosure> sincos_turns(const Enclosure& u) { return of_period(u, 1); }
  static Turn<Enclosure> sincos_half_turns(const Enclosure& v) { return of_period(v, 2); }

 private:
  // sin and cos of 2πx/period.
  static Turn<Enclosure> of_period(const Enclosure& x, double period) {
    if (!(x.hi - x.lo < period) || !(x.size() < 0x1p40)) return {{-1, 1}, {-1, 1}};
    const auto at = [&](double t) {
      return period == 1 ? darboux::sincos_turns(t) : darboux::sincos_half_turns(t);
    };
    const Turn<double> a = at(x.lo), b = at(x.hi);
    // Whether x holds `first` plus a whole number of periods, widened by what x itself is rounded.
    const auto holds = [&](double first) {
      const double slack = 4 * 0x1p-52 * (x.size() + period);
      return std::floor((x.hi + slack - first * period) / period) >=
             std::ceil((x.lo - slack - first * period) / period);
    };
    const auto range = [&](double p, double q, double top, double bottom) {
      Enclosure r = Enclosure::rounded(std::fmin(p, q), std::fmax(p, q), 4);
      return Enclosure{holds(bottom) ? -1 : std::fmax(r.lo, -1), holds(top) ? 1 : std::fmin(r.hi, 1)};
    };
    return {range(a.sin, b.sin, 0.25, 0.75), range(a.cos, b.cos, 0, 0.5)};
  }
};
