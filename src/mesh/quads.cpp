#include "quads.h"

#include <algorithm>

namespace darboux {

std::optional<std::array<std::uint32_t, 4>> quad_of(const Triangle& x, const Triangle& y) {
  std::array<std::uint32_t, 4> quad;
  if (x[0] == y[0] && x[2] == y[1])
    quad = {x[0], x[1], x[2], y[2]};
  else if (x[1] == y[0] && x[2] == y[2])
    quad = {x[0], x[1], y[1], x[2]};
  else
    return std::nullopt;
  auto sorted = quad;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return std::nullopt;
  return quad;
}

}  // namespace darboux
