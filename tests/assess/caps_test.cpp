// Flat caps whose vertices all lie on the surface that they close.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>

namespace darboux::caps_test {
namespace {

// The unit sphere above z = -0.6, and a base over the vertices of its rim alone; uvs look along z.
Mesh dome() {
  constexpr std::uint32_t columns = 32, rows = 24;
  const double lowest = std::asin(-0.6);
  Mesh mesh;
  const auto add = [&](const Vec3<double>& p, const Vec3<double>& n) {
    mesh.positions.push_back(p);
    mesh.normals.push_back(n);
    mesh.uvs.push_back(n.z == -1 ? Vec2<double>{0.8 + 0.2 * p.x, 0.8 + 0.2 * p.y}
                                 : Vec2<double>{0.3 + 0.3 * p.x, 0.3 + 0.3 * p.y});
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    const double u = 2 * std::numbers::pi * i / columns,
                 v = lowest + (std::numbers::pi / 2 - lowest) * j / rows;
    return Vec3<double>{std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)};
  };
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) add(at(i, j), at(i, j));
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * columns + i, b = j * columns + (i + 1) % columns;
      mesh.triangles.push_back({a, b, b + columns});
      if (j + 1 < rows) mesh.triangles.push_back({a, b + columns, a + columns});
    }
  std::vector<std::uint32_t> rim;
  for (std::uint32_t i = 0; i < columns; ++i) rim.push_back(add(at(i, 0), {0, 0, -1}));
  for (std::uint32_t i = 1; i + 1 < columns; ++i) mesh.triangles.push_back({rim[0], rim[i + 1], rim[i]});
  return mesh;
}

TEST(Caps, ABaseIsNoPartOfTheSphere) {
  const std::vector<Assessment> parts = assess_parts(dome());
  std::string found;
  for (const Assessment& part : parts) {
    if (part.fit && part.fit->fits) found += std::string(part.fit->surface.surface.info().name) + ' ';
    for (const Finding& f : part.report.findings)
      EXPECT_EQ(f.severity, Severity::info) << f.code << ": " << f.message;
    EXPECT_NE(part.report.verdict, Verdict::fail);
  }
  EXPECT_NE(found.find("sphere "), std::string::npos) << found;
  EXPECT_NE(found.find("plane "), std::string::npos) << found;
}

// With a base or without, a wrong normal of the sphere is found.
TEST(Caps, TheSphereIsStillJudged) {
  Mesh mesh = dome();
  Vec3<double>& n = mesh.normals[32 * 12 + 3];
  n = unit(n + Vec3<double>{0, 0, 0.8});
  bool fails = false;
  for (const Assessment& part : assess_parts(mesh)) fails |= part.report.verdict == Verdict::fail;
  EXPECT_TRUE(fails);
}

}  // namespace
}  // namespace darboux::caps_test
