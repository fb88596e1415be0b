/// \file io.h
/// Files: glTF and GLB over the JSON document itself, OBJ through assimp. Every float keeps its bits.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <darboux/mesh.h>

namespace darboux {

/// One drawable piece of a file: a primitive of a glTF mesh, a mesh of an OBJ.
struct Primitive {
  std::size_t mesh = 0;       ///< index of the mesh in the file
  std::size_t primitive = 0;  ///< index within the mesh
  std::string name;           ///< the mesh's name, may be empty
  int texcoord = 0;           ///< which TEXCOORD set `data.uvs` holds; -1 when there is none
  Mesh data;
  /// World matrices of the nodes that show it, one an instance; empty when no node does.
  std::vector<Eigen::Matrix4d> instances;
};

/// A piece of a file that holds no triangles and was passed over.
struct SkippedPrimitive {
  std::size_t mesh = 0, primitive = 0;
  std::string reason;  ///< e.g. "mode 1 (lines) has no triangles"
};

/// What a file holds.
struct Asset {
  std::vector<Primitive> primitives;
  std::vector<SkippedPrimitive> skipped;
};

/// Reads .glb, .gltf or .obj, chosen by the content where it tells (the magic "glTF"), else by the extension.
/// \throws FileError naming the file, what is wrong and what is permitted
Asset read_asset(const std::string& path);

/// A glTF or GLB file held as its JSON document and its buffers, to be rewritten with everything else preserved.
class GltfDocument {
 public:
  /// \throws FileError
  static GltfDocument load(const std::string& path);
  GltfDocument(GltfDocument&&) noexcept;
  GltfDocument& operator=(GltfDocument&&) noexcept;
  ~GltfDocument();

  /// The triangles in it.
  Asset asset() const;

  /// Gives one primitive a TANGENT accessor (float VEC4, one a vertex), appended to the binary chunk; an old one
  /// is left where it is, unreferenced by this primitive. \throws MeshError when the count differs from POSITION's
  void set_tangents(std::size_t mesh, std::size_t primitive, std::span<const Vec4<float>> tangents);

  /// Gives one primitive new vertices: every vertex attribute is copied so that new vertex i is old vertex
  /// source[i], bit for bit, and the indices are replaced.
  void remap_vertices(std::size_t mesh, std::size_t primitive, std::span<const std::uint32_t> source,
                      std::span<const std::uint32_t> indices);

  /// Writes a GLB, whole or not at all. External buffers and data URIs become the binary chunk or stay as they
  /// are, whichever keeps the rest of the document unchanged. \throws FileError
  void save_glb(const std::string& path) const;

 private:
  struct Content;
  explicit GltfDocument(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

/// Writes one mesh as a GLB: float32 attributes, 32-bit indices (16-bit where they suffice), POSITION with min and
/// max. Doubles are rounded to the nearest float; normals and tangents are not renormalised. \throws FileError
/// \param extras_json a JSON object stored as the mesh's extras, or empty
void write_glb(const std::string& path, const Mesh& mesh, const std::string& name,
               const std::string& extras_json = {});

/// Writes a text or binary file whole or not at all: to a temporary beside it, then renamed. The path "-" is
/// standard output. \throws FileError when the folder is missing or not writable, or the disk is full
void write_file(const std::string& path, std::string_view content);

}  // namespace darboux
