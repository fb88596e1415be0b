#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <darboux/error.h>
#include <darboux/scene.h>

#include "hidden_tiles.h"
#include "kept_answers.h"
#include "known_patches.h"
#include "mesh_parts.h"
#include "occlusion.h"
#include "surface_tiles.h"
#include "tile_culling.h"
#include "visited_tiles.h"

namespace darboux {
namespace {

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

// The decision for an instance: its tiles.
struct Decision {
  InstanceView whole;
  TileCounts counts;
  bool reads_nothing = false;
  std::size_t first_patch = 0;
  std::uint32_t patch_count = 0;
};

// The maximum number of tiles of a plan, including hidden ones, so that a scene is refused before the work is
// done.
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
  void plan_instances();
  void plan_instance(std::uint32_t instance);
  void decide(std::uint32_t instance, Decision& decision);
  void add_patches(std::uint32_t instance);
  void expect_room(std::size_t more) const;
  void count(const Decision& decision);
  void add_tiles();
  void add(std::uint32_t instance, std::uint32_t known);
  void finish();

  const Scene& scene_;
  SceneRequest request_;
  bool keeps_;
  std::vector<std::unique_ptr<SurfaceTiles>> tiles_;
  TileCulling tests_{scene_, request_, keeps_};
  KeptAnswers answers_{tests_, keeps_};
  VisitedTiles visited_{tests_, answers_};  // of the current instance

  std::vector<Decision> decisions_;  // of all instances
  KnownPatches patches_{request_.skip.duplicates, request_.attributes};
  std::vector<std::uint32_t> used_, last_used_;  // known patches by instance, of this plan and the last
  std::vector<Shown> shown_;
  std::vector<Around> around_;  // of all instances in view, if occlusion is requested
  Occlusion occlusion_{Camera()};
  std::vector<bool> hidden_;        // of used_
  std::vector<PlannedTile> drawn_;  // by instances
  std::uint32_t plans_ = 0;
  std::array<std::uint64_t, 2> samples_by_attributes_{};  // without tangents, and with all requested
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

void ScenePlanner::Planner::begin(const Camera& camera) {
  camera.check();
  const bool goes_on = answers_.go_to(camera, scene_.instances.size()),
             failed = std::exchange(unfinished_, true);
  // Patches that no plan needs any more are removed, all at once.
  const bool many = patches_.size() > (std::size_t{1} << 16) + 4 * used_.size();
  if (many) patches_.forget();
  if (goes_on && (failed || many)) answers_.forget();
  if (keeps_) decisions_.resize(scene_.instances.size());
  if (request_.skip.occluded) around_.resize(scene_.instances.size());
  std::swap(used_, last_used_);
  used_.clear();
  shown_.clear();
  drawn_.clear();
  plan_ = {};
  samples_by_attributes_ = {};
  ++plans_;
}

void ScenePlanner::Planner::plan_instances() {
  const auto count = static_cast<std::uint32_t>(scene_.instances.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    // Instances whose answers are recomputed are scattered in memory, so they are prefetched.
    constexpr std::uint32_t soon = 8;
    if (keeps_ && i + soon < count && !answers_.hold(i + soon)) {
      prefetch(&scene_.instances[i + soon], sizeof(SceneInstance));
      answers_.prefetch(i + soon);
    }
    plan_instance(i);
  }
}

// The decision for an earlier camera as long as it is valid; else a new one.
void ScenePlanner::Planner::plan_instance(std::uint32_t index) {
  Decision once;
  Decision& decision = keeps_ ? decisions_[index] : once;
  const std::size_t first = used_.size();
  bool kept = keeps_ && answers_.hold(index);
  if (!kept) {
    answers_.begin(index, tiles_of(index));
    kept = keeps_ && tests_.whole() == decision.whole && answers_.still_hold();
  }
  if (kept) {
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
}

void ScenePlanner::Planner::decide(std::uint32_t index, Decision& d) {
  const Placed& placed = tests_.placed();
  d = {};
  d.whole = tests_.whole();
  if (request_.skip.occluded)
    around_[index] = {
        {placed.centre, (1 + 0x1p-40) * placed.largest * tests_.tiles().radius() + placed.displacement},
        placed.largest};
  answers_.start();
  if (tests_.asked().empty()) {
    d.reads_nothing = true;
  } else if (d.whole.outside) {
    d.counts.outside_frustum = static_cast<std::uint32_t>(tiles_within({}, d.whole.finest));
  } else {
    d.counts = visited_.visit();
    add_patches(index);
  }
  answers_.finish();
}

// Adds a patch for each needed tile.
void ScenePlanner::Planner::add_patches(std::uint32_t index) {
  const std::uint32_t surface = scene_.instances[index].surface;
  for (const VisitedTiles::Visited& tile : visited_.visited()) {
    if (!tile.needed) continue;
    expect_room(1);
    const VisitedTiles::Edges& edges = visited_.edges(tile);
    if (edges.coordinates.empty()) {
      const std::uint32_t known = patches_.find_plain(surface, tile.node, tile.cells, tests_.asked());
      if (known != KnownPatches::none) {
        used_.push_back(known);
        continue;
      }
    }
    const TilePlace& at = tests_.tiles()[tile.node].place;
    ScenePatch patch;
    patch.surface = surface;
    patch.level_u = at.level_u;
    patch.level_v = at.level_v;
    patch.cells_u = static_cast<std::uint16_t>(1u << tile.cells.u);
    patch.cells_v = static_cast<std::uint16_t>(1u << tile.cells.v);
    patch.column = at.column;
    patch.row = at.row;
    patch.attributes = tests_.asked();
    patch.edge_counts = edges.counts;
    used_.push_back(patches_.add(patch, edges.coordinates, tile.node));
  }
}

void ScenePlanner::Planner::expect_room(std::size_t more) const {
  if (more > most_tiles - used_.size()) refuse_small_bounds();
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

// Adds all needed tiles that are not hidden.
void ScenePlanner::Planner::add_tiles() {
  drawn_.reserve(used_.size());
  plan_.patches.reserve(std::min(used_.size(), patches_.size()));
  for (const Shown& shown : shown_) {
    bool needed = false;
    for (std::size_t i = 0; i < shown.patch_count; ++i)
      if (const std::size_t k = shown.first_patch + i; !hidden_[k]) {
        needed = true;
        add(shown.instance, used_[k]);
      }
    plan_.instances_needed += needed;
  }
}

// Adds a tile of an instance, with its patch.
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

// Computes the sums, and sorts tiles by patch.
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

ScenePlan ScenePlanner::Planner::plan(const Camera& camera) {
  begin(camera);
  plan_instances();
  hidden_.assign(used_.size(), false);
  occlusion_ = Occlusion(camera);
  if (request_.skip.occluded)
    plan_.skipped.occluded +=
        HiddenTiles(scene_, tiles_, patches_, used_, occlusion_).find(shown_, around_, hidden_);
  add_tiles();
  finish();
  plan_mesh_parts(scene_, request_, tests_, occlusion_, plan_);
  return std::move(plan_);
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
