/// \file map_arguments.h
/// Common code of `normalmap` and `bake`: the mesh that a map covers, the frames, and image files.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <darboux/fit_mesh.h>
#include <darboux/image_files.h>
#include <darboux/io.h>
#include <darboux/normal_map.h>
#include <darboux/normal_map_files.h>
#include <darboux/placed_surface.h>

#include "assets/map_source.h"
#include "command.h"

namespace darboux {

struct MapArguments {
  std::string output, mesh, basis, decode = "mikktspace", green = "opengl", depth, sign = "gltf", wrap,
                                   uv_origin;
  std::vector<std::string> primitives;
  bool signed_floats = false;
  std::optional<double> normal_scale;
  std::optional<std::uint64_t> dither;
  std::uint64_t dilate = 0;
};

inline constexpr Choice<MapBasis, 3> map_bases{{"stored", "mikktspace", "analytic"}};
inline constexpr Choice<MapDecode, 2> map_decodes{{"mikktspace", "gltf-viewer"}};
inline constexpr Choice<MapGreen, 2> map_greens{{"opengl", "directx"}};
inline constexpr Choice<SampleType, 3> map_depths{{"8", "16", "float"}};

/// Adds the common options; --basis differs between the two commands.
void add_map_options(CLI::App& sub, MapArguments& arguments);

/// \param primitives as --primitive; null if that option selects nothing of this file \throws as
/// map_source(); ParameterError for an invalid primitive
MapSource map_source(const std::string& path, const std::vector<std::string>* primitives,
                     const Common& common);

/// The triangles of --mesh: those of `only`, or without it those of --primitive.
/// \throws ParameterError, FileError
std::vector<MapPiece> map_pieces(const MapArguments& arguments, const Common& common, bool world,
                                 const ChosenPrimitives& only = {});

/// Reads a map with read_image(). \throws FileError also, without --signed-floats, for floats that are
/// evidently signed: further below 0 than rounding of unit vectors to 8-bit codes can cause
Image read_map(const MapSource& source, bool drop_colour_tags, bool signed_floats, const Common& common);

/// The rms distance of the triangle corners from the surface at their uvs, relative to the diagonal of their
/// bounding box. Corners at which the surface has no value are excluded; infinity if that applies to all.
double rms_relative(const PlacedSurface& surface, std::span<const MapPiece> pieces);

/// The limit of that distance for a mesh of the surface: twice that of a fit, as corners are counted here and
/// vertices there.
inline constexpr double corners_fit_below = 2 * fits_below;

/// Returns f(). \throws FileError instead of a MeshError of f, with the file name before its message
template <class F>
auto naming_the_mesh(const std::string& file, const F& f) {
  try {
    return f();
  } catch (const MeshError& e) {
    throw FileError(file, e.what());
  }
}

/// The option (or other description) that names a file, and the file name.
using MapFile = std::pair<const char*, std::string>;

/// Checks that output files differ from each other and from all input files. Input files may coincide.
/// \throws ParameterError
void check_files_apart(const std::vector<MapFile>& read, const std::vector<MapFile>& written);

/// The same for -o and --report, which must also have names of image files.
void check_map_files(const std::vector<MapFile>& read, const std::string& output,
                     const std::string& report = "");

/// -o and --report of a conversion: opened before the work, written after it.
class MapOutputs {
 public:
  /// \throws FileError
  explicit MapOutputs(const std::string& output, const std::string& report = "");
  /// The map unless there is none(), then the picture of its states, `width` by `height`. \throws FileError
  void write(const NormalMapResult& result, int width, int height);
  /// Whether there is no map, because of conflicts or because the mesh covers nothing.
  static bool none(const NormalMapResult& result) { return result.conflicts != 0 || result.covered == 0; }

 private:
  std::string output_, report_;
  OutputFile output_file_;
  std::optional<OutputFile> report_file_;
};

/// The sample type of --depth, else the type nearest to `wish` that the file format supports. \throws
/// ParameterError
SampleType map_type(const MapArguments& arguments, SampleType wish);

/// Adds the counts of a conversion to the JSON, and prints a line for each that is not zero.
void add_counts(Json& json, const NormalMapResult& result);
void print_counts(const NormalMapResult& result);

/// "triangle 7 of mesh 0 primitive 0"
std::string owner_text(const MapConflict::Owner& owner, std::span<const MapPiece> pieces);
/// The first conflict; null where there is none.
Json conflict_json(const NormalMapResult& result, std::span<const MapPiece> pieces);
void print_conflict(const NormalMapResult& result, std::span<const MapPiece> pieces);

}  // namespace darboux
