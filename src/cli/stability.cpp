#include <algorithm>
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

// The options as given; missing ones come from the study file or the preset.
struct StabilityArguments {
  std::vector<std::string> surfaces, sweeps, routes;
  std::optional<int> points, samples;
  std::optional<std::uint64_t> seed;
  ReportArguments report;
};

// Options override the study file, which overrides the preset.
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

// The requested sweeps that a surface does not have, or that no route computes, one line each. \throws
// ParameterError if none of the surfaces has any
std::string sweeps_left_out(const StabilityOptions& options, bool named) {
  const std::vector<StabilityJob> jobs = stability_jobs(options);
  if (jobs.empty()) {
    std::vector<std::string> surfaces, sweeps, routes;
    for (const AnySurface& surface : options.surfaces) surfaces.push_back(surface.specification());
    for (const StabilitySweep* sweep : options.sweeps) sweeps.emplace_back(sweep->name);
    throw ParameterError("--sweeps", expected_got("sweeps that the surfaces have and the routes answer",
                                                  "none of " + joined(sweeps) + " for " + joined(surfaces)));
  }
  std::string text;
  const auto leave_out = [&](const std::string& why, const StabilitySweep& sweep) {
    text += "left out: " + why + ' ' + std::string(sweep.name) + '\n';
  };
  for (std::size_t k = 0; named && k < options.sweeps.size(); ++k) {
    const StabilitySweep& sweep = *options.sweeps[k];
    if (std::none_of(options.routes.begin(), options.routes.end(),
                     [&](const StabilityRoute* r) { return r->domain == sweep.domain; })) {
      leave_out("none of the routes answers", sweep);
      continue;
    }
    for (std::size_t s = 0; s < options.surfaces.size(); ++s)
      if (std::none_of(jobs.begin(), jobs.end(),
                       [&](const StabilityJob& j) { return j.surface == s && j.sweep == k; }))
        leave_out(options.surfaces[s].specification() + " has no", sweep);
  }
  return text;
}

// The command line that repeats this run, with every choice spelt out.
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
  const StabilityOptions options = parse(arguments);
  const std::string left_out =
      sweeps_left_out(options, !arguments.sweeps.empty() && !arguments.surfaces.empty());
  run_report(arguments.report,
             {.command = "stability",
              .command_line = command_line(options, arguments),
              .seed = options.seed,
              .seeds = std::to_string(options.seed),
              .identity = stability_identity(options),
              .run =
                  [&](const auto& identity, const auto& study_options, auto& jobs, const auto& progress) {
                    const auto curves = std::make_shared<std::vector<StabilityCurve>>(
                        run_stability_study(options, identity, study_options, jobs, progress));
                    return Report{
                        .holds = std::all_of(curves->begin(), curves->end(),
                                             [](const StabilityCurve& c) { return c.holds(); }),
                        .results = {{"curves", curves_json(*curves)}},
                        .page = [curves](const Provenance& p) { return stability_page(*curves, p); },
                        .markdown = [curves](const Provenance& p) { return stability_markdown(*curves, p); },
                        .picture = [curves] { return stability_picture(*curves); },
                        .csv = [curves] { return curves_csv(*curves); },
                        .other = {},
                        .text = stability_text(*curves) + left_out,
                        .summary = stability_summary(*curves)};
                  }},
             common);
}

}  // namespace

void add_stability(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "stability", "Measure numerical stability: errors in units of roundoff, as evaluation gets harder");
  auto arguments = std::make_shared<StabilityArguments>();
  const auto names = [](const auto& items) {
    std::vector<std::string> result;
    for (const auto& item : items) result.emplace_back(item.name);
    return joined(result);
  };
  sub.add_option("SURFACE", arguments->surfaces, std::string(surface_help) + "; all when none is given");
  sub.add_option("--sweeps", arguments->sweeps,
                 "separated by commas, some of " + names(stability_sweeps()) + " [all]")
      ->delimiter(',');
  sub.add_option("--routes", arguments->routes,
                 "separated by commas, some of " + names(stability_routes()) + " [all]")
      ->delimiter(',');
  sub.add_option("--points", arguments->points,
                 "values of x in each sweep" + default_text(StabilityChoices{}.points))
      ->check(whole_number_between(2, most_points));
  sub.add_option("--samples", arguments->samples,
                 "random points at each x" + default_text(StabilityChoices{}.samples))
      ->check(whole_number_between(1, most_points));
  sub.add_option("--seed", arguments->seed, "seed of the random points [1]")->check(whole_number);
  add_report_options(sub, arguments->report,
                     "quick (the defaults), standard (61 values of x, 8 points at each), full (301, 16)");
  add_output_options(sub, arguments->report, "the curves of the first surface", "every point of every curve");
  add_common(sub, common, "darboux stability sphere torus --sweeps pole_distance,scale");
  sub.callback([arguments, &common] { run_stability(*arguments, common); });
}

}  // namespace darboux
