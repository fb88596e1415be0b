// Random scenes: cameras among surfaces of all kinds.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <darboux/scene.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test {

inline Eigen::Affine3d random_placement(Random& random, bool rigid) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  const Vec3<double> axis = random.direction(), at = random.uniform(6, 30) * random.direction();
  result.linear() =
      Eigen::AngleAxisd(random.uniform(0, 2 * std::numbers::pi), to_eigen(axis)).toRotationMatrix();
  if (!rigid)
    result.linear() *=
        Eigen::Vector3d(random.log_uniform(0.5, 2) * random.sign(), random.log_uniform(0.5, 2), 1)
            .asDiagonal();
  result.translation() = to_eigen(at);
  return result;
}

inline Camera random_camera(Random& random) {
  Camera camera;
  camera.pose = Camera::look_at(to_eigen(random.uniform(0, 3) * random.direction()),
                                to_eigen(20 * random.direction()), to_eigen(random.direction()));
  camera.vertical_field_of_view_rad = random.uniform(0.3, 2);
  camera.width_px = 640;
  camera.height_px = 480;
  if (random.uniform() < 0.3) {
    camera.projection = Camera::Projection::orthographic;
    camera.view_height = random.log_uniform(2, 40);
    camera.near_distance = -5;
  }
  camera.far_distance = random.log_uniform(10, 100);
  return camera;
}

// Some of every surface of the catalogue, placed at random.
inline Scene random_scene(Random& random, std::size_t instances) {
  Scene scene;
  scene.surfaces = all_surfaces();
  scene.materials = {{.name = "plain"}, {.name = "bumpy"}, {.name = "cloth"}, {.name = "displaced"}};
  scene.materials[1].normal_map = true;
  scene.materials[2].double_sided = true;
  scene.materials[3].displacement = 0.1;
  for (std::size_t i = 0; i < instances; ++i)
    scene.instances.push_back({static_cast<std::uint32_t>(random.bits() % scene.surfaces.size()),
                               static_cast<std::uint32_t>(random.bits() % scene.materials.size()),
                               random_placement(random, random.uniform() < 0.5)});
  return scene;
}

inline bool is_in_view(const Camera& camera, const Eigen::Vector3d& p) {
  const Eigen::Vector3d q = camera.pose.inverse() * p;
  const double z = -q.z(), aspect = double(camera.width_px) / camera.height_px;
  const bool perspective = camera.projection == Camera::Projection::perspective;
  const double y = perspective ? z * std::tan(camera.vertical_field_of_view_rad / 2) : camera.view_height / 2;
  return z >= camera.near_distance && z <= camera.far_distance && std::fabs(q.y()) <= y &&
         std::fabs(q.x()) <= y * aspect;
}

inline std::uint64_t total(const SkippedTiles& s) {
  return s.no_normal_map + s.outside_frustum + s.back_facing + s.occluded + s.below_error + s.duplicates;
}

}  // namespace darboux::test
