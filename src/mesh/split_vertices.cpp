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
  std::vector<bool> differs(vertices);  // whether corners there have other values than the first
  bool any_differs = false;
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    std::uint32_t& first = result.corner[corners[c]];
    if (first == none) first = c;
    if (!differs[corners[c]] && compare(first, c) != 0) any_differs = differs[corners[c]] = true;
  }
  if (!any_differs) return result;

  std::vector<std::uint32_t> sorted;
  for (std::uint32_t c = 0; c < corners.size(); ++c)
    if (differs[corners[c]]) sorted.push_back(c);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (corners[a] != corners[b]) return corners[a] < corners[b];
    const int order = compare(a, b);
    return order != 0 ? order < 0 : a < b;
  });
  const auto equal = [&](std::uint32_t a, std::uint32_t b) {
    return corners[a] == corners[b] && compare(a, b) == 0;
  };
  std::vector<std::uint32_t> news;  // the first corners of new vertices
  for (std::size_t i = 0; i < sorted.size(); ++i)
    if (const std::uint32_t c = sorted[i];
        (i == 0 || !equal(sorted[i - 1], c)) && result.corner[corners[c]] != c)
      news.push_back(c);
  std::sort(news.begin(), news.end());
  if (vertices + news.size() >= none)
    throw MeshError("split_vertices", expected_got("fewer than 2^32 - 1 vertices", "more after the split"));
  for (std::size_t k = 0; k < news.size(); ++k) {
    result.source.push_back(corners[news[k]]);
    result.corner.push_back(news[k]);
    result.indices[news[k]] = static_cast<std::uint32_t>(vertices + k);
  }
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (equal(sorted[i - 1], sorted[i])) result.indices[sorted[i]] = result.indices[sorted[i - 1]];
  return result;
}

}  // namespace darboux
