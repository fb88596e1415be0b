// Cones and cylinders of one row, as programs make them: with a vertex at the apex for each column, scaled,
// and with triangles at the apex that have no area.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>

namespace darboux::cones_test {
namespace {

using V = Vec3<double>;

constexpr std::uint32_t columns = 32;

// From y = -1, where the radius is 1, to y = 1. \param upper radius there; 0: an apex
Mesh open_cone(double upper) {
  Mesh mesh;
  for (const bool top : {true, false})
    for (std::uint32_t k = 0; k <= columns; ++k) {
      const double u = static_cast<double>(k) / columns, angle = 2 * std::numbers::pi * u,
                   r = top ? upper : 1;
      mesh.positions.push_back({r * std::sin(angle), top ? 1.0 : -1.0, r * std::cos(angle)});
      mesh.normals.push_back(unit(V{std::sin(angle), (1 - upper) / 2, std::cos(angle)}));
      mesh.uvs.push_back({u, top ? 1.0 : 0.0});
    }
  for (std::uint32_t k = 0; k < columns; ++k) {
    const std::uint32_t a = k, b = columns + 1 + k;
    if (upper > 0) mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
  }
  return mesh;
}

void add_cap(Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t k = 0; k <= columns; ++k) {
    const double angle = 2 * std::numbers::pi * k / columns;
    mesh.positions.push_back({std::sin(angle), -1, std::cos(angle)});
    mesh.normals.push_back({0, -1, 0});
    mesh.uvs.push_back({0.5 + 0.5 * std::sin(angle), 0.5 + 0.5 * std::cos(angle)});
  }
  mesh.positions.push_back({0, -1, 0});
  mesh.normals.push_back({0, -1, 0});
  mesh.uvs.push_back({0.5, 0.5});
  for (std::uint32_t k = 0; k < columns; ++k)
    mesh.triangles.push_back({first + k + 1, first + k, first + columns + 1});
}

// \param normals are transformed too, by the inverse transpose
void scale(Mesh& mesh, const V& by, bool normals) {
  for (V& p : mesh.positions) p = {by.x * p.x, by.y * p.y, by.z * p.z};
  if (normals)
    for (V& n : mesh.normals) n = unit(V{n.x / by.x, n.y / by.y, n.z / by.z});
}

std::size_t count_of(const Mesh& mesh, std::string_view code, Severity severity) {
  std::size_t result = 0;
  for (const Assessment& part : assess_parts(mesh))
    for (const Finding& f : part.report.findings)
      if (f.code == code && f.severity == severity) result += f.count;
  return result;
}

TEST(Cones, NormalsOfColumnsAtAnApexAreNotStale) {
  Mesh mesh = open_cone(0);
  add_cap(mesh);
  EXPECT_EQ(count_of(mesh, "NORMAL_STALE", Severity::warning), 0u);
}

TEST(Cones, NormalsThatACylindersScaleLeftBehindAreStale) {
  for (const V& by : {V{2.5, 1, 1}, V{1, 1, 0.3}}) {
    Mesh mesh = open_cone(1);
    scale(mesh, by, true);
    EXPECT_EQ(count_of(mesh, "NORMAL_STALE", Severity::warning), 0u);
    Mesh stale = open_cone(1);
    scale(stale, by, false);
    EXPECT_EQ(count_of(stale, "NORMAL_STALE", Severity::warning), stale.corners()) << by.x;
  }
}

// One ring and an apex lie on a round cone whose triangles would be others.
TEST(Cones, EllipticOnesAreNoRoundOnes) {
  Mesh mesh = open_cone(0);
  scale(mesh, {1, 1, 2}, true);
  for (const Assessment& part : assess_parts(mesh)) EXPECT_FALSE(part.fit && part.fit->fits);
  EXPECT_EQ(count_of(mesh, "NORMAL_ANGLE", Severity::warning), 0u);
}

TEST(Cones, TangentsOfTrianglesWithoutAreaAreUnseen) {
  Mesh mesh = open_cone(0);
  for (std::uint32_t k = 0; k < columns; ++k) mesh.triangles.push_back({k, columns + 1 + k, k + 1});
  for (const V& n : mesh.normals) {
    const V t = unit(V{n.z, 0, -n.x});
    mesh.tangents.push_back({t.x, t.y, t.z, 1});
  }
  const auto lean = [](Mesh of, std::size_t v) {
    of.tangents[v] = {of.normals[v].x, of.normals[v].y, of.normals[v].z, 1};
    return count_of(of, "TANGENT_NOT_ORTHOGONAL", Severity::error);
  };
  EXPECT_EQ(lean(mesh, 0), 0u) << "the first apex has no other triangle";
  EXPECT_GT(lean(mesh, 1), 0u);
}

}  // namespace
}  // namespace darboux::cones_test
