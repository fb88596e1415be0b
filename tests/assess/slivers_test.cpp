// Few corners that their own triangles speak against, where those may be slivers, or were cut or simplified
// since.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>

namespace darboux::slivers_test {
namespace {

using V = Vec3<double>;

constexpr std::uint32_t n = 40;  // squares along a side

float rounded(double x) {
  return static_cast<float>(x);
}

std::uint32_t at(std::uint32_t i, std::uint32_t j) {
  return j * (n + 1) + i;
}

// Hills of no known surface: 9600 corners, six at each vertex inside.
Mesh hills() {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = i, y = j;
      mesh.positions.push_back(
          {rounded(x), rounded(y),
           rounded(0.25 * std::sin(1.3 * x + 0.2 * y) + 0.2 * std::cos(1.7 * y - 0.4 * x))});
      mesh.uvs.push_back({rounded(x / n), rounded(y / n)});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  mesh.normals.assign(mesh.positions.size(), V{});
  for (const auto& [a, b, c] : mesh.triangles) {
    const V across = cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const std::uint32_t v : {a, b, c}) mesh.normals[v] = mesh.normals[v] + across;
  }
  for (V& m : mesh.normals) m = unit(m);
  return mesh;
}

// Along u: perpendicular to the normal and to y.
Mesh with_tangents(Mesh mesh) {
  for (const V& m : mesh.normals) {
    const V t = unit(V{m.z, 0, -m.x});
    mesh.tangents.push_back({t.x, t.y, t.z, 1});
  }
  return mesh;
}

std::size_t count_of(const Mesh& mesh, std::string_view code, Severity severity) {
  std::size_t result = 0;
  for (const Finding& f : assess(mesh, {}).report.findings)
    if (f.code == code && f.severity == severity) result += f.count;
  return result;
}

// By a quarter turn about their normals.
Mesh turned(Mesh mesh, std::uint32_t vertices) {
  for (std::uint32_t k = 0; k < vertices; ++k) {
    const std::uint32_t v = at(5 + 4 * k, 7);
    const V b = cross(mesh.normals[v], mesh.tangents[v].xyz());
    mesh.tangents[v] = {b.x, b.y, b.z, mesh.tangents[v].w};
  }
  return mesh;
}

// To `deg` from the mean of its triangles.
void tilt(Mesh& mesh, std::uint32_t v, double deg) {
  const V across = unit(cross(mesh.normals[v], V{1, 0.3, 0}));
  const double angle = deg * std::acos(-1.0) / 180;
  mesh.normals[v] = std::cos(angle) * mesh.normals[v] + std::sin(angle) * across;
}

TEST(Slivers, FewTangentsOutsideTheirConesAreAWarning) {
  const Mesh mesh = with_tangents(hills());
  ASSERT_EQ(mesh.corners(), 9600u);
  EXPECT_EQ(assess(mesh, {}).report.verdict, Verdict::pass);
  for (const std::uint32_t vertices : {1u, 3u}) {
    EXPECT_EQ(count_of(turned(mesh, vertices), "TANGENT_ANGLE", Severity::error), 0u) << vertices;
    EXPECT_EQ(count_of(turned(mesh, vertices), "TANGENT_ANGLE", Severity::warning), 6 * vertices);
  }
  // 24 of 9600 corners are more than 1 in 500.
  EXPECT_EQ(count_of(turned(mesh, 4), "TANGENT_ANGLE", Severity::error), 24u);
}

TEST(Slivers, FewNormalsAcrossTheirTrianglesAreAWarning) {
  Mesh mesh = hills();
  const std::uint32_t v = at(9, 9);
  tilt(mesh, v, 125);
  EXPECT_GT(count_of(mesh, "NORMAL_ANGLE", Severity::error), 0u) << "on the triangles' back";

  // Across all triangles of a flat spot: 90 degrees from each.
  Mesh flat = hills();
  const auto lie_down = [&](std::uint32_t i, std::uint32_t j) {
    for (const std::uint32_t b : {j - 1, j, j + 1})
      for (const std::uint32_t a : {i - 1, i, i + 1}) {
        flat.positions[at(a, b)].z = 0;
        flat.normals[at(a, b)] = {0, 0, 1};
      }
    flat.normals[at(i, j)] = {0.6, 0.8, 0};
  };
  lie_down(9, 9);
  EXPECT_EQ(count_of(flat, "NORMAL_ANGLE", Severity::error), 0u);
  EXPECT_GE(count_of(flat, "NORMAL_ANGLE", Severity::warning), 6u);  // and by the neighbours
  // 169 of 1681 normals are more than a tenth.
  for (std::uint32_t j = 2; j < n - 1; j += 3)
    for (std::uint32_t i = 2; i < n - 1; i += 3) lie_down(i, j);
  EXPECT_EQ(count_of(flat, "NORMAL_ANGLE", Severity::error), 6u * 169);
}

TEST(Slivers, SignsBesideATriangleWithoutUvAreaAreOpen) {
  Mesh mesh = hills();
  const std::uint32_t a = at(0, 0), b = at(1, 1);
  mesh.uvs[a] = mesh.uvs[b];
  mesh = with_tangents(mesh);
  Mesh beside = mesh;
  beside.tangents[b].w = -beside.tangents[b].w;
  EXPECT_EQ(count_of(beside, "TANGENT_HANDEDNESS", Severity::error), 0u);
  Mesh elsewhere = mesh;
  elsewhere.tangents[at(9, 9)].w = -elsewhere.tangents[at(9, 9)].w;
  EXPECT_EQ(count_of(elsewhere, "TANGENT_HANDEDNESS", Severity::error), 6u);
}

// A triangle of three vertices of its own; its height is a step of single precision, or not.
TEST(Slivers, WithinTheRoundingOfPositionsOpposeNoWinding) {
  for (const bool thin : {true, false}) {
    Mesh mesh = hills();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const float y = thin ? std::nextafter(10.F, 11.F) : 10.3F;
    for (const V& p : {V{10, 10, 1}, V{11, 10, 1}, V{10.5, y, 1}}) {
      mesh.positions.push_back(p);
      mesh.normals.push_back({0, 0, 1});
      mesh.uvs.push_back({p.x / n, p.y / n});
    }
    mesh.triangles.push_back({first, first + 2, first + 1});
    EXPECT_EQ(count_of(mesh, "NORMALS_OPPOSE_WINDING", Severity::warning), thin ? 0u : 3u) << thin;
  }
}

TEST(Slivers, SignsOfANormalThatFacesAwayFromATriangleAreOpen) {
  Mesh mesh = with_tangents(hills());
  const std::uint32_t v = at(9, 9);
  // On the back of one of its six triangles, in front of the others.
  mesh.positions[at(10, 10)].z += 8;
  mesh.tangents[v].w = -mesh.tangents[v].w;
  EXPECT_EQ(count_of(mesh, "TANGENT_HANDEDNESS", Severity::error), 6u) << "still in front of all";
  mesh.normals[v] = unit(V{1, 1, 0.3});
  EXPECT_EQ(count_of(mesh, "TANGENT_HANDEDNESS", Severity::error), 0u);
}

}  // namespace
}  // namespace darboux::slivers_test
