// What ScenePlanner keeps from one camera of a path to the next changes no plan.
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/scene.h>

#include "every_surface.h"
#include "random.h"
#include "random_scene.h"
#include "scene/surface_tiles.h"

namespace darboux::test::scene_path_test {
namespace {

void expect_same_plan(const ScenePlan& kept, const ScenePlan& anew) {
  EXPECT_EQ(kept.tiles_all, anew.tiles_all);
  EXPECT_EQ(kept.skipped.no_normal_map, anew.skipped.no_normal_map);
  EXPECT_EQ(kept.skipped.outside_frustum, anew.skipped.outside_frustum);
  EXPECT_EQ(kept.skipped.back_facing, anew.skipped.back_facing);
  EXPECT_EQ(kept.skipped.occluded, anew.skipped.occluded);
  EXPECT_EQ(kept.skipped.below_error, anew.skipped.below_error);
  EXPECT_EQ(kept.skipped.duplicates, anew.skipped.duplicates);
  EXPECT_EQ(kept.instances_needed, anew.instances_needed);
  EXPECT_EQ(kept.tiles_unbounded, anew.tiles_unbounded);
  EXPECT_EQ(kept.samples_full, anew.samples_full);
  EXPECT_EQ(kept.samples_needed, anew.samples_needed);
  EXPECT_EQ(kept.attribute_samples, anew.attribute_samples);
  EXPECT_EQ(kept.edge_coordinates, anew.edge_coordinates);
  ASSERT_EQ(kept.patches.size(), anew.patches.size());
  ASSERT_EQ(kept.tiles.size(), anew.tiles.size());
  for (std::size_t k = 0; k < kept.patches.size(); ++k) {
    const ScenePatch &a = kept.patches[k], &b = anew.patches[k];
    ASSERT_TRUE(a.surface == b.surface && a.column == b.column && a.row == b.row && a.cells_u == b.cells_u &&
                a.cells_v == b.cells_v && a.level_u == b.level_u && a.level_v == b.level_v &&
                a.edge_counts == b.edge_counts && a.attributes == b.attributes &&
                a.first_edge_coordinate == b.first_edge_coordinate && a.first_tile == b.first_tile);
  }
  for (std::size_t k = 0; k < kept.tiles.size(); ++k)
    ASSERT_TRUE(kept.tiles[k].instance == anew.tiles[k].instance &&
                kept.tiles[k].patch == anew.tiles[k].patch);
}

// What is kept from one camera to the next changes nothing: steps of all sizes, so that decisions hold, hold
// in part, and fail.
TEST(ScenePath, PlansOfAPathAreThoseOfEachCamera) {
  Random random(8);
  for (int round = 0; round < 6; ++round) {
    const Scene scene = random_scene(random, 60);
    SceneRequest request;
    request.chord_px = 6;
    request.frame_angle_rad = round % 3 == 0 ? 0.3 : std::numbers::pi;
    if (round == 3) request.skip.duplicates = false;
    if (round == 4) request.chord = 0.01;
    request.skip.occluded = round % 2 == 1;
    ScenePlanner planner(scene, request);
    Camera camera = random_camera(random);
    for (int i = 0; i < 12; ++i) {
      const double step = random.log_uniform(1e-6, 0.3);
      if (i % 4 != 3) {
        camera.pose.translate(to_eigen(step * random.direction()));
        camera.pose.rotate(Eigen::AngleAxisd(step / 4, to_eigen(random.direction())));
        camera.pose.linear() = Eigen::Quaterniond(camera.pose.linear()).normalized().toRotationMatrix();
      }
      if (i == 8) camera.vertical_field_of_view_rad *= 0.9;
      expect_same_plan(planner.plan(camera), plan_scene(scene, camera, request));
      if (HasFatalFailure()) return;
    }
  }
}

// The same where most decisions are kept: closed forms in view, and small steps.
TEST(ScenePath, SmallStepsChangeWhatTheyMust) {
  Random random(14);
  std::size_t changes = 0;
  for (int round = 0; round < 6; ++round) {
    Scene scene = random_scene(random, 0);
    scene.surfaces.clear();
    for (const char* name : {"sphere", "torus", "cylinder", "cone", "disk", "plane",
                             "ellipsoid:semi_axis_x=1,semi_axis_y=0.3,semi_axis_z=0.6"})
      scene.surfaces.push_back(make_surface(name));
    for (std::uint32_t i = 0; i < 600; ++i) {
      Eigen::Affine3d placement = random_placement(random, i % 3 != 0);
      placement.translation() =
          Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), -1.5) * random.log_uniform(3, 30);
      scene.instances.push_back({i % 7, i % 4, placement});
    }
    SceneRequest request;
    request.chord_px = round % 2 == 0 ? 2 : 0.5;
    request.frame_angle_rad = std::numbers::pi;
    request.skip.occluded = round % 3 == 1;
    ScenePlanner planner(scene, request);
    Camera camera;
    camera.far_distance = 40;
    if (round % 3 == 2) {
      camera.projection = Camera::Projection::orthographic;
      camera.view_height = 30;
    }
    ScenePlan last;
    for (int i = 0; i < 40; ++i) {
      const double step = random.log_uniform(1e-4, 0.1);
      if (i % 2 == 0)
        camera.pose.translate(to_eigen(step * random.direction()));
      else
        camera.pose.rotate(Eigen::AngleAxisd(step / 5, to_eigen(random.direction())));
      camera.pose.linear() = Eigen::Quaterniond(camera.pose.linear()).normalized().toRotationMatrix();
      const ScenePlan kept = planner.plan(camera);
      expect_same_plan(kept, plan_scene(scene, camera, request));
      if (HasFatalFailure()) return;
      changes += kept.skipped.back_facing != last.skipped.back_facing;
      last = kept;
    }
  }
  EXPECT_GT(changes, 20u);
}

// The distance of a surface without a closed form of it is that of its box from afar, and of its parts from
// near: it jumps between, where the box is four of its radii away.
TEST(ScenePath, DistancesThatJumpChangeWhatTheyMust) {
  Random random(19);
  for (int round = 0; round < 5; ++round) {
    Scene scene{{}, {{}}, {}};
    if (round == 0)
      scene.surfaces = {make_surface("bezier-patch"), make_surface("bspline-patch")};
    else
      scene.surfaces = {make_surface("superellipsoid"), make_surface("elliptic-paraboloid")};
    std::vector<double> radii;
    for (const AnySurface& surface : scene.surfaces)
      radii.push_back(SurfaceTiles(surface, TileOrder::position).radius());
    for (std::uint32_t i = 0; i < 2000; ++i) {
      Eigen::Affine3d placement = random_placement(random, true);
      placement.translation() = to_eigen(radii[i % 2] * random.uniform(4, 6) * random.direction());
      scene.instances.push_back({i % 2, 0, placement});
    }
    SceneRequest request;
    request.attributes = Attribute::position | Attribute::normal;
    request.chord_px = random.log_uniform(0.03, 0.3);
    request.frame_angle_rad = std::numbers::pi;
    request.skip.outside_frustum = request.skip.back_facing = false;  // depths say little
    ScenePlanner planner(scene, request);
    Camera camera;
    for (int i = 0; i < 20; ++i) {
      camera.pose.translation() += to_eigen(0.03 * random.direction());
      expect_same_plan(planner.plan(camera), plan_scene(scene, camera, request));
      if (HasFailure()) return;
    }
  }
}

// A plan that an error ends in the middle leaves nothing behind.
TEST(ScenePath, APathGoesOnAfterAnError) {
  Random random(12);
  Scene scene = random_scene(random, 60);
  SceneRequest request;
  request.chord_px = 6;
  request.frame_angle_rad = std::numbers::pi;
  ScenePlanner planner(scene, request);
  Camera camera = random_camera(random);
  camera.vertical_field_of_view_rad = 2;
  camera.projection = Camera::Projection::perspective;
  camera.near_distance = 0.1;
  expect_same_plan(planner.plan(camera), plan_scene(scene, camera, request));
  Camera elsewhere = camera;
  elsewhere.pose.rotate(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitY()));
  const Eigen::Affine3d placement = scene.instances[0].placement;
  scene.instances[0].placement.linear().setZero();
  EXPECT_THROW(planner.plan(elsewhere), ParameterError);
  scene.instances[0].placement = placement;
  expect_same_plan(planner.plan(camera), plan_scene(scene, camera, request));
}

// Patches of one number have the same samples, and others another number.
TEST(ScenePath, PatchesOfAPathKeepTheirNumbers) {
  Random random(13);
  Scene scene = random_scene(random, 60);
  SceneRequest request;
  request.chord_px = 3;
  request.frame_angle_rad = std::numbers::pi;
  ScenePlanner planner(scene, request);
  Camera camera;
  camera.vertical_field_of_view_rad = 2;
  using Samples = std::vector<double>;
  std::map<std::uint64_t, Samples> known;
  std::map<std::pair<std::uint32_t, Samples>, std::uint64_t> numbers;
  std::size_t again = 0;
  for (int i = 0; i < 6; ++i) {
    camera.pose.translate(to_eigen(0.05 * random.direction()));
    const ScenePlan plan = planner.plan(camera);
    for_each_tile(scene, plan, [&](const TileSamples& tile) {
      Samples samples{double(tile.patch().attributes == request.attributes)};
      for (std::size_t k = 0; k < tile.size(); ++k) {
        samples.push_back(tile.uv(k).x);
        samples.push_back(tile.uv(k).y);
      }
      const auto [at, fresh] = known.emplace(tile.patch().id, samples);
      again += !fresh;
      ASSERT_EQ(at->second, samples);
      ASSERT_EQ(numbers.emplace(std::pair(tile.patch().surface, samples), tile.patch().id).first->second,
                tile.patch().id);
    });
  }
  EXPECT_GT(again, 3 * known.size());
}

}  // namespace
}  // namespace darboux::test::scene_path_test
