#include "report/scene_picture.h"

#include <cmath>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace darboux::test
