#include "work_precision_study.h"

#include <darboux/error.h>

#include "report/work_precision_report.h"

namespace darboux {

std::optional<WorkChoices> work_preset(std::string_view name) {
  WorkChoices choices;
  if (name == "quick") return choices;
  if (name != "standard" && name != "full") return std::nullopt;
  choices.surfaces.clear();
  choices.rounds = name == "full" ? 51 : 21;
  choices.resolutions.push_back(64);
  if (name == "full") choices.resolutions.insert(choices.resolutions.end(), {128, 256});
  return choices;
}

void read_work_study(const std::string& file, WorkChoices& choices) {
  const Json json = io::parse_json(file, io::read_file(file));
  const auto study = io::JsonCursor::with_pointers(file, json);
  study.expect_keys({"$schema", "command", "preset", "surfaces", "methods", "meshes", "resolutions", "rounds",
                     "points", "checked", "timeout", "seed"});
  read_common(study, "work-precision", work_preset, choices);
  if (study.has("methods"))
    read_names(study.at("methods"), choices.methods, [](const auto& name) { find_work_methods(name); });
  if (study.has("meshes"))
    read_names(study.at("meshes"), choices.meshes, [](const auto& name) { find_mesh_family(name); });
  if (study.has("resolutions"))
    read_resolutions(study.at("resolutions"), 1, "a list of numbers that grow", finest_work_rows,
                     choices.resolutions);
  if (study.has("rounds")) choices.rounds = static_cast<int>(study.at("rounds").integer(3, most_rounds));
  if (study.has("points"))
    choices.points = static_cast<int>(study.at("points").integer(16, most_work_points));
  if (study.has("checked"))
    choices.checked = static_cast<int>(study.at("checked").integer(1, most_work_points));
  if (study.has("timeout")) {
    choices.timeout = study.at("timeout").number();
    if (!(choices.timeout > 0)) study.at("timeout").fail("seconds above 0");
  }
}

Json work_identity(const WorkOptions& options) {
  Json study = surfaces_identity(options.surfaces), methods = Json::array(), meshes = Json::array();
  for (const WorkMethod* method : options.methods) methods.push_back(method->name);
  for (const MeshFamily* family : options.families) meshes.push_back(family->name);
  study.update({{"methods", methods},
                {"meshes", meshes},
                {"resolutions", options.resolutions},
                {"rounds", options.rounds},
                {"points", options.points},
                {"checked", options.checked},
                {"timeout", options.timeout},
                {"seed", options.seed}});
  return study;
}

std::vector<WorkSample> run_work_study(const WorkOptions& options, const StudyIdentity& identity,
                                       const StudyOptions& study, std::size_t& jobs_done,
                                       const std::function<void(double)>& progress) {
  std::vector<Job> jobs;
  for (const WorkJob& piece : work_jobs(options)) {
    const bool evaluation = piece.family == options.families.size();
    jobs.push_back({options.surfaces[piece.surface].specification() + ' ' +
                        (evaluation ? "evaluation" : std::string(options.families[piece.family]->name)),
                    [&options, piece] {
                      std::vector<WorkSample> samples = run_work_job(options, piece);
                      mark_fronts(samples);
                      return work_json(samples);
                    }});
  }
  const std::vector<Json> results = run_study(identity, jobs, study, progress);
  std::vector<WorkSample> samples;
  take_results(results, study.results, "samples of work-precision", jobs_done,
               [&](std::size_t, const Json& all) {
                 for (const Json& sample : all) samples.push_back(work_sample_of(sample));
               });
  return samples;
}

WorkDocument read_work_document(const std::string& file) {
  const Json json = io::parse_json(file, io::read_file(file));
  const std::string wanted = "what darboux work-precision --json prints";
  if (!json.is_object() || !json.contains("samples"))
    throw FileError(file, expected_got(wanted, "a document without samples"));
  WorkDocument document;
  std::vector<WorkSample>& samples = document.samples;
  try {
    for (const Json& sample : json["samples"]) samples.push_back(work_sample_of(sample));
  } catch (const Error& e) {
    throw FileError(file, "sample " + std::to_string(samples.size()) + ": " + e.what());
  } catch (const Json::exception&) {
    throw FileError(file, expected_got(wanted, "sample " + std::to_string(samples.size()) +
                                                   " with a key that is missing or of another type"));
  }
  try {
    document.study = json.at("study");
    for (const char* key : {"seed", "points", "checked", "inputs"}) document.study.at(key);
    document.version = json.at("provenance").at("version").get<std::string>();
    document.machine = json.at("provenance").at("machine").get<std::string>();
  } catch (const Json::exception&) {
    throw FileError(file, expected_got(wanted, "a study or a provenance with a key that is missing"));
  }
  return document;
}

std::vector<std::string> compare_studies(const WorkDocument& before, const WorkDocument& after,
                                         const std::string& after_file) {
  const auto expect_same = [&](const std::string& key, const Json& a, const Json& b) {
    if (a != b)
      throw FileError(after_file, "study: " + key + ": " + expected_got(a.dump() + " as before", b.dump()));
  };
  for (const char* key : {"seed", "points", "checked"})
    expect_same(key, before.study.at(key), after.study.at(key));
  for (const auto& [file, hash] : after.study.at("inputs").items())
    if (before.study.at("inputs").contains(file))
      expect_same("inputs: " + file, before.study.at("inputs").at(file), hash);
  std::vector<std::string> notes;
  const auto note = [&](const std::string& what, const std::string& a, const std::string& b) {
    if (a != b) notes.push_back(what + ": " + a + " before, " + b + " after");
  };
  note("version", before.version, after.version);
  note("machine", before.machine, after.machine);
  return notes;
}

}  // namespace darboux
