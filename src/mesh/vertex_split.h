/// \file vertex_split.h
/// Adds vertices for corners whose values differ from those of their vertex.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <darboux/error.h>
#include <darboux/split_vertices.h>

#include "base/text.h"

namespace darboux {

/// Adds new vertices for some corners, as split_vertices() does, to a split that has none yet. \param others
/// these corners \param compare compares the values of two corners, as memcmp() does
template <class Compare>
void split_off(SplitVertices& split, std::span<const std::uint32_t> corners,
               std::vector<std::uint32_t> others, const Compare& compare) {
  std::sort(others.begin(), others.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (corners[a] != corners[b]) return corners[a] < corners[b];
    const int order = compare(a, b);
    return order != 0 ? order < 0 : a < b;
  });
  const auto is_new = [&](std::size_t i) {
    return i == 0 || corners[others[i - 1]] != corners[others[i]] || compare(others[i - 1], others[i]) != 0;
  };
  std::vector<std::uint32_t> news;  // the first corners of new vertices
  for (std::size_t i = 0; i < others.size(); ++i)
    if (is_new(i)) news.push_back(others[i]);
  std::sort(news.begin(), news.end());
  const std::size_t vertices = split.source.size();
  if (vertices + news.size() >= SplitVertices::no_corner)
    throw MeshError("split_vertices", expected_got("fewer than 2^32 - 1 vertices", "more after the split"));
  for (std::size_t k = 0; k < news.size(); ++k) {
    split.source.push_back(corners[news[k]]);
    split.corner.push_back(news[k]);
    split.indices[news[k]] = static_cast<std::uint32_t>(vertices + k);
  }
  for (std::size_t i = 0; i < others.size(); ++i)
    if (!is_new(i)) split.indices[others[i]] = split.indices[others[i - 1]];
}

}  // namespace darboux
