#include "input.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <mutex>
#include <string>

#include <darboux/error.h>

#include "base/parallel.h"
#include "base/text.h"

namespace darboux::mikk {
namespace {

[[noreturn]] void refuse(const std::string& expected, const std::string& got) {
  throw MeshError("mesh", expected_got(expected, got));
}

constexpr std::size_t most_corners = std::numeric_limits<std::uint32_t>::max() / 3;

void check_sizes(const MikkMesh& mesh) {
  const std::size_t n = mesh.positions.size() / 3;
  if (mesh.positions.size() % 3 != 0)
    refuse("three numbers per position", std::to_string(mesh.positions.size()) + " numbers");
  if (mesh.normals.size() != 3 * n)
    refuse("three numbers for the normal of each of its " + std::to_string(n) + " vertices",
           std::to_string(mesh.normals.size()) + " numbers");
  if (mesh.uvs.size() != 2 * n)
    refuse("two numbers for the uv of each of its " + std::to_string(n) + " vertices",
           std::to_string(mesh.uvs.size()) + " numbers");
  const std::size_t corners = mesh.corner_count();
  if (n >= most_corners)
    refuse("at most " + std::to_string(most_corners - 1) + " vertices", std::to_string(n));
  if (corners >= most_corners)
    refuse("at most " + std::to_string(most_corners - 1) + " corners", std::to_string(corners));
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    if (mesh.corners[c] >= n)
      refuse("vertices below " + std::to_string(n),
             "vertex " + std::to_string(mesh.corners[c]) + " at corner " + std::to_string(c));
  std::size_t sum = 0;
  for (std::size_t f = 0; f < mesh.face_sizes.size(); ++f) {
    if (mesh.face_sizes[f] != 3 && mesh.face_sizes[f] != 4)
      refuse("faces of 3 or 4 corners", std::to_string(mesh.face_sizes[f]) + " in face " + std::to_string(f));
    sum += mesh.face_sizes[f];
  }
  if (mesh.face_sizes.empty() ? corners % 3 != 0 : sum != corners)
    refuse(mesh.face_sizes.empty() ? "three corners per face"
                                   : "the " + std::to_string(sum) + " corners of its faces",
           std::to_string(corners) + " corners");
}

void check(const MikkOptions& options) {
  if (options.threads < 0)
    throw ParameterError("threads", expected_got("0 (all) or more", std::to_string(options.threads)));
  if (!(options.angular_threshold >= 0 && options.angular_threshold <= 180))
    throw ParameterError("angular threshold",
                         expected_got("0 <= degrees <= 180", std::to_string(options.angular_threshold)));
}

// The bits of a magnitude increase with it; those of infinity and NaN are the largest. Signed, as lanes
// compare signed.
std::int32_t magnitude_bits(float x) {
  return std::bit_cast<std::int32_t>(x) & 0x7fffffff;
}

float greatest_magnitude(std::span<const float> x, int threads) {
  std::mutex mutex;
  std::int32_t greatest = 0;
  parallel_ranges(x.size(), thread_count(threads), [&](std::size_t begin, std::size_t end) {
    std::array<std::int32_t, 16> here{};  // none waits for another
    const auto take = [&](std::size_t i, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k) here[k] = std::max(here[k], magnitude_bits(x[i + k]));
    };
    std::size_t i = begin;
    for (; i + here.size() <= end; i += here.size()) take(i, here.size());
    take(i, end - i);
    const std::lock_guard lock(mutex);
    greatest = std::max(greatest, *std::max_element(here.begin(), here.end()));
  });
  return std::bit_cast<float>(greatest);
}

// The greatest magnitude of an attribute; throws if it is above `most`.
float check(const char* name, std::span<const float> x, std::size_t components, float most, int threads) {
  const float greatest = greatest_magnitude(x, threads);
  if (magnitude_bits(greatest) <= magnitude_bits(most)) return greatest;
  std::size_t i = 0;
  while (magnitude_bits(x[i]) <= magnitude_bits(most)) ++i;
  refuse("magnitudes up to " + shortest(static_cast<double>(most)), shortest(static_cast<double>(x[i])) +
                                                                        " in the " + name + " of vertex " +
                                                                        std::to_string(i / components));
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
