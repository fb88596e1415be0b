/// \file compare.h
/// The tangents of two meshes, corner by corner: is one exactly the other?
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
  /// Tangents up to this angle apart, of the same sign, count as the same; at 0 only those of the same bits
  /// do.
  double max_angle_deg = 0;
};

/// Corners of one mesh without a counterpart in the other, by the first reason that holds.
struct Unmatched {
  std::size_t not_finite =
      0;                     ///< NaN or infinity in position, normal or uv, at the corner or in its triangle
  std::size_t position = 0;  ///< the other mesh has no corner at this position
  std::size_t triangle =
      0;                   ///< it has this very vertex, but not in the same triangle, or fewer copies of that
  std::size_t uv = 0;      ///< it has this position and normal, with other uvs or none
  std::size_t normal = 0;  ///< it has this position and uv, with other normals or none
  std::size_t uv_and_normal = 0;  ///< it has this position alone
  std::size_t total() const { return not_finite + position + triangle + uv + normal + uv_and_normal; }
};

/// How the signs w of a and b compare, over the pairs in which each is positive or negative.
enum class SignAgreement : std::uint8_t { none, same, opposite, mixed };
inline constexpr std::array<std::string_view, 4> sign_agreement_names{"none", "same", "opposite", "mixed"};

struct WorstTangent {
  std::uint32_t vertex_a, vertex_b;
  double deg;
};

/// What became of the corners of two meshes a and b. Counts are in pairs of matched corners unless said
/// otherwise.
struct MeshComparison {
  std::size_t corners_a = 0, corners_b = 0, matched = 0;
  Unmatched unmatched_a, unmatched_b;
  /// How many would match if b stored 1 - v for v. Counted only if uvs are a reason for corners without a
  /// counterpart and both meshes have uvs.
  std::size_t matched_with_v_flipped = 0;

  bool tangents_a = false, tangents_b = false;  ///< which has tangents at all; without both all below is 0
  std::size_t equal_bits = 0;             ///< x, y, z and w bit-equal; NaN is equal to a NaN of the same bits
  std::size_t equal_directions = 0;       ///< x, y and z bit-equal, whatever w
  std::size_t no_direction = 0;           ///< the tangent of either is zero or not finite: no angle
  std::optional<Statistics> tangent_deg;  ///< angles, of all other matched corners
  SignAgreement sign = SignAgreement::none;
  std::size_t opposite_signs = 0;
  /// Set if all signs are opposite and each mesh follows one convention (frame.h). true: a stores raw and b
  /// gltf; false: the reverse.
  std::optional<bool> a_is_raw;
  std::optional<WorstTangent> worst;  ///< the largest angle where bits differ
  bool same = false;                  ///< as compare() defines it
};

/// Compares two meshes in their own spaces.
///
/// Two corners are the same if they agree in position, normal and uv, and so do the next and the previous
/// corners of their triangles. The order of the triangles, the corner that a triangle begins with, the
/// indices, and split or welded vertices do not matter. Corners of equal bits are matched first, then those
/// that differ by less than 1e-6 of the range over both meshes (for positions the diagonal of their box, for
/// uvs the larger side of theirs, for normals 2) or are linked by a chain of such differences. Positions up
/// to 1.5 times that far apart may count as the same too. An attribute that one mesh lacks differs from any
/// that the other stores. If several corners are the same (duplicate triangles, triangles in one point),
/// those with bit-equal tangents are paired first, the rest in the order of their tangents along one fixed
/// direction. A corner is matched at most once. NaN and infinities in positions, normals and uvs match
/// nothing.
///
/// The meshes are the same where both have corners and tangents, all corners of both are matched, and at each
/// matched pair all four numbers of the tangents are bit-equal, or, with max_angle_deg > 0, the angle is at
/// most that and w is equal. Tangents without a direction have no angle: they must be bit-equal.
///
/// Exchanging a and b exchanges their results and changes nothing else, except which corner is the worst if
/// several are equally bad. Cost: n log k for n corners, k of which share a vertex. That is about one second
/// for 10^6 triangles if their bits agree, three times that if not. \throws MeshError when a mesh is
/// inconsistent \throws ParameterError for an angle outside [0, 180]
MeshComparison compare(const Mesh& a, const Mesh& b, const CompareOptions& options = {});

/// A piece of a file: its place and name there.
struct NamedMesh {
  std::size_t mesh = 0, primitive = 0;
  std::string_view name;
  const Mesh* data = nullptr;
};

/// Which piece of one file is which of another: indices into the lists given.
struct MeshPairs {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< in the order of a
  std::vector<std::size_t> only_a, only_b;
};

/// Pairs pieces in four rounds, each over those that are left: the same name (not empty, and once in each
/// file) and primitive; the same mesh and primitive, and boxes that agree; boxes that agree, the nearest
/// first in the order of a; the same mesh and primitive. Boxes are those of the finite positions that
/// triangles use. They agree where no side of one lies farther from the other's than 1 % of the diagonal of
/// the larger; two that hold nothing agree too. Cost: that of the names, and the product of the numbers of
/// pieces for those that neither name nor place pairs. \throws MeshError for a null pointer
MeshPairs pair_meshes(std::span<const NamedMesh> a, std::span<const NamedMesh> b);

}  // namespace darboux
