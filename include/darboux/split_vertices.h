/// \file split_vertices.h
/// Values of corners, tangents above all, as values of vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace darboux {

/// Vertices so split that all corners of each have the same values.
struct SplitVertices {
  /// What `corner` says of a vertex that no corner uses.
  static constexpr std::uint32_t no_corner = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> source;  ///< new vertex i has the attributes of old vertex source[i]
  std::vector<std::uint32_t> corner;  ///< the first corner at new vertex i, whose values it has, or no_corner
  std::vector<std::uint32_t> indices;  ///< the new vertex of each corner: the new index buffer
};

/// Splits vertices where values of their corners differ, so that a method that gives every corner a tangent
/// of its own can be stored one per vertex.
///
/// Corners at one vertex need not have one tangent: at a seam, a mirror fold or a crease they have several.
/// Writing them through the old index buffer, tangents[indices[c]] = t[c], is a trap: the last corner written
/// wins, and the others are shaded with a tangent of the wrong island, often of the wrong sign. Such vertices
/// must be split, and the index buffer with them.
///
/// Old vertices keep their place, source[i] = i for i < vertices, used or not. The values of a vertex's first
/// corner stay with it; every further distinct list of values makes one new vertex, in the order of corners.
/// So nothing changes where nothing differs. Values are compared by their bits: 0 and -0 differ, and a NaN
/// equals a NaN of the same bits.
///
/// \param vertices how many there are \param corners the vertex of each corner: the old index buffer
/// \param values the same number of values per corner, corner after corner: say x, y, z and w of its tangent,
/// then the deltas of morph targets; empty: nothing is split. Cost: linear, and m log m of the m corners at
/// vertices that are split, whatever the values. \throws MeshError when a corner names no vertex, values
/// cannot be shared out evenly, or there would be 2^32 - 1 vertices or more
SplitVertices split_vertices(std::size_t vertices, std::span<const std::uint32_t> corners,
                             std::span<const float> values);

}  // namespace darboux
