// MikkTSpace to the bit: against tangents that the npm package mikktspace made, which are those of the C
// original.
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/mikktspace.h>

#include "mikktspace/arrays.h"
#include "mikktspace/generated_meshes.h"
#include "refusal_of.h"

namespace darboux::test::mikktspace_test {
namespace {

template <class T>
std::vector<T> read_all(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<T> result(std::filesystem::file_size(path) / sizeof(T));
  file.read(reinterpret_cast<char*>(result.data()), static_cast<std::streamsize>(result.size() * sizeof(T)));
  return result;
}

// A soup file: the number of triangles, then the corners.
Soup read_soup(const std::filesystem::path& path) {
  const std::vector<float> words = read_all<float>(path);
  Soup soup((words.size() - 1) / 8);
  std::memcpy(soup.data(), words.data() + 1, soup.size() * sizeof(Corner));
  return soup;
}

class Files : public ::testing::TestWithParam<std::string> {};
TEST_P(Files, GiveTheSameBits) {
  std::filesystem::path folder = std::string(DARBOUX_TEST_DATA) + "/mikktspace";
  if (!exists(folder / (GetParam() + ".soup"))) folder = std::string(DARBOUX_SHARED) + "/meshes/oracle";
  if (!exists(folder / (GetParam() + ".soup"))) GTEST_SKIP() << GetParam() << ".soup is not there";
  const Arrays arrays(read_soup(folder / (GetParam() + ".soup")));
  EXPECT_TRUE(same_bits(arrays.tangents(), read_all<float>(folder / (GetParam() + ".tan"))));
}
INSTANTIATE_TEST_SUITE_P(MikkTSpace, Files, ::testing::Values("degen", "torus", "mirror"),
                         [](const auto& of) { return of.param; });

TEST(MikkTSpace, GeneratedMeshesGiveTheSameBits) {
  const std::vector<std::uint32_t> stored =
      read_all<std::uint32_t>(std::string(DARBOUX_TEST_DATA) + "/mikktspace/generated_meshes.tangents");
  std::size_t at = 0, compared = 0, unsorted_matters = 0;
  for (std::uint32_t k = 0; k < generated_meshes; ++k) {
    const Soup soup = generated_mesh(k);
    const std::size_t corners = stored.at(at++);
    if (corners == 0) continue;  // the package gave up
    ASSERT_EQ(corners, soup.size()) << "mesh " << k;
    std::vector<float> expected(4 * corners);
    std::memcpy(expected.data(), &stored.at(at), expected.size() * sizeof(float));
    at += expected.size();
    const Arrays arrays(soup);
    EXPECT_TRUE(same_bits(arrays.tangents(), expected)) << "mesh " << k;
    unsorted_matters += !same_bits(arrays.tangents({.sort_all_edges = true}), expected);
    ++compared;
  }
  EXPECT_EQ(at, stored.size());
  EXPECT_GE(compared, 200U);
  EXPECT_GE(unsorted_matters, 1U) << "the original's unsorted edges should show in some";
  std::cout << compared << " meshes, unsorted edges matter in " << unsorted_matters << '\n';
}

// The tangents in full have the same directions; the lengths are those of the derivatives on a plane.
TEST(MikkTSpace, LengthsAreThoseOfTheDerivatives) {
  Arrays plane;
  for (const auto& [u, v] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}, {0.F, 0.F}, {1.F, 1.F}, {0.F, 1.F}})
    plane.add({3 * u, 2 * v, 0, 0, 0, 1, u, v});
  for (const MikkTangent& x : mikktspace(plane.mesh())) {
    EXPECT_EQ(std::vector<float>(x.t, x.t + 3), (std::vector<float>{1, 0, 0}));
    EXPECT_EQ(std::vector<float>(x.b, x.b + 3), (std::vector<float>{0, 1, 0}));
    EXPECT_FLOAT_EQ(x.t_length, 3);
    EXPECT_FLOAT_EQ(x.b_length, 2);
    EXPECT_EQ(x.sign, 1);
  }
  const Arrays arrays(torus_soup(20, 10));
  const std::vector<MikkTangent> all = mikktspace(arrays.mesh());
  const std::vector<float> four = arrays.tangents();
  for (std::size_t c = 0; c < all.size(); ++c)
    EXPECT_EQ(std::vector<float>(all[c].t, all[c].t + 3), std::vector<float>(&four[4 * c], &four[4 * c] + 3));
}

// dpdu of 2^130 is infinite, and NaN where the triangle has no angle: its edges are parallel as seen along
// the normal.
TEST(MikkTSpace, LengthsBeyondTheRangeAreInfiniteOrNaN) {
  const float far = 0x1p100F, near = 0x1p-30F;
  for (const bool flat : {false, true}) {
    Arrays triangle;
    triangle.add(flat ? Corner{0, 0, 0, 0.6F, -0.8F, 0, 0, 0} : Corner{0, 0, 0, 0, 0, 1, 0, 0});
    triangle.add({far, 0, 0, 0, 0, 1, near, 0});
    triangle.add({0, far, 0, 0, 0, 1, 0, 1});
    const MikkTangent x = mikktspace(triangle.mesh())[0];
    EXPECT_TRUE(x.served);
    EXPECT_TRUE(flat ? std::isnan(x.t_length) : x.t_length == std::numeric_limits<float>::infinity());
    EXPECT_EQ(x.b_length, flat ? 0 : far);
  }
}

// As the npm package has it too: what is left of dpdu across the normal, 1e-30 and 1e-40, has a square of 0.
TEST(MikkTSpace, ATangentAlongTheNormalIsWhatRoundingMakesOfIt) {
  const auto tangent = [](const std::array<Corner, 3>& corners, std::size_t corner) {
    Arrays triangle;
    for (const Corner& x : corners) triangle.add(x);
    const MikkTangent x = mikktspace(triangle.mesh())[corner];
    return std::array<float, 3>{x.t[0], x.t[1], x.t[2]};
  };
  const auto with_normal = [&](float y) {
    return tangent({{{0, 0, 0, 1, y, 0, 0, 0}, {1, 0, 0, 1, y, 0, 1, 0}, {0, 1, 0, 1, y, 0, 0, 1}}}, 0);
  };
  for (const float x : with_normal(1e-30F)) EXPECT_TRUE(std::isnan(x));
  const std::array<float, 3> unscaled = with_normal(1e-40F);
  EXPECT_TRUE(unscaled[0] == 0 && unscaled[1] < 0 && unscaled[1] > -FLT_MIN && unscaled[2] == 0);
  EXPECT_EQ(with_normal(0), (std::array<float, 3>{}));
  // dpdu at corner 1 is along the normal but for rounding.
  const std::array<Corner, 3> along{{{0.25F, 0.75F, 0.5F, 0.408248F, -0.816497F, 0.408248F, 0, 0.25F},
                                     {0.5F, 1, -1, -0.534522484F, -0.80178374F, 0.267261237F, -0.5F, 0},
                                     {-0.5F, -0.5F, -0.5F, 0.948683F, 0, 0.316228F, -1, 0}}};
  EXPECT_EQ(tangent(along, 1), (std::array<float, 3>{0, -1, 0}));
}

// A quad is its two triangles, along the diagonal that is shorter in the uvs: on one that is bent the others
// would differ.
TEST(MikkTSpace, QuadsAreCutAlongTheShorterDiagonal) {
  for (const bool other : {false, true}) {
    Arrays quad;
    const float x =
        other ? 0.3F : 1.7F;  // makes the diagonal from corner 1 or that from corner 0 the shorter
    for (const auto& [u, v] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {x, 1.F}, {x - 1, 1.F}})
      quad.add({u, v + 0.4F * u * v, 0.2F * u * v, 0, 0, 1, u, v});
    quad.face_sizes = {4};
    quad.corners = {0, 1, 2, 3};
    Arrays triangles = quad;
    triangles.face_sizes.clear();
    triangles.corners =
        other ? std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3} : std::vector<std::uint32_t>{0, 1, 3, 1, 2, 3};
    const std::vector<float> four = quad.tangents(), six = triangles.tangents();
    for (std::size_t c = 0; c < 6; ++c)
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_NEAR(four[4 * triangles.corners[c] + k], six[4 * c + k], 1e-6)
            << other << ' ' << c << ' ' << k;
  }
}

// Of a quad with two corners in one place, both have the same tangent.
TEST(MikkTSpace, AQuadWithoutItsFourthCornerHasATangentThere) {
  Arrays quad;
  for (const auto& [u, v] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}, {1.F, 1.F}})
    quad.add({u, v, 0, 0, 0, 1, u, v});
  quad.face_sizes = {4};
  const std::vector<float> tangents = quad.tangents();
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_EQ(std::vector<float>(&tangents[4 * c], &tangents[4 * c] + 4), (std::vector<float>{1, 0, 0, 1}))
        << c;
}

TEST(MikkTSpace, AThresholdPartsGroups) {
  Arrays fold;  // two triangles at a right angle; the uvs of the second are sheared
  const float h = std::sqrt(0.5F);
  const Corner first{0, 0, 0, 0, -h, h, 0, 0}, second{1, 0, 0, 0, -h, h, 0, 1};
  for (const Corner& x : {first, second, Corner{0, 1, 0, 0, 0, 1, -1, 0}, second, first,
                          Corner{0.5F, 0, -1, 0, -1, 0, 1, 1.5F}})
    fold.add(x);
  EXPECT_FALSE(same_bits(fold.tangents({.angular_threshold = 5}), fold.tangents()));
  EXPECT_TRUE(same_bits(fold.tangents({.angular_threshold = 179}), fold.tangents()));
}

// Powers of two far beyond what squares in single precision can hold change nothing.
TEST(MikkTSpace, ScaleDoesNotMatter) {
  for (std::uint32_t k = 0; k < generated_meshes; k += 3) {
    const Arrays plain(generated_mesh(k));
    const std::vector<float> tangents = plain.tangents();
    for (const auto& [position, uv] :
         {std::pair{100, 0}, {-100, 0}, {0, 100}, {0, -100}, {100, 100}, {-100, -100}, {100, -100}}) {
      Arrays scaled = plain;
      for (float& x : scaled.positions) x = std::ldexp(x, position);
      for (float& x : scaled.uvs) x = std::ldexp(x, uv);
      EXPECT_TRUE(same_bits(scaled.tangents(), tangents))
          << "mesh " << k << ", 2^" << position << ", 2^" << uv;
    }
  }
  Arrays plane;
  for (const auto& [u, v] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}})
    plane.add(
        {std::ldexp(3 * u, 60), std::ldexp(2 * v, 60), 0, 0, 0, 1, std::ldexp(u, -40), std::ldexp(v, -40)});
  EXPECT_EQ(mikktspace(plane.mesh())[0].t_length, std::ldexp(3.F, 100));
}

// One vertex far out, even at the end of the range, changes nothing elsewhere.
TEST(MikkTSpace, AnOutlierLeavesTheOthersAlone) {
  const Arrays plain(torus_soup(20, 10));
  const std::vector<float> tangents = plain.tangents();
  for (const float far : {1e25F, -3e38F, 1e30F})
    for (const bool in_uv : {false, true}) {
      Arrays with = plain;
      (in_uv ? with.uvs[2 * 600] : with.positions[3 * 600]) = far;
      const std::vector<float> changed = with.tangents();
      std::size_t others = 0;
      for (std::size_t c = 0; c < plain.mesh().corner_count(); ++c) {
        for (std::size_t k = 0; k < 4; ++k) EXPECT_TRUE(std::isfinite(changed[4 * c + k]));
        others += std::memcmp(&changed[4 * c], &tangents[4 * c], 16) != 0 ? 1 : 0;
      }
      EXPECT_LE(others, 18U) << far;  // the corners at the three vertices of its triangle
    }
}

TEST(MikkTSpace, SmallMeshes) {
  EXPECT_TRUE(Arrays().tangents().empty());
  Arrays point(Soup(3, Corner{1, 2, 3, 0, 0, 1, 0, 0}));
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(point.tangents()[4 * c + 3], -1);
  EXPECT_EQ(point.tangents()[0], 1);
}

// Triangles at one vertex: 10^5 whose directions agree, and of those that turn all round, as at a pole, where
// every pair is looked at, fewer.
TEST(MikkTSpace, Fans) {
  for (const bool polar : {false, true}) {
    Arrays fan;
    const std::uint32_t n = polar ? 5000 : 100000;
    fan.add({0, 0, 0, 0, 0, 1, polar ? 0.5F : 0, 0});
    for (std::uint32_t k = 0; k <= n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      const auto x = static_cast<float>(std::cos(angle)), y = static_cast<float>(std::sin(angle));
      if (polar)
        fan.add({x, y, 0, 0, 0, 1, static_cast<float>(k) / static_cast<float>(n), 1});
      else
        fan.add({x, y, 0, 0, 0, 1, x, y});
    }
    for (std::uint32_t k = 1; k <= n; ++k) fan.corners.insert(fan.corners.end(), {0, k, k + 1});
    const std::vector<float> tangents = fan.tangents();
    if (!polar) {
      EXPECT_NEAR(tangents[0], 1, 1e-6);
    }
    for (const float x : tangents) ASSERT_TRUE(std::isfinite(x));
  }
}

// 10^5 copies of one triangle: their edges are all equal, and none finds a neighbour.
TEST(MikkTSpace, CopiesOfOneTriangle) {
  Arrays copies;
  for (const auto& [u, v] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {0.F, 1.F}})
    copies.add({u, v, 0, 0, 0, 1, u, v});
  for (int k = 0; k < 100000; ++k) copies.corners.insert(copies.corners.end(), {0, 1, 2});
  const std::vector<float> tangents = copies.tangents();
  for (std::size_t c = 0; c < 300000; ++c)
    ASSERT_EQ(std::vector<float>(&tangents[4 * c], &tangents[4 * c] + 4), (std::vector<float>{1, 0, 0, 1}));
}

TEST(MikkTSpace, RefusesWhatCannotBeRight) {
  const Arrays good(Soup(3, Corner{1, 2, 3, 0, 0, 1, 0, 0}));
  const auto refusal = [&](auto change) {
    Arrays arrays = good;
    change(arrays);
    return refusal_of<Error>([&] { arrays.tangents(); });
  };
  const auto has = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  has(refusal([](Arrays& a) { a.normals.pop_back(); }),
      "three numbers for the normal of each of its 3 vertices, got 8 numbers");
  has(refusal([](Arrays& a) { a.uvs.clear(); }),
      "two numbers for the uv of each of its 3 vertices, got 0 numbers");
  has(refusal([](Arrays& a) { a.positions.pop_back(); }), "three numbers per position, got 8 numbers");
  has(refusal([](Arrays& a) { a.corners = {0, 1, 3}; }), "vertices below 3, got vertex 3 at corner 2");
  has(refusal([](Arrays& a) { a.corners = {0, 1}; }), "three corners per face, got 2 corners");
  has(refusal([](Arrays& a) { a.face_sizes = {5}; }), "faces of 3 or 4 corners, got 5 in face 0");
  has(refusal([](Arrays& a) { a.face_sizes = {4}; }), "the 4 corners of its faces, got 3 corners");
  has(refusal([](Arrays& a) { a.normals[4] = std::numeric_limits<float>::quiet_NaN(); }),
      "got nan in the normal of vertex 1");
  has(refusal([](Arrays& a) { a.normals[7] = 1e30F; }), " in the normal of vertex 2");
  has(refusal([](Arrays& a) { a.uvs[4] = std::numeric_limits<float>::infinity(); }),
      "got inf in the uv of vertex 2");
  std::vector<float> tangents(11);
  has(refusal_of<Error>([&] { mikktspace(good.mesh(), tangents); }), "11 numbers");
  has(refusal_of<Error>([&] { mikktspace(good.mesh(), {.threads = -1}); }),
      "threads: expected 0 (all) or more, got -1");
  has(refusal_of<Error>([&] { mikktspace(good.mesh(), {.angular_threshold = 181}); }),
      "expected 0 <= degrees <= 180, got 181");
}

}  // namespace
}  // namespace darboux::test::mikktspace_test
