/// \file elementary.h
/// exp, log, sinh, cosh, tanh and pow for float, double and SIMD lanes of them. They use only + - * / and bit
/// operations, so lanes and single numbers give the same bits on any machine. Formulas call them unqualified,
/// so that dual numbers and multiprecision numbers can provide their own.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include <darboux/binary.h>

namespace darboux {

namespace detail {

// Coefficients below are minimax (sollya's fpminimax), rounded to the format.

// ln 2 = ln2_high + ln2_low, where k ln2_high is exact for the exponents k of the format.
//
// cosh r = 1 + z C(z) and sinh r = r + r z S(z), z = r², for |r| <= ln 2 / 2: approximation error 3.6e-18
// absolute and 2.7e-19 relative in double, 1.0e-10 and 5.3e-11 in float.
//
// log((1 + s) / (1 - s)) = 2 s + s z (L0 + z L(z)), z = s², for |s| <= 3 - √8: relative error 9.0e-21 in
// double, 2.9e-11 in float.
//
// tanh x = x + x z P(z) / Q(z), z = x², for |x| <= (ln 3) / 2: relative error 6.8e-19 in double, 3.5e-9 in
// float.
//
// Where |x| < ordinary, exp(x) and 2^±n / 2 are normal numbers, n the integer nearest to x / ln 2. Beyond
// ±extreme exp has overflowed or is 0, and so has or is x^±most_power of any x but 1.
template <class T>
struct Elementary;

template <>
struct Elementary<double> {
  static constexpr double inverse_ln2 = 0x1.71547652b82fep0;
  static constexpr double ln2_high = 0x1.62e42fefa38p-1, ln2_low = 0x1.ef35793c7673p-45;
  static constexpr double ordinary = 708, extreme = 760, most_power = 0x1p64;
  static constexpr std::array<double, 5> cosh{0x1.000000000000cp-1, 0x1.555555554fdfdp-5,
                                              0x1.6c16c1860a63dp-10, 0x1.a01995aef14f3p-16,
                                              0x1.28b103a7191e1p-22};
  static constexpr std::array<double, 5> sinh{0x1.5555555555559p-3, 0x1.111111110f64dp-7,
                                              0x1.a01a01b0084bep-13, 0x1.71ddf800c3f69p-19,
                                              0x1.af5f48a901a78p-26};
  static constexpr double sqrt_half = 0x1.6a09e667f3bcdp-1;
  static constexpr double log_first = 0x1.5555555555555p-1;
  static constexpr std::array<double, 7> log{0x1.9999999999d0dp-2, 0x1.2492492439e6bp-2, 0x1.c71c724ae7019p-3,
                                             0x1.745ce1f078ac5p-3, 0x1.3b201debb5c8dp-3, 0x1.0f67d30280089p-3,
                                             0x1.0f08f574106bep-3};
  static constexpr double tanh_split = 0x1.193ea7aad030ap-1, tanh_one = 20;
  static constexpr std::array<double, 3> tanh_p{-0x1.5555555555555p-2, -0x1.4fe792b0cfe4dp-6,
                                                -0x1.a200c64637e59p-13};
  static constexpr std::array<double, 4> tanh_q{1, 0x1.d895051ac092fp-2, 0x1.7dacc15a9f7d2p-6,
                                                0x1.b17339a0530a5p-13};
};

template <>
struct Elementary<float> {
  static constexpr float inverse_ln2 = 0x1.715476p0f;
  static constexpr float ln2_high = 0x1.62e4p-1f, ln2_low = 0x1.7f7d1cp-20f;
  static constexpr float ordinary = 86, extreme = 120, most_power = 0x1p32f;
  static constexpr std::array<float, 3> cosh{0x1p-1f, 0x1.5554e4p-5f, 0x1.6d5156p-10f};
  static constexpr std::array<float, 3> sinh{0x1.555556p-3f, 0x1.110fe2p-7f, 0x1.a28f3ap-13f};
  static constexpr float sqrt_half = 0x1.6a09e6p-1f;
  static constexpr float log_first = 0x1.555554p-1f;
  static constexpr std::array<float, 3> log{0x1.999bd2p-2f, 0x1.23f24ep-2f, 0x1.ec01b6p-3f};
  static constexpr float tanh_split = 0x1.193ea8p-1f, tanh_one = 10;
  static constexpr std::array<float, 2> tanh_p{-0x1.555556p-2f, -0x1.98b2eap-10f};
  static constexpr std::array<float, 2> tanh_q{1, 0x1.9e62cap-2f};
};

template <class S>
constexpr int fraction_bits = std::numeric_limits<Element<S>>::digits - 1;

// x with the sign of s, for x >= 0.
template <Binary S>
S with_sign_of(const S& s, const S& x) {
  return from_bits<S>((to_bits(s) & to_bits(S(Element<S>(-0.0)))) | to_bits(x));
}

// exp(x + x_low) = 2^n (cosh r + sinh r), r = high - low the remainder of x + x_low by ln 2, in the terms
// that are added up last: cosh r = 1 + even, sinh r = high + odd. For |x| <= extreme.
template <Binary S>
struct ExpTerms {
  using F = Elementary<Element<S>>;
  S shifted, n;
  S high, even, odd;

  explicit ExpTerms(const S& x, const S& x_low = S(0)) {
    const S magic(Format<Element<S>>::magic);
    shifted = opaque(S(x * S(F::inverse_ln2) + magic));
    n = shifted - magic;
    high = x - n * S(F::ln2_high);
    const S low = n * S(F::ln2_low) - x_low, r = high - low, z = r * r;
    even = z * horner(F::cosh, z);
    odd = (r * z) * horner(F::sinh, z) - low;
  }
  // exp(r), within 0.9 ulp.
  S exp_remainder() const { return S(1) + (high + (even + odd)); }
  // 2^n times a power of two p, and p / 2^n.
  S scale_up(const S& p) const { return from_bits<S>(to_bits(p) + (to_bits(shifted) << fraction_bits<S>)); }
  S scale_down(const S& p) const { return from_bits<S>(to_bits(p) - (to_bits(shifted) << fraction_bits<S>)); }
};

// 2^k exp(x + x_low) of any x, rounded once more where it is subnormal.
template <std::floating_point S>
S extreme_exp(const S& x, const S& x_low, int k) {
  constexpr S extreme = Elementary<S>::extreme;
  if (!(x == x)) return x;
  const bool inside = -extreme < x && x < extreme;
  const ExpTerms<S> e = inside ? ExpTerms<S>(x, x_low) : ExpTerms<S>(x < 0 ? -extreme : extreme);
  return std::scalbn(e.exp_remainder(), static_cast<int>(e.n) + k);
}

// x = 2^k (1 + f) with 1 + f in [√½, √2), both exact; x > 0 and normal.
template <Binary S>
struct Exponent {
  S k, f;
  explicit Exponent(const S& x) {
    using T = Element<S>;
    using F = Elementary<T>;
    // The exponent of x / √½, plus that of 2 so that it is no negative number.
    constexpr T units = T(std::uint64_t{1} << fraction_bits<S>),
                bias = T(std::numeric_limits<T>::max_exponent);
    const auto bits = to_bits(x), two = to_bits(S(T(2)));
    const auto biased = ((bits - to_bits(S(F::sqrt_half))) + two) >> fraction_bits<S>;
    k = from_bits<S>(biased + to_bits(S(units))) - S(units + bias);
    f = from_bits<S>((bits - (biased << fraction_bits<S>)) + two) - S(T(1));
  }
};

// Multiplies a subnormal x > 0 by the 2^k that makes it a normal number; k, which is 0 for a normal x.
template <std::floating_point S>
S lift_subnormal(S& x) {
  if (x >= std::numeric_limits<S>::min()) return S(0);
  constexpr int k = fraction_bits<S> + 2;
  x *= S(std::uint64_t{1} << k);
  return S(k);
}

template <Binary S>
auto is_positive_and_normal(const S& x) {
  using Limits = std::numeric_limits<Element<S>>;
  return S(Limits::min()) <= x && x <= S(Limits::max());
}

// The sum of a number and a much smaller one.
template <class S>
struct HighLow {
  S high, low;
};

// a b exactly, by splitting. [Dekker1971]
template <Binary S>
HighLow<S> exact_product(const S& a, const S& b) {
  using T = Element<S>;
  const S splitter(T((std::uint64_t{1} << ((std::numeric_limits<T>::digits + 1) / 2)) + 1));
  const S ca = splitter * a, cb = splitter * b, ah = ca - (ca - a), bh = cb - (cb - b), al = a - ah,
          bl = b - bh;
  const S product = a * b;
  return {product, ((ah * bh - product) + ah * bl + al * bh) + al * bl};
}

// log(2^k (1 + f)), relative error at most 2^-53 / 50 in double and 2^-24 / 50 in float: of the series in
// s = f / (2 + f) the first term is taken to twice the digits, and of the second, 1% of it, only s z and the
// product with L0 are rounded. Searched: 2^-53 / 70 and 2^-24 / 68.
template <Binary S>
HighLow<S> accurate_log(const S& k, const S& f) {
  using T = Element<S>;
  using F = Elementary<T>;
  const S one(T(1)), two(T(2));
  const S d = two + f, d_low = f - (d - two), inverse = one / d, s = f * inverse;
  const HighLow<S> sd = exact_product(s, d), z = exact_product(s, s);
  const S s_low = (((f - sd.high) - sd.low) - s * d_low) * inverse;
  // Greatest first; each sum but the last leaves its rounding error.
  const S a = k * S(F::ln2_high), b = s + s, cube = s * z.high, c = cube * S(F::log_first);
  const S ab = a + b, abc = ab + c;
  const S tail = cube * (z.high * horner(F::log, z.high)) + (s * z.low) * S(F::log_first);
  const S low =
      ((b - (ab - a)) + (c - (abc - ab))) + (((s_low + s_low) * (one + z.high) + k * S(F::ln2_low)) + tail);
  const S high = abc + low;
  return {high, low - (high - abc)};
}

}  // namespace detail

/// e^x for any x, within 0.95 ulp in double and float; infinity, 0 or subnormal where the correct result is.
/// About 35 operations.
template <detail::Binary S>
S exp(const S& x) {
  using std::abs;
  if (!(abs(x) < S(detail::Elementary<detail::Element<S>>::ordinary))) {
    if constexpr (detail::Lanewise<S>)
      S::diverge();
    else
      return detail::extreme_exp(x, S(0), 0);
  }
  const detail::ExpTerms<S> e(x);
  return e.exp_remainder() * e.scale_up(S(1));
}

/// The natural logarithm of any x: within 0.95 ulp in double and float, also near 1; -inf for 0, NaN for x <
/// 0. A division and about 40 operations.
template <detail::Binary S>
S log(const S& x) {
  using F = detail::Elementary<detail::Element<S>>;
  S normal = x, subnormal_k(0);
  if (!detail::is_positive_and_normal(x)) {
    if constexpr (detail::Lanewise<S>) {
      S::diverge();
    } else {
      using Limits = std::numeric_limits<S>;
      if (!(x >= 0)) return Limits::quiet_NaN();
      if (x == 0) return -Limits::infinity();
      if (x > Limits::max()) return x;
      subnormal_k = detail::lift_subnormal(normal);
    }
  }
  const detail::Exponent<S> e(normal);
  const S k = e.k - subnormal_k, f = e.f, half_square = S(detail::Element<S>(0.5)) * f * f;
  const S s = f / (S(2) + f), z = s * s;
  // log(1 + f) = f - f²/2 + s (f²/2 + z (L0 + z L(z))), for s (2 + f) = f
  return k * S(F::ln2_high) -
         ((half_square -
           (s * (half_square + z * (z * detail::horner(F::log, z) + S(F::log_first))) + k * S(F::ln2_low))) -
          f);
}

/// cosh x = (e^x + e^-x) / 2 for any x, within 1.5 ulp in double and float; overflows where its value does.
/// About 45 operations.
template <detail::Binary S>
S cosh(const S& x) {
  using std::abs;
  const S size = abs(x);
  if (!(size < S(detail::Elementary<detail::Element<S>>::ordinary))) {
    if constexpr (detail::Lanewise<S>)
      S::diverge();
    else
      return detail::extreme_exp(size, S(0), -1);
  }
  const detail::ExpTerms<S> e(size);
  const S half(detail::Element<S>(0.5)), up = e.scale_up(half), down = e.scale_down(half);
  const S c = up + down, s = up - down;  // cosh and sinh of n ln 2
  return c + ((c * e.even + s * (e.high + e.odd)) + (down - (c - up)));
}

/// sinh x = (e^x - e^-x) / 2 for any x, within 1.75 ulp in double and float, also next to 0; overflows where
/// its value does. Odd to the last bit. About 45 operations.
template <detail::Binary S>
S sinh(const S& x) {
  using std::abs;
  if (!(abs(x) < S(detail::Elementary<detail::Element<S>>::ordinary))) {
    if constexpr (detail::Lanewise<S>)
      S::diverge();
    else
      return detail::with_sign_of(x, detail::extreme_exp(S(abs(x)), S(0), -1));
  }
  const detail::ExpTerms<S> e(x);
  const S half(detail::Element<S>(0.5)), up = e.scale_up(half), down = e.scale_down(half);
  const S c = up + down, s = up - down;  // cosh and sinh of n ln 2
  return detail::with_sign_of(x, S(s + (c * e.high + (c * e.odd + s * e.even))));
}

/// tanh x = sinh x / cosh x for any x, within 1.6 ulp in double and float, also next to 0. Odd to the last
/// bit. A division and about 60 operations.
template <detail::Binary S>
S tanh(const S& x) {
  using std::abs;
  using T = detail::Element<S>;
  using F = detail::Elementary<T>;
  const S one(T(1)), top(F::tanh_one), size = abs(x), z = x * x;
  const auto small = size < S(F::tanh_split);
  // Beyond the split 1 - 2 / (e^2x + 1), of which the second term is at most 1/2.
  const S clamped = select(size > top, top, size);
  const detail::ExpTerms<S> e(clamped + clamped);
  const S power = e.exp_remainder() * e.scale_up(one);
  const S numerator = select(small, size * z * detail::horner(F::tanh_p, z), S(T(-2)));
  const S denominator = select(small, detail::horner(F::tanh_q, z), power + one);
  return detail::with_sign_of(x, S(select(small, size, one) + numerator / denominator));
}

/// x^e for x >= 0 and an exponent that is the same in all lanes: within 2 + |e log x| / 50 ulp in double and
/// float; correctly inf, 0 or subnormal at the ends. x^0 = 1 = 1^e, 0^e and inf^e are the limits, NaN for x <
/// 0. A division and about 140 operations.
template <detail::Binary S>
S pow(const S& x, const S& e) {
  using std::abs;
  using F = detail::Elementary<detail::Element<S>>;
  using Limits = std::numeric_limits<detail::Element<S>>;
  const S zero(0), one(1), infinity(Limits::infinity());
  const auto is_zero = x == zero;
  S base = select(is_zero, one, x), subnormal_k(0), exponent = e;
  if (!(detail::is_positive_and_normal(base) && abs(e) < S(F::most_power))) {
    if constexpr (detail::Lanewise<S>) {
      S::diverge();
    } else {
      if (e == 0 || x == 1) return one;
      if (!(x >= 0) || e != e) return Limits::quiet_NaN();
      if (x > Limits::max()) return e > 0 ? infinity : zero;
      subnormal_k = detail::lift_subnormal(base);
      // As good as any larger exponent of that sign, as only 1 itself is closer to 1 than a rounding.
      if (!(abs(e) < F::most_power)) exponent = e < 0 ? -F::most_power : F::most_power;
    }
  }
  const detail::Exponent<S> split(base);
  const detail::HighLow<S> log = detail::accurate_log(S(split.k - subnormal_k), split.f);
  const detail::HighLow<S> product = detail::exact_product(exponent, log.high);
  const S low = product.low + exponent * log.low;
  const S at_zero = select(e > zero, zero, select(e < zero, infinity, one));
  if (!(abs(product.high) < S(F::ordinary))) {
    if constexpr (detail::Lanewise<S>)
      S::diverge();
    else
      return is_zero ? at_zero : detail::extreme_exp(product.high, low, 0);
  }
  const detail::ExpTerms<S> power(product.high, low);
  return select(is_zero, at_zero, S(power.exp_remainder() * power.scale_up(one)));
}

/// The same for long double, by the standard library.
template <detail::Binary S>
requires std::same_as<S, long double> S exp(const S& x) {
  return std::exp(x);
}
template <detail::Binary S>
requires std::same_as<S, long double> S log(const S& x) {
  return std::log(x);
}
template <detail::Binary S>
requires std::same_as<S, long double> S cosh(const S& x) {
  return std::cosh(x);
}
template <detail::Binary S>
requires std::same_as<S, long double> S sinh(const S& x) {
  return std::sinh(x);
}
template <detail::Binary S>
requires std::same_as<S, long double> S tanh(const S& x) {
  return std::tanh(x);
}
template <detail::Binary S>
requires std::same_as<S, long double> S pow(const S& x, const S& e) {
  return std::pow(x, e);
}

}  // namespace darboux
