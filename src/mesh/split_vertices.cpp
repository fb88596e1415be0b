#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>

#include <darboux/error.h>
#include <darboux/split_vertices.h>

#include "base/text.h"

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

// The corners, those of one vertex together and in order.
std::vector<std::uint32_t> sort_by_vertex(std::size_t vertices, std::span<const std::uint32_t> corners) {
  std::vector<std::uint32_t> next(vertices + 1, 0);
  for (const std::uint32_t v : corners) ++next[v + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::uint32_t> sorted(corners.size());
  for (std::uint32_t c = 0; c < corners.size(); ++c) sorted[next[corners[c]]++] = c;
  return sorted;
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

  // The first corner at the same vertex with the same values.
  std::vector<std::uint32_t> first(corners.size());
  std::vector<std::uint32_t> sorted = sort_by_vertex(vertices, corners);
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    while (end < sorted.size() && corners[sorted[end]] == corners[sorted[begin]]) ++end;
    std::sort(sorted.data() + begin, sorted.data() + end, [&](std::uint32_t a, std::uint32_t b) {
      const int order = compare(a, b);
      return order != 0 ? order < 0 : a < b;
    });
    for (std::size_t i = begin; i < end; ++i)
      first[sorted[i]] =
          i > begin && compare(sorted[i - 1], sorted[i]) == 0 ? first[sorted[i - 1]] : sorted[i];
  }

  SplitVertices result;
  result.source.resize(vertices);
  std::iota(result.source.begin(), result.source.end(), 0U);
  result.corner.assign(vertices, none);
  result.indices.resize(corners.size());
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t v = corners[c];
    if (first[c] != c) {
      result.indices[c] = result.indices[first[c]];
    } else if (result.corner[v] == none) {
      result.corner[v] = c;
      result.indices[c] = v;
    } else {
      if (result.source.size() + 1 >= none)
        throw MeshError("split_vertices",
                        expected_got("fewer than 2^32 - 1 vertices", "more after the split"));
      result.indices[c] = static_cast<std::uint32_t>(result.source.size());
      result.source.push_back(v);
      result.corner.push_back(c);
    }
  }
  return result;
}

}  // namespace darboux
