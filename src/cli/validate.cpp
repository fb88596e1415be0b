#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <optional>

#include "base/linear_algebra.h"
#include "base/parallel_jobs.h"
#include "configuration.h"
#include "validate_files.h"
#include "validate_pictures.h"

namespace darboux {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> files;
  std::string surface = "auto", placement = "fit", reference = "analytic,triangles,local,mikktspace";
  double max_angle = 5;
  bool findings = false, details = false;
  std::vector<std::string> fail_on, ignore, severity, exclude;
  bool strict = false, github = false;
  std::string only;
  std::optional<double> budget;
  std::string normal_map;
  std::string configuration, baseline, sarif, junit;
  Pictures pictures;
};

Eigen::Isometry3d parse_placement(const std::string& text) {
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  if (text == "identity") return placement;
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 16)
    throw ParameterError("--placement",
                         expected_got("fit, identity or 16 numbers, column by column", "'" + text + "'"));
  for (std::size_t k = 0; k < 16; ++k)
    placement.matrix()(static_cast<Eigen::Index>(k % 4), static_cast<Eigen::Index>(k / 4)) =
        parse_finite("--placement", parts[k]);
  if (!is_rigid(placement))
    throw ParameterError("--placement", expected_got("a rotation with a translation",
                                                     "a matrix that is not rigid with determinant +1"));
  return placement;
}

References parse_references(const std::string& text) {
  // In the order of ReferenceKind, whose first is none.
  constexpr std::array<bool References::*, 5> members{nullptr, &References::analytic, &References::triangles,
                                                      &References::local, &References::mikktspace};
  References result{false, false, false, false};
  for (const std::string& name : split(text, ',')) {
    const auto found = std::find(reference_names.begin() + 1, reference_names.end(), name);
    if (found == reference_names.end())
      throw ParameterError(
          "--reference",
          "'" + name +
              "' is no reference, expected analytic, triangles, local and mikktspace, separated by commas");
    result.*members[static_cast<std::size_t>(found - reference_names.begin())] = true;
  }
  return result;
}

void list_findings(const Common& common) {
  Json list = Json::array();
  for (const FindingKind& kind : finding_kinds()) {
    const std::string_view severity = name_of(kind.severity);
    if (common.json)
      list.push_back(
          {{"code", kind.code}, {"severity", severity}, {"message", kind.message}, {"to_do", kind.to_do}});
    else
      std::cout << kind.code << ", " << severity << ": " << kind.message << "\n    to do: " << kind.to_do
                << '\n';
  }
  if (common.json) print_json({{"findings", list}});
}

// Rejects unknown codes.
Code parse_code(const std::string& option, const std::string& name) {
  if (const std::optional<Code> code = code_named(name)) return *code;
  throw ParameterError(option, "expected a code that --findings lists, got '" + name + "'");
}

Policy policy_of(const Arguments& arguments) {
  Policy policy;
  policy.strict = arguments.strict;
  policy.only_needed = !arguments.only.empty();
  for (const std::string& code : arguments.ignore) policy.ignore.insert(parse_code("--ignore", code));
  for (const std::string& code : arguments.fail_on)
    policy.severity[parse_code("--fail-on", code)] = Severity::error;
  for (const std::string& text : arguments.severity) {
    const std::size_t at = std::min(text.find('='), text.size());
    const std::string name = text.substr(0, at), severity = text.substr(std::min(at + 1, text.size()));
    const Code code = parse_code("--severity", name);
    const auto found = std::find(severity_names.begin(), severity_names.end(), severity);
    if (found == severity_names.end())
      throw ParameterError("--severity", "expected " + name + "=error, warning or info, got '" + text + "'");
    policy.severity[code] = static_cast<Severity>(found - severity_names.begin());
  }
  return policy;
}

// No output may overwrite an input or another output, or have an extension of another format.
void check_outputs(const Arguments& arguments, const std::vector<AssessedFile>& files) {
  std::vector<std::pair<std::string, std::string>> taken;
  for (const AssessedFile& file : files) taken.emplace_back(file.path, "a file that is judged");
  if (!arguments.baseline.empty()) taken.emplace_back(arguments.baseline, "the baseline");
  for (const auto& [option, output] : {std::pair<std::string, std::string>{"--sarif", arguments.sarif},
                                       {"--junit", arguments.junit},
                                       {"--paint", arguments.pictures.paint},
                                       {"--report", arguments.pictures.page}}) {
    if (output.empty()) continue;
    for (const auto& [other, what] : taken) {
      std::error_code none;
      if (fs::path(output).lexically_normal() == fs::path(other).lexically_normal() ||
          fs::equivalent(output, other, none))
        throw ParameterError(option, expected_got("a file of its own", "'" + output + "', which is " + what));
    }
    taken.emplace_back(output, "what " + option + " writes");
  }
  known_extension("--sarif", arguments.sarif, {".sarif", ".json"});
  known_extension("--junit", arguments.junit, {".xml"});
}

void run(const Arguments& arguments, Common& common) {
  if (arguments.findings) return list_findings(common);
  if (arguments.files.empty())
    throw ParameterError("validate",
                         "expected FILES or folders to read, or --findings, got neither; put FILES before "
                         "options that take several values, such as --ignore");
  const Policy policy = policy_of(arguments);
  if (arguments.github && common.json)
    throw ParameterError("--github", "expected text on standard output, got --json, which takes it");
  for (const std::string& file : arguments.files)
    if (common.json && fs::path(file).extension() == ".json" && !fs::exists(file))
      throw ParameterError("--json", expected_got("no file name, as in --json > " + file, file));
  for (const auto& [option, file] : {std::pair{"--sarif", &arguments.sarif}, {"--junit", &arguments.junit}})
    if (is_standard_output(*file))
      throw ParameterError(option, expected_got("the name of a file", "-: standard output is taken"));
  AssessOptions options;
  options.max_angle_deg = arguments.max_angle;
  if (!(arguments.max_angle > 0) || arguments.max_angle > 180)
    throw ParameterError("--max-angle", expected_got("0 < degrees <= 180", shortest(arguments.max_angle)));
  if (arguments.surface != "auto") {
    // Rejects values out of range before any file is read.
    const AnySurface surface = surface_argument(arguments.surface);
    const auto& fitted = fitted_kinds();
    if (std::find(fitted.begin(), fitted.end(), surface.info().name) != fitted.end() &&
        surface.file().empty())
      options.surface = parse_specification(arguments.surface);
    else
      options.exact_surface = surface;
  }
  options.references = parse_references(arguments.reference);
  if (arguments.budget && !(*arguments.budget > 0))
    throw ParameterError("--budget", "expected seconds > 0, got " + shortest(*arguments.budget));
  options.budget = arguments.budget;
  if (!options.references.analytic && (options.declares_surface() || arguments.placement != "fit"))
    throw ParameterError("--reference",
                         expected_got("a list with analytic, as --surface or --placement is given",
                                      "one without: no surface "
                                      "would be fitted"));
  const std::optional<MapCostOptions> map_cost = map_cost_options(arguments.normal_map, common.read);
  if (arguments.placement != "fit") options.placement = parse_placement(arguments.placement);

  // Files that cannot be read or written are reported before the work, not after it.
  const bool with_baseline = !arguments.baseline.empty();
  const Json baseline = with_baseline ? read_baseline(arguments.baseline) : Json();
  std::optional<OutputFile> sarif_file, junit_file;
  if (!arguments.sarif.empty()) sarif_file.emplace(arguments.sarif);
  if (!arguments.junit.empty()) junit_file.emplace(arguments.junit);

  std::vector<std::string> unused;
  std::vector<AssessedFile> files = files_of(arguments.files, arguments.exclude, unused);
  for (const std::string& pattern : unused)
    print_error("--exclude '" + pattern + "' matches no mesh file and no folder of those given");
  check_outputs(arguments, files);
  check_pictures(arguments.pictures, files.size());
  options.keep_errors = arguments.pictures.any();
  {
    Progress progress("validate", common);
    parallel_for(
        files.size(), common.threads,
        [&](std::size_t i) { assess_file(files[i], options, policy, common.read, map_cost); },
        [&](double share) { progress.update(share); });
  }
  if (with_baseline) compare_with_baseline(files, arguments.baseline, baseline);

  for (const AssessedFile& file : files) {
    if (!file.readable()) print_error(file.error);
    if (file.worse) common.exit_status = std::max(common.exit_status, file.readable() ? 1 : 2);
  }
  if (common.json)
    print_json(report_json(files, with_baseline));
  else
    print_text(files, with_baseline, arguments.details, common.quiet);
  if (arguments.github) print_github(files, with_baseline);
  if (sarif_file) {
    sarif_file->write(json_text(sarif(files, with_baseline)) + '\n');
    sarif_file->commit();
  }
  if (junit_file) {
    junit_file->write(junit(files, with_baseline));
    junit_file->commit();
  }
  write_pictures(arguments.pictures, files, arguments.max_angle, common.read);
}

}  // namespace

void add_validate(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("validate", "Judge the normals and tangents stored in mesh files");
  auto arguments = std::make_shared<Arguments>();
  sub.add_option(
      "FILES", arguments->files,
      joined({asset_extensions().begin(), asset_extensions().end()}) +
          " files, or folders of them; name them before options that take several values, such as --ignore");
  sub.add_option(
         "--surface", arguments->surface,
         "auto, or a kind with the parameters that are known, such as torus:minor_radius=0.4. Kinds that "
         "cannot be fitted, and formula:file=FILE, are used exactly as given, with defaults for what is not "
         "given; only their placement is fitted")
      ->capture_default_str();
  sub.add_option("--placement", arguments->placement,
                 "where the surface lies: fit, identity, or the 16 numbers of a matrix, column by column, "
                 "separated by commas")
      ->capture_default_str();
  sub.add_option("--max-angle", arguments->max_angle,
                 "largest error of an interior corner, in degrees; three times as much is allowed at seams, "
                 "pole rings, creases and borders")
      ->capture_default_str();
  sub.add_option(
         "--reference", arguments->reference,
         "references to compare with, separated by commas: analytic (the surface that the mesh was made "
         "from), triangles (the mesh's own triangles), local (neighbouring vertices), mikktspace "
         "(MikkTSpace's tangents). Only analytic and triangles make errors; against a surface that was "
         "recognised, not declared, a difference may be a warning instead")
      ->capture_default_str();
  sub.add_option("--fail-on", arguments->fail_on,
                 "count these findings as errors: codes separated by commas; --findings lists them")
      ->delimiter(',');
  sub.add_option("--severity", arguments->severity,
                 "change how findings count: CODE=error, CODE=warning or CODE=info, separated by commas; "
                 "--fail-on CODE is CODE=error")
      ->delimiter(',');
  sub.add_option("--ignore", arguments->ignore,
                 "drop these findings: codes separated by commas; how many were dropped is printed")
      ->delimiter(',');
  sub.add_flag("--strict", arguments->strict, "treat warnings as errors, and undetermined as fail");
  sub.add_option("--only", arguments->only,
                 "needed: judge only primitives whose materials read tangents; formats other than glTF do "
                 "not say, so all of their primitives are judged")
      ->check(CLI::IsMember({"needed"}));
  sub.add_option(
      "--exclude", arguments->exclude,
      "in the folders given, skip paths that match this pattern: 'old', the folder of that name, or '*.stl'");
  sub.add_option(
      "--budget", arguments->budget,
      "seconds per file after which no further surface is tried; all other checks always run in full");
  sub.add_option("--normal-map", arguments->normal_map,
                 "WIDTHxHEIGHT: report how much of the error a normal map of this size would leave, for "
                 "meshes on known surfaces");
  sub.add_flag("--github", arguments->github, "also print annotations for GitHub workflows");
  sub.add_option("--baseline", arguments->baseline,
                 "an earlier --json report: only what is worse than in it makes the exit status 1 or 2");
  sub.add_option("--sarif", arguments->sarif, "also write errors and warnings as SARIF 2.1.0 to this file");
  sub.add_option("--junit", arguments->junit,
                 "also write the verdicts as JUnit XML to this file, one test case per mesh or part");
  add_pictures(sub, arguments->pictures);
  sub.add_option(
      "--config", arguments->configuration,
      "read options from this TOML file, one per line: max-angle = 2, fail-on = [\"CODE\"], files = "
      "[\"assets\"]; the command line takes precedence");
  sub.add_flag("--details", arguments->details,
               "print a table for every mesh and part, even where there are more than a dozen");
  sub.add_flag("--findings", arguments->findings, "list and explain all findings");
  add_read_options(sub, common);
  add_common(sub, common, "darboux validate torus.glb --surface torus --max-angle 2 --json");
  sub.callback([arguments, &common, &sub] {
    if (!arguments->configuration.empty()) read_configuration(sub, arguments->configuration);
    run(*arguments, common);
  });
}

}  // namespace darboux
