#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/validate.h>

#include "answers.h"
#include "base/degrees.h"
#include "base/flatten.h"
#include "base/text.h"
#include "corner_counts.h"
#include "diagnose_normals.h"
#include "diagnose_tangents.h"
#include "findings.h"
#include "judge.h"
#include "mesh_under_test.h"
#include "mikktspace_comparison.h"
#include "normal_cones.h"

namespace darboux {
namespace {

constexpr double expected_agreement = 0.8;  // of two references; error bars cover less if coarse
constexpr double agree_within = 0.1;        // of the limit: references that differ by less agree

// Angles are negative where there is nothing to compare.
float kept(double angle) {
  return angle < 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(angle);
}

// Whether two references agree within their uncertainties.
DARBOUX_FLATTEN bool agree(const Truth& a, const Truth& b, double floor_deg) {
  const auto within = [&](double angle, double one, double other) {
    return degrees_per_radian * angle <= certain * std::hypot(one, other) + floor_deg;
  };
  const double normal = angle_between_units(a.normal, b.normal);
  return within(std::fmin(normal, std::numbers::pi - normal), a.normal_deg, b.normal_deg) &&
         within(angle_between_units(a.tangent, b.tangent), a.tangent_deg, b.tangent_deg);
}

bool known(const Truth& t) {
  return detail::finite(t.normal) && detail::finite(t.tangent) && std::isfinite(t.normal_deg) &&
         std::isfinite(t.tangent_deg);
}

// The validation of one mesh: makes the report from the answers.
class MeshValidation {
 public:
  MeshValidation(const MeshUnderTest& under_test, std::span<const Truth> truth, Basis basis,
                 const ValidateOptions& options)
      : answers_(under_test, truth, basis, options) {
    report_.corners = under_test.mesh.corners();
    report_.handedness = answers_.signs.handedness();
  }

  MeshReport report() && {
    compare();
    const Judge judge(answers_, diagnose());
    for (std::uint32_t v = 0; v < answers_.mesh.positions.size(); ++v)
      if (answers_.corners_of[v] > 0) count_vertex(v);
    count_uncompared_normals();
    const CornerCounts counts = count_corners(answers_, judge);
    if (!answers_.under_test.cones.empty()) report_.triangles = counts.triangles;
    add_findings(counts, answers_, judge, report_);
    keep_errors_by_triangles(judge);
    compare_with_neighbours();
    compare_with_mikktspace();
    look_at_signs();
    add_notes();
    decide();
    return std::move(report_);
  }

 private:
  // \param angles_at returns the angles of a vertex
  template <class AnglesAt>
  std::vector<ClassReport> class_reports(std::span<const Truth> truth, const AnglesAt& angles_at) const {
    ClassSums sums(answers_.mesh, answers_.classes.of_vertex);
    for (std::uint32_t v = 0; v < answers_.mesh.positions.size(); ++v)
      sums.add(answers_.classes.of_vertex[v], v, answers_.corners_of[v], angles_at(v),
               truth.empty() ? nullptr : &truth[v]);
    return sums.reports();
  }

  bool only_mikktspace() const {
    const References& r = answers_.options.references;
    return r.mikktspace && !r.analytic && !r.triangles && !r.local;
  }

  void compare();
  Mistakes diagnose();
  void count_vertex(std::uint32_t v);
  void count_uncompared_normals();
  void keep_errors_by_triangles(const Judge& judge);
  void compare_with_neighbours();
  void compare_with_mikktspace();
  void look_at_signs();
  bool lacks_uv_area() const;
  void add_notes();
  void decide();

  const Answers answers_;
  // Numbers of corners: decided by the surface; compared with it but undecided; decided by the neighbours.
  std::size_t decided_ = 0, undecided_ = 0, locally_ = 0;
  MeshReport report_;
};

void MeshValidation::compare() {
  report_.classes = class_reports(answers_.statistics_truth(),
                                  [this](std::uint32_t v) { return answers_.statistics_angles(v); });
  if (!answers_.options.keep_errors) return;
  report_.errors_deg.reserve(answers_.mesh.corners());
  std::vector<float> of_vertex(answers_.mesh.positions.size());
  for (std::uint32_t v = 0; v < of_vertex.size(); ++v) {
    const Angles a = answers_.statistics_angles(v);
    of_vertex[v] = kept(answers_.mesh.tangents.empty() ? a.normal : a.tangent);
  }
  for (const Triangle& triangle : answers_.mesh.triangles)
    for (const std::uint32_t v : triangle) report_.errors_deg.push_back(of_vertex[v]);
}

// Counts what does not depend on the verdict.
void MeshValidation::count_vertex(std::uint32_t v) {
  const std::uint32_t corners = answers_.corners_of[v];
  const VertexChecks& c = answers_.checks[v];
  if (!answers_.mesh.tangents.empty() && c.tangent_zero) report_.zero_tangents += corners;
  if (!c.tangent_finite || !c.normal_finite || !c.position_finite || !c.uv_finite)
    report_.non_finite += corners;
  if (!answers_.mesh.tangents.empty() && c.has_tangent && !c.tangent_unit) report_.non_unit += corners;
  if (!c.orthogonal) report_.non_orthogonal += corners;
  const std::span<const Truth> truth = answers_.statistics_truth();
  if (truth.empty() || !c.uv_finite) return;
  report_.normal_uncertainty_deg.add(truth[v].normal_deg, corners);
  report_.tangent_uncertainty_deg.add(truth[v].tangent_deg, corners);
  if (answers_.accurate.known()) {
    const Angles& a = answers_.accurate.angles(v);
    const Claim normal = answers_.accurate.normal(v), tangent = answers_.accurate.tangent(v);
    if (normal != Claim::none || tangent != Claim::none) decided_ += corners;
    if (!answers_.is_pole(v) && ((a.normal >= 0 && normal == Claim::none) ||
                                 (a.tangent >= 0 && tangent == Claim::none && !answers_.is_unseen(v))))
      undecided_ += corners;
    if (answers_.accurate.has_sides() && answers_.accurate.inward(v)) report_.inward += corners;
  }
  if (answers_.smooth.known() &&
      (answers_.smooth.normals[v] != Claim::none || answers_.smooth.tangents[v] != Claim::none))
    locally_ += corners;
}

void MeshValidation::count_uncompared_normals() {
  const Mesh& mesh = answers_.mesh;
  const auto& classes = report_.classes;
  if (mesh.normals.empty() || std::any_of(classes.begin(), classes.end(),
                                          [](const ClassReport& c) { return c.normal_deg.has_value(); }))
    return;
  const NormalChecks& normals = answers_.under_test.normals;
  std::vector<bool> asked(mesh.positions.size());
  for (std::uint32_t v = 0; v < asked.size(); ++v)
    asked[v] = answers_.corners_of[v] > 0 && answers_.checks[v].has_normal && normals.drawn[v] &&
               !normals.faceted_vertices[v];
  VertexJoins of_part;
  const std::vector<bool> average = are_average_normals(mesh, joins_of(answers_.under_test, of_part), asked);
  for (std::uint32_t v = 0; v < asked.size(); ++v)
    if (asked[v] && !average[v]) report_.uncompared_normals += answers_.corners_of[v];
}

// For meshes without angles for the statistics.
void MeshValidation::keep_errors_by_triangles(const Judge& judge) {
  for (std::size_t c = 0; c < report_.errors_deg.size(); ++c) {
    if (!std::isnan(report_.errors_deg[c])) continue;
    const std::uint32_t v = answers_.mesh.triangles[c / 3][c % 3];
    const auto sign = static_cast<std::int8_t>(answers_.under_test.raw_sign[c / 3]);
    if (answers_.mesh.tangents.empty()
            ? judge.normal_error(v)
            : judge.tangent_error({v, sign, false, 1}) == Judge::Decider::triangles)
      report_.errors_deg[c] = kept(
          answers_.mesh.tangents.empty() ? supported_deg : answers_.under_test.cones.outside_deg(v, sign));
  }
}

void MeshValidation::compare_with_neighbours() {
  if (!answers_.smooth.known()) return;
  LocalReport& report = report_.local.emplace();
  if (!answers_.accurate.known()) {
    report.classes = report_.classes;
    return;
  }
  report.classes = class_reports(answers_.under_test.local, [this](std::uint32_t v) {
    return answers_.corners_of[v] == 0 ? Angles{} : answers_.smooth.angles[v];
  });
  std::size_t agreeing = 0;
  for (std::uint32_t v = 0; v < answers_.accurate.truths().size(); ++v) {
    const Truth &a = answers_.accurate.truth(v), &b = answers_.under_test.local[v];
    if (answers_.classes.of_vertex[v] != VertexClass::interior || !known(a) || !known(b)) continue;
    report.compared += answers_.corners_of[v];
    if (agree(a, b, agree_within * answers_.options.max_angle_deg)) agreeing += answers_.corners_of[v];
  }
  if (report.compared == 0) return;
  report.agreement = static_cast<double>(agreeing) / static_cast<double>(report.compared);
  if (report.agreement < expected_agreement)
    add(report_, finding(Code::references_disagree, report.compared,
                         ": they agree at " + rounded(100 * report.agreement, 3) +
                             " % of interior corners, so that the positions stray from the surface in "
                             "waves, or the uvs are others"));
}

void MeshValidation::compare_with_mikktspace() {
  if (answers_.under_test.mikktspace.empty()) return;
  MikktspaceComparison comparison = darboux::compare_with_mikktspace(
      answers_.under_test, answers_.checks, answers_.corners_of, answers_.signs.raw(), answers_.options);
  const MikkReport& report = report_.mikktspace.emplace(std::move(comparison.report));
  add(report_, finding(Code::tangent_not_mikktspace, comparison.beyond,
                       worst_text(answers_.options.max_angle_deg, comparison.worst_deg)));
  if (!only_mikktspace()) return;
  report_.classes = report.classes;
  for (std::size_t c = 0; c < report_.errors_deg.size(); ++c) {
    const std::uint32_t v = answers_.mesh.triangles[c / 3][c % 3];
    const Vec4<float>& m = answers_.under_test.mikktspace.at(c, v);
    const bool comparable = m.w != 0 && answers_.checks[v].has_tangent;
    report_.errors_deg[c] =
        kept(comparable
                 ? angles_to_mikktspace(answers_.mesh, v, answers_.checks[v], m, answers_.signs.raw()).tangent
                 : -1);
  }
}

void MeshValidation::look_at_signs() {
  if (answers_.mesh.tangents.empty()) return;
  const HandednessConvention convention = report_.handedness.convention;
  // Where all normals oppose the winding, w has the opposite meaning: normals, winding or w may be wrong.
  if (!answers_.under_test.normals.all_oppose) {
    if (convention == HandednessConvention::raw && answers_.options.sign == SignConvention::gltf)
      add(report_, finding(Code::handedness_convention, answers_.signs.all().raw,
                           " (it would be glTF's if v were flipped)"));
    if (convention == HandednessConvention::gltf && answers_.options.sign == SignConvention::raw)
      add(report_, finding(Code::binormal_against_v, answers_.signs.all().gltf));
  }
  const bool mixed = convention == HandednessConvention::mixed;
  add(report_,
      finding(Code::handedness_mixed, mixed ? report_.handedness.wrong : answers_.signs.in_opposite_islands(),
              answers_.signs.islands_text()));
  std::size_t across = 0;
  for (std::uint32_t v = 0; v < answers_.corners_of.size(); ++v)
    across += answers_.under_test.across_mirror[v] ? answers_.corners_of[v] : 0;
  add(report_, finding(Code::vertex_across_mirror, across));
}

Mistakes MeshValidation::diagnose() {
  Mistakes mistakes;
  if (!answers_.accurate.known() ||
      (answers_.accurate.normals_agree() < Accurate::enough && !answers_.averages.explain_normals()))
    mistakes.normals = diagnose_normals(answers_.under_test, answers_.accurate, answers_.options, report_);
  if (answers_.mesh.tangents.empty()) return mistakes;
  const std::span<const Truth> truth = answers_.statistics_truth();
  std::size_t oblique = 0;
  double most = 0;
  const double near = 0.99 * std::sin(std::fmin(answers_.options.max_angle_deg, 90) / degrees_per_radian);
  for (std::uint32_t v = 0; v < truth.size(); ++v) {
    const Vec3<double>&t = truth[v].tangent, &b = truth[v].bitangent;
    // For nearly all of them the cosine shows quickly that the angle is near 90 degrees.
    if (dot(t, b) * dot(t, b) < near * near * dot(t, t) * dot(b, b)) continue;
    if (answers_.is_pole(v) || !known(truth[v])) continue;
    const double off = std::fabs(90 - degrees_per_radian * angle_between(t, b));
    if (!(off - certain * truth[v].tangent_deg > answers_.options.max_angle_deg)) continue;
    oblique += answers_.corners_of[v];
    most = std::fmax(most, off);
  }
  add(report_, finding(Code::bitangent_not_orthogonal, oblique, " (by up to " + rounded(most, 3) + " deg)"));
  // The mesh's own triangles say whether there is anything to diagnose. Without a surface: any tangent
  // outside their cones. If a surface was recognised and their cones hold most tangents, its chart is not the
  // mesh's, and only another uv set may explain the tangents better.
  bool held = false;
  if (!answers_.accurate.declared() && !answers_.under_test.cones.empty()) {
    std::size_t within = 0, beyond = 0;
    for (std::uint32_t v = 0; v < answers_.mesh.positions.size(); ++v) {
      const Claim claim = answers_.under_test.cones.claim(v, 0);
      within += claim == Claim::within ? answers_.corners_of[v] : 0;
      beyond += claim == Claim::beyond ? answers_.corners_of[v] : 0;
    }
    if (!answers_.accurate.known() && beyond == 0) return mistakes;
    held = answers_.accurate.known() && within > beyond;
  }
  const auto mikktspace = [&](std::size_t c) {
    const std::uint32_t v = answers_.mesh.triangles[c / 3][c % 3];
    const Vec4<float>& m = answers_.under_test.mikktspace.at(c, v);
    const Vec3<double> n = answers_.mesh.normals[v];
    if (m.w == 0 || !detail::finite(n))
      return Directions{detail::nan_vector<double>(), detail::nan_vector<double>()};
    const Vec3<double> t = direction_of(m);
    return Directions{t, double{m.w} * cross(n, t)};
  };
  const auto known_truth = [&](std::size_t c) {
    const Truth& t = truth[answers_.mesh.triangles[c / 3][c % 3]];
    return Directions{t.tangent, t.bitangent};
  };
  // MikkTSpace's tangents of the same triangles are more certain than estimates from neighbours.
  const bool known_tangents =
      answers_.accurate.known() &&
      std::any_of(truth.begin(), truth.end(), [](const Truth& t) { return std::isfinite(t.tangent_deg); });
  if (!known_tangents && !answers_.under_test.mikktspace.empty())
    mistakes.tangents = diagnose_tangents(answers_.under_test, mikktspace, answers_.options, held, report_);
  if (!mistakes.tangents && !truth.empty())
    mistakes.tangents = diagnose_tangents(answers_.under_test, known_truth, answers_.options, held, report_);
  return mistakes;
}

// Without uv area a tangent has no visible effect, so none can be wrong.
bool MeshValidation::lacks_uv_area() const {
  const auto any = [](const std::vector<bool>& of) {
    return std::find(of.begin(), of.end(), true) != of.end();
  };
  return !answers_.mesh.uvs.empty() && any(answers_.under_test.has_area) &&
         !any(answers_.under_test.has_uv_area);
}

void MeshValidation::add_notes() {
  for (std::size_t t = 0; t < answers_.mesh.triangles.size(); ++t) {
    if (!answers_.under_test.has_area[t])
      ++report_.degenerate_triangles;
    else if (!answers_.mesh.uvs.empty() && answers_.under_test.raw_sign[t] == 0)
      ++report_.degenerate_uv_triangles;
  }
  report_.faceted = 3 * static_cast<std::size_t>(std::count(answers_.under_test.normals.faceted.begin(),
                                                            answers_.under_test.normals.faceted.end(), true));
  add(report_, finding(Code::normals_oppose_winding, answers_.under_test.normals.opposing));
  add(report_,
      finding(Code::reference_uncertain, undecided_,
              ": normals are known to " +
                  deviation_text(report_.normal_uncertainty_deg.rms(), 2, " deg rms") + ", tangents to " +
                  deviation_text(report_.tangent_uncertainty_deg.rms(), 2, " deg rms")));
  const std::size_t at_least_one = std::max<std::size_t>(answers_.mesh.corners(), 1);
  add(report_, finding(Code::normals_inward, report_.inward));
  add(report_, finding(Code::faceted, report_.faceted,
                       answers_.accurate.known() && !answers_.accurate.declared()
                           ? "; they are not compared with the surface"
                           : ""));
  add(report_, finding(Code::tangent_missing, answers_.mesh.tangents.empty() ? at_least_one : 0,
                       answers_.mesh.normals.empty() ? "" : "; only its normals are judged"));
  add(report_, finding(Code::normal_missing, answers_.mesh.normals.empty() ? at_least_one : 0));
  add(report_, finding(Code::uv_without_area,
                       !answers_.mesh.tangents.empty() && lacks_uv_area() ? report_.corners : 0));
  add(report_, finding(Code::triangles_missing, answers_.mesh.triangles.empty() ? 1 : 0));
  add(report_,
      finding(Code::vertex_unreferenced, static_cast<std::size_t>(std::count(
                                             answers_.corners_of.begin(), answers_.corners_of.end(), 0U))));
}

void MeshValidation::decide() {
  const bool by_triangles = report_.triangles && report_.triangles->compared > 0;
  using enum ReferenceKind;
  report_.reference = decided_ > 0                              ? analytic
                      : by_triangles                            ? triangles
                      : locally_ > 0                            ? local
                      : report_.mikktspace && only_mikktspace() ? mikktspace
                                                                : none;
  const bool tangents =
      !answers_.mesh.tangents.empty() && !(!answers_.mesh.normals.empty() && lacks_uv_area());
  report_.without_errors = answers_.mesh.triangles.empty() || (!tangents && answers_.mesh.normals.empty())
                               ? Verdict::nothing
                           : !tangents || decided_ > 0 || by_triangles ? Verdict::pass
                                                                       : Verdict::undetermined;
  const bool any_error = !report_.findings.empty() && report_.findings.front().severity == Severity::error;
  report_.verdict = any_error ? Verdict::fail : report_.without_errors;
}

}  // namespace

MeshReport validate(const MeshUnderTest& under_test, std::span<const Truth> truth, Basis basis,
                    const ValidateOptions& options) {
  return MeshValidation(under_test, truth, basis, options).report();
}

MeshReport validate(const Mesh& mesh, const std::optional<PlacedSurface>& placed,
                    const ValidateOptions& options) {
  std::vector<Truth> truth;
  if (placed) truth.reserve(mesh.uvs.size());
  if (placed)
    for (const Vec2<double>& uv : mesh.uvs) truth.push_back(placed->truth(uv));
  return validate(mesh, truth, options);
}

MeshReport validate(const Mesh& mesh, std::span<const Truth> truth, const ValidateOptions& options) {
  check_consistent(mesh, "mesh");
  if (!truth.empty() && truth.size() != mesh.positions.size())
    throw MeshError("mesh", std::to_string(truth.size()) + " truths for " +
                                std::to_string(mesh.positions.size()) +
                                " vertices, expected one per vertex or none");
  MeshUnderTest under_test = prepare(mesh, options);
  add_references(under_test, options);
  classify_vertices(under_test, poles(truth), options);
  return validate(under_test, truth, Basis::declared, options);
}

}  // namespace darboux
