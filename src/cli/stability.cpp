#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include <darboux/io.h>
#include <darboux/stability.h>

#include "base/text.h"
#include "command.h"
#include "report/stability_report.h"
#include "report_command.h"
#include "stability_study.h"

namespace darboux {
namespace {

// As given; what is not given comes from the study file or the preset.
struct StabilityArguments {
  std::vector<std::string> surfaces, sweeps, routes;
  std::optional<int> points, samples;
  std::optional<std::uint64_t> seed;
  ReportArguments report;
};

// What is given wins over the study file, and that over the preset.
StabilityChoices choose(const StabilityArguments& arguments) {
  const auto preset = stability_preset(arguments.report.preset);
  if (!preset)
    throw ParameterError("--preset", expected_got(preset_names, "'" + arguments.report.preset + "'"));
  StabilityChoices choices = *preset;
  if (!arguments.report.study.empty()) read_stability_study(arguments.report.study, choices);
  if (!arguments.surfaces.empty()) choices.surfaces = arguments.surfaces;
  if (!arguments.sweeps.empty()) choices.sweeps = arguments.sweeps;
  if (!arguments.routes.empty()) choices.routes = arguments.routes;
  if (arguments.points) choices.points = *arguments.points;
  if (arguments.samples) choices.samples = *arguments.samples;
  if (arguments.seed) choices.seed = *arguments.seed;
  return choices;
}

StabilityOptions parse(const StabilityArguments& arguments) {
  const StabilityChoices choices = choose(arguments);
  StabilityOptions options;
  for (const std::string& name : choices.surfaces) options.surfaces.push_back(surface_argument(name));
  if (choices.surfaces.empty()) options.surfaces = all_surfaces();
  for (const std::string& name : choices.sweeps) options.sweeps.push_back(&find_stability_sweep(name));
  if (choices.sweeps.empty())
    for (const StabilitySweep& sweep : stability_sweeps()) options.sweeps.push_back(&sweep);
  for (const std::string& name : choices.routes) options.routes.push_back(&find_stability_route(name));
  if (choices.routes.empty())
    for (const StabilityRoute& route : stability_routes()) options.routes.push_back(&route);
  options.points = choices.points;
  options.samples = choices.samples;
  options.seed = choices.seed;
  return options;
}

// The line that runs the same again, every choice spelt out.
std::string command_line(const StabilityOptions& options, const StabilityArguments& arguments) {
  std::string line = "darboux stability";
  for (const AnySurface& surface : options.surfaces) line += ' ' + shell_quoted(surface.specification());
  const auto list = [&](const char* option, const auto& items) {
    for (std::size_t i = 0; i < items.size(); ++i)
      (line += i == 0 ? std::string(" ") + option + ' ' : ",").append(items[i]->name);
  };
  list("--sweeps", options.sweeps);
  list("--routes", options.routes);
  line += " --points " + std::to_string(options.points) + " --samples " + std::to_string(options.samples) +
          " --seed " + std::to_string(options.seed);
  return line + command_line_of(arguments.report);
}

void run_stability(const StabilityArguments& arguments, Common& common) {
  const ReportArguments& to = arguments.report;
  check(to, common);
  const StabilityOptions options = parse(arguments);
  // Opened before the work, so that a folder that cannot be written is reported at once.
  std::optional<OutputFile> output, csv;
  if (!to.output.empty()) output.emplace(to.output);
  if (!to.csv.empty()) csv.emplace(to.csv);
  const Provenance origin = provenance(DARBOUX_VERSION, command_line(options, arguments));
  const StudyIdentity identity{"stability", DARBOUX_VERSION, stability_identity(options),
                               provenance_json(origin, common.threads)};
  std::size_t jobs = 0;
  std::vector<StabilityCurve> curves;
  {
    Progress progress("stability", common);
    curves = run_stability_study(options, identity, to.study_options(common.threads), jobs,
                                 [&](double share) { progress.update(share); });
  }
  if (!to.shard.empty()) return print_shard(to, jobs, common);
  const bool holds =
      std::all_of(curves.begin(), curves.end(), [](const StabilityCurve& c) { return c.holds(); });
  common.exit_status = holds ? 0 : 1;
  const Json document{{"curves", curves_json(curves)},
                      {"holds", holds},
                      {"seed", options.seed},
                      {"study", identity.study},
                      {"provenance", identity.provenance}};
  if (output) {
    const std::string format = format_of(to);
    output->write(format == "md"     ? stability_markdown(curves, origin)
                  : format == "svg"  ? stability_picture(curves)
                  : format == "json" ? document.dump(2, ' ', false, Json::error_handler_t::replace) + '\n'
                                     : stability_page(curves, origin));
    output->commit();
  }
  if (csv) {
    csv->write(curves_csv(curves));
    csv->commit();
  }
  if (common.json) return print_json(document);
  // A page or CSV on standard output stands alone there.
  if (is_standard_output(to.output) || is_standard_output(to.csv)) return;
  std::fputs(stability_text(curves).c_str(), stdout);
  if (!to.output.empty()) std::printf("report: %s\n", to.output.c_str());
  if (!to.csv.empty()) std::printf("CSV: %s\n", to.csv.c_str());
}

}  // namespace

void add_stability(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "stability", "Stress evaluation numerically: errors in units of roundoff against what makes it hard");
  auto arguments = std::make_shared<StabilityArguments>();
  const auto names = [](const auto& items) {
    std::vector<std::string> result;
    for (const auto& item : items) result.emplace_back(item.name);
    return joined(result);
  };
  sub.add_option("SURFACE", arguments->surfaces, std::string(surface_help) + "; all when none is given");
  sub.add_option("--sweeps", arguments->sweeps,
                 "comma-separated, some of " + names(stability_sweeps()) + " [all]")
      ->delimiter(',');
  sub.add_option("--routes", arguments->routes,
                 "comma-separated, some of " + names(stability_routes()) + " [all]")
      ->delimiter(',');
  sub.add_option("--points", arguments->points, "values of x in each sweep [24]")
      ->check(CLI::Range(2, 10000));
  sub.add_option("--samples", arguments->samples, "random points at each x [3]")->check(CLI::Range(1, 10000));
  sub.add_option("--seed", arguments->seed, "of the random points [1]")->check(whole_number);
  add_report_options(sub, arguments->report,
                     "quick (the defaults), standard (61 values of x, 8 points at each), full (301, 16)");
  add_output_options(sub, arguments->report, "the curves of the first surface", "every point of every curve");
  add_common(sub, common, "darboux stability sphere torus --sweeps pole_distance,scale");
  sub.callback([arguments, &common] { run_stability(*arguments, common); });
}

}  // namespace darboux
