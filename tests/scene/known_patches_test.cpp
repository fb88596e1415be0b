// The patches that the plans of a scene share.
#include "scene/known_patches.h"

#include <gtest/gtest.h>

namespace darboux::test {
namespace {

ScenePatch patch_of(std::uint32_t surface, std::uint16_t cells) {
  ScenePatch patch;
  patch.surface = surface;
  patch.cells_u = patch.cells_v = cells;
  return patch;
}

// A patch that is added again is found where it is one, and numbers go on when all are forgotten.
TEST(KnownPatches, AreFoundAndForgotten) {
  for (const bool once : {true, false}) {
    KnownPatches patches(once);
    ScenePatch patch = patch_of(1, 4);
    patches.begin(patch);
    EXPECT_EQ(patches.add(patch, 3), 0u);
    EXPECT_EQ(patches.add(patch, 3), once ? 0u : 1u);
    EXPECT_NE(patches.add(patch_of(2, 4), 3), 0u);
    const std::uint64_t count = patches.size();
    patches.forget();
    EXPECT_EQ(patches.size(), 0u);
    EXPECT_EQ(patches.add(patch, 3), 0u);
    EXPECT_EQ(patches[0].patch.id, count);
  }
}

// The table has a place of its own for each surface, node, number of cells and "all attributes", empty at
// first and when all are forgotten.
TEST(KnownPatches, PlainOnesHaveAPlaceEach) {
  KnownPatches patches(true);
  const auto each = [&](const auto& f) {
    std::uint32_t k = 0;
    for (const std::uint32_t surface : {0u, 3u})
      for (const std::uint32_t node : {0u, 1u, 70u})
        for (int u = 0; u <= tile_level_u; ++u)
          for (int v = 0; v <= tile_level_v; ++v)
            for (const bool all : {false, true}) f(patches.plain(surface, node, {u, v}, all), k++);
  };
  each([](std::uint32_t& place, std::uint32_t k) {
    EXPECT_EQ(place, KnownPatches::none);
    place = k;
  });
  each([](const std::uint32_t& place, std::uint32_t k) { EXPECT_EQ(place, k); });
  patches.forget();
  each([](const std::uint32_t& place, std::uint32_t) { EXPECT_EQ(place, KnownPatches::none); });
}

}  // namespace
}  // namespace darboux::test
