// Points and uvs as files store them: roundings that rows of a grid have in common are no shape.
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <random>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include <darboux/fit_mesh.h>

#include "fit/uv/fit_uv.h"
#include "random_pose.h"
#include "thinning.h"

namespace darboux::rounded_uv_test {
namespace {

struct Storage {
  const char* name;
  std::function<double(double)> stored;
  double error;  // of a number about 1
};
double printed(const char* format, double x) {
  char text[64];
  std::snprintf(text, sizeof text, format, x);
  return std::stod(text);
}
const std::vector<Storage>& storages() {
  static const std::vector<Storage> all{
      {"float", [](double x) { return static_cast<double>(static_cast<float>(x)); }, 0x1p-24},
      {"6 decimals", [](double x) { return printed("%.6f", x); }, 0.5e-6},
      {"4 decimals", [](double x) { return printed("%.4f", x); }, 0.5e-4},
      {"6 digits", [](double x) { return printed("%.6g", x); }, 5e-6}};
  return all;
}

// Columns times rows; vertices from pole to pole, or the middles of cells.
struct Grid {
  int columns, rows;
  bool vertices = false;

  std::string text() const {
    return std::to_string(columns) + " x " + std::to_string(rows) + (vertices ? " vertices" : "");
  }
  std::vector<Vec2<double>> uvs() const {
    const double first = vertices ? 0 : 0.5;
    std::vector<Vec2<double>> result;
    for (int k = 0; k < (vertices ? rows + 1 : rows); ++k)
      for (int i = 0; i < columns; ++i) result.push_back({(i + first) / columns, (k + first) / rows});
    return result;
  }
};
// Of 20, 40 and 80 the decimals end: exact ones look like rounded ones.
const std::vector<Grid>& grids() {
  static const std::vector<Grid> all{{20, 20}, {60, 60}, {206, 5}, {40, 20, true}, {80, 40, true}};
  return all;
}

// The positions are those of the uvs before both are stored.
PointCloud stored(const PlacedSurface& surface, const Grid& grid, const Storage& storage) {
  PointCloud cloud;
  for (const Vec2<double>& uv : grid.uvs()) {
    const Vec3<double> p = surface.position(uv);
    cloud.uvs.push_back({storage.stored(uv.x), storage.stored(uv.y)});
    cloud.positions.push_back({storage.stored(p.x), storage.stored(p.y), storage.stored(p.z)});
  }
  return cloud;
}

PointFit fitted(const PointCloud& cloud, const char* surface = "auto") {
  PointFitOptions options;
  options.with_uv = true;
  options.surface = surface;
  return fit_points_with_uv(cloud, options);
}

// The kind, by `auto`, and its parameters within what the fit says of them, which is no more than what is
// stored errs by, times what its shape makes of it.
void expect_found(const PlacedSurface& truth, const Grid& grid, const Storage& storage) {
  SCOPED_TRACE(truth.surface.specification() + ", " + storage.name + ", " + grid.text());
  const PointFit fit = fitted(stored(truth, grid, storage));
  ASSERT_TRUE(fit.usable) << fit.reason;
  ASSERT_EQ(fit.surface->surface.info().name, truth.surface.info().name);
  EXPECT_EQ(fit.surface->uv.name, "as stored");
  const auto expected = truth.surface.parameters(), found = fit.surface->surface.parameters();
  const double size = 1 + truth.placement.translation().norm();
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_LE(std::fabs(found[k].value - expected[k].value), 6 * fit.standard_errors[k].value)
        << expected[k].name << ": " << found[k].value << ", expected " << expected[k].value;
    EXPECT_LE(fit.standard_errors[k].value, 30 * size * storage.error) << expected[k].name;
  }
}

TEST(RoundedUv, EveryKindIsFoundInEveryStorage) {
  std::mt19937_64 random(11);
  std::size_t next = 0;
  for (const std::string_view kind : fitted_kinds())
    for (const Storage& storage : storages())
      expect_found({make_surface(kind), random_pose(random, 2)}, grids()[next++ % grids().size()], storage);
}

// Where the axes are the world's, most coordinates of a row round alike.
TEST(RoundedUv, ASphereOnAGridIsNoEllipsoid) {
  int turn = 0;
  for (const Grid& grid : grids()) {
    ++turn;
    for (int k = 0; k < 8; ++k)
      for (const Storage& storage : storages()) {
        if (!test::is_taken(turn + k)) continue;
        PlacedSurface truth{make_surface("sphere").with(std::vector{1 + 0.37 * k})};
        if (k % 2 == 1) truth.placement.translation() = Eigen::Vector3d(0.3, 0.2, 5);
        expect_found(truth, grid, storage);
      }
  }
}

// An ellipsoid's semi-axes differ by ten times what floats leave, or more.
TEST(RoundedUv, AnEllipsoidThatRoundingsDoNotExplainIsOne) {
  for (const Grid& grid : grids())
    for (const double by : {1e-5, 1e-3})
      expect_found({make_surface("ellipsoid").with(std::vector{1 + by, 1.0, 1 - by})}, grid,
                   storages().front());
}

// With noise in the positions, and uvs of exact or of three decimals: the radius errs by what is stated. Of
// 60 runs the root mean square of errors over standard errors is within 1 ± 3/sqrt(120) where all errors are
// independent. Roundings are counted by half of the greatest, 1.15 times less than they are, and those of u
// as if they moved the radius too: it errs by less than is stated.
TEST(RoundedUv, TheStatedErrorIsTheTrueOneWithNoise) {
  std::normal_distribution<double> normal;
  const Storage exact{"exact", [](double x) { return x; }, 0},
      three{"3 decimals", [](double x) { return printed("%.3f", x); }, 0.5e-3};
  // The steps of the rounded grids are no multiples of the last decimal: else all would have one error.
  const std::vector<std::pair<Grid, Storage>> cases{
      {{20, 20}, exact}, {{40, 20, true}, exact}, {{61, 13}, three}, {{17, 29}, three}};
  for (const auto& [grid, storage] : cases) {
    double squares = 0;
    constexpr int runs = 60;
    for (int run = 0; run < runs; ++run) {
      std::mt19937_64 random(static_cast<std::uint64_t>(run));
      // A phase of its own: roundings are others in each run.
      const double radius = std::uniform_real_distribution<double>(1, 2)(random);
      const PlacedSurface truth{make_surface("disk").with(std::vector{radius, 0.3}), random_pose(random, 1)};
      PointCloud cloud;
      const double shift = storage.error > 0 ? std::uniform_real_distribution<double>(0, 0.01)(random) : 0;
      for (const Vec2<double>& at : grid.uvs()) {
        const Vec2<double> uv{at.x + shift, at.y + shift};
        cloud.uvs.push_back({storage.stored(uv.x), storage.stored(uv.y)});
        cloud.positions.push_back(truth.position(uv) +
                                  1e-3 * Vec3<double>{normal(random), normal(random), normal(random)});
      }
      const PointFit fit = fitted(cloud, "disk");
      ASSERT_TRUE(fit.usable) << fit.reason;
      const double error = fit.surface->surface.parameters()[0].value - radius;
      squares += std::pow(error / fit.standard_errors[0].value, 2) / runs;
    }
    EXPECT_LE(std::sqrt(squares), 1.3) << grid.text() << ", " << storage.name;
    EXPECT_GE(std::sqrt(squares), storage.error > 0 ? 0.25 : 0.7) << grid.text() << ", " << storage.name;
  }
}

}  // namespace
}  // namespace darboux::rounded_uv_test
