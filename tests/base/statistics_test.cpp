#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include <darboux/statistics.h>

namespace darboux::statistics_test {
namespace {

TEST(Summarise, GivesMaxRmsAndNearestRank) {
  std::vector<double> values(100);
  std::iota(values.begin(), values.end(), 1.0);  // 1 .. 100
  std::shuffle(values.begin(), values.end(), std::mt19937_64(1));
  const Statistics s = summarise(values);
  EXPECT_EQ(s.max, 100);
  EXPECT_EQ(s.p95, 95);
  EXPECT_NEAR(s.rms, std::sqrt(100 * 101 * 201 / 6.0 / 100), 1e-12);
  // Nearest rank: the ceil(0.95 n)-th smallest.
  std::vector<double> three{3, 1, 2}, twenty(20, 1.0), twenty_one(21, 1.0);
  EXPECT_EQ(summarise(three).p95, 3);
  twenty[4] = 9;
  EXPECT_EQ(summarise(twenty).p95, 1);
  twenty_one[4] = twenty_one[7] = 9;
  EXPECT_EQ(summarise(twenty_one).p95, 9);
  std::vector<double> none;
  EXPECT_EQ(summarise(none).max, 0);
}

TEST(FitLine, IsExactOnALineAndCoversTheSlope) {
  const std::vector<double> x{1, 2, 3, 4}, y{5, 7, 9, 11};
  const Line line = fit_line(x, y);
  EXPECT_NEAR(line.slope, 2, 1e-14);
  EXPECT_NEAR(line.intercept, 3, 1e-14);
  EXPECT_NEAR(line.slope_high - line.slope_low, 0, 1e-12);
  EXPECT_TRUE(std::isinf(fit_line(std::vector<double>{1, 2}, std::vector<double>{1, 2}).slope_high));
  EXPECT_THROW(fit_line(std::vector<double>{1, 2, 3}, std::vector<double>{1, 2}), ParameterError);
  // 95 % intervals of noisy lines hold the true slope in 95 % of 4000 sets: 3800, standard deviation 14.
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.1);
  int covered = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<double> noisy(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) noisy[k] = 3 + 2 * x[k] + noise(random);
    const Line fit = fit_line(x, noisy);
    covered += fit.slope_low <= 2 && 2 <= fit.slope_high;
  }
  EXPECT_NEAR(covered, 3800, 5 * 14);
}

// Counted values are as many equal ones.
TEST(Statistics, CountedValuesAreManyEqualOnes) {
  std::mt19937_64 random(7);
  for (int run = 0; run < 300; ++run) {
    std::vector<Counted> counted;
    std::vector<double> all;
    const std::size_t n = 1 + random() % 40;
    for (std::size_t i = 0; i < n; ++i) {
      counted.push_back({static_cast<double>(random() % 16), static_cast<std::uint32_t>(1 + random() % 9)});
      all.insert(all.end(), counted.back().count, counted.back().value);
    }
    const Statistics a = summarise(counted), b = summarise(all);
    EXPECT_EQ(a.max, b.max);
    EXPECT_NEAR(a.rms, b.rms, 1e-14 * b.rms);
    EXPECT_EQ(a.p95, b.p95) << "run " << run;
  }
  std::vector<Counted> none;
  EXPECT_EQ(summarise(none).max, 0);
}

}  // namespace
}  // namespace darboux::statistics_test
