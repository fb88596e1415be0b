#include "scene_picture.h"

#include <array>
#include <cmath>

namespace darboux {

void draw_tiles(Rasteriser& picture, const Scene& scene, const TileSamples& samples,
                const std::function<PictureMaterial(const PlannedTile&)>& material) {
  const Attributes there = samples.patch().attributes;
  std::vector<PictureVertex> vertices(samples.size());
  for (const PlannedTile& tile : samples.tiles()) {
    const Eigen::Affine3d& placement = scene.instances[tile.instance].placement;
    const Eigen::Matrix3d m = placement.linear(), normals = m.inverse().transpose();
    // A mirror turns the bitangent to the other side of n × t.
    const double side = m.determinant() < 0 ? -1 : 1;
    const auto turned = [](const Eigen::Matrix3d& by, const Vec3<double>& a) {
      return from_eigen(by * to_eigen(a));
    };
    const Vec3<double> translation = from_eigen(placement.translation());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      PictureVertex& v = vertices[i];
      v.position = turned(m, samples.vec3(Attribute::position, i)) + translation;
      v.normal = unit(turned(normals, samples.vec3(Attribute::normal, i)));
      v.uv = samples.uv(i);
      v.tangent = {};
      if (!there.has(Attribute::tangent4)) continue;
      const auto stored = samples(Attribute::tangent4, i);
      const Vec3<double> tangent = unit(turned(m, {stored[0], stored[1], stored[2]}));
      v.tangent = {tangent.x, tangent.y, tangent.z, side * stored[3]};
    }
    // By instance and place in its chart: the order of the patches depends on culling.
    const Tile place = samples.patch().tile();
    const auto fixed = [](double x) { return static_cast<std::uint64_t>(std::ldexp(x, 14)); };
    picture.add(vertices, samples.triangles(), material(tile),
                std::uint64_t{tile.instance} << 32 | fixed(place.v0) << 16 | fixed(place.u0));
  }
}

PictureMaterial picture_material(const Scene& scene, const PlannedTile& tile) {
  // Okabe and Ito's, distinct for colour-blind readers too, in linear RGB.
  static constexpr std::array<Vec3<double>, 8> colours{{{0.45, 0.45, 0.45},
                                                        {0.79, 0.35, 0.0},
                                                        {0.09, 0.46, 0.81},
                                                        {0.0, 0.34, 0.17},
                                                        {0.87, 0.78, 0.05},
                                                        {0.0, 0.17, 0.45},
                                                        {0.66, 0.11, 0.0},
                                                        {0.6, 0.19, 0.39}}};
  const std::uint32_t index = scene.instances[tile.instance].material;
  const SceneMaterial& m = scene.materials[index];
  PictureMaterial result{.colour = colours[index % colours.size()], .double_sided = m.double_sided};
  if (m.normal_map) result.normal_map = bump;
  return result;
}

PictureMaterial picture_material(TileFate fate) {
  static constexpr std::array<Vec3<double>, tile_fates> colours{
      {{0.0, 0.34, 0.17}, {0.79, 0.35, 0.0}, {0.6, 0.6, 0.6}, {0.09, 0.46, 0.81}}};
  return {.colour = colours[static_cast<std::size_t>(fate)], .double_sided = true};
}

Eigen::Matrix3d axes_beside(const Camera& camera) {
  const Eigen::Matrix3d r = camera.pose.linear();
  const Eigen::Vector3d towards_us = r.col(0) + 0.8 * r.col(1) - 0.25 * r.col(2);
  return Camera::look_at(towards_us, Eigen::Vector3d::Zero(), r.col(1)).linear();
}

Camera view_along(const Eigen::Matrix3d& axes, const Vec3<double>& least, const Vec3<double>& greatest,
                  const Camera& with_pixels_of) {
  Camera camera = with_pixels_of;
  camera.projection = Camera::Projection::orthographic;
  const Vec3<double> size = greatest - least, centre = 0.5 * (least + greatest);
  constexpr double margin = 1.05;
  camera.view_height = margin * std::fmax(size.y, size.x * camera.height_px / camera.width_px);
  camera.pose.linear() = axes;
  camera.pose.translation() = axes * Eigen::Vector3d(centre.x, centre.y, greatest.z + size.z);
  camera.near_distance = 0;
  camera.far_distance = 3 * size.z;
  return camera;
}

}  // namespace darboux
