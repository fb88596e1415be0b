// Intervals with linear forms: they hold every number that the operands hold, and are off by terms of second
// order only.
#include "scene/interval.h"

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test::interval_test {
namespace {

using tiles::Enclosure;
using tiles::Interval;

// An operation on numbers and on enclosures of them, and where it is defined.
struct Operation {
  const char* name;
  std::function<Enclosure(const Enclosure&, const Enclosure&)> of_enclosures;
  std::function<long double(long double, long double)> of_numbers;
  double least, most;  // of its operands
};
void PrintTo(const Operation& operation, std::ostream* out) {
  *out << operation.name;
}
const long double pi_l = std::acos(-1.0L);
const Operation operations[] = {
    {"sum", [](auto& a, auto& b) { return a + b; }, [](auto a, auto b) { return a + b; }, -3, 3},
    {"difference", [](auto& a, auto& b) { return a - b; }, [](auto a, auto b) { return a - b; }, -3, 3},
    {"product", [](auto& a, auto& b) { return a * b; }, [](auto a, auto b) { return a * b; }, -3, 3},
    {"quotient", [](auto& a, auto& b) { return a / b; }, [](auto a, auto b) { return a / b; }, 0.2, 3},
    {"square", [](auto& a, auto&) { return square(a); }, [](auto a, auto) { return a * a; }, -3, 3},
    {"absolute", [](auto& a, auto&) { return abs(a); }, [](auto a, auto) { return std::fabs(a); }, -3, 3},
    {"sqrt", [](auto& a, auto&) { return sqrt(a); }, [](auto a, auto) { return std::sqrt(a); }, 0.1, 3},
    {"exp", [](auto& a, auto&) { return exp(a); }, [](auto a, auto) { return std::exp(a); }, -3, 3},
    {"log", [](auto& a, auto&) { return log(a); }, [](auto a, auto) { return std::log(a); }, 0.1, 3},
    {"sinh", [](auto& a, auto&) { return sinh(a); }, [](auto a, auto) { return std::sinh(a); }, -3, 3},
    {"cosh", [](auto& a, auto&) { return cosh(a); }, [](auto a, auto) { return std::cosh(a); }, -3, 3},
    {"tanh", [](auto& a, auto&) { return tanh(a); }, [](auto a, auto) { return std::tanh(a); }, -3, 3},
    {"power", [](auto& a, auto&) { return pow(a, Enclosure(0.7)); },
     [](auto a, auto) { return std::pow(a, static_cast<long double>(0.7)); }, 0.1, 3},
    {"sine", [](auto& a, auto&) { return sincos_turns(a).sin; },
     [](auto a, auto) { return std::sin(2 * pi_l * a); }, -3, 3},
    {"cosine", [](auto& a, auto&) { return sincos_half_turns(a).cos; },
     [](auto a, auto) { return std::cos(pi_l * a); }, -3, 3}};

class Enclosures : public ::testing::TestWithParam<Operation> {
 protected:
  Random random{41};
  // A linear form whose numbers are within the operation's domain, of the given relative width.
  Enclosure operand(double width) {
    const double least = GetParam().least, most = GetParam().most;
    for (;;) {
      const double mid = random.uniform(least, most);
      Enclosure x(mid);
      x.u = width * random.uniform(-1, 1), x.v = width * random.uniform(-1, 1), x.rest = 0;
      x.range = Interval::rounded(mid - x.radius(), mid + x.radius());
      if (x.range.lo > least && x.range.hi < most) return x;
    }
  }
};
INSTANTIATE_TEST_SUITE_P(All, Enclosures, ::testing::ValuesIn(operations),
                         [](const auto& info) { return std::string(info.param.name); });

long double value(const Enclosure& x, double a, double b) {
  return static_cast<long double>(x.mid) + static_cast<long double>(x.u) * a +
         static_cast<long double>(x.v) * b;
}

TEST_P(Enclosures, HoldEveryNumber) {
  for (int i = 0; i < 5000; ++i) {
    const double width = random.log_uniform(1e-17, 0.5);
    const Enclosure x = operand(width), y = operand(width), z = GetParam().of_enclosures(x, y);
    for (int k = 0; k < 9; ++k) {
      const double a = k < 4 ? (k % 2 ? 1 : -1) : random.uniform(-1, 1),
                   b = k < 4 ? (k / 2 ? 1 : -1) : random.uniform(-1, 1);
      const long double exact = GetParam().of_numbers(value(x, a, b), value(y, a, b));
      ASSERT_LE(z.range.lo, exact);
      ASSERT_GE(z.range.hi, exact);
      ASSERT_LE(std::fabs(exact - value(z, a, b)), z.rest);
    }
  }
}

// Halving the operands' widths quarters what is left beside the linear form.
TEST_P(Enclosures, AreOffBySecondOrder) {
  for (int i = 0; i < 200; ++i) {
    Enclosure x = operand(1e-3), y = operand(1e-3);
    const Enclosure wide = GetParam().of_enclosures(x, y);
    for (Enclosure* e : {&x, &y}) {
      e->u /= 16, e->v /= 16;
      e->range = Interval::rounded(e->mid - e->radius(), e->mid + e->radius());
    }
    // 16² = 256, half of which is left to what is not quadratic, and roundings.
    ASSERT_LE(GetParam().of_enclosures(x, y).rest, wide.rest / 128 + 1e-14);
  }
}

TEST(Enclosures, OfWhatIsNotDefinedAreInfinite) {
  const Enclosure around_zero(-1, 1);
  const Enclosure quotient = Enclosure(1) / around_zero;
  EXPECT_EQ(quotient.range.hi, std::numeric_limits<double>::infinity());
  EXPECT_EQ(quotient.range.lo, -std::numeric_limits<double>::infinity());
  const Enclosure after = quotient * quotient - quotient;
  EXPECT_EQ(after.range.hi, std::numeric_limits<double>::infinity());
  EXPECT_EQ(sqrt(Enclosure(-2, -1)).range.hi, std::numeric_limits<double>::infinity());
  EXPECT_EQ(log(around_zero).range.lo, -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace darboux::test::interval_test
