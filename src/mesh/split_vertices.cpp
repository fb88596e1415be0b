#include <cstring>
#include <numeric>
#include <string>
#include <utility>

#include <darboux/error.h>
#include <darboux/split_vertices.h>

#include "base/text.h"
#include "vertex_split.h"

namespace darboux {
namespace {

constexpr std::uint32_t none = SplitVertices::no_corner;

void check_arguments(std::size_t vertices, std::span<const std::uint32_t> corners,
                     std::span<const float> values) {
  if (vertices >= none || corners.size() >= none)
    throw MeshError("split_vertices", expected_got("fewer than 2^32 - 1 vertices and corners",
                                                   std::to_string(vertices) + " vertices and " +
                                                       std::to_string(corners.size()) + " corners"));
  if (values.size() != 0 && (corners.empty() || values.size() % corners.size() != 0))
    throw MeshError("split_vertices", expected_got("the same number of values for each of " +
                                                       std::to_string(corners.size()) + " corners",
                                                   std::to_string(values.size()) + " values"));
  for (std::size_t c = 0; c < corners.size(); ++c)
    if (corners[c] >= vertices)
      throw MeshError("split_vertices", "corner " + std::to_string(c) + ": " +
                                            expected_got("a vertex below " + std::to_string(vertices),
                                                         std::to_string(corners[c])));
}

}  // namespace

SplitVertices split_vertices(std::size_t vertices, std::span<const std::uint32_t> corners,
                             std::span<const float> values) {
  check_arguments(vertices, corners, values);
  const std::size_t bytes = corners.empty() ? 0 : values.size() / corners.size() * sizeof(float);
  const auto* data = reinterpret_cast<const char*>(values.data());
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    return bytes == 0 ? 0 : std::memcmp(data + a * bytes, data + b * bytes, bytes);
  };

  SplitVertices result;
  result.source.resize(vertices);
  std::iota(result.source.begin(), result.source.end(), 0U);
  result.corner.assign(vertices, none);
  result.indices.assign(corners.begin(), corners.end());
  std::vector<std::uint32_t> others;
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    std::uint32_t& first = result.corner[corners[c]];
    if (first == none)
      first = c;
    else if (compare(first, c) != 0)
      others.push_back(c);
  }
  if (!others.empty()) split_off(result, corners, std::move(others), compare);
  return result;
}

}  // namespace darboux
