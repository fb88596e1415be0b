// The patches of the plans of a scene, each once.
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
  std::uint32_t plan = 0, index = 0;  // the last plan that has it, and where
};

class KnownPatches {
 public:
  // \param once whether patches of the same samples are one
  explicit KnownPatches(bool once) : once_(once) {}

  std::size_t size() const { return patches_.size(); }
  KnownPatch& operator[](std::uint32_t i) { return patches_[i]; }
  std::span<const double> edge_coordinates(const ScenePatch& p) const;

  // A patch is begun, the further samples on its edges are added, and it is added itself or found.
  void begin(ScenePatch& patch) const;
  void add_edge_coordinate(double x) { edge_coordinates_.push_back(x); }
  std::uint32_t add(ScenePatch patch, std::uint32_t node);
  // Where the number of the patch stands that is the node of a surface cut into so many cells, in powers of
  // two, with none but their corners; none where there is none yet. A table: of small instances all patches
  // are such. \param all whether it has all attributes that are asked for
  std::uint32_t& plain(std::uint32_t surface, std::uint32_t node, const TileLevels& cells, bool all);
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  // All of them; numbers go on.
  void forget();

 private:
  bool once_;
  std::vector<KnownPatch> patches_;
  std::vector<double> edge_coordinates_;
  HashTable by_hash_;
  using OfNode = std::array<std::uint32_t, 2 * (tile_level_u + 1) * (tile_level_v + 1)>;
  std::vector<std::vector<OfNode>> plain_;  // by surface and node
  std::uint64_t forgotten_ = 0;
};

}  // namespace darboux
