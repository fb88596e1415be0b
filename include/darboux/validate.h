/// \file validate.h
/// Compares the normals and tangents stored in a mesh with references, and reports what is wrong and where.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <darboux/frame.h>
#include <darboux/mesh.h>
#include <darboux/mesh_classes.h>
#include <darboux/placed_surface.h>
#include <darboux/statistics.h>

namespace darboux {

/// From best to worst. `nothing` means nothing to judge: no triangles, or neither normals nor tangents.
enum class Verdict { nothing, pass, undetermined, fail };
enum class Severity { info, warning, error };
inline constexpr std::array<std::string_view, 4> verdict_names{"nothing", "pass", "undetermined", "fail"};
inline constexpr std::array<std::string_view, 3> severity_names{"info", "warning", "error"};

/// What a mesh is compared with. `none`: nothing could decide.
enum class ReferenceKind { none, analytic, triangles, local, mikktspace };
inline constexpr std::array<std::string_view, 5> reference_names{"none", "analytic", "triangles", "local",
                                                                 "mikktspace"};

/// A kind of finding: its code, which is stable, and its meaning. All kinds: finding_kinds().
struct FindingKind {
  std::string_view code;
  Severity severity;         ///< the default; errors become warnings if the evidence is weaker
  std::string_view message;  ///< what is wrong
  std::string_view to_do;    ///< how to fix it
};
/// All kinds of findings, errors first.
std::span<const FindingKind> finding_kinds();

/// What was found. `count` is in corners unless the message says otherwise.
struct Finding {
  std::string_view code;
  Severity severity;
  std::size_t count;
  std::string message;  ///< the message of its kind, with details of this case
  std::string_view to_do;
  std::size_t kind = 0;  ///< index into finding_kinds()
};

/// The corner with the largest error of a class.
struct WorstCorner {
  std::uint32_t vertex;  ///< index into the mesh
  Vec2<double> uv;       ///< as stored
};
/// The errors in one vertex class, in degrees, over its triangle corners. A corner whose tangent is zero or
/// not finite counts in `corners`, but not in the tangent statistics; the same holds for normals.
struct ClassReport {
  VertexClass vertex_class;
  std::size_t corners = 0;
  std::optional<Statistics> normal_deg, tangent_deg,
      bitangent_deg;                 ///< empty if nothing could be compared
  std::optional<WorstCorner> worst;  ///< by tangent error, or by normal error if there are no tangents
  /// Standard deviations of the reference, in degrees, over the corners in normal_deg and tangent_deg.
  Spread normal_uncertainty_deg{}, tangent_uncertainty_deg{};
};

/// Comparison with the local reference: polynomials fitted to the mesh's own positions and, if any, uvs
/// (local_truth()).
struct LocalReport {
  std::vector<ClassReport> classes;  ///< as MeshReport has them
  /// compared: interior corners where both this reference and the deciding one determine normal and tangent.
  /// agreement: the share of these where the two agree, that is, where neither the normals (up to sign) nor
  /// the tangents differ by more than three combined standard deviations. Zero if this reference is the
  /// deciding one.
  std::size_t compared = 0;
  double agreement = 0;
};

/// Comparison with the mesh's own triangles. The dpdu of the triangles at a corner, projected perpendicular
/// to its normal, span a cone; every average with positive weights lies inside it.
struct TrianglesReport {
  std::size_t compared = 0;  ///< corners whose triangles span a cone of less than 180 degrees
  std::size_t outside = 0;   ///< of these, corners whose tangent lies outside the cone by more than permitted
  double worst_deg = 0;      ///< the farthest of those outside
  /// Undecided corners, of those with tangent, normal and a triangle with area in space and uv: the cone is
  /// 180 degrees or wider, or the tangent is outside by no more than coarse triangles, seams and rounding
  /// explain.
  std::size_t open = 0;
};

/// The implementation of MikkTSpace that matches the tangents at 99 % of the corners or more.
enum class MikkVariant {
  none,
  original,        ///< the original, bit for bit
  sorted_edges,    ///< a port that sorts all edges (MikkOptions::sort_all_edges), bit for bit
  reordered_sums,  ///< within 2e-5 degrees of the original: a port that sums in another order
};
inline constexpr std::array<std::string_view, 4> mikk_variant_names{"none", "original", "sorted edges",
                                                                    "reordered sums"};

/// Comparison with the tangents that MikkTSpace (mikktspace.h) computes from the mesh's positions, normals
/// and uvs.
struct MikkReport {
  /// The share of corners whose stored tangent equals MikkTSpace's, bit for bit in single precision. w is
  /// compared under the sign convention that matches more corners.
  double equal_bits = 0;
  MikkVariant variant = MikkVariant::none;
  std::vector<ClassReport> classes;  ///< as in MeshReport, without normals and deviations
};

/// The sign convention (SignConvention) that the stored w follow. mixed: neither, at 99 % of the corners.
enum class HandednessConvention { none, raw, gltf, mixed };
inline constexpr std::array<std::string_view, 4> handedness_convention_names{"none", "raw", "gltf", "mixed"};

/// The sign convention with counts, over the corners with w = ±1 of triangles with uv area. none: no
/// tangents.
struct Handedness {
  HandednessConvention convention = HandednessConvention::none;
  double consistent = 0;  ///< share of corners that follow `convention` (mixed: the larger one)
  std::size_t wrong = 0;  ///< the remaining corners
};

struct MeshReport {
  std::size_t corners = 0;
  /// The first of analytic, triangles and local that decided any corner; mikktspace if only that was
  /// requested.
  ReferenceKind reference = ReferenceKind::none;
  std::size_t inward =
      0;  ///< corners whose normal and triangles oppose the surface's n; they are compared with -n
  /// Where no normal can be compared with a surface or with neighbours: corners whose normal is no
  /// average of their triangles' either. Only those more than 80 degrees from all of these are errors.
  std::size_t uncompared_normals = 0;
  std::size_t faceted = 0;  ///< corners with their triangle's normal, although neighbours differ by more
  Handedness handedness;
  std::size_t zero_tangents = 0, non_unit = 0, non_orthogonal = 0, non_finite = 0;  ///< corners
  std::size_t degenerate_triangles = 0, degenerate_uv_triangles = 0;
  /// Angles to the surface if known, else to local jets; to MikkTSpace's tangents if only those were
  /// requested. Empty classes are omitted.
  std::vector<ClassReport> classes;
  /// Standard deviations of the reference, in degrees, over all corners, whatever the mesh stores.
  Spread normal_uncertainty_deg, tangent_uncertainty_deg;
  std::optional<TrianglesReport>
      triangles;  ///< filled if it was requested and the mesh has tangents, normals and uvs
  std::optional<LocalReport> local;      ///< if requested and there are uvs or normals
  std::optional<MikkReport> mikktspace;  ///< if requested and there are tangents, normals and uvs
  std::vector<Finding> findings;         ///< errors first
  /// The error at each corner, in degrees; three per triangle. Filled if ValidateOptions::keep_errors is set.
  /// It is the angle that enters the statistics in `classes`: that of the tangent, or of the normal if there
  /// are no tangents. Without such an angle, where only the triangles report an error, it is the angle by
  /// which the tangent lies outside their cone; for a normal it is 80, as the normal is more than 80 degrees
  /// from them. NaN if nothing was compared.
  std::vector<float> errors_deg;
  Verdict verdict = Verdict::undetermined;
  Verdict without_errors = Verdict::undetermined;  ///< the verdict if no finding were an error
};

/// The references to compare a mesh with.
struct References {
  bool analytic = true;    ///< the surface it was made from, declared or recognised
  bool mikktspace = true;  ///< MikkTSpace's tangents of the mesh's own data
  bool local = true;       ///< polynomials in (u, v) fitted to the mesh's own positions, with their error
  bool triangles = true;   ///< the range of all averages over the mesh's own triangles
};

struct ValidateOptions {
  double max_angle_deg = 5;  ///< limit for interior corners, in (0, 180]; three times that at seams, pole
                             ///< rings, creases and borders
  References references{};
  /// Other uv sets of the mesh that its tangents may follow instead: the number of the set, and one uv per
  /// vertex.
  std::span<const std::pair<int, std::vector<Vec2<double>>>> other_uvs{};
  /// Adjacent triangles that continue the surface, such as the other primitives of a glTF mesh, with the same
  /// attributes. They are not judged, but normals and tangents at vertices with equal position and normal may
  /// be averaged over them too. Ignored where the tangents follow other uvs than the mesh's. Null: none.
  const Mesh* beside = nullptr;
  /// The sign convention of the file's format. Tangents that follow the other convention are reported as
  /// TANGENT_HANDEDNESS_CONVENTION or, if the format's is raw, as BINORMAL_AGAINST_V.
  SignConvention sign = SignConvention::gltf;
  int threads = 1;           ///< 0: all hardware threads; the report does not depend on it
  bool keep_errors = false;  ///< whether to fill MeshReport::errors_deg, 12 bytes per triangle
};

/// Validates a mesh in its local space. Angles are atan2 angles of normalised vectors. The statistics use
/// tangents as stored; TANGENT_ANGLE judges the tangent after projection perpendicular to the stored normal.
/// The bitangent is w·cross(n, t), with n as stored and w corrected for the sign convention found; it is
/// compared with the derivative with respect to the stored v. Let s be the standard deviation of the
/// reference. An angle is beyond its limit if it exceeds it by more than 3 s, within if it stays below it by
/// more than 3 s, and undecided otherwise. So at most 0.14 % of fits call a correct angle wrong. Verdict:
/// fail if there is any finding of severity error; else nothing if there are no triangles, or neither
/// tangents to judge nor normals; else pass if there are no tangents to judge, or if the surface or the
/// triangles judged some of them; else undetermined. Errors, one per corner, the first that applies:
/// TANGENT_NOT_FINITE, TANGENT_ZERO, TANGENT_NOT_UNIT (|1 - |t|²| > 0.0005, or above what the quantisation
/// of tangents explains, if that is more), TANGENT_INVALID_SIGN, TANGENT_NOT_ORTHOGONAL (|t·n| > 0.26; a
/// warning from 0.02), TANGENT_HANDEDNESS (against its uv island), TANGENT_ANGLE, NORMAL_NOT_FINITE,
/// NORMAL_NOT_UNIT, NORMAL_ANGLE, POSITION_NOT_FINITE, UV_NOT_FINITE. Others: finding_kinds(). If more than a
/// fifth of the tangents are wrong, common causes are tested and reported as well (swapped axes, another uv
/// set, a transform not applied to the tangents); this does not change the errors. Cost: linear in the
/// corners; local_truth() 1 µs per vertex, MikkTSpace 0.3 µs per triangle. \param truth the exact frame at
/// each vertex; empty: the other references decide \throws MeshError if the mesh is inconsistent, or if the
/// number of truths, or of uvs in a set, is not that of the vertices; ParameterError for a max_angle_deg out
/// of range, and as chosen_instruction_set()
MeshReport validate(const Mesh& mesh, std::span<const Truth> truth, const ValidateOptions& options = {});

/// The same, with the normals and tangents of a surface at the vertices' uvs as the truth. Positions are not
/// compared with the surface: assess() of assess.h does that, and reports SURFACE_MISMATCH.
/// \param truth the surface from which the mesh was made, known exactly; empty: the other references decide
MeshReport validate(const Mesh& mesh, const std::optional<PlacedSurface>& truth,
                    const ValidateOptions& options = {});

}  // namespace darboux
