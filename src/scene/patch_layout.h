// The order of the samples of a patch: first the corners of its cells, u varying fastest; then the samples of
// neighbours on its edges, in the order v0, v1, u0, u1; then the centre of each cell that has such samples on
// its border.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <darboux/scene.h>

namespace darboux {

constexpr std::uint32_t edge_samples(const ScenePatch& p) {
  return p.edge_counts[0] + p.edge_counts[1] + p.edge_counts[2] + p.edge_counts[3];
}

// A cell with additional samples on its border: the range of samples on each edge.
struct SplitCell {
  std::uint32_t column, row;
  std::array<std::uint32_t, 4> first{}, count{};
};
// \param coordinates of all patches
std::vector<SplitCell> split_cells(const ScenePatch& patch, std::span<const double> coordinates);

std::uint64_t sample_count(const ScenePatch& patch, std::span<const double> coordinates);

}  // namespace darboux
