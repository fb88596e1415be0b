#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include <darboux/assess.h>
#include <darboux/error.h>
#include <darboux/frame.h>

#include "fit/common/kinds.h"
#include "mesh/triangle_signs.h"
#include "recognise.h"
#include "uv_choice.h"
#include "validate/angles.h"
#include "validate/findings.h"
#include "validate/parts.h"

namespace darboux {
namespace {

constexpr std::size_t most_parts = 256;

void take(const Mesh& mesh, Recognised& result, MeshFit fit) {
  result.fit = std::move(fit);
  result.truth = truths(mesh, *result.fit);
}

// The declared surface through the mesh's uvs, and by its positions where there are none or the mesh is a
// part.
Recognised find_declared(const Mesh& mesh, const AssessOptions& options, bool part) {
  Recognised result;
  try {
    MeshFit fit = options.exact_surface ? fit_surface(mesh, *options.exact_surface, options.placement)
                                        : fit_surface(mesh, *options.surface, options.placement);
    result.reason = nearest_fit(fit);
    result.declared = fit.fits;
    if (fit.fits)
      take(mesh, result, std::move(fit));
    else
      result.fit = std::move(fit);
  } catch (const UndeterminedError& e) {
    result.reason = std::string(": ") + e.what();
    result.too_little = true;
  } catch (const MeshError& e) {
    result.reason = std::string(": ") + e.what();
  }
  if (result.fits() || !(mesh.uvs.empty() || part)) return result;
  const std::string_view kind =
      options.exact_surface ? options.exact_surface->info().name : std::string_view(options.surface->name);
  if (options.exact_surface) {
    if (mesh.uvs.empty())
      result.reason = ": there are no uvs, which tell where a " + std::string(kind) + " lies";
  } else if (auto fit = fit_positions(mesh, options.surface, options.placement)) {
    take(mesh, result, std::move(*fit));
    result.declared = true;
  } else if (mesh.uvs.empty()) {
    result.reason = ": there are no uvs, and by the positions alone it is not " + fit::with_article(kind) +
                    " as declared";
  }
  return result;
}

// A part: the declared surface, else any.
Recognised recognise_part(const Mesh& mesh, const AssessOptions& options, Effort& effort,
                          std::string_view charted) {
  if (!options.declares_surface())
    return recognise(mesh, triangle_signs(mesh), options.placement, effort, charted);
  Recognised result = find_declared(mesh, options, true);
  return result.fits()
             ? result
             : recognise(mesh, triangle_signs(mesh), {}, effort);  // the placement was the declared surface's
}

// Whose n may be on either side.
bool is_planar(const AnySurface& surface) {
  return surface.info().name == "plane" || surface.info().name == "disk";
}

Assessment assessment_of(const MeshUnderTest& under_test, Recognised recognised, const AssessOptions& options,
                         bool declared) {
  const bool fits = recognised.fits();
  const bool planar = fits && is_planar(recognised.fit->surface.surface);
  const Basis basis = declared || recognised.declared ? Basis::declared
                      : planar                        ? Basis::recognised_unsided
                                                      : Basis::recognised;
  Assessment result{std::move(recognised.fit), validate(under_test, recognised.truth, basis, options)};
  result.evidence = std::move(recognised.evidence);
  const Mesh& mesh = under_test.mesh;
  MeshReport& report = result.report;
  if (mesh.uvs.empty()) add(report, finding(Code::uv_missing, std::max<std::size_t>(mesh.corners(), 1)));
  if (fits || !options.references.analytic || (mesh.uvs.empty() && !declared)) return result;
  const std::size_t corners = std::max<std::size_t>(mesh.corners(), 1);
  // A declared surface that is near enough is no mismatch, even where the fit cannot tell which of its charts
  // it is.
  if (declared && !recognised.too_little && !(result.fit && result.fit->rms_relative <= fits_below)) {
    add(report, finding(Code::surface_mismatch, corners, recognised.reason));
    report.verdict = Verdict::fail;
  } else {
    add(report, finding(Code::surface_unknown, corners, recognised.reason));
    // What was declared could not be compared, nor anything else.
    if (declared && (recognised.too_little || report.reference == ReferenceKind::none)) {
      report.without_errors = std::max(report.without_errors, Verdict::undetermined);
      report.verdict = std::max(report.verdict, Verdict::undetermined);
    }
  }
  return result;
}

std::vector<bool> poles(const std::vector<Truth>& truth) {
  std::vector<bool> result;
  for (const Truth& t : truth) result.push_back(t.pole);
  return result;
}

Assessment assess_whole(MeshUnderTest under_test, Recognised recognised, const AssessOptions& options) {
  classify_vertices(under_test, poles(recognised.truth), options);
  return assessment_of(under_test, std::move(recognised), options, options.declares_surface());
}

void check(const Mesh& mesh, const AssessOptions& options) {
  check_consistent(mesh, "mesh");
  if (options.surface) make_surface(*options.surface);  // refuses unknown names, whatever the mesh
}

// Corner and vertex numbers of a part, in the whole.
void renumber(MeshReport& report, const Part& part) {
  const auto in_whole = [&](std::vector<ClassReport>& classes) {
    for (ClassReport& c : classes)
      if (c.worst) c.worst->vertex = part.vertices[c.worst->vertex];
  };
  in_whole(report.classes);
  if (report.local) in_whole(report.local->classes);
  if (report.mikktspace) in_whole(report.mikktspace->classes);
}

struct RecognisedPart {
  Part part;
  Recognised recognised;
};

// The parts of a mesh that are surfaces of their own, and the triangles that are none.
struct Parts {
  std::vector<RecognisedPart> recognised;  // in the order of their first triangles
  std::vector<std::uint32_t> rest;
  bool declared = false;        // the declared surface is among them
  std::size_t passed_over = 0;  // parts that were not looked at, as there are too many

  Parts(const Mesh& mesh, const AssessOptions& options, Effort& effort, std::string_view charted)
      : charted_(charted) {
    std::vector<std::uint32_t> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    look_at(mesh, options, effort, std::move(all), false);
    std::sort(recognised.begin(), recognised.end(), [](const RecognisedPart& a, const RecognisedPart& b) {
      return a.part.triangles.front() < b.part.triangles.front();
    });
    std::sort(rest.begin(), rest.end());
  }

 private:
  std::string_view charted_;  // what recognise() is asked for

  // Cuts at the borders of charts and where normals break, and what is not recognised then at its creases.
  // The largest first, as only so many are looked at.
  void look_at(const Mesh& whole, const AssessOptions& options, Effort& effort,
               std::vector<std::uint32_t> triangles, bool at_creases) {
    const Part from = part_of(whole, triangles);
    std::vector<std::vector<std::uint32_t>> pieces = parts_of(from.mesh, at_creases);
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    const bool one = pieces.size() == 1;
    const auto is_rest = [&](const std::vector<std::uint32_t>& piece) {
      for (const std::uint32_t t : piece) rest.push_back(from.triangles[t]);
    };
    if (one && at_creases) return is_rest(pieces.front());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (i >= most_parts) {
        ++passed_over;
        is_rest(pieces[i]);
        continue;
      }
      std::vector<std::uint32_t> of_whole;
      for (const std::uint32_t t : pieces[i]) of_whole.push_back(from.triangles[t]);
      Part part = part_of(whole, of_whole);
      // The whole mesh as one part was looked at before.
      Recognised found = one ? Recognised{} : recognise_part(part.mesh, options, effort, charted_);
      if (found.fits()) {
        declared |= found.declared;
        recognised.push_back({std::move(part), std::move(found)});
      } else if (!at_creases && charted_.empty()) {
        look_at(whole, options, effort, std::move(of_whole), true);
      } else {
        is_rest(pieces[i]);
      }
    }
  }
};

// Vertices that belong to two parts whose frames differ: no one normal, or no one tangent, is right for both.
// A vertex is that of another part where positions and normals are the same; uvs may differ, and so may the
// indices, as in files with one vertex per corner. \param parts those that are recognised and the rest
std::vector<bool> between_parts(const Mesh& mesh, const VertexJoins& joins,
                                std::span<const RecognisedPart> parts, double max_angle_deg) {
  const std::size_t n = joins.position_and_normal.size();
  struct First {
    std::uint32_t part, vertex;  // counted from 1; its vertex in the part
  };
  std::vector<First> first(n, First{0, 0});
  std::vector<bool> group(n, false);
  const double limit = max_angle_deg / degrees_per_radian;
  const auto differ = [&](const First& a, const First& b) {
    const RecognisedPart &p = parts[a.part - 1], &q = parts[b.part - 1];
    if (p.recognised.truth.empty() || q.recognised.truth.empty()) return true;
    const Truth &s = p.recognised.truth[a.vertex], &t = q.recognised.truth[b.vertex];
    if (s.pole || t.pole) return true;
    const double turn = angle_between(s.normal, t.normal);
    if (!(std::fmin(turn, std::numbers::pi - turn) <= limit)) return true;
    const std::uint32_t v = p.part.vertices[a.vertex], w = q.part.vertices[b.vertex];
    const bool one_tangent = !mesh.tangents.empty() && mesh.tangents[v] == mesh.tangents[w] &&
                             (mesh.uvs.empty() || mesh.uvs[v] == mesh.uvs[w]);
    return one_tangent && !(angle_between(s.tangent, t.tangent) <= limit);
  };
  for (std::uint32_t k = 0; k < parts.size(); ++k)
    for (std::uint32_t i = 0; i < parts[k].part.vertices.size(); ++i) {
      const std::uint32_t at = joins.position_and_normal[parts[k].part.vertices[i]];
      const First here{k + 1, i};
      if (first[at].part == 0) first[at] = here;
      if (first[at].part != here.part && differ(first[at], here)) group[at] = true;
    }
  std::vector<bool> result(n);
  for (std::uint32_t v = 0; v < n; ++v) result[v] = group[joins.position_and_normal[v]];
  return result;
}

std::vector<Assessment> assess_each(MeshUnderTest whole, std::vector<RecognisedPart> parts,
                                    const AssessOptions& options) {
  const Mesh& mesh = whole.mesh;
  std::vector<bool> is_pole(mesh.positions.size(), false);
  for (const RecognisedPart& p : parts)
    for (std::size_t v = 0; v < p.recognised.truth.size(); ++v)
      if (p.recognised.truth[v].pole) is_pole[p.part.vertices[v]] = true;
  classify_vertices(whole, is_pole, options);
  const std::vector<bool> between = between_parts(mesh, whole.joins, parts, options.max_angle_deg);
  whole.between_parts = between;
  for (std::uint32_t v = 0; v < between.size(); ++v)
    if (between[v] && !is_pole[v]) whole.classes.of_vertex[v] = VertexClass::crease;
  std::vector<Assessment> result;
  for (RecognisedPart& p : parts) {
    std::vector<bool> shared(p.part.vertices.size());
    for (std::size_t v = 0; v < shared.size(); ++v) {
      shared[v] = between[p.part.vertices[v]];
      if (shared[v] && !p.recognised.truth.empty())
        p.recognised.truth[v].normal = detail::nan_vector<double>();
    }
    std::size_t corners = 0;
    for (const Triangle& triangle : p.part.mesh.triangles)
      for (const std::uint32_t v : triangle) corners += shared[v];
    AssessOptions of_part = options;
    const UvSets other_uvs = restrict_to(options.other_uvs, p.part);
    of_part.other_uvs = other_uvs;
    result.push_back(assessment_of(restrict_to(whole, p.part), std::move(p.recognised), of_part, false));
    result.back().part = result.size() - 1;
    add(result.back().report, finding(Code::crease_shared, corners));
    renumber(result.back().report, p.part);
    result.back().triangles = std::move(p.part.triangles);
  }
  return result;
}

Recognised look_at_whole(const MeshUnderTest& under_test, const AssessOptions& options, Effort& effort) {
  if (!options.references.analytic) return {};
  return options.declares_surface()
             ? find_declared(under_test.mesh, options, false)
             : recognise(under_test.mesh, under_test.raw_sign, options.placement, effort);
}

void note_effort(MeshReport& report, const Effort& effort) {
  add(report, finding(Code::parts_in_brief, effort.searched_briefly()));
  add(report, finding(Code::budget_spent, effort.cut_short() ? std::max<std::size_t>(report.corners, 1) : 0));
}

// Calls judge_as(mesh, options) with the uvs that the tangents follow, and says which they are. Nothing where
// they are the mesh's.
template <class AssessMesh>
std::optional<std::vector<Assessment>> assess_by_other_uvs(const Mesh& mesh, const AssessOptions& options,
                                                           const AssessMesh& assess_mesh) {
  std::optional<UvChoice> choice = choose_uvs(mesh, options);
  if (!choice) return std::nullopt;
  Mesh other = mesh;
  other.uvs = std::move(choice->uvs);
  AssessOptions others = options;
  others.texture_transform.reset();
  others.names_uv_set = true;
  std::vector<Assessment> assessments = assess_mesh(other, others);
  const std::size_t corners = std::max<std::size_t>(mesh.corners(), 1);
  if (choice->transformed) add(assessments.front().report, finding(Code::tangent_texture_transform, corners));
  if (choice->set) {
    for (Assessment& j : assessments) j.uv_set = choice->set;
    add(assessments.front().report,
        finding(Code::tangent_uv_set_used, corners, ": TEXCOORD_" + std::to_string(*choice->set)));
  }
  return assessments;
}

}  // namespace

Assessment assess(const Mesh& mesh, const AssessOptions& options) {
  check(mesh, options);
  if (auto other = assess_by_other_uvs(
          mesh, options, [](const Mesh& m, const AssessOptions& o) { return std::vector{assess(m, o)}; }))
    return std::move(other->front());
  MeshUnderTest under_test = prepare(mesh, options);
  Effort effort(options.budget);
  Recognised recognised = look_at_whole(under_test, options, effort);
  Assessment result = assess_whole(std::move(under_test), std::move(recognised), options);
  note_effort(result.report, effort);
  return result;
}

std::vector<Assessment> assess_parts(const Mesh& mesh, const AssessOptions& options) {
  check(mesh, options);
  if (auto other = assess_by_other_uvs(mesh, options, assess_parts)) return std::move(*other);
  MeshUnderTest under_test = prepare(mesh, options);
  Effort effort(options.budget);
  Recognised whole = look_at_whole(under_test, options, effort);
  // Uvs that are a surface's own tell more than positions do: parts with charts of their own, as the halves
  // of a mirrored one, go before a whole whose uvs say nothing.
  const bool uncharted = whole.fits() && !options.declares_surface() &&
                         whole.fit->chart == UvChart::unknown && !mesh.uvs.empty();
  if (!options.references.analytic || (whole.fits() && !uncharted))
    return {assess_whole(std::move(under_test), std::move(whole), options)};

  Parts parts(mesh, options, effort, uncharted ? whole.fit->surface.surface.info().name : std::string_view());
  if (uncharted && !parts.rest.empty()) parts.recognised.clear();
  if (options.declares_surface() && !parts.declared) parts.recognised.clear();
  if (parts.recognised.empty()) {
    Assessment result = assess_whole(std::move(under_test), std::move(whole), options);
    add(result.report, finding(Code::parts_too_many, parts.passed_over, " (counted in parts)"));
    note_effort(result.report, effort);
    return {std::move(result)};
  }
  if (!parts.rest.empty()) {
    Recognised unknown;
    unknown.reason = whole.reason;
    unknown.evidence = whole.evidence;
    parts.recognised.push_back({part_of(mesh, std::move(parts.rest)), std::move(unknown)});
  }
  std::vector<Assessment> result = assess_each(std::move(under_test), std::move(parts.recognised), options);
  // What is left of a mesh of which something was assessed leaves nothing open.
  const bool assessed = std::any_of(result.begin(), result.end(), [](const Assessment& j) {
    return j.report.without_errors == Verdict::pass;
  });
  for (Assessment& j : result)
    if (assessed && j.report.without_errors == Verdict::undetermined) {
      j.report.without_errors = Verdict::pass;
      if (j.report.verdict == Verdict::undetermined) j.report.verdict = Verdict::pass;
    }
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) used[v] = true;
  MeshReport& first = result.front().report;
  add(first, finding(Code::vertex_unreferenced,
                     static_cast<std::size_t>(std::count(used.begin(), used.end(), false))));
  add(first, finding(Code::parts_too_many, parts.passed_over, " (counted in parts)"));
  note_effort(first, effort);
  return result;
}

}  // namespace darboux
