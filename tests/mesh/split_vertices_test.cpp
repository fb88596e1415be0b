// Vertices are split where values differ, and only there.
#include <bit>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include <darboux/split_vertices.h>

#include "refusal_of.h"

namespace darboux::split_vertices_test {
namespace {

using Indices = std::vector<std::uint32_t>;
constexpr std::uint32_t none = SplitVertices::no_corner;

TEST(SplitVertices, KeepsTheFirstValueAndNumbersTheOthersInOrder) {
  // Vertex 1 is used with 5, 7, 5 and 6, vertex 3 never.
  const Indices corners = {0, 1, 2, 2, 1, 0, 1, 2, 1};
  const std::vector<float> values = {1, 5, 2, 2, 7, 1, 5, 3, 6};
  const SplitVertices split = split_vertices(4, corners, values);
  EXPECT_EQ(split.source, (Indices{0, 1, 2, 3, 1, 2, 1}));
  EXPECT_EQ(split.corner, (Indices{0, 1, 2, none, 4, 7, 8}));
  EXPECT_EQ(split.indices, (Indices{0, 1, 2, 2, 4, 0, 1, 5, 6}));
}

TEST(SplitVertices, TellsValuesApartByTheirBits) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto vertices = [](float a, float b) {
    return split_vertices(1, Indices{0, 0}, std::vector<float>{a, b}).source.size();
  };
  EXPECT_EQ(vertices(1, 1), 1u);
  EXPECT_EQ(vertices(nan, nan), 1u);
  EXPECT_EQ(vertices(0.0f, -0.0f), 2u);
  EXPECT_EQ(vertices(nan, -nan), 2u);
  EXPECT_EQ(vertices(1, std::nextafter(1.0f, 2.0f)), 2u);
  // Lists of several values differ where any of them does, the last one too.
  const std::vector<float> lists = {1, 2, 3, 1, 2, 4, 1, 2, 3, 0, 2, 3};
  EXPECT_EQ(split_vertices(1, Indices{0, 0, 0, 0}, lists).indices, (Indices{0, 1, 0, 2}));
}

TEST(SplitVertices, NothingToSplit) {
  EXPECT_EQ(split_vertices(0, {}, {}).source, Indices{});
  EXPECT_EQ(split_vertices(2, {}, {}).corner, (Indices{none, none}));
  const SplitVertices split = split_vertices(2, Indices{1, 1, 0}, {});
  EXPECT_EQ(split.source, (Indices{0, 1}));
  EXPECT_EQ(split.corner, (Indices{2, 0}));
  EXPECT_EQ(split.indices, (Indices{1, 1, 0}));
}

// The laws that define it, against a map, on random corners with many repeats.
TEST(SplitVertices, EveryCornerFindsItsVertexAndItsValues) {
  std::mt19937 random(5);
  for (int round = 0; round < 100; ++round) {
    const std::size_t vertices = 1 + random() % 20, width = 1 + random() % 3;
    Indices corners(3 * (random() % 40));
    std::vector<float> values(corners.size() * width);
    for (auto& v : corners) v = static_cast<std::uint32_t>(random() % vertices);
    for (auto& x : values) x = static_cast<float>(random() % 3) - 1;
    const SplitVertices split = split_vertices(vertices, corners, values);

    ASSERT_EQ(split.source.size(), split.corner.size());
    ASSERT_EQ(split.indices.size(), corners.size());
    const auto list = [&](std::uint32_t c) {
      return std::vector<float>(values.data() + c * width, values.data() + (c + 1) * width);
    };
    std::map<std::pair<std::uint32_t, std::vector<float>>, std::uint32_t> known;
    std::vector<bool> used(vertices, false);
    std::size_t count = vertices;
    for (std::uint32_t c = 0; c < corners.size(); ++c) {
      const std::uint32_t expected = used[corners[c]] ? static_cast<std::uint32_t>(count) : corners[c];
      const auto [it, fresh] = known.try_emplace({corners[c], list(c)}, expected);
      if (fresh) {
        count += used[corners[c]] ? 1 : 0;
        used[corners[c]] = true;
        EXPECT_EQ(split.corner[it->second], c);
      }
      EXPECT_EQ(split.indices[c], it->second);
      EXPECT_EQ(split.source[split.indices[c]], corners[c]);
      EXPECT_EQ(list(split.corner[split.indices[c]]), list(c));
    }
    EXPECT_EQ(split.source.size(), count);
  }
}

// A fan of 10^5 corners of different values at one vertex, in an order that a scan of those before would take
// 10^10 steps for, and beside it as many equal ones.
TEST(SplitVertices, AFanOfManyValuesAtOneVertex) {
  constexpr std::uint32_t n = 100000;
  Indices corners(2 * n, 0);
  std::vector<float> values(2 * n, -1);
  for (std::uint32_t c = 0; c < n; ++c) values[c] = static_cast<float>((c * 77773ull) % n);
  const SplitVertices split = split_vertices(1, corners, values);
  ASSERT_EQ(split.source.size(), n + 1);
  for (std::uint32_t c = 0; c < n; ++c) EXPECT_EQ(split.indices[c], c);
  for (std::uint32_t c = n; c < 2 * n; ++c) EXPECT_EQ(split.indices[c], n);
}

TEST(SplitVertices, RefusesWhatDoesNotFit) {
  const auto refusal = [](std::size_t vertices, const Indices& corners, const std::vector<float>& values) {
    return test::refusal_of<MeshError>([&] { split_vertices(vertices, corners, values); });
  };
  EXPECT_EQ(refusal(3, {0, 1, 3}, {1, 2, 3}), "split_vertices: corner 2: expected a vertex below 3, got 3");
  EXPECT_EQ(refusal(3, {0, 1, 2}, {1, 2}),
            "split_vertices: expected the same number of values for each of 3 corners, got 2 values");
  EXPECT_EQ(refusal(3, {}, {1}),
            "split_vertices: expected the same number of values for each of 0 corners, got 1 values");
  EXPECT_NE(refusal(0xFFFFFFFF, {}, {}).find("2^32 - 1"), std::string::npos);
}

}  // namespace
}  // namespace darboux::split_vertices_test
