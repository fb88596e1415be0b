#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/frame.h>
#include <darboux/local_truth.h>
#include <darboux/mesh_frames.h>
#include <darboux/validate.h>

#include "text.h"

namespace darboux {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr double unit_tolerance = 0.0005;      // of |t|², as the Khronos glTF validator
constexpr double orthogonal_tolerance = 0.02;  // of t·n
constexpr double certain = 3;                  // standard deviations
constexpr double rounding_deg = 1e-10;         // what rounding may turn a frame by, beside any noise
constexpr double expected_agreement = 0.8;  // of two references; their error bars cover less on coarse meshes

// The errors, in the order in which a corner is assigned to the first that fits.
enum Defect : std::size_t {
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
  defects,
};

struct DefectText {
  std::string_view code, message;
};
constexpr std::array<DefectText, defects> defect_texts{{
    {"TANGENT_NOT_FINITE", "tangents hold NaN or infinity"},
    {"TANGENT_ZERO", "tangents are zero: no direction for the normal map here"},
    {"TANGENT_NOT_UNIT", "tangents are not of unit length"},
    {"TANGENT_INVALID_SIGN", "w of the tangent is neither +1 nor -1"},
    {"TANGENT_NOT_ORTHOGONAL", "tangents lean on the normal (|t.n| > 0.02)"},
    {"TANGENT_HANDEDNESS", "w differs from the rest of its uv island: the normal map is mirrored here"},
    {"TANGENT_ANGLE", "tangents point away from the true direction by more than permitted"},
    {"NORMAL_NOT_FINITE", "normals hold NaN or infinity"},
    {"NORMAL_NOT_UNIT", "normals are not of unit length"},
    {"NORMAL_ANGLE", "normals point away from the true direction by more than permitted"},
    {"POSITION_NOT_FINITE", "positions hold NaN or infinity"},
    {"UV_NOT_FINITE", "uvs hold NaN or infinity"},
}};

bool finite(const Vec2<double>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y);
}
bool finite(const Vec4<double>& a) {
  return detail::finite(a.xyz()) && std::isfinite(a.w);
}
bool is_unit(const Vec3<double>& a) {
  return std::fabs(1 - dot(a, a)) <= unit_tolerance;
}

// What is the same for every corner of a vertex.
struct VertexFacts {
  bool position_finite, uv_finite = true, normal_finite = true, normal_unit = true;
  bool tangent_finite = true, tangent_zero = false, tangent_unit = true, sign_valid = true, orthogonal = true;
  // Degrees against the truth; negative where there is nothing to compare.
  double normal_deg = -1, tangent_deg = -1, bitangent_raw_deg = -1, bitangent_gltf_deg = -1;
};

// An angle that is known to a standard deviation against what is permitted.
bool is_beyond(double angle, double deviation, double limit) {
  return angle - certain * deviation > limit;
}
bool is_undecided(double angle, double deviation, double limit) {
  return angle >= 0 && !is_beyond(angle, deviation, limit) && !(angle + certain * deviation <= limit);
}

VertexFacts stored_facts(const Mesh& mesh, std::uint32_t v) {
  VertexFacts f{.position_finite = detail::finite(mesh.positions[v])};
  if (!mesh.uvs.empty()) f.uv_finite = finite(mesh.uvs[v]);
  if (!mesh.normals.empty()) {
    f.normal_finite = detail::finite(mesh.normals[v]);
    f.normal_unit = is_unit(mesh.normals[v]);
  }
  if (!mesh.tangents.empty()) {
    const Vec4<double>& t = mesh.tangents[v];
    f.tangent_finite = finite(t);
    f.tangent_zero = t.xyz() == Vec3<double>{};
    f.tangent_unit = is_unit(t.xyz());
    f.sign_valid = t.w == 1 || t.w == -1;
    if (!mesh.normals.empty() && f.normal_finite && f.tangent_finite)
      f.orthogonal = std::fabs(dot(t.xyz(), mesh.normals[v])) <= orthogonal_tolerance;
  }
  return f;
}

// A mesh seen from inside, compared with -n: at most corners the normal and the winding both oppose the surface's n.
bool faces_inward(const Mesh& mesh, std::span<const Truth> truth) {
  std::size_t against = 0;
  if (mesh.normals.empty()) return false;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3<double> face =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const std::uint32_t v : {a, b, c})
      against += dot(mesh.normals[v], truth[v].normal) < 0 && dot(face, truth[v].normal) < 0;
  }
  return 2 * against > mesh.corners();
}

void compare_with_truth(const Mesh& mesh, std::uint32_t v, const Truth& truth, bool inward, VertexFacts& f) {
  f.normal_deg = f.tangent_deg = f.bitangent_raw_deg = f.bitangent_gltf_deg = -1;
  if (!f.uv_finite || !detail::finite(truth.normal)) return;
  const auto angle = [](const Vec3<double>& a, const Vec3<double>& b) {
    return degrees * angle_between(a, b);
  };
  const bool has_normal = !mesh.normals.empty() && f.normal_finite && mesh.normals[v] != Vec3<double>{};
  if (has_normal) f.normal_deg = angle(mesh.normals[v], inward ? -truth.normal : truth.normal);
  if (mesh.tangents.empty() || !f.tangent_finite || f.tangent_zero) return;
  const Vec4<double>& t = mesh.tangents[v];
  f.tangent_deg = angle(t.xyz(), truth.tangent);
  if (!has_normal || !f.sign_valid) return;
  const Vec3<double> stored = t.w * cross(mesh.normals[v], t.xyz());
  f.bitangent_raw_deg = angle(stored, truth.bitangent);
  f.bitangent_gltf_deg = angle(-stored, truth.bitangent);
}

// The raw sign of each triangle, 0 without uv area.
std::vector<int> triangle_signs(const Mesh& mesh) {
  std::vector<int> signs(mesh.triangles.size(), 0);
  if (mesh.uvs.empty()) return signs;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (!is_degenerate(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]))
      signs[t] = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) > 0 ? 1 : -1;
  }
  return signs;
}

struct SignCount {
  std::size_t raw = 0, gltf = 0;
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

// The statistics of one comparison; truth: at each vertex, empty where there is none.
std::vector<ClassReport> class_reports(const Mesh& mesh, const MeshClasses& classes,
                                       const std::vector<VertexFacts>& facts, std::span<const Truth> truth,
                                       bool raw_convention) {
  struct Sums {
    std::size_t corners = 0;
    std::vector<double> normal, tangent, bitangent;
    Spread normal_uncertainty, tangent_uncertainty;
    double worst = -1;
    std::uint32_t worst_vertex = 0;
  };
  std::array<Sums, vertex_class_names.size()> sums;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      const VertexFacts& f = facts[v];
      Sums& s = sums[static_cast<std::size_t>(classes.of_vertex[v])];
      ++s.corners;
      const double bitangent_deg = raw_convention ? f.bitangent_raw_deg : f.bitangent_gltf_deg;
      if (f.normal_deg >= 0) {
        s.normal.push_back(f.normal_deg);
        s.normal_uncertainty.add(truth[v].normal_deg);
      }
      if (f.tangent_deg >= 0) {
        s.tangent.push_back(f.tangent_deg);
        s.tangent_uncertainty.add(truth[v].tangent_deg);
      }
      if (bitangent_deg >= 0) s.bitangent.push_back(bitangent_deg);
      const double judged = mesh.tangents.empty() ? f.normal_deg : f.tangent_deg;
      if (judged > s.worst) {
        s.worst = judged;
        s.worst_vertex = v;
      }
    }
  std::vector<ClassReport> reports;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    Sums& s = sums[k];
    if (s.corners == 0) continue;
    const auto summary = [](std::vector<double>& values) {
      return values.empty() ? std::nullopt : std::optional<Statistics>(summarise(values));
    };
    ClassReport entry{static_cast<VertexClass>(k), s.corners,    summary(s.normal),    summary(s.tangent),
                      summary(s.bitangent),        std::nullopt, s.normal_uncertainty, s.tangent_uncertainty};
    if (s.worst >= 0) entry.worst = WorstCorner{s.worst_vertex, mesh.uvs[s.worst_vertex]};
    reports.push_back(entry);
  }
  return reports;
}

// Whether two references are the same as far as either is known.
bool agree(const Truth& a, const Truth& b) {
  const auto within = [](double angle, double one, double other) {
    return degrees * angle <= certain * std::hypot(one, other) + rounding_deg;
  };
  const double normal = angle_between(a.normal, b.normal);
  return within(std::fmin(normal, std::numbers::pi - normal), a.normal_deg, b.normal_deg) &&
         within(angle_between(a.tangent, b.tangent), a.tangent_deg, b.tangent_deg);
}

bool known(const Truth& t) {
  return detail::finite(t.normal) && detail::finite(t.tangent) && std::isfinite(t.normal_deg) &&
         std::isfinite(t.tangent_deg);
}

LocalReport compare_with_neighbours(const Mesh& mesh, const MeshClasses& classes,
                                    std::vector<VertexFacts> facts, std::span<const Truth> truth,
                                    bool raw_convention) {
  const std::vector<Truth> local = local_truth(mesh);
  for (std::uint32_t v = 0; v < local.size(); ++v) compare_with_truth(mesh, v, local[v], false, facts[v]);
  LocalReport report{class_reports(mesh, classes, facts, local, raw_convention)};
  if (truth.empty()) return report;
  std::size_t agreeing = 0;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      if (classes.of_vertex[v] != VertexClass::interior || !known(truth[v]) || !known(local[v])) continue;
      ++report.compared;
      agreeing += agree(truth[v], local[v]);
    }
  if (report.compared > 0)
    report.agreement = static_cast<double>(agreeing) / static_cast<double>(report.compared);
  return report;
}

}  // namespace

MeshReport validate(const Mesh& mesh, const std::optional<PlacedSurface>& placed,
                    const ValidateOptions& options) {
  check_consistent(mesh, "mesh");
  std::vector<Truth> truth;
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
  MeshReport report;
  report.corners = mesh.corners();
  report.reference = truth.empty() ? "none" : "analytic";
  const bool analytic = report.reference == "analytic", has_tangents = !mesh.tangents.empty();
  const std::size_t n = mesh.positions.size();

  std::vector<bool> is_pole(n, false);
  if (analytic) {
    for (std::size_t v = 0; v < n; ++v) is_pole[v] = truth[v].pole;
    report.inward = faces_inward(mesh, truth);
  }
  std::vector<VertexFacts> facts(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    facts[v] = stored_facts(mesh, v);
    if (analytic) compare_with_truth(mesh, v, truth[v], report.inward, facts[v]);
  }

  const MeshClasses classes = classify(mesh, is_pole);
  const std::vector<int> raw_sign = triangle_signs(mesh);
  SignCount signs;
  std::vector<SignCount> island_signs(static_cast<std::size_t>(classes.islands));
  // Calls f(triangle, corner, vertex) for each corner whose w can be judged.
  const auto for_each_signed_corner = [&](auto f) {
    if (!has_tangents) return;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t])
        if (raw_sign[t] != 0 && facts[v].sign_valid && facts[v].tangent_finite && !facts[v].tangent_zero)
          f(t, v);
  };
  for_each_signed_corner([&](std::size_t t, std::uint32_t v) {
    const bool raw = mesh.tangents[v].w == raw_sign[t];
    SignCount& island = island_signs[static_cast<std::size_t>(classes.island_of_triangle[t])];
    ++(raw ? signs.raw : signs.gltf);
    ++(raw ? island.raw : island.gltf);
  });
  report.handedness = judge_handedness(signs);
  const bool raw_convention = signs.raw > signs.gltf;

  std::array<std::size_t, defects> defect_count{};
  std::array<double, defects> worst_angle{};
  std::size_t pole_beyond = 0, against_winding = 0;
  double pole_worst = 0;
  std::size_t undecided = 0, judged = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (is_degenerate(mesh.positions[a], mesh.positions[b], mesh.positions[c]))
      ++report.degenerate_triangles;
    else if (!mesh.uvs.empty() && raw_sign[t] == 0)
      ++report.degenerate_uv_triangles;
    if (!mesh.normals.empty()) {
      const Vec3<double> face =
          cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
      const auto opposes = [&](std::uint32_t v) { return dot(face, mesh.normals[v]) < 0; };
      if (opposes(a) && opposes(b) && opposes(c)) ++against_winding;
    }
    for (const std::uint32_t v : mesh.triangles[t]) {
      const VertexFacts& f = facts[v];
      const VertexClass vertex_class = classes.of_vertex[v];
      const bool pole = vertex_class == VertexClass::pole;
      const double limit = options.max_angle_deg * (vertex_class == VertexClass::interior ? 1 : 3);
      const double normal_deviation = analytic ? truth[v].normal_deg : 0,
                   tangent_deviation = analytic ? truth[v].tangent_deg : 0;
      std::array<bool, defects> has{};
      if (has_tangents) {
        has[tangent_not_finite] = !f.tangent_finite;
        has[tangent_zero] = f.tangent_zero;
        has[tangent_not_unit] = !f.tangent_unit;
        has[tangent_invalid_sign] = !f.sign_valid;
        has[tangent_not_orthogonal] = !f.orthogonal;
        has[tangent_angle] = !pole && is_beyond(f.tangent_deg, tangent_deviation, limit);
        if (raw_sign[t] != 0 && f.sign_valid) {
          const SignCount& island = island_signs[static_cast<std::size_t>(classes.island_of_triangle[t])];
          const bool raw = mesh.tangents[v].w == raw_sign[t];
          // Where both signs hold half the island, the mesh's convention decides.
          const bool island_raw = island.raw == island.gltf ? raw_convention : island.raw > island.gltf;
          has[tangent_handedness] = raw != island_raw;
        }
      }
      has[normal_not_finite] = !f.normal_finite;
      has[normal_not_unit] = !f.normal_unit;
      has[normal_angle] = !pole && is_beyond(f.normal_deg, normal_deviation, limit);
      has[position_not_finite] = !f.position_finite;
      has[uv_not_finite] = !f.uv_finite;
      const auto first = std::find(has.begin(), has.end(), true);
      if (first != has.end()) ++defect_count[static_cast<std::size_t>(first - has.begin())];
      worst_angle[tangent_angle] =
          std::fmax(worst_angle[tangent_angle], has[tangent_angle] ? f.tangent_deg : 0);
      worst_angle[normal_angle] = std::fmax(worst_angle[normal_angle], has[normal_angle] ? f.normal_deg : 0);

      report.zero_tangents += has[tangent_zero];
      report.non_finite += has[tangent_not_finite] || !f.normal_finite || !f.position_finite || !f.uv_finite;
      report.non_unit += has_tangents && f.tangent_finite && !f.tangent_zero && !f.tangent_unit;
      report.non_orthogonal += has[tangent_not_orthogonal];
      if (pole && f.tangent_deg > limit) {
        ++pole_beyond;
        pole_worst = std::fmax(pole_worst, f.tangent_deg);
      }

      if (!analytic || !f.uv_finite) continue;
      report.normal_uncertainty_deg.add(truth[v].normal_deg);
      report.tangent_uncertainty_deg.add(truth[v].tangent_deg);
      if (pole || (f.normal_deg < 0 && f.tangent_deg < 0)) continue;
      ++judged;
      undecided += first == has.end() && (is_undecided(f.normal_deg, normal_deviation, limit) ||
                                          is_undecided(f.tangent_deg, tangent_deviation, limit));
    }
  }
  report.classes = class_reports(mesh, classes, facts, truth, raw_convention);
  if (options.local && !mesh.uvs.empty())
    report.local = compare_with_neighbours(mesh, classes, facts, truth, raw_convention);

  for (std::size_t d = 0; d < defects; ++d) {
    if (defect_count[d] == 0) continue;
    std::string message(defect_texts[d].message);
    if (worst_angle[d] > 0)
      message += " (worst " + rounded(worst_angle[d], 4) + " deg, permitted " +
                 rounded(options.max_angle_deg, 4) + " in the interior, " +
                 rounded(3 * options.max_angle_deg, 4) + " elsewhere)";
    report.findings.push_back({defect_texts[d].code, Severity::error, defect_count[d], message});
  }
  const auto note = [&](std::string_view code, Severity severity, std::size_t count, std::string message) {
    if (count > 0) report.findings.push_back({code, severity, count, std::move(message)});
  };
  note("NORMALS_OPPOSE_WINDING", Severity::warning, 3 * against_winding,
       "triangles are wound clockwise as seen along their normals");
  note("HANDEDNESS_MIXED", Severity::warning,
       report.handedness.convention == "mixed" ? report.handedness.wrong : 0,
       "w follows neither sign convention throughout; the smaller part is counted. Where uvs jump back "
       "inside triangles "
       "(a seam with shared vertices), their uv area has the wrong sign");
  if (report.local && report.local->compared > 0 && report.local->agreement < expected_agreement)
    note("REFERENCES_DISAGREE", Severity::warning, report.local->compared,
         "the surface's frames and those of the mesh's own positions and uvs agree at " +
             rounded(100 * report.local->agreement, 3) +
             " % of interior corners: the positions stray from the surface in waves, or the uvs are others");
  note("REFERENCE_UNCERTAIN", Severity::info, undecided,
       "angles lie within three standard deviations of the limit, as well as the surface is known: normals "
       "to " +
           deviation_text(report.normal_uncertainty_deg.rms(), 2, " deg rms") + ", tangents to " +
           deviation_text(report.tangent_uncertainty_deg.rms(), 2, " deg rms"));
  note("POLE_TANGENT", Severity::info, pole_beyond,
       "tangents at a pole differ from the limit for their own u by up to " + rounded(pole_worst, 4) +
           " deg; at a pole no direction is right for every texture");
  note("NORMALS_INWARD", Severity::info, report.inward ? mesh.corners() : 0,
       "normals and triangles face the inside of the surface; they were compared with its inward normal");
  note("TANGENT_MISSING", Severity::info, has_tangents ? 0 : std::max<std::size_t>(mesh.corners(), 1),
       mesh.normals.empty() ? "the mesh stores no tangents"
                            : "the mesh stores no tangents; only its normals are judged");
  note("NORMAL_MISSING", Severity::info, mesh.normals.empty() ? std::max<std::size_t>(mesh.corners(), 1) : 0,
       "the mesh stores no normals: neither they nor bitangents are judged");
  note("TRIANGLES_MISSING", Severity::info, mesh.triangles.empty(),
       "the primitive has no triangle (counted in primitives)");
  {
    std::vector<bool> referenced(n, false);
    for (const Triangle& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) referenced[v] = true;
    note("VERTEX_UNREFERENCED", Severity::info,
         static_cast<std::size_t>(std::count(referenced.begin(), referenced.end(), false)),
         "vertices that no triangle uses (counted in vertices), not judged");
  }
  const bool any_error = !report.findings.empty() && report.findings.front().severity == Severity::error;
  bool compared = false;
  for (const ClassReport& c : report.classes) compared = compared || c.normal_deg || c.tangent_deg;
  report.verdict = any_error                             ? Verdict::fail
                   : compared && 2 * undecided <= judged ? Verdict::pass
                                                         : Verdict::undetermined;
  return report;
}

}  // namespace darboux
