/// \file wrap.h
/// Which texel a texture has outside of [0, 1].
#pragma once

#include <cstdint>

#include <darboux/normal_map.h>

namespace darboux::normal_map {

/// The column (or row) that a texture of this size has at x; -1 where it is cut off.
inline std::int64_t wrapped(std::int64_t x, std::int64_t size, MapWrap wrap) {
  if (x >= 0 && x < size) return x;
  if (wrap == MapWrap::clamp) return -1;
  const std::int64_t period = wrap == MapWrap::mirror ? 2 * size : size;
  const std::int64_t m = (x % period + period) % period;
  return m < size ? m : period - 1 - m;
}

}  // namespace darboux::normal_map
