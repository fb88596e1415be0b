#include "hidden_tiles.h"

#include <algorithm>
#include <bit>

namespace darboux {

std::uint64_t HiddenTiles::find(std::span<const Shown> shown, std::span<const Around> around,
                                std::vector<bool>& hidden) {
  cover(shown, around);
  occlusion_.finish();
  if (occlusion_.empty()) return 0;
  // Testing the tiles of smaller instances one by one is not worth it.
  constexpr double large = 4;
  std::uint64_t count = 0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const Shown& it = shown[k];
    const Occlusion::Ball& ball = around[it.instance].ball;
    if (!tiles_of(scene_.instances[it.instance]).known()) continue;
    if (occlusion_.hides(ball)) {
      for (std::size_t i = 0; i < it.patch_count; ++i) hidden[it.first_patch + i] = true;
      count += it.patch_count;
    } else if (it.patch_count > 1 && occlusion_.size_of(ball) > large && occlusion_.may_hide_of(ball)) {
      count += find_of(it, hidden);
    }
  }
  return count;
}

void HiddenTiles::cover(std::span<const Shown> shown, std::span<const Around> around) {
  // Smaller ones hide little. In cells of the depth buffer, which has 128 in a row.
  constexpr double smallest = 5;
  constexpr std::size_t most = 16;
  struct Candidate {
    double size;
    std::uint32_t shown;
    bool operator<(const Candidate& other) const {
      return size != other.size ? size > other.size : shown < other.shown;
    }
  };
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < shown.size(); ++i) {
    const double size = occlusion_.size_of(around[shown[i].instance].ball);
    if (!(size >= smallest)) continue;
    const SceneInstance& instance = scene_.instances[shown[i].instance];
    const SceneMaterial& material = scene_.materials[instance.material];
    if (!material.see_through && material.displacement == 0 &&
        Occlusion::can_hide(tiles_of(instance), instance.placement))
      candidates.push_back({size, i});
  }
  const std::size_t count = std::min(most, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
                    candidates.end());
  candidates.resize(count);
  std::vector<Occlusion::Drawn> drawn;
  for (const Candidate& candidate : candidates) {
    const Shown& it = shown[candidate.shown];
    const auto& [ball, largest] = around[it.instance];
    if (occlusion_.hides(ball)) continue;
    const SceneInstance& instance = scene_.instances[it.instance];
    drawn.clear();
    for (const std::uint32_t id : used_.subspan(it.first_patch, it.patch_count)) {
      const ScenePatch& p = patches_[id].patch;
      drawn.push_back({{p.level_u, p.level_v, p.column, p.row},
                       {std::countr_zero(p.cells_u), std::countr_zero(p.cells_v)}});
    }
    occlusion_.add({instance, tiles_of(instance), scene_.materials[instance.material].double_sided, ball,
                    largest, drawn});
  }
}

std::uint64_t HiddenTiles::find_of(const Shown& shown, std::vector<bool>& hidden) const {
  const SceneInstance& instance = scene_.instances[shown.instance];
  if (scene_.materials[instance.material].displacement > 0) return 0;
  const Occlusion::OfCamera of_camera(occlusion_, instance.placement);
  std::uint64_t count = 0;
  for (std::size_t k = shown.first_patch; k < shown.first_patch + shown.patch_count; ++k) {
    const TileNode& node = tiles_of(instance)[patches_[used_[k]].node];
    if (!occlusion_.hides(of_camera, node.lo, node.hi)) continue;
    hidden[k] = true;
    ++count;
  }
  return count;
}

}  // namespace darboux
