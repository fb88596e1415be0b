// How surfaces are seen in pictures: orthographic, z up, from a fixed direction.
#pragma once

#include <darboux/vector.h>

namespace darboux {

// In the picture: x to the right, y down, z towards the viewer.
using PicturePoint = Vec3<double>;

// Unit vectors of the view, of rational numbers: azimuth -53 degrees, elevation 28.
inline constexpr Vec3<double> to_right{4.0 / 5, 3.0 / 5, 0}, upward{-24.0 / 85, 32.0 / 85, 15.0 / 17},
    to_viewer{9.0 / 17, -12.0 / 17, 8.0 / 17};

// From view coordinates to the picture.
struct Projection {
  double scale = 1, x = 0, y = 0;

  PicturePoint operator()(const Vec3<double>& p) const {
    return {x + scale * dot(p, to_right), y - scale * dot(p, upward), scale * dot(p, to_viewer)};
  }
};

}  // namespace darboux
