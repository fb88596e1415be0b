#include "command.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <new>
#include <system_error>

#include <unistd.h>

#include <darboux/io.h>

#include "base/extension.h"
#include "base/text.h"

namespace darboux {

void add_common(CLI::App& sub, Common& common, const std::string& example) {
  sub.add_flag("--json", common.json, "print one JSON document to stdout and nothing else");
  sub.add_flag("--quiet", common.quiet,
               "print no progress bar and no notes; commands that judge print one verdict per line, commands "
               "that write files print nothing but errors");
  sub.add_option("--threads", common.threads,
                 "number of threads; results do not depend on it, only measured times do")
      ->capture_default_str()
      ->check(whole_number_between(1, 1024));
  sub.set_version_flag("--version", std::string("darboux ") + DARBOUX_VERSION);
  sub.footer("\nExample:\n  " + example + "\n");
}

void add_read_options(CLI::App& sub, Common& common) {
  sub.add_flag("--allow-outside", common.read.allow_outside,
               "also open files outside the folder of a .gltf that it refers to by ../ or a symbolic link");
  sub.add_flag_callback(
      "--no-sandbox", [&common] { common.read.sandbox = false; },
      "do not sandbox the process that reads OBJ and FBX; needed only on kernels without seccomp");
  sub.add_option_function<std::uint64_t>(
         "--max-memory", [&common](const std::uint64_t& bytes) { common.read.max_memory = bytes; },
         "largest size of the decoded content of a glTF, COLLADA, PLY or image, such as 8GiB [4GiB or 16 "
         "times the file, whichever is larger; 512MiB for files below 10 MB]")
      ->transform(CLI::AsSizeValue(false))
      ->transform(CLI::Validator(
          [](std::string& text) {
            const bool number = !text.empty() && text[0] >= '0' && text[0] <= '9';
            return number ? std::string() : expected_got("a size such as 8GiB", "'" + text + "'");
          },
          ""));
}

CLI::Validator whole_number_between(std::uint64_t least, std::uint64_t most) {
  const auto check = [least, most](const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good =
        error == std::errc{} && end == text.data() + text.size() && value >= least && value <= most;
    return good ? std::string()
                : expected_got("a whole number from " + std::to_string(least) + " to " + std::to_string(most),
                               "'" + text + "'");
  };
  return {check, ""};
}

CLI::Validator finite_number(const std::string& expected, bool (*good)(double)) {
  const auto check = [=](const std::string& text) {
    try {
      if (good(parse_finite("", text))) return std::string();
    } catch (const ParameterError&) {
      // A message with what this option expects follows below.
    }
    return expected_got(expected, "'" + text + "'");
  };
  return {check, ""};
}

void check_glb_name(const std::string& output) {
  const auto others = asset_extensions();
  const std::string extension = extension_of(output);
  if (extension != ".glb" && std::find(others.begin(), others.end(), extension) != others.end())
    throw ParameterError(output, expected_got("a name of a GLB, not ending in " + extension, output));
}

std::string known_extension(const std::string& option, const std::string& output,
                            const std::vector<std::string>& extensions, const std::string& otherwise) {
  // Formats other than those of meshes.
  constexpr std::string_view formats[] = {".html",  ".htm",  ".md",    ".txt",  ".tex", ".csv", ".tsv",
                                          ".xlsx",  ".json", ".jsonl", ".xml",  ".npy", ".f32", ".f64",
                                          ".sarif", ".svg",  ".pdf",   ".ps",   ".eps", ".png", ".jpg",
                                          ".gif",   ".tga",  ".jpeg",  ".webp", ".exr", ".xyz", ".pcd"};
  const auto is_in = [](const auto& list, const std::string& name) {
    return std::find(std::begin(list), std::end(list), name) != std::end(list);
  };
  const std::string extension = extension_of(output);
  if (is_in(extensions, extension)) return extension;
  if (!is_in(formats, extension) && !is_in(asset_extensions(), extension)) return {};
  throw ParameterError(
      option, expected_got((extensions.size() > 1 ? "a name that ends in one of " : "a name that ends in ") +
                               joined(extensions) + otherwise,
                           "'" + output + "'"));
}

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json array(const Vec3<double>& a) {
  return {number(a.x), number(a.y), number(a.z)};
}

Json numbers(std::span<const double> values) {
  Json json = Json::array();
  for (const double x : values) json.push_back(number(x));
  return json;
}

std::string utf8(const std::string& text) {
  return Json::parse(json_text(text, -1)).get<std::string>();
}

double parse_finite(const std::string& subject, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    throw ParameterError(subject,
                         expected_got("a finite number such as 0.25", "'" + std::string(text) + "'"));
  return value;
}

std::pair<int, int> parse_grid(const std::string& subject, const std::string& text) {
  const std::vector<std::string> parts = split(text, 'x');
  int sizes[2] = {0, 0};
  bool good = parts.size() == 2;
  for (std::size_t k = 0; good && k < 2; ++k) {
    const auto [end, error] = std::from_chars(parts[k].data(), parts[k].data() + parts[k].size(), sizes[k]);
    good = error == std::errc{} && end == parts[k].data() + parts[k].size() && sizes[k] >= 1 &&
           sizes[k] <= 1000000000;
  }
  if (!good)
    throw ParameterError(
        subject, expected_got("NxM with N and M from 1 to 1000000000, such as 64x32", "'" + text + "'"));
  return {sizes[0], sizes[1]};
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text = text.substr(end + 1);
  }
}

Json surface_json(const AnySurface& surface) {
  Json parameters = Json::object();
  for (const ParameterValue& p : surface.parameters()) parameters[std::string(p.name)] = number(p.value);
  Json result{{"name", surface.info().name}};
  if (!surface.file().empty()) result["file"] = surface.file();
  result["parameters"] = parameters;
  return result;
}

Json statistics_json(const Statistics& s) {
  return {{"max", number(s.max)}, {"rms", number(s.rms)}, {"p95", number(s.p95)}};
}

Json spread_json(const Spread& spread) {
  return {{"max", number(spread.max())}, {"rms", number(spread.rms())}, {"infinite", spread.infinite()}};
}

namespace {

// The pieces between commas, where only a comma before NAME= separates.
std::vector<std::string> split_assignments(std::string_view text) {
  std::vector<std::string> parts;
  for (const std::string& piece : split(text, ',')) {
    const std::size_t name_end =
        piece.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
    const bool assignment = name_end != std::string::npos && name_end > 0 && piece[name_end] == '=';
    if (assignment || parts.empty())
      parts.push_back(piece);
    else
      parts.back() += ',' + piece;
  }
  return parts;
}

}  // namespace

AnySurface surface_argument(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string name(text.substr(0, colon));
  const bool formula = name == "formula";
  const auto& kinds = surface_file_kinds();
  const bool from_file = formula || std::find(kinds.begin(), kinds.end(), name) != kinds.end();
  if (!from_file || (!formula && colon == std::string_view::npos)) return make_surface(text);

  std::string file;
  std::vector<std::pair<std::string, std::string>> texts;
  if (colon != std::string_view::npos)
    for (const std::string& item : split_assignments(text.substr(colon + 1))) {
      const std::size_t equals = item.find('=');
      const std::string key = item.substr(0, equals);
      const auto same = [&](const auto& p) { return p.first == key; };
      if ((key == "file" && !file.empty()) || std::any_of(texts.begin(), texts.end(), same))
        throw ParameterError(name, "'" + key + "': " + expected_got("one value", "a second one"));
      if (equals == std::string::npos || equals + 1 == item.size())
        throw ParameterError(
            name,
            "'" + key + "': " +
                expected_got(std::string("file=FILE") + (formula ? " or PARAMETER=NUMBER" : ""), "no value"));
      if (key == "file")
        file = item.substr(equals + 1);
      else if (formula)
        texts.emplace_back(key, item.substr(equals + 1));
      else
        throw ParameterError(name, "unknown parameter '" + key + "', known are file");
    }
  if (file.empty())
    throw ParameterError(
        name, expected_got(name + ":file=FILE" + (formula ? ", where FILE has lines such as z = u*v" : ""),
                           "no file"));
  std::vector<std::pair<std::string, double>> parameters;
  for (const auto& [key, text_of] : texts)
    parameters.emplace_back(key, parse_finite(name + ": " + key, text_of));
  return formula ? read_formula_surface(file, parameters) : read_surface_file(name, file);
}

std::string primitive_text(std::size_t mesh, std::size_t primitive, const std::string& name) {
  return "mesh " + std::to_string(mesh) + " primitive " + std::to_string(primitive) +
         (name.empty() ? "" : " (" + one_line(name) + ")");
}

Json skipped_json(const std::vector<SkippedPrimitive>& skipped) {
  Json json = Json::array();
  for (const SkippedPrimitive& s : skipped)
    json.push_back({{"mesh", s.mesh}, {"primitive", s.primitive}, {"reason", s.reason}});
  return json;
}

void print_error(std::string_view message) {
  std::cerr << "darboux: " << message_line(message) << '\n';
}

std::string error_of(const std::string& file) {
  try {
    throw;
  } catch (const FileError& e) {
    return e.what();
  } catch (const std::bad_alloc&) {
    return FileError(file, "needs more memory than there is").what();
  } catch (const std::exception& e) {
    return FileError(file, e.what()).what();
  }
}

std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

void print_json(const Json& json) {
  std::cout << json_text(json) << '\n';
}

Progress::Progress(std::string label, const Common& common, bool shown) : label_(std::move(label)) {
  if (!shown || common.quiet || ::isatty(STDERR_FILENO) == 0) return;
  try {
    drawer_ = std::jthread([this](const std::stop_token& stop) { draw(stop); });
  } catch (const std::system_error&) {  // no thread is left for it: no bar
  }
}

void Progress::draw(const std::stop_token& stop) const noexcept {
  using namespace std::chrono_literals;
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  std::mutex mutex;
  std::condition_variable_any ends;
  std::unique_lock lock(mutex);
  const auto stops_within = [&](auto time) {
    return ends.wait_for(lock, stop, time, [&] { return stop.stop_requested(); });
  };
  if (stops_within(500ms)) return;
  do {
    constexpr int width = 40;
    static constexpr char done[] = "########################################",
                          left[] = "........................................";
    const double share = std::fmin(1, std::fmax(0, share_));
    const int filled = static_cast<int>(std::lround(width * share));
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    std::fprintf(stderr, "\r%s [%.*s%.*s] %3.0f %%, %.0f s", label_.c_str(), filled, done, width - filled,
                 left, 100 * share, std::floor(seconds));
  } while (!stops_within(200ms));
  std::fputs("\r\033[K", stderr);
}

}  // namespace darboux
