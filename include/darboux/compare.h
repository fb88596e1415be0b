/// \file compare.h
/// Compares the tangents of two meshes, corner by corner.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <darboux/mesh.h>
#include <darboux/statistics.h>

namespace darboux {

struct CompareOptions {
  /// Tangents of equal sign at most this angle apart count as the same. 0: only bit-identical tangents do.
  double max_angle_deg = 0;
};

/// Corners of one mesh without a counterpart in the other, by the first reason that applies.
struct Unmatched {
  std::size_t not_finite =
      /// NaN or infinity in position, normal or uv, at the corner or elsewhere in its triangle.
      0;
  std::size_t position = 0;  ///< the other mesh has no corner at this position
  std::size_t triangle =
      /// It has an equal vertex, but not in the same triangle, or fewer copies of the triangle.
      0;
  std::size_t uv = 0;             ///< it has this position and normal, with other uvs or none
  std::size_t normal = 0;         ///< it has this position and uv, with other normals or none
  std::size_t uv_and_normal = 0;  ///< it has this position, with other uvs and normals
  std::size_t total() const { return not_finite + position + triangle + uv + normal + uv_and_normal; }
};

/// How the signs w of a and b compare, over the pairs in which neither is 0 or NaN.
enum class SignAgreement : std::uint8_t { none, same, opposite, mixed };
inline constexpr std::array<std::string_view, 4> sign_agreement_names{"none", "same", "opposite", "mixed"};

struct WorstTangent {
  std::uint32_t vertex_a, vertex_b;
  double deg;
};

/// The result of comparing two meshes a and b. Counts are pairs of matched corners unless stated otherwise.
struct MeshComparison {
  std::size_t corners_a = 0, corners_b = 0, matched = 0;
  Unmatched unmatched_a, unmatched_b;
  /// How many would match if b stored 1 - v for v. Counted only if uvs are a reason for corners without a
  /// counterpart and both meshes have uvs.
  std::size_t matched_with_v_flipped = 0;

  bool tangents_a = false, tangents_b = false;  ///< which mesh has tangents; unless both do, all below is 0
  std::size_t equal_bits = 0;             ///< x, y, z and w bit-equal; NaN is equal to a NaN of the same bits
  std::size_t equal_directions = 0;       ///< x, y and z bit-equal, whatever w
  std::size_t no_direction = 0;           ///< one of the tangents is zero or not finite: no angle
  std::optional<Statistics> tangent_deg;  ///< angles, of all other matched corners
  SignAgreement sign = SignAgreement::none;
  std::size_t opposite_signs = 0;
  /// Set if all signs are opposite and each mesh follows one convention (frame.h). true: a stores raw and b
  /// gltf; false: the reverse.
  std::optional<bool> a_is_raw;
  std::optional<WorstTangent> worst;  ///< the pair with the largest angle, of those whose bits differ
  bool same = false;                  ///< as compare() defines it
};

/// Compares two meshes, each in its local space.
///
/// Two corners are the same if they agree in position, normal and uv, and so do the next and the previous
/// corners of their triangles. The order of the triangles, the corner that a triangle begins with, the
/// indices, and split or welded vertices do not matter. Bit-identical corners are matched first, then those
/// that differ by less than 1e-6 of the range over both meshes (positions: the diagonal of the bounding box;
/// uvs: the larger side of theirs; normals: 2) or are linked by a chain of such differences. Positions up to
/// 1.5 times that far apart may also count as the same. An attribute that one mesh lacks differs from any
/// that the other stores. If several corners are the same (duplicate triangles, triangles in one point),
/// those with bit-equal tangents are paired first, the rest in the order of their tangents along one fixed
/// direction. A corner is matched at most once. NaN and infinities in positions, normals and uvs match
/// nothing.
///
/// The meshes are the same if both have corners and tangents, all corners of both are matched, and in each
/// matched pair all four numbers of the tangents are bit-identical or, with max_angle_deg > 0, the angle is
/// at most that and w is equal. Tangents without a direction have no angle: they must be bit-identical.
///
/// Exchanging a and b exchanges their results and changes nothing else, except which corner is reported as
/// worst among ties. Cost: n log k for n corners, k of which share a vertex: about one second for 10^6
/// bit-identical triangles, three times that otherwise. \throws MeshError if a mesh is inconsistent \throws
/// ParameterError for an angle outside [0, 180]
MeshComparison compare(const Mesh& a, const Mesh& b, const CompareOptions& options = {});

/// A piece of a file, with its index and name there.
struct NamedMesh {
  std::size_t mesh = 0, primitive = 0;
  std::string_view name;
  const Mesh* data = nullptr;
};

/// Corresponding pieces of two files, as indices into the given lists.
struct MeshPairs {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< in the order of a
  std::vector<std::size_t> only_a, only_b;
};

/// Pairs pieces in four rounds, each among those left over: (1) equal name (not empty, unique in each file)
/// and primitive; (2) equal mesh and primitive, and boxes that agree; (3) boxes that agree, in the order of
/// a, the nearest first; (4) equal mesh and primitive. A box is the bounding box of the finite positions that
/// triangles use. Two boxes agree if corresponding sides differ by at most 1 % of the larger diagonal; two
/// empty boxes agree. Cost: that of comparing names, plus the product of the numbers of pieces that rounds 1
/// and 2 leave. \throws MeshError for a null pointer
MeshPairs pair_meshes(std::span<const NamedMesh> a, std::span<const NamedMesh> b);

}  // namespace darboux
