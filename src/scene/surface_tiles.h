// The tiles of one surface with their bounds, computed on demand.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <darboux/tile_bounds.h>

#include "tile_levels.h"

namespace darboux {

// A tile: one of 2^level_u × 2^level_v of the chart.
struct TilePlace {
  std::uint8_t level_u = 0, level_v = 0;
  std::uint32_t column = 0, row = 0;

  Tile tile() const;
  TilePlace half(bool along_u, bool along_v, std::uint32_t i, std::uint32_t k) const;
};

// The squared distance from a point to a box.
inline double squared_distance_to_box(const Vec3<double>& p, const Vec3<double>& lo, const Vec3<double>& hi) {
  const auto beyond = [](double x, double from, double to) {
    return x < from ? from - x : x > to ? x - to : 0;
  };
  const Vec3<double> d{beyond(p.x, lo.x, hi.x), beyond(p.y, lo.y, hi.y), beyond(p.z, lo.z, hi.z)};
  return dot(d, d);
}

// The levels required by the permitted frame angles, with the case they apply to.
struct FrameLevels {
  double condition = 0, angle = 0;
  bool of_tangents = false;
  TileLevels levels;
};

// Whether rates are proven bounds; otherwise they are estimated from samples.
struct Proven {
  bool chord = false, frame = false;
  bool operator==(const Proven&) const = default;
};

// A point of a tile, represented by its normal n and n · P. If it is seen from the side of n, the tile does
// not entirely face away. Unknown if n = 0.
struct FacingPoint {
  Vec3<double> normal{};
  double height = 0;
  bool made = false;

  // \param eye the eye point or, without perspective, the direction towards it. False if rounding decides.
  bool faces(const Vec3<double>& eye, bool perspective) const {
    const double x = normal.x * eye.x, y = normal.y * eye.y, z = normal.z * eye.z,
                 h = perspective ? height : 0;
    return x + y + z - h > 0x1p-40 * (std::fabs(x) + std::fabs(y) + std::fabs(z) + std::fabs(h));
  }
};

struct TileNode {
  Vec3<double> lo, hi;  // its box, within that of the tile it is part of
  TilePlace place;
  // The first of the children, if split along u, along v, along both. 0 if not yet created.
  std::array<std::uint32_t, 3> parts{};
  Proven proven;
  FrameLevels frame_levels{};
  ChordLevels chord_levels;
  TileBounds bounds;
  TileRates rates;
  FacingPoint middle;
};

enum class Split : std::uint8_t { u, v, both, none };
constexpr std::uint32_t part_count(Split split) {
  return split == Split::both ? 4 : 2;
}

class SurfaceTiles {
 public:
  // \param order second if frames have bounds, position if only chords have
  SurfaceTiles(const AnySurface& surface, TileOrder order);

  const AnySurface& surface() const { return surface_; }
  // Whether bounds are proven. If not, boxes and rates are estimates, equal for all tiles.
  bool known() const { return known_; }
  // The largest rates over the chart.
  const TileRates& finest() const { return finest_; }
  const Proven& proven() const { return proven_; }  // of these
  // The same rates estimated from samples, if smaller: interval bounds overestimate.
  const TileRates& typical() const { return typical_; }
  bool is_typical() const { return is_typical_; }  // whether these are the largest
  double radius() const { return radius_; }        // of a sphere about centre() that holds all of it
  const Vec3<double>& centre() const { return centre_; }
  // Largest distance from the origin of its own space to a point of that sphere.
  double reach() const { return reach_of_all_; }
  const ChordLevels& finest_chord_levels() const { return finest_levels_; }
  const ChordLevels& typical_chord_levels() const { return typical_levels_; }

  // A lower bound of the distance from a point: in closed form; from far away, that of the box; otherwise the
  // smallest of those of 16 × 16 tiles. For surfaces without bounds it is an estimate from samples. It is
  // Lipschitz with constant 1 in the point, except for jumps between these cases.
  struct Distance {
    double least;
    bool by_tiles = false;
    double way_to_jump = std::numeric_limits<double>::infinity();  // lower bound
  };
  Distance distance(const Vec3<double>& from);

  static constexpr std::uint32_t root = 0;
  const TileNode& operator[](std::uint32_t node) const { return *nodes_[node]; }
  FrameLevels& frame_levels(std::uint32_t node) { return nodes_[node]->frame_levels; }
  FrameLevels& frame_levels() { return frame_levels_; }  // of the finest
  FrameLevels& typical_frame_levels() { return typical_frame_levels_; }
  // A point of a tile that is likely to be visible from an eye point or direction: the middle or, for the
  // whole chart, one of several chosen by the octant.
  const FacingPoint& facing_point(std::uint32_t node, const Vec3<double>& eye) {
    FacingPoint& point =
        node == root ? of_octants_[(eye.x < 0 ? 1u : 0u) + (eye.y < 0 ? 2u : 0u) + (eye.z < 0 ? 4u : 0u)]
                     : nodes_[node]->middle;
    if (point.made) return point;
    if (node == root)
      make_octants();
    else
      make_middle(*nodes_[node]);
    return point;
  }
  // The first of the parts.
  std::uint32_t parts(std::uint32_t node, Split split);

 private:
  std::unique_ptr<TileNode> make(const TilePlace& place);
  FacingPoint facing_point_at(double u, double v) const;
  void make_middle(TileNode& node) const;
  void make_octants();
  double estimated_distance(const Vec3<double>& from) const;
  void find_nearest(std::uint32_t node, const Vec3<double>& from, double& nearest_squared);
  void find_finest();
  void find_closed_form();
  void sample();

  AnySurface surface_;
  TileOrder order_;
  bool known_ = true, is_typical_ = false;
  Proven proven_;
  TileRates finest_, sampled_, typical_;
  FrameLevels frame_levels_, typical_frame_levels_;
  Vec3<double> centre_{}, lo_{}, hi_{};
  double radius_ = 0, reach_of_all_ = 0;
  std::vector<Vec3<double>> places_;
  double reach_ = 0;  // from them to all of the surface
  ChordLevels finest_levels_, typical_levels_;
  // The meridian of a surface of revolution about z, in coordinates (ρ, z): a circle about (centre, 0), a
  // line, or neither.
  struct Meridian {
    enum class Kind : std::uint8_t { none, circle, line } kind = Kind::none;
    double centre = 0, radius = 0;
    double from[2]{}, to[2]{};

    double distance(const Vec3<double>& p) const;
  } meridian_;
  std::optional<Vec3<double>> ellipsoid_;  // its axes
  std::vector<std::unique_ptr<TileNode>> nodes_;
  std::array<FacingPoint, 8> of_octants_;
};

}  // namespace darboux
