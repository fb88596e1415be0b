// Meshes beside surfaces in a scene: the bounds of their parts, and what is planned of them.
#include <cstdint>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/scene.h>

#include "every_surface.h"
#include "random_scene.h"
#include "refusal_of.h"

namespace darboux::test::scene_mesh_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Two triangles, a square of side 1 about the origin that faces +z.
SceneMeshPart square_part(std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return SceneMeshPart::of(mesh, material);
}

TEST(SceneMesh, BoundsOfPartsOfMeshesHoldTheirTriangles) {
  const SceneMeshPart part = square_part(3);
  EXPECT_EQ(part.box.min(), Eigen::Vector3d(-0.5, -0.5, 0));
  EXPECT_EQ(part.box.max(), Eigen::Vector3d(0.5, 0.5, 0));
  EXPECT_EQ(part.axis, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(part.half_angle_rad, 0);
  EXPECT_EQ(part.material, 3u);
  EXPECT_EQ(part.vertices, 4u);
  EXPECT_FALSE(part.moves);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, infinity}};
  EXPECT_TRUE(SceneMeshPart::of(mesh, 0).moves);
}

// Meshes beside surfaces: each part of an instance has one fate.
TEST(SceneMesh, PartsOfMeshesArePlannedAsAWhole) {
  Scene scene;
  scene.surfaces = {make_surface("plane")};
  scene.materials = {
      {.name = "wall"}, {.name = "bumpy", .normal_map = true}, {.name = "moved", .displacement = 2.1}};
  scene.instances = {{0, 0, Eigen::Translation3d(0, 0, -5) * Eigen::Affine3d(Eigen::Scaling(4.0))}};
  scene.meshes = {{{square_part(0), square_part(1)}}, {{square_part(2)}}};
  const auto add = [&](std::uint32_t mesh, double x, double z, double turn = 0) {
    scene.mesh_instances.push_back(
        {mesh, false,
         Eigen::Translation3d(x, 0, z) * Eigen::Affine3d(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()))});
  };
  add(0, 0, -3);                    // in view
  add(0, 0.2, -3.5);                // the same vertices
  add(0, 0, -3, std::numbers::pi);  // from behind
  add(0, 0, 3);                     // behind the camera
  add(0, 0, -8);                    // behind the wall
  add(1, 0, -8);                    // may come out of it
  add(1, 0, 2);                     // displaced into view
  add(1, 0, 2.1);
  Camera camera;
  SceneRequest request;
  request.skip.occluded = true;
  ScenePlan plan = plan_scene(scene, camera, request);
  EXPECT_EQ(plan.skipped.back_facing, 2u);
  EXPECT_EQ(plan.skipped.outside_frustum, 3u);
  EXPECT_EQ(plan.skipped.occluded, 2u);
  EXPECT_EQ(plan.skipped.duplicates, 3u) << "two parts, and the displaced one";
  ASSERT_EQ(plan.parts.size(), 6u);
  EXPECT_EQ(plan.parts[2].instance, 1u);
  EXPECT_EQ(plan.parts[3].part, 1u);
  EXPECT_EQ(plan.tiles_needed, plan.patches.size() + 3);
  EXPECT_EQ(plan.tiles_needed + total(plan.skipped), plan.tiles_all);
  EXPECT_EQ(plan.instances_needed, 1u + 6u);
  const auto samples = [&](Attribute a) { return plan.attribute_samples[static_cast<std::size_t>(a)]; };
  EXPECT_EQ(samples(Attribute::position), plan.samples_needed);
  EXPECT_EQ(samples(Attribute::tangent4), 4u) << "of the bumpy part, once";

  request.skip.occluded = request.skip.duplicates = false;
  plan = plan_scene(scene, camera, request);
  EXPECT_EQ(plan.parts.size(), 8u);
  EXPECT_EQ(plan.skipped.duplicates, 0u);
  scene.mesh_instances[3].moves = true;
  scene.meshes[0].parts[0].moves = true;
  plan = plan_scene(scene, camera, request);
  EXPECT_EQ(plan.parts.size(), 11u) << "its place is not known, nor where the first part is";
  EXPECT_EQ(plan.tiles_unbounded, 6u);

  const auto refusal = [&](const Scene& s) { return refusal_of([&] { plan_scene(s, camera, request); }); };
  Scene bad = scene;
  bad.mesh_instances[1].mesh = 2;
  EXPECT_NE(refusal(bad).find("mesh instance 1: expected a mesh of the scene, got 2"), std::string::npos);
  bad = scene;
  bad.meshes[0].parts[1].material = 7;
  EXPECT_NE(refusal(bad).find("expected materials of the scene, got 7"), std::string::npos) << refusal(bad);
  bad = scene;
  bad.mesh_instances[0].placement.translation().x() = infinity;
  EXPECT_NE(refusal(bad).find("expected a placement that is finite"), std::string::npos);
}

TEST(SceneMesh, AnIndexOutOfRangeIsRefused) {
  Mesh mesh;
  mesh.positions.resize(3);
  mesh.triangles = {{0, 1, 3}};
  EXPECT_THROW(SceneMeshPart::of(mesh, 0), MeshError);
}

}  // namespace
}  // namespace darboux::test::scene_mesh_test
