#include "report/scene_picture.h"

#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/frame.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test::scene_picture_test {
namespace {

void draw(Rasteriser& picture, const Scene& scene, const ScenePlan& plan) {
  for_each_tile(scene, plan, [&](const TileSamples& samples) {
    draw_tiles(picture, scene, samples,
               [&](const PlannedTile& tile) { return picture_material(scene, tile); });
  });
}

std::vector<std::uint8_t> picture_of(const Scene& scene, const Camera& camera, const ScenePlan& plan) {
  Rasteriser picture(camera);
  draw(picture, scene, plan);
  return picture.picture().rgb;
}

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
    draw(picture, scene, plan_scene(scene, camera, {}));
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
    const ScenePlan culled = plan_scene(scene, camera, request);
    request.skip.outside_frustum = request.skip.back_facing = false;
    const ScenePlan all = plan_scene(scene, camera, request);
    outside += culled.skipped.outside_frustum;
    back_facing += culled.skipped.back_facing;
    const auto with = picture_of(scene, camera, culled), without = picture_of(scene, camera, all);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < with.size(); ++i) differing += with[i] != without[i];
    EXPECT_EQ(differing, 0u) << "round " << round;
    EXPECT_LE(culled.tiles.size(), all.tiles.size());
  }
  EXPECT_GT(outside, 100u);
  EXPECT_GT(back_facing, 100u);
}

// Something large before small things of all kinds, close enough together that many are hidden in part.
Scene crowded_scene(Random& random, int round) {
  static const char* large[] = {"sphere",       "torus:major_radius=1,minor_radius=0.6",
                                "plane",        "cylinder",
                                "ellipsoid",    "cone",
                                "disk",         "catenoid",
                                "bspline-patch"};
  Scene scene;
  scene.surfaces = all_surfaces();
  scene.materials = {{.name = "plain"}, {.name = "cloth", .double_sided = true}, {.name = "veil"}};
  scene.materials[2].double_sided = scene.materials[2].see_through = true;
  const auto turned = [&] {
    return Eigen::Affine3d(Eigen::AngleAxisd(random.uniform(0, 6), to_eigen(random.direction())));
  };
  const auto first_large = static_cast<std::uint32_t>(scene.surfaces.size());
  for (const char* name : large) scene.surfaces.push_back(make_surface(name));
  for (std::uint32_t i = 0; i < 5; ++i) {
    SceneInstance instance{first_large + static_cast<std::uint32_t>(random.bits() % std::size(large)),
                           random.uniform() < 0.1 ? 2u : i % 2, turned()};
    if (round % 2 == 0)
      instance.placement.linear() *= Eigen::Vector3d(random.sign(), random.uniform(0.6, 1.5), 1).asDiagonal();
    instance.placement.pretranslate(
        Eigen::Vector3d(random.uniform(-2, 2), random.uniform(-1.5, 1.5), random.uniform(-6, -2)));
    scene.instances.push_back(instance);
  }
  for (std::uint32_t i = 0; i < 60; ++i) {
    SceneInstance instance{static_cast<std::uint32_t>(random.bits() % first_large), i % 2, turned()};
    instance.placement.linear() *= 0.15;
    const double depth = random.uniform(3, 12);
    instance.placement.pretranslate(
        Eigen::Vector3d(random.uniform(-0.4, 0.4) * depth, random.uniform(-0.3, 0.3) * depth, -depth));
    scene.instances.push_back(instance);
  }
  return scene;
}

// Every pixel of a picture, against that of all tiles: what is hidden is nowhere in it. With three times as
// many pixels along a side as planned for, so that slivers are seen too.
// \returns how many tiles are hidden, and of how many
std::pair<std::size_t, std::size_t> expect_same_picture(const Scene& scene, Camera camera,
                                                        SceneRequest request) {
  request.attributes = Attribute::position | Attribute::normal;
  request.skip.occluded = true;
  const ScenePlan culled = plan_scene(scene, camera, request);
  request.skip.occluded = false;
  const ScenePlan all = plan_scene(scene, camera, request);
  EXPECT_EQ(all.tiles.size(), culled.tiles.size() + culled.skipped.occluded);
  camera.width_px *= 3;
  camera.height_px *= 3;
  const auto with = picture_of(scene, camera, culled), without = picture_of(scene, camera, all);
  std::size_t differing = 0;
  for (std::size_t i = 0; i < with.size(); ++i) differing += with[i] != without[i];
  EXPECT_EQ(differing, 0u);
  return {culled.skipped.occluded, all.tiles.size()};
}

TEST(ScenePicture, IsTheSameWithoutWhatIsHidden) {
  Random random(11);
  std::size_t hidden = 0, all = 0;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = crowded_scene(random, round);
    Camera camera;
    camera.width_px = 160;
    camera.height_px = 120;
    camera.near_distance = random.log_uniform(0.01, 3);
    camera.far_distance = random.uniform(8, 40);
    if (round % 5 == 0) {
      camera.projection = Camera::Projection::orthographic;
      camera.view_height = 5;
    }
    SceneRequest request;
    request.chord_px = random.log_uniform(0.2, 8);
    request.frame_angle_rad = round % 3 == 0 ? 0.3 : std::numbers::pi;
    const auto [some, of] = expect_same_picture(scene, camera, request);
    hidden += some;
    all += of;
  }
  std::cout << hidden << " of " << all << " tiles hidden\n";
  EXPECT_GT(hidden, all / 20);
}

// Squares of a pixel close to a ring, on both sides of it and about its rims: slopes, and borders that
// coarse triangles cut off.
TEST(ScenePicture, ShowsWhatIsCloseToWhatHides) {
  Random random(12);
  std::size_t hidden = 0, all = 0;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    Scene scene;
    scene.surfaces = {make_surface("disk:inner_radius=0.4,outer_radius=1"), make_surface("plane")};
    scene.materials = {{.name = "ring", .double_sided = true}, {.name = "square"}};
    const Eigen::Affine3d turned = Eigen::Translation3d(0, 0, -3) *
                                   Eigen::AngleAxisd(random.uniform(0, 1.45), Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(random.uniform(0, 6), Eigen::Vector3d::UnitZ());
    scene.instances.push_back({0, 0, turned});
    for (int i = 0; i < 1000; ++i) {
      const double rim = i % 2 == 0 ? 1 : 0.4, angle = random.uniform(0, 6.3),
                   from_axis = i % 4 < 2 ? random.uniform(0.4, 1) : rim + random.uniform(-0.1, 0.1);
      SceneInstance square{1, 1, Eigen::Affine3d(Eigen::Scaling(0.012))};
      square.placement.pretranslate(turned * Eigen::Vector3d(from_axis * std::cos(angle),
                                                             from_axis * std::sin(angle),
                                                             random.uniform(-0.3, 0.3)));
      scene.instances.push_back(square);
    }
    Camera camera;
    camera.width_px = camera.height_px = 200;
    camera.vertical_field_of_view_rad = 0.8;
    if (round % 4 == 3) {
      camera.projection = Camera::Projection::orthographic;
      camera.view_height = 2.4;
    }
    SceneRequest request;
    request.frame_angle_rad = std::numbers::pi;
    request.chord_px = round % 2 == 0 ? 9 : random.log_uniform(0.2, 3);
    const auto [some, of] = expect_same_picture(scene, camera, request);
    hidden += some;
    all += of;
  }
  std::cout << hidden << " of " << all << " tiles hidden\n";
  EXPECT_GT(hidden, all / 20);
}

}  // namespace
}  // namespace darboux::test::scene_picture_test
