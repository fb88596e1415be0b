// Vertex normals: their weights, and vertices that have none.
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/sample_mesh.h>
#include <darboux/torus.h>
#include <darboux/vertex_normals.h>

#include "refusal_of.h"

namespace darboux::vertex_normals_test {
namespace {

constexpr double few_roundings = 8 * 0x1p-53;
constexpr std::array all_weights{NormalWeight::uniform, NormalWeight::area, NormalWeight::angle,
                                 NormalWeight::max};

bool is_nan(const Vec3<double>& n) {
  return std::isnan(n.x) && std::isnan(n.y) && std::isnan(n.z);
}

// At vertex 0 a triangle in z = 0: legs 1 and 1, a right angle, area 1/2; and one in x = 0: edges 2 and
// sqrt(8), 45 degrees, area 2. Normals along z and x.
Mesh two_triangles(double scale = 1) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -2, 0}, {0, -2, -2}};
  for (Vec3<double>& p : mesh.positions) p = scale * p;
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  return mesh;
}

TEST(VertexNormals, WeighAsTheySay) {
  // Lengths below and above which areas, or their inverses, are not numbers any more, too.
  for (const double scale : {1.0, 1e-300, 1e-170, 1e-155, 1e155, 1e170, 1e300}) {
    const Mesh mesh = two_triangles(scale);
    const auto expect = [&](NormalWeight weight, double z, double x) {
      const std::vector<Vec3<double>> n = vertex_normals(mesh, weight);
      ASSERT_EQ(n.size(), 5u);
      const double length = std::hypot(x, z);
      EXPECT_LE(norm(n[0] - Vec3<double>{x / length, 0, z / length}), few_roundings) << scale;
      for (const std::size_t v : {1u, 2u}) EXPECT_LE(norm(n[v] - Vec3<double>{0, 0, 1}), few_roundings);
      for (const std::size_t v : {3u, 4u}) EXPECT_LE(norm(n[v] - Vec3<double>{1, 0, 0}), few_roundings);
    };
    expect(NormalWeight::uniform, 1, 1);
    expect(NormalWeight::area, 0.5, 2);
    expect(NormalWeight::angle, 90, 45);
    expect(NormalWeight::max, 1, std::sqrt(0.5) / 2 / std::sqrt(8.0));
  }
}

TEST(VertexNormals, AreNoNumberWhereThereIsNoTriangleWithArea) {
  Mesh mesh = two_triangles();
  mesh.positions.push_back({5, 5, 5});  // of no triangle
  mesh.positions.push_back({3, 0, 0});  // of one without area, beside good ones
  mesh.triangles.push_back({0, 1, 6});
  for (const NormalWeight weight : all_weights) {
    const auto plain = vertex_normals(two_triangles(), weight), n = vertex_normals(mesh, weight);
    EXPECT_TRUE(is_nan(n[5]));
    EXPECT_TRUE(is_nan(n[6]));
    for (std::size_t v = 0; v < 5; ++v) EXPECT_LE(norm(n[v] - plain[v]), few_roundings);
  }
}

// Back to back, to the bit and but for rounding.
TEST(VertexNormals, AreNoNumberWhereTheyCancel) {
  Mesh exact = two_triangles(), rounded;
  exact.triangles = {{0, 1, 2}, {0, 2, 1}};
  rounded.positions = {{0.1, 0.2, 0.3}, {1.3, 0.1, 0.7}, {0.2, 1.7, 0.9}, {1.3, 0.1, 0.7}, {0.2, 1.7, 0.9}};
  // The same triangle with its vertices in another order: other edges make its normal.
  rounded.triangles = {{0, 1, 2}, {2, 1, 0}};
  for (const NormalWeight weight : all_weights)
    for (const Mesh* mesh : {&exact, &rounded}) {
      const auto n = vertex_normals(*mesh, weight);
      for (std::size_t v = 0; v < 3; ++v) EXPECT_TRUE(is_nan(n[v])) << v;
    }
}

TEST(VertexNormals, NeedPositionsAndTrianglesOnly) {
  const Mesh torus = sample_mesh(Torus{1.0, 0.4}, {.columns = 64, .rows = 32});
  Mesh bare;
  bare.positions = torus.positions;
  bare.triangles = torus.triangles;
  for (const NormalWeight weight : all_weights) {
    const auto n = vertex_normals(bare, weight);
    EXPECT_EQ(n, vertex_normals(torus, weight));
    // Outwards; an edge of 2 pi 0.4 / 32 of a tube of radius 0.4 turns the normal by 0.2 at most.
    for (std::size_t v = 0; v < n.size(); ++v) EXPECT_GT(dot(n[v], torus.normals[v]), std::cos(0.2));
  }
  EXPECT_TRUE(vertex_normals(Mesh{}, NormalWeight::area).empty());
}

TEST(VertexNormals, RefuseBadMeshes) {
  Mesh index = two_triangles();
  index.triangles[1][2] = 5;
  EXPECT_THROW(vertex_normals(index, NormalWeight::area), MeshError);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Mesh mesh = two_triangles();
    mesh.positions[3].y = bad;
    EXPECT_NE(test::refusal_of<MeshError>([&] {
                vertex_normals(mesh, NormalWeight::area);
              }).find("position of vertex 3: expected finite numbers"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace darboux::vertex_normals_test
