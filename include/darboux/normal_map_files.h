/// \file normal_map_files.h
/// The triangles of a file as a normal map sees them. Target darboux::io.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <darboux/frame.h>
#include <darboux/io.h>
#include <darboux/normal_map.h>

namespace darboux {

struct MapPieceOptions {
  ReadOptions read{};
  /// Meshes of the file, or single primitives of them, by their numbers; all where there are none.
  std::vector<std::pair<std::size_t, std::optional<std::size_t>>> only{};
  SignConvention sign = SignConvention::gltf;  ///< of stored tangents
  std::optional<MapWrap> wrap{};               ///< instead of what the file says
  std::optional<bool> v_up{};                  ///< instead of what the format has
  std::optional<double> scale{};               ///< instead of normalTexture.scale; 1 ignores it
  /// MapPiece::to_world is needed: it must be the same for all nodes that show a mesh.
  bool world = false;
};

/// The primitives of a file that read_asset() reads. For glTF they have the uv set, KHR_texture_transform,
/// sampler and scale of the first texture that reads the tangent frame, the normal texture first; v runs
/// down, and the map repeats unless the sampler says otherwise. A transform that maps the uvs onto a line or
/// a point is not applied. For other formats v runs up, and the map repeats.
/// \throws FileError as read_asset(), where a number of `only` is not there, where `world` is wanted and
/// nodes differ, and for a file without triangles
std::vector<MapPiece> normal_map_pieces(const std::string& path, const MapPieceOptions& options = {});

/// The image that a primitive of a glTF has its normal map in.
struct NormalTexture {
  std::size_t mesh = 0, primitive = 0;
  std::size_t image = 0;  ///< in "images"
  std::string file{};     ///< that the image names; empty where it is in the glTF or in a buffer
};

/// The primitives of a glTF whose normal texture has an image. Reads the JSON document only.
/// \throws FileError
std::vector<NormalTexture> normal_textures(const std::string& path, const ReadOptions& options = {});

/// The bytes of an image of a glTF: of the file or data URI that it names, or of its bufferView.
/// \throws FileError
std::string gltf_image_bytes(const std::string& path, std::size_t image, const ReadOptions& options = {});

}  // namespace darboux
