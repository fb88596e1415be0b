#include "creases.h"

#include <limits>
#include <numbers>

#include <darboux/frame.h>

#include "mesh/area_vector.h"

namespace darboux {

bool is_sharp(const Mesh& mesh, const SharedEdge& edge) {
  const auto face = [&](std::uint32_t t) { return area_vector(mesh, mesh.triangles[t]); };
  const Vec3<double> n = face(edge.triangle[0]),
                     m = edge.turned ? -face(edge.triangle[1]) : face(edge.triangle[1]);
  // Nearly always the angle is below 45 degrees, which the cosine shows. The bound is 0 or infinite where the
  // squares under- or overflow.
  const double cosine = dot(n, m), bound = 0.5 * dot(n, n) * dot(m, m);
  if (cosine > 0 && bound > std::numeric_limits<double>::min() && cosine * cosine > bound) return false;
  const bool areas = n != Vec3<double>{} && m != Vec3<double>{} && detail::finite(n) && detail::finite(m);
  return areas && angle_between(n, m) > crease_deg * std::numbers::pi / 180;
}

}  // namespace darboux
