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

namespace darboux {
namespace {

struct Storage {
  const char* name;
  std::function<double(double)> stored;
};
double printed(const char* format, double x) {
  char text[64];
  std::snprintf(text, sizeof text, format, x);
  return std::stod(text);
}
const std::vector<Storage>& storages() {
  static const std::vector<Storage> all{
      {"float", [](double x) { return static_cast<double>(static_cast<float>(x)); }},
      {"6 decimals", [](double x) { return printed("%.6f", x); }},
      {"4 decimals", [](double x) { return printed("%.4f", x); }},
      {"6 digits", [](double x) { return printed("%.6g", x); }}};
  return all;
}

// A grid of columns times rows, poles and seams left out; the positions are those of the uvs before both are
// stored.
PointCloud grid(const PlacedSurface& surface, int columns, int rows, const Storage& storage) {
  PointCloud cloud;
  for (int k = 0; k < rows; ++k)
    for (int i = 0; i < columns; ++i) {
      const Vec2<double> uv{(i + 0.5) / columns, (k + 0.5) / rows};
      const Vec3<double> p = surface.position(uv);
      cloud.uvs.push_back({storage.stored(uv.x), storage.stored(uv.y)});
      cloud.positions.push_back({storage.stored(p.x), storage.stored(p.y), storage.stored(p.z)});
    }
  return cloud;
}

PointFit fitted(const PointCloud& cloud) {
  PointFitOptions options;
  options.with_uv = true;
  return fit_points_with_uv(cloud, options);
}

// The kind, by `auto`, and its parameters within what the fit says of them.
void expect_found(const PlacedSurface& truth, const PointCloud& cloud, const std::string& text) {
  SCOPED_TRACE(text);
  const PointFit fit = fitted(cloud);
  ASSERT_TRUE(fit.usable) << fit.reason;
  ASSERT_EQ(fit.surface->surface.info().name, truth.surface.info().name);
  EXPECT_EQ(fit.surface->uv.name, "as stored");
  const auto expected = truth.surface.parameters(), found = fit.surface->surface.parameters();
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_LE(std::fabs(found[k].value - expected[k].value), 6 * fit.standard_errors[k].value)
        << expected[k].name << ": " << found[k].value << ", expected " << expected[k].value;
}

constexpr std::pair<int, int> grids[] = {{20, 20}, {60, 60}, {206, 5}};

TEST(RoundedUv, EveryKindIsFoundInEveryStorage) {
  std::mt19937_64 random(11);
  std::size_t next = 0;
  for (const std::string_view kind : fitted_kinds())
    for (const Storage& storage : storages()) {
      const auto [columns, rows] = grids[next++ % std::size(grids)];
      const PlacedSurface truth{make_surface(kind), random_pose(random, 2)};
      expect_found(truth, grid(truth, columns, rows, storage),
                   std::string(kind) + ", " + storage.name + ", " + std::to_string(columns) + " x " +
                       std::to_string(rows));
    }
}

// Where the axes are the world's, most coordinates of a row round alike.
TEST(RoundedUv, ASphereOnAGridIsNoEllipsoid) {
  for (const auto& [columns, rows] : grids)
    for (int k = 0; k < 8; ++k)
      for (const Storage& storage : storages()) {
        PlacedSurface truth{make_surface("sphere").with(std::vector{1 + 0.37 * k})};
        if (k % 2 == 1) truth.placement.translation() = Eigen::Vector3d(0.3, 0.2, 5);
        expect_found(truth, grid(truth, columns, rows, storage),
                     std::to_string(k) + ", " + storage.name + ", " + std::to_string(columns) + " x " +
                         std::to_string(rows));
      }
}

// An ellipsoid's semi-axes differ by ten times what floats leave, or more.
TEST(RoundedUv, AnEllipsoidThatRoundingsDoNotExplainIsOne) {
  for (const auto& [columns, rows] : grids)
    for (const double by : {1e-5, 1e-3}) {
      const PlacedSurface truth{make_surface("ellipsoid").with(std::vector{1 + by, 1.0, 1 - by})};
      expect_found(
          truth, grid(truth, columns, rows, storages().front()),
          "by " + std::to_string(by) + ", " + std::to_string(columns) + " x " + std::to_string(rows));
    }
}

// Noise beyond the steps dithers them: what is stated of the radius is what the unrounded points tell.
TEST(RoundedUv, NoiseLeavesTheErrorsAsTheyAre) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const PlacedSurface truth{make_surface("sphere"), random_pose(random, 1)};
  PointCloud exact = grid(truth, 40, 20, {"as it is", [](double x) { return x; }});
  for (Vec3<double>& p : exact.positions)
    p = p + 1e-3 * Vec3<double>{normal(random), normal(random), normal(random)};
  PointCloud rounded = exact;
  const Storage& storage = storages()[2];
  for (Vec3<double>& p : rounded.positions)
    p = {storage.stored(p.x), storage.stored(p.y), storage.stored(p.z)};
  const PointFit a = fitted(exact), b = fitted(rounded);
  ASSERT_TRUE(a.usable && b.usable) << a.reason << '\n' << b.reason;
  EXPECT_NEAR(b.standard_errors[0].value / a.standard_errors[0].value, 1, 0.02);
}

}  // namespace
}  // namespace darboux
