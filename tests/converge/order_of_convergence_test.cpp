// The interval of the order covers the order.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/order_of_convergence.h>

namespace darboux::order_of_convergence_test {
namespace {

constexpr std::uint64_t seed = 20261125;

struct Sequence {
  double order;
  std::vector<ErrorsAtWidth> widths;
};

// Five to eight widths, each half the one before:
//   error = h^p (1 + a (h/h0)^q) exp(noise), plus rounding at the floor in squares.
// p from 1/2 to 4; a from -1/2 to 1: up to half or twice the error at the coarsest width; q 1 or 2; noise 0.1
// to 10 % there, as it falls with the square root of the number of vertices: not at all at a pole, like
// sqrt(h) along a seam, like h in the interior. Widths whose error is not ten times the floor are cut off, as
// converge() does.
Sequence sequence(std::mt19937_64& random, int meshes) {
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  constexpr double orders[] = {0.5, 1, 1.5, 2, 3, 4};
  std::normal_distribution<double> normal;
  for (;;) {
    Sequence s{orders[random() % 6], {}};
    const double q = 1 + static_cast<double>(random() % 2), a = uniform(-0.5, 1);
    const double noise = std::exp(uniform(std::log(1e-3), std::log(0.1)));
    const double falls = 0.5 * static_cast<double>(random() % 3);
    const double floor = std::exp2(-s.order * uniform(2.5, 14));
    const int levels = 5 + static_cast<int>(random() % 4);
    for (int k = 0; k < levels; ++k) {
      ErrorsAtWidth width{std::exp2(-k), {}};
      for (int m = 0; m < meshes; ++m)
        width.errors.push_back(std::hypot(std::pow(width.h, s.order) * (1 + a * std::pow(width.h, q)) *
                                              std::exp(noise * std::pow(width.h, falls) * normal(random)),
                                          floor * uniform(0, 1)));
      if (*std::min_element(width.errors.begin(), width.errors.end()) <= 10 * floor) break;
      s.widths.push_back(std::move(width));
    }
    if (s.widths.size() >= 3) return s;
  }
}

// 1000 sequences each; the standard deviation of a coverage of 95 % is 0.7 %.
TEST(OrderOfConvergence, IntervalsCover) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  for (const int meshes : {1, 3, 5}) {
    std::mt19937_64 random(seed);
    constexpr int count = 1000;
    int covered = 0;
    std::vector<double> widths;
    for (int i = 0; i < count; ++i) {
      const Sequence s = sequence(random, meshes);
      const OrderEstimate e = estimate_order(s.widths);
      covered += e.low <= s.order && s.order <= e.high;
      widths.push_back(e.high - e.low);
    }
    std::nth_element(widths.begin(), widths.begin() + count / 2, widths.end());
    std::printf("%d mesh(es) per width: coverage %.1f %%, median width %.3f\n", meshes,
                100.0 * covered / count, widths[count / 2]);
    EXPECT_GE(covered, 920) << meshes;
    EXPECT_LE(covered, 980) << meshes;
  }
}

// Sequences without noise: the interval is what bias may do, and covers all but few.
TEST(OrderOfConvergence, CurvatureCutsOffWhatIsNotAsymptotic) {
  std::vector<ErrorsAtWidth> bent, straight;
  for (int k = 0; k < 7; ++k) {
    const double h = std::exp2(-k);
    bent.push_back({h, {h * h * (1 + h)}});
    straight.push_back({h, {3 * h * h}});
  }
  const OrderEstimate of_bent = estimate_order(bent), of_straight = estimate_order(straight);
  EXPECT_GE(of_bent.first, 2u);
  EXPECT_LE(of_bent.low, 2);
  EXPECT_GE(of_bent.high, 2);
  EXPECT_LT(of_bent.high - of_bent.low, 0.2);
  EXPECT_EQ(of_straight.first, 0u);
  EXPECT_NEAR(of_straight.order, 2, 1e-12);
  EXPECT_LT(of_straight.high - of_straight.low, 1e-9);
}

// The spread of the meshes goes into the interval: twice the spread, twice the width.
TEST(OrderOfConvergence, SpreadOfMeshesWidensTheInterval) {
  double last = 0;
  for (const double spread : {0.01, 0.02, 0.04}) {
    std::vector<ErrorsAtWidth> widths;
    for (int k = 0; k < 5; ++k) {
      const double h = std::exp2(-k);
      widths.push_back({h, {h * std::exp(-spread), h, h * std::exp(spread)}});
    }
    const OrderEstimate e = estimate_order(widths);
    EXPECT_NEAR(e.order, 1, 1e-12);
    if (last > 0) {
      EXPECT_NEAR(e.high - e.low, 2 * last, 1e-9);
    }
    last = e.high - e.low;
  }
}

// The finest width with one mesh only has the spread of the one before.
TEST(OrderOfConvergence, OneMeshHasTheSpreadOfCoarserOnes) {
  std::vector<ErrorsAtWidth> widths;
  for (int k = 0; k < 4; ++k) {
    const double h = std::exp2(-k);
    widths.push_back({h, {h * 0.9, h, h * 1.1}});
  }
  const double before = estimate_order(widths).high;
  widths.back().errors = {widths.back().h};
  EXPECT_GT(estimate_order(widths).high, before);
}

TEST(OrderOfConvergence, RefusesWhatIsNoSequence) {
  EXPECT_TRUE(std::isnan(estimate_order(std::vector<ErrorsAtWidth>{{1, {1}}, {0.5, {0.5}}}).order));
  const std::vector<std::vector<ErrorsAtWidth>> bad{{{1, {1}}, {1, {0.5}}, {0.5, {0.2}}},
                                                    {{1, {1}}, {0.5, {0}}, {0.2, {1}}},
                                                    {{1, {1}}, {0.5, {}}, {0.2, {1}}}};
  for (const auto& widths : bad) EXPECT_THROW(estimate_order(widths), ParameterError);
}

}  // namespace
}  // namespace darboux::order_of_convergence_test
