// The number of cells of a tile, as powers of two.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <darboux/tile_bounds.h>

namespace darboux {

// A tile has at most 2^5 × 2^4 cells: larger tiles are culled less often, and smaller ones cost more per
// sample.
constexpr int tile_level_u = 5, tile_level_v = 4;
constexpr int finest_level = 14;  // of the cells of a chart

struct TileLevels {
  int u = 0, v = 0;
  bool operator==(const TileLevels&) const = default;
};

// The sequence of subdivisions of a tile for decreasing chord bounds. Each one divides the side along which
// the error decreases more per additional sample of the chart. The error decreases with each subdivision, so
// a search finds how many are needed.
class ChordLevels {
 public:
  ChordLevels() = default;
  // \param du, dv the size of the tile; most: how often it may be cut
  ChordLevels(const TileRates& rates, double du, double dv, const TileLevels& most) {
    TileLevels cuts;
    double uu = rates.position_uu * du * du, uv = 2 * rates.position_uv * du * dv,
           vv = rates.position_vv * dv * dv;
    double cells_u = 1 / du, cells_v = 1 / dv;  // of the chart
    errors_.fill(-1);
    for (std::size_t k = 0;; ++k) {
      levels_u_[k] = static_cast<std::uint8_t>(cuts.u);
      const double error = (1 + 0x1p-48) * (uu + uv + vv) / 8;
      errors_[k] = error >= 0 ? rounded_up(error) : std::numeric_limits<float>::infinity();
      if (cuts.u == most.u && cuts.v == most.v) break;
      uv /= 2;
      const double gain_u = (0.75 * uu + uv) * (cells_v * cells_u + cells_v),
                   gain_v = (0.75 * vv + uv) * (cells_v * cells_u + cells_u);
      if (cuts.v == most.v || (cuts.u < most.u && gain_u >= gain_v)) {
        ++cuts.u;
        uu /= 4;
        cells_u *= 2;
      } else {
        ++cuts.v;
        vv /= 4;
        cells_v *= 2;
      }
    }
  }

  struct Answer {
    TileLevels levels;
    double least, most;  // the answer is the same for all chord bounds in [least, most)
  };
  // The fewest cells that satisfy this chord bound, or the maximum.
  Answer operator()(double chord) const {
    // A linear search: there are few entries, and a binary search would wait for each comparison.
    const float least = rounded_down(chord);
    std::int32_t larger = 0;
    for (const float error : errors_) larger += error > least ? 1 : 0;
    auto k = static_cast<std::size_t>(larger);
    const bool enough = errors_[k] >= 0;
    if (!enough) --k;  // the last one is not either
    return {{levels_u_[k], static_cast<int>(k) - levels_u_[k]},
            enough ? errors_[k] : 0,
            k == 0   ? std::numeric_limits<double>::infinity()
            : enough ? errors_[k - 1]
                     : errors_[k]};
  }

 private:
  // A float is at most x if and only if it is at most rounded_down(x).
  static float rounded_down(double x) {
    const auto nearest = static_cast<float>(x);
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) - (nearest > x ? 1u : 0u));
  }
  static float rounded_up(double x) {
    const auto nearest = static_cast<float>(x);
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) + (nearest < x ? 1u : 0u));
  }

  static constexpr std::size_t size = 32;
  static_assert(2 * finest_level + 1 < size);
  std::array<float, size> errors_{};  // after this many cuts, rounded up; -1 where there are no more
  std::array<std::uint8_t, size> levels_u_{};
};

}  // namespace darboux
