/// \file coverage.h
/// The exact set of texels that a triangle covers.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <darboux/vector.h>

namespace darboux::normal_map {

/// The texels begin to end - 1 of a row, and the weights of the corners at the first one's centre.
struct Span {
  std::int64_t begin = 0, end = 0;
  std::array<double, 3> weights{};
};

/// A triangle in the plane of texels, with corners rounded to multiples of 2^-32. Everything below is exact
/// except the weights, whose error is a few roundings of 1.
class TexelTriangle {
 public:
  static constexpr double farthest = 1 << 22;  ///< texels from 0 that corners may lie

  /// \param corners in texels, no farther than that \returns none if it has no area
  static std::optional<TexelTriangle> of(const std::array<Vec2<double>, 3>& corners) {
    TexelTriangle result;
    for (std::size_t k = 0; k < 3; ++k) result.p_[k] = {fixed(corners[k].x), fixed(corners[k].y)};
    const Wide area = result.edge(2, result.p_[2]);
    if (area == 0) return std::nullopt;
    result.sign_ = area < 0 ? -1 : 1;
    result.area_ = std::fabs(static_cast<double>(area));
    return result;
  }

  /// Rows of texels with centres between the lowest and the highest corner: first to last - 1.
  std::array<std::int64_t, 2> rows() const {
    const auto [low, high] = std::minmax({p_[0].y, p_[1].y, p_[2].y});
    return {narrowed(-floor_divided(half - low, one)), narrowed(floor_divided(high - half, one) + 1)};
  }

  /// In texels.
  double area() const { return area_ / 2 * 0x1p-64; }

  /// The difference of the weights between adjacent texels.
  double step(std::size_t k) const {
    return -sign_ * static_cast<double>(Wide{end(k).y - start(k).y} << 32) / area_;
  }

  /// The texels of a row whose centres lie inside. A centre on an edge belongs to the side given by the
  /// edge's direction, hence to one of two triangles that share the edge in opposite directions, once both
  /// are wound alike.
  Span span(std::int64_t row) const {
    const Point first{half, row * one + half};  // the centre of column 0
    Span span{-(std::int64_t{1} << 40), std::int64_t{1} << 40, {}};
    std::array<Wide, 3> at_zero;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t dx = sign_ * (end(k).x - start(k).x), dy = sign_ * (end(k).y - start(k).y);
      at_zero[k] = sign_ * edge(k, first);
      // at_zero - x dy 2^32 >= least
      const Wide least = dy > 0 || (dy == 0 && dx < 0) ? 0 : 1, rest = at_zero[k] - least;
      const Wide slope = Wide{dy} << 32;
      if (dy > 0)
        span.end = std::min(span.end, narrowed(floor_divided(rest, slope)) + 1);
      else if (dy < 0)
        span.begin = std::max(span.begin, narrowed(-floor_divided(rest, -slope)));
      else if (rest < 0)
        return {};
    }
    if (span.begin >= span.end) return {};
    for (std::size_t k = 0; k < 3; ++k)
      span.weights[k] =
          static_cast<double>(at_zero[k] - Wide{span.begin} * (Wide{sign_ * (end(k).y - start(k).y)} << 32)) /
          area_;
    return span;
  }

 private:
  __extension__ using Wide = __int128;
  struct Point {
    std::int64_t x, y;
  };
  static constexpr std::int64_t one = std::int64_t{1} << 32, half = one / 2;

  static std::int64_t fixed(double texels) {
    return static_cast<std::int64_t>(std::nearbyint(texels * 0x1p32));
  }
  static Wide floor_divided(Wide a, Wide b) {  // b > 0
    return a / b - (a % b < 0 ? 1 : 0);
  }
  static std::int64_t narrowed(Wide a) {
    constexpr Wide most = std::int64_t{1} << 40;
    return static_cast<std::int64_t>(a > most ? most : a < -most ? -most : a);
  }
  // The edge against corner k.
  const Point& start(std::size_t k) const { return p_[(k + 1) % 3]; }
  const Point& end(std::size_t k) const { return p_[(k + 2) % 3]; }
  // Twice the area of the edge against corner k and a point.
  Wide edge(std::size_t k, const Point& at) const {
    const Point &a = start(k), &b = end(k);
    return Wide{b.x - a.x} * (at.y - a.y) - Wide{b.y - a.y} * (at.x - a.x);
  }

  std::array<Point, 3> p_;
  int sign_ = 1;     // of its winding
  double area_ = 0;  // twice it, in units of 2^-64
};

}  // namespace darboux::normal_map
