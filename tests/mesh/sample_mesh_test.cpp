#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>

namespace darboux::sample_mesh_test {
namespace {

SampleMeshOptions grid(int columns, int rows) {
  return {.columns = columns, .rows = rows};
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += norm(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])) / 2;
  return sum;
}

TEST(SampleMesh, HasTheCountsOfItsGrid) {
  const Mesh split = sample_mesh(Torus{1.0, 0.4}, grid(8, 5));
  EXPECT_EQ(split.positions.size(), 9u * 6u);
  EXPECT_EQ(split.triangles.size(), 2u * 8u * 5u);
  SampleMeshOptions shared = grid(8, 5);
  shared.shared_seam = true;
  EXPECT_EQ(sample_mesh(Torus{1.0, 0.4}, shared).positions.size(), 8u * 5u);
  EXPECT_EQ(sample_mesh(Cylinder{1.0, 1.0}, shared).positions.size(), 8u * 6u);
  // A sphere: one triangle a column at each pole, and the pole vertex no triangle uses left out.
  const Mesh sphere = sample_mesh(Sphere{1.0}, grid(8, 5));
  EXPECT_EQ(sphere.triangles.size(), 2u * 8u * 4u);
  EXPECT_EQ(sphere.positions.size(), 9u * 4u + 2u * 8u);
}

TEST(SampleMesh, CoversTheSurface) {
  // Inscribed triangles lose a share of O(h²) of the area; at 256 x 128 less than 1e-3.
  constexpr double pi = 3.14159265358979323846;
  EXPECT_NEAR(area(sample_mesh(Sphere{2.0}, grid(256, 128))), 16 * pi, 16 * pi * 1e-3);
  EXPECT_NEAR(area(sample_mesh(Torus{2.0, 0.5}, grid(256, 128))), 4 * pi * pi, 4 * pi * pi * 1e-3);
  EXPECT_NEAR(area(sample_mesh(Cylinder{1.0, 3.0}, grid(256, 128))), 6 * pi, 6 * pi * 1e-3);
}

// Over every surface and option: stored data are the surface's at the vertex's own uv, wound as n, w as
// documented.
TEST(SampleMesh, StoresTheTruth) {
  for (const AnySurface& surface : all_surfaces())
    for (const double shear : {0.0, 0.5})
      for (const bool mirror : {false, true})
        for (const SignConvention sign : {SignConvention::gltf, SignConvention::raw}) {
          SampleMeshOptions o = grid(48, 29);
          o.jitter = 0.2;
          o.random_diagonals = true;
          o.shear = shear;
          o.mirror = mirror;
          o.sign = sign;
          const Mesh mesh = sample_mesh(surface, o);
          for (const Triangle& triangle : mesh.triangles) {
            const auto& [a, b, c] = triangle;
            const Vec3<double> face =
                cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
            const double raw = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) > 0 ? 1 : -1;
            for (const std::uint32_t v : triangle) {
              EXPECT_GT(dot(face, mesh.normals[v]), 0) << surface.info().name;
              EXPECT_EQ(mesh.tangents[v].w, sign == SignConvention::raw ? raw : -raw) << surface.info().name;
            }
          }
          // The superellipsoid goes like a root of u at its quarter turns: a rounding of u is 1e-8 of the
          // position.
          if ((shear != 0 || mirror) && surface.info().name == "superellipsoid") continue;
          for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            // Off by one rounding of the sum, by another of 1 - |2u - 1|; w tells the half. Vertices on the
            // fold, which jitter must leave there, are the surface's at u = 1/2 from both.
            const double stored = mesh.uvs[v].x - shear * mesh.uvs[v].y;
            const bool second = mesh.tangents[v].w == (sign == SignConvention::raw ? -1 : 1);
            const double u = !mirror ? stored : second ? 1 - stored / 2 : stored / 2;
            const double along = second ? -1 : 1;
            const Sample<double> s = surface.sample(u, mesh.uvs[v].y);
            EXPECT_LE(norm(mesh.positions[v] - s.jet.position), 1e-14);
            EXPECT_LE(norm(mesh.normals[v] - s.frame.n), 1e-14);
            EXPECT_LE(norm(mesh.tangents[v].xyz() - along * s.frame.t), 1e-14);
          }
        }
}

// A spindle torus: inside the lemon the chart turns over, and the triangles are wound the other way, as n.
// Only triangles across the axis belong to neither side.
TEST(SampleMesh, IsWoundAsItsNormalsWhereTheChartTurnsOver) {
  const Mesh mesh = sample_mesh(Torus{0.2, 0.4}, grid(32, 64));
  int outside = 0, inside = 0;
  for (const Triangle& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle;
    const auto side = [&](std::uint32_t v) { return mesh.tangents[v].w; };
    if (side(a) != side(b) || side(b) != side(c)) continue;
    const Vec3<double> face =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    EXPECT_GT(dot(face, mesh.normals[a]), 0);
    const double raw = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) > 0 ? 1 : -1;
    EXPECT_EQ(mesh.tangents[a].w, -raw);
    ++(raw > 0 ? outside : inside);
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 2000);
}

TEST(SampleMesh, IsTheSameForTheSameSeedAndDiffersForAnother) {
  SampleMeshOptions o = grid(8, 8);
  o.jitter = 0.2;
  const Mesh a = sample_mesh(Torus{1.0, 0.4}, o), b = sample_mesh(Torus{1.0, 0.4}, o);
  EXPECT_EQ(a.positions, b.positions);
  o.seed = 2;
  EXPECT_NE(a.positions, sample_mesh(Torus{1.0, 0.4}, o).positions);
}

TEST(SampleMesh, JitterLeavesTheBordersAlone) {
  SampleMeshOptions o = grid(8, 8);
  o.jitter = 0.3;
  std::set<double> border_u;
  for (const auto& uv : sample_mesh(Torus{1.0, 0.4}, o).uvs)
    if (uv.y == 0 || uv.y == 1) border_u.insert(uv.x);
  EXPECT_EQ(border_u, (std::set<double>{0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1}));
}

TEST(SampleMesh, AMirroredMeshStoresUBelowOne) {
  for (const bool shared : {false, true}) {
    SampleMeshOptions o = grid(8, 5);
    o.mirror = true;
    o.shared_seam = shared;
    for (const auto& uv : sample_mesh(Torus{1.0, 0.4}, o).uvs) EXPECT_TRUE(uv.x >= 0 && uv.x <= 1) << uv.x;
  }
}

// x + grading sin(2πx)/2π: monotone, 0, 1/2 and 1 to the bit, cells from 1 - grading to 1 + grading of the
// average.
TEST(SampleMesh, GradedCellsAreAsWideAsTheyShould) {
  for (const double grading : {0.0, 0.5, 0.9})
    for (const bool mirror : {false, true}) {
      SampleMeshOptions o = grid(64, 32);
      o.grading = grading;
      o.mirror = mirror;
      std::set<double> u, v;
      for (const auto& uv : sample_mesh(Torus{1.0, 0.4}, o).uvs) u.insert(uv.x), v.insert(uv.y);
      EXPECT_TRUE(mirror || u.size() == 65);  // the halves of a mirrored one differ by roundings
      EXPECT_EQ(v.size(), 33u);
      for (const double exact : {0.0, 0.5, 1.0})
        EXPECT_TRUE(v.contains(exact) && (mirror || u.contains(exact)));
      EXPECT_TRUE(u.contains(0) && u.contains(1));
      double least = 1, most = 0;
      for (auto at = std::next(v.begin()); at != v.end(); ++at) {
        const double cells = 32 * (*at - *std::prev(at));
        least = std::min(least, cells);
        most = std::max(most, cells);
      }
      // The mean of 1 + grading cos 2πx over a cell of 1/32 is off its extreme by grading (2π/32)²/6.
      EXPECT_NEAR(least, 1 - grading, 0.0065 * grading + 1e-12);
      EXPECT_NEAR(most, 1 + grading, 0.0065 * grading + 1e-12);
    }
}

TEST(SampleMesh, RefusesBadOptions) {
  const auto refused = [](auto change) {
    SampleMeshOptions o = grid(8, 8);
    change(o);
    EXPECT_THROW(sample_mesh(Torus{1.0, 0.4}, o), ParameterError);
  };
  refused([](auto& o) { o.columns = 0; });
  refused([](auto& o) { o.rows = -1; });
  refused([](auto& o) { o.jitter = 0.5; });
  refused([](auto& o) { o.jitter = NAN; });
  refused([](auto& o) { o.shear = INFINITY; });
  refused([](auto& o) { o.grading = 1; });
  refused([](auto& o) { o.grading = -0.1; });
  refused([](auto& o) { o.mirror = true, o.columns = 7; });
  refused([](auto& o) { o.shared_seam = true, o.columns = 2; });
  refused([](auto& o) { o.v_first = 0.8, o.v_last = 0.2; });
  // A surface that has lanterns.
  SampleMeshOptions lantern = grid(8, 8);
  lantern.topology = MeshTopology::lantern;
  EXPECT_NO_THROW(sample_mesh(Cylinder{}, lantern));
  lantern.grading = 0.5;
  EXPECT_THROW(sample_mesh(Cylinder{}, lantern), ParameterError);
}

}  // namespace
}  // namespace darboux::sample_mesh_test
