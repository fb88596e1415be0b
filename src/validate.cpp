#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/frame.h>
#include <darboux/mesh_frames.h>
#include <darboux/validate.h>

#include "text.h"
#include "triangle_signs.h"
#include "validate/explain.h"
#include "validate/facts.h"
#include "validate/findings.h"
#include "validate/subject.h"

namespace darboux {
namespace {

constexpr double certain = 3;               // standard deviations
constexpr double rounding_deg = 1e-10;      // what rounding may turn a frame by, beside any noise
constexpr double expected_agreement = 0.8;  // of two references; their error bars cover less on coarse meshes
constexpr auto no_code = static_cast<Code>(corner_errors);

// An angle that is known to a standard deviation against what is permitted.
bool is_beyond(double angle, double deviation, double limit) {
  return angle - certain * deviation > limit;
}
bool is_undecided(double angle, double deviation, double limit) {
  return angle >= 0 && !is_beyond(angle, deviation, limit) && !(angle + certain * deviation <= limit);
}

// Angles are negative where there is nothing to compare.
float kept(double angle) {
  return angle < 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(angle);
}

struct SignCount {
  std::size_t raw = 0, gltf = 0;
};

// Which sign convention the whole mesh and each island follow.
struct Signs {
  std::span<const signed char> of_triangle;  // raw, 0 without uv area
  SignCount all;
  std::vector<SignCount> islands;

  Signs(const Subject& subject, const std::vector<VertexFacts>& facts)
      : of_triangle(subject.raw_sign), islands(static_cast<std::size_t>(subject.classes.islands)) {
    const Mesh& mesh = subject.mesh;
    if (mesh.tangents.empty()) return;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) {
        if (of_triangle[t] == 0 || !facts[v].sign_valid || !facts[v].has_tangent) continue;
        const bool raw = mesh.tangents[v].w == of_triangle[t];
        SignCount& island = islands[static_cast<std::size_t>(subject.classes.island_of_triangle[t])];
        ++(raw ? all.raw : all.gltf);
        ++(raw ? island.raw : island.gltf);
      }
  }

  bool raw() const { return all.raw > all.gltf; }
  // Where both signs hold half the island, the mesh's convention decides.
  bool raw_in(std::int32_t island) const {
    const SignCount& count = islands[static_cast<std::size_t>(island)];
    return count.raw == count.gltf ? raw() : count.raw > count.gltf;
  }
  // Of each vertex how many corners have another sign than their island; empty where none has.
  std::vector<std::uint32_t> wrong(const Mesh& mesh, const MeshClasses& classes) const {
    if (all.raw == 0 || all.gltf == 0) return {};
    std::vector<std::uint32_t> result(mesh.positions.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (of_triangle[t] == 0) continue;
      const bool raw = raw_in(classes.island_of_triangle[t]);
      for (const std::uint32_t v : mesh.triangles[t])
        result[v] += (mesh.tangents[v].w == of_triangle[t]) != raw;
    }
    return result;
  }
};

Handedness judge_handedness(const SignCount& all) {
  Handedness result;
  const std::size_t total = all.raw + all.gltf, larger = std::max(all.raw, all.gltf);
  if (total == 0) return result;
  result.consistent = static_cast<double>(larger) / static_cast<double>(total);
  result.wrong = total - larger;
  result.convention = result.consistent < 0.99 ? "mixed" : all.raw > all.gltf ? "raw" : "gltf";
  return result;
}

// Whether two references are the same as far as either is known.
bool agree(const Truth& a, const Truth& b) {
  const auto within = [](double angle, double one, double other) {
    return degrees_per_radian * angle <= certain * std::hypot(one, other) + rounding_deg;
  };
  const double normal = angle_between(a.normal, b.normal);
  return within(std::fmin(normal, std::numbers::pi - normal), a.normal_deg, b.normal_deg) &&
         within(angle_between(a.tangent, b.tangent), a.tangent_deg, b.tangent_deg);
}

bool known(const Truth& t) {
  return detail::finite(t.normal) && detail::finite(t.tangent) && std::isfinite(t.normal_deg) &&
         std::isfinite(t.tangent_deg);
}

// One mesh being judged: its data, and what is found along the way.
class Judge {
 public:
  Judge(const Subject& subject, std::span<const Truth> truth, const ValidateOptions& options)
      : subject_(subject),
        mesh_(subject.mesh),
        classes_(subject.classes),
        options_(options),
        truth_(truth.empty() ? std::span<const Truth>(subject.local) : truth),
        facts_(facts_of(mesh_)),
        signs_(subject, facts_),
        corners_of_(mesh_.positions.size(), 0) {
    for (const Triangle& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle) ++corners_of_[v];
    report_.corners = mesh_.corners();
    report_.reference = !truth.empty()                                     ? "analytic"
                        : !truth_.empty()                                  ? "local"
                        : !subject.mikktspace.empty() && only_mikktspace() ? "mikktspace"
                                                                           : "none";
    report_.handedness = judge_handedness(signs_.all);
    if (report_.reference == "analytic" && faces_inward(mesh_, truth_)) report_.inward = mesh_.corners();
  }

  MeshReport report() && {
    compare();
    judge_corners();
    compare_with_neighbours();
    compare_with_mikktspace();
    look_at_signs();
    look_for_explanations();
    add_notes();
    decide();
    return std::move(report_);
  }

 private:
  static std::vector<VertexFacts> facts_of(const Mesh& mesh) {
    std::vector<VertexFacts> facts(mesh.positions.size());
    for (std::uint32_t v = 0; v < facts.size(); ++v) facts[v] = stored_facts(mesh, v);
    return facts;
  }
  bool only_mikktspace() const {
    return options_.references.mikktspace && !options_.references.analytic && !options_.references.local;
  }
  double limit_of(std::uint32_t v) const {
    return options_.max_angle_deg * (classes_.of_vertex[v] == VertexClass::interior ? 1 : 3);
  }
  bool is_pole(std::uint32_t v) const { return classes_.of_vertex[v] == VertexClass::pole; }
  std::string permitted() const {
    return rounded(options_.max_angle_deg, 4) + " in the interior, " +
           rounded(3 * options_.max_angle_deg, 4) + " elsewhere";
  }

  Angles angles_to(std::span<const Truth> truth, bool inward, std::uint32_t v) const {
    if (truth.empty() || corners_of_[v] == 0) return {};
    return angles(mesh_, v, facts_[v], truth[v], inward, signs_.raw());
  }
  // \param angles_at of a vertex
  template <class AnglesAt>
  std::vector<ClassReport> class_reports(std::span<const Truth> truth, const AnglesAt& angles_at) const {
    ClassSums sums(mesh_);
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v)
      sums.add(classes_.of_vertex[v], v, corners_of_[v], angles_at(v), truth.empty() ? nullptr : &truth[v]);
    return sums.reports();
  }

  // With what decides; MikkTSpace has its own comparison, by corners.
  void compare() {
    angles_.reserve(mesh_.positions.size());
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v)
      angles_.push_back(angles_to(truth_, report_.inward > 0, v));
    report_.classes = class_reports(truth_, [this](std::uint32_t v) { return angles_[v]; });
    if (!options_.keep_errors) return;
    report_.errors_deg.reserve(mesh_.corners());
    for (const Triangle& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle)
        report_.errors_deg.push_back(kept(mesh_.tangents.empty() ? angles_[v].normal : angles_[v].tangent));
  }

  void judge_corners();
  Code error_of(std::uint32_t v, bool wrong_sign) const;
  void compare_with_neighbours();
  void compare_with_mikktspace();
  void look_at_signs();
  void look_for_explanations();
  void add_notes();
  void decide();

  const Subject& subject_;
  const Mesh& mesh_;
  const MeshClasses& classes_;
  const ValidateOptions& options_;
  std::span<const Truth> truth_;  // of what decides; empty where there is none
  std::vector<VertexFacts> facts_;
  Signs signs_;
  std::vector<std::uint32_t> corners_of_;  // how many each vertex has
  std::vector<Angles> angles_;
  std::size_t undecided_ = 0, judged_ = 0;
  MeshReport report_;
};

// The first error that fits a corner of v whose w is of the wrong sign or not.
Code Judge::error_of(std::uint32_t v, bool wrong_sign) const {
  using enum Code;
  const VertexFacts& f = facts_[v];
  const Angles& a = angles_[v];
  const double limit = limit_of(v), normal_deviation = truth_.empty() ? 0 : truth_[v].normal_deg,
               tangent_deviation = truth_.empty() ? 0 : truth_[v].tangent_deg;
  const bool pole = is_pole(v);
  if (!mesh_.tangents.empty()) {
    if (!f.tangent_finite) return tangent_not_finite;
    if (f.tangent_zero) return tangent_zero;
    if (!f.tangent_unit) return tangent_not_unit;
    if (!f.sign_valid) return tangent_invalid_sign;
    if (!f.orthogonal) return tangent_not_orthogonal;
    if (wrong_sign) return tangent_handedness;
    if (!pole && is_beyond(a.tangent, tangent_deviation, limit)) return tangent_angle;
  }
  if (!f.normal_finite) return normal_not_finite;
  if (!f.normal_unit) return normal_not_unit;
  if (!pole && is_beyond(a.normal, normal_deviation, limit)) return normal_angle;
  if (!f.position_finite) return position_not_finite;
  if (!f.uv_finite) return uv_not_finite;
  return no_code;
}

// The corners of a vertex are alike but for the sign of their triangles.
void Judge::judge_corners() {
  const bool has_tangents = !mesh_.tangents.empty(), local = report_.reference == "local";
  std::array<std::size_t, corner_errors> count{};
  double worst_tangent = 0, worst_normal = 0, pole_worst = 0;
  std::size_t pole_beyond = 0;
  const std::vector<std::uint32_t> wrong_signs = signs_.wrong(mesh_, classes_);
  for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v) {
    const std::uint32_t corners = corners_of_[v], wrong = wrong_signs.empty() ? 0 : wrong_signs[v];
    if (corners == 0) continue;
    const VertexFacts& f = facts_[v];
    const Angles& a = angles_[v];
    std::size_t without_error = 0;
    for (const bool wrong_sign : {false, true}) {
      const std::uint32_t alike = wrong_sign ? wrong : corners - wrong;
      if (alike == 0) continue;
      const Code error = error_of(v, wrong_sign);
      if (error == no_code)
        without_error += alike;
      else
        count[static_cast<std::size_t>(error)] += alike;
      if (error == Code::tangent_angle) worst_tangent = std::fmax(worst_tangent, a.tangent);
      if (error == Code::normal_angle) worst_normal = std::fmax(worst_normal, a.normal);
    }
    if (has_tangents && f.tangent_zero) report_.zero_tangents += corners;
    if (!f.tangent_finite || !f.normal_finite || !f.position_finite || !f.uv_finite)
      report_.non_finite += corners;
    if (has_tangents && f.has_tangent && !f.tangent_unit) report_.non_unit += corners;
    if (!f.orthogonal) report_.non_orthogonal += corners;
    const double limit = limit_of(v);
    if (is_pole(v) && a.tangent > limit) {
      pole_beyond += corners;
      pole_worst = std::fmax(pole_worst, a.tangent);
    }
    if (truth_.empty() || !f.uv_finite) continue;
    report_.normal_uncertainty_deg.add(truth_[v].normal_deg, corners);
    report_.tangent_uncertainty_deg.add(truth_[v].tangent_deg, corners);
    if (is_pole(v)) continue;
    const bool compared = a.normal >= 0 || a.tangent >= 0;
    if (!compared && !local) continue;
    judged_ += corners;
    if (!compared || is_undecided(a.normal, truth_[v].normal_deg, limit) ||
        is_undecided(a.tangent, truth_[v].tangent_deg, limit))
      undecided_ += without_error;
  }
  for (std::size_t k = 0; k < corner_errors; ++k) {
    const auto code = static_cast<Code>(k);
    const double worst = code == Code::tangent_angle  ? worst_tangent
                         : code == Code::normal_angle ? worst_normal
                                                      : 0;
    add(report_,
        finding(code, count[k],
                worst > 0 ? " (worst " + rounded(worst, 4) + " deg, permitted " + permitted() + ")" : ""));
  }
  add(report_, finding(Code::pole_tangent, pole_beyond, " (worst " + rounded(pole_worst, 4) + " deg)"));
}

void Judge::compare_with_neighbours() {
  if (subject_.local.empty()) return;
  LocalReport& report = report_.local.emplace();
  if (report_.reference == "local") {
    report.classes = report_.classes;
    return;
  }
  report.classes =
      class_reports(subject_.local, [this](std::uint32_t v) { return angles_to(subject_.local, false, v); });
  std::size_t agreeing = 0;
  for (std::uint32_t v = 0; v < truth_.size(); ++v) {
    if (classes_.of_vertex[v] != VertexClass::interior || !known(truth_[v]) || !known(subject_.local[v]))
      continue;
    report.compared += corners_of_[v];
    if (agree(truth_[v], subject_.local[v])) agreeing += corners_of_[v];
  }
  if (report.compared == 0) return;
  report.agreement = static_cast<double>(agreeing) / static_cast<double>(report.compared);
  if (report.agreement < expected_agreement)
    add(report_, finding(Code::references_disagree, report.compared,
                         ": they agree at " + rounded(100 * report.agreement, 3) +
                             " % of interior corners, so that the positions stray from the surface in "
                             "waves, or the uvs are others"));
}

void Judge::compare_with_mikktspace() {
  if (subject_.mikktspace.empty()) return;
  MikkReport& report = report_.mikktspace.emplace();
  ClassSums sums(mesh_);
  std::size_t equal_raw = 0, equal_gltf = 0, beyond = 0;
  double worst = 0;
  const auto bits = [](double x) { return std::bit_cast<std::uint32_t>(static_cast<float>(x)); };
  const bool keep = options_.keep_errors && report_.reference == "mikktspace";
  const auto same = [](const Vec4<float>& a, const Vec4<float>& b) {  // to the bit
    using Bits = std::array<std::uint32_t, 4>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
  };
  // Corners of a vertex to which MikkTSpace gives the same are compared once.
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> first(mesh_.positions.size(), none);
  std::vector<std::uint32_t> alike(mesh_.positions.size(), 0);
  for (std::size_t c = 0; c < mesh_.corners(); ++c) {
    const std::uint32_t v = mesh_.triangles[c / 3][c % 3];
    if (first[v] == none) first[v] = c;
    alike[v] += same(subject_.mikktspace[c], subject_.mikktspace[first[v]]);
  }
  for (std::size_t c = 0; c < mesh_.corners(); ++c) {
    const std::uint32_t v = mesh_.triangles[c / 3][c % 3];
    const Vec4<float>& m = subject_.mikktspace[c];
    if (c != first[v] && same(m, subject_.mikktspace[first[v]])) {
      if (keep) report_.errors_deg[c] = report_.errors_deg[first[v]];
      continue;
    }
    const std::uint32_t corners = c == first[v] ? alike[v] : 1;
    const Vec4<double>& t = mesh_.tangents[v];
    Angles a;
    if (m.w != 0 && facts_[v].has_tangent) {
      const Vec3<double> direction{m.x, m.y, m.z};
      a.tangent = degrees_per_radian * angle_between(t.xyz(), direction);
      if (facts_[v].has_normal && facts_[v].sign_valid)
        a.bitangent =
            degrees_per_radian * angle_between((signs_.raw() ? t.w : -t.w) * cross(mesh_.normals[v], t.xyz()),
                                               m.w * cross(mesh_.normals[v], direction));
      if (bits(t.x) == bits(m.x) && bits(t.y) == bits(m.y) && bits(t.z) == bits(m.z)) {
        equal_raw += t.w == m.w ? corners : 0;
        equal_gltf += t.w == -m.w ? corners : 0;
      }
      if (!is_pole(v) && a.tangent > limit_of(v)) {
        beyond += corners;
        worst = std::fmax(worst, a.tangent);
      }
    }
    sums.add(classes_.of_vertex[v], v, corners, a, nullptr);
    if (keep) report_.errors_deg[c] = kept(a.tangent);
  }
  report.classes = sums.reports();
  if (mesh_.corners() > 0)
    report.equal_bits =
        static_cast<double>(std::max(equal_raw, equal_gltf)) / static_cast<double>(mesh_.corners());
  Finding off = finding(Code::tangent_not_mikktspace, beyond,
                        " (worst " + rounded(worst, 4) + " deg, permitted " + permitted() + ")");
  if (report_.reference == "mikktspace") {
    off.severity = Severity::error;
    report_.classes = report.classes;
  }
  add(report_, std::move(off));
}

void Judge::look_at_signs() {
  if (mesh_.tangents.empty()) return;
  const std::string_view convention = report_.handedness.convention;
  if (convention == "raw")
    add(report_, finding(Code::handedness_convention, signs_.all.raw,
                         " (glTF's of uvs whose v was flipped is the same)"));
  if (convention == "mixed") {
    std::size_t raw = 0, gltf = 0, both = 0;
    for (const SignCount& island : signs_.islands) ++(island.gltf == 0 ? raw : island.raw == 0 ? gltf : both);
    add(report_, finding(Code::handedness_mixed, report_.handedness.wrong,
                         "; of the uv islands " + std::to_string(raw) + " are raw, " + std::to_string(gltf) +
                             " glTF's, " + std::to_string(both) + " both"));
  }
  std::size_t across = 0;
  for (std::uint32_t v = 0; v < corners_of_.size(); ++v)
    across += subject_.across_mirror[v] ? corners_of_[v] : 0;
  add(report_, finding(Code::vertex_across_mirror, across));
}

void Judge::look_for_explanations() {
  if (mesh_.tangents.empty()) return;
  if (!truth_.empty()) {
    std::size_t oblique = 0;
    double most = 0;
    const double near = 0.99 * std::sin(std::fmin(options_.max_angle_deg, 90) / degrees_per_radian);
    for (std::uint32_t v = 0; v < truth_.size(); ++v) {
      const Vec3<double>&t = truth_[v].tangent, &b = truth_[v].bitangent;
      // The cosine tells of nearly all that they are not far from a right angle.
      if (dot(t, b) * dot(t, b) < near * near * dot(t, t) * dot(b, b)) continue;
      if (is_pole(v) || !known(truth_[v])) continue;
      const double off = std::fabs(90 - degrees_per_radian * angle_between(t, b));
      if (!(off - certain * truth_[v].tangent_deg > options_.max_angle_deg)) continue;
      oblique += corners_of_[v];
      most = std::fmax(most, off);
    }
    add(report_,
        finding(Code::bitangent_not_orthogonal, oblique, " (by up to " + rounded(most, 3) + " deg)"));
    explain(
        subject_, signs_.of_triangle,
        [&](std::size_t c) {
          const Truth& t = truth_[mesh_.triangles[c / 3][c % 3]];
          return Directions{t.tangent, t.bitangent};
        },
        options_, report_);
  } else if (!subject_.mikktspace.empty()) {
    explain(
        subject_, signs_.of_triangle,
        [&](std::size_t c) {
          const Vec4<float>& m = subject_.mikktspace[c];
          const Vec3<double> n = mesh_.normals[mesh_.triangles[c / 3][c % 3]];
          if (m.w == 0 || !detail::finite(n))
            return Directions{detail::nan_vector<double>(), detail::nan_vector<double>()};
          const Vec3<double> t{m.x, m.y, m.z};
          return Directions{t, double{m.w} * cross(n, t)};
        },
        options_, report_);
  }
}

void Judge::add_notes() {
  std::size_t against_winding = 0;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh_.triangles[t];
    if (is_degenerate(mesh_.positions[a], mesh_.positions[b], mesh_.positions[c]))
      ++report_.degenerate_triangles;
    else if (!mesh_.uvs.empty() && signs_.of_triangle[t] == 0)
      ++report_.degenerate_uv_triangles;
    if (mesh_.normals.empty()) continue;
    const Vec3<double> face =
        cross(mesh_.positions[b] - mesh_.positions[a], mesh_.positions[c] - mesh_.positions[a]);
    const auto opposes = [&](std::uint32_t v) { return dot(face, mesh_.normals[v]) < 0; };
    if (opposes(a) && opposes(b) && opposes(c)) ++against_winding;
  }
  add(report_, finding(Code::normals_oppose_winding, 3 * against_winding));
  add(report_,
      finding(Code::reference_uncertain, undecided_,
              ": normals are known to " +
                  deviation_text(report_.normal_uncertainty_deg.rms(), 2, " deg rms") + ", tangents to " +
                  deviation_text(report_.tangent_uncertainty_deg.rms(), 2, " deg rms")));
  const std::size_t at_least_one = std::max<std::size_t>(mesh_.corners(), 1);
  add(report_, finding(Code::normals_inward, report_.inward));
  add(report_, finding(Code::tangent_missing, mesh_.tangents.empty() ? at_least_one : 0,
                       mesh_.normals.empty() ? "" : "; only its normals are judged"));
  add(report_, finding(Code::normal_missing, mesh_.normals.empty() ? at_least_one : 0));
  add(report_, finding(Code::triangles_missing, mesh_.triangles.empty() ? 1 : 0));
  add(report_, finding(Code::vertex_unreferenced,
                       static_cast<std::size_t>(std::count(corners_of_.begin(), corners_of_.end(), 0U))));
}

void Judge::decide() {
  const bool any_error = !report_.findings.empty() && report_.findings.front().severity == Severity::error;
  bool compared = false;
  for (const ClassReport& c : report_.classes) compared = compared || c.normal_deg || c.tangent_deg;
  report_.verdict = any_error                               ? Verdict::fail
                    : compared && 2 * undecided_ <= judged_ ? Verdict::pass
                                                            : Verdict::undetermined;
}

}  // namespace

MeshReport judge_subject(const Subject& subject, std::span<const Truth> truth,
                         const ValidateOptions& options) {
  return Judge(subject, truth, options).report();
}

MeshReport validate(const Mesh& mesh, const std::optional<PlacedSurface>& placed,
                    const ValidateOptions& options) {
  check_consistent(mesh, "mesh");
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
                                " vertices, permitted is one each or none");
  std::vector<bool> is_pole;
  for (const Truth& t : truth) is_pole.push_back(t.pole);
  Subject subject = prepare(mesh, options);
  subject.classes = classify(mesh, is_pole, subject.raw_sign);
  return judge_subject(subject, truth, options);
}

}  // namespace darboux
