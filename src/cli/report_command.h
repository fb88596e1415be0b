/// \file report_command.h
/// Common code of the report commands: presets, study files, results, shards, pages and CSV.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command.h"
#include "io/json_cursor.h"
#include "report/provenance.h"
#include "study/study.h"

namespace darboux {

struct ReportArguments {
  std::string preset = "quick", study, results, shard;
  std::string output, csv, format;

  StudyOptions study_options(int threads) const {
    return {results, shard.empty() ? Shard{} : parse_shard(shard), threads};
  }
};

inline constexpr const char* preset_names = "quick, standard or full";

/// Adds --preset, --study, --results and --shard. \param presets description of the presets
void add_report_options(CLI::App& sub, ReportArguments& arguments, const std::string& presets);

/// Adds -o, --format and --csv. \param svg, csv description of their content
void add_output_options(CLI::App& sub, ReportArguments& arguments, const std::string& svg,
                        const std::string& csv);

/// These options as part of the command line that reproduces the run: " --results FILE -o FILE".
std::string command_line_of(const ReportArguments& arguments,
                            const std::vector<std::pair<const char*, std::string>>& others = {});

/// A default value for help texts: " [24]"; for doubling resolutions, " [8..128]".
std::string default_text(int n);
std::string default_text(double x);
std::string default_text(const std::vector<int>& resolutions);

/// Parses --resolutions: "8..256" (doubling) or "8,16,32", increasing. \param finest the largest permitted
/// number
/// \throws ParameterError
std::vector<int> parse_resolutions(const std::string& text, int finest);

/// Text quoted for a shell.
std::string shell_quoted(const std::string& text);

/// The surfaces in the identity of a study: their specifications, and a hash of each file from which one is
/// read.
Json surfaces_identity(const std::vector<AnySurface>& surfaces);

/// Reads a list of names from a study file. find(name) throws for unknown names.
template <class Find>
void read_names(const io::JsonCursor& list, std::vector<std::string>& names, Find find) {
  if (!list.json().is_array() || list.size() == 0) list.fail("a list of names");
  names.clear();
  for (std::size_t i = 0; i < list.size(); ++i) {
    names.push_back(list.at(i).text());
    try {
      find(names.back());
    } catch (const Error& e) {
      list.at(i).refuse(e.what());
    }
  }
}

/// Reads the keys common to all study files: checks that the file is for this command, then overrides
/// `choices` by its preset, surfaces and seed. The preset is applied first and provides the defaults.
template <class Choices>
void read_common(const io::JsonCursor& study, const char* command,
                 std::optional<Choices> (*preset_named)(std::string_view), Choices& choices) {
  if (const auto of = study.at("command"); of.text() != command) of.fail('"' + std::string(command) + '"');
  if (study.has("preset")) {
    const auto preset = study.at("preset");
    const std::optional<Choices> choices_of = preset_named(preset.text());
    if (!choices_of) preset.fail(preset_names);
    choices = *choices_of;
  }
  if (study.has("surfaces"))
    read_names(study.at("surfaces"), choices.surfaces, [](const auto& name) { surface_argument(name); });
  if (study.has("seed")) choices.seed = study.at("seed").integer();
}

/// Reads a list of increasing resolutions, from 2 to `finest`, from a study file. \param expected description
/// of the list, of at least `fewest` numbers
void read_resolutions(const io::JsonCursor& list, std::size_t fewest, const char* expected, int finest,
                      std::vector<int>& resolutions);

/// Calls take(job, result) for each job with a result, and counts these jobs. \param what description of the
/// results, "samples of converge" \param file the file from which they were read \throws FileError for a
/// result with another structure
template <class Take>
void take_results(const std::vector<Json>& results, const std::string& file, const std::string& what,
                  std::size_t& jobs_done, Take take) {
  jobs_done = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i].is_null()) continue;
    ++jobs_done;
    try {
      take(i, results[i]);
    } catch (const Json::exception&) {
      throw FileError(file, "job " + std::to_string(i) + ": " + expected_got(what, "others"));
    }
  }
}

/// Another option that writes a file: its name, the content, and the path; not used if the path is empty.
struct OtherOutput {
  const char *option, *what;
  std::string file;
};

/// The results of a command, in every output format.
struct Report {
  bool holds;    ///< if false, exit status 1
  Json results;  ///< the document's own keys
  std::function<std::string(const Provenance&)> page, markdown;
  std::function<std::string()> picture, csv, other;
  std::string text;     ///< for a terminal
  std::string summary;  ///< one line, the only output with --quiet
};

/// A study to be run by a command.
struct ReportStudy {
  std::string command;       ///< "converge"
  std::string command_line;  ///< reproduces the run
  std::uint64_t seed;
  std::string seeds;  ///< in words: "1 to 3"
  Json identity;      ///< everything on which the results depend
  OtherOutput other{};
  /// Runs the jobs of the shard, sets the number of jobs with results, and reports.
  std::function<Report(const StudyIdentity&, const StudyOptions&, std::size_t& jobs,
                       const std::function<void(double)>& progress)>
      run;
};

/// Opens the outputs first, so that an unwritable folder is reported before the work; runs the study with a
/// progress bar; writes the outputs and prints. \throws ParameterError if two options write to the same file,
/// if --format is given without -o, or if a shard would write more than its results
void run_report(const ReportArguments& arguments, const ReportStudy& study, Common& common);

}  // namespace darboux
