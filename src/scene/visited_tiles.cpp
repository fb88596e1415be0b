#include "visited_tiles.h"

#include <algorithm>
#include <utility>

#include "tile_edges.h"

namespace darboux {

TileCounts VisitedTiles::visit() {
  SurfaceTiles& tiles = tests_.tiles();
  TileCounts counts;
  visited_.clear();
  visited_.push_back({.node = SurfaceTiles::root, .planes = tests_.whole().planes});
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    Visited here = visited_[i];
    const auto all = static_cast<std::uint32_t>(tiles_within(tiles[here.node].place, tests_.whole().finest));
    if (here.planes != 0 && answers_.outside(here.node, here.planes)) {
      counts.outside_frustum += all;
      continue;
    }
    if (tests_.may_face_away() && answers_.faces_away(here.node)) {
      counts.back_facing += all;
      continue;
    }
    const Resolution needed = answers_.resolution(here.node);
    here.cells = needed.cells;
    here.split = needed.split();
    if (here.split != Split::none) {
      here.first_part = static_cast<std::uint32_t>(visited_.size());
      const std::uint32_t first = tiles.parts(here.node, here.split);
      for (std::uint32_t k = 0; k < part_count(here.split); ++k)
        visited_.push_back({.node = first + k, .planes = here.planes});
    } else {
      here.needed = here.has_cells = true;
      counts.unbounded += !tests_.bounds(needed.proven);
      counts.below_error += all - 1;
    }
    visited_[i] = here;
  }
  find_finest();
  return counts;
}

void VisitedTiles::find_finest() {
  finest_ = {};
  edges_.counts = {};
  edges_.coordinates.clear();
  if (visited_.size() == 1) return;
  const TileLevels& most = tests_.whole().finest;
  const auto take = [&](const Visited& tile) {
    const TilePlace& at = tests_.tiles()[tile.node].place;
    finest_ = {std::max(finest_.u, at.level_u + tile.cells.u),
               std::max(finest_.v, at.level_v + tile.cells.v)};
  };
  for (const Visited& tile : visited_)
    if (tile.needed) take(tile);
  for (Visited& tile : visited_) {
    if (finest_ == most) break;
    if (tile.needed || tile.split != Split::none) continue;
    // A tile that is not visible.
    const Resolution r = answers_.resolution(tile.node);
    if (r.split() != Split::none) {
      finest_ = most;
      break;
    }
    tile.cells = r.cells;
    tile.has_cells = true;
    take(tile);
  }
}

void VisitedTiles::find_edges(const Visited& tile) {
  edges_.counts = {};
  edges_.coordinates.clear();
  const TilePlace& place = tests_.tiles()[tile.node].place;
  // Along an edge no tile is finer than the finest.
  const bool finest_u = place.level_u + tile.cells.u >= finest_.u,
             finest_v = place.level_v + tile.cells.v >= finest_.v;
  if (finest_u && finest_v) return;
  const Extent e(place);
  const SurfaceInfo& info = tests_.tiles().surface().info();
  const auto round = [](Coordinate c) { return c == Coordinate::turn || c == Coordinate::twisted_turn; };
  const std::uint32_t step_u = (e.u1 - e.u0) >> tile.cells.u, step_v = (e.v1 - e.v0) >> tile.cells.v;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool along_u = k < 2, upper = k % 2 == 1;
    if (along_u ? finest_u : finest_v) continue;
    std::uint32_t line = along_u ? (upper ? e.v1 : e.v0) : (upper ? e.u1 : e.u0);
    std::uint32_t from = along_u ? e.u0 : e.v0, to = along_u ? e.u1 : e.v1;
    bool mirrored = false;
    found_.clear();
    if (line == (upper ? chart_size : 0)) {  // across the seam
      const Coordinate across = along_u ? info.v : info.u;
      if (!round(across)) continue;
      line = chart_size - line;
      if (across == Coordinate::twisted_turn) {
        mirrored = true;
        from = chart_size - std::exchange(to, chart_size - from);
      }
    }
    search({along_u, !upper, line, from, to, along_u ? step_u : step_v, mirrored});
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    edges_.counts[k] = static_cast<std::uint32_t>(found_.size());
    for (const std::uint32_t x : found_) edges_.coordinates.push_back(double(x) / chart_size);
  }
}

// Uses the tiles that were visited and, below invisible ones, the cells that their parts would have.
void VisitedTiles::search(const EdgeSearch& edge) {
  SurfaceTiles& tiles = tests_.tiles();
  const auto unseen = [&](const auto& self, std::uint32_t node) -> void {
    const Extent extent(tiles[node].place);
    const Resolution r = answers_.resolution(node);
    if (r.split() == Split::none) return edge.take(extent, r.cells, found_);
    const std::uint32_t first = tiles.parts(node, r.split());
    edge.for_parts(extent, r.split(), [&](std::uint32_t k) { self(self, first + k); });
  };
  const auto seen = [&](const auto& self, std::uint32_t visited) -> void {
    const Visited& v = visited_[visited];
    if (v.split != Split::none)
      edge.for_parts(Extent(tiles[v.node].place), v.split,
                     [&](std::uint32_t k) { self(self, v.first_part + k); });
    else if (v.has_cells)
      edge.take(Extent(tiles[v.node].place), v.cells, found_);
    else
      unseen(unseen, v.node);
  };
  seen(seen, 0);
}

}  // namespace darboux
