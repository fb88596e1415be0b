// An instance relative to a camera.
#pragma once

#include <array>
#include <cstdint>

#include <darboux/scene.h>

#include "surface_tiles.h"
#include "view.h"

namespace darboux {

struct Placed {
  Vec3<double> eye;          // in the surface's own space; for an orthographic camera, the direction to it
  double smallest, largest;  // scale factors of the placement
  double condition;          // their ratio, 1 for a uniform scale
  Eigen::Vector3d centre;    // of the surface's sphere, in the scene
  double displacement;
  double eye_rounding;    // of `eye`
  double plane_rounding;  // of planes
  // Distance of the whole instance (with margin) outside the frustum; < 0: not outside.
  double away;
  double farthest;      // from the eye to the far side of a sphere round it
  std::uint8_t planes;  // of the frustum, those that may cut it
  double within;        // distance inside the other planes
  // The depth of P, along the view, is depth_normal · P - depth_offset.
  Vec3<double> depth_normal;
  double depth_offset;
  double least_depth;  // minimum over the instance, with margin
  // The inside is normal · P >= offset, P in the surface's own space. Only if the instance is not outside.
  std::array<Vec3<double>, 6> normals;
  std::array<double, 6> offsets;
};

// \throws ParameterError for a placement that is singular or not finite
void place(const Scene& scene, std::uint32_t instance, const SurfaceTiles& tiles, const View& view,
           Placed& result);

}  // namespace darboux
