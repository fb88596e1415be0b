// `darboux normalmap`: converts a normal map to another space, checks one, or compares two.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <tuple>
#include <utility>

#include "io/files.h"
#include "map_arguments.h"
#include "map_checks.h"
#include "report/lit_model.h"

namespace darboux {
namespace {

struct NormalMapArguments : MapArguments {
  std::string input, from, to, surface, report, render, size = "800x600";
  bool two_channels = false, keep_length = false, drop_colour_tags = false;
  MapCheckArguments checks;
};

constexpr Choice<MapSpace, 3> spaces{{"object", "tangent", "world"}};

struct NormalMapSeconds {
  double read = 0, convert = 0, write = 0;
};

Json report_json(const NormalMapArguments& a, const NormalMapOptions& options, const NormalMapResult& r,
                 std::span<const MapPiece> pieces, std::size_t texels, const NormalMapSeconds& seconds) {
  Json json{{"file", utf8(a.input)},
            {"output", MapOutputs::none(r) ? Json() : Json(utf8(a.output))},
            {"from", a.from},
            {"to", a.to},
            {"basis", map_bases.names[static_cast<std::size_t>(options.basis)]},
            {"decode", a.decode},
            {"green", a.green},
            {"depth", map_depths.names[static_cast<std::size_t>(*options.type)]},
            {"texels", texels}};
  add_counts(json, r);
  json["first_conflict"] = conflict_json(r, pieces);
  json["seconds"] = {
      {"read", number(seconds.read)}, {"convert", number(seconds.convert)}, {"write", number(seconds.write)}};
  return json;
}

void print_text(const NormalMapArguments& a, const NormalMapResult& r, std::span<const MapPiece> pieces,
                std::size_t texels) {
  std::cout << one_line(a.input) << ": " << r.covered << " of " << texels << " texels covered";
  if (r.dilated != 0) std::cout << ", " << r.dilated << " in the gutter filled";
  std::cout << '\n';
  print_counts(r);
  // Directions of a map lean little from the surface, unless they are read in a space that is not theirs.
  if (r.below_surface > r.covered / 10)
    std::cout << "is INPUT a map in " << a.from << " space? read as one, "
              << std::lround(100.0 * r.below_surface / r.covered)
              << " % of its texels point into the surface\n";
  if (r.first_conflict) return print_conflict(r, pieces);
  if (r.covered == 0) return;
  std::cout << "rounding: at most " << rounded(r.quantisation_max_deg, 3) << " degrees, rms "
            << rounded(r.quantisation_rms_deg, 3) << '\n'
            << a.output << '\n';
}

void check_spaces(const NormalMapArguments& a) {
  const auto need = [](const std::string& value, const char* what, const char* expected) {
    if (value.empty()) throw ParameterError(what, expected_got(expected, "none"));
  };
  need(a.input, "normalmap", "an image to read");
  need(a.output, "normalmap", "-o OUT.png");
  need(a.from, "--from", "object, tangent or world");
  need(a.to, "--to", "object or tangent");
  if (a.mesh.empty() && a.surface.empty())
    throw ParameterError("normalmap", expected_got("--mesh FILE or --surface SURFACE", "neither"));
  if (a.mesh.empty() && !a.basis.empty() && a.basis != "analytic")
    throw ParameterError("--basis", expected_got("analytic where there is no --mesh", a.basis));
  if (a.mesh.empty() && a.from == "world")
    throw ParameterError("--from", expected_got("object or tangent where there is no --mesh", a.from));
}

NormalMapOptions options_of(const NormalMapArguments& a, const Common& common) {
  NormalMapOptions options;
  options.from = spaces.of(a.from);
  options.to = spaces.of(a.to);
  options.basis = !a.basis.empty() ? map_bases.of(a.basis)
                  : a.mesh.empty() ? MapBasis::analytic
                                   : MapBasis::stored;
  const bool analytic = options.basis == MapBasis::analytic;
  if (analytic && a.surface.empty())
    throw ParameterError("--surface", expected_got("one for --basis analytic", "none"));
  if (!analytic && !a.surface.empty())
    throw ParameterError("--surface", expected_got("--basis analytic beside it", "another basis"));
  options.decode = map_decodes.of(a.decode);
  options.green = map_greens.of(a.green);
  options.two_channels = a.two_channels;
  options.keep_length = a.keep_length;
  options.signed_floats = a.signed_floats;
  options.dither = a.dither;
  options.dilate = static_cast<int>(a.dilate);
  options.threads = common.threads;
  return options;
}

// A glTF as INPUT is also the mesh, unless --mesh names another.
bool is_whole_asset(const NormalMapArguments& a) {
  return !a.input.empty() && a.mesh.empty() && a.surface.empty() && io::is_gltf(a.input);
}

// The map, and the primitives that it belongs to if it comes with the mesh; otherwise those of --primitive.
// No output may be the image that INPUT names.
MapSource map_source(const NormalMapArguments& a, const std::vector<MapFile>& written, const Common& common) {
  std::error_code none;
  const bool same_file = std::filesystem::equivalent(a.input, a.mesh, none);
  MapSource source = map_source(a.input, same_file ? &a.primitives : nullptr, common);
  check_files_apart({{"the image of INPUT", source.file}}, written);
  if (!same_file) source.primitives.clear();
  return source;
}

void run_convert(const NormalMapArguments& a, Common& common) {
  check_spaces(a);
  NormalMapOptions options = options_of(a, common);
  check_map_files({{"INPUT", a.input}, {"--mesh", a.mesh}}, a.output, a.report);
  std::optional<AnySurface> surface;
  if (!a.surface.empty()) surface = surface_argument(a.surface);
  options.surface = surface ? &*surface : nullptr;
  auto lap = [last = std::chrono::steady_clock::now()]() mutable {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last, now)).count();
  };
  MapOutputs outputs(a.output, a.report);
  std::vector<MapPiece> pieces;
  Image map;
  {
    const MapSource source = map_source(a, {{"-o", a.output}, {"--report", a.report}}, common);
    if (!a.mesh.empty()) pieces = map_pieces(a, common, a.from == "world", source.primitives);
    map = read_map(source, a.drop_colour_tags, a.signed_floats, common);
  }
  options.type = map_type(a, map.type());
  const int width = map.width, height = map.height;
  const std::size_t texels = map.texels();
  check_map_memory(a.input, map.bytes(), texels, map.channels, *options.type, common.read);
  NormalMapSeconds seconds{.read = lap()};
  NormalMapResult result;
  {
    Progress progress("normalmap", common);
    options.progress = [&](double share) { progress.update(share); };
    result = naming_the_mesh(a.mesh, [&] { return convert_normal_map(map, pieces, options); });
  }
  map = Image();
  seconds.convert = lap();
  outputs.write(result, width, height);
  seconds.write = lap();
  if (MapOutputs::none(result)) common.exit_status = 1;
  if (common.json)
    print_json(report_json(a, options, result, pieces, texels, seconds));
  else if (!common.quiet)
    print_text(a, result, pieces, texels);
}

// The mesh, lit through the map.
void run_render(const NormalMapArguments& a, Common& common) {
  if (a.input.empty() || a.mesh.empty() || (a.from != "tangent" && a.from != "object"))
    throw ParameterError("--render",
                         expected_got("an image, --mesh FILE and --from tangent or object", "not all"));
  check_files_apart({{"INPUT", a.input}, {"--mesh", a.mesh}}, {{"--render", a.render}});
  if (image_types(a.render).back() != SampleType::u16)
    throw ParameterError(a.render, expected_got("a name that ends in .png", "another"));
  LitModelOptions options{.space = spaces.of(a.from),
                          .basis = a.basis.empty() ? MapBasis::stored : map_bases.of(a.basis),
                          .green = map_greens.of(a.green),
                          .signed_floats = a.signed_floats,
                          .threads = common.threads};
  if (options.basis == MapBasis::analytic)
    throw ParameterError("--basis", expected_got("stored or mikktspace beside --render", "analytic"));
  std::tie(options.width, options.height) = parse_grid("--size", a.size);
  OutputFile render(a.render);
  const MapSource source = map_source(a, {{"--render", a.render}}, common);
  const std::vector<MapPiece> pieces = map_pieces(a, common, false, source.primitives);
  const Image map = read_map(source, a.drop_colour_tags, a.signed_floats, common);
  render.write(png_of(naming_the_mesh(a.mesh, [&] { return lit_model(map, pieces, options); })));
  render.commit();
  if (common.json)
    print_json({{"file", utf8(a.input)}, {"render", utf8(a.render)}, {"from", a.from}, {"green", a.green}});
  else if (!common.quiet)
    std::cout << a.render << '\n';
}

// Refuses options that belong to another of the four modes.
void check_ways(const CLI::App& sub, const std::vector<const char*>& others, const char* way) {
  for (const CLI::Option* option : sub.get_options())
    for (const char* name : others)
      if (option->count() != 0 && option->check_name(name))
        throw ParameterError(name, std::string("cannot be combined with ") + way);
}

void run_normalmap(const CLI::App& sub, NormalMapArguments& a, Common& common) {
  a.checks.green = a.green;
  a.checks.report = a.report;
  a.checks.signed_floats = a.signed_floats;
  const std::vector<const char*> of_conversion{"INPUT",   "--output",  "--from",         "--to",
                                               "--basis", "--surface", "--two-channels", "--keep-length",
                                               "--depth", "--dither",  "--dilate"},
      of_comparison{"--max-angle", "--worst"},
      of_mesh{"--primitive", "--sign", "--wrap", "--uv-origin", "--normal-scale"};
  if (!a.checks.file.empty()) {
    a.checks.primitives = a.primitives;
    std::vector<const char*> of_others = of_mesh;
    if (io::is_gltf(a.checks.file)) of_others.erase(of_others.begin());
    check_ways(sub, of_conversion, "--check");
    check_ways(sub, of_comparison, "--check");
    check_ways(sub, of_others, "--check");
    check_ways(sub, {"--compare", "--mesh", "--report", "--render", "--size", "--decode"}, "--check");
    return run_map_check(a.checks, common);
  }
  if (!a.checks.compared.empty()) {
    check_ways(sub, of_conversion, "--compare");
    check_ways(sub, {"--render", "--size", "--decode", "--sign", "--normal-scale"}, "--compare");
    if (a.mesh.empty()) check_ways(sub, of_mesh, "--compare without --mesh");
    return run_map_comparison(a.checks, a, a.drop_colour_tags, common);
  }
  check_ways(sub, of_comparison, "a conversion: it belongs to --compare");
  if (is_whole_asset(a)) a.mesh = a.input;
  if (!a.render.empty()) {
    check_ways(sub,
               {"--output", "--to", "--surface", "--two-channels", "--keep-length", "--depth", "--dither",
                "--dilate", "--report", "--decode"},
               "--render");
    return run_render(a, common);
  }
  check_ways(sub, {"--size"}, "a conversion: it belongs to --render");
  if (a.mesh.empty()) check_ways(sub, of_mesh, "a conversion without --mesh");
  run_convert(a, common);
}

}  // namespace

void add_normalmap(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "normalmap", "Convert a normal map from one space to another; check and compare maps");
  auto a = std::make_shared<NormalMapArguments>();
  sub.add_option("INPUT", a->input,
                 "the .png, .tga or .exr to read, or a glTF: its normal texture is read and, without --mesh, "
                 "its triangles");
  sub.add_option("--from", a->from, "the space of the map: object, tangent or world")->check(spaces.check());
  sub.add_option("--to", a->to, "the space to convert to: object or tangent")
      ->check(CLI::IsMember({"object", "tangent"}));
  add_map_options(sub, *a);
  sub.add_option("--basis", a->basis,
                 "which tangents: stored (in the file), mikktspace (computed anew) or analytic (the "
                 "surface's) [stored; analytic without --mesh]")
      ->check(map_bases.check());
  sub.add_option(
      "--surface", a->surface,
      std::string("the surface whose frames --basis analytic uses (without --mesh, over the whole map): ") +
          surface_help);
  sub.add_flag("--two-channels", a->two_channels,
               "the tangent-space map holds only x and y; z is computed from them");
  sub.add_flag("--keep-length", a->keep_length, "keep the length of the vectors instead of normalising them");
  sub.add_option("--depth", a->depth, "bits per channel to write: 8, 16 or float [as the input]")
      ->check(map_depths.check());
  sub.add_flag("--drop-colour-tags", a->drop_colour_tags,
               "read files tagged as sRGB or with a gamma, and ignore the tags");
  sub.add_option(
      "--report", a->report,
      "write a picture of the texels that are covered, conflicts in red; with --compare, of the angles");
  sub.add_option("--render", a->render,
                 "draw the mesh lit through the map as a .png (frames as with --decode gltf-viewer)");
  sub.add_option("--size", a->size, "size of that picture in pixels, WIDTHxHEIGHT")->capture_default_str();
  sub.add_option(
      "--check", a->checks.file,
      "report what is wrong with this map by itself: length, sRGB tag, swapped or flipped channels");
  sub.add_option("--compare", a->checks.compared,
                 "report the angles between two maps; with --mesh, per island")
      ->expected(2);
  sub.add_option(
         "--max-angle", a->checks.max_angle_deg,
         "angle in degrees up to which --compare calls texels the same; beyond, it exits with status 1")
      ->capture_default_str()
      ->check(finite_number("degrees from 0 to 180", [](double x) { return x >= 0 && x <= 180; }));
  sub.add_option("--worst", a->checks.worst, "number of texels that --compare lists")
      ->capture_default_str()
      ->check(whole_number_up_to(10000));
  add_read_options(sub, common);
  add_common(sub, common,
             "darboux normalmap tangent.png --from tangent --to object --mesh torus.glb -o object.png");
  sub.callback([a, &common, &sub] { run_normalmap(sub, *a, common); });
}

}  // namespace darboux
