// The tiles of one surface with what is known of them, made when they are first asked for.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include <darboux/tile_bounds.h>

namespace darboux {

// A tile: one of 2^level_u × 2^level_v of the chart.
struct TilePlace {
  std::uint8_t level_u = 0, level_v = 0;
  std::uint32_t column = 0, row = 0;

  Tile tile() const;
  TilePlace half(bool along_u, bool along_v, std::uint32_t i, std::uint32_t k) const;
};

// How many cells, as powers of two.
struct TileLevels {
  int u = 0, v = 0;
};

// Those that the angles of frames asked for, and in which case.
struct FrameLevels {
  double condition = 0, angle = 0;
  bool of_tangents = false;
  TileLevels levels;
};

// Whether rates are bounds; else they are estimated from samples.
struct Proven {
  bool chord = false, frame = false;
};

struct TileNode {
  TilePlace place;
  TileBounds bounds;
  TileRates rates;
  Proven proven;
  Vec3<double> lo, hi;  // its box
  // The first of the parts it is split into: along u, along v, along both. 0 where there are none yet.
  std::array<std::uint32_t, 3> parts{};
  FrameLevels frame_levels{};
};

enum class Split : std::uint8_t { u, v, both, none };
constexpr std::uint32_t part_count(Split split) {
  return split == Split::both ? 4 : 2;
}

class SurfaceTiles {
 public:
  // \param order second where frames have bounds
  SurfaceTiles(const AnySurface& surface, TileOrder order);

  const AnySurface& surface() const { return surface_; }
  // Whether bounds are proven. Where not, boxes and rates are estimates, the same for all tiles.
  bool known() const { return known_; }
  // The largest rates over the chart.
  const TileRates& finest() const { return finest_; }
  const Proven& proven() const { return proven_; }  // of these
  // The same as samples have them, where these are smaller: bounds on intervals are larger than what they
  // bound.
  const TileRates& typical() const { return typical_; }
  double radius() const { return radius_; }  // of a sphere about centre() that holds all of it
  const Vec3<double>& centre() const { return centre_; }

  // From samples, for surfaces without bounds.
  double estimated_distance(const Vec3<double>& from) const;

  static constexpr std::uint32_t root = 0;
  const TileNode& operator[](std::uint32_t node) const { return nodes_[node]; }
  FrameLevels& frame_levels(std::uint32_t node) { return nodes_[node].frame_levels; }
  FrameLevels& frame_levels() { return frame_levels_; }  // of the finest
  FrameLevels& typical_frame_levels() { return typical_frame_levels_; }
  // The first of the parts.
  std::uint32_t parts(std::uint32_t node, Split split);

 private:
  TileNode make(const TilePlace& place) const;
  void find_finest();
  void sample();

  AnySurface surface_;
  TileOrder order_;
  bool known_ = true;
  Proven proven_;
  TileRates finest_, sampled_, typical_;
  FrameLevels frame_levels_, typical_frame_levels_;
  Vec3<double> centre_{}, lo_{}, hi_{};
  double radius_ = 0;
  std::vector<Vec3<double>> places_;
  double reach_ = 0;  // from them to all of the surface
  std::deque<TileNode> nodes_;
};

}  // namespace darboux
