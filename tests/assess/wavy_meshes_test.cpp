// Exact tangents of coarse meshes of unknown surfaces: their triangles are chords, whose cone they may leave.
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/from_position.h>
#include <darboux/sample_mesh.h>

#include "random_meshes.h"
#include "thinning.h"

namespace darboux::wavy_meshes_test {
namespace {

// A sheared, twisted sheet with two waves along each axis, at random.
struct Wavy {
  struct Wave {
    double size, of_u, from_u, of_v, from_v;  // turns
  };
  double shear = 0, twist = 0;
  std::array<std::array<Wave, 2>, 3> waves{};

  static constexpr SurfaceInfo info{"wavy", "a sheet with random waves", Coordinate::linear,
                                    Coordinate::linear};
  template <class S>
  Vec3<S> position(const S& u, const S& v) const {
    const auto along = [&](std::size_t axis) {
      S sum = lift<S>(0.0);
      for (const Wave& w : waves[axis])
        sum = sum + lift<S>(w.size) * sincos_turns(S(lift<S>(w.of_u) * u + lift<S>(w.from_u))).sin *
                        sincos_turns(S(lift<S>(w.of_v) * v + lift<S>(w.from_v))).cos;
      return sum;
    };
    const S two = lift<S>(2.0);
    return {two * u + lift<S>(shear) * v + along(0), two * v + along(1), lift<S>(twist) * u * v + along(2)};
  }
};

Mesh wavy_mesh(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  Wavy surface{between(-1.5, 1.5), between(-1, 1), {}};
  for (auto& axis : surface.waves)
    for (Wavy::Wave& w : axis)
      w = {between(-0.08, 0.08), between(0.3, 2.5), between(0, 1), between(0.3, 2.5), between(0, 1)};
  constexpr std::array<int, 6> sizes{6, 8, 10, 12, 16, 24};
  const int columns = sizes[random() % sizes.size()], rows = sizes[random() % sizes.size()];
  return sample_mesh(FromPosition<Wavy>{surface}, {.columns = columns, .rows = rows});
}

// Corners whose tangents leave the cones of their triangles, and what is said of them.
struct Outside {
  std::size_t corners = 0, errors = 0;
  std::size_t warnings = 0;  // of neighbouring vertices that allow it, or of few corners
};

Outside outside_of(const Mesh& mesh) {
  const MeshReport report = assess(mesh).report;
  Outside result{report.triangles->outside};
  for (const Finding& f : report.findings) {
    if (f.code != "TANGENT_ANGLE") continue;
    if (f.severity == Severity::error) result.errors += f.count;
    for (const char* reason : {"neighbouring vertices allow it", "few corners, told by their own triangles"})
      if (f.message.find(reason) != std::string::npos) result.warnings += f.count;
  }
  return result;
}

// Turns the tangents of some vertices about their normals.
void turn_some(Mesh& mesh, double deg, unsigned seed) {
  std::mt19937 random(seed);
  const double a = deg * std::numbers::pi / 180;
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    if (random() % 30 != 0) continue;
    const Vec3<double> t = mesh.tangents[v].xyz(), b = cross(mesh.normals[v], t);
    const Vec3<double> turned = std::cos(a) * t + std::sin(a) * b;
    mesh.tangents[v] = {turned.x, turned.y, turned.z, mesh.tangents[v].w};
  }
}

// Prints the figures of docs/decisions/0020.
TEST(WavyMeshes, ExactTangentsAreSeldomErrors) {
  struct Sum {
    std::size_t meshes = 0, failing = 0, corners = 0, errors = 0;
    void add(const Outside& outside) {
      EXPECT_EQ(outside.errors + outside.warnings, outside.corners);
      meshes += outside.corners > 0, failing += outside.errors > 0;
      corners += outside.corners, errors += outside.errors;
    }
  };
  // As they are, turned by 20 degrees and by 45: exact tangents, then MikkTSpace's.
  std::array<std::array<Sum, 3>, 2> sums;
  const unsigned last_seed = 100 / static_cast<unsigned>(std::min(test::thinning(), 3));
  for (unsigned seed = 1; seed <= last_seed; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mesh mesh = wavy_mesh(seed);
    for (auto& [as_is, by_20, by_45] : sums) {
      const Outside outside = outside_of(mesh);
      as_is.add(outside);
      for (const double deg : {20.0, 45.0}) {
        Mesh turned = mesh;
        turn_some(turned, deg, seed);
        (deg < 30 ? by_20 : by_45).add(outside_of(turned));
      }
      test::bake(mesh);
    }
  }
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      const Sum& sum = sums[k][i];
      std::printf("%s%s: outside their cones %zu corners of %zu meshes, errors %zu of %zu\n",
                  std::array{"exact", "MikkTSpace's"}[k],
                  std::array{"", " turned by 20 deg", " turned by 45 deg"}[i], sum.corners, sum.meshes,
                  sum.errors, sum.failing);
    }
  const auto& [exact, mikktspaces] = sums;
  EXPECT_EQ(mikktspaces[0].corners, 0u);
  // Measured, less a few: some of the turned tangents of coarse meshes stay within their cones.
  EXPECT_LE(exact[0].failing, (3 * last_seed + 99) / 100);
  EXPECT_GE(100 * exact[1].failing, 25 * last_seed);
  EXPECT_GE(100 * exact[2].failing, 68 * last_seed);
  EXPECT_GE(100 * exact[2].errors, 95 * exact[2].corners);
  EXPECT_GE(100 * mikktspaces[1].failing, 48 * last_seed);
  EXPECT_GE(100 * mikktspaces[2].failing, 90 * last_seed);
  EXPECT_GE(100 * mikktspaces[2].errors, 97 * mikktspaces[2].corners);
}

}  // namespace
}  // namespace darboux::wavy_meshes_test
