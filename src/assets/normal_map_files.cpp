#include <algorithm>

#include <darboux/error.h>
#include <darboux/normal_map_files.h>

#include "assets/texture_uvs.h"
#include "base/text.h"
#include "io/files.h"
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

// The property that reads the frame through the texture to which Primitive::texcoord belongs.
std::optional<io::FrameReader> reader_of(const GltfFile& file, const JsonCursor& primitive) {
  for (const std::size_t material : io::materials_of(file, primitive))
    for (const io::FrameReader& reader : io::frame_readers(file, material))
      if (reader.has_texture) return reader;
  return std::nullopt;
}

// Its texture, if the document has it.
std::optional<JsonCursor> texture_of(const GltfFile& file, const io::FrameReader& reader) {
  if (!reader.texture) return std::nullopt;
  const JsonCursor root = file.root();
  if (!root.has("textures") || *reader.texture >= root.at("textures").size())
    root.fail("a texture " + std::to_string(*reader.texture) + ", which " + reader.pointer + " names",
              "none");
  return root.at("textures").at(*reader.texture);
}

// The wrap modes of that texture.
std::array<MapWrap, 2> wraps_of(const GltfFile& file, const io::FrameReader& reader) {
  const std::optional<JsonCursor> texture = texture_of(file, reader);
  if (!texture || !texture->has("sampler")) return {MapWrap::repeat, MapWrap::repeat};
  const JsonCursor sampler = file.element("samplers", texture->at("sampler"));
  return {wrap_of(sampler, "wrapS"), wrap_of(sampler, "wrapT")};
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
    const auto reader =
        gltf ? reader_of(document->file(),
                         document->file().root().at("meshes").at(p.mesh).at("primitives").at(p.primitive))
             : std::nullopt;
    MapPiece& piece = pieces.emplace_back(piece_of(path, std::move(p), options));
    if (reader) piece.wrap = wraps_of(document->file(), *reader);
    if (options.wrap) piece.wrap = {*options.wrap, *options.wrap};
    piece.v_up = options.v_up.value_or(!gltf);
    piece.scale = options.scale.value_or(reader ? reader->scale : 1);
  }
  if (pieces.empty())
    throw FileError(path, expected_got(options.only.empty() ? "triangles" : "the primitives that were named",
                                       asset.primitives.empty() ? "no triangles" : "others"));
  return pieces;
}

std::vector<NormalTexture> normal_textures(const std::string& path, const ReadOptions& options) {
  const GltfFile file = io::load_gltf_json(path, options);
  std::vector<NormalTexture> result;
  if (!file.root().has("meshes")) return result;
  const JsonCursor meshes = file.root().at("meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const JsonCursor primitives = meshes.at(m).at("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto reader = reader_of(file, primitives.at(p));
      if (!reader || !reader->is_normal_map) continue;
      const auto texture = texture_of(file, *reader);
      if (!texture || !texture->has("source")) continue;
      const JsonCursor image = file.element("images", texture->at("source"));
      result.push_back({m, p, texture->at("source").integer(),
                        image.has("uri") ? io::file_of_uri(path, image.at("uri").text()) : ""});
    }
  }
  return result;
}

std::string gltf_image_bytes(const std::string& path, std::size_t image, const ReadOptions& options) {
  const GltfFile file = io::load_gltf_json(path, options);
  const JsonCursor images = file.root().at("images");
  io::ReadBuffers buffers;
  return io::image_bytes(file, images.at(image), buffers);
}

}  // namespace darboux
