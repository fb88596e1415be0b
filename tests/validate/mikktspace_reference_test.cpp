// MikkTSpace's tangents kept once per vertex are those of every corner.
#include "validate/mikktspace_reference.h"

#include <cmath>
#include <cstring>
#include <span>

#include <gtest/gtest.h>

#include <darboux/mesh.h>
#include <darboux/validate.h>

namespace darboux::mikktspace_reference_test {
namespace {

bool same_bits(const Vec4<float>& a, const Vec4<float>& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Four triangles over five vertices; corners of vertices 0 and 2 differ, one by the sign of a zero alone.
struct Example {
  Mesh mesh;
  std::vector<Vec4<float>> of_corner;

  Example() {
    mesh.positions.resize(6);
    mesh.triangles = {{0, 1, 2}, {2, 1, 3}, {0, 2, 4}, {4, 2, 0}};
    for (int c = 0; c < 12; ++c) {
      const std::uint32_t v = mesh.triangles[c / 3][c % 3];
      of_corner.push_back({static_cast<float>(v), 0, 1, 1});
    }
    of_corner[3].y = -0.0f;  // vertex 2
    of_corner[6].w = -1;     // vertex 0
    of_corner[10].x = 7;     // vertex 2
  }
};

TEST(MikktspaceReference, HasTheTangentOfEveryCorner) {
  const Example e;
  const MikktspaceReference reference(e.mesh, e.of_corner);
  EXPECT_FALSE(reference.empty());
  for (std::size_t c = 0; c < 12; ++c)
    EXPECT_TRUE(same_bits(reference.at(c, e.mesh.triangles[c / 3][c % 3]), e.of_corner[c])) << c;
  ASSERT_EQ(reference.others().size(), 3u);
  for (const auto& [k, corner] : {std::pair{0, 3}, {1, 6}, {2, 10}})
    EXPECT_EQ(reference.others()[k].corner, static_cast<std::size_t>(corner));
  EXPECT_EQ(reference.of_vertex(5).w, 0) << "no triangle uses it";
}

TEST(MikktspaceReference, OfAPartIsThatOfItsCorners) {
  const Example e;
  const MikktspaceReference whole(e.mesh, e.of_corner);
  // Triangles 1 and 3, with vertices in the order of their appearance: 2 1 3 4 0.
  const std::vector<std::uint32_t> vertices{2, 1, 3, 4, 0}, triangles{1, 3};
  Mesh part;
  part.positions.resize(5);
  part.triangles = {{0, 1, 2}, {3, 0, 4}};
  const MikktspaceReference reference = whole.restricted_to(part, vertices, triangles);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(same_bits(reference.at(3 * t + k, part.triangles[t][k]), e.of_corner[3 * triangles[t] + k]))
          << t << ' ' << k;
  EXPECT_TRUE(MikktspaceReference().restricted_to(part, vertices, triangles).empty());
}

// Without a corner there is nothing to compare, where "0 % of corners to the bit" would say that nothing
// matches.
TEST(MikktspaceReference, IsNotMadeWithoutTriangles) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.tangents.assign(3, {1, 0, 0, 1});
  EXPECT_FALSE(validate(mesh, std::span<const Truth>()).mikktspace);
  mesh.triangles = {{0, 1, 2}};
  EXPECT_TRUE(validate(mesh, std::span<const Truth>()).mikktspace);
}

// A grid in the plane z = 0, u along x, every seventh vertex with another normal.
Mesh grid_with(const Vec3<double>& normal) {
  constexpr std::uint32_t n = 8;
  Mesh mesh;
  for (std::uint32_t i = 0; i < n * n; ++i) {
    mesh.positions.push_back({double(i / n), double(i % n), 0});
    mesh.uvs.push_back({double(i / n) / n, double(i % n) / n});
    mesh.normals.push_back(i % 7 == 0 ? normal : Vec3<double>{0, 0, 1});
  }
  mesh.tangents.assign(n * n, {1, 0, 0, -1});
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t v = n * i; v + 1 < n * (i + 1); ++v) {
      mesh.triangles.push_back({v, v + n, v + 1});
      mesh.triangles.push_back({v + 1, v + n, v + n + 1});
    }
  return mesh;
}

// Where t is along the normal, what MikkTSpace gives is zero, infinite or NaN: nothing to compare with, and
// not 90 degrees.
TEST(MikktspaceReference, HasNoTangentWhereMikktspaceGivesNone) {
  for (const Vec3<double>& normal :
       {Vec3<double>{1, 0, 0}, {1, 1e-24, 0}, {1, 1e-30, 1e-40}, {1, 0, 1e-24}, {1, -1e-40, 0}}) {
    SCOPED_TRACE(normal.y);
    const Mesh mesh = grid_with(normal);
    const MikktspaceReference reference = mikktspace_reference(mesh, mesh.uvs, 1);
    std::size_t none = 0;
    for (std::size_t c = 0; c < mesh.corners(); ++c) {
      const std::uint32_t v = mesh.triangles[c / 3][c % 3];
      const Vec4<float> expected = v % 7 == 0 ? Vec4<float>{0, 0, 0, 0} : Vec4<float>{1, 0, 0, 1};
      EXPECT_EQ(reference.at(c, v), expected) << c;
      none += v % 7 == 0;
    }
    ValidateOptions options;
    options.references = {.analytic = false, .mikktspace = true, .local = false, .triangles = false};
    const MeshReport report = validate(mesh, std::span<const Truth>(), options);
    ASSERT_TRUE(report.mikktspace);
    EXPECT_DOUBLE_EQ(report.mikktspace->equal_bits, 1 - double(none) / double(mesh.corners()));
    for (const ClassReport& c : report.mikktspace->classes)
      EXPECT_EQ(c.tangent_deg.value().max, 0) << static_cast<int>(c.vertex_class);
  }
}

// Normals of no ordinary length are no reason to give none.
TEST(MikktspaceReference, HasTangentsBesideTinyAndHugeNumbers) {
  for (const double length : {1e-40, 1e-24, 1e-20, 1e8})
    for (const double size : {1e-37, 1.0, 1e37}) {
      Mesh mesh = grid_with({0, 0, 1});
      for (auto& n : mesh.normals) n = length * n;
      for (auto& p : mesh.positions) p = size * p;
      const MikktspaceReference reference = mikktspace_reference(mesh, mesh.uvs, 1);
      for (std::size_t c = 0; c < mesh.corners(); ++c) {
        const Vec4<float>& t = reference.at(c, mesh.triangles[c / 3][c % 3]);
        EXPECT_TRUE(t.w == 1 && std::fabs(t.x - 1) < 1e-6 && t.y == 0 && t.z == 0)
            << length << ' ' << size << ' ' << c;
      }
    }
}

}  // namespace
}  // namespace darboux::mikktspace_reference_test
