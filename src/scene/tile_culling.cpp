#include "tile_culling.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// 2^-level
double share_of(int level) {
  return 1.0 / static_cast<double>(1u << level);
}

// The fewest cells over a rectangle of the chart for which error(du, dv), which decreases with both, is at
// most 1; at most 2^most. Each step halves the side that reduces the error more.
template <class F>
TileLevels fewest_cells(double width_u, double width_v, const TileLevels& most, F error) {
  TileLevels result;
  double du = width_u, dv = width_v;
  while ((result.u < most.u || result.v < most.v) && !(error(du, dv) <= 1)) {
    if (result.v == most.v || (result.u < most.u && !(error(du, dv / 2) < error(du / 2, dv)))) {
      ++result.u;
      du /= 2;
    } else {
      ++result.v;
      dv /= 2;
    }
  }
  return result;
}

// Rates of frames that a placement M stretches, of a given condition κ. Of f = M x / |M x|, with L and F
// the rates of x of first and second order, |f'| <= κ L, and across f |f''| <= κ F + 2 κ² L². The rates
// of a vector perpendicular to two such vectors are at most the sums of theirs.
TileRates stretched(const TileRates& r, double condition) {
  const double k = condition, k2 = condition * condition;
  TileRates result = r;
  result.normal_u = k * r.normal_u;
  result.normal_v = k * r.normal_v;
  result.normal_uu = k * r.normal_uu + 2 * k2 * r.normal_u * r.normal_u;
  result.normal_uv = k * r.normal_uv + 2 * k2 * r.normal_u * r.normal_v;
  result.normal_vv = k * r.normal_vv + 2 * k2 * r.normal_v * r.normal_v;
  result.frame_u = 2 * k * r.frame_u;
  result.frame_v = 2 * k * r.frame_v;
  result.frame_uu = 2 * k * r.frame_uu + 6 * k2 * r.frame_u * r.frame_u;
  result.frame_uv = 2 * k * r.frame_uv + 6 * k2 * r.frame_u * r.frame_v;
  result.frame_vv = 2 * k * r.frame_vv + 6 * k2 * r.frame_v * r.frame_v;
  return result;
}

// The angle of interpolated frames. Where there is no bound yet, a value beyond all limits that decreases
// with the cells.
double interpolation_angle(const TileRates& r, bool of_tangents, double du, double dv) {
  const double angle =
      of_tangents ? r.frame_interpolation_angle(du, dv) : r.normal_interpolation_angle(du, dv);
  if (std::isfinite(angle)) return angle;
  return std::numbers::pi +
         (of_tangents ? r.frame_u * du + r.frame_v * dv : r.normal_u * du + r.normal_v * dv);
}

}  // namespace

TileCulling::TileCulling(const Scene& scene, const SceneRequest& request, bool wants_slack)
    : scene_(scene),
      request_(request),
      wants_slack_(wants_slack),
      bounds_chord_(std::isfinite(request.chord) || std::isfinite(request.chord_px)) {
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (const auto x = static_cast<Attribute>(a); request.attributes.has(x) && !tangent_attributes.has(x))
      without_tangents_ |= x;
}

bool TileCulling::bounds_frames(Attributes asked) const {
  return asked.has_any(frame_attributes) && request_.frame_angle_rad < std::numbers::pi;
}

void TileCulling::look(const Camera& camera) {
  view_ = View(camera);
  const bool by_distance = view_.perspective() && std::isfinite(request_.chord_px);
  const double pixels = view_.length_of(request_.chord_px, 1);
  chord_per_distance_ = by_distance ? pixels : 0;
  chord_ = by_distance ? request_.chord : std::fmin(request_.chord, pixels);
}

double TileCulling::rounding() const {
  return placed_.condition *
         (0x1p-40 * (view_.distance_of_eye() + 2 * placed_.farthest + view_.near_distance()) +
          0x1p8 * placed_.plane_rounding);
}

void TileCulling::begin(std::uint32_t index, SurfaceTiles& tiles) {
  const SceneMaterial& material = scene_.materials[scene_.instances[index].material];
  tiles_ = &tiles;
  place(scene_, index, tiles, view_, placed_);
  slack = {};
  asked_ =
      request_.skip.unread_attributes && !material.reads_tangents() ? without_tangents_ : request_.attributes;
  bounds_frame_ = bounds_frames(asked_);
  may_face_away_ =
      request_.skip.back_facing && tiles.known() && !material.double_sided && material.displacement == 0;
  const bool culls = request_.skip.outside_frustum && tiles.known();
  whole_.outside = culls && placed_.away > 0;
  whole_.planes = culls && !whole_.outside ? placed_.planes : 0;
  if (culls) Slack::lower(slack.turning, whole_.outside ? placed_.away : placed_.within);
  find_resolutions();
}

// Every tile of the finest resolution.
void TileCulling::find_resolutions() {
  nearest_ = nearest_distance();
  local_chord_ = chord_ / placed_.largest;
  local_chord_per_distance_ = chord_per_distance_ / placed_.largest;
  if (wants_slack_) distance_per_local_chord_ = placed_.largest / chord_per_distance_;
  SurfaceTiles& tiles = *tiles_;
  // Independent of what the material reads, so that the number of tiles does not depend on it.
  const Attributes asked = std::exchange(asked_, request_.attributes);
  const bool bounds_frame = std::exchange(bounds_frame_, bounds_frames(asked_));
  whole_.uniform =
      cells_needed(nearest_, tiles.typical(), tiles.typical_chord_levels(), {}, tiles.typical_frame_levels());
  whole_.finest =
      request_.skip.below_error && !tiles.is_typical()
          ? cells_needed(nearest_, tiles.finest(), tiles.finest_chord_levels(), {}, tiles.frame_levels())
          : whole_.uniform;
  asked_ = asked;
  bounds_frame_ = bounds_frame;
}

// From the eye to the surface, in the scene; anything nearer than the near plane is invisible.
double TileCulling::nearest_distance() {
  whole_.by_tiles = false;
  if (!view_.perspective()) return infinity;
  const auto [nearest, by_tiles, way_to_jump] = tiles_->distance(placed_.eye);
  whole_.by_tiles = by_tiles;
  Slack::lower(slack.moving, way_to_jump * placed_.smallest);
  const double rounded = nearest - placed_.eye_rounding - 0x1p-48 * nearest;
  const double distance = std::max(view_.near_distance(), rounded * placed_.smallest - placed_.displacement);
  return tiles_->known() ? std::max(distance, view_.stretch() * placed_.least_depth) : distance;
}

// The number of cells that a tile needs at a distance from the eye, for its chords and for its frames.
TileLevels TileCulling::cells_needed(double distance, const TileRates& rates, const ChordLevels& chords,
                                     const TilePlace& place, FrameLevels& kept) {
  const double condition = placed_.condition;
  TileLevels result;
  if (bounds_chord_) {
    const ChordLevels::Answer answer =
        chords(local_chord_per_distance_ == 0 ? local_chord_
                                              : std::min(local_chord_, local_chord_per_distance_ * distance));
    result = answer.levels;
    if (wants_slack_ && local_chord_per_distance_ != 0) {
      // The range of distances with the same answer.
      const double share = 1 / view_.stretch();  // depths count this many times
      Slack::lower(slack.turning, (distance - answer.least * distance_per_local_chord_) * share);
      if (!(answer.most > local_chord_))
        Slack::lower(slack.turning, (answer.most * distance_per_local_chord_ - distance) * share);
    }
  }
  if (!bounds_frame_) return result;
  // These do not depend on the distance.
  const TileLevels most{finest_level - place.level_u, finest_level - place.level_v};
  const double width_u = share_of(place.level_u), width_v = share_of(place.level_v);
  const bool of_tangents = asked_.has_any(tangent_attributes);
  if (kept.condition != condition || kept.of_tangents != of_tangents ||
      kept.angle != request_.frame_angle_rad) {
    // A placement that scales uniformly up to rounding, as single-precision matrices do, turns vectors by at
    // most this.
    const double turned = 4 * (condition - 1), asked_for = request_.frame_angle_rad;
    const bool alike = turned <= 0.01 * asked_for;
    const TileRates of_frames = alike ? rates : stretched(rates, condition);
    const double angle = alike ? asked_for - turned : asked_for;
    kept = {condition, asked_for, of_tangents,
            fewest_cells(width_u, width_v, most, [&](double du, double dv) {
              return interpolation_angle(of_frames, of_tangents, du, dv) / angle;
            })};
  }
  return {std::max(result.u, kept.levels.u), std::max(result.v, kept.levels.v)};
}

// Whether a tile lies entirely outside a plane of the frustum. Tests its box first, then the tile itself.
bool TileCulling::outside(std::uint32_t index, std::uint8_t& planes) {
  const Placed& placed = placed_;
  const TileNode& node = (*tiles_)[index];
  const double margin = placed.displacement + placed.plane_rounding;
  double inside = infinity;  // how far the tile reaches into all of those asked
  const Vec3<double> middle = 0.5 * (node.lo + node.hi), half = 0.5 * (node.hi - node.lo);
  for (std::size_t k = 0; k < 6; ++k) {
    if (!(planes >> k & 1)) continue;
    const Vec3<double>& n = placed.normals[k];
    const double at = dot(n, middle) - placed.offsets[k],
                 reach = (std::fabs(n.x) * half.x + std::fabs(n.y) * half.y + std::fabs(n.z) * half.z) *
                         (1 + 0x1p-48);
    if (at - reach > margin) {
      planes = static_cast<std::uint8_t>(planes & ~(1u << k));
      inside = std::min(inside, at - reach);
      continue;
    }
    const bool by_box = at + reach < -margin;
    const double most = by_box ? at + reach : node.bounds.support(n) - placed.offsets[k];
    // How interval bounds change with the plane is unknown.
    const double certain = by_box || node.bounds.attained() ? std::fabs(most + margin) : 0;
    if (most < -margin) {
      Slack::lower(slack.turning, certain);
      return true;
    }
    inside = std::min(inside, certain);
  }
  Slack::lower(slack.turning, inside);
  return false;
}

bool TileCulling::faces_away(std::uint32_t index) {
  const bool perspective = view_.perspective();
  // Most tiles have a point that proves the contrary. Bounds would only add the slack.
  if (!wants_slack_ && tiles_->facing_point(index, placed_.eye).faces(placed_.eye, perspective)) return false;
  const TileBounds& bounds = (*tiles_)[index].bounds;
  const double facing =
      (perspective ? bounds.facing(placed_.eye) : bounds.facing_along(placed_.eye)) + placed_.eye_rounding;
  // It changes by at most the motion of the eye, in the surface's own space, times facing_rate(); or the
  // camera's turn.
  const double way = std::fabs(facing) * placed_.smallest / bounds.facing_rate();
  if (perspective)
    Slack::lower(slack.moving, way);
  else
    Slack::lower(slack.turning, way * placed_.farthest);
  return facing < 0;
}

Resolution TileCulling::resolution(std::uint32_t index) {
  const Placed& placed = placed_;
  SurfaceTiles& tiles = *tiles_;
  const TileNode& node = tiles[index];
  // The finest resolution suffices everywhere. The bounds of a large tile may require more.
  const TileLevels most{whole_.finest.u - node.place.level_u, whole_.finest.v - node.place.level_v};
  // A chart is never cut finer than 2^finest_level.
  const bool limited_u = whole_.finest.u == finest_level, limited_v = whole_.finest.v == finest_level;
  const bool by_bounds = request_.skip.below_error || tiles.is_typical();
  const Resolution finest{most, limited_u || limited_v || !by_bounds ? Proven{} : tiles.proven()};
  if (!request_.skip.below_error) return finest;
  // Smaller tiles have bounds where this one has none, except those at a pole.
  constexpr int small = 5;
  if (!bounds(node.proven) && tiles.known() && (node.place.level_u < small || node.place.level_v < small) &&
      (most.u > tile_level_u || most.v > tile_level_v))
    return finest;
  double distance = nearest_;
  if (view_.perspective() && tiles.known()) {
    const double to_box = std::sqrt(squared_distance_to_box(placed.eye, node.lo, node.hi));
    distance = std::max(
        distance, (to_box - placed.eye_rounding - 0x1p-48 * to_box) * placed.smallest - placed.displacement);
    // View::length_of() takes a point at a distance for one at the least depth that it may have. It has more
    // where all of the tile does.
    const Vec3<double> middle = 0.5 * (node.lo + node.hi), half = 0.5 * (node.hi - node.lo);
    const Vec3<double>& n = placed.depth_normal;
    const double depth = dot(n, middle) - placed.depth_offset -
                         (std::fabs(n.x) * half.x + std::fabs(n.y) * half.y + std::fabs(n.z) * half.z) -
                         placed.displacement - placed.plane_rounding;
    distance = std::max(distance, view_.stretch() * depth);
  }
  const TileLevels cells =
      cells_needed(distance, node.rates, node.chord_levels, node.place, tiles.frame_levels(index));
  const bool enough = cells.u <= most.u - limited_u && cells.v <= most.v - limited_v;
  return enough ? Resolution{cells, node.proven} : finest;
}

}  // namespace darboux
