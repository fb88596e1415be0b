// What is asked of an instance and of its tiles before a camera, and for how long the answers stay the same.
#pragma once

#include <cstdint>
#include <limits>

#include <darboux/scene.h>

#include "placed.h"
#include "surface_tiles.h"
#include "view.h"

namespace darboux {

// Attributes that read more of the frame than the normal.
constexpr Attributes tangent_attributes =
    Attribute::tangent | Attribute::bitangent | Attribute::handedness | Attribute::tangent4;

// The cells of a tile as its place asks for them, whether or not it is seen.
struct Resolution {
  TileLevels cells;
  Proven proven;

  Split split() const {
    const bool u = cells.u > tile_level_u, v = cells.v > tile_level_v;
    return u && v ? Split::both : u ? Split::u : v ? Split::v : Split::none;
  }
  bool operator==(const Resolution&) const = default;
};

// How far a camera may move until an answer may be another. What planes say of a point changes by no more
// than the eye moves, and the point's distance times what the camera turns, and so do depths; facing by what
// the eye moves.
struct Slack {
  double turning = std::numeric_limits<double>::infinity(), moving = turning;

  static void lower(double& slack, double way) { slack = slack <= way ? slack : way > 0 ? way : 0; }
};

// An instance as a whole.
struct InstanceView {
  TileLevels uniform;  // cells that the nearest point needs, everywhere
  TileLevels finest;   // the same by the bounds: no tile needs more
  bool outside = false;
  bool by_tiles = false;    // SurfaceTiles::Distance: where it changes, answers about tiles jump with it
  std::uint8_t planes = 0;  // of the frustum, those that may cut it

  bool operator==(const InstanceView&) const = default;
};

class TileTests {
 public:
  // \param wants_slack whether somebody asks for it
  TileTests(const Scene& scene, const SceneRequest& request, bool wants_slack);

  void look(const Camera& camera);
  // The instance that is asked about from now on. \throws ParameterError as place()
  void begin(std::uint32_t instance, SurfaceTiles& tiles);

  SurfaceTiles& tiles() const { return *tiles_; }
  const Placed& placed() const { return placed_; }
  const InstanceView& whole() const { return whole_; }
  Attributes asked() const { return asked_; }  // of it, perhaps nothing
  const View& view() const { return view_; }
  bool perspective() const { return view_.perspective(); }
  Attributes without_tangents() const { return without_tangents_; }
  bool may_face_away() const { return may_face_away_; }
  bool bounds(const Proven& proven) const {
    return (!bounds_chord_ || proven.chord) && (!bounds_frame_ || proven.frame);
  }
  bool bounds_frames(Attributes asked) const;

  // Whether a tile lies wholly beyond one of some planes of the frustum, of which those stay that may cut it.
  bool outside(std::uint32_t node, std::uint8_t& planes);
  bool faces_away(std::uint32_t node);
  Resolution resolution(std::uint32_t node);

  // Of all answers since it was set.
  Slack slack;
  // What roundings may add to it.
  double rounding() const;

 private:
  void find_resolutions();
  double nearest_distance();
  TileLevels cells_needed(double distance, const TileRates& rates, const ChordLevels& chords,
                          const TilePlace& place, FrameLevels& kept);

  const Scene& scene_;
  const SceneRequest& request_;
  bool wants_slack_;
  Attributes without_tangents_;
  bool bounds_chord_;
  View view_{Camera()};
  double chord_ = 0, chord_per_distance_ = 0;  // in the scene; the latter 0 where the distance does not count

  SurfaceTiles* tiles_ = nullptr;
  Placed placed_;
  InstanceView whole_;
  Attributes asked_;
  bool bounds_frame_ = false, may_face_away_ = false;
  double nearest_ = 0;  // distance from the eye
  // In the surface's own space.
  double local_chord_ = 0, local_chord_per_distance_ = 0, distance_per_local_chord_ = 0;
};

}  // namespace darboux
