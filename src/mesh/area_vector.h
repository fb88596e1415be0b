#pragma once

#include <darboux/mesh.h>
#include <darboux/vector.h>

namespace darboux {

// A vector along the normal of a triangle's winding; its length is twice the area.
inline Vec3<double> area_vector(const Mesh& mesh, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
}

}  // namespace darboux
