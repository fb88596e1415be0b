// The oracle's numbers against boost's with 20 digits more, which take other ways (Taylor after halving the
// argument).
#include "multiprecision.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <darboux/multiprecision.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test::multiprecision_test {
namespace {

using Wide = BoostDigits<60>;

// x to 60 digits, from sums of doubles: x = a + b + c with a the nearest double, b that of the rest, ...
Wide wide(const Multiprecision& x) {
  Wide sum = 0;
  Multiprecision rest = x;
  for (int i = 0; i < 4; ++i) {
    const double part = static_cast<double>(rest);
    sum += Wide(part);
    rest = rest - Multiprecision(part);
  }
  return sum;
}

double relative_error(const Multiprecision& found, const Wide& exact) {
  return static_cast<double>(abs(wide(found) - exact) / abs(exact));
}

// 40 digits leave 1e-40; the transcendental functions may lose a digit.
TEST(Multiprecision, HasFortyDigits) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double a = random.uniform(0.1, 10), b = random.uniform(0.1, 10);
    const Multiprecision x = Multiprecision(a) / Multiprecision(b);
    const Wide y = Wide(a) / Wide(b);
    EXPECT_LE(relative_error(x, y), 1e-40);
    EXPECT_LE(relative_error(x * x + x, y * y + y), 3e-40);
    EXPECT_LE(relative_error(sqrt(x), sqrt(y)), 2e-40);
    EXPECT_LE(relative_error(exp(x), exp(y)), 1e-38);
    EXPECT_LE(relative_error(sinh(x), sinh(y)), 1e-38);
    EXPECT_LE(relative_error(cosh(x), cosh(y)), 1e-38);
    EXPECT_LE(relative_error(tanh(x), tanh(y)), 1e-38);
    EXPECT_LE(relative_error(pow(x, Multiprecision(0.7)), pow(y, Wide(0.7))), 1e-38);
    // Near 1 the logarithm is small, and its error is that of its argument.
    EXPECT_LE(static_cast<double>(abs(wide(log(x)) - log(y))), 3e-39);
  }
}

TEST(Multiprecision, SineAndCosineAgreeWithBoost) {
  Random random(2);
  const Wide pi = acos(Wide(-1));
  EXPECT_LE(relative_error(Multiprecision::pi(), pi), 1e-40);
  for (int i = 0; i < 1000; ++i) {
    const double x = i % 2 == 0 ? random.uniform(-3, 3) : random.log_uniform(1e-200, 1);
    const auto [s, c] = sincos_pi(Multiprecision(x));
    const Wide sine = sin(pi * Wide(x)), cosine = cos(pi * Wide(x));
    // Relative to the sine itself only where x is small. (wide() needs doubles 1e-60 below x.)
    EXPECT_LE(static_cast<double>(abs(wide(s) - sine) / (std::fabs(x) < 0.5 ? abs(sine) : Wide(1))), 2e-39)
        << x;
    EXPECT_LE(static_cast<double>(abs(wide(c) - cosine)), 2e-39) << x;
  }
}

TEST(Multiprecision, TakesLongDoublesExactly) {
  const long double values[] = {1.0L / 3, std::numeric_limits<long double>::max(),
                                std::numeric_limits<long double>::denorm_min(), -0x1.000000000001p-70L};
  for (const long double x : values) EXPECT_EQ(static_cast<long double>(Multiprecision(x)), x);
  const bool wider = std::numeric_limits<long double>::digits > std::numeric_limits<double>::digits;
  EXPECT_EQ(Multiprecision(1.0L / 3) == Multiprecision(1.0 / 3), !wider);
  EXPECT_FALSE(isfinite(Multiprecision(std::numeric_limits<long double>::infinity())));
  EXPECT_TRUE(Multiprecision(2) == Multiprecision(2.0F));
}

TEST(Multiprecision, QuarterTurnsAreExact) {
  for (int k = -8; k <= 8; ++k) {
    const Turn<Multiprecision> many = sincos_turns(Multiprecision(k / 4.0));
    const Turn<double> exact = sincos_turns(k / 4.0);
    EXPECT_EQ(static_cast<double>(many.sin), exact.sin) << k;
    EXPECT_EQ(static_cast<double>(many.cos), exact.cos) << k;
  }
  // The period is removed exactly.
  EXPECT_TRUE(sincos_turns(Multiprecision(0.3) + Multiprecision(12345.0)).sin ==
              sincos_turns(Multiprecision(0.3)).sin);
}

TEST(Multiprecision, ReachesBeyondDouble) {
  const Multiprecision tiny = Multiprecision(1e-300) * Multiprecision(1e-300),
                       huge = Multiprecision(1e300) * Multiprecision(1e300);
  EXPECT_TRUE(tiny > Multiprecision(0.0));
  EXPECT_TRUE(isfinite(huge));
  EXPECT_NEAR(static_cast<double>(tiny * huge), 1, 1e-15);
  EXPECT_EQ(static_cast<double>(huge), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(isfinite(Multiprecision(1.0) / Multiprecision(0.0)));
}

TEST(Multiprecision, ComparesAndRounds) {
  const Multiprecision third = Multiprecision(1.0) / Multiprecision(3.0);
  EXPECT_TRUE(third < Multiprecision(1.0) && third <= third && third >= third && third == third &&
              Multiprecision(1.0) > third);
  EXPECT_FALSE(third == Multiprecision(1.0 / 3));
  EXPECT_EQ(static_cast<double>(third), 1.0 / 3);
  EXPECT_EQ(static_cast<double>(abs(-third)), 1.0 / 3);
  EXPECT_EQ(static_cast<double>(Multiprecision()), 0);
}

}  // namespace
}  // namespace darboux::test::multiprecision_test
