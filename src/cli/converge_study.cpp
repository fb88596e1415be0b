#include "converge_study.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include <darboux/error.h>

#include "base/text.h"

namespace darboux {
namespace {

std::string read_input(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) throw FileError(file, "expected a readable file, got none");
  return text.str();
}

// Reads the values of a study file; messages name the path of the key.
class StudyReader {
 public:
  explicit StudyReader(const std::string& file) : file_(file) {
    const std::string text = read_input(file);
    try {
      json_ = Json::parse(text);
    } catch (const Json::parse_error& e) {
      throw FileError(file, "expected JSON, got an error at byte " + std::to_string(e.byte));
    }
    if (!json_.is_object()) throw FileError(file, expected_got("a JSON object", json_.type_name()));
  }
  const Json& json() const { return json_; }

  [[noreturn]] void wrong(const std::string& path, const std::string& expected, const Json& got) const {
    throw FileError(file_, path + ": " + expected_got(expected, one_line(got.dump()).substr(0, 60)));
  }
  void only(const std::vector<std::string>& known) const {
    for (const auto& [key, value] : json_.items())
      if (std::find(known.begin(), known.end(), key) == known.end())
        throw FileError(file_, '/' + one_line(key) + ": unknown key, known are " + joined(known));
  }
  template <class Value, class Is>
  bool list(const char* key, const char* expected, Is is, std::vector<Value>& values) const {
    if (!json_.contains(key)) return false;
    const Json& list = json_[key];
    const std::string path = '/' + std::string(key);
    if (!list.is_array() || list.empty()) wrong(path, std::string("a list of ") + expected, list);
    values.clear();
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!is(list[i])) wrong(path + '/' + std::to_string(i), expected, list[i]);
      values.push_back(list[i].get<Value>());
    }
    return true;
  }
  // Names are looked up here, so that the message can say where they stand.
  template <class Find>
  void names(const char* key, std::vector<std::string>& values, Find find) const {
    if (!list(
            key, "names", [](const Json& j) { return j.is_string(); }, values))
      return;
    for (std::size_t i = 0; i < values.size(); ++i) try {
        find(values[i]);
      } catch (const Error& e) {
        throw FileError(file_, '/' + std::string(key) + '/' + std::to_string(i) + ": " + e.what());
      }
  }

 private:
  std::string file_;
  Json json_;
};

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
  static constexpr std::array<std::string_view, 3> quantities{"tangent", "bitangent", "normal"};
  const auto find = [&](const auto& names, const char* key) {
    const auto at = std::find(names.begin(), names.end(), json.at(key).get<std::string>());
    if (at == names.end()) throw ParameterError(key, "expected a known name, got " + json.at(key).dump());
    return at;
  };
  LevelSample s{};
  s.method = find_frame_method(json.at("method").get<std::string>()).name;
  s.vertex_class = static_cast<VertexClass>(find(vertex_class_names, "class") - vertex_class_names.begin());
  s.quantity = *find(quantities, "quantity");
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

ConvergeChoices converge_preset(const std::string& name) {
  ConvergeChoices choices;
  if (name == "quick") return choices;
  choices.surfaces = {"torus:major_radius=1,minor_radius=0.4",
                      "sphere",
                      "cylinder",
                      "ellipsoid",
                      "cone",
                      "one-sheet-hyperboloid"};
  choices.meshes.clear();
  for (const MeshFamily& family : mesh_families()) choices.meshes.emplace_back(family.name);
  choices.resolutions = {16, 32, 64, 128, 256, 512};
  if (name == "full") {
    choices.resolutions.insert(choices.resolutions.begin(), 8);
    choices.resolutions.push_back(1024);
  } else if (name != "standard") {
    throw ParameterError("--preset", expected_got("quick, standard or full", "'" + name + "'"));
  }
  return choices;
}

void read_converge_study(const std::string& file, ConvergeChoices& choices) {
  const StudyReader reader(file);
  const Json& json = reader.json();
  reader.only(
      {"$schema", "command", "preset", "surfaces", "methods", "meshes", "resolutions", "v_range", "seed"});
  if (json.value("command", Json()) != "converge")
    reader.wrong("/command", "\"converge\"", json.value("command", Json()));
  if (json.contains("preset")) {
    const Json& preset = json["preset"];
    if (std::find(study_presets.begin(), study_presets.end(), preset) == study_presets.end())
      reader.wrong("/preset", "quick, standard or full", preset);
    choices = converge_preset(preset.get<std::string>());
  }
  reader.names("surfaces", choices.surfaces, [](const std::string& name) { surface_argument(name); });
  reader.names("methods", choices.methods, [](const std::string& name) { find_frame_method(name); });
  reader.names("meshes", choices.meshes, [](const std::string& name) { find_mesh_family(name); });
  int last = 1;
  const auto grows = [&](const Json& j) {
    if (!j.is_number_integer() || j < last + 1 || j > finest_rows) return false;
    last = j.get<int>();
    return true;
  };
  const bool given =
      reader.list("resolutions", "whole numbers that grow, from 2 to 1024", grows, choices.resolutions);
  if (given && choices.resolutions.size() < 3)
    reader.wrong("/resolutions", "at least three numbers", json["resolutions"]);
  std::vector<double> range;
  const auto in_range = [](const Json& j) { return j.is_number() && j >= 0 && j <= 1; };
  if (reader.list("v_range", "numbers from 0 to 1", in_range, range)) {
    if (range.size() != 2 || range[0] >= range[1])
      reader.wrong("/v_range", "two numbers that grow", json["v_range"]);
    choices.v_first = range[0];
    choices.v_last = range[1];
  }
  if (json.contains("seed")) {
    if (!json["seed"].is_number_unsigned()) reader.wrong("/seed", "a whole number from 0", json["seed"]);
    choices.seed = json["seed"].get<std::uint64_t>();
  }
}

Json converge_identity(const ConvergeOptions& options) {
  Json surfaces = Json::array(), methods = Json::array(), meshes = Json::array(), inputs = Json::object();
  for (const AnySurface& surface : options.surfaces) {
    surfaces.push_back(surface.specification());
    if (!surface.file().empty()) inputs[surface.file()] = hash_text(read_input(surface.file()));
  }
  for (const FrameMethod* method : options.methods) methods.push_back(method->name);
  for (const MeshFamily* family : options.families) meshes.push_back(family->name);
  return {{"surfaces", surfaces},
          {"methods", methods},
          {"meshes", meshes},
          {"resolutions", options.resolutions},
          {"v_range", {options.v_first, options.v_last}},
          {"seed", options.seed},
          {"inputs", inputs}};
}

std::vector<Study> run_converge_study(const ConvergeOptions& options, const StudyIdentity& identity,
                                      const StudyOptions& study, std::size_t& jobs_done,
                                      const std::function<void(double)>& progress) {
  const std::vector<ConvergeJob> pieces = converge_jobs(options);
  std::vector<Job> jobs;
  for (const ConvergeJob& piece : pieces)
    jobs.push_back({options.surfaces[piece.surface].specification() + ' ' +
                        std::string(options.families[piece.family]->name) +
                        " n=" + std::to_string(piece.resolution),
                    [&options, piece] {
                      Json samples = Json::array();
                      for (const LevelSample& sample : run_converge_job(options, piece))
                        samples.push_back(sample_json(sample));
                      return samples;
                    }});
  const std::vector<Json> results = run_study(identity, jobs, study, progress);
  jobs_done = 0;
  std::vector<std::vector<LevelSample>> of_job(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (results[i].is_null()) continue;
    ++jobs_done;
    try {
      for (const Json& sample : results[i]) of_job[i].push_back(sample_of(sample, pieces[i].resolution));
    } catch (const Json::exception&) {
      throw FileError(study.results,
                      "job " + std::to_string(i) + ": expected samples of converge, got others");
    }
  }
  return conclude_studies(options, pieces, of_job);
}

}  // namespace darboux
