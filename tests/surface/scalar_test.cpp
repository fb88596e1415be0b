#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#if __has_include(<ceres/jet.h>)
#include <ceres/jet.h>
#endif

#include <darboux/ceres_jet.h>
#include <darboux/scalar.h>

#include "archetype.h"
#include "every_surface.h"
#include "multiprecision.h"
#include "random.h"
#include "thinning.h"

namespace darboux::test::scalar_test {
namespace {

using Mp50 = BoostDigits<50>;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

const int points = 20'000 / thinning();

// |computed - exact| in units in the last place of the exact value.
template <class T>
double ulps(T computed, const Mp50& exact) {
  if (exact == 0) return computed == 0 ? 0 : infinity;
  const Mp50 ulp = ldexp(Mp50(1), ilogb(exact) - (std::numeric_limits<T>::digits - 1));
  return static_cast<double>(abs(Mp50(computed) - exact) / ulp);
}

// sin and cos of 2πx or πx at 50 digits, straight from the definition. At |x| <= 1e15 the angle loses 16 of
// them, and the values there are no smaller than 1e-17: 17 digits more than double has are left.
Turn<Mp50> exact_sincos(const Mp50& x, int pi_multiple) {
  const Mp50 angle = pi_multiple * pi<Mp50>() * x;
  return {sin(angle), cos(angle)};
}

bool same_bits(const Turn<double>& a, const Turn<double>& b) {
  return std::bit_cast<std::array<std::uint64_t, 2>>(a) == std::bit_cast<std::array<std::uint64_t, 2>>(b);
}

struct Range {
  std::string name;
  std::function<double(Random&)> draw;
};
const std::array<Range, 5> ranges{
    {{"random [0, 1)", [](Random& r) { return r.uniform(); }},
     {"near quarter turns",
      [](Random& r) {
        return static_cast<double>(r.bits() % 9) / 4 - 1 + r.sign() * r.log_uniform(1e-17, 1e-3);
      }},
     {"tiny", [](Random& r) { return r.sign() * r.log_uniform(1e-300, 1e-3); }},
     {"random +-1000", [](Random& r) { return r.uniform(-1000, 1000); }},
     {"random +-1e15", [](Random& r) { return r.sign() * r.log_uniform(1e3, 1e15); }}}};

// Derived, in ulp of the sine s of (π/2) r, r in [0, 1/2]: r HI is rounded by 1/2 ulp of its own, which is
// an ulp of s where r HI >= 1/2 > s; the sum by 1/2; the second term, 1/24 of s there, by 1.7 of its own ulps
// = 0.11; the polynomial errs by 0.03. The cosine has less. Searched: 1.6133 in double (6e7 points), 1.60007
// in float (every float in [2^-12, 1/8]).
constexpr double bound = 1.65;

TEST(SincosTurns, DoubleErrsByAtMostTheStatedUlps) {
  Random random(1);
  for (const Range& range : ranges) {
    double worst = 0, worst_half = 0;
    for (int i = 0; i < points; ++i) {
      const double x = range.draw(random);
      const Turn<double> turn = sincos_turns(x), half = sincos_half_turns(x);
      const Turn<Mp50> e = exact_sincos(x, 2), e_half = exact_sincos(x, 1);
      // Exact zeros come out of 50 digits as 1e-34 and less; no double coordinate gives less than 1e-300.
      const auto error = [](double computed, const Mp50& exact) {
        return computed == 0 && abs(exact) < Mp50("1e-30") ? 0 : ulps(computed, exact);
      };
      worst = std::max({worst, error(turn.sin, e.sin), error(turn.cos, e.cos)});
      worst_half = std::max({worst_half, error(half.sin, e_half.sin), error(half.cos, e_half.cos)});
    }
    std::cout << range.name << ": " << worst << " ulp, half turns " << worst_half << " ulp\n";
    EXPECT_LE(worst, bound) << range.name;
    EXPECT_LE(worst_half, bound) << range.name;
  }
}

// In single precision the double result, proven above, is the reference.
TEST(SincosTurns, FloatErrsByAtMostTheStatedUlps) {
  Random random(2);
  for (const Range& range : ranges) {
    double worst = 0;
    for (int i = 0; i < 50 * points; ++i) {
      const float x = static_cast<float>(range.draw(random));
      if (std::fabs(x) < 1e-37F) continue;  // the sine of a denormal float has fewer digits
      const auto error = [](float computed, double exact) {
        if (exact == 0) return computed == 0 ? 0 : infinity;
        return std::fabs(computed - exact) / std::ldexp(1.0, std::ilogb(exact) - 23);
      };
      const Turn<float> turn = sincos_turns(x), half = sincos_half_turns(x);
      const double wide = static_cast<double>(x);
      const Turn<double> e = sincos_turns(wide), e_half = sincos_half_turns(wide);
      worst = std::max({worst, error(turn.sin, e.sin), error(turn.cos, e.cos), error(half.sin, e_half.sin),
                        error(half.cos, e_half.cos)});
    }
    std::cout << range.name << ": " << worst << " ulp\n";
    EXPECT_LE(worst, bound) << range.name;
  }
}

TEST(SincosTurns, WorstKnownPointsStayWithinTheBound) {
  for (const double x : {0x1.50a427a7c7b4ep-4, 0x1.fc67b32af9993p-4}) {
    const Turn<Mp50> exact = exact_sincos(x, 2);
    EXPECT_LE(ulps(sincos_turns(x).sin, exact.sin), bound) << x;
    EXPECT_LE(ulps(sincos_turns(x).cos, exact.cos), bound) << x;
  }
  const float x = 0x1.48b298p-4F;
  EXPECT_LE(ulps(sincos_turns(x).sin, exact_sincos(x, 2).sin), bound);
}

TEST(SincosTurns, QuarterTurnsAreExactAndZerosPositive) {
  constexpr std::array<Turn<double>, 4> quarter{{{0, 1}, {1, 0}, {0, -1}, {-1, 0}}};
  for (int k = -4000; k <= 4000; ++k) {
    const auto& expected = quarter[static_cast<unsigned>(k) % 4];
    EXPECT_TRUE(same_bits(sincos_turns(k / 4.0), expected)) << k << "/4";
    EXPECT_TRUE(same_bits(sincos_half_turns(k / 2.0), expected)) << k << "/2";
    const Turn<float> single = sincos_turns(static_cast<float>(k) / 4);
    EXPECT_TRUE(same_bits({single.sin, single.cos}, expected)) << k << "/4f";
  }
}

TEST(SincosTurns, WholeTurnsLeaveTheBits) {
  Random random(3);
  for (int i = 0; i < 10 * points; ++i) {
    const double u = static_cast<double>(random.bits() >> 34) * 0x1p-30;  // m 2^-30 in [0, 1)
    const double k = std::floor(random.uniform(-0x1p20, 0x1p20));
    ASSERT_TRUE(same_bits(sincos_turns(u), sincos_turns(u + k))) << u << " + " << k;
    ASSERT_TRUE(same_bits(sincos_half_turns(u), sincos_half_turns(u + 2 * k))) << u << " + " << 2 * k;
  }
  EXPECT_TRUE(same_bits(sincos_turns(0.0), sincos_turns(1.0)));
}

TEST(SincosTurns, HugeArgumentsAreReducedExactly) {
  const Turn<double> zero = sincos_turns(0.0), half = sincos_turns(0.5);
  for (const double whole : {-0.0, 5.0, -3.0, 1e15, 0x1p51, 0x1p53, 1e300, 1e308, -1e308})
    EXPECT_TRUE(same_bits(sincos_turns(whole), zero)) << whole;
  for (const double x : {0x1p51 + 0.5, -0x1p51 - 0.5, 1e15 + 0.5})
    EXPECT_TRUE(same_bits(sincos_turns(x), half)) << x;
  EXPECT_TRUE(same_bits(sincos_half_turns(0x1p52 + 1), half));
  EXPECT_TRUE(same_bits(sincos_half_turns(1e308), zero));
}

TEST(SincosTurns, NotFiniteGivesNan) {
  for (const double x : {nan_value, infinity, -infinity})
    for (const Turn<double>& turn : {sincos_turns(x), sincos_half_turns(x)}) {
      EXPECT_TRUE(std::isnan(turn.sin)) << x;
      EXPECT_TRUE(std::isnan(turn.cos)) << x;
    }
  EXPECT_TRUE(std::isnan(sincos_turns(std::numeric_limits<float>::infinity()).sin));
}

TEST(SincosTurns, OddAndEven) {
  Random random(4);
  for (int i = 0; i < points; ++i) {
    const double x = random.uniform(-2, 2);
    const Turn<double> a = sincos_turns(x), b = sincos_turns(-x);
    EXPECT_EQ(a.sin, -b.sin) << x;
    EXPECT_EQ(a.cos, b.cos) << x;
  }
}

// The generic route: long double and many digits.
TEST(GenericScalar, LongDoubleErrsByAFewUlps) {
  Random random(5);
  double worst = 0;
  for (int i = 0; i < points / 4; ++i) {
    const long double x = random.uniform(-3, 3);
    const Turn<long double> turn = sincos_turns(x);
    const Turn<Mp50> exact = exact_sincos(Mp50(x), 2);
    worst = std::max({worst, ulps(turn.sin, exact.sin), ulps(turn.cos, exact.cos)});
  }
  std::cout << worst << " ulp\n";
  // π and its product with the reduced angle are rounded, an ulp together, and up to 2 where the binade
  // changes; the machine's sine and cosine add 1/2 to 1.
  EXPECT_LE(worst, 3);
  EXPECT_EQ(sincos_turns(0.25L).cos, 0);
  EXPECT_EQ(sincos_half_turns(1.0L).sin, 0);
}

TEST(GenericScalar, MultiprecisionKeepsItsDigits) {
  EXPECT_LE(abs(pi<Mp50>() - Mp50("3.14159265358979323846264338327950288419716939937510582")), Mp50("1e-49"));
  for (const Mp50& x : {Mp50(1) / 7, Mp50(-5) / 3, Mp50(1000) + Mp50(2) / 3}) {
    const Turn<Mp50> turn = sincos_turns(x), half = sincos_half_turns(x);
    const Turn<Mp50> exact = exact_sincos(x, 2), exact_half = exact_sincos(x, 1);
    // 50 digits less the 4 of 2π 1000.
    for (const Mp50& error :
         {turn.sin - exact.sin, turn.cos - exact.cos, half.sin - exact_half.sin, half.cos - exact_half.cos})
      EXPECT_LE(abs(error), Mp50("1e-46")) << x;
  }
}

TEST(Lift, KeepsTheValueInEveryScalar) {
  EXPECT_EQ(lift<double>(0.1), 0.1);
  EXPECT_EQ(lift<double>(0.1F), static_cast<double>(0.1F));
  EXPECT_EQ(lift<float>(0.1), 0.1F);
  EXPECT_EQ(lift<long double>(0.1), 0.1L - (0.1L - static_cast<long double>(0.1)));
  EXPECT_EQ(lift<Mp50>(0.1), Mp50(0.1));
  EXPECT_NE(lift<Mp50>(0.1), Mp50("0.1"));
  EXPECT_EQ(lift<Archetype<>>(0.1).value(), 0.1);
  using Nested = Dual<Dual<double, 2>, 2>;
  const Nested nested = lift<Nested>(0.1);
  EXPECT_EQ(nested.value.value, 0.1);
  EXPECT_EQ(nested.derivative[1].value, 0);
  EXPECT_EQ(nested.value.derivative[0], 0);
  using Many = Dual<Mp50, 1>;
  EXPECT_EQ(lift<Many>(Mp50("0.1")).value, Mp50("0.1"));
  EXPECT_EQ(two_pi<float>(), 2 * pi<float>());
}

#if __has_include(<ceres/jet.h>)
// One expression that uses every operation, for any pair of numbers.
template <class S>
S everything(const S& x, const S& y) {
  using std::sqrt, std::abs, ceres::sqrt, ceres::abs;
  const Turn<S> a = sincos_turns(x * y), b = sincos_half_turns(x - y);
  return sqrt(x * x + y / x) * a.sin + abs(b.cos - x) / (y + lift<S>(2.0)) - (-(a.cos * b.sin)) * pi<S>();
}

TEST(Dual, AgreesWithCeresJet) {
  using D = Dual<double, 2>;
  using Jet = ceres::Jet<double, 2>;
  Random random(6);
  for (int i = 0; i < points; ++i) {
    const double x = random.uniform(0.5, 2), y = random.uniform(0.5, 2);
    const D d = everything(D::variable(x, 0), D::variable(y, 1));
    const Jet j = everything(Jet(x, 0), Jet(y, 1));
    // Jet divides by multiplying with the inverse, so the two round differently: some 10 roundings of values
    // below 10, and 30 of derivatives' terms below 100 (2π times y <= 2 times the root <= 3, and sums of
    // them).
    EXPECT_NEAR(d.value, j.a, 10 * 0x1p-53 * 10);
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(d.derivative[k], j.v[k], 30 * 0x1p-53 * 100);
  }
}

TEST(Dual, SineAndCosineAreThoseOfJetToTheBit) {
  using D = Dual<double, 1>;
  using Jet = ceres::Jet<double, 1>;
  Random random(7);
  for (int i = 0; i < points; ++i) {
    const double x = random.uniform(-2, 2);
    const Turn<D> d = sincos_turns(D::variable(x, 0));
    const Turn<Jet> j = sincos_turns(Jet(x, 0));
    EXPECT_EQ(d.sin.value, j.sin.a);
    EXPECT_EQ(d.sin.derivative[0], j.sin.v[0]);
    EXPECT_EQ(d.cos.derivative[0], j.cos.v[0]);
    EXPECT_EQ(d.sin.derivative[0], two_pi<double>() * sincos_turns(x).cos);
    EXPECT_EQ(sincos_half_turns(D::variable(x, 0)).cos.derivative[0],
              -(pi<double>() * sincos_half_turns(x).sin));
  }
}
#else
TEST(Dual, AgreesWithCeresJet) {
  GTEST_SKIP() << "ceres/jet.h is not there";
}
#endif

TEST(Dual, NestedGivesSecondDerivatives) {
  using D = Dual<Dual<double, 2>, 2>;
  const auto variable = [](double x, int k) { return D::variable(Dual<double, 2>::variable(x, k), k); };
  // Integers: x³y² at (3, 5) exactly.
  const D x = variable(3, 0), y = variable(5, 1), f = x * x * x * y * y;
  EXPECT_EQ(f.value.value, 675);
  EXPECT_EQ(f.derivative[0].derivative[0], 6 * 3 * 25);
  EXPECT_EQ(f.derivative[0].derivative[1], 6 * 9 * 5);
  EXPECT_EQ(f.derivative[1].derivative[0], 6 * 9 * 5);
  EXPECT_EQ(f.derivative[1].derivative[1], 2 * 27);
  // 1/x: 2/x³; sqrt x: -x^(-3/2)/4, both exact at 4.
  const D four = variable(4, 0);
  EXPECT_EQ((lift<D>(1.0) / four).derivative[0].derivative[0], 2.0 / 64);
  EXPECT_EQ(sqrt(four).derivative[0].derivative[0], -1.0 / 32);
  // sin'' = -(2π)² sin: products of three, two roundings more than the right side, of at most 40.
  const double at = 0.3, omega = two_pi<double>();
  const Turn<D> turn = sincos_turns(variable(at, 0));
  EXPECT_NEAR(turn.sin.derivative[0].derivative[0], -(omega * omega) * sincos_turns(at).sin,
              4 * 40 * 0x1p-53);
  EXPECT_NEAR(turn.cos.derivative[0].derivative[0], -(omega * omega) * sincos_turns(at).cos,
              4 * 40 * 0x1p-53);
}

// tanh' = 1/cosh², tanh'' = -2 tanh/cosh², which in 40 digits do not overflow: each has a few roundings.
TEST(Dual, TanhHasDerivativesWhereCoshOverflows) {
  using D = Dual<Dual<double, 1>, 1>;
  for (const double x :
       {-1e6, -800.0, -20.0, -0.3, 0.0, 1e-9, 0.3, 1.0, 5.0, 20.0, 350.0, 710.0, 800.0, 1e300}) {
    const D f = tanh(D::variable(Dual<double, 1>::variable(x, 0), 0));
    EXPECT_EQ(f.value.value, tanh(x));
    // Beyond, both are less than a double.
    const Multiprecision at(std::fmax(-800, std::fmin(x, 800))), c = cosh(at);
    const auto first = static_cast<double>(Multiprecision(1.0) / (c * c)),
               second = static_cast<double>(Multiprecision(-2.0) * tanh(at) / (c * c));
    EXPECT_NEAR(f.derivative[0].value, first, 12 * 0x1p-53 * first) << x;
    EXPECT_EQ(f.value.derivative[0], f.derivative[0].value) << x;
    EXPECT_NEAR(f.derivative[0].derivative[0], second, 24 * 0x1p-53 * std::fabs(second)) << x;
  }
}

TEST(Dual, ComparesByValue) {
  using D = Dual<double, 1>;
  const D one = D::variable(1, 0), two(2.0);
  EXPECT_TRUE(one < two && two > one && one <= two && two >= one && !(one == two) && one == D(1.0));
  EXPECT_EQ(abs(-two).value, 2);
  EXPECT_EQ(abs(-one).derivative[0], 1);
  EXPECT_TRUE(isfinite(one));
  EXPECT_FALSE(isfinite(one / D(0.0)));
}

}  // namespace
}  // namespace darboux::test::scalar_test
