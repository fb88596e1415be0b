#include <algorithm>

#include <darboux/error.h>
#include <darboux/judge.h>

#include "text.h"

namespace darboux {

Judgement judge(const Mesh& mesh, const JudgeOptions& options) {
  check_consistent(mesh, "mesh");
  if (options.surface) make_surface(*options.surface);  // refuses unknown names, whatever the mesh
  Judgement result;
  std::string reason;
  try {
    result.fit = options.surface ? fit_surface(mesh, *options.surface, options.placement)
                                 : fit_any_surface(mesh, options.placement);
    reason = "nearest is " + result.fit->surface.surface.specification(6) + " with an rms distance of " +
             rounded(result.fit->rms_relative, 2) + " of the mesh's size, permitted is " +
             rounded(fits_below, 1);
  } catch (const MeshError& e) {
    reason = e.what();
  }
  const bool fits = result.fit && result.fit->fits;
  std::vector<Truth> truth;
  if (fits)
    for (const Vec2<double>& uv : mesh.uvs) truth.push_back(truth_at(*result.fit, uv));
  result.report = validate(mesh, truth, options);
  if (fits) return result;

  auto& findings = result.report.findings;
  if (mesh.uvs.empty())
    findings.push_back(
        {"UV_MISSING", Severity::info, mesh.corners(), "the mesh has no uvs, so tangents have no truth"});
  if (options.surface && !mesh.uvs.empty()) {
    const auto first_other = std::find_if(findings.begin(), findings.end(),
                                          [](const Finding& f) { return f.severity != Severity::error; });
    findings.insert(first_other, {"SURFACE_MISMATCH", Severity::error, mesh.corners(),
                                  "the declared surface does not fit the positions at their uvs: " + reason});
    result.report.verdict = Verdict::fail;
  } else if (!mesh.uvs.empty()) {
    findings.push_back(
        {"SURFACE_UNKNOWN", Severity::info, mesh.corners(), "no surface of the catalogue fits: " + reason});
  }
  return result;
}

}  // namespace darboux
