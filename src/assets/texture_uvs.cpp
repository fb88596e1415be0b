#include "assets/texture_uvs.h"

#include <cmath>

#include <darboux/placed_surface.h>

namespace darboux {

void transform_uvs(Mesh& mesh, const Primitive& primitive) {
  if (!primitive.texture_transform) return;
  const UvConvention transform{"", *primitive.texture_transform};
  const auto& m = transform.affine;
  const double area = m[0] * m[3] - m[1] * m[2];
  if (area == 0 || !std::isfinite(area)) return;
  for (Vec2<double>& uv : mesh.uvs) uv = transform.surface_uv(uv);
}

}  // namespace darboux
