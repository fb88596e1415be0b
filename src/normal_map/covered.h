/// \file covered.h
/// The texels of a whole piece.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include <darboux/error.h>
#include <darboux/normal_map.h>

#include "base/text.h"
#include "normal_map/coverage.h"
#include "normal_map/wrap.h"

namespace darboux::normal_map {

inline std::string name_of(const MapPiece& piece) {
  return "mesh " + std::to_string(piece.mesh_index) + " primitive " + std::to_string(piece.primitive);
}

/// A triangle of a piece in texels; none if it has no area. \throws MeshError for uvs too far out
inline std::optional<TexelTriangle> texel_triangle(const MapPiece& piece, std::size_t triangle, int width,
                                                   int height) {
  std::array<Vec2<double>, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2<double>& uv = piece.mesh.uvs[piece.mesh.triangles[triangle][k]];
    corners[k] = {uv.x * width, (piece.v_up ? 1 - uv.y : uv.y) * height};
    if (!(std::fabs(corners[k].x) <= TexelTriangle::farthest) ||
        !(std::fabs(corners[k].y) <= TexelTriangle::farthest))
      throw MeshError(name_of(piece), expected_got("uvs within 2^22 texels",
                                                   "(" + shortest(uv.x) + ", " + shortest(uv.y) + ")"));
  }
  return TexelTriangle::of(corners);
}

/// The total of texels and rows that triangles cover, and its limit for a map.
class Work {
 public:
  void add(const TexelTriangle& triangle) {
    const auto [first, last] = triangle.rows();
    done_ += triangle.area() + static_cast<double>(last - first);
    ++triangles_;
  }
  /// \throws MeshError if it is too much
  void check(std::size_t texels) const {
    if (done_ > 64.0 * static_cast<double>(texels) + 16.0 * triangles_ + 0x1p22)
      throw MeshError("map", expected_got("uvs that cover the map at most 64 times",
                                          rounded(done_ / static_cast<double>(texels), 3) + " times"));
  }

 private:
  double done_ = 0, triangles_ = 0;
};

}  // namespace darboux::normal_map
