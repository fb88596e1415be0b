#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>

#include <gtest/gtest.h>

#include <darboux/derivative.h>
#include <darboux/differentiate.h>
#include <darboux/evaluate.h>

#include "estimate_quality.h"
#include "every_surface.h"
#include "random.h"

namespace darboux::test::differentiate_test {
namespace {

// ---- Functions with known derivatives: what smooth functions look like, each with the length its user would
// state. The truth is computed in long double from the same double parameters.

struct Truth {
  Wide first, second;
};

// a sin 2π(k x + φ), up to 20 turns, the argument rounded as anybody would
struct Sine {
  static constexpr const char* name = "sine";
  double a, k, phase;
  explicit Sine(Random& r) : a(r.log_uniform(0.1, 10)), k(r.log_uniform(0.5, 20)), phase(r.uniform()) {}
  double length(double) const { return 1 / k; }
  double operator()(double x) const { return a * std::sin(tau * (k * x + phase)); }
  Truth truth(double x) const {
    const Wide angle = wide_tau * (Wide(k) * x + phase), w = wide_tau * k;
    return {a * w * std::cos(angle), -a * w * w * std::sin(angle)};
  }
};
// three of them: large terms cancel at places
struct Sines {
  static constexpr const char* name = "sum of sines";
  std::array<double, 3> a, k, phase;
  explicit Sines(Random& r) {
    for (int i = 0; i < 3; ++i) a[i] = r.uniform(-1, 1), k[i] = r.log_uniform(0.5, 5), phase[i] = r.uniform();
  }
  double length(double) const { return 1 / std::max({k[0], k[1], k[2]}); }
  double operator()(double x) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += a[i] * std::sin(tau * (k[i] * x + phase[i]));
    return sum;
  }
  Truth truth(double x) const {
    Truth sum{0, 0};
    for (int i = 0; i < 3; ++i) {
      const Wide angle = wide_tau * (Wide(k[i]) * x + phase[i]), w = wide_tau * k[i];
      sum.first += a[i] * w * std::cos(angle);
      sum.second -= a[i] * w * w * std::sin(angle);
    }
    return sum;
  }
};
struct Exponential {
  static constexpr const char* name = "exponential";
  double a, k;
  explicit Exponential(Random& r) : a(r.log_uniform(0.1, 10)), k(r.sign() * r.log_uniform(0.5, 20)) {}
  double length(double) const { return tau / std::fabs(k); }
  double operator()(double x) const { return a * std::exp(k * x); }
  Truth truth(double x) const {
    const Wide e = a * std::exp(Wide(k) * x);
    return {k * e, Wide(k) * k * e};
  }
};
// degree 2 to 12, random coefficients: they cancel too
struct Polynomial {
  static constexpr const char* name = "polynomial";
  int degree;
  std::array<double, 13> c;
  explicit Polynomial(Random& r) : degree(2 + static_cast<int>(r.bits() % 11)) {
    for (double& x : c) x = r.uniform(-1, 1);
  }
  double length(double) const { return tau / degree; }
  double operator()(double x) const {
    double sum = 0;
    for (int i = degree; i >= 0; --i) sum = sum * x + c[i];
    return sum;
  }
  Truth truth(double x) const {
    Truth sum{0, 0};
    for (int i = degree; i >= 1; --i) sum.first = sum.first * x + i * Wide(c[i]);
    for (int i = degree; i >= 2; --i) sum.second = sum.second * x + i * (i - 1) * Wide(c[i]);
    return sum;
  }
};
// (1 + a t) / (1 + t²), t = (x - c) / w: poles at c ± i w
struct Rational {
  static constexpr const char* name = "rational";
  double a, c, w;
  explicit Rational(Random& r) : a(r.uniform(-2, 2)), c(r.uniform()), w(r.log_uniform(0.1, 2)) {}
  double length(double x) const { return 1.5 * std::hypot(w, x - c); }
  double operator()(double x) const {
    const double t = (x - c) / w;
    return (1 + a * t) / (1 + t * t);
  }
  Truth truth(double x) const {
    const Wide t = (Wide(x) - c) / w, q = 1 + t * t, n = a - 2 * t - a * t * t;
    return {n / (q * q) / w, ((-2 - 2 * a * t) * q - 4 * t * n) / (q * q * q) / w / w};
  }
};

// ---- How good estimates are

// `method(f, x, behaviour)` over `many_points` random points of the five kinds of functions on [0, 1].
enum class Which { first, second };
template <class Method>
Quality quality(std::uint64_t seed, Which which, Method method) {
  Random random(seed);
  Quality all;
  const auto run = [&]<class F>(std::type_identity<F>) {
    Quality one;
    for (int i = 0; i < many_points / 5; ++i) {
      const F f(random);
      const double x = random.uniform();
      const DerivativeEstimate d = method(f, x, f.length(x));
      const Truth truth = f.truth(x);
      const Wide t = which == Which::first ? truth.first : truth.second;
      const double error = static_cast<double>(std::fabs(d.value - t));
      if (!(d.error >= error / 2))
        std::cout << "below half: " << F::name << " at x = " << x
                  << ", f' or f'' = " << static_cast<double>(t) << std::scientific << ", error " << error
                  << ", estimate " << d.error << '\n';
      one.add(error, d.error, static_cast<double>(t));
      all.add(error, d.error, static_cast<double>(t));
    }
    one.print(F::name);
  };
  run(std::type_identity<Sine>{});
  run(std::type_identity<Sines>{});
  run(std::type_identity<Exponential>{});
  run(std::type_identity<Polynomial>{});
  run(std::type_identity<Rational>{});
  all.print("all");
  return all;
}

// The promise of differentiate.h.
void expect_honest(Quality q) {
  EXPECT_LE(q.below_half_per_million(), 10);
  EXPECT_LE(q.percentile(50), 10);
  EXPECT_LE(q.percentile(99), 100);
}

// ---- Central differences

template <class T>
class Central : public ::testing::Test {};
TYPED_TEST_SUITE(Central, EvenOrders, OrderNames);

// Σ w_k k^p = 1/2 for p = 1 and 0 for the odd p up to order - 1: what exactness up to `order` means.
TYPED_TEST(Central, WeightsSatisfyTheirEquations) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  constexpr auto weights = central_weights<order>();
  for (int power = 1; power < order; power += 2) {
    double sum = 0;
    for (int k = 1; k <= order / 2; ++k) sum += weights[k - 1] * std::pow(k, power);
    // Weights rounded to u/2 of at most 1, times 4^7.
    EXPECT_NEAR(sum, power == 1 ? 0.5 : 0, 4 * roundoff * std::pow(order / 2, power)) << power;
  }
}

TYPED_TEST(Central, IsExactForPolynomialsOfItsOrder) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  // At x = 1 with steps of 1/4: values are exact dyadic numbers.
  const auto monomial = [](double x) { return std::pow(x, order); };
  // Some 10 roundings of values up to 3^8, with the weights' sum 2 (second: 7) over h.
  const double largest = 10 * roundoff * std::pow(1 + (order / 2 + 1) * 0.25, order);
  EXPECT_NEAR(central_difference<order>(monomial, 1.0, 0.25).value, order, largest * 2 / 0.25);
  EXPECT_NEAR(second_difference<order>(monomial, 1.0, 0.25).value, order * (order - 1), largest * 7 / 0.0625);
}

TYPED_TEST(Central, HasItsOrder) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  const auto f = [](double x) { return Vec3<double>{std::exp(x), std::sin(x), std::exp(-x)}; };
  const Vec3<double> first{std::exp(0.3), std::cos(0.3), -std::exp(-0.3)};
  const Vec3<double> second{std::exp(0.3), -std::sin(0.3), std::exp(-0.3)};
  const double h = order == 8 ? 0x1p-2 : order == 6 ? 0x1p-3 : 0x1p-4;
  const auto observed = [&](const auto& error) { return std::log2(error(h) / error(h / 2)); };
  // The next term of the error is about (order h)² / 12 of the first, 0.33 at order 8, 0.05 at order 6;
  // rounding is at most 2% of it.
  const double slack = order == 8 ? 0.2 : 0.06;
  EXPECT_NEAR(observed([&](double s) { return norm(central_difference<order>(f, 0.3, s).value - first); }),
              order, slack);
  EXPECT_NEAR(observed([&](double s) { return norm(second_difference<order>(f, 0.3, s).value - second); }),
              order, slack);
}

TYPED_TEST(Central, FirstDerivativeIsEstimatedHonestly) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  expect_honest(quality(1, Which::first, [](const auto& f, double x, double length) {
    return central_difference<order>(f, x, behaviour(f, x, length));
  }));
}
TYPED_TEST(Central, SecondDerivativeIsEstimatedHonestly) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  expect_honest(quality(2, Which::second, [](const auto& f, double x, double length) {
    return second_difference<order>(f, x, behaviour(f, x, length));
  }));
}

// A length that is wrong by a factor 3 either way costs accuracy, not honesty.
TYPED_TEST(Central, AWrongLengthIsSeen) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  for (const double factor : {1.0 / 3, 3.0}) {
    std::cout << "length times " << factor << '\n';
    Quality q = quality(3, Which::first, [&](const auto& f, double x, double length) {
      return central_difference<order>(f, x, behaviour(f, x, factor * length));
    });
    // One in a thousand (measured: 600 in 10^6, where f has large terms that cancel).
    EXPECT_LE(q.below_half_per_million(), 1000);
  }
}

// ---- One-sided differences

template <class T>
class OneSided : public ::testing::Test {};
using AllOrders =
    ::testing::Types<Order<1>, Order<2>, Order<3>, Order<4>, Order<5>, Order<6>, Order<7>, Order<8>>;
TYPED_TEST_SUITE(OneSided, AllOrders, OrderNames);

TYPED_TEST(OneSided, IsExactForPolynomialsOfItsOrder) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  const auto monomial = [](double x) { return std::pow(x, order); };
  for (const double h : {0.25, -0.25}) {
    // Values up to (1 + 9/4)^8, weights up to 2^order / |h|.
    const double tolerance =
        4 * roundoff * std::pow(1 + (order + 1) * std::fabs(h), order) * std::exp2(order) / 0.25;
    EXPECT_NEAR(one_sided_difference<order>(monomial, 1.0, h).value, order, tolerance) << h;
  }
}

TYPED_TEST(OneSided, HasItsOrder) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  const auto f = [](double x) { return std::exp(x); };
  for (const double sign : {1.0, -1.0}) {
    const auto error = [&](double h) {
      return std::fabs(one_sided_difference<order>(f, 0.3, sign * h).value - std::exp(0.3));
    };
    const double h = order == 8 ? 0x1.8p-4 : order == 7 ? 0x1p-4 : order >= 5 ? 0x1p-5 : 0x1p-7;
    // The next term is about order h / 2 of the first, at most 3/8; half of that shows, times 1/ln 2.
    EXPECT_NEAR(std::log2(error(h) / error(h / 2)), order, 0.3);
  }
}

TYPED_TEST(OneSided, IsEstimatedHonestly) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  expect_honest(quality(4, Which::first, [](const auto& f, double x, double length) {
    return one_sided_difference<order>(f, x, behaviour(f, x, length), x < 0.5 ? 1 : -1);
  }));
}

// ---- Ridders, dual numbers

TEST(Ridders, IsEstimatedHonestly) {
  Quality q = quality(5, Which::first, [](const auto& f, double x, double length) {
    return ridders(f, x, behaviour(f, x, length));
  });
  EXPECT_LE(q.below_half_per_million(), 10);
  EXPECT_LE(q.percentile(50), 10);
  // The entry chosen is one where rounding outweighs truncation: errors near 0 by luck are all seen (389
  // measured).
  EXPECT_LE(q.percentile(99), 600);
}

// Where the tableau's own differences were up to 977 times too small (50 000 points of a sine, first step
// 2^-6).
TEST(Ridders, HasARoundingFloor) {
  Random random(6);
  double worst = 0;
  for (int i = 0; i < 50'000; ++i) {
    const double x = random.uniform();
    const auto f = [](double t) { return sincos_turns(t).sin; };
    const DerivativeEstimate d = ridders(f, x, 0x1p-6);
    worst = std::fmax(worst, std::fabs(d.value - tau * sincos_turns(x).cos) / d.error);
  }
  std::cout << "largest error / estimate " << worst << '\n';
  EXPECT_LE(worst, 2);
}

// x exp(-k x) / (1 + x²) in any number: what dual numbers can run.
struct Formula {
  double k;
  template <class S>
  S operator()(const S& x) const {
    using std::exp;
    const S one = lift<S>(1.0);
    return x * exp(-(lift<S>(k) * x)) / (one + x * x);
  }
  // The truth by hand: f' = f (1/x - k - 2x/q), q = 1 + x².
  Truth truth(double x) const {
    const Wide X = x, q = 1 + X * X, f = X * std::exp(-k * X) / q;
    const Wide log_slope = 1 / X - k - 2 * X / q, its_slope = -1 / (X * X) - (2 - 2 * X * X) / (q * q);
    return {f * log_slope, f * (log_slope * log_slope + its_slope)};
  }
};

template <class Method>
Quality dual_quality(Which which, Method method) {
  Random random(7);
  Quality q;
  for (int i = 0; i < many_points / thinning(3); ++i) {
    const Formula f{random.log_uniform(0.2, 5)};
    const double x = random.uniform(0.01, 2);
    const DerivativeEstimate d = method(f, x);
    const Truth truth = f.truth(x);
    const Wide t = which == Which::first ? truth.first : truth.second;
    q.add(static_cast<double>(std::fabs(d.value - t)), d.error, static_cast<double>(t));
  }
  q.print("dual");
  return q;
}
TEST(DualNumbers, FirstDerivativeIsEstimatedHonestly) {
  expect_honest(dual_quality(Which::first, [](const Formula& f, double x) { return dual_derivative(f, x); }));
}
TEST(DualNumbers, SecondDerivativeIsEstimatedHonestly) {
  expect_honest(
      dual_quality(Which::second, [](const Formula& f, double x) { return second_dual_derivative(f, x); }));
}
// Without a wider number: the estimate is a model.
TEST(DualNumbers, AreEstimatedHonestlyWithoutAWiderNumber) {
  expect_honest(dual_quality(Which::first, [](const Formula& f, double x) {
    return dual_derivative([&](const Dual<double, 1>& s) { return f(s); }, x);
  }));
  expect_honest(dual_quality(Which::second, [](const Formula& f, double x) {
    return second_dual_derivative([&](const Dual<Dual<double, 1>, 1>& s) { return f(s); }, x);
  }));
}

// ---- The planner

// f counts its calls and refuses to be evaluated outside [0, 1].
struct Watched {
  int* calls;
  double k = 1;
  double operator()(double x) const {
    ++*calls;
    EXPECT_TRUE(0 <= x && x <= 1) << std::setprecision(17) << x;
    return std::sin(tau * k * x) + 2;
  }
};

TEST(Planner, StaysInTheDomainAndCountsEvaluations) {
  Random random(11);
  const std::array<double, 6> special{0, 1, 1e-300, 1e-9, 0x1.fffffffffffffp-1, 0.5};
  std::array<int, 5> methods{};
  int met = 0;
  for (int i = 0; i < 3000; ++i) {
    int calls = 0;
    const double k = random.log_uniform(0.01, 100);
    const double x = i < 600 ? special[static_cast<std::size_t>(i % 6)] : random.uniform();
    const Watched f{&calls, k};
    const double wanted = random.log_uniform(1e-14, 1) * tau * k;
    const auto d = derivative(f, x, {.error = wanted, .length = 1 / k, .domain = {0, 1}});
    EXPECT_EQ(d.evaluations, calls);
    EXPECT_EQ(d.met, d.error <= wanted);
    ++methods[static_cast<std::size_t>(d.method)];
    met += d.met;
    // The estimate, twice; 20 in 10^6 would be no failure, so one here is.
    EXPECT_LE(std::fabs(d.value - tau * k * std::cos(tau * k * x)),
              2 * d.error + 4 * roundoff * tau * k * (1 + tau * k));
    if (wanted > 1e-10 * tau * k) {
      EXPECT_TRUE(d.met) << k << ' ' << x << ' ' << wanted << ' ' << d.error;
    }
  }
  std::cout << met << " of 3000 met\n";
  EXPECT_EQ(methods[static_cast<std::size_t>(DerivativeMethod::dual)], 0);
  EXPECT_GT(methods[static_cast<std::size_t>(DerivativeMethod::one_sided)], 0);
  EXPECT_GT(methods[static_cast<std::size_t>(DerivativeMethod::central)], 0);
}

TEST(Planner, TakesTheCheapestThatIsGoodEnough) {
  const auto f = [](double x) { return std::exp(x); };
  const Behaviour b = behaviour(f, 0.5, tau);
  for (const double wanted : {1e-6, 1e-9, 1e-11, 1e-12, 1e-20}) {
    const auto d = derivative(f, 0.5, {.error = wanted, .length = tau}, b);
    std::cout << wanted << ": " << name(d.method, d.order) << ", " << d.evaluations << " evaluations, "
              << d.error << '\n';
    EXPECT_EQ(d.met, wanted > 1e-15);
    // The differences that might do, of 3 to 10 evaluations, and at most 20 of Ridders.
    EXPECT_LE(d.evaluations, wanted > 1e-15 ? 3 + 4 + 5 + 6 + 7 + 8 + 9 + 10 : 72);
    if (!d.met) {
      EXPECT_LE(d.error, 1e-12);  // the best there was
    }
  }
  const auto cheap = derivative(f, 0.5, {.error = 1e-6, .length = tau}, b);
  EXPECT_EQ(name(cheap.method, cheap.order), "one_sided1");
  EXPECT_EQ(cheap.evaluations, 3);
  const auto at_edge = derivative(f, 0.0, {.error = 1e-11, .length = tau, .domain = {0, 1}}, b);
  EXPECT_EQ(at_edge.method, DerivativeMethod::one_sided);
  EXPECT_TRUE(at_edge.met);
}

TEST(Planner, PrefersDualNumbers) {
  const auto d = derivative(Formula{1.5}, 0.7, {.error = 1e-15});
  EXPECT_EQ(d.method, DerivativeMethod::dual);
  EXPECT_TRUE(d.met);
  EXPECT_NEAR(d.value, static_cast<double>(Formula{1.5}.truth(0.7).first), 4 * roundoff);
  // With a parameter of type double f is one of doubles.
  const auto e = derivative([](double x) { return Formula{1.5}(x); }, 0.7, {.error = 1e-10});
  EXPECT_NE(e.method, DerivativeMethod::dual);
  EXPECT_NEAR(e.value, static_cast<double>(Formula{1.5}.truth(0.7).first), 2e-10);
}

TEST(Planner, OutsideTheDomainThereIsNoDerivative) {
  const auto f = [](double x) { return x; };
  for (const double x : {-0.1, 1.1, std::nan(""), double{INFINITY}}) {
    const auto d = derivative(f, x, {.error = 1, .domain = {0, 1}});
    EXPECT_TRUE(std::isnan(d.value)) << x;
    EXPECT_EQ(d.error, INFINITY);
    EXPECT_FALSE(d.met);
    EXPECT_EQ(d.method, DerivativeMethod::none);
    EXPECT_EQ(d.evaluations, 0);
  }
}

TEST(Planner, NamesItsMethods) {
  EXPECT_EQ(name(DerivativeMethod::central, 8), "central8");
  EXPECT_EQ(name(DerivativeMethod::ridders), "ridders");
  EXPECT_EQ(name(DerivativeMethod::none), "none");
}

// ---- What is not a derivative

// Every method on f at x.
template <class F, class Check>
void with_every_method(const F& f, double x, Check check) {
  const Behaviour b = behaviour(f, x);
  check(central_difference<2>(f, x));
  check(central_difference<8>(f, x));
  check(central_difference<8>(f, x, b));
  check(one_sided_difference<1>(f, x));
  check(one_sided_difference<8>(f, x));
  check(one_sided_difference<8>(f, x, b, 1));
  check(second_difference<2>(f, x));
  check(second_difference<8>(f, x, b));
  check(ridders(f, x));
  check(ridders(f, x, b));
}

TEST(NotFinite, IsNeverANumber) {
  const auto expect_none = [](const auto& d) {
    if constexpr (std::same_as<std::remove_cvref_t<decltype(d.value)>, double>)
      EXPECT_TRUE(std::isnan(d.value));
    else
      EXPECT_TRUE(std::isnan(d.value.x) && std::isnan(d.value.y) && std::isnan(d.value.z));
    EXPECT_EQ(d.error, INFINITY);
  };
  for (const double bad : {std::nan(""), double{INFINITY}, -double{INFINITY}}) {
    with_every_method([&](double) { return bad; }, 0.5, expect_none);
    with_every_method([&](double x) { return x < 0.5 ? x : bad; }, 0.5, expect_none);
    with_every_method([&](double x) { return Vec3<double>{x, bad, 1}; }, 0.5, expect_none);
  }
  // Overflow of a difference; a step below the spacing of numbers at x; no x.
  expect_none(central_difference<2>([](double x) { return x > 0.5 ? 1.7e308 : -1.7e308; }, 0.5));
  expect_none(central_difference<2>([](double x) { return x; }, 0x1p60));
  expect_none(one_sided_difference<8>([](double x) { return x; }, 1.0, 0.0));
  with_every_method([](double x) { return x; }, std::nan(""), expect_none);
  expect_none(dual_derivative([](const auto& x) { return x / x; }, 0.0));
}

TEST(Constants, HaveDerivativeZero) {
  with_every_method(
      [](double) {
        return Vec3<double>{1, 2, 3};
      },
      0.5,
      [](const auto& d) {
        EXPECT_EQ(d.value, (Vec3<double>{0, 0, 0}));
        EXPECT_GT(d.error, 0);
        EXPECT_LT(d.error, 1e-6);
      });
  with_every_method([](double) { return 0.0; }, 0.5,
                    [](const auto& d) {
                      EXPECT_EQ(d.value, 0);
                      EXPECT_EQ(d.error, 0);
                    });
}

// Tiny and huge values neither underflow nor overflow on the way: the relative error stays.
TEST(Scales, DoNotMatter) {
  for (const double size : {1e-280, 1e-150, 1.0, 1e150, 1e280}) {
    const auto f = [&](double x) { return Vec3<double>{size * std::exp(x), size * std::sin(x), size * x}; };
    const Vec3<double> truth{size * std::exp(0.4), size * std::cos(0.4), size};
    const DerivativeEstimate d = central_difference<8>(f, 0.4);
    EXPECT_LE(norm(d.value - truth), 2 * d.error) << size;
    EXPECT_LE(d.error, 1e-12 * size) << size;
    EXPECT_LE(central_difference<8>(f, 0.4, behaviour(f, 0.4)).error, 1e-12 * size) << size;
  }
}

// sin 2πx whose argument is not rounded: x less its whole part is exact.
double exact_sine(double x) {
  return static_cast<double>(std::sin(wide_tau * (Wide(x) - std::floor(Wide(x)))));
}

// Far from zero neighbouring numbers are a good part of a step apart. Estimates hold all the same: none of 40
// 000 per method is below half the error, with rounded nodes 1.25 % were.
TEST(FarFromZero, IsEstimatedHonestly) {
  Random random(41);
  for (const double magnitude : {1e8, 1e9, 1e10, 1e11})
    for (int i = 0; i < 10000; ++i) {
      const double x = magnitude * random.uniform(0.5, 1.5);
      const Wide angle = wide_tau * (Wide(x) - std::floor(Wide(x)));
      const auto truth = static_cast<double>(wide_tau * std::cos(angle));
      const Behaviour b = behaviour(exact_sine, x);
      const auto expect_honest = [&](const DerivativeEstimate<double>& d, const char* method) {
        EXPECT_LE(std::fabs(d.value - truth), 2 * d.error) << method << " at " << std::setprecision(17) << x;
      };
      expect_honest(one_sided_difference<8>(exact_sine, x, b, 1), "one_sided8");
      expect_honest(one_sided_difference<8>(exact_sine, x), "one_sided8, one rounding assumed");
      expect_honest(central_difference<8>(exact_sine, x, b), "central8");
      expect_honest(central_difference<4>(exact_sine, x), "central4, one rounding assumed");
      expect_honest(ridders(exact_sine, x, b), "ridders");
    }
}

// Steps become exact by becoming shorter: the domain is not left, however coarse numbers are in it.
TEST(FarFromZero, StaysInTheDomain) {
  Random random(43);
  for (const double magnitude : {1e9, 1e11})
    for (int i = 0; i < 4000; ++i) {
      const double x = magnitude * random.uniform(0.5, 1.5), unit = std::nextafter(x, 1e300) - x;
      const double length = unit * random.log_uniform(300, 4300), room = length * random.uniform(0.01, 0.21);
      const Interval domain{x - room, x + room};
      bool within = true;
      const auto f = [&](double t) {
        within = within && domain.lo <= t && t <= domain.hi;
        return std::sin(tau * ((t - x) / length));
      };
      derivative(f, x, {.error = 0, .length = length, .domain = domain});
      EXPECT_TRUE(within) << std::setprecision(17) << x << ' ' << length << ' ' << room;
    }
}

// First derivatives take no square or cube of a length, which for short ones would underflow.
TEST(ShortLengths, HaveDerivatives) {
  for (const double length : {1e-100, 1e-160, 1e-200, 1e-280}) {
    const auto f = [&](double x) { return std::sin(tau * (x / length)); };
    const double x = 0.1 * length, truth = tau * std::cos(tau * 0.1);
    const auto expect_right = [&](const DerivativeEstimate<double>& d, double relative) {
      EXPECT_NEAR(d.value * length, truth, relative * truth) << length;
      EXPECT_LE(std::fabs(d.value * length - truth), 2 * d.error * length) << length;
      EXPECT_LE(d.error * length, 10 * relative * truth) << length;
    };
    expect_right(central_difference<8>(f, x, central_step<8>(length)), 1e-11);
    expect_right(one_sided_difference<6>(f, x, one_sided_step<6>(length)), 1e-9);
    expect_right(ridders(f, x, length / 8), 1e-11);
    expect_right(central_difference<8>(f, x, behaviour(f, x, length)), 1e-11);
  }
}

// The noise of f is found.
TEST(Behaviour, MeasuresNoise) {
  const auto f = [](double x) { return std::sin(x) + 1e-10 * std::sin(1e12 * x); };
  const double rms = 1e-10 / std::sqrt(2.0);
  Random random(12);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(0.5, 1);
    const Behaviour b = behaviour(f, x, tau);
    // 14 samples: the rms within a factor 2 (some 5 standard deviations).
    EXPECT_LE(b.rounding, 2 * rms);
    EXPECT_GE(b.rounding, rms / 2);
    const DerivativeEstimate d = central_difference<8>(f, x, b);
    EXPECT_LE(std::fabs(d.value - std::cos(x)), 2 * d.error);
    EXPECT_LE(d.error, 1e-7);
  }
}

}  // namespace
}  // namespace darboux::test::differentiate_test
