// exp, log, cosh, sinh, tanh, pow of double and float against 50 digits: stated ulps, special values.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/elementary.h>

#include "multiprecision.h"
#include "random.h"
#include "thinning.h"

namespace darboux::test::elementary_test {
namespace {

using Mp50 = BoostDigits<50>;

template <class T>
using Limits = std::numeric_limits<T>;

const int points = 4'000 / thinning();

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) { std::cout << "seed " << seed << '\n'; }
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  // 2^x with x uniform.
  double log_uniform(double from_exponent, double to_exponent) {
    return std::exp2(uniform(from_exponent, to_exponent));
  }
  double sign() { return engine_() % 2 == 0 ? 1 : -1; }

 private:
  std::mt19937_64 engine_;
};

// |computed - exact| in units in the last place of T at the exact value, which below the normal numbers are
// those of the smallest. An overflow is right where the exact value rounds to one.
template <class T, class Exact>
double ulps(T computed, const Exact& exact) {
  using std::abs, std::ilogb, std::ldexp;
  if (computed != computed || exact != exact) return computed != computed && exact != exact ? 0 : HUGE_VAL;
  const Exact above = ldexp(Exact(1), Limits<T>::max_exponent);  // the next number if there were one
  if (abs(exact) >= above || abs(computed) > Limits<T>::max()) {
    const bool infinite = abs(computed) > Limits<T>::max();
    const Exact got = infinite ? above : Exact(abs(computed));
    const Exact wanted = infinite && abs(exact) > above ? above : Exact(abs(exact));
    const bool same_sign = (computed < 0) == (exact < 0);
    return same_sign ? static_cast<double>(Exact(abs(got - wanted) / (above * Limits<T>::epsilon() / 2)))
                     : HUGE_VAL;
  }
  if (exact == 0) return computed == 0 ? 0 : HUGE_VAL;
  const int exponent = std::max(static_cast<int>(ilogb(exact)), Limits<T>::min_exponent - 1);
  return static_cast<double>(
      Exact(abs(Exact(computed) - exact) / ldexp(Exact(1), exponent + 1 - Limits<T>::digits)));
}

// What a function of one variable shall do.
template <class T>
struct Law {
  std::string name;
  std::function<T(T)> function;
  std::function<Mp50(const Mp50&)> exact;
  std::function<double(double)> wide;  // for the truth of a float
  double bound;
  double first, last;  // beyond these it is constant or infinite
};

// Of 50 digits 38 are left at the least, and below 1e-12 two terms of the series give as many.
Mp50 exact_sinh(const Mp50& x) {
  return abs(x) < Mp50("1e-12") ? Mp50(x + x * x * x / 6) : Mp50((exp(x) - exp(-x)) / 2);
}
Mp50 exact_tanh(const Mp50& x) {
  return exact_sinh(x) / ((exp(x) + exp(-x)) / 2);
}

template <class T>
std::vector<Law<T>> laws() {
  const double top = std::is_same_v<T, float> ? 105 : 750;
  return {
      {"exp", [](T x) { return exp(x); }, [](const Mp50& x) { return Mp50(exp(x)); },
       [](double x) { return std::exp(x); }, 0.95, -top, top},
      {"log", [](T x) { return log(x); }, [](const Mp50& x) { return Mp50(log(x)); },
       [](double x) { return std::log(x); }, 0.95, 0, Limits<T>::max()},
      {"cosh", [](T x) { return cosh(x); }, [](const Mp50& x) { return Mp50((exp(x) + exp(-x)) / 2); },
       [](double x) { return std::cosh(x); }, 1.5, -top, top},
      {"sinh", [](T x) { return sinh(x); }, exact_sinh, [](double x) { return std::sinh(x); }, 1.75, -top,
       top},
      {"tanh", [](T x) { return tanh(x); }, exact_tanh, [](double x) { return std::tanh(x); }, 1.6, -22, 22},
  };
}

template <class T>
class ElementaryOf : public ::testing::Test {};
using Types = ::testing::Types<double, float>;
TYPED_TEST_SUITE(ElementaryOf, Types);

TYPED_TEST(ElementaryOf, FunctionsErrByAtMostTheStatedUlps) {
  using T = TypeParam;
  Random random(1);
  const double smallest = Limits<T>::min_exponent - Limits<T>::digits, largest = Limits<T>::max_exponent;
  for (const Law<T>& law : laws<T>()) {
    const double sign = law.first < 0 ? 1 : 0;
    const std::array<std::function<double()>, 5> draws{
        [&] { return random.uniform(law.first, law.last); }, [&] { return random.uniform(sign * -2, 2); },
        // where sums and differences cancel, and next to 1 for log
        [&] { return (sign == 0 ? 1 : 0) + random.sign() * random.log_uniform(smallest, -1); },
        [&] { return random.log_uniform(smallest, largest); },
        [&] { return (sign == 0 ? 1 : -1) * random.log_uniform(-20, std::log2(law.last)); }};
    for (std::size_t d = 0; d < draws.size(); ++d) {
      double worst = 0;
      T worst_at = 0;
      for (int i = 0; i < points; ++i) {
        const T x = static_cast<T>(draws[d]());
        if (x == 0 && sign == 0) continue;  // the special value of log
        // The oracle is spared what overflows it.
        const double error =
            ulps(law.function(x), law.exact(Mp50(std::clamp<double>(x, 2 * law.first, 2 * law.last))));
        if (!(error <= worst)) worst = error, worst_at = x;
      }
      std::cout << law.name << ", draw " << d << ": " << worst << " ulp at " << worst_at << '\n';
      EXPECT_LE(worst, law.bound) << law.name << " at " << worst_at;
    }
  }
}

// Every 4099th float, against double.
TEST(Elementary, FloatsOfEveryMagnitudeErrByAtMostTheStatedUlps) {
  for (const Law<float>& law : laws<float>()) {
    double worst = 0;
    float worst_at = 0;
    for (std::uint64_t bits = 0; bits < std::uint64_t{1} << 32; bits += 4099) {
      const float x = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      const double error = ulps(law.function(x), law.wide(x));
      if (!(error <= worst)) worst = error, worst_at = x;
    }
    std::cout << law.name << ": " << worst << " ulp at " << worst_at << '\n';
    EXPECT_LE(worst, law.bound) << law.name << " at " << worst_at;
  }
}

TYPED_TEST(ElementaryOf, PowErrsByAtMostTheStatedUlps) {
  using T = TypeParam;
  Random random(2);
  const double smallest = Limits<T>::min_exponent - Limits<T>::digits, largest = Limits<T>::max_exponent;
  const double most = 1.05 * Limits<T>::max_exponent * std::log(2.0);
  const std::array<std::function<double()>, 4> bases{
      [&] { return random.uniform(0, 2); }, [&] { return random.uniform(0.7, 1.42); },
      [&] { return random.log_uniform(smallest, largest); },
      [&] { return 1 + random.sign() * random.log_uniform(1 - Limits<T>::digits, -2); }};
  // e itself, or e log x.
  const std::array<std::function<double(double)>, 3> exponents{
      [&](double) { return random.uniform(-3, 3); },
      [&](double x) { return random.uniform(-most, most) / std::log(x); },
      [&](double x) { return random.sign() * random.log_uniform(-70, 10) / std::log(x); }};
  for (std::size_t b = 0; b < bases.size(); ++b)
    for (std::size_t k = 0; k < exponents.size(); ++k) {
      double worst = 0, worst_ulps = 0;
      T worst_x = 0, worst_e = 0;
      for (int i = 0; i < points; ++i) {
        const T x = static_cast<T>(bases[b]()), e = static_cast<T>(exponents[k](x));
        if (x == 0 || x == 1 || !(std::abs(e) <= Limits<T>::max())) continue;
        const Mp50 power = Mp50(e) * log(Mp50(x));
        const double size = std::min<double>(static_cast<double>(abs(power)), 2 * most);
        const double error = ulps(pow(x, e), Mp50(exp(std::clamp(power, Mp50(-2 * most), Mp50(2 * most)))));
        worst_ulps = std::max(worst_ulps, error);
        if (!(error / (2 + size / 50) <= worst)) worst = error / (2 + size / 50), worst_x = x, worst_e = e;
      }
      std::cout << "base " << b << ", exponent " << k << ": " << worst_ulps << " ulp, " << worst
                << " of the bound at " << worst_x << ", " << worst_e << '\n';
      EXPECT_LE(worst, 1) << worst_x << " to the " << worst_e;
    }
}

// NaN equals NaN, and +0 is not -0.
template <class T>
bool same(T a, T b) {
  return (a != a && b != b) || (a == b && std::signbit(a) == std::signbit(b));
}

TYPED_TEST(ElementaryOf, SpecialValuesAreThoseOfTheStandardLibrary) {
  using T = TypeParam;
  constexpr T inf = Limits<T>::infinity(), nan = Limits<T>::quiet_NaN(), tiny = Limits<T>::denorm_min();
  for (const T x :
       {T(0), T(-0.0), T(1), inf, -inf, nan, tiny, -tiny, Limits<T>::max(), Limits<T>::lowest()}) {
    if (x != 1) {
      EXPECT_TRUE(same(exp(x), std::exp(x))) << x;
      EXPECT_TRUE(same(cosh(x), std::cosh(x))) << x;
      EXPECT_TRUE(same(sinh(x), std::sinh(x))) << x;
      EXPECT_TRUE(same(tanh(x), std::tanh(x))) << x;
    }
    const bool round = std::abs(x) != tiny && x != Limits<T>::max();  // powers of it are exact
    EXPECT_TRUE(!round || same(log(x), std::log(x))) << x;
    for (const T e : {T(0), T(-0.0), T(0.5), T(1), T(-2), inf, -inf, nan, tiny, -tiny, Limits<T>::max(),
                      Limits<T>::lowest()}) {
      // A negative x is refused, and -0 taken for 0.
      const T standard = x < 0 ? (e == 0 ? T(1) : nan) : std::pow(std::abs(x), e);
      EXPECT_TRUE(same(pow(x, e), standard) || ulps(pow(x, e), standard) <= (round ? 0 : 20))
          << x << ' ' << e;
    }
  }
  EXPECT_EQ(exp(T(0)), 1);
  EXPECT_EQ(cosh(T(0)), 1);
  EXPECT_TRUE(same(log(T(1)), T(0)));
  EXPECT_EQ(log(T(0)), -inf);
  EXPECT_TRUE(std::isnan(log(-tiny)));
  EXPECT_EQ(tanh(T(23)), 1);
  EXPECT_EQ(tanh(T(-23)), -1);
  for (const T x : {T(2), T(0.25), Limits<T>::min(), Limits<T>::max(), tiny}) {
    EXPECT_EQ(pow(x, T(1)), x);
    EXPECT_EQ(pow(T(1), x), 1);
  }
}

// Within an ulp of where exp and its kin overflow, and become subnormal, and 0.
TYPED_TEST(ElementaryOf, OverflowAndUnderflowWhereTheirValuesDo) {
  using T = TypeParam;
  const T overflow = static_cast<T>(log(Mp50(Limits<T>::max())));
  const T normal = static_cast<T>(log(Mp50(Limits<T>::min())));
  const T zero = static_cast<T>(log(Mp50(Limits<T>::denorm_min()) / 2));
  const T ordinary = detail::Elementary<T>::ordinary;
  for (const T start : {overflow, normal, zero, ordinary, T(-ordinary), T(overflow + std::log(T(2)))}) {
    T x = start;
    for (int i = 0; i < 8; ++i) x = std::nextafter(x, -Limits<T>::infinity());
    for (int i = 0; i < 16; ++i, x = std::nextafter(x, Limits<T>::infinity())) {
      EXPECT_LE(ulps(exp(x), Mp50(exp(Mp50(x)))), 0.95) << x;
      EXPECT_LE(ulps(cosh(x), Mp50((exp(Mp50(x)) + exp(Mp50(-x))) / 2)), 1.5) << x;
      EXPECT_LE(ulps(sinh(x), exact_sinh(Mp50(x))), 1.75) << x;
    }
  }
}

TYPED_TEST(ElementaryOf, SinhAndTanhAreOddAndCoshIsEven) {
  using T = TypeParam;
  Random random(3);
  for (int i = 0; i < points; ++i) {
    const T x = static_cast<T>(random.log_uniform(-30, 10));
    EXPECT_TRUE(same(sinh(T(-x)), T(-sinh(x)))) << x;
    EXPECT_TRUE(same(tanh(T(-x)), T(-tanh(x)))) << x;
    EXPECT_TRUE(same(cosh(T(-x)), cosh(x))) << x;
  }
}

}  // namespace
}  // namespace darboux::test::elementary_test
