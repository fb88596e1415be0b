#include "stability_study.h"

#include "report/stability_report.h"

namespace darboux {

std::optional<StabilityChoices> stability_preset(std::string_view name) {
  StabilityChoices choices;
  if (name == "quick") return choices;
  if (name == "standard") {
    choices.points = 61;
    choices.samples = 8;
    return choices;
  }
  if (name != "full") return std::nullopt;
  choices.points = 301;
  choices.samples = 16;
  return choices;
}

void read_stability_study(const std::string& file, StabilityChoices& choices) {
  const Json json = io::parse_json(file, io::read_file(file));
  const auto study = io::JsonCursor::with_pointers(file, json);
  study.expect_keys(
      {"$schema", "command", "preset", "surfaces", "sweeps", "routes", "points", "samples", "seed"});
  read_common(study, "stability", stability_preset, choices);
  if (study.has("sweeps"))
    read_names(study.at("sweeps"), choices.sweeps, [](const auto& name) { find_stability_sweep(name); });
  if (study.has("routes"))
    read_names(study.at("routes"), choices.routes, [](const auto& name) { find_stability_route(name); });
  if (study.has("points")) choices.points = static_cast<int>(study.at("points").integer(2, most_points));
  if (study.has("samples")) choices.samples = static_cast<int>(study.at("samples").integer(1, most_points));
}

Json stability_identity(const StabilityOptions& options) {
  Json study = surfaces_identity(options.surfaces), sweeps = Json::array(), routes = Json::array();
  for (const StabilitySweep* sweep : options.sweeps) sweeps.push_back(sweep->name);
  for (const StabilityRoute* route : options.routes) routes.push_back(route->name);
  study.update({{"sweeps", sweeps},
                {"routes", routes},
                {"points", options.points},
                {"samples", options.samples},
                {"seed", options.seed}});
  return study;
}

std::vector<StabilityCurve> run_stability_study(const StabilityOptions& options,
                                                const StudyIdentity& identity, const StudyOptions& study,
                                                std::size_t& jobs_done,
                                                const std::function<void(double)>& progress) {
  const std::vector<StabilityJob> pieces = stability_jobs(options);
  std::vector<Job> jobs;
  for (const StabilityJob& piece : pieces)
    jobs.push_back({options.surfaces[piece.surface].specification() + ' ' +
                        std::string(options.sweeps[piece.sweep]->name),
                    [&options, piece] { return curves_json(run_stability_job(options, piece)); }});
  const std::vector<Json> results = run_study(identity, jobs, study, progress);
  std::vector<StabilityCurve> curves;
  take_results(results, study.results, "curves of stability", jobs_done, [&](std::size_t, const Json& all) {
    for (const Json& curve : all) curves.push_back(curve_of(curve));
  });
  return curves;
}

}  // namespace darboux
