#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include <darboux/assess.h>
#include <darboux/error.h>

#include "base/degrees.h"
#include "fit/common/kinds.h"
#include "fit/fit_kinds.h"
#include "mesh/area_vector.h"
#include "mesh/used_vertices.h"
#include "parts.h"
#include "recognise.h"
#include "surface_kind.h"
#include "uv_choice.h"
#include "validate/findings.h"

namespace darboux {
namespace {

constexpr std::size_t most_parts = 256;

void take(const Mesh& mesh, std::span<const signed char> signs, Recognition& result, MeshFit fit) {
  result.truth = truths(mesh, fit, signs);
  result.fit = std::move(fit);
}

// Whether the surface may be the mesh's, even if the uvs do not determine its chart.
bool is_near(const std::optional<MeshFit>& fit) {
  return fit && fit->rms_relative <= fits_below;
}

// Finds the declared surface through the mesh's uvs, or by its positions if there are no uvs or they are not
// the surface's own. \param signs of its triangles \param by_positions whether positions alone may suffice
Recognition find_declared(const Mesh& mesh, std::span<const signed char> signs, const AssessOptions& options,
                          bool by_positions = true) {
  Recognition result;
  try {
    auto [fit, limit] = options.exact_surface
                            ? fit_declared(mesh, *options.exact_surface, options.placement, signs)
                            : fit_declared(mesh, *options.surface, options.placement, signs);
    result.reason = nearest_fit(fit, limit);
    result.declared = fit.fits;
    if (fit.fits)
      take(mesh, signs, result, std::move(fit));
    else
      result.fit = std::move(fit);
  } catch (const UndeterminedError& e) {
    result.reason = std::string(": ") + e.what();
    result.identifiable = false;
  } catch (const MeshError& e) {
    result.reason = std::string(": ") + e.what();
  }
  if (result.fits() || !by_positions) return result;
  const std::string_view kind =
      options.exact_surface ? options.exact_surface->info().name : std::string_view(options.surface->name);
  if (options.exact_surface) {
    if (mesh.uvs.empty())
      result.reason = ": there are no uvs, which tell where a " + std::string(kind) + " lies";
    return result;
  }
  // For a disk of any size, positions determine its plane.
  const bool plane = kind == "disk" && options.surface->parameters.empty();
  if (auto fit = fit_positions(mesh, plane ? SurfaceSpecification{"plane", {}} : *options.surface,
                               options.placement)) {
    take(mesh, signs, result, std::move(*fit));
    result.declared = true;
  } else if (mesh.uvs.empty()) {
    result.reason = ": there are no uvs, and by the positions alone it is not " + fit::with_article(kind) +
                    " as declared";
  }
  return result;
}

Assessment assessment_of(const MeshUnderTest& under_test, Recognition recognition,
                         const AssessOptions& options, bool declared) {
  const bool fits = recognition.fits();
  const bool planar = fits && is_planar(kind_of(*recognition.fit));
  const Basis basis = declared || recognition.declared ? Basis::declared
                      : planar                         ? Basis::recognised_unsided
                                                       : Basis::recognised;
  Assessment result{std::move(recognition.fit), validate(under_test, recognition.truth, basis, options)};
  result.evidence = std::move(recognition.evidence);
  const Mesh& mesh = under_test.mesh;
  MeshReport& report = result.report;
  if (mesh.uvs.empty()) add(report, finding(Code::uv_missing, std::max<std::size_t>(mesh.corners(), 1)));
  if (fits || !options.references.analytic || (mesh.uvs.empty() && !declared)) return result;
  const std::size_t corners = std::max<std::size_t>(mesh.corners(), 1);
  // A declared surface that is near enough is not a mismatch, even if the fit cannot determine which of its
  // charts the uvs belong to.
  if (declared && recognition.identifiable && !is_near(result.fit)) {
    add(report, finding(Code::surface_mismatch, corners, recognition.reason));
    report.verdict = Verdict::fail;
  } else {
    add(report, finding(Code::surface_unknown, corners, recognition.reason));
    // The declared surface could not be compared, or nothing judged the mesh.
    if (declared && (!recognition.identifiable || report.reference == ReferenceKind::none)) {
      report.without_errors = std::max(report.without_errors, Verdict::undetermined);
      report.verdict = std::max(report.verdict, Verdict::undetermined);
    }
  }
  return result;
}

Assessment assess_whole(MeshUnderTest under_test, Recognition recognition, const AssessOptions& options) {
  classify_vertices(under_test, poles(recognition.truth), options);
  return assessment_of(under_test, std::move(recognition), options, options.declares_surface());
}

void check(const Mesh& mesh, const AssessOptions& options) {
  check_consistent(mesh, "mesh");
  if (options.surface) make_surface(*options.surface);  // throws for unknown names, whatever the mesh
}

// Replaces the vertex numbers of a part by those of the whole.
void renumber(MeshReport& report, const MeshPart& part) {
  const auto in_whole = [&](std::vector<ClassReport>& classes) {
    for (ClassReport& c : classes)
      if (c.worst) c.worst->vertex = part.vertices[c.worst->vertex];
  };
  in_whole(report.classes);
  if (report.local) in_whole(report.local->classes);
  if (report.mikktspace) in_whole(report.mikktspace->classes);
}

// Finds the parts of a mesh that are surfaces, and the triangles that are not.
class PartSearch {
 public:
  using Triangles = Cutter::Triangles;

  // \param charted for recognise()
  PartSearch(const MeshUnderTest& whole, const AssessOptions& options, SearchBudget& budget,
             std::optional<std::string_view> charted)
      : options_(options), budget_(budget), charted_(charted), cutter_(whole) {
    Triangles all(whole.mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    look_at(all, false);
    std::sort(recognised.begin(), recognised.end(),
              [](const MeshPart& a, const MeshPart& b) { return a.triangles.front() < b.triangles.front(); });
    std::sort(rest.begin(), rest.end());
  }

  // The unrecognised triangles as one part. \param whole the result for the whole mesh
  MeshPart rest_as_part(const Recognition& whole) {
    MeshPart part = cutter_.part(std::move(rest));
    part.recognition.reason = whole.reason;
    part.recognition.evidence = whole.evidence;
    return part;
  }

  std::vector<MeshPart> recognised;  // in the order of their first triangles
  Triangles rest;
  bool declared = false;        // the declared surface is among them
  std::size_t passed_over = 0;  // parts not examined because there are too many

 private:
  // Cuts at the borders of charts and where normals break; pieces that are not recognised then are cut at
  // their creases. The largest come first, as the number of examined parts is limited.
  void look_at(const Triangles& triangles, bool at_creases) {
    std::vector<Triangles> pieces = cutter_.pieces(triangles, at_creases);
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    const bool one = pieces.size() == 1;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (i >= most_parts) {
        ++passed_over;
        leave(pieces[i]);
        continue;
      }
      // A single piece was examined before: as the whole mesh, or before the cut at creases.
      if (!one && is_recognised(pieces[i])) continue;
      if (!at_creases && !charted_)
        look_at(pieces[i], true);
      else
        leave(pieces[i]);
    }
  }

  void leave(const Triangles& piece) { rest.insert(rest.end(), piece.begin(), piece.end()); }

  bool is_recognised(const Triangles& piece) {
    MeshPart part = cutter_.part(piece);
    part.recognition = recognise_part(part);
    if (!part.recognition.fits()) return false;
    declared |= part.recognition.declared;
    recognised.push_back(std::move(part));
    return true;
  }

  // Looks for the declared surface, else for any.
  Recognition recognise_part(const MeshPart& part) {
    if (!options_.declares_surface())
      return recognise(part.mesh, part.raw_sign, options_.placement, budget_, charted_);
    Recognition result = find_declared(part.mesh, part.raw_sign, options_, !charted_);
    if (result.fits() || charted_) return result;
    return recognise(part.mesh, part.raw_sign, {}, budget_);  // a given placement is the declared surface's
  }

  const AssessOptions& options_;
  SearchBudget& budget_;
  std::optional<std::string_view> charted_;
  Cutter cutter_;
};

std::vector<Assessment> assess_each(MeshUnderTest whole, std::vector<MeshPart> parts,
                                    const AssessOptions& options) {
  std::vector<bool> is_pole(whole.mesh.positions.size(), false);
  for (const MeshPart& p : parts)
    for (std::size_t v = 0; v < p.recognition.truth.size(); ++v)
      if (p.recognition.truth[v].pole) is_pole[p.vertices[v]] = true;
  classify_vertices(whole, is_pole, options);
  whole.between_parts = between_parts(whole, parts, options.max_angle_deg);
  const std::vector<bool>& between = whole.between_parts;
  for (std::uint32_t v = 0; v < between.size(); ++v)
    if (between[v] && !is_pole[v]) whole.classes.of_vertex[v] = VertexClass::crease;
  std::vector<Assessment> result;
  for (MeshPart& p : parts) {
    for (std::size_t v = 0; v < p.recognition.truth.size(); ++v)
      if (between[p.vertices[v]]) p.recognition.truth[v].normal = detail::nan_vector<double>();
    std::size_t corners = 0;
    for (const Triangle& triangle : p.mesh.triangles)
      for (const std::uint32_t v : triangle) corners += between[p.vertices[v]];
    AssessOptions of_part = options;
    const UvSets other_uvs = restrict_to(options.other_uvs, p);
    of_part.other_uvs = other_uvs;
    result.push_back(assessment_of(restrict_to(whole, p.mesh, p.vertices, p.triangles, options.max_angle_deg),
                                   std::move(p.recognition), of_part, false));
    result.back().part = result.size() - 1;
    add(result.back().report, finding(Code::crease_shared, corners));
    renumber(result.back().report, p);
    result.back().triangles = std::move(p.triangles);
  }
  return result;
}

Recognition recognise_whole(const MeshUnderTest& under_test, const AssessOptions& options,
                            SearchBudget& budget) {
  if (!options.references.analytic) return {};
  return options.declares_surface()
             ? find_declared(under_test.mesh, under_test.raw_sign, options)
             : recognise(under_test.mesh, under_test.raw_sign, options.placement, budget);
}

// If one assessment passes, undetermined parts do not make the mesh undetermined.
void close_what_is_left(std::vector<Assessment>& assessments) {
  const bool passes = std::any_of(assessments.begin(), assessments.end(), [](const Assessment& assessment) {
    return assessment.report.without_errors == Verdict::pass;
  });
  if (!passes) return;
  for (Assessment& assessment : assessments) pass_if_undetermined(assessment.report);
}

void note_budget(MeshReport& report, const SearchBudget& budget) {
  add(report, finding(Code::parts_in_brief, budget.searched_briefly()));
  add(report, finding(Code::budget_spent, budget.cut_short() ? std::max<std::size_t>(report.corners, 1) : 0));
}

// Calls assess_under_test(MeshUnderTest, options) with the uvs that the tangents follow, and reports them if
// they are not the mesh's.
template <class AssessUnderTest>
std::vector<Assessment> assess_by_uvs_followed(const Mesh& mesh, AssessOptions options,
                                               const AssessUnderTest& assess_under_test) {
  check(mesh, options);
  MeshUnderTest own = prepare(mesh, options);
  const std::optional<UvChoice> choice = choose_uvs(own, options);
  MeshUnderTest under_test = choice ? prepare_with_uvs_of(choice->mesh, std::move(own)) : std::move(own);
  if (choice) options.beside = nullptr;  // the uvs of `beside` are of the mesh's own set
  add_references(under_test, options);
  std::vector<Assessment> assessments = assess_under_test(std::move(under_test), options);
  if (!choice) return assessments;
  const std::size_t corners = std::max<std::size_t>(mesh.corners(), 1);
  if (choice->transformed) add(assessments.front().report, finding(Code::tangent_texture_transform, corners));
  if (choice->set) {
    for (Assessment& assessment : assessments) assessment.uv_set = choice->set;
    add(assessments.front().report,
        finding(Code::tangent_uv_set_used, corners, ": TEXCOORD_" + std::to_string(*choice->set)));
  }
  return assessments;
}

// Whether there are flat-shaded triangles that cut across the surface on which their vertices lie, like the
// flat base of a hemisphere.
bool has_caps(const MeshUnderTest& under_test, std::span<const Truth> truth) {
  const Mesh& mesh = under_test.mesh;
  if (mesh.normals.empty() || truth.empty()) return false;
  const double across = std::cos(50 / degrees_per_radian), own = std::cos(10 / degrees_per_radian);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!under_test.has_area[t]) continue;
    const Triangle& triangle = mesh.triangles[t];
    const Vec3<double> n = unit(area_vector(mesh, triangle));
    if (std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) {
          return std::fabs(dot(n, truth[v].normal)) < across &&
                 std::fabs(dot(n, unit(mesh.normals[v]))) > own;
        }))
      return true;
  }
  return false;
}

std::vector<Assessment> assess_whole_or_parts(MeshUnderTest under_test, const AssessOptions& options) {
  const Mesh& mesh = under_test.mesh;
  SearchBudget budget(options);
  Recognition whole = recognise_whole(under_test, options, budget);
  // A surface's own uvs are stronger evidence than positions: parts with charts of their own, such as the
  // halves of a mirrored mesh, take precedence over a whole whose uvs say nothing.
  const bool capped = whole.fits() && !options.declares_surface() && has_caps(under_test, whole.truth);
  const bool uncharted = whole.fits() && !capped && whole.fit->chart == UvChart::unknown && !mesh.uvs.empty();
  if (!options.references.analytic || (whole.fits() && !uncharted && !capped))
    return {assess_whole(std::move(under_test), std::move(whole), options)};

  std::optional<std::string_view> charted;
  if (uncharted) charted = whole.fit->surface.surface.info().name;
  PartSearch parts(under_test, options, budget, charted);
  if (uncharted && !parts.rest.empty()) parts.recognised.clear();
  if (capped && std::none_of(parts.recognised.begin(), parts.recognised.end(), [&](const MeshPart& part) {
        return kind_of(*part.recognition.fit) == kind_of(*whole.fit);
      }))
    parts.recognised.clear();
  if (options.declares_surface() && !parts.declared) parts.recognised.clear();
  if (parts.recognised.empty()) {
    Assessment result = assess_whole(std::move(under_test), std::move(whole), options);
    add(result.report, finding(Code::parts_too_many, parts.passed_over, " (counted in parts)"));
    note_budget(result.report, budget);
    return {std::move(result)};
  }
  if (!parts.rest.empty()) parts.recognised.push_back(parts.rest_as_part(whole));
  std::vector<Assessment> result = assess_each(std::move(under_test), std::move(parts.recognised), options);
  close_what_is_left(result);
  const std::vector<bool> used = used_vertices(mesh);
  MeshReport& first = result.front().report;
  add(first, finding(Code::vertex_unreferenced,
                     static_cast<std::size_t>(std::count(used.begin(), used.end(), false))));
  add(first, finding(Code::parts_too_many, parts.passed_over, " (counted in parts)"));
  note_budget(first, budget);
  return result;
}

}  // namespace

Assessment assess(const Mesh& mesh, const AssessOptions& options) {
  std::vector<Assessment> one =
      assess_by_uvs_followed(mesh, options, [](MeshUnderTest under_test, const AssessOptions& own_options) {
        SearchBudget budget(own_options);
        Recognition recognition = recognise_whole(under_test, own_options, budget);
        std::vector<Assessment> result;
        result.push_back(assess_whole(std::move(under_test), std::move(recognition), own_options));
        note_budget(result.front().report, budget);
        return result;
      });
  return std::move(one.front());
}

std::vector<Assessment> assess_parts(const Mesh& mesh, const AssessOptions& options) {
  return assess_by_uvs_followed(mesh, options, assess_whole_or_parts);
}

}  // namespace darboux
