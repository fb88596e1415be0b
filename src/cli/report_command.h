/// \file report_command.h
/// What the report commands share: presets, study files, results, shards, pages and CSV.
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

/// Adds --preset, --study, --results and --shard. \param presets what each preset is
void add_report_options(CLI::App& sub, ReportArguments& arguments, const std::string& presets);

/// Adds -o, --format and --csv. \param svg, csv what these hold
void add_output_options(CLI::App& sub, ReportArguments& arguments, const std::string& svg,
                        const std::string& csv);

/// These as they stand in the line that runs the same again: " --results FILE -o FILE".
std::string command_line_of(const ReportArguments& arguments,
                            const std::vector<std::pair<const char*, std::string>>& others = {});

/// How help texts show a default: " [24]"; of resolutions that double, " [8..128]".
std::string default_text(int n);
std::string default_text(double x);
std::string default_text(const std::vector<int>& resolutions);

/// "8..256" (doubling) or "8,16,32", of --resolutions; they grow. \param finest the largest number
/// \throws ParameterError
std::vector<int> parse_resolutions(const std::string& text, int finest);

/// Text as a shell reads it.
std::string shell_quoted(const std::string& text);

/// The surfaces' part of a study's identity: their specifications, and a hash of each file that one is read
/// from.
Json surfaces_identity(const std::vector<AnySurface>& surfaces);

/// A study file's list of names, each of which find(name) knows or throws for.
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

/// Reads what every study file has: checks that it is for this command, then overrides `choices` by its
/// preset, surfaces and seed. The preset comes first: it supplies whatever the file does not state.
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

/// A study file's list of resolutions, which grow, from 2 to `finest`. \param expected what list, of at least
/// `fewest`
void read_resolutions(const io::JsonCursor& list, std::size_t fewest, const char* expected, int finest,
                      std::vector<int>& resolutions);

/// Calls take(job, result) for each job that has a result, and counts these jobs.
/// \param what the results are, "samples of converge" \param file where they were read from
/// \throws FileError for a result of another shape
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

/// An option that writes a file too: its name, what it writes, and where; nothing where that is empty.
struct OtherOutput {
  const char *option, *what;
  std::string file;
};

/// What a command has found, in every format.
struct Report {
  bool holds;    ///< else exit status 1
  Json results;  ///< the document's own keys
  std::function<std::string(const Provenance&)> page, markdown;
  std::function<std::string()> picture, csv, other;
  std::string text;     ///< for a terminal
  std::string summary;  ///< one line, all that --quiet leaves
};

/// A study as a command runs it.
struct ReportStudy {
  std::string command;       ///< "converge"
  std::string command_line;  ///< runs the same again
  std::uint64_t seed;
  std::string seeds;  ///< in words: "1 to 3"
  Json identity;      ///< all that the results depend on
  OtherOutput other{};
  /// Runs the jobs of the shard, sets how many of them have results now, and reports.
  std::function<Report(const StudyIdentity&, const StudyOptions&, std::size_t& jobs,
                       const std::function<void(double)>& progress)>
      run;
};

/// Opens the outputs, so that a folder that cannot be written is reported before the work; runs the study
/// with its progress shown; writes the outputs and prints. \throws ParameterError where two options write to
/// one place, a format is asked for without -o, or a shard is to write more than its results
void run_report(const ReportArguments& arguments, const ReportStudy& study, Common& common);

}  // namespace darboux
