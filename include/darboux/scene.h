/// \file scene.h
/// View-dependent evaluation of parametric surfaces. A plan lists the tiles of each instance that are needed,
/// their resolution and their attributes; the batch kernels then evaluate only these.
///   const ScenePlan plan = plan_scene(scene, camera, request);
///   for_each_tile(scene, plan, [&](const TileSamples& tile) { draw(tile); });
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/any_surface.h>
#include <darboux/scene_mesh.h>
#include <darboux/tile_bounds.h>

namespace darboux {

/// The properties of a material that affect planning.
struct SceneMaterial {
  std::string name;
  bool normal_map = false, clearcoat_normal_map = false;
  bool anisotropy = false;    ///< with a texture or without
  bool double_sided = false;  ///< both sides are seen
  bool see_through = false;   ///< transparent or with holes: it occludes nothing. (Meshes never occlude)
  /// Upper bound of a displacement, in the unit of length of the scene.
  double displacement = 0;

  /// Whether it reads more of the frame than the normal.
  bool reads_tangents() const { return normal_map || clearcoat_normal_map || anisotropy; }
};

/// An instance of a surface in a scene. Positions are transformed by the placement, normals by its inverse
/// transpose, so a mirrored instance shows the same side.
struct SceneInstance {
  std::uint32_t surface = 0, material = 0;  ///< indices into those of the scene
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
};

struct Scene {
  std::vector<AnySurface> surfaces;
  std::vector<SceneMaterial> materials;
  std::vector<SceneInstance> instances;
  /// Existing triangle meshes: planned by whole parts, and not evaluated.
  std::vector<SceneMesh> meshes{};
  std::vector<SceneMeshInstance> mesh_instances{};
};

/// A camera as in glTF: it looks along its -z axis, with y up.
struct Camera {
  enum class Projection : std::uint8_t { perspective, orthographic };

  Projection projection = Projection::perspective;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< camera to scene
  int width_px = 1280, height_px = 720;
  double vertical_field_of_view_rad = 1;            ///< of a perspective camera, the whole angle
  double view_height = 2;                           ///< of an orthographic camera, a length
  double near_distance = 0.1, far_distance = 1000;  ///< lengths along the view; far may be infinity

  /// At `eye`, looking at `target`. \throws ParameterError when they coincide, or `up` is parallel to the
  /// view
  static Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                                   const Eigen::Vector3d& up = {0, 0, 1});
  /// \throws ParameterError naming what is wrong: a pose that is not rigid or finite, sizes below one pixel,
  /// an angle that is not between 0 and pi, near >= far, near <= 0 of a perspective camera
  void check() const;
};

/// Interpolates between two cameras, t from 0 to 1: positions and lenses linearly, the rotation about a fixed
/// axis along the shorter arc. If one of the two has no far plane, neither has the result.
/// \throws ParameterError where projections or image sizes differ
Camera between(const Camera& from, const Camera& to, double t);

/// The requested attributes and accuracy. An infinite bound has no effect; the strictest bound decides.
struct SceneRequest {
  Attributes attributes = Attribute::position | Attribute::normal | Attribute::tangent4;
  /// The permitted distance between the surface and the triangles through the samples: in pixels of the
  /// camera, and in the unit of length of the scene.
  double chord_px = 0.5, chord = std::numeric_limits<double>::infinity();
  /// The permitted angle between t, b and n and those interpolated in a triangle and normalised.
  double frame_angle_rad = 0.0175;  ///< radians, about 1 degree
  /// What may be skipped. With everything off, each instance is evaluated uniformly, at the resolution that
  /// its nearest point requires.
  struct Skip {
    bool unread_attributes = true;  ///< tangents of materials that read none
    bool outside_frustum = true, back_facing = true, below_error = true, duplicates = true;
    /// Tiles that lie wholly behind opaque surfaces that are drawn. The test takes about 30 us for each of up
    /// to 16 instances that appear large, and 0.05 to 0.5 us for each instance in view.
    bool occluded = false;
    static constexpr Skip nothing() {
      return {.unread_attributes = false,
              .outside_frustum = false,
              .back_facing = false,
              .below_error = false,
              .duplicates = false,
              .occluded = false};
    }
  } skip;
};

/// The samples of one of 2^level_u × 2^level_v tiles of a chart: the corners of its cells_u × cells_v
/// cells, and on its edges also the samples of its neighbours. Coordinates are integer multiples of powers of
/// two, so neighbours have the same bits on their common edge.
struct ScenePatch {
  std::uint32_t surface = 0;
  std::uint8_t level_u = 0, level_v = 0;
  std::uint16_t cells_u = 1, cells_v = 1;  ///< powers of two
  std::uint32_t column = 0, row = 0;       ///< of the tile
  Attributes attributes;
  /// Unique over all plans of one ScenePlanner: patches with the same id have the same samples, which a
  /// caller may keep.
  std::uint64_t id = 0;
  /// The number of additional samples that the neighbours have on the edges v0, v1, u0, u1, and the index of
  /// the first one in ScenePlan::edge_coordinates. In ascending order.
  std::array<std::uint32_t, 4> edge_counts{};
  std::uint32_t first_edge_coordinate = 0;
  /// Range in ScenePlan::tiles: the tiles that use these samples.
  std::uint32_t first_tile = 0, tile_count = 0;

  Tile tile() const;
  bool plain() const { return (edge_counts[0] | edge_counts[1] | edge_counts[2] | edge_counts[3]) == 0; }
};

/// A tile that is needed.
struct PlannedTile {
  std::uint32_t instance, patch;
};

/// A part of a mesh that is needed.
struct PlannedPart {
  std::uint32_t instance, part;  ///< of Scene::mesh_instances, and of its mesh
};

/// Numbers of skipped tiles, each counted under one reason. A part of a mesh instance counts as one tile.
struct SkippedTiles {
  std::uint64_t no_normal_map = 0;  ///< only tangents are requested, and the material reads none
  std::uint64_t outside_frustum = 0;
  std::uint64_t back_facing = 0;
  std::uint64_t occluded = 0;     ///< hidden behind others, before duplicates
  std::uint64_t below_error = 0;  ///< a larger tile with as few samples suffices
  std::uint64_t duplicates = 0;   ///< computed once, for another instance of the surface
};

struct ScenePlan {
  std::vector<ScenePatch> patches;       ///< what is to be evaluated
  std::vector<PlannedTile> tiles;        ///< what is to be drawn, by patch
  std::vector<double> edge_coordinates;  ///< of the patches
  std::vector<PlannedPart> parts;        ///< of meshes, what is to be drawn

  std::uint64_t instances_needed = 0;  ///< those with at least one tile, and parts of instances of meshes
  std::uint64_t tiles_all = 0;         ///< of all instances at their finest resolution
  std::uint64_t tiles_needed = 0;      ///< all, less those skipped: patches and parts of meshes
  SkippedTiles skipped;
  /// Needed tiles whose resolution is not proven, counted before duplicates and hidden tiles are removed.
  /// Either the resolution is estimated from samples and increased by half: next to poles, on surfaces
  /// without bounds and, without skip.below_error, on surfaces without closed forms. Or it is limited to the
  /// maximum of 2^14 cells along a side. Parts of meshes count here if they move. Surfaces without bounds are
  /// never culled.
  std::uint64_t tiles_unbounded = 0;
  /// Samples if every instance were evaluated uniformly at the resolution of its nearest point; for meshes,
  /// their vertices.
  std::uint64_t samples_full = 0;
  std::uint64_t samples_needed = 0;  ///< of the patches, and vertices
  /// Samples of each attribute that are evaluated, or read.
  std::array<std::uint64_t, attribute_count> attribute_samples{};
};

/// Plans the evaluation for one camera. Nothing visible is omitted: tiles are culled only by proven bounds,
/// rounding included. Resolutions satisfy the requested bounds, which is proven except for tiles_unbounded.
/// Surfaces without bounds are not culled, and their resolution is estimated from samples. Cost: about 0.2 us
/// per instance outside the frustum, 0.5 us per small one in view, and up to some ms per surface without
/// closed forms, whose tiles are bounded first: docs/reports/scene.md. \throws ParameterError for a camera or
/// a bound that is out of range, an index that is, a placement that is singular or not finite, or bounds that
/// ask for more than 2^24 tiles in view, duplicates and what others hide included, or 2^18 of one surface
ScenePlan plan_scene(const Scene& scene, const Camera& camera, const SceneRequest& request);

/// The same for many cameras of a scene. The plans are those of plan_scene(), to the bit, except for the ids
/// of patches. The planner caches the bounds of the surfaces' tiles. It also reuses the decisions for an
/// instance while they provably hold: while the camera, with the same lens, has moved and rotated too little
/// to change any of them. Memory: about 1 kB for each tile of a surface that a camera looked at, 110 bytes
/// per instance and 40 more with skip.occluded, 16 for each answer about a tile of an instance in view, and
/// the patches of the last plans.
class ScenePlanner {
 public:
  /// \param scene lives as long as this, and does not change
  /// \throws ParameterError as plan_scene() for a bound that is out of range
  ScenePlanner(const Scene& scene, const SceneRequest& request);
  ScenePlanner(ScenePlanner&&) noexcept;
  ScenePlanner& operator=(ScenePlanner&&) noexcept;
  ~ScenePlanner();
  /// \throws ParameterError as plan_scene()
  ScenePlan plan(const Camera& camera);

 private:
  friend ScenePlan plan_scene(const Scene& scene, const Camera& camera, const SceneRequest& request);
  class Planner;
  static ScenePlan plan_once(const Scene& scene, const Camera& camera, const SceneRequest& request);
  std::unique_ptr<Planner> planner_;
};

/// The samples of one patch, in the space of its surface. Valid until the function that receives them
/// returns.
class TileSamples {
 public:
  const ScenePatch& patch() const { return *patch_; }
  /// The tiles with these samples; transform each by the placement of its instance.
  std::span<const PlannedTile> tiles() const { return tiles_; }
  std::size_t size() const { return status_.size(); }
  Vec2<double> uv(std::size_t i) const {
    const std::size_t corners = corners_.size();
    return i < corners ? corners_[i]
                       : Vec2<double>{others_[2 * (i - corners)], others_[2 * (i - corners) + 1]};
  }
  /// All components of an attribute of the i-th sample; empty where it was not asked for.
  std::span<const double> operator()(Attribute a, std::size_t i) const {
    const std::size_t n = info_of(a).components;
    const double* values = values_[static_cast<std::size_t>(a)];
    return values ? std::span<const double>(values + n * i, n) : std::span<const double>();
  }
  Vec3<double> vec3(Attribute a, std::size_t i) const {
    const auto x = (*this)(a, i);
    return {x[0], x[1], x[2]};
  }
  Status status(std::size_t i) const { return status_[i]; }
  /// Three indices per triangle, wound counter-clockwise as seen from the side of dpdu × dpdv. There are no
  /// gaps to the neighbours, and no T-junctions.
  std::span<const std::uint32_t> triangles() const { return triangles_; }

 private:
  friend class TileEvaluator;
  const ScenePatch* patch_ = nullptr;
  std::span<const PlannedTile> tiles_;
  Points<double> corners_;  // of cells, by rows
  std::vector<double> others_;
  std::array<const double*, attribute_count> values_{};
  std::span<Status> status_;
  std::span<const std::uint32_t> triangles_;
};

/// Evaluates the patches of a plan one after the other, reusing memory. Scene and plan must outlive this
/// object, and the plan must be of this scene, which is not checked.
class TileEvaluator {
 public:
  TileEvaluator(const Scene& scene, const ScenePlan& plan) : scene_(&scene), plan_(&plan) {}
  /// \param patch one of the plan \param options options.threads is ignored
  /// \throws ParameterError where the scene has fewer surfaces, or the plan fewer tiles, than the patch names
  const TileSamples& evaluate(const ScenePatch& patch, const EvaluateOptions& options = {});

 private:
  const Scene* scene_;
  const ScenePlan* plan_;
  TileSamples samples_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>>
      of_plain_;  // triangles, by cells
  std::vector<std::uint32_t> triangles_;
  std::vector<double> memory_;
  std::vector<Status> status_;
};

/// Calls f(const TileSamples&) for each patch of a plan, in order and in the calling thread. The plan must be
/// of this scene. \throws ParameterError as TileEvaluator::evaluate()
template <class F>
void for_each_tile(const Scene& scene, const ScenePlan& plan, F&& f, const EvaluateOptions& options = {}) {
  TileEvaluator evaluator(scene, plan);
  for (const ScenePatch& patch : plan.patches) f(evaluator.evaluate(patch, options));
}

}  // namespace darboux
