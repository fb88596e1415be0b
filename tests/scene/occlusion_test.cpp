// What is hidden lies behind opaque surface, and what cannot hide hides nothing.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include <darboux/scene.h>

#include "every_surface.h"
#include "random.h"
#include "random_scene.h"

namespace darboux::test::occlusion_test {
namespace {

// Whether the way from a to b meets a unit sphere, of either side, or the unit square about the origin.
bool sphere_is_before(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double half = a.dot(d), square = d.squaredNorm(),
               under = half * half - square * (a.squaredNorm() - 1);
  if (under <= 0) return false;
  const auto on_way = [](double at) { return at > 0 && at < 1; };
  return on_way((-half - std::sqrt(under)) / square) || on_way((-half + std::sqrt(under)) / square);
}
bool square_is_before(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double at = a.z() / (a.z() - b.z());
  const Eigen::Vector3d p = a + at * (b - a);
  const auto within = [](double x) { return std::fabs(x) <= 0.5; };
  return at > 0 && at < 1 && within(p.x()) && within(p.y());
}

// Of the surfaces themselves, whatever their triangles: what is hidden lies behind another point of one.
TEST(Occlusion, HiddenTilesLieBehindOthers) {
  Random random(21);
  std::size_t looked_at = 0;
  for (int round = 0; round < 12; ++round) {
    Scene scene;
    scene.surfaces = all_surfaces();
    const auto sphere = static_cast<std::uint32_t>(scene.surfaces.size());
    scene.surfaces.push_back(make_surface("sphere"));
    scene.surfaces.push_back(make_surface("plane"));
    scene.materials = {{.name = "thin", .double_sided = true},
                       {.name = "glass", .double_sided = true, .see_through = true}};
    for (std::uint32_t i = 0; i < 8; ++i) {
      Eigen::Affine3d placement = random_placement(random, i % 4 < 2);
      placement.translation() =
          Eigen::Vector3d(random.uniform(-3, 3), random.uniform(-2, 2), -random.uniform(4, 6));
      if (i % 2 == 1) placement.linear() *= 3;
      scene.instances.push_back({sphere + i % 2, i == 7 ? 1u : 0u, placement});
    }
    for (std::uint32_t i = 0; i < 300; ++i) {
      Eigen::Affine3d placement = random_placement(random, i % 2 == 0);
      placement.linear() *= 0.05;
      placement.translation() =
          Eigen::Vector3d(random.uniform(-6, 6), random.uniform(-4, 4), -random.uniform(2, 12));
      scene.instances.push_back({static_cast<std::uint32_t>(random.bits() % sphere), 1, placement});
    }
    Camera camera;
    camera.near_distance = round % 2 == 0 ? 0.1 : 3.5;
    const bool perspective = round % 3 > 0;
    if (!perspective) {
      camera.projection = Camera::Projection::orthographic;
      camera.view_height = 7;
    }
    SceneRequest request;
    request.chord_px = random.log_uniform(0.5, 20);
    request.frame_angle_rad = std::numbers::pi;
    const auto tiles_of = [&](const ScenePlan& plan) {
      std::set<std::tuple<std::uint32_t, int, int, std::uint32_t, std::uint32_t>> tiles;
      for (const PlannedTile& t : plan.tiles) {
        const ScenePatch& p = plan.patches[t.patch];
        tiles.insert({t.instance, p.level_u, p.level_v, p.column, p.row});
      }
      return tiles;
    };
    const auto all = tiles_of(plan_scene(scene, camera, request));
    request.skip.occluded = true;
    const ScenePlan plan = plan_scene(scene, camera, request);
    const auto shown = tiles_of(plan);
    EXPECT_EQ(all.size(), shown.size() + plan.skipped.occluded);
    for (const auto& hidden : all) {
      if (shown.contains(hidden)) continue;
      const auto& [i, level_u, level_v, column, row] = hidden;
      for (int k = 0; k < 20; ++k) {
        const double u = std::ldexp(column + random.uniform(), -level_u),
                     v = std::ldexp(row + random.uniform(), -level_v);
        const Eigen::Vector3d p =
            scene.instances[i].placement *
            to_eigen(scene.surfaces[scene.instances[i].surface].sample(u, v).jet.position);
        if (!is_in_view(camera, p)) continue;
        ++looked_at;
        // From the near plane on.
        const double near = camera.near_distance;
        const Eigen::Vector3d from =
            perspective ? Eigen::Vector3d(p * (near / -p.z())) : Eigen::Vector3d(p.x(), p.y(), -near);
        bool behind = false;
        for (std::uint32_t other = 0; other < 7 && !behind; ++other) {
          if (other == i) continue;
          const Eigen::Affine3d to_local = scene.instances[other].placement.inverse();
          behind = other % 2 == 0 ? sphere_is_before(to_local * from, to_local * p)
                                  : square_is_before(to_local * from, to_local * p);
        }
        // Of a large one a far side may lie behind its own near side.
        if (i < 8 && i % 2 == 0 && !behind) {
          const Eigen::Affine3d to_local = scene.instances[i].placement.inverse();
          behind = sphere_is_before(to_local * from, to_local * (p - 1e-9 * (p - from)));
        }
        ASSERT_TRUE(behind) << scene.surfaces[scene.instances[i].surface].specification() << " at " << u
                            << ' ' << v << ", round " << round;
      }
    }
  }
  std::cout << looked_at << " points of hidden tiles\n";
  EXPECT_GT(looked_at, 1000u);
}

TEST(Occlusion, WhatIsSeenThroughHidesNothing) {
  Scene scene;
  scene.surfaces = {make_surface("plane"), make_surface("sphere")};
  scene.materials = {{.name = "wall"}, {.name = "ball"}};
  scene.instances = {{0, 0, Eigen::Translation3d(0, 0, -5) * Eigen::Affine3d(Eigen::Scaling(4.0))},
                     {1, 1, Eigen::Translation3d(0, 0, -8) * Eigen::Affine3d(Eigen::Scaling(0.5))}};
  SceneRequest request;
  request.skip.occluded = true;
  EXPECT_GT(plan_scene(scene, Camera(), request).skipped.occluded, 0u);
  scene.materials[0].see_through = true;
  const ScenePlan plan = plan_scene(scene, Camera(), request);
  EXPECT_EQ(plan.skipped.occluded, 0u);
  EXPECT_EQ(plan.instances_needed, 2u);
}

// Larger ones that cannot hide, of one side only, are no reason not to look at the wall.
TEST(Occlusion, WhatCannotHideTakesNoPlaceOfWhatCan) {
  Scene scene;
  scene.surfaces = {make_surface("plane"), make_surface("sphere"), make_surface("moebius-strip")};
  scene.materials = {{.name = "all"}};
  scene.instances = {{0, 0, Eigen::Translation3d(0, 0, -5) * Eigen::Affine3d(Eigen::Scaling(4.0))},
                     {1, 0, Eigen::Translation3d(0, 0, -8) * Eigen::Affine3d(Eigen::Scaling(0.5))}};
  for (int i = 0; i < 20; ++i)
    scene.instances.push_back(
        {2, 0, Eigen::Translation3d(0, 0, -40 - i) * Eigen::Affine3d(Eigen::Scaling(30.0))});
  SceneRequest request;
  request.skip.occluded = true;
  EXPECT_GT(plan_scene(scene, Camera(), request).skipped.occluded, 0u);
}

}  // namespace
}  // namespace darboux::test::occlusion_test
