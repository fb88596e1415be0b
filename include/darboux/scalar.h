/// \file scalar.h
/// The operations that a formula may require of its number type: constants at its own precision, sine and
/// cosine of turns with exact range reduction, and dual numbers. A formula itself uses + - * /, sqrt and the
/// functions of elementary.h.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include <darboux/binary.h>
#include <darboux/elementary.h>

namespace darboux {

/// An angle, represented by its sine and cosine.
template <class S>
struct Turn {
  S sin{}, cos{};
};

/// Customisation point for number types. The primary template serves any real type with + - * /, comparisons
/// and floor, sin, cos, acos found by argument-dependent lookup (long double, boost::multiprecision numbers);
/// float, double, Dual and ceres::Jet (ceres_jet.h) are specialised.
template <class S>
struct Scalar {
  /// π, correct to the last digit of S.
  static const S& pi() {
    using std::acos;
    static const S value = acos(S(-1));
    return value;
  }
  static S lift(double x) { return S(x); }
  /// sin 2πu, cos 2πu, the period removed exactly.
  static Turn<S> sincos_turns(const S& u) {
    using std::floor;
    return sincos_quarters(S(4) * (u - floor(u + S(0.5))));
  }
  /// sin πv, cos πv, the period removed exactly.
  static Turn<S> sincos_half_turns(const S& v) {
    using std::floor;
    return sincos_quarters(S(2) * (v - S(2) * floor(v / S(2) + S(0.5))));
  }

 private:
  // sin, cos of (π/2) x for |x| <= 2: the nearest quarter turn is taken off exactly.
  static Turn<S> sincos_quarters(const S& x) {
    using std::cos, std::floor, std::sin;
    const S nearest = floor(x + S(0.5));
    if (!(nearest == nearest)) return {nearest, nearest};  // NaN
    const S angle = pi() * ((x - nearest) / S(2));
    const S s = sin(angle), c = cos(angle);
    switch (static_cast<int>(nearest) & 3) {
      case 0:
        return {s, c};
      case 1:
        return {c, S(0) - s};
      case 2:
        return {S(0) - s, S(0) - c};
      default:
        return {S(0) - c, s};
    }
  }
};

namespace detail {

// Polynomials for sin and cos of (π/2) r, |r| <= 1/2, z = r²:
//   sin = r (HI + (LO + z S(z))), cos = 1 + z C(z)
// Minimax in the relative error, coefficients rounded to the format (sollya's fpminimax); approximation error
// 3.7e-18 and 3.9e-19 in double, 1.1e-10 and 5.2e-10 in float.
template <class T>
struct QuarterTurn;

template <>
struct QuarterTurn<double> {
  static constexpr double hi = 0x1.921fb54442d18p0, lo = 0x1.1a62633145c07p-54;
  static constexpr std::array<double, 6> sin{-0x1.4abbce625be46p-1,  0x1.466bc67758c6ap-4,
                                             -0x1.32d2cce31fa29p-8,  0x1.5078300841253p-13,
                                             -0x1.e3009539b8239p-19, 0x1.e3fe157a20439p-25};
  static constexpr std::array<double, 7> cos{
      -0x1.3bd3cc9be45dep0,   0x1.03c1f081b5a67p-2,  -0x1.55d3c7e3c325cp-6, 0x1.e1f5067b90e22p-11,
      -0x1.a6d1e7297d362p-16, 0x1.f9c89cce8e2d6p-22, -0x1.b1673f09c707fp-28};
};

template <>
struct QuarterTurn<float> {
  static constexpr float hi = 0x1.921fb6p0f, lo = -0x1.777a5cp-25f;
  static constexpr std::array<float, 4> sin{-0x1.4abbcep-1f, 0x1.466b84p-4f, -0x1.32b5ap-8f, 0x1.46c086p-13f};
  static constexpr std::array<float, 4> cos{-0x1.3bd3ccp0f, 0x1.03c1b8p-2f, -0x1.55b7cep-6f, 0x1.d684aap-11f};
};

// sin, cos of (π/2) x for |x| < 2^51 (2^22 in float), without a branch.
template <Binary S>
constexpr Turn<S> sincos_quarters(const S& x) {
  using Q = QuarterTurn<Element<S>>;
  using Bits = decltype(to_bits(x));
  const S magic(Format<Element<S>>::magic), shifted = opaque(S(x + magic));
  const Bits quadrant = to_bits(shifted);
  const S r = x - (shifted - magic), z = r * r;
  const S s = r * S(Q::hi) + r * (horner(Q::sin, z) * z + S(Q::lo));
  const S c = horner(Q::cos, z) * z + S(1);
  const Bits s_bits = to_bits(s), c_bits = to_bits(c), one(1), two(2);
  const Bits swap = (s_bits ^ c_bits) & (Bits(0) - (quadrant & one));
  constexpr int sign_shift = 8 * sizeof(Element<S>) - 2;
  // + 0 turns the -0 of a quarter turn into +0.
  return {from_bits<S>(Bits(s_bits ^ swap ^ ((quadrant & two) << sign_shift))) + S(0),
          from_bits<S>(Bits(c_bits ^ swap ^ (((quadrant + one) & two) << sign_shift))) + S(0)};
}

template <Binary S>
struct HardwareScalar {
  using T = Element<S>;
  static constexpr S pi() { return S(std::numbers::pi_v<T>); }
  static constexpr S lift(double x) { return S(static_cast<T>(x)); }
  static Turn<S> sincos_turns(const S& u) { return of_quarters(u, T(4), T(1)); }
  static Turn<S> sincos_half_turns(const S& v) { return of_quarters(v, T(2), T(2)); }

 private:
  // Of quarters · x quarter turns; beyond the range that sincos_quarters takes the period is removed first.
  static Turn<S> of_quarters(const S& x, T quarters, T period) {
    using std::abs;
    if (abs(x) < S(Format<T>::most_turns)) return sincos_quarters(S(S(quarters) * x));
    if constexpr (Lanewise<S>) {
      S::diverge();
      return {x, x};
    } else {
      return sincos_quarters(quarters * (x - period * nearest_integer(x / period)));
    }
  }
};

}  // namespace detail

template <>
struct Scalar<double> : detail::HardwareScalar<double> {};
template <>
struct Scalar<float> : detail::HardwareScalar<float> {};

/// x as an S: the identity, or a constant (derivative zero) where S is a dual number over the type of x.
template <class S, class T>
S lift(const T& x) {
  if constexpr (std::same_as<S, T>)
    return x;
  else if constexpr (std::floating_point<T> && std::floating_point<S>)
    return static_cast<S>(x);
  else if constexpr (std::floating_point<T> && !std::same_as<T, long double>)
    return Scalar<S>::lift(static_cast<double>(x));
  else if constexpr (requires(const S& s) {
                       Scalar<S>::value(s);
                     })  // a constant of the dual number's own scalar
    return S(lift<std::remove_cvref_t<decltype(Scalar<S>::value(std::declval<const S&>()))>>(x));
  else
    return S(x);
}

namespace detail {

// Predicates on which a formula branches: whether a number is zero, finite, not NaN. SIMD scalars provide
// their own, true if they hold for all lanes.
template <class S>
bool all_zero(const S& x) {
  return !(x < lift<S>(0.0)) && !(lift<S>(0.0) < x);
}
template <class S>
bool all_finite(const S& x) {
  return x - x == lift<S>(0.0);
}
template <class S>
bool all_numbers(const S& x) {
  return x < lift<S>(1.0) || lift<S>(0.0) < x;
}

}  // namespace detail

/// sin 2πu and cos 2πu. The period is removed exactly before any multiplication by π. So u and u + k give
/// the same bits wherever u + k is exact; quarter turns give exactly 0 and ±1; zeros are +0. Error: at most
/// 1.65 ulp in double and float for every finite u. NaN if u is not finite. Cost: about 4 ns.
template <class S>
Turn<S> sincos_turns(const S& u) {
  return Scalar<S>::sincos_turns(u);
}

/// sin πv and cos πv, with the properties of sincos_turns; the period is 2.
template <class S>
Turn<S> sincos_half_turns(const S& v) {
  return Scalar<S>::sincos_half_turns(v);
}

/// π at the precision of S.
template <class S>
S pi() {
  return Scalar<S>::pi();
}

/// 2π at the precision of S.
template <class S>
S two_pi() {
  return lift<S>(2.0) * Scalar<S>::pi();
}

/// A dual number: a value and its first derivatives with respect to N variables, propagated through + - * /,
/// sqrt, exp, log, sinh, cosh, tanh, pow and abs by the rules of differentiation. Comparisons compare the
/// values only. Nest it (Dual<Dual<double, 2>, 2>) for second derivatives.
template <class T, int N>
struct Dual {
  T value{};
  std::array<T, N> derivative{};

  constexpr Dual() = default;
  /// A constant.
  constexpr explicit(false) Dual(const T& constant)  // NOLINT: clang-tidy 14 does not know explicit(false)
      : value(constant), derivative{} {
    derivative.fill(lift<T>(0.0));
  }
  /// A constant of an arithmetic type, also where T is a dual number itself: 0.5 * exp(x).
  template <class A>
  requires(std::is_arithmetic_v<A> && !std::same_as<A, T>) constexpr explicit(false)
      Dual(A constant)  // NOLINT: as above
      : Dual(lift<T>(constant)) {}
  constexpr Dual(const T& v, const std::array<T, N>& d) : value(v), derivative(d) {}
  /// The k-th variable at x.
  static constexpr Dual variable(const T& x, int k) {
    Dual result(x);
    result.derivative[k] = lift<T>(1.0);
    return result;
  }

  // value v, derivative a·x' + b·y'
  static constexpr Dual chain(const T& v, const T& a, const Dual& x, const T& b, const Dual& y) {
    Dual result(v);
    for (int k = 0; k < N; ++k) result.derivative[k] = a * x.derivative[k] + b * y.derivative[k];
    return result;
  }
  static constexpr Dual chain(const T& v, const T& a, const Dual& x) {
    Dual result(v);
    for (int k = 0; k < N; ++k) result.derivative[k] = a * x.derivative[k];
    return result;
  }

  friend constexpr Dual operator+(const Dual& x, const Dual& y) {
    Dual result(x.value + y.value);
    for (int k = 0; k < N; ++k) result.derivative[k] = x.derivative[k] + y.derivative[k];
    return result;
  }
  friend constexpr Dual operator-(const Dual& x, const Dual& y) {
    Dual result(x.value - y.value);
    for (int k = 0; k < N; ++k) result.derivative[k] = x.derivative[k] - y.derivative[k];
    return result;
  }
  friend constexpr Dual operator-(const Dual& x) {
    Dual result(-x.value);
    for (int k = 0; k < N; ++k) result.derivative[k] = -x.derivative[k];
    return result;
  }
  friend constexpr Dual operator*(const Dual& x, const Dual& y) {
    return chain(x.value * y.value, y.value, x, x.value, y);
  }
  friend constexpr Dual operator/(const Dual& x, const Dual& y) {
    const T quotient = x.value / y.value, inverse = lift<T>(1.0) / y.value;
    return chain(quotient, inverse, x, -quotient * inverse, y);
  }
  friend Dual sqrt(const Dual& x) {
    using std::sqrt;
    const T root = sqrt(x.value);
    return chain(root, lift<T>(0.5) / root, x);
  }
  friend Dual exp(const Dual& x) {
    const T value = exp(x.value);
    return chain(value, value, x);
  }
  friend Dual log(const Dual& x) { return chain(log(x.value), lift<T>(1.0) / x.value, x); }
  friend Dual sinh(const Dual& x) { return chain(sinh(x.value), cosh(x.value), x); }
  friend Dual cosh(const Dual& x) { return chain(cosh(x.value), sinh(x.value), x); }
  friend Dual tanh(const Dual& x) {
    using std::abs;
    const T size = abs(x.value), c = cosh(x.value), decay = exp(-size);
    // From 80 on 1/cosh² is 4 exp(-2|x|) to 69 digits; cosh would overflow, and have no derivatives.
    return chain(tanh(x.value),
                 select(size < lift<T>(80.0), T(lift<T>(1.0) / c / c), T(lift<T>(4.0) * decay * decay)), x);
  }
  /// x to a constant power, x >= 0; its derivative for x > 0 only.
  friend Dual pow(const Dual& x, const Dual& constant) {
    const T value = pow(x.value, constant.value);
    return chain(value, constant.value * pow(x.value, constant.value - lift<T>(1.0)), x);
  }
  friend Dual abs(const Dual& x) { return select(x.value < lift<T>(0.0), Dual(-x), x); }
  friend bool isfinite(const Dual& x) {
    using std::isfinite;
    return isfinite(x.value);
  }
  friend constexpr auto operator<(const Dual& x, const Dual& y) { return x.value < y.value; }
  friend constexpr auto operator>(const Dual& x, const Dual& y) { return x.value > y.value; }
  friend constexpr auto operator<=(const Dual& x, const Dual& y) { return x.value <= y.value; }
  friend constexpr auto operator>=(const Dual& x, const Dual& y) { return x.value >= y.value; }
  friend constexpr auto operator==(const Dual& x, const Dual& y) { return x.value == y.value; }
};

namespace detail {

// Sine and cosine on any dual-like type D over T: (s, c)' = (ω c, -ω s) x'.
template <class D, class T, class Chain>
Turn<D> sincos_dual(const Turn<T>& angle, const T& omega, Chain chain) {
  return {chain(angle.sin, omega * angle.cos), chain(angle.cos, -(omega * angle.sin))};
}

}  // namespace detail

template <class T, int N>
struct Scalar<Dual<T, N>> {
  using D = Dual<T, N>;
  static const T& value(const D& x) { return x.value; }
  static D pi() { return D(darboux::pi<T>()); }
  static D lift(double x) { return D(darboux::lift<T>(x)); }
  static Turn<D> sincos_turns(const D& u) { return sincos(Scalar<T>::sincos_turns(u.value), two_pi<T>(), u); }
  static Turn<D> sincos_half_turns(const D& v) {
    return sincos(Scalar<T>::sincos_half_turns(v.value), darboux::pi<T>(), v);
  }

 private:
  static Turn<D> sincos(const Turn<T>& angle, const T& omega, const D& x) {
    return detail::sincos_dual<D>(angle, omega,
                                  [&](const T& v, const T& slope) { return D::chain(v, slope, x); });
  }
};

}  // namespace darboux
