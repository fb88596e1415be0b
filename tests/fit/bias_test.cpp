// The mean distance that noise gives points of a curved surface.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "fit/common/noise_bias.h"

namespace darboux::test::bias_test {
namespace {

// Of a point of a sphere with isotropic noise, the mean of the noncentral chi distribution of three degrees
// of freedom less R.
double mean_distance(double radius, double sigma) {
  const double r = radius / sigma;
  return sigma * std::sqrt(2 / std::numbers::pi) * std::exp(-0.5 * r * r) +
         (radius + sigma * sigma / radius) * std::erf(r / std::numbers::sqrt2) - radius;
}

TEST(Bias, IsThatOfASphere) {
  for (const double sigma : {1e-3, 0.05, 0.2}) {
    // The fade-out takes (sigma / R)^4 of it; the difference to R has roundings of 1e-16.
    const double exact = mean_distance(1, sigma);
    EXPECT_NEAR(fit::bias(sigma, 2), exact, 1.01 * std::pow(sigma, 4) * exact + 1e-15) << sigma;
    EXPECT_EQ(fit::bias(sigma, -2), -fit::bias(sigma, 2));
  }
}

// x / (1 + x^4) is largest at 3^(-1/4).
TEST(Bias, FadesOutWhereRadiiComeNearTheNoise) {
  const double most = 0.75 * std::pow(3, -0.25);
  for (int i = 0; i < 2000; ++i) {
    const double now = fit::bias(1, 1e-2 * i), next = fit::bias(1, 1e-2 * (i + 1));
    EXPECT_LE(now, most * (1 + 1e-15));
    EXPECT_NEAR(next, now, 0.51e-2);  // no slope is above that at 0, a half
  }
  EXPECT_NEAR(fit::bias(1, 2e4), 0, 1.01e-12);
  for (const double none : {std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_EQ(fit::bias(1, none), 0);
}

}  // namespace
}  // namespace darboux::test::bias_test
