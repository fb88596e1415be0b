#include <algorithm>
#include <cstdio>
#include <iostream>
#include <new>

#include <darboux/io.h>
#include <darboux/judge.h>

#include "../validate/findings.h"
#include "command.h"
#include "parallel.h"

namespace darboux {
namespace {

struct Arguments {
  std::vector<std::string> files;
  std::string surface = "auto", placement = "fit", reference = "analytic,mikktspace,local";
  double max_angle = 5;
  bool findings = false;
  std::vector<std::string> fail_on;
};

struct JudgedPrimitive {
  Primitive primitive;  // without its data
  std::vector<Judgement> judgements;
};

struct JudgedFile {
  std::vector<JudgedPrimitive> primitives;
  std::vector<SkippedPrimitive> skipped;
  std::string error;  // empty where the file could be read
  Verdict verdict = Verdict::pass;
};

Eigen::Isometry3d parse_placement(const std::string& text) {
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  if (text == "identity") return placement;
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 16)
    throw ParameterError(
        "--placement",
        "'" + text + "' is no placement, permitted are fit, identity or 16 numbers, column by column");
  for (std::size_t k = 0; k < 16; ++k)
    placement.matrix()(static_cast<Eigen::Index>(k % 4), static_cast<Eigen::Index>(k / 4)) =
        parse_finite("--placement", parts[k]);
  const Eigen::Matrix3d m = placement.linear();
  const bool rigid = (m.transpose() * m - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
                     m.determinant() > 0 && placement.matrix().row(3) == Eigen::RowVector4d(0, 0, 0, 1);
  if (!rigid)
    throw ParameterError(
        "--placement",
        "the matrix is not rigid with determinant +1, permitted are rotations with a translation");
  return placement;
}

// Node transforms change what a renderer shows, not what the mesh stores: they give rise to findings only.
void add_node_findings(const Primitive& primitive, MeshReport& report) {
  std::size_t mirrored = 0, sheared = 0;
  for (const Eigen::Matrix4d& world : primitive.instances) {
    const Eigen::Matrix3d m = world.topLeftCorner<3, 3>();
    const Eigen::Matrix3d gram = m.transpose() * m;
    const double scale = gram.trace() / 3;
    mirrored += m.determinant() < 0;
    sheared += (gram - scale * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-5 * scale;
  }
  add(report, finding(Code::node_mirrored, mirrored));
  add(report, finding(Code::node_scale_not_uniform, sheared));
}

// A finding that was asked for counts as an error.
void raise(const std::vector<std::string>& codes, MeshReport& report) {
  for (Finding& f : report.findings)
    if (std::find(codes.begin(), codes.end(), f.code) != codes.end()) {
      f.severity = Severity::error;
      report.verdict = Verdict::fail;
    }
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
}

JudgedFile judge_file(const std::string& path, const JudgeOptions& options,
                      const std::vector<std::string>& fail_on) {
  JudgedFile result;
  try {
    Asset asset = read_asset(path);
    result.skipped = asset.skipped;
    if (asset.primitives.empty()) result.verdict = Verdict::undetermined;
    for (Primitive& primitive : asset.primitives) {
      std::vector<Judgement> judgements = judge_parts(primitive.data, options);
      add_node_findings(primitive, judgements.front().report);
      for (Judgement& j : judgements) {
        raise(fail_on, j.report);
        result.verdict = std::max(result.verdict, j.report.verdict);
      }
      primitive.data = {};
      result.primitives.push_back({std::move(primitive), std::move(judgements)});
    }
  } catch (const FileError& e) {
    result.error = e.what();
  } catch (const Error& e) {
    result.error = path + ": " + e.what();
  } catch (const std::bad_alloc&) {
    result.error = path + ": needs more memory than there is, permitted is what fits";
  }
  return result;
}

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

// What stored uvs mean on the surface.
std::string convention(const MeshFit& fit) {
  return fit.chart == UvChart::own         ? std::string(fit.surface.uv.name)
         : fit.chart == UvChart::projected ? "projected"
                                           : "unknown";
}

Json report_json(const Primitive& primitive, const Judgement& judgement) {
  const MeshReport& report = judgement.report;
  Json json{{"mesh", primitive.mesh},
            {"primitive", primitive.primitive},
            {"name", primitive.name},
            {"corners", report.corners},
            {"verdict", verdict_names[static_cast<std::size_t>(report.verdict)]}};
  if (judgement.part) json["part"] = *judgement.part;
  json["surface"] = nullptr;
  json["uv"] = nullptr;
  if (judgement.fit && judgement.fit->fits) {
    const MeshFit& fit = *judgement.fit;
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
    json["uv"] = {{"convention", convention(fit)}, {"texcoord", primitive.texcoord}};
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
  if (report.mikktspace)
    json["references"]["mikktspace"] = {{"equal_bits", number(report.mikktspace->equal_bits)},
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
  json["degenerate_triangles"] = report.degenerate_triangles;
  json["degenerate_uv_triangles"] = report.degenerate_uv_triangles;
  json["classes"] = classes_json(report.classes);
  json["findings"] = Json::array();
  for (const Finding& f : report.findings)
    json["findings"].push_back({{"code", f.code},
                                {"severity", severity_names[static_cast<std::size_t>(f.severity)]},
                                {"count", f.count},
                                {"message", f.message},
                                {"to_do", f.to_do}});
  return json;
}

void print_local(const LocalReport& local) {
  const auto interior = std::find_if(local.classes.begin(), local.classes.end(), [](const ClassReport& c) {
    return c.vertex_class == VertexClass::interior && (c.normal_deg || c.tangent_deg);
  });
  if (interior == local.classes.end()) {
    std::cout << "    local: nothing is known of interior corners, their neighbours do not tell\n";
    return;
  }
  std::string text;
  const auto add = [&](const char* what, const std::optional<Statistics>& s, const Spread& uncertainty) {
    if (!s) return;
    text += (text.empty() ? "local: interior " : "; ") + std::string(what) + " differ by " +
            rounded(s->rms, 2) + " deg rms, uncertain by " + deviation_text(uncertainty.rms(), 2);
  };
  add("normals", interior->normal_deg, interior->normal_uncertainty_deg);
  add("tangents", interior->tangent_deg, interior->tangent_uncertainty_deg);
  std::cout << "    " << text << '\n';
  if (local.compared > 0)
    std::cout << "    local and analytic agree at " << rounded(100 * local.agreement, 3)
              << " % of interior corners\n";
}

void print_mikktspace(const MikkReport& mikktspace) {
  double max = 0, squares = 0, corners = 0;
  for (const ClassReport& c : mikktspace.classes)
    if (c.tangent_deg && c.vertex_class != VertexClass::pole) {
      const auto n = static_cast<double>(c.corners);
      max = std::fmax(max, c.tangent_deg->max);
      squares += n * c.tangent_deg->rms * c.tangent_deg->rms;
      corners += n;
    }
  std::cout << "    mikktspace: " << rounded(100 * mikktspace.equal_bits, 4) << " % of corners to the bit";
  if (corners > 0)
    std::cout << ", tangents differ by " << rounded(std::sqrt(squares / corners), 2) << " deg rms, "
              << rounded(max, 3) << " at most";
  std::cout << '\n';
}

void print_judgement(const Primitive& primitive, const Judgement& judgement) {
  const MeshReport& report = judgement.report;
  std::cout << "  mesh " << primitive.mesh << " primitive " << primitive.primitive;
  if (judgement.part) std::cout << " part " << *judgement.part;
  if (!primitive.name.empty()) std::cout << " (" << one_line(primitive.name) << ")";
  std::cout << ": " << report.corners << " corners";
  if (judgement.fit && judgement.fit->fits)
    std::cout << ", " << judgement.fit->surface.surface.specification(6) << ", uvs "
              << convention(*judgement.fit);
  std::cout << ", w " << report.handedness.convention << ", judged by " << report.reference << '\n';
  if (!report.classes.empty())
    std::printf("    %-10s %9s  %-23s  %-23s  %-23s\n", "class", "corners", "normal max/rms (deg)",
                "tangent max/rms (deg)", "bitangent max/rms (deg)");
  std::cout.flush();
  for (const ClassReport& c : report.classes) {
    const auto cell = [](const std::optional<Statistics>& s) {
      if (!s) return std::string("-");
      char text[48];
      std::snprintf(text, sizeof text, "%.3g / %.3g", s->max, s->rms);
      return std::string(text);
    };
    std::printf("    %-10s %9zu  %-23s  %-23s  %-23s\n",
                std::string(vertex_class_names[static_cast<std::size_t>(c.vertex_class)]).c_str(), c.corners,
                cell(c.normal_deg).c_str(), cell(c.tangent_deg).c_str(), cell(c.bitangent_deg).c_str());
  }
  std::fflush(stdout);
  if ((report.reference == "analytic" || report.reference == "local") && report.corners > 0)
    std::cout << "    truth uncertain by "
              << deviation_text(report.normal_uncertainty_deg.rms(), 2, " deg rms") << " (normals), "
              << deviation_text(report.tangent_uncertainty_deg.rms(), 2, " deg rms") << " (tangents)\n";
  if (report.local && report.reference != "local") print_local(*report.local);
  if (report.mikktspace) print_mikktspace(*report.mikktspace);
  for (const Finding& f : report.findings)
    std::cout << "    " << severity_names[static_cast<std::size_t>(f.severity)] << ' ' << f.code << " ("
              << f.count << "): " << f.message << '\n';
}

void print_people(const std::string& path, const JudgedFile& file) {
  std::cout << one_line(path) << ": " << verdict_names[static_cast<std::size_t>(file.verdict)] << '\n';
  if (file.primitives.empty()) std::cout << "  holds no triangles to judge\n";
  for (const auto& [primitive, judgements] : file.primitives)
    for (const Judgement& judgement : judgements) print_judgement(primitive, judgement);
  for (const SkippedPrimitive& s : file.skipped)
    std::cout << "  mesh " << s.mesh << " primitive " << s.primitive << " not judged: " << s.reason << '\n';
}

References parse_references(const std::string& text) {
  References result{false, false, false};
  for (const std::string& name : split(text, ',')) {
    if (name == "analytic")
      result.analytic = true;
    else if (name == "mikktspace")
      result.mikktspace = true;
    else if (name == "local")
      result.local = true;
    else
      throw ParameterError("--reference",
                           "'" + name +
                               "' is no reference, permitted are analytic, mikktspace and local, with commas "
                               "between");
  }
  return result;
}

void list_findings(const Common& common) {
  Json list = Json::array();
  for (const FindingKind& kind : finding_kinds()) {
    const std::string_view severity = severity_names[static_cast<std::size_t>(kind.severity)];
    if (common.json)
      list.push_back(
          {{"code", kind.code}, {"severity", severity}, {"message", kind.message}, {"to_do", kind.to_do}});
    else
      std::cout << kind.code << ", " << severity << ": " << kind.message << "\n    to do: " << kind.to_do
                << '\n';
  }
  if (common.json) print_json({{"findings", list}});
}

// Refuses codes that there are not.
void check_codes(const std::vector<std::string>& codes) {
  for (const std::string& code : codes)
    if (std::none_of(finding_kinds().begin(), finding_kinds().end(),
                     [&](const FindingKind& kind) { return kind.code == code; }))
      throw ParameterError("--fail-on", "'" + code + "' is no finding, permitted are those of --findings");
}

void run(const Arguments& arguments, Common& common) {
  if (arguments.findings) return list_findings(common);
  if (arguments.files.empty()) throw ParameterError("validate", "needs FILES to read, or --findings");
  check_codes(arguments.fail_on);
  JudgeOptions options;
  options.max_angle_deg = arguments.max_angle;
  if (!(arguments.max_angle > 0) || arguments.max_angle > 180)
    throw ParameterError("--max-angle",
                         shortest(arguments.max_angle) + " is out of range, permitted is 0 < degrees <= 180");
  if (arguments.surface != "auto") {
    options.surface = parse_specification(arguments.surface);
    make_surface(*options.surface);  // refuses values out of range before any file is read
  }
  options.references = parse_references(arguments.reference);
  if (!options.references.analytic && (options.surface || arguments.placement != "fit"))
    throw ParameterError("--reference",
                         "without analytic no surface is fitted, permitted with --surface and --placement "
                         "are lists with analytic");
  if (arguments.placement != "fit") options.placement = parse_placement(arguments.placement);

  std::vector<JudgedFile> files(arguments.files.size());
  Progress progress("validate", common);
  parallel_for(
      files.size(), common.threads,
      [&](std::size_t i) { files[i] = judge_file(arguments.files[i], options, arguments.fail_on); },
      [&](double share) { progress.update(share); });

  Json list = Json::array();
  Verdict verdict = Verdict::pass;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const JudgedFile& file = files[i];
    Json entry{{"file", arguments.files[i]}};
    if (!file.error.empty()) {
      print_error(file.error);
      common.exit_status = 2;
      verdict = Verdict::fail;
      entry["verdict"] = "fail";
      entry["error"] = file.error;
      entry["meshes"] = Json::array();
      list.push_back(entry);
      continue;
    }
    verdict = std::max(verdict, file.verdict);
    if (!common.json) print_people(arguments.files[i], file);
    entry["verdict"] = verdict_names[static_cast<std::size_t>(file.verdict)];
    entry["meshes"] = Json::array();
    for (const auto& [primitive, judgements] : file.primitives)
      for (const Judgement& judgement : judgements)
        entry["meshes"].push_back(report_json(primitive, judgement));
    entry["skipped"] = Json::array();
    for (const SkippedPrimitive& s : file.skipped)
      entry["skipped"].push_back({{"mesh", s.mesh}, {"primitive", s.primitive}, {"reason", s.reason}});
    list.push_back(entry);
  }
  if (common.json)
    print_json({{"files", list}, {"verdict", verdict_names[static_cast<std::size_t>(verdict)]}});
  if (verdict != Verdict::pass) common.exit_status = std::max(common.exit_status, 1);
}

}  // namespace

void add_validate(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("validate", "Compare the tangents stored in mesh files with the truth");
  auto arguments = std::make_shared<Arguments>();
  sub.add_option("FILES", arguments->files, ".glb, .gltf or .obj files");
  sub.add_option("--surface", arguments->surface,
                 "auto, or the kind with the parameters that are known: torus:minor_radius=0.4")
      ->capture_default_str();
  sub.add_option("--placement", arguments->placement,
                 "fit, identity, or 16 numbers, column by column, separated by commas")
      ->capture_default_str();
  sub.add_option(
         "--max-angle", arguments->max_angle,
         "degrees an interior corner may be off; three times that at seams, pole rings, creases and borders")
      ->capture_default_str();
  sub.add_option(
         "--reference", arguments->reference,
         "what to compare with, with commas between: analytic, the surface it was made from; mikktspace, "
         "MikkTSpace's tangents of the mesh's data; local, what its positions and uvs say. The first of "
         "analytic "
         "and local that is known decides, mikktspace alone")
      ->capture_default_str();
  sub.add_option("--fail-on", arguments->fail_on,
                 "codes of findings that count as errors, with commas between; --findings lists them")
      ->delimiter(',');
  sub.add_flag("--findings", arguments->findings, "name and explain all findings");
  add_common(sub, common, "darboux validate torus.glb --surface torus --max-angle 2 --json");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
