// What is known of the tiles of one surface: distances, points by which tiles face an eye, cells.
#include "scene/surface_tiles.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/ellipsoid.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test::surface_tiles_test {
namespace {

// From outside, the nearest point of what is convex is that whose normal points here.
TEST(SurfaceTiles, DistancesToEllipsoidsAreExactFromOutside) {
  Random random(31);
  for (int i = 0; i < 300; ++i) {
    const Ellipsoid<> ellipsoid{random.log_uniform(0.02, 5), random.log_uniform(0.02, 5),
                                random.log_uniform(0.02, 5)};
    const AnySurface surface(ellipsoid);
    SurfaceTiles tiles(surface, TileOrder::position);
    for (int k = 0; k < 30; ++k) {
      const double u = random.uniform(), v = random.uniform(0.01, 0.99),
                   distance = random.log_uniform(1e-3, 1e3);
      const Vec3<double> p = surface.jet(u, v).position, from = p + distance * surface.frame(u, v).n;
      const double found = tiles.distance(from).least;
      // Rounding of the point itself, of its normal times the distance, and 2^-46 of the sizes.
      const double size = norm(from) + 5;
      EXPECT_LE(found, distance + 0x1p-50 * size);
      EXPECT_GE(found, distance - 0x1p-43 * size)
          << ellipsoid.semi_axis_x << ' ' << ellipsoid.semi_axis_y << ' ' << ellipsoid.semi_axis_z << " from "
          << u << ' ' << v;
    }
  }
}

// From its centre, its axes and its points.
TEST(SurfaceTiles, DistancesToEllipsoidsFromWithin) {
  Random random(35);
  for (int i = 0; i < 300; ++i) {
    const Vec3<double> axes{random.log_uniform(0.02, 5), random.log_uniform(0.02, 5),
                            random.log_uniform(0.02, 5)};
    const AnySurface surface(Ellipsoid<>{axes.x, axes.y, axes.z});
    SurfaceTiles tiles(surface, TileOrder::position);
    const double shortest = std::fmin(axes.x, std::fmin(axes.y, axes.z));
    const double at_centre = tiles.distance({0, 0, 0}).least;
    EXPECT_LE(at_centre, shortest);
    EXPECT_GE(at_centre, shortest * (1 - 0x1p-36));
    for (const double along : {-1.5, -1.0, -0.5, 0.25, 1.0, 3.0}) {
      for (const Vec3<double>& from : {Vec3<double>{along * axes.x, 0, 0}, Vec3<double>{0, along * axes.y, 0},
                                       Vec3<double>{0, 0, along * axes.z}}) {
        // The end of the axis is a point of the surface.
        const double to_end = std::fabs(1 - 1 / std::fabs(along)) * norm(from);
        const double found = tiles.distance(from).least;
        EXPECT_GE(found, 0);
        EXPECT_LE(found, to_end * (1 + 0x1p-50));
        if (std::fabs(along) > 1) {
          EXPECT_GE(found, to_end - 0x1p-43 * (norm(from) + 5));
        }
      }
    }
    const Vec3<double> on_it = surface.jet(random.uniform(), random.uniform()).position;
    EXPECT_LE(tiles.distance(on_it).least, 0x1p-50 * norm(on_it));
  }
}

// From anywhere, no point of the surface is nearer, and the distance changes by no more than the way.
TEST(SurfaceTiles, NoPointOfAnEllipsoidIsNearer) {
  Random random(32);
  for (int i = 0; i < 60; ++i) {
    const AnySurface surface(
        Ellipsoid<>{random.log_uniform(0.1, 5), random.log_uniform(0.1, 5), random.log_uniform(0.1, 5)});
    SurfaceTiles tiles(surface, TileOrder::position);
    std::vector<Vec3<double>> points;
    for (int k = 0; k < 400; ++k) points.push_back(surface.jet(random.uniform(), random.uniform()).position);
    for (int k = 0; k < 30; ++k) {
      const Vec3<double> from = random.log_uniform(1e-3, 20) * random.direction();
      const double found = tiles.distance(from).least;
      for (const Vec3<double>& p : points) ASSERT_LE(found, norm(from - p));
      const double way = random.log_uniform(1e-6, 1);
      EXPECT_LE(std::fabs(tiles.distance(from + way * random.direction()).least - found),
                way + 0x1p-40 * (norm(from) + 5));
    }
  }
}

// A point that faces the eye says that not all of its tile faces away.
TEST(SurfaceTiles, TilesOfPointsThatFaceTheEyeDoNotFaceAway) {
  Random random(33);
  std::size_t facing = 0, away = 0;
  for (const AnySurface& surface : all_surfaces()) {
    SurfaceTiles tiles(surface, TileOrder::first);
    if (!tiles.known()) continue;
    for (int i = 0; i < 200; ++i) {
      std::uint32_t node = SurfaceTiles::root;
      for (std::uint64_t level = random.bits() % 4; level > 0; --level)
        node = tiles.parts(node, Split::both) + static_cast<std::uint32_t>(random.bits() % 4);
      const Vec3<double> eye = random.log_uniform(0.1, 30) * random.direction();
      for (const bool perspective : {true, false}) {
        const bool faces = tiles.facing_point(node, eye).faces(eye, perspective);
        const TileBounds& bounds = tiles[node].bounds;
        const double bound = perspective ? bounds.facing(eye) : bounds.facing_along(eye);
        if (faces) {
          ASSERT_GT(bound, 0) << surface.info().name;
        }
        facing += faces;
        away += bound < 0;
      }
    }
  }
  EXPECT_GT(facing, 1000u);
  EXPECT_GT(away, 300u);
}

// The cells that a chord asks for keep it, one cut less does not, and so from `least` to `most`. No others of
// as many cuts keep a shorter one with as few samples of the chart.
TEST(ChordLevels, CellsKeepTheChord) {
  Random random(34);
  for (int i = 0; i < 3000; ++i) {
    TileRates rates;
    rates.position_uu = random.uniform() < 0.1 ? 0 : random.log_uniform(1e-3, 1e3);
    rates.position_uv = random.uniform() < 0.1 ? 0 : random.log_uniform(1e-3, 1e3);
    rates.position_vv = random.uniform() < 0.1 ? 0 : random.log_uniform(1e-3, 1e3);
    const int level_u = static_cast<int>(random.bits() % 5), level_v = static_cast<int>(random.bits() % 5);
    const double du = std::ldexp(1, -level_u), dv = std::ldexp(1, -level_v);
    const TileLevels most{finest_level - level_u, finest_level - level_v};
    const ChordLevels levels(rates, du, dv, most);
    const double chord = random.log_uniform(1e-9, 1e3);
    const ChordLevels::Answer answer = levels(chord);
    const auto error = [&](const TileLevels& l) {
      return rates.chord(std::ldexp(du, -l.u), std::ldexp(dv, -l.v));
    };
    const bool all = answer.levels == most;
    if (!all) {
      EXPECT_LE(error(answer.levels), chord);
    }
    EXPECT_TRUE(answer.levels.u <= most.u && answer.levels.v <= most.v);
    // Errors are kept in float32, rounded up.
    const double less = chord * (1 - 0x1p-22);
    if (answer.levels.u > 0 && answer.levels.v > 0) {
      EXPECT_TRUE(error({answer.levels.u - 1, answer.levels.v}) > less ||
                  error({answer.levels.u, answer.levels.v - 1}) > less);
    }
    const auto samples = [&](const TileLevels& l) {
      return (std::ldexp(1, level_u + l.u) + 1) * (std::ldexp(1, level_v + l.v) + 1);
    };
    for (const int more : {-1, 1}) {
      const TileLevels other{answer.levels.u + more, answer.levels.v - more};
      if (other.u < 0 || other.v < 0 || other.u > most.u || other.v > most.v) continue;
      EXPECT_TRUE(error(other) >= error(answer.levels) * (1 - 0x1p-40) ||
                  samples(other) > samples(answer.levels));
    }
    EXPECT_LE(answer.least, chord);
    EXPECT_GT(answer.most, chord);
    if (answer.least > 0) {
      EXPECT_EQ(levels(answer.least).levels, answer.levels);
    }
    if (std::isfinite(answer.most)) {
      EXPECT_EQ(levels(std::nextafter(answer.most, 0)).levels, answer.levels);
      if (answer.least > 0) {
        EXPECT_NE(levels(answer.most).levels, answer.levels);
      }
    }
  }
}

}  // namespace
}  // namespace darboux::test::surface_tiles_test
