/// \file split_vertices.h
/// Converts values per corner, such as tangents, to values per vertex by splitting vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace darboux {

/// The result of splitting: all corners of a new vertex have the same values.
struct SplitVertices {
  /// The value of `corner` for a vertex that no corner uses.
  static constexpr std::uint32_t no_corner = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> source;  ///< new vertex i has the attributes of old vertex source[i]
  std::vector<std::uint32_t> corner;  ///< the first corner at new vertex i, whose values it has, or no_corner
  std::vector<std::uint32_t> indices;  ///< the new vertex of each corner: the new index buffer
};

/// Splits vertices where values of their corners differ, so that tangents computed per corner can be stored
/// per vertex.
///
/// Corners at one vertex can have different tangents: at a seam, a mirror fold or a crease. Do not write them
/// through the old index buffer, tangents[indices[c]] = t[c]: the last corner wins, and the others are shaded
/// with a tangent of the wrong island, often with the wrong sign. Such vertices must be split, and the index
/// buffer adapted.
///
/// Old vertices keep their index, source[i] = i for i < vertices, whether used or not. A vertex keeps the
/// values of its first corner; every further distinct list of values creates one new vertex, in the order of
/// corners. So nothing changes if nothing differs. Values are compared by their bits: 0 and -0 differ, and a
/// NaN equals a NaN of the same bits.
///
/// \param vertices the number of old vertices \param corners the vertex of each corner: the old index buffer
/// \param values the same number of values per corner, corner after corner: say x, y, z and w of its tangent,
/// then the deltas of morph targets; empty: nothing is split. Cost: linear, and m log m of the m corners at
/// vertices that are split, whatever the values. \throws MeshError when a corner names no vertex, values
/// cannot be shared out evenly, or there would be 2^32 - 1 vertices or more
SplitVertices split_vertices(std::size_t vertices, std::span<const std::uint32_t> corners,
                             std::span<const float> values);

}  // namespace darboux
