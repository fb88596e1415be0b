// The local shape of a fitted surface about one of its points. It gives starts for other kinds: a kind that
// random samples missed may be found from another kind's shape.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry.h"

namespace darboux::fit {

struct Osculation {
  Vector3d at;                       // on the surface
  Matrix3d frame;                    // the principal directions, and a normal
  std::array<double, 2> curvatures;  // along them, positive where the centre lies along that normal
  Circle3 circle;                    // of the inliers

  bool is_strip() const { return circle.deviation < 0.2 * (at - circle.centre).norm(); }
};

// Principal curvatures from differences of the normals of a model, accurate to 1e-3, for starts. None if the
// surface has none. \param near the result is for the foot of this point
std::optional<Osculation> osculation(const Primitive& primitive, const LocalModel& model,
                                     const Vector3d& near, const Circle3& circle);

}  // namespace darboux::fit
