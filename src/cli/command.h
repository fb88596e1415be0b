/// \file command.h
/// Common code of the subcommands: common options, numbers in JSON, the progress bar.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <darboux/any_surface.h>
#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/io.h>
#include <darboux/statistics.h>
#include <darboux/vector.h>

#include "base/text.h"

namespace darboux {

using Json = nlohmann::ordered_json;

/// The options common to all subcommands, and the exit status: 0 if all checks passed, 1 if a check failed or
/// the verdict is fail or undetermined, 2 for a usage error or unreadable input.
struct Common {
  bool json = false, quiet = false;
  ReadOptions read;
  int threads = 1;
  int exit_status = 0;
};

/// Adds --json, --quiet, --threads to a subcommand, and the example that ends its help.
void add_common(CLI::App& sub, Common& common, const std::string& example);

/// Adds --allow-outside to a subcommand that reads glTF.
void add_read_options(CLI::App& sub, Common& common);

/// The values of a command-line option that stands for an enumeration, in its order.
template <class E, std::size_t N>
struct Choice {
  std::array<const char*, N> names;

  CLI::IsMember check() const { return CLI::IsMember(std::vector<std::string>(names.begin(), names.end())); }
  bool has(const std::string& name) const {
    return std::find(names.begin(), names.end(), name) != names.end();
  }
  E of(const std::string& name) const {
    return static_cast<E>(std::find(names.begin(), names.end(), name) - names.begin());
  }
};

/// The values of --sign, in the order of SignConvention.
inline constexpr Choice<SignConvention, 2> sign_conventions{{"gltf", "raw"}};

/// A validator for options: digits only, and a number from `least` to `most`.
CLI::Validator whole_number_between(std::uint64_t least, std::uint64_t most);
inline CLI::Validator whole_number_up_to(std::uint64_t most) {
  return whole_number_between(0, most);
}
inline const CLI::Validator whole_number = whole_number_up_to(std::numeric_limits<std::uint64_t>::max());

/// A validator for options: a finite number that satisfies `good`; `expected` describes it in messages.
CLI::Validator finite_number(const std::string& expected, bool (*good)(double));

/// \throws ParameterError if the name of a GLB output file has the extension of another format
void check_glb_name(const std::string& output);

/// The extension of an output file, in lower case, if it is one of these, such as ".html"; empty if it has
/// none, or an unknown one, as names from mktemp have. \param otherwise what else is accepted, for the
/// message \throws ParameterError for an extension of another known format
std::string known_extension(const std::string& option, const std::string& output,
                            const std::vector<std::string>& extensions, const std::string& otherwise = {});

// One file per subcommand; each adds itself to the tool.
void add_surfaces(CLI::App& app, Common& common);
void add_eval(CLI::App& app, Common& common);
void add_check(CLI::App& app, Common& common);
void add_mesh(CLI::App& app, Common& common);
void add_tangents(CLI::App& app, Common& common);
void add_validate(CLI::App& app, Common& common);
void add_converge(CLI::App& app, Common& common);
void add_fit(CLI::App& app, Common& common);
void add_compare(CLI::App& app, Common& common);
void add_plan(CLI::App& app, Common& common);
void add_scene(CLI::App& app, Common& common);
void add_normalmap(CLI::App& app, Common& common);
void add_bake(CLI::App& app, Common& common);
void add_stability(CLI::App& app, Common& common);
void add_work_precision(CLI::App& app, Common& common);
void add_merge(CLI::App& app, Common& common);

/// A number as JSON: null for NaN and infinities, else printed so that it reads back to the same bits.
Json number(double x);
Json array(const Vec3<double>& a);
Json numbers(std::span<const double> values);
/// A text for JSON: bytes that are not UTF-8 become U+FFFD.
std::string utf8(const std::string& text);

/// Parses the whole text as a finite double, whatever the locale.
/// \throws ParameterError naming `subject`
double parse_finite(const std::string& subject, std::string_view text);

/// Parses "NxM".
/// \throws ParameterError naming `subject`
std::pair<int, int> parse_grid(const std::string& subject, const std::string& text);

/// Pieces of `text` between separators.
std::vector<std::string> split(std::string_view text, char separator);

/// The surface for a SURFACE argument: one of the catalogue, "formula:file=my.surface,a=3", or a kind that is
/// read from a file, "bezier-patch:file=net.json". A comma belongs to the path unless NAME= follows it.
/// \throws ParameterError, FileError
AnySurface surface_argument(std::string_view text);

/// The description of SURFACE in help texts.
inline constexpr const char* surface_help =
    "NAME, NAME:PARAMETER=VALUE,..., formula:file=FILE, or bezier-patch, bspline-patch or "
    "surface-of-revolution with :file=FILE";

/// Name, file and parameters of a surface as JSON, the same in all commands.
Json surface_json(const AnySurface& surface);

/// Statistics of angles as JSON, the same in all commands.
Json statistics_json(const Statistics& statistics);

/// Standard deviations as JSON, the same in all commands.
Json spread_json(const Spread& spread);

/// "mesh 0 primitive 1", and " (NAME)" where it has a name.
std::string primitive_text(std::size_t mesh, std::size_t primitive, const std::string& name = {});
template <class NamedPrimitive>
std::string primitive_text(const NamedPrimitive& p) {
  return primitive_text(p.mesh, p.primitive, p.name);
}

/// Skipped primitives as JSON, the same in all commands.
Json skipped_json(const std::vector<SkippedPrimitive>& skipped);

/// Prints "darboux: MESSAGE" on stderr, as one line whatever the message contains.
void print_error(std::string_view message);

/// The message of the exception being handled, with the name of the file even if a library did not add it.
std::string error_of(const std::string& file);

/// JSON as text, on one line if `indent` is -1. Bytes that are not UTF-8 become U+FFFD.
std::string json_text(const Json& json, int indent = 2);

/// Prints one JSON document to stdout.
void print_json(const Json& json);

/// A progress bar on stderr and the seconds so far, which count on where the share does not change, as within
/// one large file. It is drawn only on a terminal, not with --quiet, and not during the first half second.
class Progress {
 public:
  /// \param shown false where the terminal may show something else meanwhile: a pager, what is typed
  Progress(std::string label, const Common& common, bool shown = true);
  /// \param share fraction done, in [0, 1]
  void update(double share) { share_ = share; }

 private:
  void draw(const std::stop_token& stop) const noexcept;

  std::string label_;
  std::atomic<double> share_{0};
  std::jthread drawer_;
};

}  // namespace darboux
