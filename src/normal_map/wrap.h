/// \file wrap.h
/// Wrapping of texture coordinates outside [0, 1].
#pragma once

#include <cstdint>

#include <darboux/normal_map.h>

namespace darboux::normal_map {

/// The column (or row) at x for a texture of this size; -1 if x is outside and wrap is clamp.
inline std::int64_t wrapped(std::int64_t x, std::int64_t size, MapWrap wrap) {
  if (x >= 0 && x < size) return x;
  if (wrap == MapWrap::clamp) return -1;
  const std::int64_t period = wrap == MapWrap::mirror ? 2 * size : size;
  const std::int64_t m = (x % period + period) % period;
  return m < size ? m : period - 1 - m;
}

}  // namespace darboux::normal_map
