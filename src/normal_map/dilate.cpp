#include "normal_map/dilate.h"

#include <cstdint>

#include "normal_map/texels.h"

namespace darboux::normal_map {
namespace {

// The neighbours of texels, direct ones first.
class Neighbours {
 public:
  Neighbours(const Image& image, std::array<bool, 2> wraps)
      : width_(image.width), height_(image.height), wraps_(wraps) {}

  // f(texel) for each, until it returns true.
  template <class F>
  void of(std::size_t texel, const F& f) const {
    constexpr std::array<std::array<int, 2>, 8> steps{
        {{0, -1}, {-1, 0}, {1, 0}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    const auto at = static_cast<std::int64_t>(texel);
    for (const auto& [dx, dy] : steps) {
      const std::int64_t x = moved(at % width_, dx, width_, wraps_[0]);
      const std::int64_t y = moved(at / width_, dy, height_, wraps_[1]);
      if (x >= 0 && y >= 0 && f(static_cast<std::size_t>(y * width_ + x))) return;
    }
  }

 private:
  static std::int64_t moved(std::int64_t x, int step, std::int64_t size, bool wraps) {
    x += step;
    if (x >= 0 && x < size) return x;
    return wraps ? (x + size) % size : -1;
  }
  std::int64_t width_, height_;
  std::array<bool, 2> wraps_;
};

}  // namespace

std::size_t dilate(Image& image, std::vector<TexelState>& states, int steps, std::array<bool, 2> wraps) {
  const TexelAccess access(image);
  const Neighbours neighbours(image, wraps);
  const auto filled = [&](std::size_t texel) {
    return states[texel] == TexelState::covered || states[texel] == TexelState::dilated;
  };
  std::size_t count = 0;
  // Empty texels next to a filled one, each with that one.
  std::vector<std::array<std::size_t, 2>> ring, next;
  std::vector<bool> listed(states.size());
  const auto list = [&](std::size_t texel) {
    if (states[texel] != TexelState::empty || listed[texel]) return;
    neighbours.of(texel, [&](std::size_t from) {
      if (!filled(from)) return false;
      listed[texel] = true;
      next.push_back({texel, from});
      return true;
    });
  };
  for (std::size_t texel = 0; texel < states.size(); ++texel) list(texel);
  for (int step = 0; step < steps && !next.empty(); ++step) {
    ring.swap(next);
    next.clear();
    for (const auto& [texel, from] : ring) {
      states[texel] = TexelState::dilated;
      access.set(texel, access.get(from));
    }
    count += ring.size();
    for (const auto& [texel, from] : ring)
      neighbours.of(texel, [&](std::size_t beside) {
        list(beside);
        return false;
      });
  }
  return count;
}

}  // namespace darboux::normal_map
