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

#include "known_patches.h"
#include "mesh_parts.h"
#include "occlusion.h"
#include "patch_layout.h"
#include "surface_tiles.h"
#include "tile_edges.h"
#include "tile_tests.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint8_t all_planes = 63;  // of the frustum

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
  const TileLevels deepest{std::max(finest.u - tile_level_u, 0), std::max(finest.v - tile_level_v, 0)};
  return std::uint64_t{1} << (deepest.u - place.level_u + deepest.v - place.level_v);
}

// What is skipped of one instance, but for duplicates, and what of it has no bounds.
struct Counts {
  std::uint32_t outside_frustum = 0, back_facing = 0, below_error = 0, unbounded = 0;
};

// An answer about a tile, and how far a camera's way may go until it is another.
struct Answer {
  enum class To : std::uint8_t { outside, faces_away, resolution };
  double limit;
  std::uint32_t node;
  To to;
  std::uint8_t planes;  // that were asked about
  std::uint16_t value;
};

// What holds an instance, for what it hides and what hides it.
struct Around {
  Occlusion::Ball ball;
  double largest = 0;  // by what it is scaled, at most
};

// What was decided for an instance: its tiles, and by which answers.
struct Decision {
  InstanceView whole;
  Around around;  // whatever the camera
  Counts counts;
  bool reads_nothing = false;
  std::size_t first_patch = 0, first_answer = 0;
  std::uint32_t patch_count = 0, answer_count = 0;
  // All answers stay the same while moved <= moving and moved + reach · turned <= turning, of the camera's
  // way.
  double reach = 0, moving = -infinity, turning = -infinity;
};

// The patches of an instance that is in view: known ones, as they are used by this plan.
struct Shown {
  std::uint32_t instance, first_patch, patch_count;
};

// How far a camera has moved and turned, all in all: the length of its way, and that of its axes' way as a
// matrix: a turn by the angle a moves no unit vector by more than 2 sin(a/2), and the matrix by √2 times
// that. Each step adds more than is rounded, so that none is lost in a long way.
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
    if (!same) {
      moved = turned = 0;
    } else if (next.pose.matrix() != last_->pose.matrix()) {
      constexpr double up = 1 + 0x1p-50;
      moved = (moved + (next.pose.translation() - last_->pose.translation()).norm() * (1 + 0x1p-48)) * up;
      // Poses are rigid to 1e-5.
      turned = (turned + (next.pose.linear() - last_->pose.linear()).norm() * (1 + 0x1p-15)) * up;
    }
    last_ = next;
    return same;
  }

 private:
  std::optional<Camera> last_;
};

// As many tiles as a plan has at most, before any are hidden: what is refused is so before the work.
constexpr std::size_t most_tiles = std::size_t{1} << 24;

void refuse_small_bounds() {
  throw ParameterError("scene", "expected bounds that at most " + std::to_string(most_tiles) +
                                    " tiles keep, got smaller ones: ask for a larger chord or angle");
}

}  // namespace

class ScenePlanner::Planner {
 public:
  // \param keeps decisions from one camera to the next
  Planner(const Scene& scene, const SceneRequest& request, bool keeps);
  ScenePlan plan(const Camera& camera);

 private:
  void begin(const Camera& camera);
  SurfaceTiles& tiles_of(std::uint32_t instance);
  void plan_instance(std::uint32_t instance);
  bool holds(const Decision& d) const {
    return way_.moved <= d.moving && way_.moved + d.reach * way_.turned <= d.turning;
  }
  bool still_right(Decision& decision);
  void decide(std::uint32_t instance, Decision& decision);
  void prefetch(std::uint32_t instance) const;
  void drop_old_answers();
  void count(const Decision& decision);

  // How far the camera's way may go.
  double limit(double slack, bool turning) const;
  bool counts_turning(Answer::To to) const { return to != Answer::To::faces_away || !tests_.perspective(); }
  std::uint16_t value(Answer::To to, std::uint32_t node, std::uint8_t planes);
  Answer answer(Answer::To to, std::uint32_t node, std::uint8_t planes);
  // Asks about a tile, and keeps the answer.
  std::uint16_t ask(Answer::To to, std::uint32_t node, std::uint8_t planes = 0);
  Resolution resolution(std::uint32_t node);

  void visit_tiles(Counts& counts);
  void expect_room(std::size_t more) const;
  void add_patches(std::uint32_t instance);
  TileLevels finest_of_visited();
  void find_edges(const Visited& tile, const TileLevels& finest, ScenePatch& patch);
  void hide();
  void plan_meshes();
  void plan_part(std::uint32_t instance, std::uint32_t part, std::vector<bool>& known);
  void cover();
  void hide_tiles(const Shown& shown);
  void add(std::uint32_t instance, std::uint32_t known);
  void finish();

  const Scene& scene_;
  SceneRequest request_;
  bool keeps_;
  std::vector<std::unique_ptr<SurfaceTiles>> tiles_;
  TileTests tests_{scene_, request_, keeps_};
  std::vector<Visited> visited_;      // of the current instance
  std::vector<std::uint32_t> found_;  // samples on an edge

  CameraWay way_;
  double reach_ = 0;  // of the current decision
  Slack slack_of_whole_;
  std::vector<Decision> decisions_;  // of all instances
  std::vector<Answer> answers_;      // of these
  std::size_t answers_dropped_ = 0;
  std::vector<std::uint32_t> used_, last_used_;  // known patches by instance, of this plan and the last
  std::vector<Shown> shown_;
  std::vector<Around> around_;      // of these, where what is hidden is asked for
  std::vector<bool> hidden_;        // of used_
  std::vector<PlannedTile> drawn_;  // by instances
  Occlusion occlusion_{Camera()};
  KnownPatches patches_{request_.skip.duplicates};
  std::uint32_t plans_ = 0;
  std::array<std::uint64_t, 2> samples_by_attributes_{};  // without tangents, and all that was asked for
  bool unfinished_ = false;                               // the last plan, that an error ended
  ScenePlan plan_;
};

ScenePlanner::Planner::Planner(const Scene& scene, const SceneRequest& request, bool keeps)
    : scene_(scene), request_(request), keeps_(keeps), tiles_(scene.surfaces.size()) {
  check(scene, request);
}

SurfaceTiles& ScenePlanner::Planner::tiles_of(std::uint32_t index) {
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
        tests_.bounds_frames(request_.attributes) ? TileOrder::second : TileOrder::position);
  return *kept;
}

// What was decided for an earlier camera, as long as that holds; else anew.
void ScenePlanner::Planner::plan_instance(std::uint32_t index) {
  Decision once;
  Decision& decision = keeps_ ? decisions_[index] : once;
  const std::size_t first = used_.size();
  const bool kept = keeps_ && holds(decision);
  if (!kept) {
    tests_.begin(index, tiles_of(index));
    slack_of_whole_ = tests_.slack;
  }
  if (kept || (keeps_ && still_right(decision))) {
    expect_room(decision.patch_count);
    const auto known = last_used_.begin() + static_cast<std::ptrdiff_t>(decision.first_patch);
    used_.insert(used_.end(), known, known + decision.patch_count);
  } else {
    decide(index, decision);
    decision.patch_count = static_cast<std::uint32_t>(used_.size() - first);
  }
  decision.first_patch = first;
  count(decision);
  if (decision.patch_count == 0) return;
  shown_.push_back({index, static_cast<std::uint32_t>(first), decision.patch_count});
  if (request_.skip.occluded) around_.push_back(decision.around);
}

// Asks again what may have another answer by now. Whether none has.
bool ScenePlanner::Planner::still_right(Decision& d) {
  if (d.reach == 0 || !(tests_.whole() == d.whole) || !(tests_.placed().farthest < d.reach)) return false;
  reach_ = d.reach;
  d.moving = limit(slack_of_whole_.moving, false);
  d.turning = limit(slack_of_whole_.turning, true);
  for (Answer& known : std::span(answers_).subspan(d.first_answer, d.answer_count)) {
    const bool turning = counts_turning(known.to);
    if (!(way_.moved + (turning ? reach_ * way_.turned : 0) <= known.limit)) {
      const Answer now = answer(known.to, known.node, known.planes);
      if (now.value != known.value) return false;
      known = now;
    }
    double& least = turning ? d.turning : d.moving;
    least = std::min(least, known.limit);
  }
  return true;
}

void ScenePlanner::Planner::decide(std::uint32_t index, Decision& d) {
  const std::size_t first = d.first_answer, place_for = d.answer_count;
  d = {};
  d.whole = tests_.whole();
  d.around = {{tests_.placed().centre, (1 + 0x1p-40) * tests_.placed().largest * tests_.tiles().radius() +
                                           tests_.placed().displacement},
              tests_.placed().largest};
  d.reach = reach_ = 1.25 * tests_.placed().farthest;
  d.moving = limit(slack_of_whole_.moving, false);
  d.turning = limit(slack_of_whole_.turning, true);
  if (tests_.asked().empty()) {
    d.reads_nothing = true;
  } else if (d.whole.outside) {
    d.counts.outside_frustum = static_cast<std::uint32_t>(tiles_within({}, d.whole.finest));
  } else {
    d.first_answer = answers_.size();
    visit_tiles(d.counts);
    add_patches(index);
    d.answer_count = static_cast<std::uint32_t>(answers_.size() - d.first_answer);
    for (const Answer& a : std::span(answers_).subspan(d.first_answer)) {
      double& least = counts_turning(a.to) ? d.turning : d.moving;
      least = std::min(least, a.limit);
    }
  }
  // In the place of the old ones, if there is enough.
  if (d.answer_count > 0 && d.answer_count <= place_for) {
    std::copy(answers_.begin() + static_cast<std::ptrdiff_t>(d.first_answer), answers_.end(),
              answers_.begin() + static_cast<std::ptrdiff_t>(first));
    answers_.resize(d.first_answer);
    d.first_answer = first;
    answers_dropped_ += place_for - d.answer_count;
  } else {
    answers_dropped_ += place_for;
  }
}

void ScenePlanner::Planner::prefetch(std::uint32_t index) const {
  const auto fetch = [](const void* first, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; i += 64) __builtin_prefetch(static_cast<const char*>(first) + i);
  };
  const Decision& d = decisions_[index];
  fetch(&scene_.instances[index], sizeof(SceneInstance));
  fetch(answers_.data() + d.first_answer, d.answer_count * sizeof(Answer));
}

void ScenePlanner::Planner::drop_old_answers() {
  if (2 * answers_dropped_ <= answers_.size()) return;
  std::vector<Answer> kept;
  kept.reserve(answers_.size() - answers_dropped_);
  for (Decision& d : decisions_) {
    const auto of_it = std::span(answers_).subspan(d.first_answer, d.answer_count);
    d.first_answer = kept.size();
    kept.insert(kept.end(), of_it.begin(), of_it.end());
  }
  answers_ = std::move(kept);
  answers_dropped_ = 0;
}

void ScenePlanner::Planner::count(const Decision& d) {
  const std::uint64_t all = tiles_within({}, d.whole.finest);
  plan_.tiles_all += all;
  plan_.samples_full +=
      ((std::uint64_t{1} << d.whole.uniform.u) + 1) * ((std::uint64_t{1} << d.whole.uniform.v) + 1);
  if (d.reads_nothing) plan_.skipped.no_normal_map += all;
  plan_.skipped.outside_frustum += d.counts.outside_frustum;
  plan_.skipped.back_facing += d.counts.back_facing;
  plan_.skipped.below_error += d.counts.below_error;
  plan_.tiles_unbounded += d.counts.unbounded;
}

double ScenePlanner::Planner::limit(double slack, bool turning) const {
  if (!keeps_) return 0;
  const double way = way_.moved + (turning ? reach_ * way_.turned : 0),
               certain = slack - tests_.rounding() - 0x1p-40 * way;
  return way + std::min(std::max(certain, 0.0), std::max(reach_ - tests_.placed().farthest, 0.0));
}

std::uint16_t ScenePlanner::Planner::value(Answer::To to, std::uint32_t node, std::uint8_t planes) {
  if (to == Answer::To::outside) {
    const bool outside = tests_.outside(node, planes);
    return static_cast<std::uint16_t>(outside ? all_planes + 1 : planes);
  }
  if (to == Answer::To::faces_away) return tests_.faces_away(node);
  const Resolution r = tests_.resolution(node);
  return static_cast<std::uint16_t>(r.cells.u | r.cells.v << 4 | r.proven.chord << 8 | r.proven.frame << 9);
}

Answer ScenePlanner::Planner::answer(Answer::To to, std::uint32_t node, std::uint8_t planes) {
  tests_.slack = {};
  const std::uint16_t x = value(to, node, planes);
  const bool turning = counts_turning(to);
  return {limit(turning ? tests_.slack.turning : tests_.slack.moving, turning), node, to, planes, x};
}

std::uint16_t ScenePlanner::Planner::ask(Answer::To to, std::uint32_t node, std::uint8_t planes) {
  if (!keeps_) return value(to, node, planes);
  answers_.push_back(answer(to, node, planes));
  return answers_.back().value;
}

Resolution ScenePlanner::Planner::resolution(std::uint32_t node) {
  if (!keeps_) return tests_.resolution(node);
  const int x = ask(Answer::To::resolution, node);
  return {{x & 15, x >> 4 & 15}, {(x >> 8 & 1) != 0, (x >> 9 & 1) != 0}};
}

// The tiles that the current instance needs, of the coarsest resolution that is enough, and those above them.
void ScenePlanner::Planner::visit_tiles(Counts& counts) {
  SurfaceTiles& tiles = tests_.tiles();
  visited_.clear();
  visited_.push_back({.node = SurfaceTiles::root, .planes = tests_.whole().planes});
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    Visited here = visited_[i];
    const auto all = static_cast<std::uint32_t>(tiles_within(tiles[here.node].place, tests_.whole().finest));
    if (here.planes != 0) {
      const std::uint16_t left = ask(Answer::To::outside, here.node, here.planes);
      if (left > all_planes) {
        counts.outside_frustum += all;
        continue;
      }
      here.planes = static_cast<std::uint8_t>(left);
    }
    if (tests_.may_face_away() && ask(Answer::To::faces_away, here.node) != 0) {
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
        visited_.push_back({.node = first + k, .planes = here.planes});
    } else {
      here.needed = here.has_cells = true;
      counts.unbounded += !tests_.bounds(needed.proven);
      counts.below_error += all - 1;
    }
    visited_[i] = here;
  }
}

void ScenePlanner::Planner::expect_room(std::size_t more) const {
  if (more > most_tiles - used_.size()) refuse_small_bounds();
}

// A patch for each tile that is needed.
void ScenePlanner::Planner::add_patches(std::uint32_t index) {
  const std::uint32_t surface = scene_.instances[index].surface;
  const bool all = tests_.asked() == request_.attributes;
  const TileLevels finest = finest_of_visited();
  for (const Visited& tile : visited_) {
    if (!tile.needed) continue;
    expect_room(1);
    ScenePatch patch;
    patches_.begin(patch);
    if (visited_.size() > 1) find_edges(tile, finest, patch);
    std::uint32_t* known = nullptr;
    if (request_.skip.duplicates && patch.plain()) {
      known = &patches_.plain(surface, tile.node, tile.cells, all);
      if (*known != KnownPatches::none) {
        used_.push_back(*known);
        continue;
      }
    }
    const TilePlace& at = tests_.tiles()[tile.node].place;
    patch.surface = surface;
    patch.level_u = at.level_u;
    patch.level_v = at.level_v;
    patch.cells_u = static_cast<std::uint16_t>(1u << tile.cells.u);
    patch.cells_v = static_cast<std::uint16_t>(1u << tile.cells.v);
    patch.column = at.column;
    patch.row = at.row;
    patch.attributes = tests_.asked();
    used_.push_back(patches_.add(patch, tile.node));
    if (known != nullptr) *known = used_.back();
  }
}

// The finest cells of all tiles of the instance, or finer, in powers of two of the chart.
TileLevels ScenePlanner::Planner::finest_of_visited() {
  TileLevels finest;
  if (visited_.size() == 1) return finest;
  const TileLevels& most = tests_.whole().finest;
  const auto take = [&](const Visited& tile) {
    const TilePlace& at = tests_.tiles()[tile.node].place;
    finest = {std::max(finest.u, at.level_u + tile.cells.u), std::max(finest.v, at.level_v + tile.cells.v)};
  };
  for (const Visited& tile : visited_)
    if (tile.needed) take(tile);
  for (Visited& tile : visited_) {
    if (finest == most) break;
    if (tile.needed || tile.split != Split::none) continue;
    // One that is not seen.
    const Resolution r = resolution(tile.node);
    if (r.split() != Split::none) return most;
    tile.cells = r.cells;
    tile.has_cells = true;
    take(tile);
  }
  return finest;
}

// Tiles that are not seen count like the others: what a tile's triangles are does not depend on what is
// culled.
void ScenePlanner::Planner::find_edges(const Visited& tile, const TileLevels& finest, ScenePatch& patch) {
  SurfaceTiles& tiles = tests_.tiles();
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
      else if (v.has_cells)
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
    if (along_u ? tiles[tile.node].place.level_u + tile.cells.u >= finest.u
                : tiles[tile.node].place.level_v + tile.cells.v >= finest.v)
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
    for (const std::uint32_t x : found_) patches_.add_edge_coordinate(double(x) / chart_size);
  }
}

// What lies behind the largest of those in view, as seen.
void ScenePlanner::Planner::hide() {
  cover();
  occlusion_.finish();
  if (occlusion_.empty()) return;
  // Of smaller ones, tiles one by one are not worth it.
  constexpr double large = 4;
  for (std::size_t k = 0; k < shown_.size(); ++k) {
    const Shown& shown = shown_[k];
    const Occlusion::Ball& ball = around_[k].ball;
    if (!tiles_[scene_.instances[shown.instance].surface]->known()) continue;
    if (occlusion_.hides(ball)) {
      for (std::size_t i = 0; i < shown.patch_count; ++i) hidden_[shown.first_patch + i] = true;
      plan_.skipped.occluded += shown.patch_count;
    } else if (shown.patch_count > 1 && occlusion_.size_of(ball) > large && occlusion_.may_hide_of(ball)) {
      hide_tiles(shown);
    }
  }
}

void ScenePlanner::Planner::cover() {
  // Smaller ones hide little. In cells of the view, of which there are 128 in a row.
  constexpr double smallest = 5;
  constexpr std::size_t most = 16;
  struct Candidate {
    double size;
    std::uint32_t shown;
    bool operator<(const Candidate& other) const {
      return size != other.size ? size > other.size : shown < other.shown;
    }
  };
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < shown_.size(); ++i) {
    const double size = occlusion_.size_of(around_[i].ball);
    if (!(size >= smallest)) continue;
    const SceneInstance& instance = scene_.instances[shown_[i].instance];
    const SceneMaterial& material = scene_.materials[instance.material];
    if (!material.see_through && material.displacement == 0 &&
        Occlusion::can_hide(*tiles_[instance.surface], instance.placement))
      candidates.push_back({size, i});
  }
  const std::size_t count = std::min(most, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
                    candidates.end());
  candidates.resize(count);
  std::vector<Occlusion::Drawn> drawn;
  for (const Candidate& candidate : candidates) {
    const Shown& shown = shown_[candidate.shown];
    const auto& [ball, largest] = around_[candidate.shown];
    if (occlusion_.hides(ball)) continue;
    const SceneInstance& instance = scene_.instances[shown.instance];
    drawn.clear();
    for (std::size_t i = 0; i < shown.patch_count; ++i) {
      const ScenePatch& p = patches_[used_[shown.first_patch + i]].patch;
      drawn.push_back({{p.level_u, p.level_v, p.column, p.row},
                       {std::countr_zero(p.cells_u), std::countr_zero(p.cells_v)}});
    }
    occlusion_.add({instance, *tiles_[instance.surface], scene_.materials[instance.material].double_sided,
                    ball, largest, drawn});
  }
}

void ScenePlanner::Planner::hide_tiles(const Shown& shown) {
  const SceneInstance& instance = scene_.instances[shown.instance];
  if (scene_.materials[instance.material].displacement > 0) return;
  const Occlusion::OfCamera of_camera(occlusion_, instance.placement);
  for (std::size_t k = shown.first_patch; k < shown.first_patch + shown.patch_count; ++k) {
    const TileNode& node = (*tiles_[instance.surface])[patches_[used_[k]].node];
    if (!occlusion_.hides(of_camera, node.lo, node.hi)) continue;
    hidden_[k] = true;
    ++plan_.skipped.occluded;
  }
}

// A tile of an instance, by its patch.
void ScenePlanner::Planner::add(std::uint32_t instance, std::uint32_t id) {
  KnownPatch& known = patches_[id];
  if (known.plan != plans_) {
    known.plan = plans_;
    known.index = static_cast<std::uint32_t>(plan_.patches.size());
    plan_.patches.push_back(known.patch);
    const std::span<const double> edges = patches_.edge_coordinates(known.patch);
    plan_.patches.back().first_edge_coordinate = static_cast<std::uint32_t>(plan_.edge_coordinates.size());
    plan_.edge_coordinates.insert(plan_.edge_coordinates.end(), edges.begin(), edges.end());
    plan_.samples_needed += known.samples;
    samples_by_attributes_[known.patch.attributes == request_.attributes] += known.samples;
  } else {
    ++plan_.skipped.duplicates;
  }
  if (plan_.edge_coordinates.size() > 4 * most_tiles) refuse_small_bounds();
  ++plan_.patches[known.index].tile_count;
  drawn_.push_back({instance, known.index});
}

void ScenePlanner::Planner::begin(const Camera& camera) {
  camera.check();
  tests_.look(camera);
  const bool failed = std::exchange(unfinished_, true), goes_on = way_.goes_on(camera);
  // Patches that no plan needs any more are forgotten, all at once.
  const bool many = patches_.size() > (std::size_t{1} << 16) + 4 * used_.size();
  if (many) patches_.forget();
  if (failed || !goes_on || many) {
    decisions_.clear();
    answers_.clear();
    answers_dropped_ = 0;
  }
  if (keeps_) {
    drop_old_answers();
    decisions_.resize(scene_.instances.size());
  }
  std::swap(used_, last_used_);
  used_.clear();
  shown_.clear();
  around_.clear();
  drawn_.clear();
  plan_ = {};
  samples_by_attributes_ = {};
  ++plans_;
}

ScenePlan ScenePlanner::Planner::plan(const Camera& camera) {
  begin(camera);
  const auto count = static_cast<std::uint32_t>(scene_.instances.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    // Instances that are asked about anew lie anywhere: they are fetched before.
    constexpr std::uint32_t soon = 8;
    if (keeps_ && i + soon < count && !holds(decisions_[i + soon])) prefetch(i + soon);
    plan_instance(i);
  }
  hidden_.assign(used_.size(), false);
  occlusion_ = Occlusion(camera);
  if (request_.skip.occluded) hide();
  drawn_.reserve(used_.size());
  for (const Shown& shown : shown_) {
    bool needed = false;
    for (std::size_t i = 0; i < shown.patch_count; ++i)
      if (const std::size_t k = shown.first_patch + i; !hidden_[k]) {
        needed = true;
        add(shown.instance, used_[k]);
      }
    plan_.instances_needed += needed;
  }
  finish();
  plan_meshes();
  return std::move(plan_);
}

// Parts of meshes, each as one tile: nothing of them is evaluated.
void ScenePlanner::Planner::plan_meshes() {
  // Which parts an instance before needs already.
  std::vector<std::vector<bool>> known(scene_.meshes.size());
  for (std::uint32_t i = 0; i < scene_.mesh_instances.size(); ++i) {
    const SceneMeshInstance& instance = scene_.mesh_instances[i];
    const auto refuse = [&](const char* expected, const std::string& got) {
      throw ParameterError("mesh instance " + std::to_string(i),
                           std::string("expected ") + expected + ", got " + got);
    };
    if (instance.mesh >= scene_.meshes.size()) refuse("a mesh of the scene", std::to_string(instance.mesh));
    if (!instance.placement.matrix().allFinite()) refuse("a placement that is finite", "another");
    const std::vector<SceneMeshPart>& parts = scene_.meshes[instance.mesh].parts;
    known[instance.mesh].resize(parts.size());
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
      if (parts[k].material >= scene_.materials.size())
        refuse("materials of the scene", std::to_string(parts[k].material));
      plan_part(i, k, known[instance.mesh]);
    }
  }
}

void ScenePlanner::Planner::plan_part(std::uint32_t index, std::uint32_t number, std::vector<bool>& known) {
  const SceneMeshInstance& instance = scene_.mesh_instances[index];
  const SceneMeshPart& part = scene_.meshes[instance.mesh].parts[number];
  const SceneMaterial& material = scene_.materials[part.material];
  const SceneRequest::Skip& skip = request_.skip;
  const bool bounded = !part.moves && !instance.moves;
  ++plan_.tiles_all;
  plan_.samples_full += part.vertices;
  const bool all = !skip.unread_attributes || material.reads_tangents();
  if (!all && tests_.without_tangents().empty()) {
    ++plan_.skipped.no_normal_map;
    return;
  }
  if (skip.outside_frustum && bounded &&
      is_outside(part, instance.placement, material.displacement, tests_.view())) {
    ++plan_.skipped.outside_frustum;
    return;
  }
  if (skip.back_facing && bounded && !material.double_sided && material.displacement == 0 &&
      faces_away(part, instance.placement, tests_.view())) {
    ++plan_.skipped.back_facing;
    return;
  }
  if (skip.occluded && bounded && material.displacement == 0 && !occlusion_.empty() && !part.box.isEmpty() &&
      occlusion_.hides({occlusion_, instance.placement}, from_eigen(part.box.min()),
                       from_eigen(part.box.max()))) {
    ++plan_.skipped.occluded;
    return;
  }
  ++plan_.instances_needed;
  plan_.tiles_unbounded += !bounded;
  plan_.parts.push_back({index, number});
  if (skip.duplicates && known[number]) {
    ++plan_.skipped.duplicates;
    return;
  }
  known[number] = true;
  ++plan_.tiles_needed;
  plan_.samples_needed += part.vertices;
  for (std::size_t a = 0; a < attribute_count; ++a)
    if ((all ? request_.attributes : tests_.without_tangents()).has(static_cast<Attribute>(a)))
      plan_.attribute_samples[a] += part.vertices;
}

// Sums, and tiles by patch.
void ScenePlanner::Planner::finish() {
  unfinished_ = false;
  plan_.tiles_needed = plan_.patches.size();
  for (std::size_t a = 0; a < attribute_count; ++a)
    for (const bool all : {false, true})
      if ((all ? request_.attributes : tests_.without_tangents()).has(static_cast<Attribute>(a)))
        plan_.attribute_samples[a] += samples_by_attributes_[all];
  std::uint32_t next = 0;
  for (ScenePatch& patch : plan_.patches) {
    patch.first_tile = next;
    next += patch.tile_count;
  }
  plan_.tiles.resize(drawn_.size());
  std::vector<std::uint32_t> place(plan_.patches.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = plan_.patches[i].first_tile;
  for (const PlannedTile& tile : drawn_) plan_.tiles[place[tile.patch]++] = tile;
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
