#include "scene_contest.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <darboux/scene.h>

#include "occt_mesh.h"
#include "scene/view.h"
#include "scene_timing.h"

namespace darboux::bench {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Largest errors_of(const std::string& name, const Scene& scene, const ScenePlan& plan) {
  Largest result;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform;
  const std::size_t each = 200000 / plan.patches.size() + 1;
  for_each_tile(scene, plan, [&](const TileSamples& tile) {
    for (std::size_t i = 0; i < each; ++i) {
      const std::uint32_t* corner = tile.triangles().data() + 3 * (random() % (tile.triangles().size() / 3));
      double w[3] = {uniform(random), uniform(random), 0}, corners[3][3];
      if (w[0] + w[1] > 1) w[0] = 1 - w[0], w[1] = 1 - w[1];
      w[2] = 1 - w[0] - w[1];
      for (int k = 0; k < 3; ++k) {
        const auto p = tile(Attribute::position, corner[k]);
        std::copy(p.begin(), p.end(), corners[k]);
      }
      result.add(name, corners, w);
    }
  });
  return result;
}

void row(const char* what, std::size_t samples, double milliseconds, const Largest& errors, double chord) {
  std::printf("| %s | %zu | %.3f | %.2f | %.3f |\n", what, samples, milliseconds, errors.distance / chord,
              errors.normal_rad * 180 / std::numbers::pi);
}

void meshes(int rounds) {
  std::printf(
      "\n### Beside OCCT's BRepMesh\n\nOne surface of radius 1 to a chord error, a length, without a bound "
      "on angles and "
      "without a view. The largest errors of 200 000 random points of triangles, against the implicit "
      "equation.\n\n"
      "| | samples | ms | largest distance, of what was asked | largest angle of normals, degrees |\n"
      "|---|---:|---:|---:|---:|\n");
  bool missing = false;
  for (const double chord : {1e-2, 1e-3, 1e-4})
    for (const char* name : {"sphere", "torus", "cylinder", "cone"}) {
      char label[80];
      if (const auto mesh = occt_mesh(name, chord, rounds)) {
        std::snprintf(label, sizeof label, "%s, %g: BRepMesh", name, chord);
        row(label, mesh->samples, 1e3 * mesh->seconds, mesh->errors, chord);
      } else {
        missing = true;
      }
      const Scene scene{{make_surface(name)}, {{}}, {{}}};
      SceneRequest request;
      request.attributes = Attribute::position | Attribute::normal;
      request.chord = chord;
      request.chord_px = request.frame_angle_rad = infinity;
      request.skip.outside_frustum = request.skip.back_facing = false;
      ScenePlan plan;
      const double seconds = medians(rounds, {[&] {
                                       plan = plan_scene(scene, {}, request);
                                       evaluate(scene, plan);
                                     }})[0];
      std::snprintf(label, sizeof label, "%s, %g: a plan, evaluated", name, chord);
      row(label, plan.samples_needed, 1e3 * seconds, errors_of(name, scene, plan), chord);
    }
  if (missing)
    std::printf(
        "\nBRepMesh was not measured: libocct-modeling-algorithms-dev and libocct-visualization-dev are not "
        "both there.\n");
}

// What a culler by spheres and cones of normals knows of a tile.
struct Cone {
  Eigen::Vector3d centre, axis;
  double radius = 0, half_angle = 0;
};
// The least ones by samples, which is in its favour.
Cone cone_of(const TileSamples& tile) {
  Cone cone;
  Eigen::AlignedBox3d box;
  Eigen::Vector3d sum(0, 0, 0);
  const auto vector = [&](Attribute a, std::size_t i) {
    const Vec3<double> x = tile.vec3(a, i);
    return Eigen::Vector3d(x.x, x.y, x.z);
  };
  for (std::size_t i = 0; i < tile.size(); ++i) {
    box.extend(vector(Attribute::position, i));
    sum += vector(Attribute::normal, i);
  }
  cone.centre = box.center();
  cone.axis = sum.normalized();
  for (std::size_t i = 0; i < tile.size(); ++i) {
    cone.radius = std::max(cone.radius, (vector(Attribute::position, i) - cone.centre).norm());
    cone.half_angle = std::max(cone.half_angle,
                               std::acos(std::clamp(cone.axis.dot(vector(Attribute::normal, i)), -1.0, 1.0)));
  }
  return cone;
}
bool culled(const Cone& cone, const Eigen::Affine3d& rigid, const View& view) {
  const Eigen::Vector3d centre = rigid * cone.centre, axis = rigid.linear() * cone.axis;
  for (const Plane3& plane : view.planes())
    if (plane.normal.dot(centre) - plane.offset < -cone.radius) return true;
  const Eigen::Vector3d to_eye = view.eye() - centre;
  const double distance = to_eye.norm(),
               angle = std::acos(std::clamp(axis.dot(to_eye) / distance, -1.0, 1.0));
  return distance * std::cos(std::max(0.0, angle - cone.half_angle)) + cone.radius < 0;
}

void cullers(const Scene& scene, const Camera& camera, int rounds) {
  SceneRequest request;
  request.attributes = Attribute::position | Attribute::normal;
  request.chord_px = 1;
  request.frame_angle_rad = std::numbers::pi;
  request.skip.duplicates = false;
  const ScenePlan ours = plan_scene(scene, camera, request);
  SceneRequest everything = request;
  everything.skip.outside_frustum = everything.skip.back_facing = false;
  const ScenePlan all = plan_scene(scene, camera, everything);
  std::vector<Cone> cones;
  std::vector<std::size_t> samples;
  for_each_tile(scene, all, [&](const TileSamples& tile) {
    cones.push_back(cone_of(tile));
    samples.push_back(tile.size());
  });
  const View view(camera);
  std::size_t tiles = 0, needed = 0;
  const auto cull = [&] {
    tiles = needed = 0;
    for (std::size_t i = 0; i < all.patches.size(); ++i)
      if (!culled(cones[i], scene.instances[all.tiles[i].instance].placement, view)) {
        ++tiles;
        needed += samples[i];
      }
  };
  const std::vector<double> s = medians(rounds, {[&] { plan_scene(scene, camera, request); },
                                                 [&] { plan_scene(scene, camera, everything); }, cull});
  std::printf(
      "\n### Beside a culler by spheres and cones of normals\n\n%zu spheres, tori, cylinders and cones 2 to "
      "200 radii "
      "from a camera of 60 degrees, 1 px, each tile by itself. The culler is given the tiles and their least "
      "spheres "
      "and cones, by samples, for nothing.\n\n"
      "| | tiles | samples | ms |\n|---|---:|---:|---:|\n"
      "| nothing culled | %zu | %zu | %.2f |\n"
      "| spheres and cones, after these | %zu | %zu | %.2f more |\n"
      "| plan_scene() | %zu | %zu | %.2f |\n",
      scene.instances.size(), all.tiles.size(), static_cast<std::size_t>(all.samples_needed), 1e3 * s[1],
      tiles, needed, 1e3 * s[2], ours.tiles.size(), static_cast<std::size_t>(ours.samples_needed),
      1e3 * s[0]);
}

}  // namespace

void contest_of_scenes(int rounds) {
  meshes(rounds);
  Camera camera;
  camera.vertical_field_of_view_rad = std::numbers::pi / 3;
  cullers(scattered(3000), camera, rounds);
}

}  // namespace darboux::bench
