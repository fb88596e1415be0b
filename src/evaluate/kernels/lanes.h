/// \file lanes.h
/// The lanes of a SIMD register as a number type, so that the formulas of the surfaces run over them as they
/// stand. Each operation is that of the scalar, lane by lane: no fma, no reciprocal estimate, so that every
/// instruction set gives the same bits. All of it has internal linkage: what is compiled for one instruction
/// set must never be linked for another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <xsimd/xsimd.hpp>

#include <darboux/elementary.h>
#include <darboux/scalar.h>

#include "base/flatten.h"

namespace darboux::kernels {
namespace {

// Set if the lanes of a batch disagree about a condition that decides more than a value: the batch is then
// left to the single-point functions. This TLS model needs no function call; libraries that are loaded late
// may also use it for such a small variable.
[[gnu::tls_model("initial-exec")]] thread_local bool diverged = false;

template <class T>
using Register = xsimd::batch<T>;

/// N registers.
template <class R, std::size_t N>
struct Several {
  R at[N];
};
/// f of each of them.
template <std::size_t N, class F>
auto each(const F& f) {
  Several<decltype(f(std::size_t{})), N> result;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < N; ++i) result.at[i] = f(i);
  return result;
}

/// One truth value per lane. As a bool it is that of all lanes; where they differ, the batch diverges.
template <class T, std::size_t N = 1>
class Mask {
 public:
  using Registers = Several<xsimd::batch_bool<T>, N>;
  Mask(const Registers& x) : value_(x) {}  // NOLINT: converting
  const Registers& value() const { return value_; }

  bool all() const {
    xsimd::batch_bool<T> together = value_.at[0];
    for (std::size_t i = 1; i < N; ++i) together = together && value_.at[i];
    return xsimd::all(together);
  }
  bool any() const {
    xsimd::batch_bool<T> together = value_.at[0];
    for (std::size_t i = 1; i < N; ++i) together = together || value_.at[i];
    return xsimd::any(together);
  }
  operator bool() const {  // NOLINT: converting
    if (!any()) return false;
    if (!all()) diverged = true;
    return true;
  }
  friend Mask operator&&(const Mask& a, const Mask& b) {
    return each<N>([&](std::size_t i) { return a.value_.at[i] && b.value_.at[i]; });
  }
  friend Mask operator||(const Mask& a, const Mask& b) {
    return each<N>([&](std::size_t i) { return a.value_.at[i] || b.value_.at[i]; });
  }
  friend Mask operator!(const Mask& a) {
    return each<N>([&](std::size_t i) { return !a.value_.at[i]; });
  }

 private:
  Registers value_;
};

/// The bits of floating-point lanes: unsigned integers of their size.
template <class U, std::size_t N>
class LaneBits {
 public:
  using Registers = Several<xsimd::batch<U>, N>;
  LaneBits(const Registers& x) : value_(x) {}                                          // NOLINT: converting
  LaneBits(U x) : value_(each<N>([x](std::size_t) { return xsimd::batch<U>(x); })) {}  // NOLINT: converting
  const Registers& value() const { return value_; }

#define DARBOUX_OPERATOR(op)                                                         \
  friend LaneBits operator op(const LaneBits& a, const LaneBits& b) {                \
    return each<N>([&](std::size_t i) { return a.value_.at[i] op b.value_.at[i]; }); \
  }
  DARBOUX_OPERATOR(+)
  DARBOUX_OPERATOR(-)
  DARBOUX_OPERATOR(&)
  DARBOUX_OPERATOR(|)
  DARBOUX_OPERATOR(^)
#undef DARBOUX_OPERATOR
  friend LaneBits operator<<(const LaneBits& a, int n) {
    return each<N>([&](std::size_t i) { return a.value_.at[i] << n; });
  }
  friend LaneBits operator>>(const LaneBits& a, int n) {
    return each<N>([&](std::size_t i) { return a.value_.at[i] >> n; });
  }

 private:
  Registers value_;
};

/// One number per lane, in N registers: several where chains of operations are long, so that the processor
/// can work on N of them at a time.
template <class T, std::size_t N = 1>
class Lanes {
 public:
  using Element = T;
  using Word = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  using Bits = LaneBits<Word, N>;
  using Registers = Several<Register<T>, N>;
  static constexpr std::size_t lanes = N * Register<T>::size;

  Lanes() = default;                                                            // no value
  Lanes(T x) : value_(each<N>([x](std::size_t) { return Register<T>(x); })) {}  // NOLINT: converting
  Lanes(const Registers& x) : value_(x) {}                                      // NOLINT: converting
  static Lanes load(const T* from) {
    return each<N>(
        [from](std::size_t i) { return Register<T>::load_unaligned(from + i * Register<T>::size); });
  }
  void store(T* to) const {
#pragma GCC unroll 8
    for (std::size_t i = 0; i < N; ++i) value_.at[i].store_unaligned(to + i * Register<T>::size);
  }
  const Registers& value() const {
    return value_;
  }

  Bits bits() const {
    return each<N>([&](std::size_t i) { return xsimd::bitwise_cast<xsimd::batch<Word>>(value_.at[i]); });
  }
  static Lanes from_bits(const Bits& b) {
    return each<N>([&](std::size_t i) { return xsimd::bitwise_cast<Register<T>>(b.value().at[i]); });
  }

  /// Leaves this batch to the single-point functions.
  static void diverge() {
    diverged = true;
  }

#define DARBOUX_OPERATOR(type, op)                                                   \
  friend type operator op(const Lanes& a, const Lanes& b) {                          \
    return each<N>([&](std::size_t i) { return a.value_.at[i] op b.value_.at[i]; }); \
  }
  DARBOUX_OPERATOR(Lanes, +)
  DARBOUX_OPERATOR(Lanes, -)
  DARBOUX_OPERATOR(Lanes, *)
  DARBOUX_OPERATOR(Lanes, /)
  using Truth = Mask<T, N>;
  DARBOUX_OPERATOR(Truth, <)
  DARBOUX_OPERATOR(Truth, <=)
  DARBOUX_OPERATOR(Truth, ==)
#undef DARBOUX_OPERATOR
  friend Truth operator>(const Lanes& a, const Lanes& b) {
    return b < a;
  }
  friend Truth operator>=(const Lanes& a, const Lanes& b) {
    return b <= a;
  }
  friend Truth operator!=(const Lanes& a, const Lanes& b) {
    return !(a == b);
  }
  friend Lanes operator-(const Lanes& a) {
    return from_bits(a.bits() ^ Bits(sign_bit));
  }
  friend Lanes sqrt(const Lanes& a) {
    return each<N>([&](std::size_t i) { return xsimd::sqrt(a.value_.at[i]); });
  }
  friend Lanes abs(const Lanes& a) {
    return from_bits(a.bits() & Bits(sign_bit - 1));
  }

  /// condition ? a : b, lane by lane.
  friend Lanes select(const Truth& condition, const Lanes& a, const Lanes& b) {
    return each<N>([&](std::size_t i) {
      return xsimd::select(condition.value().at[i], a.value_.at[i], b.value_.at[i]);
    });
  }

 private:
  static constexpr Word sign_bit = Word{1} << (8 * sizeof(T) - 1);
  Registers value_;
};

// A function of its own: a formula of twenty powers then holds one, not twenty, and compiles in a third of
// the time. Not on AVX-512, where calls spill what its 32 registers hold, and cost a tenth of the speed.
template <class T, std::size_t N>
requires(sizeof(Register<T>) < 64) DARBOUX_FLATTEN
    [[gnu::noinline]] Lanes<T, N> pow(const Lanes<T, N>& x, const Lanes<T, N>& e) {
  return darboux::pow<Lanes<T, N>>(x, e);
}

}  // namespace
}  // namespace darboux::kernels

namespace darboux {

template <class T, std::size_t N>
struct Scalar<kernels::Lanes<T, N>> : detail::HardwareScalar<kernels::Lanes<T, N>> {};

}  // namespace darboux
