#include "converge_study.h"

#include <algorithm>
#include <cmath>

#include <darboux/error.h>

#include "base/text.h"
#include "io/json_cursor.h"

namespace darboux {
namespace {

void read_range(const io::JsonCursor& range, ConvergeChoices& choices) {
  if (!range.json().is_array() || range.size() != 2) range.fail("a list of two numbers");
  choices.v_first = range.at(std::size_t{0}).number();
  choices.v_last = range.at(std::size_t{1}).number();
  if (!(0 <= choices.v_first && choices.v_first < choices.v_last && choices.v_last <= 1))
    range.fail("two numbers that grow, in [0, 1]",
               shortest(choices.v_first) + " and " + shortest(choices.v_last));
}

Json sample_json(const LevelSample& s) {
  return {{"method", s.method},
          {"class", name_in(vertex_class_names, s.vertex_class)},
          {"quantity", s.quantity},
          {"max_deg", number(s.level.max_deg)},
          {"rms_deg", number(s.level.rms_deg)},
          {"p95_deg", number(s.level.p95_deg)},
          {"floor_deg", number(s.level.floor_deg)},
          {"seconds", number(s.level.seconds)},
          {"corners", s.level.corners},
          {"fallback_corners", s.level.fallback},
          {"h", number(s.level.h)},
          {"expected_order", s.expected_order}};
}

LevelSample sample_of(const Json& json, int resolution) {
  const auto number_of = [&](const char* key) {
    return json.at(key).is_null() ? std::nan("") : json.at(key).get<double>();
  };
  const auto find = [&](const auto& names, const char* key) {
    const auto at = std::find(names.begin(), names.end(), json.at(key).get<std::string>());
    if (at == names.end()) throw ParameterError(key, "expected a known name, got " + json.at(key).dump());
    return at;
  };
  LevelSample s{};
  s.method = find_frame_method(json.at("method").get<std::string>()).name;
  s.vertex_class = static_cast<VertexClass>(find(vertex_class_names, "class") - vertex_class_names.begin());
  s.quantity = *find(study_quantities, "quantity");
  s.level = {resolution,
             number_of("h"),
             number_of("max_deg"),
             number_of("rms_deg"),
             number_of("p95_deg"),
             number_of("floor_deg"),
             number_of("seconds"),
             json.at("corners").get<std::size_t>(),
             json.at("fallback_corners").get<std::size_t>(),
             false};
  s.expected_order = number_of("expected_order");
  return s;
}

}  // namespace

std::optional<ConvergeChoices> preset_named(std::string_view name) {
  ConvergeChoices choices;
  if (name == "quick") return choices;
  if (name != "standard" && name != "full") return std::nullopt;
  choices.surfaces = {"torus:major_radius=1,minor_radius=0.4",
                      "sphere",
                      "cylinder",
                      "ellipsoid",
                      "cone",
                      "one-sheet-hyperboloid"};
  choices.meshes = {"jittered", "jittered-diagonals", "regular", "sheared", "mirrored", "graded"};
  choices.resolutions = {16, 32, 64, 128, 256, 512};
  if (name == "full") choices.resolutions = {8, 16, 32, 64, 128, 256, 512, finest_rows};
  return choices;
}

void read_converge_study(const std::string& file, ConvergeChoices& choices) {
  const Json json = io::parse_json(file, io::read_file(file));
  const auto study = io::JsonCursor::with_pointers(file, json);
  study.expect_keys({"$schema", "command", "preset", "surfaces", "methods", "meshes", "resolutions",
                     "v_range", "seed", "seeds"});
  read_common(study, "converge", preset_named, choices);
  if (study.has("methods"))
    read_names(study.at("methods"), choices.methods, [](const auto& name) { find_frame_method(name); });
  if (study.has("meshes"))
    read_names(study.at("meshes"), choices.meshes, [](const auto& name) { find_mesh_family(name); });
  if (study.has("resolutions"))
    read_resolutions(study.at("resolutions"), 3, "a list of at least three numbers that grow", finest_rows,
                     choices.resolutions);
  if (study.has("v_range")) read_range(study.at("v_range"), choices);
  if (study.has("seeds")) choices.seeds = static_cast<int>(study.at("seeds").integer(1, most_seeds));
}

Json converge_identity(const ConvergeOptions& options) {
  Json study = surfaces_identity(options.surfaces), methods = Json::array(), meshes = Json::array();
  for (const FrameMethod* method : options.methods) methods.push_back(method->name);
  for (const MeshFamily* family : options.families) meshes.push_back(family->name);
  study.update({{"methods", methods},
                {"meshes", meshes},
                {"resolutions", options.resolutions},
                {"v_range", {options.v_first, options.v_last}},
                {"seed", options.seed},
                {"seeds", options.seeds}});
  return study;
}

std::vector<Study> run_converge_study(const ConvergeOptions& options, const StudyIdentity& identity,
                                      const StudyOptions& study, std::size_t& jobs_done,
                                      const std::function<void(double)>& progress) {
  const std::vector<ConvergeJob> pieces = converge_jobs(options);
  std::vector<Job> jobs;
  for (const ConvergeJob& piece : pieces)
    jobs.push_back({options.surfaces[piece.surface].specification() + ' ' +
                        std::string(options.families[piece.family]->name) +
                        " n=" + std::to_string(piece.resolution) +
                        (piece.mesh == 0 ? "" : " mesh=" + std::to_string(piece.mesh)),
                    [&options, piece] {
                      Json samples = Json::array();
                      for (const LevelSample& sample : run_converge_job(options, piece))
                        samples.push_back(sample_json(sample));
                      return samples;
                    }});
  const std::vector<Json> results = run_study(identity, jobs, study, progress);
  std::vector<std::vector<LevelSample>> of_job(jobs.size());
  take_results(results, study.results, "samples of converge", jobs_done, [&](std::size_t i, const Json& all) {
    for (const Json& sample : all) of_job[i].push_back(sample_of(sample, pieces[i].resolution));
  });
  return conclude_studies(options, pieces, of_job);
}

}  // namespace darboux
