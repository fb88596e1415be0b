/// \file gltf_file.h
/// A glTF file in memory: the JSON document and the bytes of its buffers.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/io.h>

#include "buffer_bytes.h"
#include "json_cursor.h"

namespace darboux {

namespace io {
struct Accessor;
}

struct GltfFile {
  std::string path;  ///< named in messages, and relative URIs start from its folder
  ReadOptions options;
  std::uint64_t json_bytes = 0;
  /// Of the document and its buffers as they are stored, before anything is decoded; 0: not from a file.
  std::uint64_t stored_bytes = 0;
  io::Json json;
  /// One for each entry of "buffers". Buffer 0 is what becomes the binary chunk, padding included. One that
  /// has neither a uri nor the chunk has no bytes.
  std::vector<std::optional<io::BufferBytes>> buffers;
  /// Of accessors whose floats were decoded from coarser numbers: half their step.
  std::map<std::size_t, double> half_steps;
  std::string other_chunks;  ///< chunks of the GLB that glTF 2.0 does not define, headers included

  io::JsonCursor root() const { return {path, json, "the document"}; }

  /// Of the document as it was read, and of the buffers that are in memory.
  std::uint64_t bytes() const;

  /// The entry of a top-level array that `index` names.
  io::JsonCursor element(const char* array, const io::JsonCursor& index) const;

  /// The bytes that the buffer, byteOffset and byteLength of a bufferView, or of what is written like one,
  /// name. They hold as long as the buffer. \throws FileError
  std::string_view view_bytes(const io::JsonCursor& view) const;
  /// The same where the bytes of its buffer are at hand.
  std::string_view view_bytes(const io::JsonCursor& view, const std::optional<io::BufferBytes>& bytes) const;

  /// Appends bytes to buffer 0, at a multiple of 4; returns where they begin.
  std::size_t append_bytes(io::Piece bytes);

  /// Appends bytes as append_bytes() does, and a bufferView on them; returns the bufferView's index.
  /// \param stride bytes from one element to the next, 0 when they are tightly packed
  /// \param target 34962 for vertex attributes, 34963 for indices
  std::size_t append_view(io::Piece bytes, std::size_t stride, int target);

  /// Appends an accessor; returns its index.
  std::size_t append_accessor(io::Json accessor);

  /// Appends a vertex attribute: an accessor like `json` but over these elements, at multiples of 4 bytes;
  /// returns its index. \param need_bounds it gets min and max, where its components have finite values;
  /// without, it gets them where `json` has them
  std::size_t append_attribute(io::Json json, io::Accessor elements, bool need_bounds);

  /// Appends an index list, 16-bit where the largest index allows it; returns the accessor's index.
  std::size_t append_indices(std::span<const std::uint32_t> indices);

  /// GltfDocument::set_tangents() of floats as bytes.
  void set_tangents(std::size_t mesh, std::size_t primitive, io::Piece tangents,
                    const std::vector<io::Piece>& deltas);

  /// The file as a GLB, with everything it names embedded: its bytes in pieces, which hold as long as this.
  /// \param kept gets a line for each image that keeps its URI
  std::vector<io::Piece> glb_pieces(std::vector<std::string>* kept = nullptr) const;
  /// The same in one.
  std::string to_glb(std::vector<std::string>* kept = nullptr) const;
};

namespace io {

/// glTF's numbers for the types of components.
enum ComponentType : std::uint64_t {
  component_i8 = 5120,
  component_u8 = 5121,
  component_i16 = 5122,
  component_u16 = 5123,
  component_u32 = 5125,
  component_f32 = 5126
};
/// Its numbers for the modes of primitives that have triangles.
enum Mode : std::uint64_t { triangles = 4, triangle_strip = 5, triangle_fan = 6 };
/// Types of a GLB's chunks: "JSON" and "BIN".
constexpr std::uint32_t json_chunk = 0x4E4F534A, bin_chunk = 0x004E4942;

/// glTF's numbers for the uses of a bufferView.
constexpr int vertex_target = 34962, index_target = 34963;

/// Reads the container, parses the document, loads its buffers, and undoes EXT_meshopt_compression and
/// KHR_draco_mesh_compression: what is left is a document without them. \throws FileError
GltfFile load_gltf(const std::string& path, Piece bytes, const ReadOptions& options = {});

/// The document alone: nothing of its buffers, images and compressed data is read, and none need be there.
/// Reads as many bytes as the JSON has. \throws FileError
GltfFile load_gltf_json(const std::string& path, const ReadOptions& options = {});

/// Buffers that are read one by one, of a document that was loaded without them.
using ReadBuffers = std::map<std::size_t, std::optional<BufferBytes>>;

/// The bytes of an entry of "images": of its uri, or of its bufferView, for which the buffer is read where it
/// is not in memory. \param read buffers that were read so \throws FileError where they are not there
std::string image_bytes(const GltfFile& file, const JsonCursor& image, ReadBuffers& read);

/// Decodes the bufferViews that EXT_meshopt_compression compresses, appends them to buffer 0 and takes the
/// extension off the document, with the buffers that only stood for decoded data. Nothing is allocated beyond
/// 64 times the bytes of the buffers, a stream holds no more, nor beyond the budget. \throws FileError
void decompress_meshopt(GltfFile& file);

/// Decodes the primitives that KHR_draco_mesh_compression compresses into new accessors, appended to buffer
/// 0, and takes the extension off the document. Such a primitive is a list of triangles afterwards. Decoded
/// data count against the budget of the file, a triangle as 64 bytes. \throws FileError
void decompress_draco(GltfFile& file);

/// Takes an extension off one object of the document.
void remove_extension(Json& owner, const char* name);

/// Takes an extension off extensionsUsed and extensionsRequired.
void retire_extension(GltfFile& file, const char* name);

/// What a caller wants among a document's extras. \throws ParameterError with this subject unless it is a
/// JSON object
Json parse_extras(const char* subject, const std::string& text);

/// A node of the scene that is shown: the default scene, else the first, else all trees of nodes.
struct ShownNode {
  std::size_t node;
  Eigen::Matrix4d world;  ///< its space to the scene's, at rest
  bool moves = false;     ///< an animation moves it or what it hangs on
  std::size_t parent;     ///< which of those shown, before it; a root itself
};
/// Depth first. \throws FileError where a node is its own ancestor or has two parents
std::vector<ShownNode> shown_nodes(const GltfFile& file);

struct FloatMesh;

/// All triangles of the document. \param floats gets an entry for each primitive: its triangles where
/// read_float_mesh() has them, and then `data` stays empty \throws FileError
Asset read_gltf(const GltfFile& file, std::vector<std::optional<FloatMesh>>* floats = nullptr);

/// What the morph targets of a primitive add to positions, normals and one TEXCOORD set. \throws FileError
std::vector<MorphTarget> read_targets(const GltfFile& file, const JsonCursor& primitive, int texcoord,
                                      std::size_t vertices);

}  // namespace io
}  // namespace darboux
