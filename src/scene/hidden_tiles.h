// Finds planned tiles that are hidden behind others.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <darboux/scene.h>

#include "known_patches.h"
#include "occlusion.h"
#include "surface_tiles.h"

namespace darboux {

// An instance in view, with its patches as indices into the list of known patches.
struct Shown {
  std::uint32_t instance, first_patch, patch_count;
};

// Bounding volumes of an instance, as occluder and as occludee.
struct Around {
  Occlusion::Ball ball;
  double largest = 0;  // largest scale factor
};

class HiddenTiles {
 public:
  // \param surfaces by their numbers; used: the known patches of all in view
  HiddenTiles(const Scene& scene, std::span<const std::unique_ptr<SurfaceTiles>> surfaces,
              const KnownPatches& patches, std::span<const std::uint32_t> used, Occlusion& occlusion)
      : scene_(scene), surfaces_(surfaces), patches_(patches), used_(used), occlusion_(occlusion) {}

  // Adds the largest instances as occluders, and marks tiles behind them. Returns their number.
  // \param around of all instances, but those that are not shown
  std::uint64_t find(std::span<const Shown> shown, std::span<const Around> around, std::vector<bool>& hidden);

 private:
  void cover(std::span<const Shown> shown, std::span<const Around> around);
  std::uint64_t find_of(const Shown& shown, std::vector<bool>& hidden) const;
  const SurfaceTiles& tiles_of(const SceneInstance& instance) const { return *surfaces_[instance.surface]; }

  const Scene& scene_;
  std::span<const std::unique_ptr<SurfaceTiles>> surfaces_;
  const KnownPatches& patches_;
  std::span<const std::uint32_t> used_;
  Occlusion& occlusion_;
};

}  // namespace darboux
