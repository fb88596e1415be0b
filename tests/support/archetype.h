// The poorest scalar a formula may assume: + - * /, sqrt, exp, log, sinh, cosh, tanh, pow, abs and the sine
// and cosine of turns, made from double only on request. No comparison, no conversion. What compiles with it
// needs nothing more. Archetype<true> adds an ordering, for formulas that ask for a side or a knot span.
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
  friend Archetype exp(Archetype a) { return Archetype(darboux::exp(a.value_)); }
  friend Archetype log(Archetype a) { return Archetype(darboux::log(a.value_)); }
  friend Archetype sinh(Archetype a) { return Archetype(darboux::sinh(a.value_)); }
  friend Archetype cosh(Archetype a) { return Archetype(darboux::cosh(a.value_)); }
  friend Archetype tanh(Archetype a) { return Archetype(darboux::tanh(a.value_)); }
  friend Archetype pow(Archetype a, Archetype b) { return Archetype(darboux::pow(a.value_, b.value_)); }
  friend Archetype abs(Archetype a) { return Archetype(std::fabs(a.value_)); }
  friend bool operator<(Archetype a, Archetype b) requires ordered { return a.value_ < b.value_; }
  friend bool operator==(Archetype a, Archetype b) requires ordered { return a.value_ == b.value_; }

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
  static Turn<A> sincos_turns(A u) { return turn(darboux::sincos_turns(u.value())); }
  static Turn<A> sincos_half_turns(A v) { return turn(darboux::sincos_half_turns(v.value())); }
  static Turn<A> turn(const Turn<double>& t) { return {A(t.sin), A(t.cos)}; }
};

}  // namespace darboux
