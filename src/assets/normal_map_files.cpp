#include <algorithm>

#include <darboux/error.h>
#include <darboux/normal_map_files.h>

#include "assets/texture_uvs.h"
#include "base/text.h"
#include "io/gltf_file.h"
#include "io/tangent_space.h"

namespace darboux {
namespace {

using io::JsonCursor;

MapWrap wrap_of(const JsonCursor& sampler, const char* key) {
  enum : std::uint64_t { clamp = 33071, mirror = 33648 };
  if (!sampler.has(key)) return MapWrap::repeat;
  const std::uint64_t mode = sampler.at(key).integer();
  return mode == clamp ? MapWrap::clamp : mode == mirror ? MapWrap::mirror : MapWrap::repeat;
}

// How the texture that Primitive::texcoord belongs to goes on outside [0, 1].
std::array<MapWrap, 2> wraps_of(const GltfFile& file, const Primitive& p) {
  std::array<MapWrap, 2> result{MapWrap::repeat, MapWrap::repeat};
  const JsonCursor primitive = file.root().at("meshes").at(p.mesh).at("primitives").at(p.primitive);
  for (const std::size_t material : io::materials_of(file, primitive))
    for (const io::FrameReader& reader : io::frame_readers(file, material)) {
      if (!reader.has_texture) continue;
      if (!reader.texture) return result;
      const JsonCursor texture = file.root().at("textures").at(*reader.texture);
      if (!texture.has("sampler")) return result;
      const JsonCursor sampler = file.element("samplers", texture.at("sampler"));
      return {wrap_of(sampler, "wrapS"), wrap_of(sampler, "wrapT")};
    }
  return result;
}

bool chosen(const Primitive& p, const MapPieceOptions& options) {
  return options.only.empty() || std::any_of(options.only.begin(), options.only.end(), [&](const auto& only) {
           return only.first == p.mesh && (!only.second || *only.second == p.primitive);
         });
}

Eigen::Matrix3d world_of(const std::string& path, const Primitive& p) {
  if (p.instances.empty())
    throw FileError(path,
                    "mesh " + std::to_string(p.mesh) + ": " + expected_got("a node that shows it", "none"));
  const Eigen::Matrix3d first = p.instances[0].topLeftCorner<3, 3>();
  for (const Eigen::Matrix4d& other : p.instances)
    if (other.topLeftCorner<3, 3>() != first)
      throw FileError(path, "mesh " + std::to_string(p.mesh) + ": " +
                                expected_got("one way to turn it into the world",
                                             std::to_string(p.instances.size()) + " nodes that differ"));
  return first;
}

MapPiece piece_of(const std::string& path, Primitive&& p, const MapPieceOptions& options) {
  MapPiece piece{.mesh = std::move(p.data), .mesh_index = p.mesh, .primitive = p.primitive};
  transform_uvs(piece.mesh, p);
  if (options.sign == SignConvention::raw)
    for (Vec4<double>& t : piece.mesh.tangents) t.w = -t.w;
  if (options.world) piece.to_world = world_of(path, p);
  return piece;
}

}  // namespace

std::vector<MapPiece> normal_map_pieces(const std::string& path, const MapPieceOptions& options) {
  const bool gltf = io::is_gltf(path);
  std::optional<GltfDocument> document;
  if (gltf) document = GltfDocument::load(path, options.read);
  Asset asset = gltf ? document->asset() : read_asset(path, options.read);
  std::vector<MapPiece> pieces;
  for (Primitive& p : asset.primitives) {
    if (!chosen(p, options)) continue;
    const auto wrap = gltf ? wraps_of(document->file(), p) : std::array{MapWrap::repeat, MapWrap::repeat};
    pieces.push_back(piece_of(path, std::move(p), options));
    pieces.back().wrap = options.wrap ? std::array{*options.wrap, *options.wrap} : wrap;
    pieces.back().v_up = options.v_up.value_or(!gltf);
  }
  if (pieces.empty())
    throw FileError(path, expected_got(options.only.empty() ? "triangles" : "the primitives that were named",
                                       asset.primitives.empty() ? "no triangles" : "others"));
  return pieces;
}

}  // namespace darboux
