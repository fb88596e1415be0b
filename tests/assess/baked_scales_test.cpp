// Uneven scales baked into meshes whose normals lean from their triangles, as those of foliage do: tangents
// scaled alike are right, wrong ones stay wrong.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/sample_mesh.h>

#include "coarse_sphere.h"
#include "random_meshes.h"

namespace darboux::baked_scales_test {
namespace {

constexpr int cards = 80;

Eigen::Vector3d direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return Eigen::Vector3d(x, y, z).normalized();
}

// Cards within a ball, turned at random, with the normals of the ball and MikkTSpace's tangents.
Mesh foliage(std::mt19937_64& random) {
  Mesh mesh;
  for (std::uint32_t card = 0; card < cards; ++card) {
    const Eigen::Vector3d centre = direction(random) * std::cbrt(test::uniform(random, 0.05, 1)),
                          x = direction(random), y = x.cross(direction(random)).normalized();
    const double turn = test::uniform(random, -3, 3);
    for (const auto& [u, v] : {std::array{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      const Eigen::Vector3d p = centre + 0.2 * ((u - 0.5) * x + (v - 0.5) * y);
      mesh.positions.push_back(from_eigen(p));
      mesh.normals.push_back(unit(mesh.positions.back()));
      mesh.uvs.push_back({u * std::cos(turn) - v * std::sin(turn), u * std::sin(turn) + v * std::cos(turn)});
    }
    mesh.triangles.push_back({4 * card, 4 * card + 1, 4 * card + 2});
    mesh.triangles.push_back({4 * card, 4 * card + 2, 4 * card + 3});
  }
  test::add_mikktspace(mesh);
  return mesh;
}

// As tools apply the matrix of a node.
void apply(const Eigen::Matrix3d& m, Mesh& mesh) {
  const Eigen::Matrix3d of_normals = m.inverse().transpose();
  for (auto& p : mesh.positions) p = from_eigen(m * to_eigen(p));
  for (auto& n : mesh.normals) n = unit(from_eigen(of_normals * to_eigen(n)));
  for (auto& t : mesh.tangents) {
    const Vec3<double> along = unit(from_eigen(m * to_eigen(t.xyz())));
    t = {along.x, along.y, along.z, t.w};
  }
}

// Turns the tangents of every so many cards about their normals.
void turn_some(int every, double deg, Mesh& mesh) {
  const double angle = deg * std::numbers::pi / 180;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (v / 4 % static_cast<std::size_t>(every) != 0) continue;
    const Vec3<double> t = mesh.tangents[v].xyz(), b = cross(mesh.normals[v], t),
                       turned = std::cos(angle) * t + std::sin(angle) * b;
    mesh.tangents[v] = {turned.x, turned.y, turned.z, mesh.tangents[v].w};
  }
}

std::vector<Eigen::Matrix3d> scales(std::mt19937_64& random) {
  Eigen::Matrix3d sheared = Eigen::Matrix3d::Identity();
  sheared(0, 1) = 0.5;
  std::vector<Eigen::Matrix3d> result{Eigen::Matrix3d::Identity(), sheared};
  for (const std::array<double, 3>& s :
       {std::array{1.5, 1.0, 1.0}, {1.0, 1.0, 0.5}, {2.0, 3.0, 5.0}, {4.0, 0.25, 1.0}})
    result.emplace_back(Eigen::Vector3d(s[0], s[1], s[2]).asDiagonal());
  for (int k = 0; k < 3; ++k) {  // along any axes
    const Eigen::Matrix3d turn = Eigen::Quaterniond(Eigen::AngleAxisd(k + 1, direction(random))).matrix();
    result.emplace_back(turn * result.back());
  }
  return result;
}

std::size_t wrong_tangents(const Mesh& mesh) {
  for (const Finding& f : assess(mesh).report.findings)
    if (f.code == "TANGENT_ANGLE" && f.severity == Severity::error) return f.count;
  return 0;
}

TEST(BakedScales, LeaveRightTangentsRight) {
  std::mt19937_64 random(281);
  std::cout << "seed 281\n";
  for (int repeat = 0; repeat < 5; ++repeat) {
    const Mesh mesh = foliage(random);
    for (const Eigen::Matrix3d& m : scales(random)) {
      Mesh scaled = mesh;
      apply(m, scaled);
      test::round_to_floats(scaled);
      EXPECT_EQ(wrong_tangents(scaled), 0u) << m;
    }
  }
}

// At the seam next to a pole a triangle of the two has no area, and the other one is far from the surface.
TEST(BakedScales, LeaveCoarseSpheresRight) {
  std::size_t found = 0;  // of tangents there that are negated
  for (const std::uint32_t columns : {6u, 8u, 10u})
    for (const std::uint32_t rows : {4u, 5u, 6u})
      for (const auto& scale : {Eigen::Vector3d(1, 1, 2), {1, 1, 3}, {1, 2, 1}, {1, 2, 3}, {1, 1, 0.5}}) {
        Mesh mesh = test::coarse_sphere(columns, rows, true);
        apply(scale.asDiagonal(), mesh);
        test::round_to_floats(mesh);
        EXPECT_EQ(wrong_tangents(mesh), 0u) << columns << ' ' << rows << ' ' << scale.transpose();
        Vec4<double>& t = mesh.tangents[columns + 1];
        t = {-t.x, -t.y, -t.z, t.w};
        found += wrong_tangents(mesh);
      }
  EXPECT_GT(found, 0u);
}

// Where few directions lean, a scale would explain any turn of them.
TEST(BakedScales, ExplainNoFewDirections) {
  std::mt19937_64 random(283);
  std::cout << "seed 283\n";
  for (const double turn : {20.0, 40.0})
    for (const double lean : {15.0, 40.0}) {
      // A flat patch whose upper half has one leaning normal, so that its dpdu lean.
      Mesh mesh = sample_mesh(make_surface("plane"), {.columns = 12, .rows = 12});
      const double angle = lean * std::numbers::pi / 180;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        if (mesh.uvs[v].y > 0.51) mesh.normals[v] = {std::sin(angle), 0, std::cos(angle)};
        const Vec3<double> t{1, 0, 0}, &n = mesh.normals[v], along = unit(t - dot(t, n) * n);
        mesh.tangents[v] = {along.x, along.y, along.z, mesh.tangents[v].w};
      }
      EXPECT_EQ(wrong_tangents(mesh), 0u);
      const Mesh right = mesh;
      turn_some(1, turn, mesh);
      std::size_t turned = 0;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        if (mesh.uvs[v].y > 0.51)
          ++turned;
        else
          mesh.tangents[v] = right.tangents[v];
      EXPECT_GE(wrong_tangents(mesh), turned) << turn << ' ' << lean;
    }
}

// Turned by so much, most are beyond their cones: a card has one direction. A scale makes some of the angles
// smaller.
TEST(BakedScales, ExplainNoTangentThatIsTurned) {
  std::mt19937_64 random(282);
  std::cout << "seed 282\n";
  for (const int every : {1, 2, 5, 20})
    for (const double deg : {40.0, 90.0}) {
      const Mesh mesh = foliage(random);
      for (const Eigen::Matrix3d& m : scales(random)) {
        Mesh scaled = mesh;
        turn_some(every, deg, scaled);
        apply(m, scaled);
        test::round_to_floats(scaled);
        const std::size_t corners = static_cast<std::size_t>(cards / every) * 6;
        const std::size_t wrong = wrong_tangents(scaled);
        EXPECT_GE(3 * wrong, corners) << every << ' ' << deg << '\n' << m;
        // Of one in twenty the others tell the scale; all of theirs are right.
        if (every == 20) {
          EXPECT_LE(wrong, corners) << every << ' ' << deg << '\n' << m;
        }
      }
    }
}

}  // namespace
}  // namespace darboux::baked_scales_test
