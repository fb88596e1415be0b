// Exact tangents of coarse meshes of unknown surfaces: their triangles are chords, whose cone they may leave.
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/from_position.h>
#include <darboux/sample_mesh.h>

namespace darboux {
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

bool fails(const Mesh& mesh) {
  for (const Finding& f : assess(mesh).report.findings)
    if (f.severity == Severity::error && f.code == "TANGENT_ANGLE") return true;
  return false;
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

// On 2026-11-27, of seeds 1 to 200: exact tangents of 12 meshes are errors, at borders, where little is known
// of the surface (25 where cones alone decide); of those with tangents turned by 45 degrees 184 fail (188).
TEST(WavyMeshes, ExactTangentsAreSeldomErrors) {
  std::size_t exact = 0, turned = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Mesh mesh = wavy_mesh(seed);
    if (fails(mesh)) ++exact;
    turn_some(mesh, 45, seed);
    if (fails(mesh)) ++turned;
  }
  EXPECT_LE(exact, 1u);  // 3 by cones alone
  EXPECT_GE(turned, 54u);
}

}  // namespace
}  // namespace darboux
