/// \file formula_run.h
/// Evaluates the instructions of a formula for any scalar type: float, double, dual numbers for the partials,
/// multiprecision numbers.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <vector>

#include <darboux/scalar.h>

#include "formula.h"

namespace darboux::io::formula {

template <class S>
constexpr bool is_dual = requires(const S& x) {
  x.derivative;
};

template <class S>
double to_double(const S& x) {
  if constexpr (is_dual<S>)
    return to_double(x.value);
  else
    return static_cast<double>(x);
}

template <class S>
Turn<S> sine_cosine(const S& x) {
  if constexpr (is_dual<S>) {
    const auto a = sine_cosine(x.value);
    return {S::chain(a.sin, a.cos, x), S::chain(a.cos, -a.sin, x)};
  } else if constexpr (std::floating_point<S>) {
    return {std::sin(x), std::cos(x)};
  } else {
    return sincos_half_turns(S(x / pi<S>()));
  }
}

template <class S>
S arctangent(const S& y, const S& x) {
  if constexpr (is_dual<S>) {
    const auto square = x.value * x.value + y.value * y.value;
    return S::chain(arctangent(y.value, x.value), x.value / square, y, -(y.value / square), x);
  } else if constexpr (std::floating_point<S>) {
    return std::atan2(y, x);
  } else {
    // The remaining angle is below 1e-15 in double: its tangent and one more term give it to 1e-75.
    const S coarse(std::atan2(to_double(y), to_double(x)));
    const auto [s, c] = sine_cosine(coarse);
    const S t = (y * c - x * s) / (x * c + y * s);
    return coarse + (t - t * t * t / S(3.0));
  }
}

// Wide real numbers lack inverse hyperbolic functions.
template <class S>
S inverse_hyperbolic(Function f, const S& x) {
  const S one = lift<S>(1.0);
  if constexpr (is_dual<S>) {
    const auto v = x.value;
    const auto i = lift<std::remove_cvref_t<decltype(v)>>(1.0);
    using std::sqrt;
    const auto slope = f == Function::asinh   ? i / sqrt(v * v + i)
                       : f == Function::acosh ? i / (sqrt(v - i) * sqrt(v + i))
                                              : i / ((i - v) * (i + v));
    return S::chain(inverse_hyperbolic(f, v), slope, x);
  } else if constexpr (std::floating_point<S>) {
    return f == Function::asinh ? std::asinh(x) : f == Function::acosh ? std::acosh(x) : std::atanh(x);
  } else if (f == Function::asinh) {
    const S a = abs(x), r = log(a + sqrt(a * a + one));
    return x < S(0.0) ? -r : r;
  } else if (f == Function::acosh) {
    return log(x + sqrt(x - one) * sqrt(x + one));
  } else {
    return log((one + x) / (one - x)) / S(2.0);
  }
}

template <class S>
S whole_power(S x, int n) {
  const S one = lift<S>(1.0);
  if (n < 0) return one / whole_power(x, -n);
  S result = one;
  for (bool first = true; n > 0; n /= 2) {
    if (n % 2 == 1) {
      result = first ? x : result * x;
      first = false;
    }
    if (n > 1) x = x * x;
  }
  return result;
}

// \param constant whether the exponent depends on neither u nor v
template <class S>
S power(const S& base, const S& exponent, bool constant) {
  if (constant) {
    const double n = to_double(exponent);
    constexpr double largest = 1024;
    if (std::fabs(n) <= largest && n == std::nearbyint(n) && (exponent == lift<S>(n) || base < lift<S>(0.0)))
      return whole_power(base, static_cast<int>(n));
  }
  if constexpr (is_dual<S>) {
    const auto &a = base.value, &b = exponent.value;
    using T = std::remove_cvref_t<decltype(a)>;
    using std::log;
    const T value = power(a, b, constant), slope = b * power(a, T(b - lift<T>(1.0)), constant);
    return constant ? S::chain(value, slope, base) : S::chain(value, slope, base, value * log(a), exponent);
  } else {
    using std::pow;
    return pow(base, exponent);
  }
}

template <class S>
S apply(Function f, const S& x) {
  using std::sqrt, std::exp, std::log, std::sinh, std::cosh, std::tanh, std::abs;
  const S zero = lift<S>(0.0), one = lift<S>(1.0);
  switch (f) {
    case Function::minus:
      return -x;
    case Function::sin:
      return sine_cosine(x).sin;
    case Function::cos:
      return sine_cosine(x).cos;
    case Function::tan: {
      const Turn<S> a = sine_cosine(x);
      return a.sin / a.cos;
    }
    case Function::asin:
      return arctangent(x, S(sqrt((one - x) * (one + x))));
    case Function::acos:
      return arctangent(S(sqrt((one - x) * (one + x))), x);
    case Function::atan:
      return arctangent(x, one);
    case Function::sinh:
      return sinh(x);
    case Function::cosh:
      return cosh(x);
    case Function::tanh:
      return tanh(x);
    case Function::asinh:
    case Function::acosh:
    case Function::atanh:
      return inverse_hyperbolic(f, x);
    case Function::sqrt:
      return sqrt(x);
    case Function::exp:
      return exp(x);
    case Function::log:
      return log(x);
    case Function::abs:
      return abs(x);
    case Function::sign:
      return x < zero ? -one : zero < x ? one : S(zero * x);  // NaN stays
    case Function::sin_turns:
      return sincos_turns(x).sin;
    case Function::cos_turns:
      return sincos_turns(x).cos;
    default:
      return x;  // plus
  }
}

/// The value of an expression. The caller provides the stack, so that its memory is reused.
template <class S>
S execute(const std::vector<Instruction>& code, const std::vector<S>& variables, std::vector<S>& stack) {
  const S zero = lift<S>(0.0), one = lift<S>(1.0);
  stack.clear();
  const auto combine = [&](auto f) {
    const S y = stack.back();
    stack.pop_back();
    stack.back() = f(stack.back(), y);
  };
  const auto decide = [&](auto f) { combine([&](const S& x, const S& y) { return f(x, y) ? one : zero; }); };
  for (std::size_t at = 0; at < code.size(); ++at) {
    const Instruction& i = code[at];
    switch (i.operation) {
      case Operation::number:
        stack.push_back(lift<S>(i.number));
        break;
      case Operation::variable:
        stack.push_back(variables[static_cast<std::size_t>(i.index)]);
        break;
      case Operation::add:
        combine([](const S& x, const S& y) -> S { return x + y; });
        break;
      case Operation::subtract:
        combine([](const S& x, const S& y) -> S { return x - y; });
        break;
      case Operation::multiply:
        combine([](const S& x, const S& y) -> S { return x * y; });
        break;
      case Operation::divide:
        combine([](const S& x, const S& y) -> S { return x / y; });
        break;
      case Operation::power:
        combine([&](const S& x, const S& y) { return power(x, y, i.index != 0); });
        break;
      case Operation::less:
        decide([](const S& x, const S& y) { return x < y; });
        break;
      case Operation::greater:
        decide([](const S& x, const S& y) { return y < x; });
        break;
      case Operation::not_greater:
        decide([](const S& x, const S& y) { return x <= y; });
        break;
      case Operation::not_less:
        decide([](const S& x, const S& y) { return y <= x; });
        break;
      case Operation::equal:
        decide([](const S& x, const S& y) { return x == y; });
        break;
      case Operation::unequal:
        decide([](const S& x, const S& y) { return !(x == y); });
        break;
      case Operation::both:
        decide([&](const S& x, const S& y) { return !(x == zero) && !(y == zero); });
        break;
      case Operation::either:
        decide([&](const S& x, const S& y) { return !(x == zero) || !(y == zero); });
        break;
      case Operation::call1:
        stack.back() = apply(i.function, S(stack.back()));
        break;
      case Operation::call2:
        combine([&](const S& x, const S& y) -> S {
          switch (i.function) {
            case Function::atan2:
              return arctangent(x, y);
            case Function::pow:
              return power(x, y, i.index != 0);
            case Function::min:
              return y < x || !(y == y) ? y : x;  // NaN stays
            default:
              return x < y || !(y == y) ? y : x;
          }
        });
        break;
      case Operation::jump_if_zero: {
        const bool jump = stack.back() == zero;
        stack.pop_back();
        if (jump) at += static_cast<std::size_t>(i.index);
        break;
      }
      case Operation::jump:
        at += static_cast<std::size_t>(i.index);
        break;
      case Operation::none:
        break;
    }
  }
  return stack.back();
}

}  // namespace darboux::io::formula
