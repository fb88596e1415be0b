#include "known_patches.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "patch_layout.h"

namespace darboux {
namespace {

// A key for patches of a surface that are the same, except for the samples on their edges.
std::pair<std::uint64_t, std::uint64_t> place_of(const ScenePatch& p) {
  return {
      std::uint64_t{p.surface} << 32 | std::uint64_t{p.cells_u} << 16 | p.cells_v,
      std::uint64_t{p.column} << 40 | std::uint64_t{p.row} << 16 | std::uint64_t{p.level_u} << 8 | p.level_v};
}

}  // namespace

std::span<const double> KnownPatches::edge_coordinates(const ScenePatch& p) const {
  return std::span(edge_coordinates_).subspan(p.first_edge_coordinate, edge_samples(p));
}

std::uint32_t KnownPatches::add(const ScenePatch& patch, std::span<const double> edge_coordinates,
                                std::uint32_t node) {
  if (!once_) return add_new(patch, edge_coordinates, node);
  if (edge_coordinates.empty()) {
    std::uint32_t& known = plain(patch, node);
    if (known == none) known = add_new(patch, {}, node);
    return known;
  }
  std::uint64_t h = 0;
  const auto mix = [&](std::uint64_t x) {
    h = (h ^ x) * 0x9E3779B97F4A7C15u;
    h ^= h >> 32;
  };
  const auto place = place_of(patch);
  mix(place.first);
  mix(place.second);
  for (const double x : edge_coordinates) mix(std::bit_cast<std::uint64_t>(x));
  const auto hash = static_cast<std::uint32_t>(h >> 32);
  std::uint32_t found = none;
  by_hash_.any_of(hash, [&](std::uint32_t i) {
    const ScenePatch& p = patches_[i].patch;
    const bool same = place_of(p) == place && p.attributes == patch.attributes &&
                      p.edge_counts == patch.edge_counts &&
                      std::ranges::equal(this->edge_coordinates(p), edge_coordinates);
    if (same) found = i;
    return same;
  });
  if (found != none) return found;
  const std::uint32_t fresh = add_new(patch, edge_coordinates, node);
  by_hash_.insert(hash, fresh);
  return fresh;
}

std::uint32_t KnownPatches::add_new(ScenePatch patch, std::span<const double> edge_coordinates,
                                    std::uint32_t node) {
  const auto fresh = static_cast<std::uint32_t>(patches_.size());
  patch.id = forgotten_ + fresh;
  patch.first_edge_coordinate = static_cast<std::uint32_t>(edge_coordinates_.size());
  edge_coordinates_.insert(edge_coordinates_.end(), edge_coordinates.begin(), edge_coordinates.end());
  patches_.push_back({patch, static_cast<std::uint32_t>(sample_count(patch, edge_coordinates_)), node});
  return fresh;
}

std::uint32_t& KnownPatches::plain(const ScenePatch& patch, std::uint32_t node) {
  if (patch.surface >= plain_.size()) plain_.resize(patch.surface + 1);
  std::vector<OfNode>& of_surface = plain_[patch.surface];
  if (node >= of_surface.size()) {
    OfNode unknown;
    unknown.fill(none);
    of_surface.resize(node + 1, unknown);
  }
  const TileLevels cells{std::countr_zero(patch.cells_u), std::countr_zero(patch.cells_v)};
  return of_surface[node][index_in_node(cells, patch.attributes)];
}

void KnownPatches::forget() {
  forgotten_ += patches_.size();
  patches_.clear();
  edge_coordinates_.clear();
  by_hash_ = {};
  plain_.clear();
}

}  // namespace darboux
