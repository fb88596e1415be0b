/// \file second_normal_map.h
/// A second implementation of normal maps, texel by texel and with no regard for speed: rational numbers
/// decide whether a triangle covers a texel, Eigen's solvers give weights and inverses, in another order.
#pragma once

#include <array>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <darboux/mesh_frames.h>
#include <darboux/normal_map.h>

namespace darboux::test {

inline Eigen::Vector3d eigen(const Vec3<double>& a) {
  return {a.x, a.y, a.z};
}

inline double code_at(const Image& image, std::size_t sample) {
  return std::visit([&](const auto& s) { return static_cast<double>(s[sample]); }, image.samples);
}

/// The frame that a triangle has at a texel.
struct SecondFrame {
  std::size_t triangle = 0;
  Eigen::Matrix3d columns;  // t, b, n
  double condition() const;
};

class SecondNormalMap {
 public:
  /// \param tangents of each corner, and whether b points up the image with w
  SecondNormalMap(const MapPiece& piece, const NormalMapOptions& options, int width, int height);

  /// All frames of triangles that cover a texel of a map whose uvs stay within it.
  std::vector<SecondFrame> frames(int x, int y) const;

  /// The numbers of a texel, x, y, z, before they are rounded.
  Eigen::Vector3d convert(const Eigen::Vector3d& codes, double most, const Eigen::Matrix3d& m) const;

 private:
  std::array<std::array<double, 2>, 3> corners(std::size_t i) const;
  bool covers(std::size_t i, int x, int y) const;
  Eigen::Matrix3d frame(std::size_t i, int x, int y) const;

  const MapPiece& piece_;
  NormalMapOptions options_;
  int width_, height_;
  MeshFrames frames_;
};

/// How the codes of a map return from another space and back. A channel may be off by ceil(0.87 c + 1/2) - 1
/// codes, c the condition of the texel's frame (docs/theory/normal-maps.md); texels with c > 10 are counted
/// apart.
struct Returned {
  std::size_t texels = 0, wrong = 0, above_10 = 0, orthonormal = 0;
};

Returned returned(const Image& map, const NormalMapResult& there, const Image& back,
                  const SecondNormalMap& second);

}  // namespace darboux::test
