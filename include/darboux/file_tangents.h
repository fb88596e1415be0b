/// \file file_tangents.h
/// Tangents for the meshes of a glTF file. Target darboux::io.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <darboux/frame.h>
#include <darboux/io.h>
#include <darboux/mesh_frames.h>

namespace darboux {

struct FileTangentOptions {
  std::string method = "mikktspace";  ///< one of frame_methods()
  SignConvention sign = SignConvention::gltf;
  bool only_needed = false;  ///< only primitives with Primitive::needs_tangents
  int threads = 1;           ///< as mesh_frames() takes it; the file does not depend on it
  /// Called with the share of primitives that are done, in [0, 1].
  std::function<void(double)> progress;
};

/// The result for one primitive.
struct PrimitiveTangents {
  std::size_t mesh = 0, primitive = 0;
  std::string name;  ///< the mesh's
  std::size_t corners = 0;
  std::size_t old_vertices = 0, vertices = 0;                         ///< before and after splitting
  std::size_t morph_targets = 0;                                      ///< targets that received deltas
  std::size_t degenerate_triangles = 0, degenerate_uv_triangles = 0;  ///< as MeshFrames
  std::size_t fallback_corners =
      0;  ///< likewise: the method gives no direction there; an arbitrary one was written
};

/// The results for all primitives, in the order of the file.
struct FileTangents {
  std::vector<PrimitiveTangents> primitives;
  std::vector<SkippedPrimitive> skipped;  ///< not changed, and why
  std::size_t incapable = 0;              ///< of skipped: those that lack normals or uvs
};

/// Writes TANGENT for the primitives of a document, computed by a method of mesh_frames.h from positions,
/// normals and the uv set Primitive::texcoord. Primitive::texture_transform is applied to the uvs unless it
/// maps them onto a line or a point. Quantised data are dequantised; nothing is renormalised. Existing
/// tangents are replaced. Vertices are split where tangents differ (split_vertices.h). All other attributes,
/// including skins, are copied bit for bit, and triangles keep their order. Every tangent written is finite
/// and unit, with w = ±1.
///
/// Morph targets: with t the method's tangents of the mesh and t_k those of the mesh with target k applied at
/// weight 1 (to positions, normals and uvs; normals then made unit), target k gets the TANGENT t_k - t, and
/// vertices are split where any of them differ. Where the method has no direction for t_k
/// (CornerFrame::fallback) the delta is zero. w is the base's.
///
/// Skipped, with a reason: points and lines; primitives without normals (glTF says that their tangents are
/// ignored) or without uvs; and, with only_needed, primitives whose tangents nothing needs.
///
/// \throws FileError when the file's data cannot be read \throws MeshError naming file, primitive and vertex
/// for the first position, normal or uv that is not finite, a morph target's included \throws ParameterError
/// for an unknown method, or as mesh_frames()
FileTangents add_tangents(GltfDocument& document, const FileTangentOptions& options = {});

/// The result of drop_idle_tangents().
struct DroppedIdle {
  std::vector<SkippedPrimitive> primitives;  ///< primitives whose TANGENT was removed, and why it was idle
  std::size_t bytes = 0;                     ///< bytes removed from the buffers
  std::string bytes_kept;                    ///< why no bytes were removed; empty if they were
};

/// Removes TANGENT from the primitives where it is idle (tangent_need.h, TangentNeed::idle), and from their
/// morph targets. Accessors and bufferViews that nothing else uses are removed from the document, and their
/// bytes from the buffers, also from between interleaved attributes. Shared accessors stay. All other
/// elements keep their bits. Buffers other than the GLB's own become data URIs. No bytes are removed if an
/// unknown extension may name accessors or bufferViews by number. Cost: linear in the bytes of the buffers.
/// \throws FileError if the document is inconsistent, which leaves it unchanged
DroppedIdle drop_idle_tangents(GltfDocument& document);

}  // namespace darboux
