#include "report_command.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

namespace darboux {
namespace {

constexpr std::array formats{"html", "md", "svg", "json"};

}  // namespace

void add_report_options(CLI::App& sub, ReportArguments& arguments, const std::string& presets) {
  sub.add_option("--preset", arguments.preset, "defaults for options that are not given: " + presets)
      ->capture_default_str();
  sub.add_option("--study", arguments.study,
                 "read the options from this JSON file; those on the command line take precedence");
  sub.add_option("--results", arguments.results,
                 "append all samples to this file as they are made; an existing file is resumed");
  sub.add_option("--shard", arguments.shard,
                 "I/N: compute only the I-th of N parts of the study; darboux merge joins them");
}

void add_output_options(CLI::App& sub, ReportArguments& arguments, const std::string& svg,
                        const std::string& csv) {
  sub.add_option("-o,--output", arguments.output, "write a report to this file");
  sub.add_option("--format", arguments.format,
                 "format of the report: html (a page), md (tables), svg (" + svg +
                     ") or json [by the file's extension, html where that names no format]")
      ->check(CLI::IsMember(std::vector<std::string>(formats.begin(), formats.end())));
  sub.add_option("--csv", arguments.csv, "write " + csv + " to this file");
}

std::string command_line_of(const ReportArguments& arguments,
                            const std::vector<std::pair<const char*, std::string>>& others) {
  std::vector<std::pair<const char*, std::string>> options{{"--results", arguments.results},
                                                           {"--shard", arguments.shard},
                                                           {"-o", arguments.output},
                                                           {"--format", arguments.format},
                                                           {"--csv", arguments.csv}};
  options.insert(options.end(), others.begin(), others.end());
  std::string line;
  for (const auto& [option, value] : options)
    if (!value.empty()) (line += std::string(" ") + option + ' ') += shell_quoted(value);
  return line;
}

std::string default_text(int n) {
  return " [" + std::to_string(n) + "]";
}

std::string default_text(double x) {
  return " [" + shortest(x) + "]";
}

std::string default_text(const std::vector<int>& resolutions) {
  return " [" + std::to_string(resolutions.front()) + ".." + std::to_string(resolutions.back()) + "]";
}

namespace {

int parse_resolution(std::string_view text, int finest) {
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc{} || end != text.data() + text.size() || n < 2 || n > finest)
    throw ParameterError("--resolutions", expected_got("numbers from 2 to " + std::to_string(finest) +
                                                           ", as 8..256 (doubling) or 8,16,32",
                                                       "'" + std::string(text) + "'"));
  return n;
}

}  // namespace

std::vector<int> parse_resolutions(const std::string& text, int finest) {
  std::vector<int> result;
  if (const std::size_t dots = text.find(".."); dots != std::string::npos) {
    const int first = parse_resolution(std::string_view(text).substr(0, dots), finest),
              last = parse_resolution(std::string_view(text).substr(dots + 2), finest);
    if (first > last)
      throw ParameterError("--resolutions", expected_got("numbers that grow", "'" + text + "'"));
    for (int n = first; n <= last; n *= 2) result.push_back(n);
  } else {
    for (const std::string& piece : split(text, ',')) {
      const int n = parse_resolution(piece, finest);
      if (!result.empty() && n <= result.back())
        throw ParameterError("--resolutions", expected_got("numbers that grow", "'" + text + "'"));
      result.push_back(n);
    }
  }
  return result;
}

void read_resolutions(const io::JsonCursor& list, std::size_t fewest, const char* expected, int finest,
                      std::vector<int>& resolutions) {
  if (!list.json().is_array() || list.size() < fewest) list.fail(expected);
  resolutions.clear();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto n = static_cast<int>(list.at(i).integer(2, finest));
    if (i > 0 && n <= resolutions.back()) list.at(i).fail("numbers that grow");
    resolutions.push_back(n);
  }
}

std::string shell_quoted(const std::string& text) {
  if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/") ==
      std::string::npos)
    return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

Json surfaces_identity(const std::vector<AnySurface>& surfaces) {
  Json names = Json::array(), inputs = Json::object();
  for (const AnySurface& surface : surfaces) {
    names.push_back(surface.specification());
    if (!surface.file().empty()) inputs[surface.file()] = hash_text(io::read_file(surface.file()));
  }
  return {{"surfaces", names}, {"inputs", inputs}};
}

namespace {

// The format of -o: by --format, else by the extension, else html. \throws ParameterError
std::string format_of(const ReportArguments& arguments) {
  if (!arguments.format.empty()) return arguments.format;
  std::vector<std::string> extensions{".htm"};
  for (const char* format : formats) extensions.push_back(std::string(".") + format);
  const std::string extension =
      known_extension("-o", arguments.output, extensions, ", or --format beside it; --csv writes CSV");
  return extension.empty() || extension == ".htm" ? "html" : extension.substr(1);
}

void check(const ReportArguments& arguments, const OtherOutput& other, const Common& common) {
  const std::string names =
      "-o -, --csv -" + (other.option ? std::string(", ") + other.option + " -" : std::string());
  const int to_stdout = is_standard_output(arguments.output) + is_standard_output(arguments.csv) +
                        is_standard_output(other.file) + common.json;
  const bool writes = !arguments.output.empty() || !arguments.csv.empty() || !other.file.empty();
  if (to_stdout > 1)
    throw ParameterError("-", expected_got("one of " + names + " and --json for standard output", "more"));
  std::map<std::string, std::string> option_of;
  for (const auto& [option, file] :
       std::vector<std::pair<const char*, std::string>>{{"--study", arguments.study},
                                                        {"--results", arguments.results},
                                                        {"-o", arguments.output},
                                                        {"--csv", arguments.csv},
                                                        {other.option ? other.option : "", other.file}}) {
    if (file.empty() || is_standard_output(file)) continue;
    std::error_code none;
    const auto [at, added] = option_of.emplace(
        std::filesystem::weakly_canonical(std::filesystem::absolute(file), none).string(), option);
    if (!added) throw ParameterError(option, expected_got("another file than that of " + at->second, file));
  }
  known_extension("--csv", arguments.csv, {".csv", ".txt"});
  known_extension("--results", arguments.results, {".jsonl", ".json", ".txt"});
  if (!arguments.format.empty() && arguments.output.empty())
    throw ParameterError("--format", "expected -o FILE with it, got none");
  if (arguments.shard.empty()) return;
  if (arguments.results.empty())
    throw ParameterError("--shard", "expected --results FILE beside it, got none");
  if (writes)
    throw ParameterError("--shard",
                         "expected --results alone, got a page, CSV or picture: merge the shards first");
}

// As in results files and JSON documents.
Json provenance_json(const Provenance& origin, int threads) {
  return {{"command", origin.command}, {"version", origin.version}, {"compiler", origin.compiler},
          {"machine", origin.machine}, {"date", origin.date},       {"threads", threads}};
}

// Prints the summary of a command that has run one shard.
void print_shard(const ReportArguments& arguments, std::size_t jobs, const Common& common) {
  if (common.json)
    return print_json({{"shard", arguments.shard}, {"jobs", jobs}, {"results", arguments.results}});
  if (!common.quiet)
    std::printf("shard %s: %zu jobs done, in %s\n", arguments.shard.c_str(), jobs, arguments.results.c_str());
}

}  // namespace

void run_report(const ReportArguments& to, const ReportStudy& study, Common& common) {
  check(to, study.other, common);
  const std::string format = format_of(to);
  struct Output {
    std::string what, file;
    std::optional<OutputFile> open{};
  };
  std::array<Output, 3> outputs{Output{"report", to.output}, Output{"CSV", to.csv},
                                Output{study.other.what ? study.other.what : "", study.other.file}};
  for (Output& output : outputs)
    if (!output.file.empty()) output.open.emplace(output.file);
  Provenance origin = provenance(DARBOUX_VERSION, study.command_line);
  origin.seeds = study.seeds;
  const StudyIdentity identity{study.command, DARBOUX_VERSION, study.identity,
                               provenance_json(origin, common.threads)};
  std::size_t jobs = 0;
  Report report;
  {
    Progress progress(study.command, common);
    report = study.run(identity, to.study_options(common.threads), jobs,
                       [&](double share) { progress.update(share); });
  }
  if (!to.shard.empty()) return print_shard(to, jobs, common);
  common.exit_status = report.holds ? 0 : 1;
  Json document = report.results;
  document.update({{"holds", report.holds},
                   {"seed", study.seed},
                   {"study", identity.study},
                   {"provenance", identity.provenance}});
  const auto in_format = [&] {
    return format == "md"     ? report.markdown(origin)
           : format == "svg"  ? report.picture()
           : format == "json" ? json_text(document) + '\n'
                              : report.page(origin);
  };
  for (std::size_t i = 0; i < outputs.size(); ++i)
    if (outputs[i].open) {
      outputs[i].open->write(i == 0 ? in_format() : i == 1 ? report.csv() : report.other());
      outputs[i].open->commit();
    }
  if (common.json) return print_json(document);
  // Nothing else is printed if an output goes to standard output.
  if (std::any_of(outputs.begin(), outputs.end(), [](const Output& o) { return is_standard_output(o.file); }))
    return;
  if (common.quiet) return void(std::puts(report.summary.c_str()));
  std::fputs(report.text.c_str(), stdout);
  for (const Output& output : outputs)
    if (output.open) std::printf("%s: %s\n", output.what.c_str(), output.file.c_str());
}

}  // namespace darboux
