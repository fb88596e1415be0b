// The tiles of an instance before a camera: which are needed, into how many cells each is cut, and what
// samples its neighbours have on its edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kept_answers.h"
#include "tile_tests.h"

namespace darboux {

struct EdgeSearch;

// Tiles of the finest resolution that a tile is made of.
inline std::uint64_t tiles_within(const TilePlace& place, const TileLevels& finest) {
  const int u = finest.u > tile_level_u ? finest.u - tile_level_u : 0,
            v = finest.v > tile_level_v ? finest.v - tile_level_v : 0;
  return std::uint64_t{1} << (u - place.level_u + v - place.level_v);
}

// Tiles of one instance that are skipped, but for duplicates, and those that have no bounds.
struct TileCounts {
  std::uint32_t outside_frustum = 0, back_facing = 0, below_error = 0, unbounded = 0;
};

class VisitedTiles {
 public:
  // A tile that was looked at, in the tree of its instance.
  struct Visited {
    std::uint32_t node;
    std::uint32_t first_part = 0;
    Split split = Split::none;
    bool needed = false;
    bool has_cells = false;
    std::uint8_t planes = 0;  // of the frustum, those that may cut it
    TileLevels cells{};       // of a tile that is needed, or of another if it is known
  };
  // Samples of neighbours on the edges v0, v1, u0, u1 of a tile, between its own: how many, and where, rising
  // on each.
  struct Edges {
    std::array<std::uint32_t, 4> counts{};
    std::vector<double> coordinates;
  };

  VisitedTiles(TileTests& tests, KeptAnswers& answers) : tests_(tests), answers_(answers) {}

  // Looks at the tiles of the instance that is asked about, from the largest to the coarsest that are enough.
  TileCounts visit();
  std::span<const Visited> visited() const { return visited_; }
  // The edges of a tile that is needed. Tiles that are not seen count like the others: what a tile's
  // triangles are does not depend on what is culled.
  const Edges& edges(const Visited& tile) {
    if (visited_.size() > 1) find_edges(tile);
    return edges_;
  }

 private:
  void find_finest();
  void find_edges(const Visited& tile);
  void search(const EdgeSearch& edge);

  TileTests& tests_;
  KeptAnswers& answers_;
  std::vector<Visited> visited_;
  TileLevels finest_;                 // of the cells of all tiles, or finer, in powers of two of the chart
  std::vector<std::uint32_t> found_;  // samples on an edge
  Edges edges_;
};

}  // namespace darboux
