// Which planned tiles lie behind others.
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

// An instance that is in view, with its patches: known ones, by their places in a list of all.
struct Shown {
  std::uint32_t instance, first_patch, patch_count;
};

// What holds an instance, for what it hides and what hides it.
struct Around {
  Occlusion::Ball ball;
  double largest = 0;  // by what it is scaled, at most
};

class HiddenTiles {
 public:
  // \param surfaces by their numbers; used: the known patches of all in view
  HiddenTiles(const Scene& scene, std::span<const std::unique_ptr<SurfaceTiles>> surfaces,
              const KnownPatches& patches, std::span<const std::uint32_t> used, Occlusion& occlusion)
      : scene_(scene), surfaces_(surfaces), patches_(patches), used_(used), occlusion_(occlusion) {}

  // Adds the largest to the occlusion, and marks tiles that lie behind them. Returns how many do.
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
