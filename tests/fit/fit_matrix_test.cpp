// Some eighty cells of the matrix of fits (tests/statistics/matrix.cpp), a quarter of them at a landing,
// twelve data sets each, every third under auto as well: what is stated holds in every one, up to chance of
// one in a million. All of the matrix: tests/statistics/matrix.sh.
#include "fit_matrix.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "thinning.h"

namespace darboux::test::fit_matrix_test {
namespace {

struct Cells {
  std::size_t count;
  std::string_view outliers_and_sigma;
  std::vector<std::string_view> regions;
};

std::vector<matrix::Cell> cells_of(std::string_view kind) {
  std::vector<Cells> groups{{50, "/0%/1e-2", {"full", "half"}},
                            {1000, "/0%/3e-2", {"half"}},
                            {1000, "/30% scattered/1e-4", {"full", "half"}},
                            {1000, "/30% scattered/1e-2", {"full", "half", "quarter"}},
                            {1000, "/50% scattered/1e-2", {"full", "half", "quarter"}}};
  if (kind != "cone") groups[0].regions.push_back("quarter");
  // Small patches, where outliers beyond them have a long lever, and few points.
  if (kind == "plane" || kind == "sphere" || kind == "cylinder")
    groups[3].regions.push_back("30 degree patch");
  if (kind == "plane" || kind == "sphere") {
    groups[0].regions.push_back("30 degree patch");
    groups.push_back({10, "/0%/1e-2", {"full", "half"}});
  }
  std::vector<matrix::Cell> result;
  for (const matrix::Cell& cell : matrix::cells())
    for (const Cells& group : groups)
      for (const std::string_view region : group.regions)
        if (cell.key() == std::string(kind) + "/" + std::string(region) + "/" + std::to_string(group.count) +
                              std::string(group.outliers_and_sigma))
          result.push_back(cell);
  return result;
}

class FitMatrix : public testing::TestWithParam<std::string_view> {};

TEST_P(FitMatrix, WhatIsStatedHolds) {
  constexpr std::uint64_t sets = 12;
  const std::vector<matrix::Cell> cells = cells_of(GetParam());
  ASSERT_GE(cells.size(), 8U);
  matrix::Hits wrong_kind;
  // At a landing every fourth one, from another on for each kind.
  auto number =
      std::find(std::begin(matrix::kinds), std::end(matrix::kinds), GetParam()) - std::begin(matrix::kinds);
  std::size_t taken = 0;
  for (const matrix::Cell& cell : cells) {
    if (thinning() > 1 && number++ % 4 != 0) continue;
    ++taken;
    matrix::Tally tally;
    for (std::uint64_t run = 0; run < sets; ++run)
      tally.add(matrix::run_of(cell, run, {.automatic = run % 3 == 0}), cell);
    EXPECT_EQ(tally.outside(cell, matrix::Tally::Judge::no_times), "")
        << cell.key() << ", data sets 0 to " << sets - 1 << '\n'
        << tally.reasons_text();
    EXPECT_GE(4 * tally.usable, 3 * sets) << cell.key() << '\n' << tally.reasons_text();
    wrong_kind += tally.hits[6];
  }
  // A few data sets of a cell show little, those of all cells more.
  EXPECT_GE(6 * wrong_kind.n, sets * taken);
  EXPECT_LE(wrong_kind.k, thinning() > 1 ? 0U : 1U)
      << wrong_kind.k << " of " << wrong_kind.n << " of the wrong kind";
}

// The data sets of a cell.
std::uint64_t runs() {
  return thinning() == 1 ? 12 : 6;
}

// The first runs of some cells.
matrix::Tally tally_of(const std::vector<std::string_view>& keys) {
  matrix::Tally tally;
  std::size_t found = 0;
  for (const matrix::Cell& cell : matrix::cells()) {
    if (std::find(keys.begin(), keys.end(), cell.key()) == keys.end()) continue;
    ++found;
    for (std::uint64_t run = 0; run < runs(); ++run) tally.add(matrix::run_of(cell, run), cell);
  }
  EXPECT_EQ(found, keys.size());
  return tally;
}

// Ten points on a noisy patch are a plane, or a sphere, as well as what they are: of 48 such sets 20 were
// "converged" as another kind.
TEST(FitFewPoints, AutoDoesNotChooseAmongWhatTheyCannotTell) {
  const matrix::Tally tally =
      tally_of({"cone/30 degree patch/10/0%/1e-2", "cone/half/10/0%/3e-2",
                "cylinder/30 degree patch/10/0%/3e-2", "cylinder/thin strip/10/0%/1e-2"});
  EXPECT_LE(3 * tally.hits[6].k, runs()) << tally.reasons_text();  // of four cells
}

TEST(FitFewPoints, AutoFindsWhatTheyTell) {
  const matrix::Tally tally =
      tally_of({"plane/full/10/0%/1e-4", "sphere/half/10/0%/1e-4", "cone/half/10/0%/1e-4"});
  EXPECT_EQ(tally.hits[6].k, 0U) << tally.reasons_text();
  EXPECT_GE(2 * tally.hits[7].k, 5 * runs()) << tally.reasons_text();  // of three cells
}

// Tubes that are thin beside the noise of the points' normals, among as many outliers: by samples these were
// not found by name, and one was a plane under auto.
TEST(FitThinTubes, AreFoundAmongAsManyOutliers) {
  const std::vector<matrix::Cell> cells = matrix::cells();
  const auto cell = std::find_if(cells.begin(), cells.end(), [](const matrix::Cell& c) {
    return c.key() == "torus/full/1000/50% scattered/3e-2";
  });
  ASSERT_NE(cell, cells.end());
  for (const std::uint64_t number : {14U, 29U, 32U, 36U, 46U, 47U, 53U, 54U, 59U}) {
    const matrix::Run run = matrix::run_of(*cell, number);
    EXPECT_TRUE(run.usable) << "data set " << number << ": " << run.reason;
    EXPECT_EQ(run.found, "torus") << "data set " << number << ": " << run.auto_reason;
    EXPECT_LT(run.mahalanobis, 9) << "data set " << number;  // three standard errors of each parameter
  }
}

// A cluster that straddles the surface was taken for noise, and a half of the intervals held.
TEST(FitClusters, AreNoNoise) {
  const matrix::Tally tally =
      tally_of({"sphere/full/1000/30% cluster/3e-2", "sphere/quarter/1000/30% cluster/3e-2",
                "cylinder/full/1000/30% cluster/3e-2", "cylinder/30 degree patch/1000/30% cluster/3e-2"});
  for (const std::size_t k : {2, 4, 5})
    EXPECT_GE(100 * tally.hits[k].k, 75 * tally.hits[k].n) << matrix::Tally::names[k] << '\n'
                                                           << tally.reasons_text();
  EXPECT_GE(6 * tally.usable, 20 * runs()) << tally.reasons_text();  // of four cells
}

// Of two spheres of as many points a fit may be either, and is judged by that: with errors about the bound. A
// mean of six chi squared of 4 degrees of freedom over 4 is above 3.04 once in a million; an error of 1.1
// times the bound is 1.21 times that.
TEST(FitSecondSurface, EitherOfTwoSpheresIsRight) {
  const matrix::Cell cell{1, 0, 2, 6, 1};
  ASSERT_EQ(cell.key(), "sphere/full/1000/50% second surface/1e-2");
  double sum = 0;
  std::size_t usable = 0, of_second = 0;
  for (std::uint64_t number = 0; number < 8; ++number) {
    const matrix::Run run = matrix::run_of(cell, number, {.automatic = false});
    if (!run.usable) continue;
    ++usable;
    of_second += run.is_second;
    sum += run.mahalanobis;
  }
  EXPECT_GE(usable, 6U);
  EXPECT_GE(of_second, 1U) << "no fit is of the second sphere, and nothing is tested";
  EXPECT_LT(sum, 3.7 * static_cast<double>(usable));
}

// Runs 0 to 11 of torus/thin strip/1000/`outliers`/1e-2, fitted as tori.
template <class Each>
void for_each_strip(std::string_view outliers, Each each) {
  const std::string key = "torus/thin strip/1000/" + std::string(outliers) + "/1e-2";
  for (const matrix::Cell& cell : matrix::cells())
    if (cell.key() == key)
      for (std::uint64_t run = 0; run < 12; ++run)
        each(matrix::run_of(cell, run, {.automatic = false}), key + ", data set " + std::to_string(run));
}

// Two sheets that are closer than the noise share it out: such tori were "usable", with none of their
// intervals right.
TEST(FitStrips, NoTorusCrossesItselfWithinTheNoise) {
  int usable = 0;
  for_each_strip("0%", [&](const matrix::Run& run, const std::string& name) {
    if (!run.usable) return;
    ++usable;
    EXPECT_LT(run.mahalanobis, 20) << name;  // squared, per parameter
  });
  EXPECT_GE(usable, 3);
}

TEST(FitStrips, ToriThatThePointsCannotTellApartAreUndetermined) {
  int undetermined = 0;
  for_each_strip("50% scattered", [&](const matrix::Run& run, const std::string&) {
    undetermined += run.reason.starts_with("undetermined: torus of major radius ") &&
                    run.reason.find(" or of major radius ") != std::string::npos;
  });
  EXPECT_GE(undetermined, 2);
}

// Surfaces of several kinds are like a small patch, or a strip, to second order. What the others found leads
// to the torus. Without, one and three of twelve clouds are of another kind, "converged", and two of the
// strips are tori.
TEST(FitStrips, AutoTellsATorusFromWhatIsLikeIt) {
  const auto found = [](const std::string& key) {
    std::map<std::string, int> count;
    for (const matrix::Cell& cell : matrix::cells())
      if (cell.key() == key)
        for (std::uint64_t run = 0; run < 12; ++run) ++count[matrix::run_of(cell, run).found];
    return count;
  };
  std::map<std::string, int> patches = found("torus/30 degree patch/1000/0%/1e-2"),
                             strips = found("torus/thin strip/1000/0%/1e-2");
  const auto wrong = [](std::map<std::string, int>& count) { return 12 - count["torus"] - count[""]; };
  EXPECT_EQ(wrong(patches), 0);
  EXPECT_GE(patches["torus"], 10);
  // A plane, which is as likely, and an ellipsoid whose rim, tighter than its noise, lies among the points.
  EXPECT_LE(wrong(strips), 2);
  EXPECT_GE(strips["torus"], 4);
}

INSTANTIATE_TEST_SUITE_P(Kinds, FitMatrix, testing::ValuesIn(matrix::kinds),
                         [](const auto& each) { return std::string(each.param); });

// The outer half of a ring on a half turn: an ellipsoid, with more unknowns, is found at once and is nearly
// as good; a torus takes more rounds. Of twelve clouds seven were ellipsoids, "converged".
TEST(FitStrips, AnEllipsoidDoesNotEndTheSearchForATorus) {
  int wrong = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    PortableRandom random(seed);
    PointCloud cloud;
    for (int i = 0; i < 800; ++i) {
      const double u = std::numbers::pi * random.uniform(), v = random.uniform(-1, 1);
      const double from_axis = 3 + std::cos(v);
      cloud.positions.push_back(
          from_eigen(Eigen::Vector3d(from_axis * std::cos(u), from_axis * std::sin(u), std::sin(v)) +
                     0.03 * random.normals()));
    }
    const PointFit fit = fit_points(cloud);
    wrong += fit.usable && fit.surface->surface.info().name != "torus";
  }
  EXPECT_LE(wrong, 1) << "seeds 1 to 12";
}

}  // namespace
}  // namespace darboux::test::fit_matrix_test
