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
  std::string path;  ///< used in messages; relative URIs refer to its folder
  ReadOptions options;
  std::uint64_t json_bytes = 0;
  /// Stored size of the document and its buffers, before decoding; 0: not from a file.
  std::uint64_t stored_bytes = 0;
  io::Json json;
  /// One per entry of "buffers". Buffer 0 becomes the binary chunk, including padding. A buffer with neither
  /// a uri nor the chunk is empty.
  std::vector<std::optional<io::BufferBytes>> buffers;
  /// Half the quantisation step of accessors whose floats were decoded from coarser numbers.
  std::map<std::size_t, double> half_steps;
  std::string other_chunks;  ///< chunks of the GLB that glTF 2.0 does not define, headers included

  io::JsonCursor root() const { return {path, json, "the document"}; }

  /// Size of the document as it was read plus the buffers in memory.
  std::uint64_t bytes() const;

  /// The entry with this index in a top-level array.
  io::JsonCursor element(const char* array, const io::JsonCursor& index) const;

  /// The bytes given by buffer, byteOffset and byteLength of a bufferView, or of an object with the same
  /// keys. Valid as long as the buffer. \throws FileError
  std::string_view view_bytes(const io::JsonCursor& view) const;
  /// The same, given the bytes of its buffer.
  std::string_view view_bytes(const io::JsonCursor& view, const std::optional<io::BufferBytes>& bytes) const;

  /// Appends bytes to buffer 0, at a multiple of 4; returns their offset.
  std::size_t append_bytes(io::Piece bytes);

  /// Appends bytes as append_bytes() does, and a bufferView on them; returns the bufferView's index.
  /// \param stride bytes from one element to the next, 0 when they are tightly packed
  /// \param target 34962 for vertex attributes, 34963 for indices
  std::size_t append_view(io::Piece bytes, std::size_t stride, int target);

  /// Appends an accessor; returns its index.
  std::size_t append_accessor(io::Json accessor);

  /// Appends a vertex attribute: an accessor like `json`, but for these elements, aligned to 4 bytes; returns
  /// its index. \param need_bounds whether to add min and max if its components have finite values; otherwise
  /// they are added only if `json` has them
  std::size_t append_attribute(io::Json json, io::Accessor elements, bool need_bounds);

  /// Appends an index list, 16-bit where the largest index allows it; returns the accessor's index.
  std::size_t append_indices(std::span<const std::uint32_t> indices);

  /// GltfDocument::set_tangents() for floats given as bytes.
  void set_tangents(std::size_t mesh, std::size_t primitive, io::Piece tangents,
                    const std::vector<io::Piece>& deltas);

  /// The file as a GLB with all referenced files embedded, as a list of pieces that are valid as long as this
  /// object. \param kept receives a line for each image that keeps its URI
  std::vector<io::Piece> glb_pieces(std::vector<std::string>* kept = nullptr) const;
  /// The same as one string.
  std::string to_glb(std::vector<std::string>* kept = nullptr) const;
};

namespace io {

/// glTF's codes for component types.
enum ComponentType : std::uint64_t {
  component_i8 = 5120,
  component_u8 = 5121,
  component_i16 = 5122,
  component_u16 = 5123,
  component_u32 = 5125,
  component_f32 = 5126
};
/// glTF's codes for the primitive modes with triangles.
enum Mode : std::uint64_t { triangles = 4, triangle_strip = 5, triangle_fan = 6 };
/// Types of a GLB's chunks: "JSON" and "BIN".
constexpr std::uint32_t json_chunk = 0x4E4F534A, bin_chunk = 0x004E4942;

/// glTF's codes for the target of a bufferView.
constexpr int vertex_target = 34962, index_target = 34963;

/// Reads the container, parses the document, loads its buffers, and decodes EXT_meshopt_compression and
/// KHR_draco_mesh_compression. The resulting document does not use these extensions. \throws FileError
GltfFile load_gltf(const std::string& path, Piece bytes, const ReadOptions& options = {});

/// Loads only the JSON document. Buffers, images and compressed data are not read and may be absent. Reads as
/// many bytes as the JSON has. \throws FileError
GltfFile load_gltf_json(const std::string& path, const ReadOptions& options = {});

/// Buffers that are read on demand, for a document that was loaded without them.
using ReadBuffers = std::map<std::size_t, std::optional<BufferBytes>>;

/// The bytes of an entry of "images": from its uri, or from its bufferView, whose buffer is read if it is not
/// in memory. \param read cache of buffers read in this way \throws FileError if they are not available
std::string image_bytes(const GltfFile& file, const JsonCursor& image, ReadBuffers& read);

/// Decodes the bufferViews with EXT_meshopt_compression, appends them to buffer 0, and removes the extension
/// and its fallback buffers from the document. Allocation is limited to 64 times the size of the buffers, the
/// maximum expansion of a stream, and by the budget. \throws FileError
void decompress_meshopt(GltfFile& file);

/// Decodes the primitives with KHR_draco_mesh_compression into new accessors, appended to buffer 0, and
/// removes the extension from the document. Such a primitive becomes a triangle list. Decoded data count
/// against the budget of the file, a triangle as 64 bytes. \throws FileError
void decompress_draco(GltfFile& file);

/// Removes an extension from one object of the document.
void remove_extension(Json& owner, const char* name);

/// Removes an extension from extensionsUsed and extensionsRequired.
void retire_extension(GltfFile& file, const char* name);

/// Parses extras given by a caller. \throws ParameterError with this subject unless it is a JSON object
Json parse_extras(const char* subject, const std::string& text);

/// A node of the scene that is used: the default scene, else the first, else all trees of nodes.
struct ShownNode {
  std::size_t node;
  Eigen::Matrix4d world;  ///< from its space to that of the scene, at rest
  bool moves = false;     ///< an animation moves it or an ancestor
  /// Index of the parent in this list, which comes before it; for a root, its own index.
  std::size_t parent;
};
/// The nodes of the scene, depth first. \throws FileError if a node is its own ancestor or has two parents
std::vector<ShownNode> shown_nodes(const GltfFile& file);

struct FloatMesh;

/// Reads all triangles of the document. \param floats receives one entry per primitive: its triangles if
/// read_float_mesh() supports it, in which case `data` is empty \throws FileError
Asset read_gltf(const GltfFile& file, std::vector<std::optional<FloatMesh>>* floats = nullptr);

/// The displacements of positions, normals and one TEXCOORD set by the morph targets of a primitive. \throws
/// FileError
std::vector<MorphTarget> read_targets(const GltfFile& file, const JsonCursor& primitive, int texcoord,
                                      std::size_t vertices);

}  // namespace io
}  // namespace darboux
