#include "report/scene_picture.h"

#include <cmath>

#include <gtest/gtest.h>

#include <darboux/frame.h>

#include "every_surface.h"

namespace darboux::test {
namespace {

// A plane of normal +z with a normal map, seen from the front, as it is and mirrored: t goes along with the
// mirror, b stays against v, and the normal still faces us.
TEST(ScenePicture, FramesGoAlongWithTheirPlacement) {
  Camera camera;
  camera.width_px = camera.height_px = 32;
  camera.projection = Camera::Projection::orthographic;
  camera.view_height = 1;
  for (const double side : {1.0, -1.0}) {
    Scene scene;
    scene.surfaces.push_back(make_surface("plane"));
    scene.materials.push_back({});
    scene.materials[0].normal_map = true;
    scene.instances.emplace_back();
    scene.instances[0].placement = Eigen::Translation3d(0, 0, -3) * Eigen::Scaling(side, 1.0, 1.0);
    Rasteriser picture(camera);
    const ScenePlan plan = plan_scene(scene, camera, {});
    for_each_tile(scene, plan, [&](const TileSamples& samples) {
      draw_tiles(picture, scene, samples,
                 [&](const PlannedTile& tile) { return picture_material(scene, tile); });
    });
    const Vec3<double> to_light = Vec3<double>{-1, 2, 3} / std::sqrt(14.0);
    const double colour = picture_material(scene, {0, 0}).colour.x;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        EXPECT_DOUBLE_EQ(picture.depth(x, y), 3);
        const double px = (x + 0.5) / 32 - 0.5, py = 0.5 - (y + 0.5) / 32;
        const Vec3<double> texel = bump({side * px + 0.5, py + 0.5});
        const double light = std::fmax(0, dot({side * texel.x, -texel.y, texel.z}, to_light));
        const double expected = 255 * std::sqrt(colour * (0.12 + 0.88 * light));
        // Half a step of 8 bits, and what rounding adds.
        ASSERT_NEAR(picture.picture().rgb[3 * (32 * y + x)], expected, 0.5 + 1e-9)
            << side << ' ' << x << ' ' << y;
      }
  }
}

TEST(ScenePicture, TheViewFromBesideHoldsTheBox) {
  Camera camera;
  camera.width_px = 40;
  camera.height_px = 20;
  const Eigen::Matrix3d axes = axes_beside(camera);
  const Vec3<double> least{-3, 2, 5}, greatest{7, 4, 6};
  const Camera view = view_along(axes, least, greatest, camera);
  view.check();
  const Eigen::Matrix4d to_view = view.pose.inverse().matrix();
  for (const double x : {least.x, greatest.x})
    for (const double y : {least.y, greatest.y})
      for (const double z : {least.z, greatest.z}) {
        const Eigen::Vector4d p = to_view * (axes * Eigen::Vector3d(x, y, z)).homogeneous();
        EXPECT_LT(std::fabs(p.y()), view.view_height / 2);
        EXPECT_LT(std::fabs(p.x()), view.view_height);
        EXPECT_GT(-p.z(), view.near_distance);
        EXPECT_LT(-p.z(), view.far_distance);
      }
  EXPECT_LT(view.view_height, 6) << "no larger than it must be: 10 wide, 20 to 40";
}

// What is skipped is nowhere in the picture, and changes nothing beside it.
TEST(ScenePicture, IsTheSameWithAndWithoutCulling) {
  Random random(8);
  std::uint64_t outside = 0, back_facing = 0;
  for (int round = 0; round < 16; ++round) {
    Camera camera;
    camera.width_px = 120;
    camera.height_px = 90;
    camera.near_distance = random.uniform(0.1, 5);
    if (round % 4 == 0) {
      camera.projection = Camera::Projection::orthographic;
      camera.view_height = 4;
    }
    Scene scene;
    scene.surfaces = all_surfaces();
    scene.materials = {
        {.name = "plain"}, {.name = "bumpy", .normal_map = true}, {.name = "cloth", .double_sided = true}};
    for (std::uint32_t i = 0; i < 8; ++i) {
      SceneInstance instance{static_cast<std::uint32_t>(random.bits() % scene.surfaces.size()), i % 3, {}};
      instance.placement = Eigen::AngleAxisd(random.uniform(0, 6), to_eigen(random.direction()));
      if (i % 2 == 0)
        instance.placement.linear() *= Eigen::Vector3d(-1, random.uniform(0.5, 1.5), 1).asDiagonal();
      instance.placement.pretranslate(
          Eigen::Vector3d(random.uniform(-3, 3), random.uniform(-2, 2), random.uniform(-9, -3)));
      scene.instances.push_back(instance);
    }
    SceneRequest request;
    request.attributes = request.attributes | Attribute::tangent | Attribute::bitangent;
    request.chord_px = 1;
    request.frame_angle_rad = 0.3;
    const auto picture_of = [&](const ScenePlan& plan) {
      Rasteriser picture(camera);
      for_each_tile(scene, plan, [&](const TileSamples& samples) {
        draw_tiles(picture, scene, samples,
                   [&](const PlannedTile& tile) { return picture_material(scene, tile); });
      });
      return picture.picture().rgb;
    };
    const ScenePlan culled = plan_scene(scene, camera, request);
    request.skip.outside_frustum = request.skip.back_facing = false;
    const ScenePlan all = plan_scene(scene, camera, request);
    outside += culled.skipped.outside_frustum;
    back_facing += culled.skipped.back_facing;
    const auto with = picture_of(culled), without = picture_of(all);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < with.size(); ++i) differing += with[i] != without[i];
    EXPECT_EQ(differing, 0u) << "round " << round;
    EXPECT_LE(culled.tiles.size(), all.tiles.size());
  }
  EXPECT_GT(outside, 100u);
  EXPECT_GT(back_facing, 100u);
}

}  // namespace
}  // namespace darboux::test
