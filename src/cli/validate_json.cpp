#include "validate_files.h"

namespace darboux {
namespace {

Json statistics_json(const Statistics& s) {
  return {{"max", number(s.max)}, {"rms", number(s.rms)}, {"p95", number(s.p95)}};
}

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
    json[std::string(vertex_class_names[static_cast<std::size_t>(c.vertex_class)])] = entry;
  }
  return json;
}

std::string_view name_of(Severity severity) {
  return severity_names[static_cast<std::size_t>(severity)];
}

Json assessment_json(const AssessedPrimitive& assessed, std::size_t which, bool with_baseline) {
  const Assessment& assessment = assessed.assessments[which];
  const std::vector<Severity>& own_severities = assessed.own_severities[which];
  const Primitive& primitive = assessed.primitive;
  const MeshReport& report = assessment.report;
  Json json{{"mesh", primitive.mesh},
            {"primitive", primitive.primitive},
            {"name", primitive.name},
            {"corners", report.corners},
            {"verdict", verdict_names[static_cast<std::size_t>(report.verdict)]}};
  if (assessment.part) json["part"] = *assessment.part;
  json["surface"] = nullptr;
  json["evidence"] = nullptr;
  if (assessment.evidence)
    json["evidence"] = {{"log10_odds", number(assessment.evidence->log10_odds)},
                        {"rival", assessment.evidence->rival},
                        {"text", assessment.evidence->text}};
  json["uv"] = nullptr;
  if (assessment.fit && assessment.fit->fits) {
    const MeshFit& fit = *assessment.fit;
    Json surface = surface_json(fit.surface.surface);
    Json placement = Json::array(), affine = Json::array();
    for (Eigen::Index k = 0; k < 16; ++k)
      placement.push_back(number(fit.surface.placement.matrix()(k % 4, k / 4)));
    surface["placement"] = placement;
    surface["fit_rms"] = number(fit.rms);
    surface["fit_rms_relative"] = number(fit.rms_relative);
    surface["sigma"] = number(fit.sigma);
    surface["covariance"] = Json::array();
    for (const auto& row : fit.covariance.rowwise()) {
      surface["covariance"].push_back(Json::array());
      for (const double x : row) surface["covariance"].back().push_back(number(x));
    }
    surface["centre"] = {number(fit.centre.x()), number(fit.centre.y()), number(fit.centre.z())};
    json["surface"] = surface;
    json["uv"] = {{"convention", uv_convention(fit)},
                  {"texcoord", assessment.uv_set.value_or(primitive.texcoord)}};
    if (fit.chart == UvChart::own) {
      for (const double x : fit.surface.uv.affine) affine.push_back(number(x));
      json["uv"]["affine"] = affine;
      json["uv"]["equivalent"] = fit.equivalent;
    } else if (fit.chart == UvChart::projected) {
      for (Eigen::Index k = 0; k < 9; ++k) affine.push_back(number(fit.projection(k % 3, k / 3)));
      json["uv"]["projection"] = affine;
    }
  }
  json["reference"] = report.reference;
  json["references"] = Json::object();
  if (report.local) {
    Json local{{"classes", classes_json(report.local->classes)}, {"compared", report.local->compared}};
    if (report.local->compared > 0) local["agreement"] = number(report.local->agreement);
    json["references"]["local"] = local;
  }
  if (report.triangles)
    json["references"]["triangles"] = {{"judged", report.triangles->compared},
                                       {"outside", report.triangles->outside},
                                       {"worst_deg", number(report.triangles->worst_deg)}};
  if (report.mikktspace)
    json["references"]["mikktspace"] = {{"equal_bits", number(report.mikktspace->equal_bits)},
                                        {"variant", report.mikktspace->variant},
                                        {"classes", classes_json(report.mikktspace->classes)}};
  json["frame_uncertainty_deg"] = nullptr;
  if (report.reference == "analytic" || report.reference == "local")
    json["frame_uncertainty_deg"] = {{"normal", spread_json(report.normal_uncertainty_deg)},
                                     {"tangent", spread_json(report.tangent_uncertainty_deg)}};
  json["handedness"] = {{"convention", report.handedness.convention},
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
  json["findings"] = Json::array();
  for (std::size_t k = 0; k < report.findings.size(); ++k) {
    const Finding& f = report.findings[k];
    const Severity own = own_severities[k];
    Json entry{{"code", f.code}, {"severity", name_of(f.severity)}};
    if (own != f.severity) entry["own_severity"] = name_of(own);
    entry["count"] = f.count;
    entry["message"] = f.message;
    entry["to_do"] = f.to_do;
    if (with_baseline) entry["baseline"] = assessed.known_count(f.code, own);
    json["findings"].push_back(std::move(entry));
  }
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
    Json entry{{"file", file.path}, {"verdict", verdict_names[static_cast<std::size_t>(file.verdict)]}};
    if (with_baseline) entry["worse"] = file.worse;
    if (!file.error.empty()) entry["error"] = file.error;
    entry["meshes"] = Json::array();
    for (const AssessedPrimitive& p : file.primitives)
      for (std::size_t a = 0; a < p.assessments.size(); ++a)
        entry["meshes"].push_back(assessment_json(p, a, with_baseline));
    entry["skipped"] = Json::array();
    for (const SkippedPrimitive& s : file.skipped)
      entry["skipped"].push_back({{"mesh", s.mesh}, {"primitive", s.primitive}, {"reason", s.reason}});
    list.push_back(std::move(entry));
  }
  Json verdicts = Json::object(), codes = Json::object(), by_severity = Json::object(),
       ignored = Json::object();
  const auto add = [](Json& counts, std::string_view name, std::size_t n) {
    Json& count = counts[std::string(name)];
    count = (count.is_null() ? std::size_t{0} : count.get<std::size_t>()) + n;
  };
  for (const std::string_view name : verdict_names) verdicts[std::string(name)] = 0;
  for (const AssessedFile& file : files) {
    add(verdicts, verdict_names[static_cast<std::size_t>(file.verdict)], 1);
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
            {"verdict", verdict_names[static_cast<std::size_t>(verdict)]}};
  if (with_baseline) json["worse"] = worse;
  return json;
}

}  // namespace darboux
