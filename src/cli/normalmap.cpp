// `darboux normalmap`: a normal map in another space.
#include <charconv>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>

#include <darboux/image_files.h>
#include <darboux/normal_map.h>
#include <darboux/normal_map_files.h>

#include "command.h"

namespace darboux {
namespace {

struct NormalMapArguments {
  std::string input, output, from, to, mesh, surface, basis, decode = "mikktspace", green = "opengl", depth,
                                                             sign = "gltf", wrap, uv_origin, report;
  std::vector<std::string> primitives;
  bool two_channels = false, keep_length = false, signed_floats = false, drop_colour_tags = false;
  std::optional<std::uint64_t> dither;
  std::uint64_t dilate = 0;
};

constexpr Choice<MapSpace, 3> spaces{{"object", "tangent", "world"}};
constexpr Choice<MapBasis, 3> bases{{"stored", "mikktspace", "analytic"}};
constexpr Choice<MapDecode, 2> decodes{{"mikktspace", "gltf-viewer"}};
constexpr Choice<MapGreen, 2> greens{{"opengl", "directx"}};
constexpr Choice<MapWrap, 3> wrap_modes{{"repeat", "mirror", "clamp"}};
constexpr Choice<SampleType, 3> depths{{"8", "16", "float"}};

// Each file another, so that none is read and written; and names of images.
void check_files(const NormalMapArguments& a) {
  std::set<std::string> seen;
  const auto take = [&](const std::string& name) {
    if (name.empty()) return;
    std::error_code none;
    if (!seen.insert(std::filesystem::weakly_canonical(name, none).string()).second)
      throw ParameterError(name, expected_got("a file for one thing", "for two"));
  };
  for (const std::string& name : {a.input, a.mesh, a.output, a.report}) take(name);
  image_types(a.output);
  if (!a.report.empty() && image_types(a.report).front() != SampleType::u8)
    throw ParameterError(a.report, expected_got("a name that ends in .png or .tga", "another"));
}

// "2" or "2:0": a mesh, or a primitive of it.
std::pair<std::size_t, std::optional<std::size_t>> primitive_argument(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  std::size_t numbers[2] = {0, 0};
  bool good = parts.size() <= 2;
  for (std::size_t k = 0; good && k < parts.size(); ++k) {
    const auto [end, error] = std::from_chars(parts[k].data(), parts[k].data() + parts[k].size(), numbers[k]);
    good = error == std::errc{} && end == parts[k].data() + parts[k].size();
  }
  if (!good)
    throw ParameterError("--primitive",
                         expected_got("MESH or MESH:PRIMITIVE, such as 0:1", "'" + text + "'"));
  if (parts.size() == 1) return {numbers[0], std::nullopt};
  return {numbers[0], numbers[1]};
}

std::vector<MapPiece> pieces_of(const NormalMapArguments& a, const Common& common) {
  if (a.mesh.empty()) return {};
  MapPieceOptions options{.read = common.read};
  for (const std::string& text : a.primitives) options.only.push_back(primitive_argument(text));
  options.sign = a.sign == "raw" ? SignConvention::raw : SignConvention::gltf;
  if (!a.wrap.empty()) options.wrap = wrap_modes.of(a.wrap);
  if (!a.uv_origin.empty()) options.v_up = a.uv_origin == "bottom";
  options.world = a.from == "world";
  return normal_map_pieces(a.mesh, options);
}

// What the file can hold that is nearest to the input's.
SampleType type_of(const NormalMapArguments& a, SampleType input) {
  const auto types = image_types(a.output);
  const auto has = [&](SampleType t) { return std::find(types.begin(), types.end(), t) != types.end(); };
  if (a.depth.empty()) return has(input) ? input : types.back();
  const SampleType wanted = depths.of(a.depth);
  if (!has(wanted))
    throw ParameterError("--depth", expected_got(std::string("one that ") +
                                                     (types.back() == SampleType::f32  ? "EXR has: float"
                                                      : types.back() == SampleType::u8 ? "TGA has: 8"
                                                                                       : "PNG has: 8 or 16"),
                                                 a.depth));
  return wanted;
}

Json owner_json(const MapConflict::Owner& owner, std::span<const MapPiece> pieces) {
  return {{"mesh", pieces[owner.piece].mesh_index},
          {"primitive", pieces[owner.piece].primitive},
          {"triangle", owner.triangle},
          {"codes", {number(owner.codes[0]), number(owner.codes[1]), number(owner.codes[2])}}};
}

struct NormalMapSeconds {
  double read = 0, convert = 0, write = 0;
};

Json report_json(const NormalMapArguments& a, const NormalMapOptions& options, const NormalMapResult& r,
                 std::span<const MapPiece> pieces, std::size_t texels, const NormalMapSeconds& seconds) {
  Json conflict;
  if (r.first_conflict) {
    const MapConflict& c = *r.first_conflict;
    conflict = {{"texel", {c.x, c.y}},
                {"triangles", {owner_json(c.owners[0], pieces), owner_json(c.owners[1], pieces)}}};
  }
  return {{"file", utf8(a.input)},
          {"output", r.conflicts != 0 ? Json() : Json(utf8(a.output))},
          {"from", a.from},
          {"to", a.to},
          {"basis", bases.names[static_cast<std::size_t>(options.basis)]},
          {"decode", a.decode},
          {"green", a.green},
          {"depth", depths.names[static_cast<std::size_t>(*options.type)]},
          {"texels", texels},
          {"covered", r.covered},
          {"dilated", r.dilated},
          {"conflicts", r.conflicts},
          {"first_conflict", conflict},
          {"below_surface", r.below_surface},
          {"not_finite", r.not_finite},
          {"no_frame", r.no_frame},
          {"too_long", r.too_long},
          {"outside_map", r.outside_map},
          {"degenerate_uv_triangles", r.degenerate_uv_triangles},
          {"mixed_sign_triangles", r.mixed_sign_triangles},
          {"condition",
           {{"max", r.condition == 0 ? Json() : number(r.condition)}, {"above_10", r.condition_above_10}}},
          {"quantisation_deg",
           {{"max", number(r.quantisation_max_deg)}, {"rms", number(r.quantisation_rms_deg)}}},
          {"seconds",
           {{"read", number(seconds.read)},
            {"convert", number(seconds.convert)},
            {"write", number(seconds.write)}}}};
}

void print_text(const NormalMapArguments& a, const NormalMapResult& r, std::span<const MapPiece> pieces,
                std::size_t texels) {
  std::ostream& out = std::cout;
  out << a.input << ": " << r.covered << " of " << texels << " texels covered";
  if (r.dilated != 0) out << ", " << r.dilated << " in the gutter filled";
  out << '\n';
  const auto count = [&](std::size_t n, const char* text) {
    if (n != 0) out << n << ' ' << text << '\n';
  };
  count(r.below_surface, "texels with z <= 0 in tangent space, which glTF discourages");
  count(r.not_finite, "covered texels that are no direction (NaN, infinite or zero), left empty");
  count(r.no_frame, "covered texels without a frame, left empty");
  count(r.too_long, "texels with x² + y² > 1, whose z is taken as 0");
  count(r.outside_map, "texels of triangles lie outside of the map, which clamps");
  count(r.degenerate_uv_triangles, "triangles without area in uv cover nothing");
  count(r.mixed_sign_triangles,
        "triangles with different signs w at their corners: the first one's is taken");
  count(r.condition_above_10, "texels whose frame has a condition above 10");
  if (r.first_conflict) {
    const MapConflict& c = *r.first_conflict;
    const auto owner = [&](const MapConflict::Owner& o) {
      return "triangle " + std::to_string(o.triangle) + " of mesh " +
             std::to_string(pieces[o.piece].mesh_index) + " primitive " +
             std::to_string(pieces[o.piece].primitive);
    };
    out << "refused: " << r.conflicts
        << " texels are claimed by triangles that want different codes, the first at (" << c.x << ", " << c.y
        << ") by " << owner(c.owners[0]) << " and " << owner(c.owners[1]) << '\n';
    return;
  }
  out << "rounding: at most " << rounded(r.quantisation_max_deg, 3) << " degrees, rms "
      << rounded(r.quantisation_rms_deg, 3) << '\n';
  out << a.output << '\n';
}

NormalMapOptions options_of(const NormalMapArguments& a, const Common& common) {
  const auto need = [](const std::string& value, const char* what, const char* expected) {
    if (value.empty()) throw ParameterError(what, expected_got(expected, "none"));
  };
  need(a.input, "normalmap", "an image to read");
  need(a.output, "normalmap", "-o OUT.png");
  need(a.from, "--from", "object, tangent or world");
  need(a.to, "--to", "object or tangent");
  if (a.mesh.empty() && a.surface.empty())
    throw ParameterError("normalmap", expected_got("--mesh FILE or --surface SURFACE", "neither"));
  NormalMapOptions options;
  options.from = spaces.of(a.from);
  options.to = spaces.of(a.to);
  const bool only_surface = a.mesh.empty();
  options.basis = !a.basis.empty() ? bases.of(a.basis) : only_surface ? MapBasis::analytic : MapBasis::stored;
  if (only_surface && options.basis != MapBasis::analytic)
    throw ParameterError("--basis", expected_got("analytic where there is no --mesh", a.basis));
  if (only_surface && options.from == MapSpace::world)
    throw ParameterError("--from", expected_got("object or tangent where there is no --mesh", a.from));
  if ((options.basis == MapBasis::analytic) == a.surface.empty())
    throw ParameterError("--surface", expected_got(a.surface.empty() ? "one for --basis analytic"
                                                                     : "--basis analytic beside it",
                                                   a.surface.empty() ? "none" : "--basis " + a.basis));
  options.decode = decodes.of(a.decode);
  options.green = greens.of(a.green);
  options.two_channels = a.two_channels;
  options.keep_length = a.keep_length;
  options.signed_floats = a.signed_floats;
  options.dither = a.dither;
  options.dilate = static_cast<int>(a.dilate);
  options.threads = common.threads;
  return options;
}

void run_convert(const NormalMapArguments& a, Common& common) {
  NormalMapOptions options = options_of(a, common);
  check_files(a);
  std::optional<AnySurface> surface;
  if (!a.surface.empty()) surface = surface_argument(a.surface);
  options.surface = surface ? &*surface : nullptr;
  auto lap = [last = std::chrono::steady_clock::now()]() mutable {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last, now)).count();
  };
  const std::vector<MapPiece> pieces = pieces_of(a, common);
  Image map = read_image(a.input, {.drop_colour_tags = a.drop_colour_tags});
  options.type = type_of(a, map.type());
  const int width = map.width, height = map.height;
  NormalMapSeconds seconds{.read = lap()};
  NormalMapResult result;
  {
    Progress progress("normalmap", common);
    options.progress = [&](double share) { progress.update(share); };
    result = convert_normal_map(map, pieces, options);
  }
  const std::size_t texels = map.texels();
  map = Image();
  seconds.convert = lap();
  if (!a.report.empty()) write_image(a.report, picture_of(result, width, height));
  if (result.conflicts == 0) write_image(a.output, result.image);
  seconds.write = lap();
  if (result.conflicts != 0 || result.covered == 0) common.exit_status = 1;
  if (common.json)
    print_json(report_json(a, options, result, pieces, texels, seconds));
  else if (!common.quiet)
    print_text(a, result, pieces, texels);
}

}  // namespace

void add_normalmap(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("normalmap", "Turn a normal map from one space into another");
  auto a = std::make_shared<NormalMapArguments>();
  sub.add_option("INPUT", a->input, "the .png, .tga or .exr to read");
  sub.add_option("-o,--output", a->output, "the .png, .tga or .exr to write");
  sub.add_option("--from", a->from, "the space of the map: object, tangent or world")->check(spaces.check());
  sub.add_option("--to", a->to, "the space wanted: object or tangent")
      ->check(CLI::IsMember({"object", "tangent"}));
  sub.add_option("--mesh", a->mesh, "the file with the triangles that the map lies on");
  sub.add_option("--primitive", a->primitives,
                 "MESH or MESH:PRIMITIVE of that file, by number; may be given again [all]")
      ->allow_extra_args(false);
  sub.add_option(
      "--surface", a->surface,
      std::string("the surface whose frames --basis analytic takes, without --mesh over all of the "
                  "map: ") +
          surface_help);
  sub.add_option(
         "--basis", a->basis,
         "tangents: stored in the file, mikktspace (made anew), analytic (the surface's) [stored; analytic "
         "without --mesh]")
      ->check(bases.check());
  sub.add_option(
         "--decode", a->decode,
         "the shader's frame inside a triangle: mikktspace (interpolated, left as it is) or gltf-viewer "
         "(each vector made unit)")
      ->capture_default_str()
      ->check(decodes.check());
  sub.add_option("--green", a->green, "the tangent-space map's green points up (opengl) or down (directx)")
      ->capture_default_str()
      ->check(greens.check());
  sub.add_flag("--two-channels", a->two_channels,
               "the tangent-space map has x and y alone; z is made of them");
  sub.add_flag("--keep-length", a->keep_length, "vectors keep their length; without, they become unit");
  sub.add_option("--depth", a->depth, "8, 16 or float bits per channel to write [as the input]")
      ->check(depths.check());
  sub.add_flag("--signed-floats", a->signed_floats, "EXR holds numbers from -1 to 1, not 0 to 1");
  sub.add_option("--dither", a->dither, "add noise of one code, made from this seed, before rounding")
      ->check(whole_number);
  sub.add_option("--dilate", a->dilate, "texels by which islands grow into the gutter")
      ->capture_default_str()
      ->check(whole_number_up_to(1024));
  sub.add_flag("--drop-colour-tags", a->drop_colour_tags,
               "read files that say they are sRGB or have a gamma, and pass over that");
  sub.add_option("--sign", a->sign, "sign convention of stored tangents: gltf or raw")
      ->capture_default_str()
      ->check(CLI::IsMember({"gltf", "raw"}));
  sub.add_option("--wrap", a->wrap,
                 "the texture outside [0, 1]: repeat, mirror or clamp [as the glTF says, else repeat]")
      ->check(wrap_modes.check());
  sub.add_option("--uv-origin", a->uv_origin,
                 "v = 0 is the top or the bottom of the image [top for glTF, else bottom]")
      ->check(CLI::IsMember({"top", "bottom"}));
  sub.add_option("--report", a->report, "write a picture of what is covered, conflicts in red");
  add_read_options(sub, common);
  add_common(sub, common,
             "darboux normalmap tangent.png --from tangent --to object --mesh torus.glb -o object.png");
  sub.callback([a, &common] { run_convert(*a, common); });
}

}  // namespace darboux
