/// \file map_arguments.h
/// What `normalmap` and `bake` share: the mesh that a map lies on, the frames, and files of images.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <darboux/image_files.h>
#include <darboux/normal_map.h>
#include <darboux/normal_map_files.h>

#include "command.h"

namespace darboux {

struct MapArguments {
  std::string output, mesh, basis, decode = "mikktspace", green = "opengl", depth, sign = "gltf", wrap,
                                   uv_origin;
  std::vector<std::string> primitives;
  std::optional<std::uint64_t> dither;
  std::uint64_t dilate = 0;
};

inline constexpr Choice<MapBasis, 3> map_bases{{"stored", "mikktspace", "analytic"}};
inline constexpr Choice<MapDecode, 2> map_decodes{{"mikktspace", "gltf-viewer"}};
inline constexpr Choice<MapGreen, 2> map_greens{{"opengl", "directx"}};
inline constexpr Choice<SampleType, 3> map_depths{{"8", "16", "float"}};

/// All options but --basis, which the two have in other words.
void add_map_options(CLI::App& sub, MapArguments& arguments);

/// The triangles of --mesh. \throws ParameterError, FileError
std::vector<MapPiece> map_pieces(const MapArguments& arguments, const Common& common, bool world);

/// Names of files to be written, images, each another, and none of those that are read.
/// \throws ParameterError
void check_map_files(const std::vector<std::string>& read, const std::string& output,
                     const std::string& report = "");

/// What --depth says, else what the file can hold that is nearest to `wish`. \throws ParameterError
SampleType map_type(const MapArguments& arguments, SampleType wish);

/// The counts of a conversion: for JSON, and a line for each that is not zero.
void add_counts(Json& json, const NormalMapResult& result);
void print_counts(const NormalMapResult& result);

/// "triangle 7 of mesh 0 primitive 0"
std::string owner_text(const MapConflict::Owner& owner, std::span<const MapPiece> pieces);
/// The first conflict; null where there is none.
Json conflict_json(const NormalMapResult& result, std::span<const MapPiece> pieces);
void print_conflict(const NormalMapResult& result, std::span<const MapPiece> pieces);

}  // namespace darboux
