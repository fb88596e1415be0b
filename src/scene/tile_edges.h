// Finds the samples that tiles have on the edges of other tiles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "surface_tiles.h"

namespace darboux {

constexpr std::uint32_t chart_size = 1u << finest_level;  // in integer units

// The extent of a tile, in integer units.
struct Extent {
  std::uint32_t u0, u1, v0, v1;
  explicit Extent(const TilePlace& p)
      : u0(p.column << (finest_level - p.level_u)),
        u1((p.column + 1) << (finest_level - p.level_u)),
        v0(p.row << (finest_level - p.level_v)),
        v1((p.row + 1) << (finest_level - p.level_v)) {}
};

// The samples of an instance's tiles on an edge of another tile that are not multiples of `spacing`.
struct EdgeSearch {
  bool along_u;  // the edge is v = line, else u = line
  bool below;    // search the tiles below the line, or those above
  std::uint32_t line, from, to, spacing;
  bool mirrored;  // across a twisted seam

  // Calls f(k) for those children of a tile that end at the line and touch the edge. The tile itself does.
  template <class F>
  void for_parts(const Extent& e, Split split, F f) const {
    const bool splits_u = split != Split::v, splits_v = split != Split::u;
    const auto parts = [&](bool splits, std::uint32_t lo, std::uint32_t hi, bool along) {
      const std::uint32_t middle = lo + (hi - lo) / 2;
      struct Range {
        std::uint32_t first, last;
      };
      if (!splits) return Range{0, 0};
      if (along) return Range{from < middle ? 0u : 1u, to > middle ? 1u : 0u};
      const std::uint32_t side = line > middle || (line == middle && !below) ? 1 : 0;
      return Range{side, side};
    };
    const auto u = parts(splits_u, e.u0, e.u1, along_u), v = parts(splits_v, e.v0, e.v1, !along_u);
    for (std::uint32_t k = v.first; k <= v.last; ++k)
      for (std::uint32_t i = u.first; i <= u.last; ++i) f(i + (splits_u ? 2 : 1) * k);
  }

  void take(const Extent& e, const TileLevels& cells, std::vector<std::uint32_t>& found) const {
    const std::uint32_t step = along_u ? (e.u1 - e.u0) >> cells.u : (e.v1 - e.v0) >> cells.v;
    if (step >= spacing) return;
    const std::uint32_t begin = std::max(from, along_u ? e.u0 : e.v0),
                        end = std::min(to, along_u ? e.u1 : e.v1);
    for (std::uint32_t x = (begin + step - 1) / step * step; x <= end; x += step)
      if (x % spacing != 0) found.push_back(mirrored ? chart_size - x : x);
  }
};

}  // namespace darboux
