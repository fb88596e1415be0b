/// \file normal_map_files.h
/// The triangles of a file as a normal map sees them.
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
  /// MapPiece::to_world is needed: it must be the same for all nodes that show a mesh.
  bool world = false;
};

/// The primitives of a file that read_asset() reads. Of a glTF with the uv set, KHR_texture_transform and
/// sampler of the first texture that reads the tangent frame, the normal texture first: v runs down, and
/// repeats unless the sampler says otherwise. A transform that maps the uvs onto a line or a point is not
/// applied. Of other formats v runs up, and repeats. normalTexture.scale is not applied.
/// \throws FileError as read_asset(), where a number of `only` is not there, where `world` is wanted and
/// nodes differ, and for a file without triangles
std::vector<MapPiece> normal_map_pieces(const std::string& path, const MapPieceOptions& options = {});

}  // namespace darboux
