// Smaller versions of the rows of docs/reports/fit.md: their first data sets, with a quarter of the points.
// What they tell of scatter grows with the number of sets alone; a bias shows half as well as in the whole
// statistics, of which fit_statistics --replay ROW SEED 2500 shows one of these sets.
// Bounds: what is required, widened by four standard deviations of what so few runs tell; a fit that just
// meets the requirement misses one of these tests once in 10^4.
#include <cmath>
#include <cstdint>
#include <map>

#include <gtest/gtest.h>

#include "statistics/rows.h"
#include "thinning.h"

namespace darboux::fit_points_statistics_test {
namespace {

using test::slow_build;
using test::thinning;

constexpr std::size_t count = 2500;

// The noise of some 2000 inliers is known to 1 / sqrt(2 * 2000) = 1.6 %; of the mean over runs four standard
// deviations, and 1 % as outliers are not of one density all over.
void expect_noise(double sum_of_ratios, double runs, const std::string& kind) {
  EXPECT_NEAR(sum_of_ratios / runs, 1, 0.01 + 4 * 0.016 / std::sqrt(runs)) << kind;
}

// The mean of e^T I e / n over k runs scatters by sqrt(2 / (n k)) of itself.
TEST(FitPointsStatistics, TheErrorIsNearTheBound) {
  std::map<std::string, std::pair<double, int>> sums;
  std::map<std::string, double> ratios;
  const std::size_t sets = 270 / thinning(3);
  for (std::size_t seed = 0; seed < sets; ++seed) {
    const Outcome outcome = outcome_of("efficiency", seed, count);
    ASSERT_TRUE(outcome.success()) << "efficiency " << seed << ": " << outcome.mahalanobis << ' '
                                   << outcome.reason;
    auto& [sum, runs] = sums[case_of("efficiency", seed).kind];
    sum += outcome.mahalanobis;
    ++runs;
    ratios[case_of("efficiency", seed).kind] += outcome.sigma_ratio;
  }
  for (const auto& [kind, entry] : sums) {
    const auto& [sum, runs] = entry;
    const int n = TrueShape(make_points(kind, {.count = 1})).parameters();
    const double required = required_efficiency(kind);
    EXPECT_LE(sum / runs, required * required * (1 + 4 * std::sqrt(2.0 / (n * runs)))) << kind;
    expect_noise(ratios[kind], runs, kind);
  }
}

TEST(FitPointsStatistics, NoFailureAtTwentyPercentOutliers) {
  for (std::size_t seed = 0; seed < static_cast<std::size_t>(240 / thinning(3)); ++seed) {
    const Outcome outcome = outcome_of("success-20", seed, count);
    EXPECT_TRUE(outcome.success()) << "success-20 " << seed << ": " << outcome.mahalanobis << ' '
                                   << outcome.reason;
  }
}

// At most 1 % failures: of 120 sets 1.2, and four standard deviations of the binomial distribution more.
TEST(FitPointsStatistics, FewFailuresAtFortyPercentOutliers) {
  const std::size_t sets = 120 / thinning(3);
  double failures = 0, ratios = 0;
  for (std::size_t seed = 0; seed < sets; ++seed) {
    const Outcome outcome = outcome_of("success-40", seed, count);
    failures += outcome.success() ? 0 : 1;
    ratios += outcome.success() ? outcome.sigma_ratio : 0;
  }
  expect_noise(ratios, static_cast<double>(sets) - failures, "all kinds");
  EXPECT_LE(failures, sets * 0.01 + 4 * std::sqrt(sets * 0.01 * 0.99));
}

TEST(FitPointsStatistics, IntervalsOfFramesCover) {
  struct Count {
    double inside = 0, all = 0;
    void add(double squared, std::size_t degrees) {
      inside += squared <= chi_squared_95[degrees] ? 1 : 0;
      ++all;
    }
    // 93 to 97 %, and four standard deviations of the binomial distribution at 95 %.
    void check(const char* what) const {
      const double margin = 0.02 + 4 * std::sqrt(0.95 * 0.05 / all);
      EXPECT_NEAR(inside / all, 0.95, margin) << what << " of " << all;
    }
  } normals, frames;
  for (std::size_t seed = 0; seed < static_cast<std::size_t>(300 / thinning(3)); ++seed) {
    const Outcome outcome = outcome_of("frames", seed, count);
    ASSERT_TRUE(outcome.success()) << "frames " << seed << ": " << outcome.mahalanobis << ' '
                                   << outcome.reason;
    if (outcome.normal) normals.add(*outcome.normal, 2);
    if (outcome.frame) frames.add(*outcome.frame, 3);
  }
  normals.check("n");
  frames.check("t, b, n");
}

// At most 0.5 % undetermined, none wrong. A landing's 20 sets show a share of 5 %: the whole statistics tell
// more.
TEST(FitPointsStatistics, TheKindIsFound) {
  const std::size_t sets = 120 / thinning();
  double undetermined = 0;
  for (std::size_t seed = 0; seed < sets; ++seed) {
    const Outcome outcome = outcome_of("auto", seed, count);
    if (!outcome.usable)
      ++undetermined;
    else
      EXPECT_EQ(outcome.found, case_of("auto", seed).kind) << "auto " << seed;
  }
  EXPECT_LE(undetermined, sets * 0.005 + 4 * std::sqrt(sets * 0.005));
}

// Kinds, scales and offsets take turns over all sets, which only slow builds cut.
TEST(FitPointsStatistics, NoiseFreePointsGiveEverythingBack) {
  for (const std::string_view row : {"noise-free", "far"})
    for (std::size_t seed = 0; seed < (row == "far" ? 36U : 108U) / (slow_build ? 10 : 1); ++seed) {
      const Outcome outcome = outcome_of(row, seed, count);
      EXPECT_LE(outcome.error, required_exactness(row, case_of(row, seed).options))
          << row << ' ' << seed << ' ' << outcome.reason;
    }
}

// PCL's own test sets, outside this repository: within the tolerance of its tests.
TEST(FitPointsStatistics, PublicPoints) {
  std::size_t found = 0;
  for (const PublicFile& file : public_files) {
    const PublicPoints points = read_public_points(DARBOUX_SHARED "/points", file.name);
    if (!points.found) continue;
    ++found;
    const PointFit fit = fit_points(points.cloud, {.surface = std::string(file.kind)});
    ASSERT_TRUE(fit.usable) << file.name << ": " << fit.reason;
    EXPECT_LE(public_error(points.expected, pcl_coefficients(*fit.surface)), points.tolerance)
        << file.name << ' ' << fit.surface->surface.specification();
    // Without its name it is found, whatever the seed, but for the spindle torus of 15 points. A plane
    // through 9 of 27 points of a sphere and a paraboloid near 20 of 50 of a torus are none.
    const bool is_found = file.name != "TorusSelfIntersectSpindle_RANSAC";
    for (int seed = 1; seed <= 6 / thinning(3); ++seed) {
      const PointFit unnamed = fit_points(points.cloud, {.seed = static_cast<std::uint64_t>(seed)});
      EXPECT_EQ(unnamed.usable, is_found) << file.name << ' ' << seed << ": " << unnamed.reason;
      if (is_found) {
        EXPECT_EQ(unnamed.candidates.front().name, file.kind) << file.name << ' ' << seed;
      }
    }
  }
  if (found == 0) GTEST_SKIP() << DARBOUX_SHARED << "/points is not there";
}

}  // namespace
}  // namespace darboux::fit_points_statistics_test
