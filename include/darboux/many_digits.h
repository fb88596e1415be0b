/// \file many_digits.h
/// A number of 40 decimal digits: the oracle against which double is measured.
#pragma once

#include <cstddef>

#include <darboux/scalar.h>

namespace darboux {

/// A real number of 40 decimal digits with exponents far beyond double's, usable wherever a formula takes a scalar.
/// Arithmetic and sqrt are correctly rounded, the other functions err by a few units of the 39th digit. About 0.1 µs an
/// operation, 5 µs a sine. Nothing of the implementation shows: boost::multiprecision's cpp_bin_float inside.
class ManyDigits {
 public:
  ManyDigits();
  ManyDigits(double x);  // NOLINT: every double is such a number
  ManyDigits(const ManyDigits& x);
  ManyDigits& operator=(const ManyDigits& x);
  ~ManyDigits() = default;

  explicit operator double() const;
  explicit operator long double() const;
  explicit operator float() const { return static_cast<float>(static_cast<double>(*this)); }

  friend ManyDigits operator+(const ManyDigits& a, const ManyDigits& b);
  friend ManyDigits operator-(const ManyDigits& a, const ManyDigits& b);
  friend ManyDigits operator*(const ManyDigits& a, const ManyDigits& b);
  friend ManyDigits operator/(const ManyDigits& a, const ManyDigits& b);
  friend ManyDigits operator-(const ManyDigits& a);
  friend bool operator==(const ManyDigits& a, const ManyDigits& b);
  friend bool operator<(const ManyDigits& a, const ManyDigits& b);
  friend bool operator>(const ManyDigits& a, const ManyDigits& b) { return b < a; }
  friend bool operator<=(const ManyDigits& a, const ManyDigits& b);
  friend bool operator>=(const ManyDigits& a, const ManyDigits& b) { return b <= a; }
  friend ManyDigits sqrt(const ManyDigits& a);
  friend ManyDigits exp(const ManyDigits& a);
  friend ManyDigits log(const ManyDigits& a);
  friend ManyDigits sinh(const ManyDigits& a);
  friend ManyDigits cosh(const ManyDigits& a);
  friend ManyDigits tanh(const ManyDigits& a);
  friend ManyDigits pow(const ManyDigits& a, const ManyDigits& b);
  friend ManyDigits abs(const ManyDigits& a);
  friend bool isfinite(const ManyDigits& a);
  /// sin πx, cos πx, the period removed exactly; relative to 1e-39 also near the zeros.
  friend Turn<ManyDigits> sincos_pi(const ManyDigits& x);
  static const ManyDigits& pi();

 private:
  struct Access;
  alignas(16) std::byte storage_[64];
};

Turn<ManyDigits> sincos_pi(const ManyDigits& x);

template <>
struct Scalar<ManyDigits> {
  static const ManyDigits& pi() { return ManyDigits::pi(); }
  static ManyDigits lift(double x) { return x; }
  static Turn<ManyDigits> sincos_turns(const ManyDigits& u) { return sincos_pi(ManyDigits(2.0) * u); }
  static Turn<ManyDigits> sincos_half_turns(const ManyDigits& v) { return sincos_pi(v); }
};

}  // namespace darboux
