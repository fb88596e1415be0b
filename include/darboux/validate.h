/// \file validate.h
/// Compares the normals and tangents stored in a mesh with the truth and says what is wrong, where.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/mesh.h>
#include <darboux/mesh_classes.h>
#include <darboux/placed_surface.h>
#include <darboux/statistics.h>

namespace darboux {

enum class Verdict { pass, undetermined, fail };
enum class Severity { info, warning, error };
inline constexpr std::array<std::string_view, 3> verdict_names{"pass", "undetermined", "fail"};
inline constexpr std::array<std::string_view, 3> severity_names{"info", "warning", "error"};

/// What was found. `count` is in corners unless the message says otherwise.
struct Finding {
  std::string_view code;
  Severity severity;
  std::size_t count;
  std::string message;
};

/// The errors of one class of vertices, in degrees, over its triangle corners. A corner whose tangent is zero
/// or not finite counts in `corners` and nowhere else; the normal's statistics leave out its own likewise.
struct WorstCorner {
  std::uint32_t vertex;
  Vec2<double> uv;
};
struct ClassReport {
  VertexClass vertex_class;
  std::size_t corners = 0;
  std::optional<Statistics> normal_deg, tangent_deg,
      bitangent_deg;                 ///< nothing where there is nothing to compare
  std::optional<WorstCorner> worst;  ///< of the tangent, or of the normal where there are no tangents
  /// Standard deviations of the truth, in degrees, at the corners that normal_deg and tangent_deg compare.
  Spread normal_uncertainty_deg{}, tangent_uncertainty_deg{};
};

/// The mesh against what its own positions and uvs say: local_truth().
struct LocalReport {
  std::vector<ClassReport> classes;  ///< as MeshReport has them
  /// Interior corners where both this and the deciding reference know normal and tangent, and the share of them where the
  /// two agree: neither normal (up to its side) nor tangent differ by more than three of their standard deviations together.
  std::size_t compared = 0;
  double agreement = 0;
};

/// Which sign convention the stored w follow, over the corners of triangles with uv area and w = ±1.
struct Handedness {
  std::string_view convention =
      "none";             ///< "raw", "gltf", "mixed" (neither has 99 %), "none" without tangents
  double consistent = 0;  ///< the share of corners that agree with the named one (mixed: the larger)
  std::size_t wrong = 0;  ///< the others
};

struct MeshReport {
  std::size_t corners = 0;
  std::string_view reference = "none";  ///< "analytic" where a truth was given, else "none"
  bool inward =
      false;  ///< most normals and triangles face against the surface's n; all were compared with -n
  Handedness handedness;
  std::size_t zero_tangents = 0, non_unit = 0, non_orthogonal = 0, non_finite = 0;  ///< corners
  std::size_t degenerate_triangles = 0, degenerate_uv_triangles = 0;
  std::vector<ClassReport> classes;  ///< empty ones left out
  /// Standard deviations of the truth in degrees over all corners, whatever the mesh stores.
  Spread normal_uncertainty_deg, tangent_uncertainty_deg;
  std::optional<LocalReport> local;  ///< where it was asked for and there are uvs
  std::vector<Finding> findings;     ///< errors first
  Verdict verdict = Verdict::undetermined;
};

struct ValidateOptions {
  double max_angle_deg =
      5;  ///< limit for interior corners; three times that at seams, pole rings, creases and borders
  bool local = false;  ///< compare with local_truth() as well
};

/// Judges a mesh in its own space.
/// Angles are atan2 angles of normalised vectors, tangents not projected. The bitangent is w·cross(n, t), n
/// as stored, w corrected for the one sign convention found, against the derivative by the stored v.
/// The truth has standard deviations s. An angle is beyond its limit where it is by more than 3 s: the true angle differs from
/// the measured one by the error of the truth in that direction, whose standard deviation is s at most, so that no more than
/// 0.14 % of fits accuse an angle that is right. It is within where 3 s more would be permitted too; else it is undecided.
/// Verdict: fail with any error finding; else pass where something was compared with a truth and half of the corners
/// or more are decided, undetermined otherwise. Errors,
/// one to a corner, the first that fits: TANGENT_NOT_FINITE, TANGENT_ZERO, TANGENT_NOT_UNIT (|1 - |t|²| >
/// 0.0005), TANGENT_INVALID_SIGN, TANGENT_NOT_ORTHOGONAL (|t·n| > 0.02), TANGENT_HANDEDNESS (against its uv
/// island), TANGENT_ANGLE, NORMAL_NOT_FINITE, NORMAL_NOT_UNIT, NORMAL_ANGLE, POSITION_NOT_FINITE,
/// UV_NOT_FINITE. Others: docs/howto/validate-a-mesh.md. Cost: linear in the corners.
/// \param truth at each vertex; empty: only the stored data are judged
/// \throws MeshError when the mesh is inconsistent, or for another number of truths than vertices
MeshReport validate(const Mesh& mesh, std::span<const Truth> truth, const ValidateOptions& options = {});

/// \param truth the surface the mesh was made from, known exactly; without one only the stored data are judged
MeshReport validate(const Mesh& mesh, const std::optional<PlacedSurface>& truth,
                    const ValidateOptions& options = {});

}  // namespace darboux
