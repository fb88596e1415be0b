// All findings in one list: code, severity, meaning and what to do.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <darboux/validate.h>

namespace darboux {

// In the order of finding_kinds(). The first twelve are the errors of a corner; a corner counts under the
// first that applies, in this order.
enum class Code : std::size_t {
  tangent_not_finite,
  tangent_zero,
  tangent_not_unit,
  tangent_invalid_sign,
  tangent_not_orthogonal,
  tangent_handedness,
  tangent_angle,
  normal_not_finite,
  normal_not_unit,
  normal_angle,
  position_not_finite,
  uv_not_finite,
  surface_mismatch,
  tangent_not_mikktspace,
  tangent_axes,
  tangent_uv_set,
  tangent_stale,
  normal_stale,
  handedness_convention,
  binormal_against_v,
  handedness_mixed,
  vertex_across_mirror,
  normals_oppose_winding,
  indices_left_over,
  uv_set_missing,
  references_disagree,
  reference_uncertain,
  bitangent_not_orthogonal,
  pole_tangent,
  normals_inward,
  faceted,
  tangent_texture_transform,
  tangent_uv_set_used,
  tangent_missing,
  normal_missing,
  uv_missing,
  uv_without_area,
  surface_unknown,
  budget_spent,
  crease_shared,
  parts_too_many,
  parts_in_brief,
  triangles_missing,
  vertex_unreferenced,
  morph_targets_not_judged,
  node_mirrored,
  node_scale_not_uniform,
  undetermined,
};
inline constexpr std::size_t corner_errors = 12;

// The finding with its message, followed by `more` about this case.
Finding finding(Code code, std::size_t count, const std::string& more = {});
// The same where the evidence is too weak for an error.
Finding warning(Code code, std::size_t count, const std::string& more = {});

inline Code code_of(const Finding& finding) {
  return static_cast<Code>(finding.kind);
}
// The code of a name like "TANGENT_ZERO", if there is one.
std::optional<Code> code_named(std::string_view name);

// Adds the finding after all of the same or higher severity; adds nothing if its count is 0.
void add(MeshReport& report, Finding finding);

// A mesh or part of a file.
struct NamedReport {
  std::string name;
  MeshReport* report;
};

// Adds HANDEDNESS_MIXED to the parts that follow another sign convention than most of the file, by corners.
// Parts without one known convention do not count, nor do those whose normals mostly oppose their winding:
// there w has the opposite meaning.
void compare_conventions(std::span<const NamedReport> parts);

// Turns an undetermined report into a pass: of a part or primitive whose mesh passes elsewhere.
inline void pass_if_undetermined(MeshReport& report) {
  if (report.without_errors != Verdict::undetermined) return;
  report.without_errors = Verdict::pass;
  if (report.verdict == Verdict::undetermined) report.verdict = Verdict::pass;
}

}  // namespace darboux
