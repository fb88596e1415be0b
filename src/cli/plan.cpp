// `darboux plan`: which primitives of glTF files need a tangent frame, and which store one.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>

#include <darboux/tangent_need.h>

#include "base/counted.h"
#include "base/extension.h"
#include "base/parallel_jobs.h"
#include "sarif.h"
#include "validate_files.h"

namespace darboux {
namespace {

struct PlanArguments {
  std::vector<std::string> files;
  std::string level = "spec", against, sarif;
  bool splits = false, strict = false;
};

struct PlannedFile {
  std::string path, error{};
  TangentNeeds needs{};
  std::vector<DroppedTangents> dropped{};
  bool ok = true;
};

constexpr std::array<std::string_view, 4> need_names{"needed", "idle", "missing", "none"};
constexpr Choice<NeedLevel, 3> levels{{"spec", "factors", "pixels"}};

constexpr FindingKind missing{"TANGENT_NEEDED", Severity::warning,
                              "the material reads a tangent frame, and there is no TANGENT",
                              "export NORMAL and uvs if they are missing, then run darboux tangents IN "
                              "-o OUT --only needed"};
constexpr FindingKind idle{"TANGENT_IDLE", Severity::info, "TANGENT is stored, and nothing reads it",
                           "remove it: darboux tangents IN -o OUT --only needed --drop-idle"};
constexpr FindingKind dropped_kind{"TANGENT_DROPPED", Severity::error,
                                   "the earlier file had the TANGENT and NORMAL that the material reads",
                                   "configure the tool that wrote the file to keep both"};

constexpr std::size_t most_idle_lines = 4;  // per file: what can be left out is no error

bool has_gltf_extension(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".glb" || extension == ".gltf";
}

std::string bytes_text(std::size_t bytes) {
  if (bytes < 1000) return std::to_string(bytes) + " bytes";
  const auto n = static_cast<double>(bytes);
  return n < 1e6 ? rounded(n / 1e3, 3) + " kB" : rounded(n / 1e6, 3) + " MB";
}

// "normal_texture at /materials/0/normalTexture, TEXCOORD_0 after its transform"
std::string reasons_text(const PrimitiveNeed& p) {
  std::string text;
  for (const NeedReason& r : p.reasons) {
    text += (text.empty() ? "" : "; ") + r.rule + " at " + r.pointer;
    if (r.texcoord >= 0) text += ", TEXCOORD_" + std::to_string(r.texcoord);
    if (r.transform) text += " after its transform";
    if (!r.note.empty()) text += " (" + one_line(r.note) + ")";
  }
  return text;
}

std::string missing_text(const PrimitiveNeed& p) {
  return "TANGENT is missing, and viewers " + std::string(p.derivable ? "can make one" : "cannot make one") +
         ": " + reasons_text(p) + (p.has_normals ? "" : "; there is no NORMAL");
}

std::string idle_text(const PrimitiveNeed& p) {
  return bytes_text(p.tangent_bytes) + " of TANGENT that nothing reads" +
         (p.reasons.empty() ? "" : ": there is no NORMAL, without which viewers ignore it");
}

Json primitive_json(const PrimitiveNeed& p) {
  Json reasons = Json::array();
  for (const NeedReason& r : p.reasons)
    reasons.push_back({{"rule", r.rule},
                       {"pointer", r.pointer},
                       {"texcoord", r.texcoord < 0 ? Json() : Json(r.texcoord)},
                       {"transform", r.transform},
                       {"derivable", r.derivable},
                       {"note", r.note.empty() ? Json() : Json(utf8(r.note))}});
  return {{"mesh", p.mesh},
          {"primitive", p.primitive},
          {"name", utf8(p.name)},
          {"need", need_names[static_cast<std::size_t>(p.need)]},
          {"reasons", std::move(reasons)},
          {"carried", p.carried},
          {"derivable", p.derivable},
          {"in_scene", p.in_scene},
          {"triangles", p.triangles},
          {"tangent_bytes", p.tangent_bytes},
          {"splits", p.splits ? Json(*p.splits) : Json()}};
}

Json totals_json(const NeedTotals& t) {
  return {{"needed", t.needed},
          {"carried", t.carried},
          {"missing", t.missing},
          {"idle", t.idle},
          {"tangent_bytes", t.tangent_bytes},
          {"idle_bytes", t.idle_bytes},
          {"geometry_bytes", t.geometry_bytes}};
}

Json report_json(const std::vector<PlannedFile>& files, bool against) {
  Json list = Json::array();
  bool ok = true;
  for (const PlannedFile& file : files) {
    ok = ok && file.ok;
    Json one{{"file", utf8(file.path)}};
    if (!file.error.empty()) one["error"] = utf8(file.error);
    Json primitives = Json::array();
    for (const PrimitiveNeed& p : file.needs.primitives) primitives.push_back(primitive_json(p));
    one["primitives"] = std::move(primitives);
    one["totals"] = totals_json(file.needs.totals);
    if (against) {
      Json dropped = Json::array();
      for (const DroppedTangents& d : file.dropped)
        dropped.push_back({{"mesh", d.after->mesh},
                           {"primitive", d.after->primitive},
                           {"name", utf8(d.after->name)},
                           {"before", {{"mesh", d.before->mesh}, {"primitive", d.before->primitive}}}});
      one["dropped"] = std::move(dropped);
    }
    list.push_back(std::move(one));
  }
  return {{"files", std::move(list)}, {"ok", ok}};
}

Json sarif_of(const std::vector<PlannedFile>& files) {
  Json rules = Json::array(), results = Json::array();
  for (const FindingKind& kind : {unreadable_file, dropped_kind, missing, idle})
    rules.push_back(sarif_rule(kind));
  for (const PlannedFile& file : files) {
    const auto add = [&](const FindingKind& kind, Severity severity, const std::string& text,
                         const std::string& place) {
      results.push_back(sarif_result(file.path, kind.code, severity, kind.severity, text, place));
    };
    if (!file.error.empty()) add(unreadable_file, Severity::error, file.error, "");
    for (const DroppedTangents& d : file.dropped)
      add(dropped_kind, Severity::error,
          primitive_text(*d.after) + ": " + with_to_do(std::string(dropped_kind.message), dropped_kind.to_do),
          primitive_text(*d.after));
    for (const PrimitiveNeed& p : file.needs.primitives) {
      if (p.need == TangentNeed::missing)
        add(missing, p.derivable ? Severity::warning : Severity::error,
            primitive_text(p) + ": " + with_to_do(missing_text(p), missing.to_do), primitive_text(p));
      if (p.need == TangentNeed::idle)
        add(idle, Severity::info, primitive_text(p) + ": " + with_to_do(idle_text(p), idle.to_do),
            primitive_text(p));
    }
  }
  return sarif_log(std::move(rules), std::move(results));
}

// "3 primitives need TANGENT: 2 with it, 1 without; 4 store it unused (12 kB of 80 kB of geometry)"
std::string summary(const NeedTotals& t) {
  const std::size_t all = t.needed + t.missing;
  std::string text = all == 0 ? "no primitive needs TANGENT"
                              : counted(all, "primitive needs", "primitives need") +
                                    " TANGENT: " + std::to_string(t.needed) + " with it, " +
                                    std::to_string(t.missing) + " without";
  if (t.idle > 0)
    text += "; " + counted(t.idle, "stores", "store") + " it unused (" + bytes_text(t.idle_bytes) + " of " +
            bytes_text(t.geometry_bytes) + " of geometry)";
  return text;
}

// With --quiet: one line per file.
void print_verdicts(const std::vector<PlannedFile>& files) {
  for (const PlannedFile& file : files)
    if (file.error.empty())
      std::cout << one_line(file.path) << ": " << (file.ok ? "ok" : "not ok") << ", "
                << summary(file.needs.totals) << '\n';
}

void print_text(const std::vector<PlannedFile>& files) {
  NeedTotals all;
  std::size_t without_need = 0, complete = 0;
  std::set<std::pair<std::string, std::string>> not_looked_at;  // files and pointers
  for (const PlannedFile& file : files) {
    if (!file.error.empty() && file.needs.primitives.empty()) continue;
    const NeedTotals& t = file.needs.totals;
    for (const PrimitiveNeed& p : file.needs.primitives)
      for (const NeedReason& r : p.reasons)
        if (!r.note.empty()) not_looked_at.emplace(file.path, r.pointer);
    for (const auto member :
         {&NeedTotals::needed, &NeedTotals::carried, &NeedTotals::missing, &NeedTotals::idle,
          &NeedTotals::tangent_bytes, &NeedTotals::idle_bytes, &NeedTotals::geometry_bytes})
      all.*member += t.*member;
    const bool nothing_to_say = t.missing == 0 && t.idle == 0 && file.dropped.empty();
    if (nothing_to_say && files.size() > 1) {
      ++(t.needed == 0 ? without_need : complete);
      continue;
    }
    std::cout << one_line(file.path) << ": " << summary(t) << '\n';
    for (const DroppedTangents& d : file.dropped)
      std::cout << "  dropped: " << primitive_text(*d.after) << ": " << dropped_kind.message << '\n';
    std::size_t idle_lines = 0;
    for (const PrimitiveNeed& p : file.needs.primitives) {
      std::string text;
      if (p.need == TangentNeed::missing) text = missing_text(p);
      if (p.need == TangentNeed::idle && ++idle_lines <= most_idle_lines) text = idle_text(p);
      if (p.splits)
        text += (text.empty() ? "" : "; ") + std::string("MikkTSpace splits ") +
                counted(*p.splits, "vertex", "vertices");
      if (text.empty()) continue;
      std::cout << "  " << primitive_text(p) << ": " << text << (p.in_scene ? "" : " (in no scene)") << '\n';
    }
    if (idle_lines > most_idle_lines)
      std::cout << "  and " << idle_lines - most_idle_lines << " more with TANGENT that nothing reads\n";
  }
  if (complete > 0)
    std::cout << counted(complete, "file has", "files have")
              << " TANGENT where it is needed and nowhere else\n";
  if (without_need > 0)
    std::cout << counted(without_need, "file needs", "files need") << " no TANGENT and "
              << (without_need == 1 ? "has" : "have") << " none\n";
  if (!not_looked_at.empty())
    std::cout << counted(not_looked_at.size(), "normal map", "normal maps")
              << " could not be looked at; --json says why\n";
  if (files.size() > 1) std::cout << "all " << files.size() << " files: " << summary(all) << '\n';
}

std::vector<PlannedFile> files_to_plan(const std::vector<std::string>& arguments) {
  std::vector<std::string> unused;
  std::vector<PlannedFile> result;
  for (const AssessedFile& file : files_of(arguments, {}, unused)) {
    const bool named = std::find(arguments.begin(), arguments.end(), file.path) != arguments.end();
    std::error_code none;
    if (named && file.readable() && !has_gltf_extension(file.path) &&
        std::filesystem::is_regular_file(file.path, none))
      throw ParameterError(file.path, expected_got("a .glb or .gltf, as only glTF has materials that say "
                                                   "what reads a tangent frame",
                                                   "another format"));
    if (named || has_gltf_extension(file.path)) result.push_back({file.path, file.error});
  }
  if (result.empty()) throw ParameterError("plan", expected_got("folders with .glb or .gltf files", "none"));
  return result;
}

void plan(PlannedFile& file, const PlanArguments& arguments, const std::optional<TangentNeeds>& before,
          const ReadOptions& read) {
  file.ok = file.error.empty();
  if (!file.ok) return;
  try {
    file.needs = tangent_need(file.path, levels.of(arguments.level), read);
    if (before) file.dropped = dropped_tangents(*before, file.needs);
    if (arguments.splits) count_splits(file.path, file.needs, read);
  } catch (const std::exception&) {
    file.error = error_of(file.path);  // the plan made before the geometry failed is kept
  }
  file.ok = file.error.empty() && file.dropped.empty() &&
            std::none_of(file.needs.primitives.begin(), file.needs.primitives.end(), [&](const auto& p) {
              return p.need == TangentNeed::missing && (arguments.strict || !p.derivable);
            });
}

void run(const PlanArguments& arguments, Common& common) {
  if (arguments.files.empty()) throw ParameterError("plan", expected_got("FILES or folders to read", "none"));
  if (is_standard_output(arguments.sarif))
    throw ParameterError("--sarif", expected_got("the name of a file", "-: standard output is taken"));
  known_extension("--sarif", arguments.sarif, {".sarif", ".json"});
  std::vector<PlannedFile> files = files_to_plan(arguments.files);
  std::optional<TangentNeeds> before;
  if (!arguments.against.empty()) {
    if (files.size() != 1)
      throw ParameterError("--against", expected_got("one file to plan", std::to_string(files.size())));
    before = tangent_need(arguments.against, levels.of(arguments.level), common.read);
  }
  const auto check_sarif = [&](const std::string& read) {
    std::error_code none;
    if (!arguments.sarif.empty() && std::filesystem::equivalent(read, arguments.sarif, none))
      throw ParameterError(
          "--sarif",
          expected_got("a file of its own", "'" + arguments.sarif + "', which is a file that is read"));
  };
  for (const PlannedFile& file : files) check_sarif(file.path);
  if (before) check_sarif(arguments.against);
  std::optional<OutputFile> sarif;
  if (!arguments.sarif.empty()) sarif.emplace(arguments.sarif);
  {
    Progress progress("plan", common);
    parallel_for(
        files.size(), common.threads, [&](std::size_t i) { plan(files[i], arguments, before, common.read); },
        [&](double share) { progress.update(share); });
  }
  for (const PlannedFile& file : files) {
    if (!file.error.empty()) print_error(file.error);
    if (!file.ok) common.exit_status = std::max(common.exit_status, file.error.empty() ? 1 : 2);
  }
  if (common.json)
    print_json(report_json(files, before.has_value()));
  else if (common.quiet)
    print_verdicts(files);
  else
    print_text(files);
  if (!sarif) return;
  sarif->write(json_text(sarif_of(files)) + '\n');
  sarif->commit();
}

}  // namespace

void add_plan(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "plan",
      "Report which primitives need tangents, which lack them, and which carry tangents that nothing reads");
  auto arguments = std::make_shared<PlanArguments>();
  sub.add_option("FILES", arguments->files, ".glb and .gltf files, or folders of them");
  sub.add_option("--level", arguments->level,
                 "spec: what the specifications say; factors: without what a factor of 0 switches off, "
                 "unless it is animated; pixels: also without flat normal maps (PNG only)")
      ->capture_default_str()
      ->check(levels.check());
  sub.add_option("--against", arguments->against,
                 "an earlier version of the file: report the tangents lost since then");
  sub.add_option("--sarif", arguments->sarif, "also write the findings as SARIF 2.1.0 to this file");
  sub.add_flag("--splits", arguments->splits,
               "count the vertices that MikkTSpace would split; this also reads the geometry");
  sub.add_flag("--strict", arguments->strict,
               "fail where TANGENT is missing, even where viewers can compute it");
  add_read_options(sub, common);
  add_common(sub, common, "darboux plan in.glb");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
