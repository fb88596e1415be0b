/// \file report_command.h
/// What the report commands share: presets, study files, results, shards, pages and CSV.
#pragma once

#include <string>
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

/// The format of -o: as --format says, else by the file's extension: html, md, svg or json.
std::string format_of(const ReportArguments& arguments);

/// \param others options that write a file too, and their files
/// \throws ParameterError where two of these write to one place, a format is asked for without -o, or a shard
/// is to write more than its results
void check(const ReportArguments& arguments, const Common& common,
           const std::vector<std::pair<const char*, std::string>>& others = {});

/// These as they stand in the line that runs the same again: " --results FILE -o FILE".
std::string command_line_of(const ReportArguments& arguments,
                            const std::vector<std::pair<const char*, std::string>>& others = {});

/// "8..256" (doubling) or "8,16,32", of --resolutions; they grow. \param finest the largest number
/// \throws ParameterError
std::vector<int> parse_resolutions(const std::string& text, int finest);

/// Text as a shell reads it.
std::string shell_quoted(const std::string& text);

/// As results files and JSON documents hold it.
Json provenance_json(const Provenance& origin, int threads);

/// What of a study's identity the surfaces are: their specifications, and a hash of each file that one is
/// read from.
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

/// What a command says that has done one shard.
void print_shard(const ReportArguments& arguments, std::size_t jobs, const Common& common);

}  // namespace darboux
