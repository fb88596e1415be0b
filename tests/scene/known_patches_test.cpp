// The patches that the plans of a scene share.
#include "scene/known_patches.h"

#include <algorithm>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace darboux::test::known_patches_test {
namespace {

ScenePatch patch_of(std::uint32_t surface, std::uint16_t cells) {
  ScenePatch patch;
  patch.surface = surface;
  patch.cells_u = patch.cells_v = cells;
  return patch;
}

constexpr Attributes all = Attribute::position | Attribute::tangent;

// A patch that is added again is found where it is one, and ids go on when all are forgotten.
TEST(KnownPatches, AreFoundAndForgotten) {
  for (const bool once : {true, false})
    for (const std::vector<double>& edge : {std::vector<double>{}, {0.125, 0.375}}) {
      KnownPatches patches(once, all);
      ScenePatch patch = patch_of(1, 4), other = patch_of(2, 4);
      patch.edge_counts[2] = other.edge_counts[2] = static_cast<std::uint32_t>(edge.size());
      EXPECT_EQ(patches.add(patch, edge, 3), 0u);
      EXPECT_EQ(patches.add(patch, edge, 3), once ? 0u : 1u);
      EXPECT_NE(patches.add(other, edge, 3), 0u);
      const std::span<const double> kept = patches.edge_coordinates(patches[0].patch);
      EXPECT_TRUE(std::ranges::equal(kept, edge));
      const std::uint64_t count = patches.size();
      patches.forget();
      EXPECT_EQ(patches.size(), 0u);
      EXPECT_EQ(patches.add(patch, edge, 3), 0u);
      EXPECT_EQ(patches[0].patch.id, count);
    }
}

// Patches of another surface, node, number of cells, of other attributes or edges are others, before and
// after all were forgotten.
TEST(KnownPatches, EachIsItself) {
  KnownPatches patches(true, all);
  const auto each = [&](const auto& f) {
    std::uint32_t k = 0;
    for (const std::uint32_t surface : {0u, 3u})
      for (const std::uint32_t node : {0u, 1u, 70u})
        for (int u = 0; u <= tile_level_u; ++u)
          for (int v = 0; v <= tile_level_v; ++v)
            for (const Attributes attributes : {all, Attributes(Attribute::position)})
              for (const std::vector<double>& edge : {std::vector<double>{}, {0.125}, {0.375}}) {
                ScenePatch patch = patch_of(surface, 1);
                patch.level_u = static_cast<std::uint8_t>(node);
                patch.cells_u = static_cast<std::uint16_t>(1u << u);
                patch.cells_v = static_cast<std::uint16_t>(1u << v);
                patch.attributes = attributes;
                patch.edge_counts[0] = static_cast<std::uint32_t>(edge.size());
                f(patches.add(patch, edge, node), k++);
              }
  };
  for (int round = 0; round < 2; ++round) {
    for (int again = 0; again < 2; ++again)
      each([](std::uint32_t known, std::uint32_t k) { EXPECT_EQ(known, k); });
    patches.forget();
  }
}

}  // namespace
}  // namespace darboux::test::known_patches_test
