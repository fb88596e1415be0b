// A scene of two surfaces, planned for one camera; what the camera needs is evaluated, nothing else.
#include <cstdio>

#include <darboux/scene.h>
#include <darboux/sphere.h>
#include <darboux/torus.h>

int main() {
  using darboux::Attribute;
  darboux::Scene scene;
  scene.surfaces = {darboux::Torus{1.0, 0.4}, darboux::Sphere{0.5}};
  scene.materials = {{.name = "bumpy", .normal_map = true}, {.name = "plain"}};
  for (int i = 0; i < 100; ++i) {  // rings and balls by turns along the x axis
    darboux::SceneInstance instance;
    instance.surface = instance.material = i % 2;
    instance.placement.translate(Eigen::Vector3d(2.0 * i, 0, 0));
    scene.instances.push_back(instance);
  }
  darboux::Camera camera;
  camera.pose = darboux::Camera::look_at({100, -6, 4}, {108, 0, 0});
  darboux::SceneRequest request;
  request.chord_px = 0.25;

  const darboux::ScenePlan plan = plan_scene(scene, camera, request);
  std::size_t samples = 0, tangents = 0, triangles = 0;
  for_each_tile(scene, plan, [&](const darboux::TileSamples& tile) {
    // Upload the samples once, and draw them for each of tile.tiles() by its instance's placement.
    for (std::size_t i = 0; i < tile.size(); ++i) {
      ++samples;
      if (!tile(Attribute::tangent4, i).empty()) ++tangents;  // the plain material reads none
    }
    triangles += tile.tiles().size() * tile.triangles().size() / 3;
  });
  std::printf("%d of %d instances are needed\n", int(plan.instances_needed), int(scene.instances.size()));
  std::printf("%d of %d tiles, %d samples, %d of them with tangents; %d triangles to draw\n",
              int(plan.tiles_needed), int(plan.tiles_all), int(samples), int(tangents), int(triangles));
}
