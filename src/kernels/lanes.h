/// \file lanes.h
/// The lanes of a SIMD register as a number type, so that the formulas of the surfaces run over them as they stand. Each
/// operation is that of the scalar, lane by lane: no fma, no reciprocal estimate, so that every instruction set gives the
/// same bits. All of it has internal linkage: what is compiled for one instruction set must never be linked for another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <xsimd/xsimd.hpp>

#include <darboux/scalar.h>

namespace darboux::kernels {
namespace {

// Set where the lanes of a batch disagree about a condition that decides more than a value: the batch is then left to the
// single-point functions.
// Found without a call: the model that libraries loaded late may use too, for so little.
[[gnu::tls_model("initial-exec")]] thread_local bool diverged = false;

template <class T>
using Register = xsimd::batch<T>;

/// One truth value a lane. As a bool it is that of all lanes; where they differ the batch diverges.
template <class T>
class Mask {
 public:
  using Bool = xsimd::batch_bool<T>;
  Mask(const Bool& b) : bool_(b) {}  // NOLINT: converting
  const Bool& lanes() const { return bool_; }

  operator bool() const {  // NOLINT: converting
    if (!xsimd::any(bool_)) return false;
    if (!xsimd::all(bool_)) diverged = true;
    return true;
  }
  friend Mask operator&&(const Mask& a, const Mask& b) { return a.bool_ && b.bool_; }
  friend Mask operator||(const Mask& a, const Mask& b) { return a.bool_ || b.bool_; }
  friend Mask operator!(const Mask& a) { return !a.bool_; }

 private:
  Bool bool_;
};

/// The bits of floating-point lanes: unsigned integers of their size.
template <class U>
class LaneBits {
 public:
  using Batch = xsimd::batch<U>;
  LaneBits(const Batch& b) : bits_(b) {}  // NOLINT: converting
  LaneBits(U x) : bits_(x) {}             // NOLINT: converting
  const Batch& lanes() const { return bits_; }

  friend LaneBits operator+(const LaneBits& a, const LaneBits& b) { return a.bits_ + b.bits_; }
  friend LaneBits operator-(const LaneBits& a, const LaneBits& b) { return a.bits_ - b.bits_; }
  friend LaneBits operator&(const LaneBits& a, const LaneBits& b) { return a.bits_ & b.bits_; }
  friend LaneBits operator|(const LaneBits& a, const LaneBits& b) { return a.bits_ | b.bits_; }
  friend LaneBits operator^(const LaneBits& a, const LaneBits& b) { return a.bits_ ^ b.bits_; }
  friend LaneBits operator<<(const LaneBits& a, int n) { return a.bits_ << n; }
  friend LaneBits operator>>(const LaneBits& a, int n) { return a.bits_ >> n; }

 private:
  Batch bits_;
};

/// A number a lane.
template <class T>
class Lanes {
 public:
  using Element = T;
  using Bits = LaneBits<std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>>;
  static constexpr std::size_t lanes = Register<T>::size;

  Lanes() : value_(T(0)) {}
  Lanes(T x) : value_(x) {}                   // NOLINT: converting
  Lanes(const Register<T>& x) : value_(x) {}  // NOLINT: converting
  static Lanes load(const T* from) { return Register<T>::load_unaligned(from); }
  void store(T* to) const { value_.store_unaligned(to); }
  const Register<T>& value() const { return value_; }

  Bits bits() const { return xsimd::bitwise_cast<typename Bits::Batch>(value_); }
  static Lanes from_bits(const Bits& b) { return xsimd::bitwise_cast<Register<T>>(b.lanes()); }

  /// Leaves this batch to the single-point functions.
  static void diverge() { diverged = true; }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return a.value_ + b.value_; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return a.value_ - b.value_; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return a.value_ * b.value_; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return a.value_ / b.value_; }
  friend Lanes operator-(const Lanes& a) { return from_bits(a.bits() ^ Bits(sign_bit)); }
  friend Lanes sqrt(const Lanes& a) { return xsimd::sqrt(a.value_); }
  friend Lanes abs(const Lanes& a) { return from_bits(a.bits() & Bits(sign_bit - 1)); }

  friend Mask<T> operator<(const Lanes& a, const Lanes& b) { return a.value_ < b.value_; }
  friend Mask<T> operator>(const Lanes& a, const Lanes& b) { return b.value_ < a.value_; }
  friend Mask<T> operator<=(const Lanes& a, const Lanes& b) { return a.value_ <= b.value_; }
  friend Mask<T> operator>=(const Lanes& a, const Lanes& b) { return b.value_ <= a.value_; }
  friend Mask<T> operator==(const Lanes& a, const Lanes& b) { return a.value_ == b.value_; }
  friend Mask<T> operator!=(const Lanes& a, const Lanes& b) { return !Mask<T>(a.value_ == b.value_); }

  /// condition ? a : b, lane by lane.
  friend Lanes select(const Mask<T>& condition, const Lanes& a, const Lanes& b) {
    return xsimd::select(condition.lanes(), a.value_, b.value_);
  }

 private:
  using Word = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  static constexpr Word sign_bit = Word{1} << (8 * sizeof(T) - 1);
  Register<T> value_;
};

}  // namespace
}  // namespace darboux::kernels

namespace darboux {

template <class T>
struct Scalar<kernels::Lanes<T>> : detail::HardwareScalar<kernels::Lanes<T>> {};

}  // namespace darboux
