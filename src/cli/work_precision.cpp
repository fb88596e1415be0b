#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <darboux/io.h>
#include <darboux/work_precision.h>

#include "base/text.h"
#include "command.h"
#include "report/work_precision_report.h"
#include "report_command.h"
#include "work_precision_study.h"

namespace darboux {
namespace {

// The options as given; missing ones come from the study file or the preset.
struct WorkArguments {
  std::vector<std::string> surfaces, methods, meshes, compare;
  std::optional<int> rounds, points, checked;
  std::optional<double> timeout;
  std::optional<std::uint64_t> seed;
  std::string x, y, resolutions;
  double tolerance = 0.1;
  ReportArguments report;
};

// Options override the study file, which overrides the preset.
WorkChoices choose(const WorkArguments& arguments) {
  const auto preset = work_preset(arguments.report.preset);
  if (!preset)
    throw ParameterError("--preset", expected_got(preset_names, "'" + arguments.report.preset + "'"));
  WorkChoices choices = *preset;
  if (!arguments.report.study.empty()) read_work_study(arguments.report.study, choices);
  if (!arguments.surfaces.empty()) choices.surfaces = arguments.surfaces;
  if (!arguments.methods.empty()) choices.methods = arguments.methods;
  if (!arguments.meshes.empty()) choices.meshes = arguments.meshes;
  if (!arguments.resolutions.empty())
    choices.resolutions = parse_resolutions(arguments.resolutions, finest_work_rows);
  if (arguments.rounds) choices.rounds = *arguments.rounds;
  if (arguments.points) choices.points = *arguments.points;
  if (arguments.checked) choices.checked = *arguments.checked;
  if (arguments.timeout) choices.timeout = *arguments.timeout;
  if (arguments.seed) choices.seed = *arguments.seed;
  return choices;
}

WorkOptions parse(const WorkArguments& arguments) {
  const WorkChoices choices = choose(arguments);
  WorkOptions options;
  // Duplicates are measured once.
  const auto once = [](auto& list, const auto& item, auto same) {
    if (std::none_of(list.begin(), list.end(), same)) list.push_back(item);
  };
  for (const std::string& name : choices.surfaces) {
    const AnySurface surface = surface_argument(name);
    once(options.surfaces, surface,
         [&](const AnySurface& other) { return other.specification() == surface.specification(); });
  }
  if (choices.surfaces.empty()) options.surfaces = all_surfaces();
  for (const std::string& name : choices.methods)
    for (const WorkMethod* method : find_work_methods(name))
      once(options.methods, method, [&](const WorkMethod* other) { return other == method; });
  if (choices.methods.empty())
    for (const WorkMethod& method : work_methods()) options.methods.push_back(&method);
  for (const std::string& name : choices.meshes) {
    const MeshFamily* family = &find_mesh_family(name);
    once(options.families, family, [&](const MeshFamily* other) { return other == family; });
  }
  options.resolutions = choices.resolutions;
  options.rounds = choices.rounds;
  options.points = choices.points;
  options.checked = choices.checked;
  options.timeout = choices.timeout;
  options.seed = choices.seed;
  return options;
}

WorkAxes axes_of(const WorkArguments& arguments) {
  WorkAxes axes;
  if (!arguments.x.empty()) axes.x = work_metrics[find_work_metric(arguments.x)];
  if (!arguments.y.empty()) axes.y = work_metrics[find_work_metric(arguments.y)];
  return axes;
}

// The command line that repeats this run, with every choice spelt out.
std::string command_line(const WorkOptions& options, const WorkArguments& arguments) {
  std::string line = "darboux work-precision";
  for (const AnySurface& surface : options.surfaces) line += ' ' + shell_quoted(surface.specification());
  const auto list = [&](const char* option, const auto& items, auto text) {
    for (std::size_t i = 0; i < items.size(); ++i)
      line += (i == 0 ? std::string(" ") + option + ' ' : ",") + std::string(text(items[i]));
  };
  const auto name = [](const auto* item) { return item->name; };
  list("--methods", options.methods, name);
  list("--meshes", options.families, name);
  list("--resolutions", options.resolutions, [](int n) { return std::to_string(n); });
  line += " --rounds " + std::to_string(options.rounds) + " --points " + std::to_string(options.points) +
          " --checked " + std::to_string(options.checked) + " --timeout " + shortest(options.timeout) +
          " --seed " + std::to_string(options.seed);
  return line + command_line_of(arguments.report, {{"--x", arguments.x}, {"--y", arguments.y}});
}

// Samples of one run that the other lacks.
std::size_t count_unmatched(const std::vector<WorkSample>& samples, const std::vector<WorkSample>& others) {
  return static_cast<std::size_t>(std::count_if(samples.begin(), samples.end(), [&](const WorkSample& s) {
    return std::none_of(others.begin(), others.end(),
                        [&](const WorkSample& other) { return same_question(s, other); });
  }));
}

void run_compare(const WorkArguments& arguments, Common& common) {
  const WorkDocument before = read_work_document(arguments.compare[0]),
                     after = read_work_document(arguments.compare[1]);
  const std::vector<std::string> notes = compare_studies(before, after, arguments.compare[1]);
  const std::vector<WorkComparison> pairs = compare_work(before.samples, after.samples, arguments.tolerance);
  if (pairs.empty())
    throw FileError(arguments.compare[1],
                    expected_got("measurements that " + arguments.compare[0] + " has too", "none"));
  const std::size_t only_before = count_unmatched(before.samples, after.samples),
                    only_after = count_unmatched(after.samples, before.samples);
  const bool holds =
      std::all_of(pairs.begin(), pairs.end(), [](const WorkComparison& c) { return c.holds(); });
  common.exit_status = holds ? 0 : 1;
  if (common.json)
    return print_json({{"pairs", comparisons_json(pairs)},
                       {"only_before", only_before},
                       {"only_after", only_after},
                       {"notes", notes},
                       {"tolerance", arguments.tolerance},
                       {"holds", holds}});
  const std::string text = comparisons_text(pairs, arguments.tolerance);  // its last line sums up
  if (common.quiet) return void(std::fputs(text.c_str() + text.rfind('\n', text.size() - 2) + 1, stdout));
  std::fputs(text.c_str(), stdout);
  if (only_before + only_after > 0) std::printf("%zu only before, %zu only after\n", only_before, only_after);
  for (const std::string& note : notes) std::printf("note: %s\n", one_line(note).c_str());
}

// --compare measures nothing, so it refuses options that say how to measure or where to write.
void check_compare(const CLI::App& sub) {
  // Not get_option(): it allocates, and must not throw here.
  const std::vector<const CLI::Option*> options = sub.get_options();
  const auto is_given = [&](std::string_view name) {
    return std::any_of(options.begin(), options.end(), [&](const CLI::Option* option) {
      return option->count() > 0 && option->get_name() == name;
    });
  };
  if (!is_given("--compare")) {
    if (is_given("--tolerance"))
      throw ParameterError("--tolerance", "expected --compare beside it, got none");
    return;
  }
  for (const CLI::Option* option : options) {
    const std::string name = option->get_name();
    const bool fits = name == "--compare" || name == "--tolerance" || name == "--json" || name == "--quiet" ||
                      name == "--threads";
    if (option->count() > 0 && !fits)
      throw ParameterError(
          name, expected_got("only --tolerance, --json, --quiet or --threads beside --compare", name));
  }
}

void run_work_precision(const WorkArguments& arguments, Common& common) {
  if (!arguments.compare.empty()) return run_compare(arguments, common);
  const WorkOptions options = parse(arguments);
  const WorkAxes axes = axes_of(arguments);
  run_report(arguments.report,
             {.command = "work-precision",
              .command_line = command_line(options, arguments),
              .seed = options.seed,
              .seeds = std::to_string(options.seed),
              .identity = work_identity(options),
              .run =
                  [&](const auto& identity, const auto& study_options, auto& jobs, const auto& progress) {
                    const auto samples = std::make_shared<std::vector<WorkSample>>(
                        run_work_study(options, identity, study_options, jobs, progress));
                    mark_fronts(*samples, axes);
                    return Report{
                        .holds = std::all_of(samples->begin(), samples->end(),
                                             [](const WorkSample& s) { return s.holds(); }),
                        .results = {{"samples", work_json(*samples)}},
                        .page = [=](const Provenance& p) { return work_page(*samples, axes, p); },
                        .markdown = [=](const Provenance& p) { return work_markdown(*samples, axes, p); },
                        .picture = [=] { return work_picture(*samples, axes); },
                        .csv = [=] { return work_csv(*samples); },
                        .other = {},
                        .text = work_text(*samples, axes),
                        .summary = work_summary(*samples)};
                  }},
             common);
}

void add_choices(CLI::App& sub, WorkArguments& arguments) {
  std::vector<std::string> methods, families, meshes, metrics(work_metrics.begin(), work_metrics.end());
  for (const WorkMethod& method : work_methods()) {
    methods.emplace_back(method.name);
    if (std::find(families.begin(), families.end(), method.family) == families.end())
      families.emplace_back(method.family);
  }
  for (const MeshFamily& family : mesh_families()) meshes.emplace_back(family.name);
  sub.add_option("SURFACE", arguments.surfaces,
                 std::string(surface_help) + " [torus sphere klein-bottle bspline-patch]");
  sub.add_option("--methods", arguments.methods,
                 "separated by commas, some of " + joined(methods) +
                     ", or a family of them: " + joined(families) + " [all]")
      ->delimiter(',');
  sub.add_option("--meshes", arguments.meshes,
                 "separated by commas, some of " + joined(meshes) + " [jittered]")
      ->delimiter(',');
  sub.add_option("--resolutions", arguments.resolutions,
                 "rows of the meshes, with twice as many columns (lantern: 2 sqrt(rows)): 8..64 (doubling) "
                 "or 8,16,32" +
                     default_text(WorkChoices{}.resolutions));
  sub.add_option(
         "--rounds", arguments.rounds,
         "rounds, 3 or more; each times every method once, in turn" + default_text(WorkChoices{}.rounds))
      ->check(whole_number_between(3, most_rounds));
  sub.add_option("--points", arguments.points, "random points per call" + default_text(WorkChoices{}.points))
      ->check(whole_number_between(16, most_work_points));
  sub.add_option("--checked", arguments.checked,
                 "how many of these points are compared with 40 digits" + default_text(WorkChoices{}.checked))
      ->check(whole_number_between(1, most_work_points));
  sub.add_option("--timeout", arguments.timeout,
                 "seconds that a call may take; a slower method is recorded once and not called again, but "
                 "the call is not interrupted" +
                     default_text(WorkChoices{}.timeout))
      ->check(finite_number("seconds above 0", [](double x) { return x > 0; }));
  sub.add_option("--seed", arguments.seed, "seed of the points and meshes [1]")->check(whole_number);
  sub.add_option("--x", arguments.x,
                 "metric on the horizontal axis of fronts and pictures: " + joined(metrics) +
                     " [time_ns at points, seconds on meshes]")
      ->check(CLI::IsMember(metrics));
  sub.add_option("--y", arguments.y, "metric on the vertical axis [frame_max at points, frame_rms on meshes]")
      ->check(CLI::IsMember(metrics));
  sub.add_option("--compare", arguments.compare,
                 "compare two documents printed by --json, before and after; exit with status 1 where a time "
                 "or an error grew")
      ->expected(2);
  sub.add_option("--tolerance", arguments.tolerance, "growth that --compare allows: 0.1 is a tenth")
      ->capture_default_str()
      ->check(finite_number("a number from 0", [](double x) { return x >= 0; }));
}

}  // namespace

void add_work_precision(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "work-precision",
      "Measure run time against error for every way to compute a frame, at points and on meshes");
  auto arguments = std::make_shared<WorkArguments>();
  add_choices(sub, *arguments);
  add_report_options(sub, arguments->report,
                     "quick (the defaults), standard (the catalogue, 21 rounds, 8 to 64 rows), full (51 "
                     "rounds, 8 to 256 rows)");
  add_output_options(sub, arguments->report,
                     "one metric against another, a panel per surface and mesh, at most 12",
                     "every measurement");
  add_common(sub, common, "darboux work-precision torus --rounds 5 --resolutions 8,16 -o work.html");
  sub.callback([arguments, &common, &sub] {
    check_compare(sub);
    run_work_precision(*arguments, common);
  });
}

}  // namespace darboux
