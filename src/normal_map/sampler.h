/// \file sampler.h
/// Samples maps between texels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <darboux/normal_map.h>

#include "normal_map/texels.h"
#include "normal_map/wrap.h"

namespace darboux::normal_map {

/// Samples a map as a renderer does.
class Sampler {
 public:
  /// \param green of a tangent-space map; opengl: y is as it is. The map outlives it.
  Sampler(const Image& map, const MapPiece& piece, bool signed_floats, MapGreen green)
      : access_(map),
        coding_(map.type(), signed_floats),
        width_(map.width),
        height_(map.height),
        wrap_(piece.wrap),
        v_up_(piece.v_up),
        green_(green == MapGreen::directx ? -1 : 1) {}

  /// Bilinear interpolation between the four texels around uv, y up the image.
  Vec3<double> at(const Vec2<double>& uv) const {
    const double x = uv.x * static_cast<double>(width_) - 0.5;
    const double y = (v_up_ ? 1 - uv.y : uv.y) * static_cast<double>(height_) - 0.5;
    const double x0 = std::floor(x), y0 = std::floor(y), a = x - x0, b = y - y0;
    const auto i = static_cast<std::int64_t>(x0), j = static_cast<std::int64_t>(y0);
    Vec3<double> sum = (1 - b) * ((1 - a) * texel(i, j) + a * texel(i + 1, j)) +
                       b * ((1 - a) * texel(i, j + 1) + a * texel(i + 1, j + 1));
    sum.y *= green_;
    return sum;
  }

 private:
  Vec3<double> texel(std::int64_t x, std::int64_t y) const {
    const auto place = [](std::int64_t k, std::int64_t size, MapWrap wrap) {
      return wrap == MapWrap::clamp ? std::clamp<std::int64_t>(k, 0, size - 1) : wrapped(k, size, wrap);
    };
    return coding_.numbers(access_.get(
        static_cast<std::size_t>(place(y, height_, wrap_[1]) * width_ + place(x, width_, wrap_[0]))));
  }
  TexelAccess<const Image> access_;
  Coding coding_;
  std::int64_t width_, height_;
  std::array<MapWrap, 2> wrap_;
  bool v_up_;
  double green_;
};

}  // namespace darboux::normal_map
