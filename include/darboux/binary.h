/// \file binary.h
/// Operations common to float, double and SIMD lanes of them: access to the bits, rounding to integers, and
/// lane-wise selection.
#pragma once

#if __cplusplus < 202002L
#error "Darboux needs C++20, got an older standard: compile with -std=c++20"
#include <darboux_needs_cxx20>  // ends the compilation here
#endif

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// With options that let the compiler reorder sums or assume that NaN does not occur, frames would be wrong
// although their status is regular. Clang never defines __ASSOCIATIVE_MATH__: see opaque().
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "darboux: expected no -ffast-math nor part of it, which breaks exact range reduction"
#endif

namespace darboux {

/// condition ? a : b, lane by lane. Both a and b are evaluated, since the lanes of a SIMD batch may differ in
/// the condition.
template <class S>
constexpr S select(bool condition, const S& a, const S& b) {
  return condition ? a : b;
}

namespace detail {

// A number type with several lanes, used by the batch kernels. Its Element is float or double. diverge()
// passes a batch whose lanes need different treatment to the functions for single points.
template <class S>
concept Lanewise = requires {
  typename S::Element;
  S::lanes;
};
// A binary floating-point number, or lanes of them.
template <class S>
concept Binary = std::floating_point<S> || Lanewise<S>;

template <class S>
struct ElementOf {
  using type = S;
};
template <Lanewise S>
struct ElementOf<S> {
  using type = typename S::Element;
};
template <class S>
using Element = typename ElementOf<S>::type;

template <class S>
constexpr auto to_bits(const S& x) {
  if constexpr (Lanewise<S>)
    return x.bits();
  else if constexpr (sizeof(S) == 8)
    return std::bit_cast<std::uint64_t>(x);
  else
    return std::bit_cast<std::uint32_t>(x);
}
template <class S, class Bits>
constexpr S from_bits(const Bits& bits) {
  if constexpr (Lanewise<S>)
    return S::from_bits(bits);
  else
    return std::bit_cast<S>(bits);
}

// Returns x, hidden from the optimiser. So (x + magic) - magic is evaluated as written even if clang is told
// to reassociate sums, which no macro reveals. No effect with other compilers.
template <class S>
constexpr S opaque(S x) {
#if defined(__clang__) && (defined(__x86_64__) || defined(__aarch64__))
  if constexpr (std::same_as<S, float> || std::same_as<S, double>)
    if (!std::is_constant_evaluated()) {
#if defined(__x86_64__)
      asm("" : "+x"(x));
#else
      asm("" : "+w"(x));
#endif
    }
#endif
  return x;
}

// x + magic rounds an |x| < half_range to an integer, which is left in the low bits; half_range / 4 turns
// have fewer quarters than that.
template <class T>
struct Format;
template <>
struct Format<double> {
  static constexpr double magic = 0x1.8p52, half_range = 0x1p51, most_turns = 0x1p49;
};
template <>
struct Format<float> {
  static constexpr float magic = 0x1.8p23f, half_range = 0x1p22f, most_turns = 0x1p20f;
};

// The integer nearest to x (ties to even), for any finite x.
template <std::floating_point T>
T nearest_integer(T x) {
  using F = Format<T>;
  return std::abs(x) < F::half_range ? opaque(x + F::magic) - F::magic : std::nearbyint(x);
}

template <class S, class T, std::size_t N>
constexpr S horner(const std::array<T, N>& coefficients, const S& z) {
  S sum(coefficients[N - 1]);
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * z + S(coefficients[i]);
  return sum;
}

}  // namespace detail

}  // namespace darboux
