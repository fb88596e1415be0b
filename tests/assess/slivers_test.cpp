// Few corners that their own triangles speak against, where those may be slivers, or were cut or simplified
// since.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>

#include "coarse_sphere.h"

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

// A coarse sphere with MikkTSpace's tangents, then every triangle cut into four: what is stored in the middle
// of an edge is the mean of its ends, as a renderer interpolates.
Mesh subdivided_sphere(std::uint32_t columns, std::uint32_t rows) {
  Mesh mesh = test::coarse_sphere(columns, rows, false);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [it, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
    if (!is_new) return it->second;
    mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    mesh.uvs.push_back({(mesh.uvs[a].x + mesh.uvs[b].x) / 2, (mesh.uvs[a].y + mesh.uvs[b].y) / 2});
    const V n = unit(mesh.normals[a] + mesh.normals[b]), t = mesh.tangents[a].xyz() + mesh.tangents[b].xyz(),
            along = unit(t - dot(t, n) * n);
    mesh.normals.push_back(n);
    mesh.tangents.push_back({along.x, along.y, along.z, mesh.tangents[a].w});
    return it->second;
  };
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : std::vector<Triangle>(mesh.triangles)) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      triangles.push_back(t);
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

TEST(Slivers, SubdividedSpheresPass) {
  std::size_t warnings = 0;
  for (const std::uint32_t columns : {8u, 10u, 12u, 16u})
    for (const std::uint32_t rows : {6u, 8u}) {
      const Mesh mesh = subdivided_sphere(columns, rows);
      EXPECT_EQ(count_of(mesh, "TANGENT_ANGLE", Severity::error), 0u) << columns << ' ' << rows;
      warnings += count_of(mesh, "TANGENT_ANGLE", Severity::warning);
    }
  EXPECT_GT(warnings, 0u) << "nothing is tested";
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
  mesh.tangents[v].w = -mesh.tangents[v].w;
  EXPECT_EQ(count_of(mesh, "TANGENT_HANDEDNESS", Severity::error), 6u) << "in front of all triangles";
  // Behind one of the six.
  mesh.positions[at(10, 10)].z += 8;
  const V m = mesh.normals[v] = unit(V{0.2, -0.2, 1}), t = unit(V{m.z, 0, -m.x});
  mesh.tangents[v] = {t.x, t.y, t.z, mesh.tangents[v].w};
  EXPECT_EQ(count_of(mesh, "TANGENT_HANDEDNESS", Severity::error), 0u);
}

TEST(Slivers, TrianglesWithoutAreaHideNoSigns) {
  Mesh mesh = with_tangents(hills());
  for (std::size_t v = 0; v < mesh.positions.size() / 2; ++v) mesh.tangents[v].w = -1;
  const std::size_t wrong = count_of(mesh, "TANGENT_HANDEDNESS", Severity::error);
  EXPECT_GT(wrong, 4000u);
  const std::vector<Triangle> triangles = mesh.triangles;
  for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({a, b, b});
  EXPECT_EQ(count_of(mesh, "TANGENT_HANDEDNESS", Severity::error), wrong);
  // Nor do rows that lie on one line of the texture hide more than their own.
  Mesh rows = with_tangents(hills());
  for (std::uint32_t j = 1; j <= n; j += 2)
    for (std::uint32_t i = 0; i <= n; ++i) rows.uvs[at(i, j)].y = rows.uvs[at(i, j - 1)].y;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i < n / 3; ++i) rows.tangents[at(i, j)].w = -1;
  EXPECT_GT(count_of(rows, "TANGENT_HANDEDNESS", Severity::error), 1400u);
}

// Turned inside out, with slivers, or so coarsely quantised that rounding leaves most planes open.
TEST(Slivers, DoNotHideThatAllNormalsOppose) {
  Mesh slivers = hills();
  for (std::uint32_t k = 0; k < 50; ++k) {
    const auto first = static_cast<std::uint32_t>(slivers.positions.size());
    const float y = std::nextafter(10.F, 11.F);
    for (const V& p : {V{10, 10, 1}, V{11, 10, 1}, V{10.5, y, 1}}) {
      slivers.positions.push_back(p);
      slivers.normals.push_back({0, 0, 1});
      slivers.uvs.push_back({p.x / n, p.y / n});
    }
    slivers.triangles.push_back({first, first + 1, first + 2});
  }
  Mesh coarse = hills();
  constexpr double step = 0.5;
  for (V& p : coarse.positions) p = {p.x, p.y, step * std::round(p.z / step)};
  coarse.half_steps.position = 0.5 * step;
  for (Mesh mesh : {slivers, coarse}) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    EXPECT_EQ(count_of(mesh, "NORMAL_ANGLE", Severity::error), 0u);
    EXPECT_GT(count_of(mesh, "NORMALS_OPPOSE_WINDING", Severity::warning), 9000u);
  }
}

// A triangle as long as high is seen, however coarse the steps of its positions are.
TEST(Slivers, CoarseStepsHideNoTangents) {
  Mesh mesh = with_tangents(hills());
  constexpr double step = 0.5;
  for (V& p : mesh.positions) p = {p.x, p.y, step * std::round(p.z / step)};
  mesh.half_steps.position = 0.5 * step;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const V& m = mesh.normals[v];
    mesh.tangents[v] = {m.x, m.y, m.z, 1};
  }
  EXPECT_EQ(count_of(mesh, "TANGENT_NOT_ORTHOGONAL", Severity::error), mesh.corners());
}

// A patch of neighbouring vertices is no few slivers.
TEST(Slivers, PatchesAreErrors) {
  Mesh mesh = with_tangents(hills());
  Mesh flat = hills();
  for (std::uint32_t j = 10; j < 15; ++j)
    for (std::uint32_t i = 10; i < 16; ++i) {
      const std::uint32_t v = at(i, j);
      const V b = cross(mesh.normals[v], mesh.tangents[v].xyz());
      mesh.tangents[v] = {b.x, b.y, b.z, 1};
      flat.normals[v] = {0.6, 0.8, 0};
    }
  EXPECT_GT(count_of(mesh, "TANGENT_ANGLE", Severity::error), 100u);
  EXPECT_GT(count_of(flat, "NORMAL_ANGLE", Severity::error), 50u);
}

}  // namespace
}  // namespace darboux::slivers_test
