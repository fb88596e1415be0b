/// \file rasterise.h
/// A small software rasteriser for triangles. Everything is computed in double, one triangle after the other:
/// the same triangles give the same picture, bit for bit, and adding triangles that are hidden, off screen or
/// back-facing changes nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <darboux/scene.h>
#include <darboux/vector.h>

namespace darboux {

/// A vertex, in scene space. A normal or tangent that is zero or not finite counts as missing; those of the
/// other corners are used.
struct PictureVertex {
  Vec3<double> position, normal;
  Vec4<double> tangent{};  ///< w in the convention of glTF
  Vec2<double> uv{};
};

struct PictureMaterial {
  Vec3<double> colour{0.6, 0.6, 0.6};  ///< linear, 0 to 1
  /// The texel of a normal map at uv; none: light falls on the interpolated normal. See bump().
  std::function<Vec3<double>(const Vec2<double>& uv)> normal_map{};
  bool object_space = false;  ///< the texel is a direction in the scene's space, not in the frame
  bool double_sided = false;
};

/// Rows from the top; red, green, blue.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// A normal map of round bumps, 16 along u and v each: the texel (x, y, z) at uv, of unit length, y against v
/// as glTF's images have it. A wave of + - * / alone, so that every machine has the same bits.
Vec3<double> bump(const Vec2<double>& uv);

/// Draws triangles for one camera.
///
/// Coverage: a pixel has one sample, in its centre. The sign of every edge function is exact, and a centre on
/// an edge belongs to the triangle on its right, or below it (the top-left rule): triangles that share an
/// edge, or meet in a vertex, cover each centre exactly once. Nothing is clipped: the edge functions are
/// those of the homogeneous coordinates [Olano1997], which know no plane behind the eye, and near and far are
/// tested where a pixel is drawn.
///
/// Depth: the nearest triangle wins; of equals, the one with the lower order, then the one added first.
///
/// Facing: single-sided triangles are drawn where n · (eye - P), interpolated from the corners, is positive.
/// So a tile whose corners all face away is not drawn at all, although some of its triangles may face the
/// eye.
///
/// Colour: position, t, b, n and uv are interpolated linearly in space, t, b and n are normalised, and light
/// falls on n' = t x + b y + n z, where (x, y, z) is the texel of the normal map, (0, 0, 1) without one. An
/// object-space map gives n' = (x, y, z) directly.
class Rasteriser {
 public:
  /// \throws ParameterError as Camera::check(), and for more than 2^26 pixels
  explicit Rasteriser(const Camera& camera);

  /// \param indices three per triangle, into `vertices`
  /// \param order of several triangles at the same depth, the one with the lower order is visible
  void add(std::span<const PictureVertex> vertices, std::span<const std::uint32_t> indices,
           const PictureMaterial& material, std::uint64_t order = 0);

  /// The picture so far, on a white background.
  const Picture& picture() const { return picture_; }
  /// The distance along the view of what a pixel shows, infinite for the background.
  double depth(int x, int y) const { return depth_[index(x, y)]; }

 private:
  struct Corner {
    Vec3<double> at;  // in pixels, times the third
    double depth;
    double facing;  // NaN without a normal
    Vec3<double> position, n, t, b;
    Vec2<double> uv;
  };
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width) +
           static_cast<std::size_t>(x);
  }
  Corner corner(const PictureVertex& v) const;
  void draw(const Corner& a, const Corner& b, const Corner& c, const PictureMaterial& material,
            std::uint64_t order);
  Vec3<double> shade(const Corner* const (&corners)[3], const double (&weights)[3], bool from_behind,
                     const PictureMaterial& material) const;

  bool perspective_;
  double scale_;  // pixels per length, of a perspective camera at distance 1
  double near_, far_;
  Vec3<double> eye_, right_, up_, back_, to_light_;
  Picture picture_;
  std::vector<double> depth_;
  std::vector<std::uint64_t> order_;
  std::vector<Corner> corners_;
};

/// The picture as a PNG.
std::string png_of(const Picture& picture);

}  // namespace darboux
