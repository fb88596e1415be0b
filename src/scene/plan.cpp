#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/scene.h>

#include "base/hash_table.h"
#include "patch_layout.h"
#include "placed.h"
#include "surface_tiles.h"
#include "tile_edges.h"
#include "view.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// 2^-level
double share_of(int level) {
  return 1.0 / static_cast<double>(1u << level);
}

constexpr Attributes tangent_attributes =
    Attribute::tangent | Attribute::bitangent | Attribute::handedness | Attribute::tangent4;

// The fewest cells on a rectangle of the chart for which error(du, dv) <= 1, which falls with both, or
// 2^most. Halves that side of the cells that is worth more.
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

// Rates of frames that a placement M stretches, of a given condition. Of f = M x / |M x|, with L and F the
// rates of x of first and second order, |f'| <= κ L, and across f |f''| <= κ F + 2 κ² L². What is square to
// two such vectors adds theirs.
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

// The angle of interpolated frames. Where there is no bound yet, beyond all bounds and falling with the
// cells.
double interpolation_angle(const TileRates& r, bool of_tangents, double du, double dv) {
  const double angle =
      of_tangents ? r.frame_interpolation_angle(du, dv) : r.normal_interpolation_angle(du, dv);
  if (std::isfinite(angle)) return angle;
  return std::numbers::pi +
         (of_tangents ? r.frame_u * du + r.frame_v * dv : r.normal_u * du + r.normal_v * dv);
}

// A tile that was looked at, in the tree of its instance.
struct Visited {
  std::uint32_t node;
  std::uint32_t first_part = 0;
  Split split = Split::none;
  bool needed = false;
  std::uint8_t planes = 0;  // of the frustum, those that may cut it
  TileLevels cells;         // of a tile that is needed
};

// The instance that is planned.
struct Current {
  SurfaceTiles* tiles;
  Placed placed;
  double nearest;  // distance from the eye
  // Chords, in the surface's own space: `chord`, and per distance from the eye.
  double chord, chord_per_distance;
  TileLevels finest;  // cells that the nearest point needs
  Attributes asked;
  bool bounds_chord, bounds_frame;  // what is asked for
};

// The cells of a tile as its place asks for them, whether or not it is seen.
struct Resolution {
  TileLevels cells;
  Proven proven;

  Split split() const {
    const bool u = cells.u > tile_level, v = cells.v > tile_level;
    return u && v ? Split::both : u ? Split::u : v ? Split::v : Split::none;
  }
};

void check(const Scene& scene, const SceneRequest& request) {
  const auto positive = [](const char* name, double bound) {
    if (!(bound > 0)) throw ParameterError(name, "expected a bound > 0, got " + std::to_string(bound));
  };
  positive("chord_px", request.chord_px);
  positive("chord", request.chord);
  positive("frame_angle_rad", request.frame_angle_rad);
  if (request.attributes.empty()) throw ParameterError("attributes", "expected at least one, got none");
  for (const SceneMaterial& m : scene.materials)
    if (!(m.displacement >= 0) || !std::isfinite(m.displacement))
      throw ParameterError("material " + m.name,
                           "expected a displacement >= 0, got " + std::to_string(m.displacement));
  if (scene.instances.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw ParameterError("scene",
                         "expected fewer than 2^31 instances, got " + std::to_string(scene.instances.size()));
}

// Tiles of the finest resolution that a tile is made of.
std::uint64_t tiles_within(const TilePlace& place, const TileLevels& finest) {
  const TileLevels deepest{std::max(finest.u - tile_level, 0), std::max(finest.v - tile_level, 0)};
  return std::uint64_t{1} << (deepest.u - place.level_u + deepest.v - place.level_v);
}

// What is skipped of one instance, but for duplicates, and what of it has no bounds.
struct Counts {
  std::uint32_t outside_frustum = 0, back_facing = 0, below_error = 0, unbounded = 0;
};

// What was decided for an instance: its tiles, and for how long they stay the same.
struct Decision {
  // While moved + reach · turned <= limit, of the camera's way.
  double reach = 0, limit = -infinity;
  std::size_t first = 0;  // of its patches, among those of the last plan
  std::uint32_t count = 0;
  Counts counts;
  TileLevels finest, uniform;
  bool reads_nothing = false;
};

// A patch of any plan of a path.
struct KnownPatch {
  ScenePatch patch;
  std::uint32_t samples;
  std::uint32_t plan = 0, index = 0;  // the last plan that has it, and where
};

// How far a camera has moved and turned, all in all: the length of its way, and that of its axes' way as a
// matrix, which is no less than the angle.
class CameraWay {
 public:
  double moved = 0, turned = 0;

  // Whether it goes on from the last camera; else the way begins anew.
  bool goes_on(const Camera& next) {
    const bool same = last_ && last_->projection == next.projection && last_->width_px == next.width_px &&
                      last_->height_px == next.height_px &&
                      last_->vertical_field_of_view_rad == next.vertical_field_of_view_rad &&
                      last_->view_height == next.view_height && last_->near_distance == next.near_distance &&
                      last_->far_distance == next.far_distance;
    if (same) {
      moved += (next.pose.translation() - last_->pose.translation()).norm() * (1 + 0x1p-48);
      turned +=
          (next.pose.linear() - last_->pose.linear()).norm() * (1 + 0x1p-15);  // poses are rigid to 1e-5
    } else {
      moved = turned = 0;
    }
    last_ = next;
    return same;
  }

 private:
  std::optional<Camera> last_;
};

}  // namespace

class ScenePlanner::Planner {
 public:
  // \param keeps decisions from one camera to the next
  Planner(const Scene& scene, const SceneRequest& request, bool keeps);
  ScenePlan plan(const Camera& camera);

 private:
  double nearest_distance(SurfaceTiles& tiles, const Placed& placed);
  TileLevels cells_needed(double distance, const TileRates& rates, const ChordLevels& chords,
                          const TilePlace& place, FrameLevels& kept);
  bool bounds_frames(Attributes asked) const {
    return asked.has_any(frame_attributes) && request_.frame_angle_rad < std::numbers::pi;
  }
  void begin(const Camera& camera);
  void plan_instance(std::uint32_t instance);
  void decide(std::uint32_t instance);
  void decide_tiles(std::uint32_t instance);
  void keep(Decision& decision) const;
  void count(const Decision& decision);
  void visit_tiles(bool one_sided);
  void add_patches(std::uint32_t instance);
  Resolution resolution(std::uint32_t node);
  bool outside(const TileNode& node, std::uint8_t& planes);
  bool faces_away(const TileNode& node);
  void find_edges(const Visited& tile, ScenePatch& patch);
  std::uint32_t known(ScenePatch patch);
  void add(std::uint32_t instance, std::uint32_t known);
  void finish();

  // Decisions hold while the camera's way, and what it turns times the distance, is shorter than this.
  void holds_for(double way) { slack_ = slack_ <= way ? slack_ : way > 0 ? way : 0; }

  const Scene& scene_;
  SceneRequest request_;
  bool keeps_;
  View view_{Camera()};
  double chord_ = 0, chord_per_distance_ = 0;  // in the scene; the latter 0 where the distance does not count
  std::vector<std::unique_ptr<SurfaceTiles>> tiles_;

  Current current_{};
  Decision decision_;  // of the current instance
  double slack_ = 0;
  std::vector<Visited> visited_;
  std::vector<std::uint32_t> found_;  // samples on an edge

  CameraWay way_;
  std::vector<Decision> decisions_;              // of all instances
  std::vector<std::uint32_t> used_, last_used_;  // known patches by instance, of this plan and the last
  std::vector<KnownPatch> patches_;
  std::vector<double> edge_coordinates_;  // of these
  std::uint64_t forgotten_ = 0;           // patches of earlier plans
  std::uint32_t plans_ = 0;
  Attributes without_tangents_;
  std::array<std::uint64_t, 2> samples_by_attributes_{};  // without tangents, and all that was asked for
  HashTable by_hash_;
  bool unfinished_ = false;  // the last plan, that an error ended
  ScenePlan plan_;
};

ScenePlanner::Planner::Planner(const Scene& scene, const SceneRequest& request, bool keeps)
    : scene_(scene), request_(request), keeps_(keeps), tiles_(scene.surfaces.size()) {
  check(scene, request);
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (const auto x = static_cast<Attribute>(a); request.attributes.has(x) && !tangent_attributes.has(x))
      without_tangents_ |= x;
}

// From the eye to the surface, in the scene; what is nearer than the near plane is not seen.
double ScenePlanner::Planner::nearest_distance(SurfaceTiles& tiles, const Placed& placed) {
  if (!view_.perspective()) return infinity;
  double jump = infinity;
  const double nearest = tiles.distance(placed.eye, jump);
  holds_for(jump * placed.smallest);
  const double rounded = nearest - placed.eye_rounding - 0x1p-48 * nearest;
  return std::fmax(rounded * placed.smallest - placed.displacement, view_.near_distance());
}

// How many cells a tile needs at a distance from the eye: what its chords ask for and what its frames ask
// for.
TileLevels ScenePlanner::Planner::cells_needed(double distance, const TileRates& rates,
                                               const ChordLevels& chords, const TilePlace& place,
                                               FrameLevels& kept) {
  const double condition = current_.placed.condition;
  const Attributes asked = current_.asked;
  TileLevels result;
  if (current_.bounds_chord) {
    const ChordLevels::Answer answer = chords(
        current_.chord_per_distance == 0 ? current_.chord
                                         : std::fmin(current_.chord, current_.chord_per_distance * distance));
    result = answer.levels;
    if (keeps_ && current_.chord_per_distance != 0) {
      // The distances between which it is the same.
      holds_for(distance - answer.least / current_.chord_per_distance);
      if (!(answer.most > current_.chord)) holds_for(answer.most / current_.chord_per_distance - distance);
    }
  }
  if (!bounds_frames(asked)) return result;
  // These do not depend on the distance.
  const TileLevels most{finest_level - place.level_u, finest_level - place.level_v};
  const double width_u = share_of(place.level_u), width_v = share_of(place.level_v);
  const bool of_tangents = asked.has_any(tangent_attributes);
  if (kept.condition != condition || kept.of_tangents != of_tangents ||
      kept.angle != request_.frame_angle_rad) {
    // What scales all alike but for rounding, as matrices in single precision do, turns vectors by that much.
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

// Whether a tile lies wholly beyond a plane of the frustum. By its box, then by itself.
bool ScenePlanner::Planner::outside(const TileNode& node, std::uint8_t& planes) {
  const Placed& placed = current_.placed;
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
      inside = std::fmin(inside, at - reach);
      continue;
    }
    const bool by_box = at + reach < -margin;
    const double most = by_box ? at + reach : node.bounds.support(n) - placed.offsets[k];
    // How bounds on intervals change with the plane is not known.
    const double certain = by_box || node.bounds.attained() ? std::fabs(most + margin) : 0;
    if (most < -margin) {
      holds_for(certain);
      return true;
    }
    inside = std::fmin(inside, certain);
  }
  holds_for(inside);
  return false;
}

bool ScenePlanner::Planner::faces_away(const TileNode& node) {
  const Placed& placed = current_.placed;
  const double facing =
      view_.perspective() ? node.bounds.facing(placed.eye) : node.bounds.facing_along(placed.eye);
  // Changes by no more than the eye moves, in the surface's own space, times facing_rate(); or turns.
  const double rate =
      node.bounds.facing_rate() / (placed.smallest * (view_.perspective() ? 1 : placed.farthest));
  holds_for(std::fabs(facing + placed.eye_rounding) / rate);
  return facing < -placed.eye_rounding;
}

Resolution ScenePlanner::Planner::resolution(std::uint32_t index) {
  const Placed& placed = current_.placed;
  SurfaceTiles& tiles = *current_.tiles;
  const TileNode& node = tiles[index];
  // The finest is enough everywhere. The bounds of a large tile may ask for more.
  const TileLevels most{current_.finest.u - node.place.level_u, current_.finest.v - node.place.level_v};
  // A chart is never cut finer than 2^finest_level.
  const bool limited_u = current_.finest.u == finest_level, limited_v = current_.finest.v == finest_level;
  const Resolution finest{most, limited_u || limited_v ? Proven{} : tiles.proven()};
  if (!request_.skip.below_error) return finest;
  // Smaller tiles have bounds where this one has none, but for those at a pole.
  constexpr int small = 5;
  const bool bounded =
      (!current_.bounds_chord || node.proven.chord) && (!current_.bounds_frame || node.proven.frame);
  if (!bounded && tiles.known() && (node.place.level_u < small || node.place.level_v < small) &&
      (most.u > tile_level || most.v > tile_level))
    return finest;
  double distance = current_.nearest;
  if (view_.perspective() && tiles.known()) {
    const double to_box = std::sqrt(squared_distance_to_box(placed.eye, node.lo, node.hi));
    distance = std::fmax(
        distance, (to_box - placed.eye_rounding - 0x1p-48 * to_box) * placed.smallest - placed.displacement);
  }
  const TileLevels cells =
      cells_needed(distance, node.rates, node.chord_levels, node.place, tiles.frame_levels(index));
  const bool enough = cells.u <= most.u - limited_u && cells.v <= most.v - limited_v;
  return enough ? Resolution{cells, node.proven} : finest;
}

// What was decided for an earlier camera, as long as that holds; else anew.
void ScenePlanner::Planner::plan_instance(std::uint32_t index) {
  if (!keeps_) return decide(index);
  Decision& kept = decisions_[index];
  const std::size_t first = used_.size();
  if (way_.moved + kept.reach * way_.turned <= kept.limit) {
    for (std::size_t i = kept.first; i < kept.first + kept.count; ++i) add(index, last_used_[i]);
    count(kept);
  } else {
    decide(index);
    kept = decision_;
    kept.count = static_cast<std::uint32_t>(used_.size() - first);
    keep(kept);
  }
  kept.first = first;
}

// For how long a decision holds. Of a point at a distance from the eye, what planes say of it changes by no
// more than the eye moves, and the distance times what the camera turns.
void ScenePlanner::Planner::keep(Decision& decision) const {
  const Placed& placed = current_.placed;
  const double rounding = 0x1p-40 * placed.condition *
                          (view_.eye().norm() + 2 * placed.farthest + view_.near_distance() + way_.moved);
  const double way = std::fmin(std::fmax(slack_ - rounding, 0), placed.farthest);
  decision.reach = placed.farthest + way;
  decision.limit = way_.moved + decision.reach * way_.turned + way;
}

void ScenePlanner::Planner::count(const Decision& decision) {
  const std::uint64_t all = tiles_within({}, decision.finest);
  plan_.tiles_all += all;
  plan_.samples_full +=
      ((std::uint64_t{1} << decision.uniform.u) + 1) * ((std::uint64_t{1} << decision.uniform.v) + 1);
  if (decision.reads_nothing) plan_.skipped.no_normal_map += all;
  plan_.skipped.outside_frustum += decision.counts.outside_frustum;
  plan_.skipped.back_facing += decision.counts.back_facing;
  plan_.skipped.below_error += decision.counts.below_error;
  plan_.tiles_unbounded += decision.counts.unbounded;
  plan_.instances_needed += decision.count > 0;
}

void ScenePlanner::Planner::decide(std::uint32_t index) {
  const SceneInstance& instance = scene_.instances[index];
  if (instance.surface >= scene_.surfaces.size() || instance.material >= scene_.materials.size())
    throw ParameterError("instance " + std::to_string(index),
                         "expected a surface below " + std::to_string(scene_.surfaces.size()) +
                             " and a material below " + std::to_string(scene_.materials.size()) + ", got " +
                             std::to_string(instance.surface) + " and " + std::to_string(instance.material));
  std::unique_ptr<SurfaceTiles>& kept = tiles_[instance.surface];
  if (!kept)
    kept = std::make_unique<SurfaceTiles>(
        scene_.surfaces[instance.surface],
        bounds_frames(request_.attributes) ? TileOrder::second : TileOrder::position);
  decision_ = {};
  slack_ = infinity;
  current_.tiles = kept.get();
  place(scene_, index, *kept, view_, current_.placed);
  const std::size_t first = used_.size();
  decide_tiles(index);
  decision_.count = static_cast<std::uint32_t>(used_.size() - first);
  count(decision_);
}

void ScenePlanner::Planner::decide_tiles(std::uint32_t index) {
  SurfaceTiles& tiles = *current_.tiles;
  const SceneMaterial& material = scene_.materials[scene_.instances[index].material];
  const SceneRequest::Skip& skip = request_.skip;

  // Every tile of the finest resolution.
  current_.nearest = nearest_distance(tiles, current_.placed);
  const double largest = current_.placed.largest;
  current_.chord = chord_ / largest;
  current_.chord_per_distance = chord_per_distance_ / largest;
  current_.asked = request_.attributes;
  current_.bounds_chord = std::isfinite(request_.chord) || std::isfinite(request_.chord_px);
  decision_.uniform = cells_needed(current_.nearest, tiles.typical(), tiles.typical_chord_levels(), {},
                                   tiles.typical_frame_levels());
  current_.finest = decision_.finest =
      skip.below_error && !tiles.is_typical()
          ? cells_needed(current_.nearest, tiles.finest(), tiles.finest_chord_levels(), {},
                         tiles.frame_levels())
          : decision_.uniform;

  if (skip.unread_attributes && !material.reads_tangents()) current_.asked = without_tangents_;
  if (current_.asked.empty()) {
    decision_.reads_nothing = true;
    return;
  }
  current_.bounds_frame = bounds_frames(current_.asked);
  if (skip.outside_frustum && tiles.known() && current_.placed.away > 0) {
    holds_for(current_.placed.away);
    decision_.counts.outside_frustum = static_cast<std::uint32_t>(tiles_within({}, current_.finest));
    return;
  }
  visit_tiles(!material.double_sided && material.displacement == 0);
  add_patches(index);
}

// The tiles that the current instance needs, of the coarsest resolution that is enough, and those above them.
void ScenePlanner::Planner::visit_tiles(bool one_sided) {
  SurfaceTiles& tiles = *current_.tiles;
  const SceneRequest::Skip& skip = request_.skip;
  visited_.clear();
  visited_.push_back({SurfaceTiles::root,
                      0,
                      Split::none,
                      false,
                      skip.outside_frustum && tiles.known() ? current_.placed.planes : std::uint8_t{0},
                      {}});
  if (skip.outside_frustum && tiles.known()) holds_for(current_.placed.within);
  Counts& counts = decision_.counts;
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    Visited here = visited_[i];
    const TileNode& node = tiles[here.node];
    const auto all = static_cast<std::uint32_t>(tiles_within(node.place, current_.finest));
    if (here.planes != 0 && outside(node, here.planes)) {
      counts.outside_frustum += all;
      continue;
    }
    if (skip.back_facing && one_sided && tiles.known() && faces_away(node)) {
      counts.back_facing += all;
      continue;
    }
    const Resolution needed = resolution(here.node);
    here.cells = needed.cells;
    here.split = needed.split();
    if (here.split != Split::none) {
      here.first_part = static_cast<std::uint32_t>(visited_.size());
      const std::uint32_t first = tiles.parts(here.node, here.split);
      for (std::uint32_t k = 0; k < part_count(here.split); ++k)
        visited_.push_back({first + k, 0, Split::none, false, here.planes, {}});
    } else {
      here.needed = true;
      const Proven& proven = needed.proven;
      if ((current_.bounds_chord && !proven.chord) || (current_.bounds_frame && !proven.frame))
        ++counts.unbounded;
      counts.below_error += all - 1;
    }
    visited_[i] = here;
  }
}

// A patch for each tile that is needed.
void ScenePlanner::Planner::add_patches(std::uint32_t index) {
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    const Visited& tile = visited_[i];
    if (!tile.needed) continue;
    const TilePlace& at = (*current_.tiles)[tile.node].place;
    ScenePatch patch;
    patch.surface = scene_.instances[index].surface;
    patch.level_u = at.level_u;
    patch.level_v = at.level_v;
    patch.cells_u = static_cast<std::uint16_t>(1u << tile.cells.u);
    patch.cells_v = static_cast<std::uint16_t>(1u << tile.cells.v);
    patch.column = at.column;
    patch.row = at.row;
    patch.attributes = current_.asked;
    patch.first_edge_coordinate = static_cast<std::uint32_t>(edge_coordinates_.size());
    if (visited_.size() > 1) find_edges(tile, patch);
    add(index, known(patch));
  }
}

// Tiles that are not seen count like the others: what a tile's triangles are does not depend on what is
// culled.
void ScenePlanner::Planner::find_edges(const Visited& tile, ScenePatch& patch) {
  SurfaceTiles& tiles = *current_.tiles;
  const auto search = [&](const EdgeSearch& edge) {
    const auto unseen = [&](const auto& self, std::uint32_t node) -> void {
      const Extent extent(tiles[node].place);
      const Resolution r = resolution(node);
      if (r.split() == Split::none) return edge.take(extent, r.cells, found_);
      const std::uint32_t first = tiles.parts(node, r.split());
      edge.for_parts(extent, r.split(), [&](std::uint32_t k) { self(self, first + k); });
    };
    const auto seen = [&](const auto& self, std::uint32_t visited) -> void {
      const Visited& v = visited_[visited];
      if (v.split != Split::none)
        edge.for_parts(Extent(tiles[v.node].place), v.split,
                       [&](std::uint32_t k) { self(self, v.first_part + k); });
      else if (v.needed)
        edge.take(Extent(tiles[v.node].place), v.cells, found_);
      else
        unseen(unseen, v.node);
    };
    seen(seen, 0);
  };
  const Extent e(tiles[tile.node].place);
  const SurfaceInfo& info = tiles.surface().info();
  const auto round = [](Coordinate c) { return c == Coordinate::turn || c == Coordinate::twisted_turn; };
  const std::uint32_t step_u = (e.u1 - e.u0) >> tile.cells.u, step_v = (e.v1 - e.v0) >> tile.cells.v;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool along_u = k < 2, upper = k % 2 == 1;
    // No tile is finer than the finest.
    if (along_u ? tiles[tile.node].place.level_u + tile.cells.u >= current_.finest.u
                : tiles[tile.node].place.level_v + tile.cells.v >= current_.finest.v)
      continue;
    std::uint32_t line = along_u ? (upper ? e.v1 : e.v0) : (upper ? e.u1 : e.u0);
    std::uint32_t from = along_u ? e.u0 : e.v0, to = along_u ? e.u1 : e.v1;
    bool mirrored = false;
    found_.clear();
    if (line == (upper ? chart_size : 0)) {  // across the seam
      const Coordinate across = along_u ? info.v : info.u;
      if (!round(across)) continue;
      line = chart_size - line;
      if (across == Coordinate::twisted_turn) {
        mirrored = true;
        from = chart_size - std::exchange(to, chart_size - from);
      }
    }
    search({along_u, !upper, line, from, to, along_u ? step_u : step_v, mirrored});
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    patch.edge_counts[k] = static_cast<std::uint32_t>(found_.size());
    for (const std::uint32_t x : found_) edge_coordinates_.push_back(double(x) * share_of(finest_level));
  }
}

// The patch, whose further samples are the last there are; or the same one if it is known already.
std::uint32_t ScenePlanner::Planner::known(ScenePatch patch) {
  const auto coordinates = [&](const ScenePatch& p) {
    return std::span<const double>(edge_coordinates_).subspan(p.first_edge_coordinate, edge_samples(p));
  };
  const auto fresh = static_cast<std::uint32_t>(patches_.size());
  std::uint32_t found = fresh;
  if (request_.skip.duplicates) {
    std::uint64_t h = 0;
    const auto mix = [&](std::uint64_t x) {
      h = (h ^ x) * 0x9E3779B97F4A7C15u;
      h ^= h >> 32;
    };
    mix(std::uint64_t{patch.surface} << 32 | patch.column);
    mix(std::uint64_t{patch.row} << 32 | std::uint64_t{patch.level_u} << 24 |
        std::uint64_t{patch.level_v} << 16 | patch.cells_u);
    mix(std::uint64_t{patch.cells_v} << 32 | edge_samples(patch));
    for (const double x : coordinates(patch)) mix(std::bit_cast<std::uint64_t>(x));
    const auto hash = static_cast<std::uint32_t>(h >> 32);
    by_hash_.any_of(hash, [&](std::uint32_t i) {
      const ScenePatch& p = patches_[i].patch;
      const bool same = p.surface == patch.surface && p.level_u == patch.level_u &&
                        p.level_v == patch.level_v && p.cells_u == patch.cells_u &&
                        p.cells_v == patch.cells_v && p.column == patch.column && p.row == patch.row &&
                        p.attributes == patch.attributes && p.edge_counts == patch.edge_counts &&
                        std::ranges::equal(coordinates(p), coordinates(patch));
      if (same) found = i;
      return same;
    });
    if (found == fresh)
      by_hash_.insert(hash, fresh);
    else
      edge_coordinates_.resize(patch.first_edge_coordinate);
  }
  if (found == fresh) {
    patch.id = forgotten_ + fresh;
    patches_.push_back({patch, static_cast<std::uint32_t>(sample_count(patch, edge_coordinates_))});
  }
  return found;
}

// A tile of an instance, by its patch.
void ScenePlanner::Planner::add(std::uint32_t instance, std::uint32_t id) {
  KnownPatch& known = patches_[id];
  if (known.plan != plans_) {
    known.plan = plans_;
    known.index = static_cast<std::uint32_t>(plan_.patches.size());
    plan_.patches.push_back(known.patch);
    const auto first = edge_coordinates_.begin() + known.patch.first_edge_coordinate;
    plan_.patches.back().first_edge_coordinate = static_cast<std::uint32_t>(plan_.edge_coordinates.size());
    plan_.edge_coordinates.insert(plan_.edge_coordinates.end(), first, first + edge_samples(known.patch));
    plan_.samples_needed += known.samples;
    samples_by_attributes_[known.patch.attributes == request_.attributes] += known.samples;
  } else {
    ++plan_.skipped.duplicates;
  }
  constexpr std::size_t most = std::size_t{1} << 24;
  if (plan_.tiles.size() == most || plan_.edge_coordinates.size() > 4 * most)
    throw ParameterError("scene", "expected bounds that at most " + std::to_string(most) +
                                      " tiles keep, got smaller ones: ask for a larger chord or angle");
  ++plan_.patches[known.index].tile_count;
  plan_.tiles.push_back({instance, known.index});
  used_.push_back(id);
}

void ScenePlanner::Planner::begin(const Camera& camera) {
  camera.check();
  view_ = View(camera);
  const bool by_distance = view_.perspective() && std::isfinite(request_.chord_px);
  chord_per_distance_ = by_distance ? view_.length_of(request_.chord_px, 1) : 0;
  chord_ = by_distance ? request_.chord : std::fmin(request_.chord, view_.length_of(request_.chord_px, 1));
  // Patches that no plan needs any more are forgotten, all at once.
  const bool many = patches_.size() > (std::size_t{1} << 16) + 4 * used_.size();
  if (many) {
    forgotten_ += patches_.size();
    patches_.clear();
    edge_coordinates_.clear();
    by_hash_ = {};
  }
  if (std::exchange(unfinished_, true) || !way_.goes_on(camera) || many) decisions_.clear();
  if (keeps_) decisions_.resize(scene_.instances.size());
  std::swap(used_, last_used_);
  used_.clear();
  plan_ = {};
  samples_by_attributes_ = {};
  ++plans_;
}

ScenePlan ScenePlanner::Planner::plan(const Camera& camera) {
  begin(camera);
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) plan_instance(i);
  finish();
  return std::move(plan_);
}

// Sums, and tiles by patch.
void ScenePlanner::Planner::finish() {
  unfinished_ = false;
  plan_.tiles_needed = plan_.patches.size();
  for (std::size_t a = 0; a < attribute_count; ++a)
    for (const bool all : {false, true})
      if ((all ? request_.attributes : without_tangents_).has(static_cast<Attribute>(a)))
        plan_.attribute_samples[a] += samples_by_attributes_[all];
  std::uint32_t next = 0;
  for (ScenePatch& patch : plan_.patches) {
    patch.first_tile = next;
    next += patch.tile_count;
  }
  if (plan_.tiles.size() == plan_.patches.size()) return;
  std::vector<PlannedTile> sorted(plan_.tiles.size());
  std::vector<std::uint32_t> place(plan_.patches.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = plan_.patches[i].first_tile;
  for (const PlannedTile& tile : plan_.tiles) sorted[place[tile.patch]++] = tile;
  plan_.tiles = std::move(sorted);
}

ScenePlanner::ScenePlanner(const Scene& scene, const SceneRequest& request)
    : planner_(std::make_unique<Planner>(scene, request, true)) {}
ScenePlanner::ScenePlanner(ScenePlanner&&) noexcept = default;
ScenePlanner& ScenePlanner::operator=(ScenePlanner&&) noexcept = default;
ScenePlanner::~ScenePlanner() = default;

ScenePlan ScenePlanner::plan(const Camera& camera) {
  return planner_->plan(camera);
}

ScenePlan ScenePlanner::plan_once(const Scene& scene, const Camera& camera, const SceneRequest& request) {
  return Planner(scene, request, false).plan(camera);
}

ScenePlan plan_scene(const Scene& scene, const Camera& camera, const SceneRequest& request) {
  return ScenePlanner::plan_once(scene, camera, request);
}

}  // namespace darboux
