// An instance before a camera.
#pragma once

#include <array>
#include <cstdint>

#include <darboux/scene.h>

#include "surface_tiles.h"
#include "view.h"

namespace darboux {

struct Placed {
  Vec3<double> eye;          // in the surface's own space; of an orthographic camera the direction to it
  double smallest, largest;  // by what the placement scales lengths
  double condition;          // their ratio, 1 where it scales all alike
  Eigen::Vector3d centre;    // of the surface's sphere, in the scene
  double displacement;
  double eye_rounding;    // of `eye`
  double plane_rounding;  // of planes
  double away;            // how far all of it, with what surrounds it, is outside the frustum; < 0: it is not
  double farthest;        // from the eye to the far side of a sphere round it
  std::uint8_t planes;    // of the frustum, those that may cut it
  double within;          // how far it is within the others
  // The depth of P, along the view, is depth_normal · P - depth_offset.
  Vec3<double> depth_normal;
  double depth_offset;
  double least_depth;  // of all of it, with what surrounds it
  // Where normal · P >= offset is inside, P in the surface's own space. Only of what is not away.
  std::array<Vec3<double>, 6> normals;
  std::array<double, 6> offsets;
};

// \throws ParameterError for a placement that is singular or not finite
void place(const Scene& scene, std::uint32_t instance, const SurfaceTiles& tiles, const View& view,
           Placed& result);

}  // namespace darboux
