#include "input.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <mutex>
#include <string>

#include <darboux/error.h>

#include "base/pieces.h"
#include "base/text.h"

namespace darboux::mikk {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw MeshError("mesh", why);
}

constexpr std::size_t most_corners = std::numeric_limits<std::uint32_t>::max() / 3;

void check_sizes(const MikkMesh& mesh) {
  const std::size_t n = mesh.positions.size() / 3;
  if (mesh.positions.size() % 3 != 0)
    refuse("has " + std::to_string(mesh.positions.size()) +
           " numbers of positions, permitted are three a vertex");
  if (mesh.normals.size() != 3 * n)
    refuse("has " + std::to_string(mesh.normals.size()) +
           " numbers of normals, permitted are three for each of its " + std::to_string(n) + " vertices");
  if (mesh.uvs.size() != 2 * n)
    refuse("has " + std::to_string(mesh.uvs.size()) + " numbers of uvs, permitted are two for each of its " +
           std::to_string(n) + " vertices");
  const std::size_t corners = mesh.corner_count();
  if (n >= most_corners)
    refuse("has " + std::to_string(n) + " vertices, permitted are up to " + std::to_string(most_corners - 1));
  if (corners >= most_corners)
    refuse("has " + std::to_string(corners) + " corners, permitted are up to " +
           std::to_string(most_corners - 1));
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    if (mesh.corners[c] >= n)
      refuse("corner " + std::to_string(c) + " is vertex " + std::to_string(mesh.corners[c]) +
             ", permitted are " + (n == 0 ? "none: there are no vertices" : "0 to " + std::to_string(n - 1)));
  std::size_t sum = 0;
  for (std::size_t f = 0; f < mesh.face_sizes.size(); ++f) {
    if (mesh.face_sizes[f] != 3 && mesh.face_sizes[f] != 4)
      refuse("face " + std::to_string(f) + " has " + std::to_string(mesh.face_sizes[f]) +
             " corners, permitted are 3 and 4");
    sum += mesh.face_sizes[f];
  }
  if (mesh.face_sizes.empty() ? corners % 3 != 0 : sum != corners)
    refuse("has " + std::to_string(corners) + " corners, permitted are those of its faces, " +
           (mesh.face_sizes.empty() ? "three each" : std::to_string(sum)));
}

void check(const MikkOptions& options) {
  if (options.threads < 0)
    throw ParameterError("threads",
                         std::to_string(options.threads) + " threads, permitted is 0 (all) or more");
  if (!(options.angular_threshold >= 0 && options.angular_threshold <= 180))
    throw ParameterError("angular threshold",
                         std::to_string(options.angular_threshold) + " degrees, permitted are 0 to 180");
}

// The bits of a magnitude grow with it; those of infinity and NaN are the greatest.
std::uint32_t magnitude_bits(float x) {
  return std::bit_cast<std::uint32_t>(x) & 0x7fffffffU;
}

float greatest_magnitude(std::span<const float> x, int threads) {
  std::mutex mutex;
  std::uint32_t greatest = 0;
  in_pieces(x.size(), thread_count(threads), [&](std::size_t begin, std::size_t end) {
    std::uint32_t here = 0;
    for (std::size_t i = begin; i < end; ++i) here = std::max(here, magnitude_bits(x[i]));
    const std::lock_guard lock(mutex);
    greatest = std::max(greatest, here);
  });
  return std::bit_cast<float>(greatest);
}

// The greatest number of an attribute, which may not be above `most`.
float check(const char* name, std::span<const float> x, std::size_t components, float most, int threads) {
  const float greatest = greatest_magnitude(x, threads);
  if (magnitude_bits(greatest) <= magnitude_bits(most)) return greatest;
  std::size_t i = 0;
  while (magnitude_bits(x[i]) <= magnitude_bits(most)) ++i;
  refuse(std::string(name) + " of vertex " + std::to_string(i / components) + " has the component " +
         shortest(static_cast<double>(x[i])) + ", permitted are magnitudes up to " +
         shortest(static_cast<double>(most)));
}

constexpr float large = 0x1p28F;

}  // namespace

Range check(const MikkMesh& mesh, const MikkOptions& options) {
  constexpr float most = std::numeric_limits<float>::max(), longest_normal = large;
  check(options);
  check_sizes(mesh);
  const float position = check("position", mesh.positions, 3, most, options.threads);
  check("normal", mesh.normals, 3, longest_normal, options.threads);
  const float uv = check("uv", mesh.uvs, 2, most, options.threads);
  const auto ordinary = [](float greatest) {
    return greatest == 0 || (greatest <= large && greatest >= 1 / large);
  };
  return {!ordinary(position) || !ordinary(uv), position > large, uv > large};
}

}  // namespace darboux::mikk
