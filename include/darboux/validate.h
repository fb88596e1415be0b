/// \file validate.h
/// Compares the normals and tangents stored in a mesh with the truth and says what is wrong, where.
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

/// A kind of finding: its code, which stays, and what it means. The whole list: finding_kinds().
struct FindingKind {
  std::string_view code;
  Severity severity;         ///< by default; errors become warnings on weaker evidence
  std::string_view message;  ///< what is wrong, in plain words
  std::string_view to_do;    ///< what to do about it
};
/// Every finding there is, errors first.
std::span<const FindingKind> finding_kinds();

/// What was found. `count` is in corners unless the message says otherwise.
struct Finding {
  std::string_view code;
  Severity severity;
  std::size_t count;
  std::string message;  ///< that of its kind, and more about this case
  std::string_view to_do;
  std::size_t kind = 0;  ///< its place in finding_kinds()
};

/// The corner with the largest error of a class.
struct WorstCorner {
  std::uint32_t vertex;  ///< index into the mesh
  Vec2<double> uv;       ///< as stored
};
/// The errors of one class of vertices, in degrees, over its triangle corners. A corner whose tangent is zero
/// or not finite counts in `corners` only; likewise a corner whose normal is, for the normal statistics.
struct ClassReport {
  VertexClass vertex_class;
  std::size_t corners = 0;
  std::optional<Statistics> normal_deg, tangent_deg,
      bitangent_deg;                 ///< nothing where there is nothing to compare
  std::optional<WorstCorner> worst;  ///< of the tangent, or of the normal where there are no tangents
  /// Standard deviations of the truth, in degrees, at the corners that normal_deg and tangent_deg compare.
  Spread normal_uncertainty_deg{}, tangent_uncertainty_deg{};
};

/// The mesh against what its own positions, and uvs where it has any, say: local_truth().
struct LocalReport {
  std::vector<ClassReport> classes;  ///< as MeshReport has them
  /// Interior corners where both this and the deciding reference know normal and tangent, and the share of
  /// them where the two agree: neither normal (up to its side) nor tangent differ by more than three of their
  /// standard deviations together. None where this decides.
  std::size_t compared = 0;
  double agreement = 0;
};

/// The tangents against those of the mesh's own triangles: each corner's triangles span a cone of directions
/// in the plane of its normal, and any positive average of them lies inside.
struct TrianglesReport {
  std::size_t compared = 0;  ///< corners whose triangles span a cone of less than 180 degrees
  std::size_t outside = 0;   ///< of these, corners whose tangent is farther from the cone than permitted
  double worst_deg = 0;      ///< the farthest of those outside
  /// Other corners with tangent, normal and a triangle with area in space and uv: the cone is 180 degrees or
  /// more, or the tangent is outside by no more than coarse triangles, seams and rounding explain.
  std::size_t open = 0;
};

/// Which implementation of MikkTSpace made the tangents, at 99 % of the corners or more.
enum class MikkVariant {
  none,
  original,        ///< the original, bit for bit
  sorted_edges,    ///< bit for bit a port that sorts all edges (MikkOptions::sort_all_edges)
  reordered_sums,  ///< within 2e-5 degrees of the original: a port that adds in another order
};
inline constexpr std::array<std::string_view, 4> mikk_variant_names{"none", "original", "sorted edges",
                                                                    "reordered sums"};

/// The mesh against MikkTSpace's tangents of its own positions, normals and uvs, mikktspace.h.
struct MikkReport {
  /// The share of corners whose stored tangent has MikkTSpace's bits in single precision, w under the one of
  /// both sign conventions that holds at more of them.
  double equal_bits = 0;
  MikkVariant variant = MikkVariant::none;
  std::vector<ClassReport> classes;  ///< as MeshReport has them, without normals and deviations
};

/// Which sign convention the stored w follow, as SignConvention has them; mixed: neither at 99 % of corners.
enum class HandednessConvention { none, raw, gltf, mixed };
inline constexpr std::array<std::string_view, 4> handedness_convention_names{"none", "raw", "gltf", "mixed"};

/// The same with its counts, over the corners of triangles with uv area and w = ±1; none without tangents.
struct Handedness {
  HandednessConvention convention = HandednessConvention::none;
  double consistent = 0;  ///< the share of corners that agree with the named one (mixed: the larger)
  std::size_t wrong = 0;  ///< the others
};

struct MeshReport {
  std::size_t corners = 0;
  /// The first of analytic, triangles and local that decided any corner; mikktspace where nothing else was
  /// asked for.
  ReferenceKind reference = ReferenceKind::none;
  std::size_t inward =
      0;  ///< corners whose normal and triangles face against the surface's n, compared with -n
  std::size_t faceted = 0;  ///< corners whose normal is their triangle's, where neighbours turn by more
  Handedness handedness;
  std::size_t zero_tangents = 0, non_unit = 0, non_orthogonal = 0, non_finite = 0;  ///< corners
  std::size_t degenerate_triangles = 0, degenerate_uv_triangles = 0;
  /// Angles to the surface, else to local jets, else, where nothing else was asked for, to MikkTSpace's
  /// tangents; empty ones left out.
  std::vector<ClassReport> classes;
  /// Standard deviations of the truth in degrees over all corners, whatever the mesh stores.
  Spread normal_uncertainty_deg, tangent_uncertainty_deg;
  std::optional<TrianglesReport>
      triangles;                         ///< where it was asked for and there are tangents, normals and uvs
  std::optional<LocalReport> local;      ///< where it was asked for and there are uvs or normals
  std::optional<MikkReport> mikktspace;  ///< where it was asked for and there are tangents, normals and uvs
  std::vector<Finding> findings;         ///< errors first
  /// Filled if ValidateOptions::keep_errors is set; three per triangle, in degrees. The angle at that corner
  /// of which `classes` has the statistics: of the tangent, or of the normal if there are no tangents. If
  /// there is no such angle and the triangles alone find the corner in error: how far the tangent lies
  /// outside their cone; for a normal 80, as it is more than 80 degrees from them. NaN if nothing is
  /// compared.
  std::vector<float> errors_deg;
  Verdict verdict = Verdict::undetermined;
  Verdict without_errors = Verdict::undetermined;  ///< what the verdict would be if no finding were an error
};

/// What a mesh is compared with.
struct References {
  bool analytic = true;    ///< the surface it was made from, declared or recognised
  bool mikktspace = true;  ///< MikkTSpace's tangents of the mesh's own data
  bool local = true;       ///< polynomials through the mesh's own positions by uv, with their error
  bool triangles = true;   ///< the mesh's own triangles, and what any average of them can be
};

struct ValidateOptions {
  double max_angle_deg = 5;  ///< limit for interior corners, above 0 and at most 180; three times that at
                             ///< seams, pole rings, creases and borders
  References references{};
  /// Other uv sets of the mesh, one uv per vertex, which its tangents may follow instead; the number names
  /// the set.
  std::span<const std::pair<int, std::vector<Vec2<double>>>> other_uvs{};
  /// Triangles on which the mesh's surface goes on, as those of a glTF mesh's other primitives, with the same
  /// attributes. They are not judged, but normals and tangents at vertices of the same position and normal
  /// may be averages over them too. Ignored where the tangents follow other uvs than the mesh's. Null: none.
  const Mesh* beside = nullptr;
  /// The sign convention of the file's format. Tangents that follow the other one are reported as
  /// TANGENT_HANDEDNESS_CONVENTION or, if the format's is raw, as BINORMAL_AGAINST_V.
  SignConvention sign = SignConvention::gltf;
  int threads = 1;           ///< 0: all; the report does not depend on it
  bool keep_errors = false;  ///< whether the report has errors_deg, 12 bytes per triangle
};

/// Assesses a mesh in its own space.
/// Angles are atan2 angles of normalised vectors. The statistics take tangents as stored; TANGENT_ANGLE
/// judges the tangent made perpendicular to the stored normal. The bitangent is w·cross(n, t), with n as
/// stored and w corrected for the one sign convention found, against the derivative by the stored v.
/// Let s be the standard deviation of the truth. An angle is beyond its limit when it exceeds it by more than
/// 3 s, within when it stays below it by more than 3 s, and undecided otherwise. So at most 0.14 % of fits
/// call a correct angle wrong. Verdict: fail with any error finding; else nothing if there are no triangles,
/// or neither tangents to judge nor normals; else pass if there are no tangents to judge, or the surface or
/// the triangles judged some of them; else undetermined. Errors, one to a corner, the first that fits:
/// TANGENT_NOT_FINITE, TANGENT_ZERO, TANGENT_NOT_UNIT (|1 - |t|²| > 0.0005, or above what the steps of
/// quantised tangents explain, if that is more), TANGENT_INVALID_SIGN, TANGENT_NOT_ORTHOGONAL (|t·n| > 0.26;
/// a warning from 0.02), TANGENT_HANDEDNESS (against its uv island), TANGENT_ANGLE, NORMAL_NOT_FINITE,
/// NORMAL_NOT_UNIT, NORMAL_ANGLE, POSITION_NOT_FINITE, UV_NOT_FINITE. Others: finding_kinds(). If more than a
/// fifth of the tangents are off, common causes are tested and reported as well (swapped axes, another uv
/// set, a transform that skipped the tangents); this changes no error. Cost: linear in the corners;
/// local_truth()'s 1 µs per vertex, MikkTSpace 0.3 µs per triangle. \param truth at each vertex; empty: the
/// other references decide \throws MeshError when the mesh is inconsistent, or for another number of truths,
/// or of uvs of a set, than vertices; ParameterError as chosen_instruction_set(), and for a max_angle_deg out
/// of range
MeshReport validate(const Mesh& mesh, std::span<const Truth> truth, const ValidateOptions& options = {});

/// The normals and tangents of the surface at each vertex's uv are the truth. Positions are not compared with
/// the surface: assess() of assess.h does that and reports SURFACE_MISMATCH.
/// \param truth the surface the mesh was made from, known exactly; without one the other references decide
MeshReport validate(const Mesh& mesh, const std::optional<PlacedSurface>& truth,
                    const ValidateOptions& options = {});

}  // namespace darboux
