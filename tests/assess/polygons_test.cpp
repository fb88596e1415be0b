// What tools write that know polygons, where a file has their triangles: tangents along the other diagonal,
// and normals that are averages of the polygons'. No error.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>
#include <darboux/mikktspace.h>
#include <darboux/triangle.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test::polygons_test {
namespace {

std::string errors(const Mesh& mesh) {
  std::string text;
  for (const Finding& f : assess(mesh).report.findings)
    if (f.severity == Severity::error) text += std::string(f.code) + ": " + f.message + '\n';
  return text;
}

// As Blender exports Suzanne: MikkTSpace of the quads, cut along one diagonal or the other. Quads that are
// concave in uv had errors, as had those whose shorter diagonal lies outside.
TEST(Polygons, TangentsOfQuadsAreNoErrors) {
  constexpr std::uint32_t quads = 400;
  Random random(7);
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint32_t> indices;
  const std::vector<std::uint8_t> sides(quads, 4);
  std::size_t concave = 0;
  for (std::uint32_t q = 0; q < quads; ++q) {
    const std::array<Vec2<double>, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    const float turn = static_cast<float>(random.uniform(0, 6.28));
    std::array<Vec2<double>, 4> uv = square;
    for (auto& p : uv) p.x += random.uniform(-0.4, 0.4), p.y += random.uniform(-0.4, 0.4);
    if (q % 2 == 0) {  // its third corner inside the triangle of the others
      const double a = random.uniform(0.1, 0.8), b = random.uniform(0.1, 0.9 - a);
      uv[2] = (1 - a - b) * uv[0] + a * uv[1] + b * uv[3];
      ++concave;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      indices.push_back(static_cast<std::uint32_t>(positions.size() / 3));
      positions.insert(positions.end(),
                       {static_cast<float>(3 * q + square[k].x), static_cast<float>(square[k].y),
                        static_cast<float>(random.uniform(-0.05, 0.05))});
      normals.insert(normals.end(), {0, 0, 1});
      uvs.insert(
          uvs.end(),
          {std::cos(turn) * static_cast<float>(uv[k].x) - std::sin(turn) * static_cast<float>(uv[k].y),
           std::sin(turn) * static_cast<float>(uv[k].x) + std::cos(turn) * static_cast<float>(uv[k].y)});
    }
  }
  std::cout << concave << " of " << quads << " quads are concave in uv\n";
  MikkMesh polygons;
  polygons.positions = positions, polygons.normals = normals, polygons.uvs = uvs, polygons.corners = indices;
  polygons.face_sizes = sides;
  std::vector<float> tangents(4 * indices.size());
  mikktspace(polygons, tangents);
  for (const std::uint32_t diagonal : {0U, 1U}) {
    Mesh mesh;
    for (std::uint32_t v = 0; v < 4 * quads; ++v) {
      mesh.positions.push_back({positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
      mesh.normals.push_back({0, 0, 1});
      mesh.uvs.push_back({uvs[2 * v], uvs[2 * v + 1]});
      mesh.tangents.push_back(
          {tangents[4 * v], tangents[4 * v + 1], tangents[4 * v + 2], tangents[4 * v + 3]});
    }
    for (std::uint32_t q = 0; q < quads; ++q) {
      const auto at = [&](std::uint32_t k) { return 4 * q + (k + diagonal) % 4; };
      mesh.triangles.push_back({at(0), at(1), at(2)});
      mesh.triangles.push_back({at(0), at(2), at(3)});
    }
    EXPECT_EQ(errors(mesh), "") << "diagonal " << diagonal;
    // Of convex quads it is still seen.
    Mesh wrong = mesh;
    for (std::uint32_t q = 0; q < quads; ++q)
      for (std::uint32_t k = 0; k < 4; ++k) {
        auto& t = wrong.tangents[4 * q + k];
        t = {-t.y, t.x, t.z, t.w};
      }
    EXPECT_NE(errors(wrong), "");
  }
}

// On a thin ridge, as of a flattened model: more than 80 degrees from each triangle, and the average of them
// by weights that are none of the common ones.
TEST(Polygons, NormalsOfRidgesAreNoErrors) {
  constexpr std::uint32_t columns = 12;
  Mesh mesh;
  const Vec3<double> left = unit(Vec3<double>{0, -1, 0.04}), right = unit(Vec3<double>{0, 1, 0.04});
  for (std::uint32_t i = 0; i <= columns; ++i)
    for (std::uint32_t side = 0; side < 3; ++side) {
      mesh.positions.push_back({1.0 * i, 0.04 * (static_cast<double>(side) - 1), side == 1 ? 1.0 : 0.0});
      mesh.normals.push_back(side == 0 ? left : side == 2 ? right : unit(1.004 * left + 0.996 * right));
    }
  for (std::uint32_t i = 0; i < columns; ++i)
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::uint32_t a = 3 * i + side, b = a + 3;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  EXPECT_EQ(errors(mesh), "");
  for (const std::size_t i : {2, 4, 6, 8, 10}) mesh.normals[3 * i + 1] = {1, 0, 0};
  EXPECT_NE(errors(mesh), "") << "along the ridge";
}

// FBX and Collada have bitangents, which without uv area are zero and on no side.
TEST(Polygons, NoSideWithoutUvAreaIsNoError) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 0}, {1, 0}, {1, 0}, {0, 0}};
  mesh.tangents.assign(4, {1, 0, 0, 0});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(errors(mesh), "");
  mesh.tangents[0].w = 0.5;
  EXPECT_NE(errors(mesh), "");
  mesh.tangents[0].w = 0;
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_NE(errors(mesh), "");
}

}  // namespace
}  // namespace darboux::test::polygons_test
