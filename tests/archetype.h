// The poorest scalar a formula may assume: + - * / and sqrt, made from double only on request. No comparison,
// no conversion, no sine. What compiles with it needs nothing more. Archetype<true> adds an ordering, for the
// frame of the torus, which must tell its inner part (R + r cos 2πv < 0).
#pragma once

#include <cmath>

#include <darboux/scalar.h>

namespace darboux::test {

template <bool ordered = false>
class Archetype {
 public:
  Archetype() = default;
  explicit Archetype(double value) : value_(value) {}
  double value() const { return value_; }

  friend Archetype operator+(Archetype a, Archetype b) { return Archetype(a.value_ + b.value_); }
  friend Archetype operator-(Archetype a, Archetype b) { return Archetype(a.value_ - b.value_); }
  friend Archetype operator*(Archetype a, Archetype b) { return Archetype(a.value_ * b.value_); }
  friend Archetype operator/(Archetype a, Archetype b) { return Archetype(a.value_ / b.value_); }
  friend Archetype operator-(Archetype a) { return Archetype(-a.value_); }
  friend Archetype sqrt(Archetype a) { return Archetype(std::sqrt(a.value_)); }
  friend bool operator<(Archetype a, Archetype b) requires ordered { return a.value_ < b.value_; }

 private:
  double value_ = 0;
};

}  // namespace darboux::test

namespace darboux {

template <bool ordered>
struct Scalar<test::Archetype<ordered>> {
  using A = test::Archetype<ordered>;
  static A pi() { return A(Scalar<double>::pi()); }
  static A lift(double x) { return A(x); }
};

}  // namespace darboux
