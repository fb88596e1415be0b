#include "report_command.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>

namespace darboux {

void add_report_options(CLI::App& sub, ReportArguments& arguments, const std::string& presets) {
  sub.add_option("--preset", arguments.preset, "what is not given otherwise: " + presets)
      ->capture_default_str();
  sub.add_option("--study", arguments.study,
                 "read the choices from this JSON file; those given on the command line win");
  sub.add_option("--results", arguments.results,
                 "append all samples to this file as they come; one that exists is resumed");
  sub.add_option("--shard", arguments.shard, "I/N: do only this part of the study, for darboux merge");
}

void check(const ReportArguments& arguments, const Common& common,
           const std::vector<std::pair<const char*, std::string>>& others) {
  std::string names = "-o -, --csv -";
  int to_stdout = is_standard_output(arguments.output) + is_standard_output(arguments.csv) + common.json;
  bool writes = !arguments.output.empty() || !arguments.csv.empty();
  for (const auto& [option, file] : others) {
    names += std::string(", ") + option + " -";
    to_stdout += is_standard_output(file);
    writes = writes || !file.empty();
  }
  if (to_stdout > 1)
    throw ParameterError("-", expected_got("one of " + names + " and --json for standard output", "more"));
  std::vector<std::pair<const char*, std::string>> files = others;
  files.insert(files.begin(), {{"--study", arguments.study},
                               {"--results", arguments.results},
                               {"-o", arguments.output},
                               {"--csv", arguments.csv}});
  std::map<std::string, std::string> option_of;
  for (const auto& [option, file] : files) {
    if (file.empty() || is_standard_output(file)) continue;
    std::error_code none;
    const auto [at, added] = option_of.emplace(
        std::filesystem::weakly_canonical(std::filesystem::absolute(file), none).string(), option);
    if (!added) throw ParameterError(option, expected_got("another file than that of " + at->second, file));
  }
  if (arguments.shard.empty()) return;
  if (arguments.results.empty())
    throw ParameterError("--shard", "expected --results FILE beside it, got none");
  if (writes)
    throw ParameterError("--shard",
                         "expected --results alone, got a page, CSV or picture: merge the shards first");
}

std::string command_line_of(const ReportArguments& arguments) {
  std::string line;
  for (const auto& [option, value] :
       {std::pair<const char*, const std::string&>{"--results", arguments.results},
        {"--shard", arguments.shard},
        {"-o", arguments.output}})
    if (!value.empty()) (line += std::string(" ") + option + ' ') += shell_quoted(value);
  return line;
}

std::string shell_quoted(const std::string& text) {
  if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/") ==
      std::string::npos)
    return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

Json provenance_json(const Provenance& origin, int threads) {
  return {{"command", origin.command}, {"version", origin.version}, {"compiler", origin.compiler},
          {"machine", origin.machine}, {"date", origin.date},       {"threads", threads}};
}

Json surfaces_identity(const std::vector<AnySurface>& surfaces) {
  Json names = Json::array(), inputs = Json::object();
  for (const AnySurface& surface : surfaces) {
    names.push_back(surface.specification());
    if (!surface.file().empty()) inputs[surface.file()] = hash_text(io::read_file(surface.file()));
  }
  return {{"surfaces", names}, {"inputs", inputs}};
}

void print_shard(const ReportArguments& arguments, std::size_t jobs, const Common& common) {
  if (common.json)
    return print_json({{"shard", arguments.shard}, {"jobs", jobs}, {"results", arguments.results}});
  std::printf("shard %s: %zu jobs done, in %s\n", arguments.shard.c_str(), jobs, arguments.results.c_str());
}

}  // namespace darboux
