// Meshes whose normals and tangents were computed on quads, and that were cut into triangles afterwards, as
// Blender does.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>
#include <darboux/mikktspace.h>

#include "said.h"

namespace darboux::quads_test {
namespace {

using test::said;
using V = Vec3<double>;
using Quad = std::array<std::uint32_t, 4>;

float rounded(double x) {
  return static_cast<float>(x);
}

// A hilly sheet of bent quads with uvs so uneven that halves of some quads wind the other way.
struct Sheet {
  Mesh mesh;
  std::vector<Quad> quads;

  explicit Sheet(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    constexpr std::uint32_t n = 16;
    for (std::uint32_t j = 0; j <= n; ++j)
      for (std::uint32_t i = 0; i <= n; ++i) {
        mesh.positions.push_back({rounded(i), rounded(j), rounded(0.5 * uniform(random))});
        mesh.uvs.push_back(
            {rounded((i + 0.55 * uniform(random)) / n), rounded((j + 0.55 * uniform(random)) / n)});
      }
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = j * (n + 1) + i;
        quads.push_back({a, a + 1, a + n + 2, a + n + 1});
      }
    store_normals();
    store_tangents();
  }

  // Per vertex the sum of the quads' normals.
  void store_normals() {
    mesh.normals.assign(mesh.positions.size(), V{0, 0, 0});
    for (const auto& [a, b, c, d] : quads) {
      const V n = unit(cross(mesh.positions[c] - mesh.positions[a], mesh.positions[d] - mesh.positions[b]));
      for (const std::uint32_t v : {a, b, c, d}) mesh.normals[v] = mesh.normals[v] + n;
    }
    for (V& n : mesh.normals) n = {rounded(unit(n).x), rounded(unit(n).y), rounded(unit(n).z)};
  }

  // MikkTSpace's of the quads; each corner gets a vertex of its own. \param cut a quad's two triangles, of
  // its corners 0 to 3
  void store_tangents(const std::array<Triangle, 2>& cut = {{{0, 1, 2}, {0, 2, 3}}}) {
    std::vector<float> positions, normals, uvs;
    std::vector<std::uint32_t> corners;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      for (const double x : {mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z})
        positions.push_back(rounded(x));
      for (const double x : {mesh.normals[v].x, mesh.normals[v].y, mesh.normals[v].z})
        normals.push_back(rounded(x));
      uvs.insert(uvs.end(), {rounded(mesh.uvs[v].x), rounded(mesh.uvs[v].y)});
    }
    for (const Quad& quad : quads) corners.insert(corners.end(), quad.begin(), quad.end());
    const std::vector<std::uint8_t> sizes(quads.size(), 4);
    std::vector<float> tangents(4 * corners.size());
    mikktspace(MikkMesh{positions, normals, uvs, corners, sizes}, tangents);
    Mesh cut_mesh;
    for (std::uint32_t c = 0; c < corners.size(); ++c) {
      cut_mesh.positions.push_back(mesh.positions[corners[c]]);
      cut_mesh.normals.push_back(mesh.normals[corners[c]]);
      cut_mesh.uvs.push_back(mesh.uvs[corners[c]]);
      cut_mesh.tangents.push_back(
          {tangents[4 * c], tangents[4 * c + 1], tangents[4 * c + 2], -tangents[4 * c + 3]});
      if (c % 4 == 0)
        for (const auto& [x, y, z] : cut) cut_mesh.triangles.push_back({c + x, c + y, c + z});
    }
    mesh = std::move(cut_mesh);
  }
};

// Quads whose halves' uvs wind differently, from the first triangle to before the last.
std::size_t opposite_halves(const Mesh& mesh, std::size_t first = 0, std::size_t last = ~std::size_t{0}) {
  const auto sign = [&](const Triangle& t) {
    const Vec2<double> a = mesh.uvs[t[1]] - mesh.uvs[t[0]], b = mesh.uvs[t[2]] - mesh.uvs[t[0]];
    return a.x * b.y - a.y * b.x > 0;
  };
  std::size_t result = 0;
  for (std::size_t t = first; t < std::min(last, mesh.triangles.size()); t += 2)
    result += sign(mesh.triangles[t]) != sign(mesh.triangles[t + 1]);
  return result;
}

TEST(Quads, TangentsOfQuadsAreMikktspaces) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Sheet sheet(seed);
    EXPECT_GT(opposite_halves(sheet.mesh), 5U) << "seed " << seed;
    const MeshReport report = assess(sheet.mesh).report;
    EXPECT_EQ(said(report), "") << "seed " << seed;
    ASSERT_TRUE(report.mikktspace);
    EXPECT_EQ(report.mikktspace->equal_bits, 1) << "seed " << seed;
    // Cut at the other diagonal.
    Sheet other(seed);
    std::vector<Triangle> triangles;
    for (std::uint32_t c = 0; c < other.mesh.positions.size(); c += 4) {
      triangles.push_back({c, c + 1, c + 3});
      triangles.push_back({c + 1, c + 2, c + 3});
    }
    other.mesh.triangles = triangles;
    const MeshReport cut_otherwise = assess(other.mesh).report;
    EXPECT_EQ(cut_otherwise.verdict, Verdict::pass) << "seed " << seed;
    EXPECT_EQ(cut_otherwise.mikktspace->equal_bits, 1) << "seed " << seed;
  }
}

TEST(Quads, WrongTangentsAreStillFound) {
  Sheet sheet(4);
  for (std::size_t v = 40; v < 60; ++v) {
    Vec4<double>& t = sheet.mesh.tangents[v];
    const V turned = cross(sheet.mesh.normals[v], t.xyz());
    t = {turned.x, turned.y, turned.z, t.w};
  }
  EXPECT_NE(said(assess(sheet.mesh).report).find("TANGENT_ANGLE"), std::string::npos);
  sheet = Sheet(4);
  for (Vec4<double>& t : sheet.mesh.tangents)
    t = {t.x, t.y, t.z, &t - &sheet.mesh.tangents[0] < 40 ? -t.w : t.w};
  EXPECT_NE(said(assess(sheet.mesh).report).find("TANGENT_HANDEDNESS"), std::string::npos);
}

// The smaller half of a quad follows the larger one: w of its own triangle is wrong there.
TEST(Quads, SignsAreTheQuads) {
  Sheet sheet(5);
  Mesh& mesh = sheet.mesh;
  ASSERT_EQ(said(assess(mesh).report), "");
  std::size_t turned = 0;
  for (std::size_t v = 0; v < mesh.tangents.size(); v += 4) {
    if (opposite_halves(mesh, v / 2, v / 2 + 1) == 0) continue;
    for (std::size_t k = 0; k < 4; ++k) mesh.tangents[v + k].w *= -1, ++turned;
    break;
  }
  ASSERT_EQ(turned, 4U);
  EXPECT_NE(said(assess(mesh).report).find("TANGENT_HANDEDNESS"), std::string::npos);
}

// A flat-shaded quad has one normal, that of its corners' mean plane. One half is small and folded over: the
// normal is 82 degrees from it, and its outer corner touches no other triangle.
TEST(Quads, AFlatQuadHasOneNormal) {
  Mesh mesh;
  for (int k = 0; k < 6; ++k) {
    const double x = 3 * k;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const V& p : {V{x, 0, 0}, V{x + 0.5, -1, 0}, V{x + 1, 0, 0}, V{x + 0.5, -0.05, 0.3}})
      mesh.positions.push_back(p);
    mesh.normals.insert(mesh.normals.end(), 4, unit(V{0, -0.3, 0.95}));
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  EXPECT_EQ(said(assess(mesh).report), "");
  // Turned, it is no average of the two.
  for (V& n : mesh.normals) n = {1, 0, 0};
  EXPECT_NE(said(assess(mesh).report).find("NORMAL_ANGLE"), std::string::npos);
}

}  // namespace
}  // namespace darboux::quads_test
