// Small relief on a recognised surface, with the exact normals of the relief: they follow the triangles, not
// the surface. And sheets whose diagonals alternate, whose tangents are judged all the same.
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>

namespace darboux::test::relief_test {
namespace {

using Map = std::function<Vec3<double>(double, double)>;

constexpr double tau = 2 * std::numbers::pi;

// The exact frames of p at the given uvs, by central differences: their error is far below a degree. Quads
// are cut along one diagonal, or along alternating ones.
Mesh mesh_of(const Map& p, const std::vector<double>& us, const std::vector<double>& vs, bool alternating) {
  Mesh mesh;
  constexpr double h = 1e-6;
  for (const double v : vs)
    for (const double u : us) {
      const Vec3<double> du = p(u + h, v) - p(u - h, v), dv = p(u, v + h) - p(u, v - h);
      const Vec3<double> n = unit(cross(du, dv)), t = unit(du - dot(du, n) * n);
      mesh.positions.push_back(p(u, v)), mesh.normals.push_back(n), mesh.uvs.push_back({u, v});
      mesh.tangents.push_back({t.x, t.y, t.z, 1});
    }
  const auto columns = static_cast<std::uint32_t>(us.size());
  for (std::uint32_t j = 0; j + 1 < vs.size(); ++j)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i, b = a + 1, c = b + columns, d = a + columns;
      if (alternating && (i + j) % 2 == 1)
        mesh.triangles.push_back({a, b, d}), mesh.triangles.push_back({b, c, d});
      else
        mesh.triangles.push_back({a, b, c}), mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

std::vector<double> grid(std::size_t n, double from = 0, double to = 1) {
  std::vector<double> result;
  for (std::size_t i = 0; i <= n; ++i)
    result.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(n));
  return result;
}

std::string messages(const Mesh& mesh, Severity severity) {
  std::string text;
  for (const Finding& f : assess(mesh).report.findings)
    if (f.severity == severity) text += std::string(f.code) + ": " + f.message + '\n';
  return text;
}

std::string errors(const Mesh& mesh) {
  return messages(mesh, Severity::error);
}

// Right, and held beside the surface that was recognised.
void expect_only_warned(const Mesh& mesh, const std::string& what) {
  EXPECT_EQ(errors(mesh), "") << what;
  EXPECT_NE(messages(mesh, Severity::warning).find("or near these"), std::string::npos)
      << what << ": " << messages(mesh, Severity::warning);
}

// 1 at the middle, 0 from 1 on, smooth.
double bump(double x) {
  return std::fabs(x) < 1 ? 0.5 + 0.5 * std::cos(std::numbers::pi * x) : 0;
}

// A shaft of radius 0.5 and length 10 with a groove round it, its rows close together in the groove.
Mesh grooved_shaft(double depth, double width, std::size_t rows) {
  const Map p = [=](double u, double v) {
    const double z = 10 * v, r = 0.5 - depth * bump((z - 4) / (0.5 * width));
    return Vec3<double>{r * std::cos(tau * u), r * std::sin(tau * u), z};
  };
  std::vector<double> vs = grid(80, 0, (4 - 0.5 * width) / 10);
  for (const double v : grid(rows, (4 - 0.5 * width) / 10, (4 + 0.5 * width) / 10))
    if (v > vs.back()) vs.push_back(v);
  for (const double v : grid(80, (4 + 0.5 * width) / 10, 1))
    if (v > vs.back()) vs.push_back(v);
  return mesh_of(p, grid(48), vs, false);
}

TEST(Relief, ExactNormalsAreNoErrors) {
  for (const std::size_t rows : {5U, 7U, 8U, 9U, 13U})
    expect_only_warned(grooved_shaft(0.005, 0.04, rows), "groove of " + std::to_string(rows) + " rows");
  const Map rivets = [](double u, double v) {
    double z = 0;
    for (const double a : {0.25, 0.75})
      for (const double b : {0.25, 0.75}) z += 0.002 * bump(std::hypot(u - a, v - b) / 0.03);
    return Vec3<double>{u, v, z};
  };
  expect_only_warned(mesh_of(rivets, grid(100), grid(100), false), "rivets");
}

// Those of a groove of more than twice the depth.
TEST(Relief, NormalsOfDeeperReliefStayErrors) {
  Mesh mesh = grooved_shaft(0.002, 0.04, 9);
  mesh.normals = grooved_shaft(0.006, 0.04, 9).normals;
  mesh.tangents.clear();
  EXPECT_NE(errors(mesh).find("NORMAL_ANGLE"), std::string::npos);
}

// Of the same shaft, normals that the triangles do not have.
TEST(Relief, NormalsThatTurnElsewhereStayErrors) {
  for (const bool in_groove : {false, true}) {
    Mesh mesh = grooved_shaft(0.005, 0.04, 9);
    std::size_t turned = 0;
    for (std::size_t v = 0; v < mesh.normals.size() && turned < 30; ++v) {
      const bool grooved = std::fabs(mesh.positions[v].z - 4) < 0.015;
      if (in_groove != grooved || v % 3 != 0 || mesh.positions[v].z < 1) continue;
      const Vec3<double> n = mesh.normals[v], t{mesh.tangents[v].x, mesh.tangents[v].y, mesh.tangents[v].z};
      mesh.normals[v] = unit(n + std::tan(25 * std::numbers::pi / 180) * t);
      const Vec3<double> along = unit(t - dot(t, mesh.normals[v]) * mesh.normals[v]);
      mesh.tangents[v] = {along.x, along.y, along.z, 1};
      ++turned;
    }
    ASSERT_EQ(turned, 30U);
    EXPECT_NE(errors(mesh).find("NORMAL_ANGLE"), std::string::npos) << in_groove;
  }
}

// Two triangles across an edge of the grid, cut along diagonals that meet, are no quad whose other diagonal
// leaves the tangents open.
TEST(AlternatingDiagonals, WrongTangentsAreErrors) {
  const Map sheet = [](double u, double v) {
    return Vec3<double>{u, v, 0.1 * std::sin(5 * u) * std::cos(4 * v) + 0.03 * u * u * u};
  };
  for (const bool alternating : {false, true}) {
    const Mesh right = mesh_of(sheet, grid(15), grid(15), alternating);
    EXPECT_EQ(errors(right), "");
    for (const std::size_t every : {1U, 2U, 20U}) {
      Mesh wrong = right;
      for (std::size_t v = 0; v < wrong.tangents.size(); v += every) {
        auto& t = wrong.tangents[v];
        t = {-t.x, -t.y, -t.z, t.w};
      }
      EXPECT_NE(errors(wrong), "") << "alternating " << alternating << ", one of " << every << " negated";
    }
    Mesh across = right;
    for (std::size_t v = 0; v < across.tangents.size(); v += 2) {
      auto& t = across.tangents[v];
      const Vec3<double> b = cross(across.normals[v], Vec3<double>{t.x, t.y, t.z});
      t = {b.x, b.y, b.z, t.w};
    }
    EXPECT_NE(errors(across), "") << "alternating " << alternating << ", half along b";
  }
}

}  // namespace
}  // namespace darboux::test::relief_test
