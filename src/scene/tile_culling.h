// Tests of an instance and its tiles against a camera, with the camera motion for which the results stay
// valid.
#pragma once

#include <cstdint>
#include <limits>

#include <darboux/scene.h>

#include "placed_instance.h"
#include "surface_tiles.h"
#include "view.h"

namespace darboux {

// Attributes that read more of the frame than the normal.
constexpr Attributes tangent_attributes =
    Attribute::tangent | Attribute::bitangent | Attribute::handedness | Attribute::tangent4;

// The number of cells that a tile requires at its distance, whether visible or not.
struct Resolution {
  TileLevels cells;
  Proven proven;

  Split split() const {
    const bool u = cells.u > tile_level_u, v = cells.v > tile_level_v;
    return u && v ? Split::both : u ? Split::u : v ? Split::v : Split::none;
  }
  bool operator==(const Resolution&) const = default;
};

// The camera motion for which an answer stays valid. The distance of a point from a plane, and its depth,
// change by at most the motion of the eye plus the distance of the point times the rotation; facing, by the
// motion of the eye.
struct Slack {
  double turning = std::numeric_limits<double>::infinity(), moving = turning;

  static void lower(double& slack, double way) { slack = slack <= way ? slack : way > 0 ? way : 0; }
};

// An instance as a whole.
struct InstanceView {
  TileLevels uniform;  // cells that the nearest point requires
  TileLevels finest;   // upper bound over all tiles
  bool outside = false;
  bool by_tiles = false;    // SurfaceTiles::Distance: where it changes, answers about tiles jump with it
  std::uint8_t planes = 0;  // of the frustum, those that may cut it

  bool operator==(const InstanceView&) const = default;
};

class TileCulling {
 public:
  // \param wants_slack whether the slack is used
  TileCulling(const Scene& scene, const SceneRequest& request, bool wants_slack);

  void look(const Camera& camera);
  // Selects the instance for the following tests. \throws ParameterError as place()
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

  // Whether a tile is entirely outside one of the given planes of the frustum. `planes` keeps those that may
  // cut it.
  bool outside(std::uint32_t node, std::uint8_t& planes);
  bool faces_away(std::uint32_t node);
  Resolution resolution(std::uint32_t node);

  // The minimum over all answers since it was set.
  Slack slack;
  // The rounding error of the slack.
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
