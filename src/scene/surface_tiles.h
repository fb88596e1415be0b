// The tiles of one surface with what is known of them, made when they are first asked for.
#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include <darboux/tile_bounds.h>

namespace darboux {

// A tile: one of 2^level_u × 2^level_v of the chart.
struct TilePlace {
  std::uint8_t level_u = 0, level_v = 0;
  std::uint32_t column = 0, row = 0;

  Tile tile() const;
  TilePlace half(bool along_u, bool along_v, std::uint32_t i, std::uint32_t k) const;
};

struct TileNode {
  TilePlace place;
  TileBounds bounds;
  TileRates rates;
  Vec3<double> lo, hi;  // its box
  // The first of the parts it is split into: along u, along v, along both. 0 where there are none yet.
  std::array<std::uint32_t, 3> parts{};
};

enum class Split : std::uint8_t { u, v, both, none };
constexpr std::uint32_t part_count(Split split) {
  return split == Split::both ? 4 : 2;
}

class SurfaceTiles {
 public:
  explicit SurfaceTiles(const AnySurface& surface);

  const AnySurface& surface() const { return surface_; }
  // Whether bounds are proven. Where not, boxes and rates are estimates, the same for all tiles.
  bool known() const { return known_; }
  // The largest finite rates over the chart. Where a tile's are infinite, as at the poles of an ellipsoid, it
  // gets the resolution that the finest of the others needs.
  const TileRates& finest() const { return finest_; }
  double radius() const { return radius_; }  // of a sphere about centre() that holds all of it
  const Vec3<double>& centre() const { return centre_; }

  static constexpr std::uint32_t root = 0;
  const TileNode& operator[](std::uint32_t node) const { return nodes_[node]; }
  // The first of the parts.
  std::uint32_t parts(std::uint32_t node, Split split);

 private:
  TileNode make(const TilePlace& place) const;
  void estimate();

  AnySurface surface_;
  bool known_ = true;
  TileRates finest_{};
  Vec3<double> centre_{}, lo_{}, hi_{};
  double radius_ = 0;
  std::deque<TileNode> nodes_;
};

}  // namespace darboux
