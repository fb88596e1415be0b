#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include <unistd.h>

#include <darboux/io.h>

#include "base/extension.h"
#include "base/text.h"
#include "command.h"
#include "eval_input.h"
#include "eval_output.h"

namespace darboux {
namespace {

// Points evaluated at a time, per thread and in total: their results stay in the caches, and memory use is
// bounded.
constexpr std::size_t points_per_thread = 4096, most_points = 65536;

constexpr Choice<FrameFormat, frame_format_names.size()> frame_formats{frame_format_names};
constexpr Choice<PointFormat, point_format_names.size()> point_formats{point_format_names};

struct EvalArguments {
  std::string surface;
  std::vector<std::string> at;
  std::string grid, input, input_format, attributes, format, output;
};

std::vector<std::string> attribute_names() {
  std::vector<std::string> names;
  for (const EvalAttribute& a : eval_attributes()) names.emplace_back(a.name);
  return names;
}

std::vector<const EvalAttribute*> choose(const std::string& names, FrameFormat format) {
  const std::vector<std::string> known = attribute_names();
  std::vector<std::string> asked = split(names, ',');
  if (names.empty()) {
    // CSV and binary numbers: only the attributes of batches, so that adding others to eval changes no
    // columns.
    asked.assign(known.begin(),
                 known.begin() + (format == FrameFormat::json ? known.size() : attribute_count));
    if (format == FrameFormat::table) asked = {"position", "tangent", "bitangent", "normal", "handedness"};
    if (format == FrameFormat::json) std::erase(asked, "tangent4");
  }
  std::vector<const EvalAttribute*> chosen;
  for (const std::string& name : asked) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw ParameterError("--attributes", "unknown attribute '" + name + "', known are " + joined(known));
    const EvalAttribute* attribute = &eval_attributes()[static_cast<std::size_t>(found - known.begin())];
    if (std::find(chosen.begin(), chosen.end(), attribute) != chosen.end())
      throw ParameterError("--attributes", expected_got("each attribute once", "'" + name + "' twice"));
    chosen.push_back(attribute);
  }
  return chosen;
}

std::vector<Vec2<double>> parse_points(const std::vector<std::string>& texts) {
  std::vector<Vec2<double>> points;
  for (const std::string& text : texts) {
    const auto parts = split(text, ',');
    if (parts.size() != 2)
      throw ParameterError("--at", expected_got("U,V such as 0.3,0.7", "'" + text + "'"));
    points.push_back({parse_finite("--at", parts[0]), parse_finite("--at", parts[1])});
  }
  return points;
}

// Writes a grid, as many rows at a time as there is room for, or in pieces of a row if a row is too long.
void write_grid(FrameWriter& writer, std::size_t columns, std::size_t rows, std::size_t room,
                Progress& progress) {
  if (const std::size_t together = room / (columns + 1); together > 0) {
    for (std::size_t first = 0; first <= rows; first += together) {
      writer.write_grid(columns, rows, first, together);
      progress.update(static_cast<double>(first) / static_cast<double>(rows));
    }
    return;
  }
  const double points = (static_cast<double>(columns) + 1) * (static_cast<double>(rows) + 1);
  double done = 0;
  PointBlocks blocks(room, [&](std::span<const double> u, std::span<const double> v) {
    writer.write(u, v);
    progress.update((done += static_cast<double>(u.size())) / points);
  });
  for (std::size_t j = 0; j <= rows; ++j) {
    const double v = static_cast<double>(j) / static_cast<double>(rows);
    for (std::size_t i = 0; i <= columns; ++i)
      blocks.add(static_cast<double>(i) / static_cast<double>(columns), v);
  }
  blocks.pass_on();
}

// By --format, else by the extension of -o, else a table.
FrameFormat format_of(const EvalArguments& arguments, const Common& common) {
  const std::string format = common.json ? "json" : arguments.format;
  if (common.json && !arguments.format.empty() && arguments.format != "json")
    throw ParameterError("--json", expected_got("no --format but json beside it", arguments.format));
  if (!format.empty()) {
    const std::string name = extension_of(arguments.output).erase(0, 1);
    if (frame_formats.has(name) && name != format)
      throw ParameterError(
          "-o", expected_got("a name that ends in ." + format + ", or in the extension of no other format",
                             "'" + arguments.output + "'"));
    return frame_formats.of(format);
  }
  const std::string extension = known_extension(
      "-o", arguments.output, {".json", ".csv", ".f32", ".f64", ".npy", ".txt"}, ", or --format beside it");
  return extension.empty() || extension == ".txt" ? FrameFormat::table
                                                  : frame_formats.of(extension.substr(1));
}

void run_eval(const EvalArguments& arguments, const Common& common) {
  const AnySurface surface = surface_argument(arguments.surface);
  FrameWriterOptions options;
  options.format = format_of(arguments, common);
  options.attributes = choose(arguments.attributes, options.format);
  options.threads = common.threads;
  options.room = std::min(points_per_thread * static_cast<std::size_t>(common.threads), most_points);

  const std::vector<Vec2<double>> points = parse_points(arguments.at);
  const int sources = !points.empty() + !arguments.grid.empty() + !arguments.input.empty();
  if (sources != 1)
    throw ParameterError("eval",
                         expected_got("exactly one of --at, --grid, --input", std::to_string(sources)));
  options.points = points.size();

  std::size_t columns = 0, rows = 0;
  if (!arguments.grid.empty()) {
    std::tie(columns, rows) = parse_grid("--grid", arguments.grid);
    options.points = (columns + 1) * (rows + 1);
    if (columns + 1 <= most_points) options.room = std::max(options.room, columns + 1);
  }
  std::unique_ptr<PointInput> input;
  if (!arguments.input.empty())
    input = open_points(arguments.input, arguments.input_format.empty()
                                             ? point_format_of(arguments.input)
                                             : point_formats.of(arguments.input_format));
  else if (!arguments.input_format.empty())
    throw ParameterError("--input-format", expected_got("--input FILE with it", "none"));

  const std::string file_name = arguments.output.empty() ? "-" : arguments.output;
  OutputFile file(file_name);
  const bool typed = arguments.input == "-" && ::isatty(STDIN_FILENO) != 0;
  Progress progress("eval", common, !is_standard_output(file_name) && !typed);
  if (input && options.format == FrameFormat::npy) {
    input = counted(std::move(input), progress);
    options.points = *input->count();
  }
  const auto writer = make_frame_writer(file, surface, options);
  if (columns > 0) {
    write_grid(*writer, columns, rows, options.room, progress);
  } else {
    PointBlocks blocks(options.room, [&](std::span<const double> u, std::span<const double> v) {
      writer->write(u, v);
      if (const auto share = input ? input->share() : std::nullopt) progress.update(*share);
    });
    for (const auto& [u, v] : points) blocks.add(u, v);
    if (input) input->read(blocks);
    blocks.pass_on();
  }
  writer->finish();
  file.commit();
}

}  // namespace

void add_eval(CLI::App& app, Common& common) {
  CLI::App& sub =
      *app.add_subcommand("eval", "Evaluate positions, partials, frames and curvatures at (u, v)");
  auto arguments = std::make_shared<EvalArguments>();
  sub.add_option("SURFACE", arguments->surface, surface_help)->required();
  sub.add_option("--at", arguments->at, "U,V: a point; may be given several times")
      ->type_size(1)
      ->allow_extra_args(false);
  sub.add_option("--grid", arguments->grid,
                 "NxM segments: u = i/N, v = j/M, both ends included; v is the outer loop");
  sub.add_option("--input", arguments->input,
                 "read the points (u, v) from this file, in pieces; - for standard input");
  sub.add_option("--input-format", arguments->input_format,
                 joined({point_format_names.begin(), point_format_names.end()}) +
                     " [by the extension; csv for standard input]")
      ->check(point_formats.check());
  sub.add_option(
      "--attributes", arguments->attributes,
      "separated by commas: " + joined(attribute_names()) +
          " [table: position, tangent, bitangent, normal, handedness; csv, f32, f64 and npy: up to "
          "principal_directions; json: all but tangent4]");
  sub.add_option(
         "--format", arguments->format,
         "table, json or csv; or plain numbers: f32, f64 (little-endian) or npy [by the extension of -o; "
         "table]")
      ->check(frame_formats.check());
  sub.add_option("-o,--output", arguments->output, "write to this file, whole or not at all");
  add_common(sub, common, "darboux eval sphere --grid 4x2 --attributes position,tangent4 --format csv");
  sub.callback([arguments, &common] { run_eval(*arguments, common); });
}

}  // namespace darboux
