// The tiles of an instance for a camera: which are needed, the number of cells of each, and the samples of
// its neighbours on its edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kept_answers.h"
#include "tile_culling.h"

namespace darboux {

struct EdgeSearch;

// The number of tiles of the finest resolution within a tile.
inline std::uint64_t tiles_within(const TilePlace& place, const TileLevels& finest) {
  const int u = finest.u > tile_level_u ? finest.u - tile_level_u : 0,
            v = finest.v > tile_level_v ? finest.v - tile_level_v : 0;
  return std::uint64_t{1} << (u - place.level_u + v - place.level_v);
}

// Numbers of skipped tiles of one instance (without duplicates), and of tiles without bounds.
struct TileCounts {
  std::uint32_t outside_frustum = 0, back_facing = 0, below_error = 0, unbounded = 0;
};

class VisitedTiles {
 public:
  // A visited tile, in the tree of its instance.
  struct Visited {
    std::uint32_t node;
    std::uint32_t first_part = 0;
    Split split = Split::none;
    bool needed = false;
    bool has_cells = false;
    std::uint8_t planes = 0;  // of the frustum, those that may cut it
    TileLevels cells{};       // of a tile that is needed, or of another if it is known
  };
  // Samples of neighbours on the edges v0, v1, u0, u1 of a tile, between its own: number and positions,
  // ascending on each edge.
  struct Edges {
    std::array<std::uint32_t, 4> counts{};
    std::vector<double> coordinates;
  };

  VisitedTiles(TileCulling& tests, KeptAnswers& answers) : tests_(tests), answers_(answers) {}

  // Visits the tiles of the selected instance, from the largest down to the coarsest that suffice.
  TileCounts visit();
  std::span<const Visited> visited() const { return visited_; }
  // The edges of a needed tile. Invisible neighbours count like visible ones, so the triangles of a tile do
  // not depend on culling.
  const Edges& edges(const Visited& tile) {
    if (visited_.size() > 1) find_edges(tile);
    return edges_;
  }

 private:
  void find_finest();
  void find_edges(const Visited& tile);
  void search(const EdgeSearch& edge);

  TileCulling& tests_;
  KeptAnswers& answers_;
  std::vector<Visited> visited_;
  TileLevels finest_;                 // of the cells of all tiles, or finer, in powers of two of the chart
  std::vector<std::uint32_t> found_;  // samples on an edge
  Edges edges_;
};

}  // namespace darboux
