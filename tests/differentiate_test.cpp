#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <darboux/differentiate.h>
#include <darboux/evaluate.h>

#include "every_surface.h"

namespace darboux::test {
namespace {

template <class T>
class CentralDifference : public ::testing::Test {};
using Orders = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 4>,
                                std::integral_constant<int, 6>, std::integral_constant<int, 8>>;
struct OrderNames {
  template <class T>
  static std::string GetName(int) {
    return "order" + std::to_string(T::value);
  }
};
TYPED_TEST_SUITE(CentralDifference, Orders, OrderNames);

// Σ w_k k^p = 1/2 for p = 1 and 0 for the odd p up to order - 1: what exactness up to `order` means.
TYPED_TEST(CentralDifference, WeightsSatisfyTheirEquations) {
  constexpr int order = TypeParam::value;
  constexpr auto weights = central_weights<order>();
  for (int power = 1; power < order; power += 2) {
    double sum = 0;
    for (int k = 1; k <= order / 2; ++k) sum += weights[k - 1] * std::pow(k, power);
    // Weights rounded to u/2 of at most 1, times 4^7.
    EXPECT_NEAR(sum, power == 1 ? 0.5 : 0, 4 * 0x1p-53 * std::pow(order / 2, power)) << power;
  }
}

TYPED_TEST(CentralDifference, IsExactForPolynomialsOfItsOrder) {
  constexpr int order = TypeParam::value;
  // x^order at x = 1 with steps of 1/4: values are exact dyadic numbers.
  const auto monomial = [](double x) { return Vec3<double>{std::pow(x, order), 0, 0}; };
  const DerivativeEstimate d = central_difference<order>(monomial, 1.0, 0.25);
  // Rounding of values up to 3^8, some 10 of them, with the weights' sum 2 over h.
  EXPECT_NEAR(d.value.x, order, 10 * 0x1p-53 * std::pow(1 + order * 0.25, order) * 2 / 0.25);
}

TYPED_TEST(CentralDifference, HasItsOrder) {
  constexpr int order = TypeParam::value;
  const auto f = [](double x) { return Vec3<double>{std::exp(x), std::sin(x), std::exp(-x)}; };
  const Vec3<double> exact{std::exp(0.3), std::cos(0.3), -std::exp(-0.3)};
  const double h = order == 8 ? 0x1p-3 : 0x1p-4;
  const double coarse = norm(central_difference<order>(f, 0.3, h).value - exact);
  const double fine = norm(central_difference<order>(f, 0.3, h / 2).value - exact);
  // The next term of the error is h² <= 1/64 of the first (all derivatives are of one size), and rounding at most
  // 2% of it: 0.05 in the exponent.
  EXPECT_NEAR(std::log2(coarse / fine), order, 0.05);
}

// The estimate may be too large; where the truth is known it is never more than 4 times too small.
struct Honesty {
  double worst = 0;
  void add(const DerivativeEstimate& d, const Vec3<double>& exact) {
    const double error = norm(d.value - exact);
    EXPECT_TRUE(std::isfinite(d.error) && d.error >= 0);
    EXPECT_LE(error, 4 * d.error);
    if (d.error > 0) worst = std::fmax(worst, error / d.error);
  }
  ~Honesty() { std::cout << "largest error / estimate " << worst << '\n'; }
};

TYPED_TEST(CentralDifference, EstimatesHonestlyOnSurfaces) {
  constexpr int order = TypeParam::value;
  Random random(1);
  Honesty honesty;
  Catalogue::for_each([&](const auto& surface) {
    for (int i = 0; i < 2000; ++i) {
      const double u = random.uniform(), v = random.uniform();
      const double h = std::ldexp(1.0, -3 - static_cast<int>(random.bits() % 18));
      const Jet2<double> j = jet(surface, u, v);
      honesty.add(central_difference<order>([&](double x) { return jet(surface, x, v).position; }, u, h),
                  j.dpdu);
      honesty.add(central_difference<order>([&](double x) { return jet(surface, u, x).position; }, v),
                  j.dpdv);
    }
  });
}

TYPED_TEST(CentralDifference, EstimatesHonestlyOnFunctions) {
  constexpr int order = TypeParam::value;
  Random random(2);
  Honesty honesty;
  for (int i = 0; i < 2000; ++i) {
    const double x = random.uniform(-2, 2), h = random.log_uniform(1e-6, 0.1);
    honesty.add(central_difference<order>(
                    [](double s) {
                      return Vec3<double>{std::exp(s), std::exp(-s), s};
                    },
                    x, h),
                {std::exp(x), -std::exp(-x), 1});
    honesty.add(central_difference<order>(
                    [](double s) {
                      return Vec3<double>{s * s * s, 1 - s * s * s * s * s, 7};
                    },
                    x, h),
                {3 * x * x, -5 * x * x * x * x, 0});
  }
}

// Zero derivative, zero function: no estimate of nothing, and no NaN.
TYPED_TEST(CentralDifference, OfConstants) {
  constexpr int order = TypeParam::value;
  const DerivativeEstimate zero = central_difference<order>([](double) { return Vec3<double>{}; }, 0.5);
  EXPECT_EQ(zero.value, Vec3<double>{});
  EXPECT_EQ(zero.error, 0);
  const DerivativeEstimate constant = central_difference<order>(
      [](double) {
        return Vec3<double>{1, 2, 3};
      },
      0.5);
  EXPECT_EQ(constant.value, Vec3<double>{});
  EXPECT_GT(constant.error, 0);
}

// What the steps are chosen for: 2.8e-11, 4.5e-13, 5.9e-14, 1.8e-14 relative to 2π for the default steps.
TYPED_TEST(CentralDifference, ReachesItsMeasuredAccuracy) {
  constexpr int order = TypeParam::value;
  constexpr double expected = order == 2 ? 2.8e-11 : order == 4 ? 4.5e-13 : order == 6 ? 5.9e-14 : 1.8e-14;
  Random random(3);
  const Sphere sphere;
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    const double u = random.uniform(0.01, 0.99), v = random.uniform(0.05, 0.95);
    const auto along_u = [&](double x) { return jet(sphere, x, v).position; };
    worst = std::fmax(worst, norm(central_difference<order>(along_u, u).value - jet(sphere, u, v).dpdu));
  }
  std::cout << worst / two_pi<double>() << '\n';
  EXPECT_LE(worst / two_pi<double>(), 2 * expected);  // twice: other points than those measured
}

// The default steps keep x ± k h exact on the grid of 2^-52, so that no rounding of the abscissa enters.
TYPED_TEST(CentralDifference, StepsAreExactAbscissae) {
  constexpr int order = TypeParam::value;
  constexpr double h = central_step<order>();
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const double x = static_cast<double>(random.bits() >> 12) * 0x1p-52;
    for (int k = 1; k <= order; ++k) {
      EXPECT_EQ((x + k * h) - x, k * h);
      EXPECT_EQ(x - (x - k * h), k * h);
    }
  }
}

}  // namespace
}  // namespace darboux::test
