#include "map_arguments.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>

namespace darboux {
namespace {

constexpr Choice<MapWrap, 3> wrap_modes{{"repeat", "mirror", "clamp"}};

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

ChosenPrimitives primitive_arguments(const std::vector<std::string>& texts) {
  ChosenPrimitives result;
  for (const std::string& text : texts) result.push_back(primitive_argument(text));
  return result;
}

struct Count {
  const char* key;
  std::size_t NormalMapResult::*count;
  const char* text;  // for people; null if printed elsewhere
};
constexpr Count texel_counts[] = {
    {"covered", &NormalMapResult::covered, nullptr},
    {"dilated", &NormalMapResult::dilated, nullptr},
    {"conflicts", &NormalMapResult::conflicts, nullptr},
    {"below_surface", &NormalMapResult::below_surface,
     "texels with z <= 0 in tangent space, which glTF discourages"},
    {"not_finite", &NormalMapResult::not_finite,
     "covered texels that are no direction (NaN, infinite or zero), left to --dilate, else empty"},
    {"no_frame", &NormalMapResult::no_frame, "covered texels without a frame, left to --dilate, else empty"},
    {"too_long", &NormalMapResult::too_long, "texels with x² + y² > 1, whose z is taken as 0"},
    {"outside_map", &NormalMapResult::outside_map,
     "texels of triangles lie outside the map, where it clamps"},
    {"degenerate_uv_triangles", &NormalMapResult::degenerate_uv_triangles,
     "triangles without area in uv cover nothing"},
    {"mixed_sign_triangles", &NormalMapResult::mixed_sign_triangles,
     "triangles with different signs w at their corners: --decode mikktspace takes the first one's"},
    {"condition_above_10", &NormalMapResult::condition_above_10,
     "texels whose frame has a condition above 10"}};

Json owner_json(const MapConflict::Owner& owner, std::span<const MapPiece> pieces) {
  return {{"mesh", pieces[owner.piece].mesh_index},
          {"primitive", pieces[owner.piece].primitive},
          {"triangle", owner.triangle},
          {"codes", {number(owner.codes[0]), number(owner.codes[1]), number(owner.codes[2])}}};
}

}  // namespace

void add_map_options(CLI::App& sub, MapArguments& a) {
  sub.add_option("-o,--output", a.output, "the .png, .tga or .exr to write");
  sub.add_option("--mesh", a.mesh, "the file with the triangles that the map belongs to");
  sub.add_option("--primitive", a.primitives,
                 "MESH or MESH:PRIMITIVE of that file, by number; may be given several times [all]")
      ->allow_extra_args(false);
  sub.add_option("--decode", a.decode,
                 "frame that the shader uses inside a triangle: mikktspace (interpolated, not normalised) or "
                 "gltf-viewer (each vector normalised)")
      ->capture_default_str()
      ->check(map_decodes.check());
  sub.add_option("--green", a.green, "green of the tangent-space map points up (opengl) or down (directx)")
      ->capture_default_str()
      ->check(map_greens.check());
  sub.add_flag("--signed-floats", a.signed_floats, "an EXR holds numbers from -1 to 1 instead of 0 to 1");
  sub.add_option("--dither", a.dither, "add noise of one code before rounding, from this seed")
      ->check(whole_number);
  sub.add_option("--dilate", a.dilate, "grow the islands into the gutter by this many texels")
      ->capture_default_str()
      ->check(whole_number_up_to(1024));
  sub.add_option("--sign", a.sign, "sign convention of stored tangents: gltf or raw")
      ->capture_default_str()
      ->check(sign_conventions.check());
  sub.add_option(
         "--wrap", a.wrap,
         "how the texture continues outside [0, 1]: repeat, mirror or clamp [as the glTF says, else repeat]")
      ->check(wrap_modes.check());
  sub.add_option("--uv-origin", a.uv_origin,
                 "whether v = 0 is the top or the bottom of the image [top for glTF, else bottom]")
      ->check(CLI::IsMember({"top", "bottom"}));
  sub.add_option("--normal-scale", a.normal_scale,
                 "factor for x and y of the tangent-space map [normalTexture.scale of the glTF, else 1]")
      ->check(finite_number("a number other than 0", [](double x) { return x != 0; }));
}

MapSource map_source(const std::string& path, const std::vector<std::string>* primitives,
                     const Common& common) {
  if (primitives == nullptr) return map_source(path, std::nullopt, common.read);
  return map_source(path, primitive_arguments(*primitives), common.read);
}

std::vector<MapPiece> map_pieces(const MapArguments& a, const Common& common, bool world,
                                 const ChosenPrimitives& only) {
  MapPieceOptions options{.read = common.read};
  options.only = only.empty() ? primitive_arguments(a.primitives) : only;
  options.sign = sign_conventions.of(a.sign);
  if (!a.wrap.empty()) options.wrap = wrap_modes.of(a.wrap);
  if (!a.uv_origin.empty()) options.v_up = a.uv_origin == "bottom";
  options.scale = a.normal_scale;
  options.world = world;
  return normal_map_pieces(a.mesh, options);
}

Image read_map(const MapSource& source, bool drop_colour_tags, bool signed_floats, const Common& common) {
  Image map = read_image(source.name, source.bytes,
                         {.drop_colour_tags = drop_colour_tags, .max_memory = common.read.max_memory});
  if (map.type() != SampleType::f32 || signed_floats) return map;
  // 8-bit codes of a unit vector are off by at most 1/255 each, so its numbers are at least -1 - √3/255.
  constexpr float least = -0.0034f;
  const auto& samples = std::get<2>(map.samples);
  float lowest = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (map.channels != 4 || i % 4 != 3) lowest = std::fmin(lowest, samples[i]);
  if (lowest < least)
    throw FileError(source.name, expected_got("numbers from 0 to 1, or --signed-floats", rounded(lowest, 2)));
  return map;
}

double rms_relative(const PlacedSurface& surface, std::span<const MapPiece> pieces) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Eigen::Vector3d least = Eigen::Vector3d::Constant(infinity), greatest = -least;
  double sum = 0, count = 0;
  for (const MapPiece& piece : pieces)
    for (const Triangle& triangle : piece.mesh.triangles)
      for (const std::uint32_t v : triangle) {
        const Eigen::Vector3d p = to_eigen(piece.mesh.positions[v]);
        least = least.cwiseMin(p);
        greatest = greatest.cwiseMax(p);
        const double squared = (to_eigen(surface.position(piece.mesh.uvs[v])) - p).squaredNorm();
        if (!std::isfinite(squared)) continue;
        sum += squared;
        ++count;
      }
  return count == 0 ? infinity : std::sqrt(sum / count) / (greatest - least).norm();
}

void check_files_apart(const std::vector<MapFile>& read, const std::vector<MapFile>& written) {
  std::map<std::string, const char*> place_of;
  const auto add = [&](const MapFile& of, bool is_read) {
    if (of.second.empty()) return;
    std::error_code none;
    const auto [at, added] = place_of.emplace(
        std::filesystem::weakly_canonical(std::filesystem::absolute(of.second), none).string(), of.first);
    if (!added && !is_read)
      throw ParameterError(of.first,
                           expected_got(std::string("another file than that of ") + at->second, of.second));
  };
  for (const MapFile& of : read) add(of, true);
  for (const MapFile& of : written) add(of, false);
}

void check_map_files(const std::vector<MapFile>& read, const std::string& output, const std::string& report) {
  check_files_apart(read, {{"-o", output}, {"--report", report}});
  if (!output.empty()) image_types(output);
  if (!report.empty() && image_types(report).front() != SampleType::u8)
    throw ParameterError(report, expected_got("a name that ends in .png or .tga", "another"));
}

MapOutputs::MapOutputs(const std::string& output, const std::string& report)
    : output_(output), report_(report), output_file_(output) {
  if (!report.empty()) report_file_.emplace(report);
}

void MapOutputs::write(const NormalMapResult& result, int width, int height) {
  if (!none(result)) write_image(output_file_, output_, result.image);
  if (report_file_) write_image(*report_file_, report_, picture_of(result, width, height));
}

SampleType map_type(const MapArguments& a, SampleType wish) {
  const auto types = image_types(a.output);
  const auto has = [&](SampleType t) { return std::find(types.begin(), types.end(), t) != types.end(); };
  if (a.depth.empty()) return has(wish) ? wish : types.back();
  const SampleType wanted = map_depths.of(a.depth);
  if (!has(wanted))
    throw ParameterError("--depth", expected_got(std::string("one that ") +
                                                     (types.back() == SampleType::f32  ? "EXR has: float"
                                                      : types.back() == SampleType::u8 ? "TGA has: 8"
                                                                                       : "PNG has: 8 or 16"),
                                                 a.depth));
  return wanted;
}

void add_counts(Json& json, const NormalMapResult& r) {
  for (const Count& c : texel_counts) json[c.key] = r.*c.count;
  json["condition"] = r.condition == 0 ? Json() : number(r.condition);
  json["quantisation_deg"] = {{"max", number(r.quantisation_max_deg)},
                              {"rms", number(r.quantisation_rms_deg)}};
}

void print_counts(const NormalMapResult& r) {
  for (const Count& c : texel_counts)
    if (c.text != nullptr && r.*c.count != 0) std::cout << r.*c.count << ' ' << c.text << '\n';
}

std::string owner_text(const MapConflict::Owner& owner, std::span<const MapPiece> pieces) {
  const MapPiece& piece = pieces[owner.piece];
  return "triangle " + std::to_string(owner.triangle) + " of " +
         primitive_text(piece.mesh_index, piece.primitive);
}

Json conflict_json(const NormalMapResult& r, std::span<const MapPiece> pieces) {
  if (!r.first_conflict) return nullptr;
  const MapConflict& c = *r.first_conflict;
  return {{"texel", {c.x, c.y}},
          {"triangles", {owner_json(c.owners[0], pieces), owner_json(c.owners[1], pieces)}}};
}

void print_conflict(const NormalMapResult& r, std::span<const MapPiece> pieces) {
  const MapConflict& c = *r.first_conflict;
  std::cout << "refused: " << r.conflicts
            << " texels for which triangles give different codes, the first at (" << c.x << ", " << c.y
            << "):\n  " << owner_text(c.owners[0], pieces) << " and " << owner_text(c.owners[1], pieces)
            << '\n';
}

}  // namespace darboux
