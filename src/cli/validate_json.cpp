#include "validate_files.h"

namespace darboux {
namespace {

Json classes_json(const std::vector<ClassReport>& classes) {
  Json json = Json::object();
  for (const ClassReport& c : classes) {
    Json entry{{"corners", c.corners}};
    if (c.normal_deg) {
      entry["normal_deg"] = statistics_json(*c.normal_deg);
      entry["normal_uncertainty_deg"] = spread_json(c.normal_uncertainty_deg);
    }
    if (c.tangent_deg) {
      entry["tangent_deg"] = statistics_json(*c.tangent_deg);
      if (c.tangent_uncertainty_deg.finite() + c.tangent_uncertainty_deg.infinite() > 0)
        entry["tangent_uncertainty_deg"] = spread_json(c.tangent_uncertainty_deg);
    }
    if (c.bitangent_deg) entry["bitangent_deg"] = statistics_json(*c.bitangent_deg);
    if (c.worst)
      entry["worst"] = {
          {"vertex", c.worst->vertex}, {"u", number(c.worst->uv.x)}, {"v", number(c.worst->uv.y)}};
    json[std::string(name_of(c.vertex_class))] = entry;
  }
  return json;
}

Json evidence_json(const std::optional<Evidence>& evidence) {
  if (!evidence) return nullptr;
  return {{"log10_odds", number(evidence->log10_odds)}, {"rival", evidence->rival}, {"text", evidence->text}};
}

// The surface with its placement and the uncertainties of both.
Json placed_surface_json(const MeshFit& fit) {
  Json surface = surface_json(fit.surface.surface);
  surface["placement"] = numbers({fit.surface.placement.data(), 16});
  surface["fit_rms"] = number(fit.rms);
  surface["fit_rms_relative"] = number(fit.rms_relative);
  surface["sigma"] = number(fit.sigma);
  surface["covariance"] = Json::array();
  for (const auto& row : fit.covariance.rowwise()) {
    surface["covariance"].push_back(Json::array());
    for (const double x : row) surface["covariance"].back().push_back(number(x));
  }
  surface["centre"] = array(from_eigen(fit.centre));
  return surface;
}

Json uv_json(const MeshFit& fit, int texcoord) {
  Json uv{{"convention", uv_convention(fit)}, {"texcoord", texcoord}};
  if (fit.chart == UvChart::own) {
    uv["affine"] = numbers(fit.surface.uv.affine);
    uv["equivalent"] = fit.equivalent;
  } else if (fit.chart == UvChart::projected) {
    uv["projection"] = numbers({fit.projection.data(), 9});
  }
  return uv;
}

// The references other than the surface.
Json references_json(const MeshReport& report) {
  Json references = Json::object();
  if (report.local) {
    Json& local = references["local"];
    local = {{"classes", classes_json(report.local->classes)}, {"compared", report.local->compared}};
    if (report.local->compared > 0) local["agreement"] = number(report.local->agreement);
  }
  if (report.triangles)
    references["triangles"] = {{"judged", report.triangles->compared},
                               {"open", report.triangles->open},
                               {"outside", report.triangles->outside},
                               {"worst_deg", number(report.triangles->worst_deg)}};
  if (report.mikktspace)
    references["mikktspace"] = {{"equal_bits", number(report.mikktspace->equal_bits)},
                                {"variant", name_of(report.mikktspace->variant)},
                                {"classes", classes_json(report.mikktspace->classes)}};
  return references;
}

Json findings_json(const AssessedPrimitive& assessed, std::size_t which, bool with_baseline) {
  Json findings = Json::array();
  const std::vector<Finding>& list = assessed.assessments[which].report.findings;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Finding& f = list[k];
    const Severity own = assessed.own_severities[which][k];
    Json entry{{"code", f.code}, {"severity", name_of(f.severity)}};
    if (own != f.severity) entry["own_severity"] = name_of(own);
    entry["count"] = f.count;
    entry["message"] = f.message;
    entry["to_do"] = f.to_do;
    if (with_baseline) entry["baseline"] = assessed.known_count(code_of(f), own);
    findings.push_back(std::move(entry));
  }
  return findings;
}

Json assessment_json(const AssessedPrimitive& assessed, std::size_t which, bool with_baseline) {
  const Assessment& assessment = assessed.assessments[which];
  const Primitive& primitive = assessed.primitive;
  const MeshReport& report = assessment.report;
  Json json{{"mesh", primitive.mesh},
            {"primitive", primitive.primitive},
            {"name", primitive.name},
            {"corners", report.corners},
            {"verdict", name_of(report.verdict)},
            {"needs_tangents", primitive.needs_tangents ? Json(*primitive.needs_tangents) : Json()}};
  if (assessment.part) json["part"] = *assessment.part;
  const bool fits = assessment.fit && assessment.fit->fits;
  json["surface"] = fits ? placed_surface_json(*assessment.fit) : Json();
  json["evidence"] = evidence_json(assessment.evidence);
  json["uv"] = fits ? uv_json(*assessment.fit, assessment.uv_set.value_or(primitive.texcoord)) : Json();
  json["reference"] = name_of(report.reference);
  json["references"] = references_json(report);
  json["frame_uncertainty_deg"] = nullptr;
  if (has_uncertainty(report))
    json["frame_uncertainty_deg"] = {{"normal", spread_json(report.normal_uncertainty_deg)},
                                     {"tangent", spread_json(report.tangent_uncertainty_deg)}};
  json["handedness"] = {{"convention", name_of(report.handedness.convention)},
                        {"consistent", number(report.handedness.consistent)},
                        {"wrong", report.handedness.wrong}};
  json["zero_tangents"] = report.zero_tangents;
  json["non_unit"] = report.non_unit;
  json["non_orthogonal"] = report.non_orthogonal;
  json["non_finite"] = report.non_finite;
  json["faceted"] = report.faceted;
  json["degenerate_triangles"] = report.degenerate_triangles;
  json["degenerate_uv_triangles"] = report.degenerate_uv_triangles;
  json["classes"] = classes_json(report.classes);
  if (!assessed.map_costs.empty()) json["normal_map"] = map_cost_json(assessed.map_costs[which].cost);
  json["findings"] = findings_json(assessed, which, with_baseline);
  return json;
}

Json file_json(const AssessedFile& file, bool with_baseline) {
  Json json{{"file", file.path}, {"verdict", name_of(file.verdict)}};
  if (with_baseline) json["worse"] = file.worse;
  if (!file.readable()) json["error"] = file.error;
  json["meshes"] = Json::array();
  for (const AssessedPrimitive& p : file.primitives)
    for (std::size_t a = 0; a < p.assessments.size(); ++a)
      json["meshes"].push_back(assessment_json(p, a, with_baseline));
  json["skipped"] = skipped_json(file.skipped);
  return json;
}

}  // namespace

Json report_json(const std::vector<AssessedFile>& files, bool with_baseline) {
  Json list = Json::array();
  Verdict verdict = Verdict::nothing;
  bool worse = false;
  for (const AssessedFile& file : files) {
    verdict = std::max(verdict, file.verdict);
    worse |= file.worse;
    list.push_back(file_json(file, with_baseline));
  }
  Json verdicts = Json::object(), codes = Json::object(), by_severity = Json::object(),
       ignored = Json::object();
  const auto add = [](Json& counts, std::string_view name, std::size_t n) {
    Json& count = counts[std::string(name)];
    count = (count.is_null() ? std::size_t{0} : count.get<std::size_t>()) + n;
  };
  for (const std::string_view name : verdict_names) verdicts[std::string(name)] = 0;
  for (const AssessedFile& file : files) {
    add(verdicts, name_of(file.verdict), 1);
    for (const AssessedPrimitive& p : file.primitives)
      p.each_finding([&](const Assessment&, const Finding& f, Severity) {
        add(codes, f.code, f.count);
        add(by_severity[std::string(f.code)], name_of(f.severity), f.count);
      });
    for (const auto& [code, n] : file.ignored) add(ignored, code, n);
  }
  Json json{{"schema_version", 1},
            {"tool_version", DARBOUX_VERSION},
            {"files", std::move(list)},
            {"totals",
             {{"verdicts", std::move(verdicts)},
              {"codes", std::move(codes)},
              {"codes_by_severity", std::move(by_severity)}}},
            {"ignored", std::move(ignored)},
            {"verdict", name_of(verdict)}};
  if (with_baseline) json["worse"] = worse;
  return json;
}

}  // namespace darboux
