// The distinct patches of the plans of a scene.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <darboux/scene.h>

#include "base/hash_table.h"
#include "tile_levels.h"

namespace darboux {

struct KnownPatch {
  ScenePatch patch;
  std::uint32_t samples, node;        // of SurfaceTiles
  std::uint32_t plan = 0, index = 0;  // the last plan that contains it, and its index there
};

class KnownPatches {
 public:
  // \param once whether patches with the same samples are merged; all: the attributes of most patches
  KnownPatches(bool once, Attributes all) : once_(once), all_(all) {}

  std::size_t size() const { return patches_.size(); }
  KnownPatch& operator[](std::uint32_t i) { return patches_[i]; }
  const KnownPatch& operator[](std::uint32_t i) const { return patches_[i]; }
  std::span<const double> edge_coordinates(const ScenePatch& p) const;

  // Finds or adds a patch; returns its number. Besides the attributes given to the constructor, the patches
  // of a surface have at most one other set.
  // \param patch with its edge_counts; edge_coordinates: its own; node: of SurfaceTiles
  std::uint32_t add(const ScenePatch& patch, std::span<const double> edge_coordinates, std::uint32_t node);

  // The number of a patch without additional samples on its edges, by surface, node and cells; `none` if
  // unknown.
  std::uint32_t find_plain(std::uint32_t surface, std::uint32_t node, const TileLevels& cells,
                           Attributes attributes) const {
    if (surface >= plain_.size() || node >= plain_[surface].size()) return none;
    return plain_[surface][node][index_in_node(cells, attributes)];
  }
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  // Removes all patches; new ids continue the sequence.
  void forget();

 private:
  std::size_t index_in_node(const TileLevels& cells, Attributes attributes) const {
    return static_cast<std::size_t>(2 * (cells.u * (tile_level_v + 1) + cells.v) + (attributes == all_));
  }
  std::uint32_t& plain(const ScenePatch& patch, std::uint32_t node);
  std::uint32_t add_new(ScenePatch patch, std::span<const double> edge_coordinates, std::uint32_t node);

  bool once_;
  Attributes all_;
  std::vector<KnownPatch> patches_;
  std::vector<double> edge_coordinates_;
  // Patches with additional samples on their edges.
  HashTable by_hash_;
  // Plain patches, by surface, node, cells and attributes. Small instances have only plain patches.
  using OfNode = std::array<std::uint32_t, 2 * (tile_level_u + 1) * (tile_level_v + 1)>;
  std::vector<std::vector<OfNode>> plain_;
  std::uint64_t forgotten_ = 0;
};

}  // namespace darboux
