/// \file tangent_need.h
/// Determines which primitives of a glTF file need a tangent frame, and which store one. Target darboux::io.
///
/// A frame is read by a normal texture, by the normal texture of a clearcoat, and by anisotropy, with or
/// without a texture (KHR_materials_anisotropy asks for NORMAL and TANGENT, or a normal texture). Materials
/// of KHR_materials_variants count like the primitive's own. Points and lines read none, nor do materials
/// with KHR_materials_unlit. TANGENT without NORMAL is ignored by viewers (glTF 2.0, 3.7.2.1).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <darboux/io.h>

namespace darboux {

enum class TangentNeed {
  needed,   ///< read and stored
  idle,     ///< stored, and nothing reads it
  missing,  ///< read, but not stored
  none      ///< neither
};

enum class NeedLevel {
  spec,     ///< by the specifications
  factors,  ///< ignores uses that a factor of 0 disables permanently: if an animation may change it, it stays
            ///< needed
  pixels    ///< without flat normal maps either: those of which every texel is (0, 0, 1) as far as 8 bits can
            ///< tell. Only PNG is looked at; a map that is lossy or not there stays needed, with a note
};

/// What reads the frame.
struct NeedReason {
  std::string rule;        ///< normal_texture, clearcoat_normal_texture, anisotropy, packed_normal_texture
  std::string pointer;     ///< JSON pointer to it, as "/materials/0/normalTexture"
  int texcoord = -1;       ///< the uv set of its texture, -1 without a texture
  bool transform = false;  ///< the texture has a KHR_texture_transform
  /// A viewer can compute the frame: NORMAL, a normal texture and its uv set are present. For anisotropy that
  /// is the normalTexture of the material, as the extension specifies.
  bool derivable = false;
  std::string note;  ///< at NeedLevel::pixels: why its texels were not examined
};

struct PrimitiveNeed {
  std::size_t mesh = 0, primitive = 0;
  std::string name;      ///< the mesh's
  std::string material;  ///< the name of its own material
  TangentNeed need = TangentNeed::none;
  std::vector<NeedReason> reasons;
  bool carried = false;               ///< it has TANGENT
  bool has_normals = false;           ///< it has NORMAL
  bool derivable = false;             ///< all reasons are; false without any
  bool in_scene = false;              ///< a scene shows it
  std::size_t triangles = 0;          ///< as its counts say, 0 for points and lines
  std::size_t tangent_bytes = 0;      ///< of TANGENT and of the morph targets' TANGENT, uncompressed
  std::optional<std::size_t> splits;  ///< vertices that count_splits() found
};

/// Bytes are of uncompressed elements; accessors that several primitives share count once.
struct NeedTotals {
  std::size_t needed = 0, carried = 0, missing = 0, idle = 0;  ///< primitives
  std::size_t tangent_bytes = 0;
  std::size_t idle_bytes = 0;      ///< of tangents that only idle primitives carry
  std::size_t geometry_bytes = 0;  ///< of all attributes, morph targets and indices of triangles
};

struct TangentNeeds {
  std::vector<PrimitiveNeed> primitives;  ///< in the order of the file
  NeedTotals totals;
};

/// Reads the document alone; at NeedLevel::pixels, the normal maps too. Cost: linear in meshes, nodes and
/// materials, about a microsecond per primitive; some 5 ns per texel.
/// \throws FileError for an inconsistent document
TangentNeeds tangent_need(const GltfDocument& document, NeedLevel level = NeedLevel::spec);

/// The same for a file, of which only the JSON is read; at NeedLevel::pixels, the normal maps too. Buffers
/// and images may be absent. \throws FileError for a file that cannot be read, or is no glTF
TangentNeeds tangent_need(const std::string& path, NeedLevel level = NeedLevel::spec,
                          const ReadOptions& options = {});

/// How many vertices MikkTSpace's tangents would add to each primitive that needs them, as add_tangents()
/// splits them. Reads the geometry of the file. \throws as add_tangents() does
void count_splits(const std::string& path, TangentNeeds& needs, const ReadOptions& options = {});

/// A primitive that had the TANGENT it needs and no longer has it; or that lost NORMAL, without which viewers
/// ignore TANGENT. The pointers are into the arguments of dropped_tangents().
struct DroppedTangents {
  const PrimitiveNeed *before, *after;
};

/// The tangents that a tool wrongly dropped between two files. Primitives are paired one to one: first those
/// that agree in mesh name, material name and number of triangles; then, among the rest, in the first two of
/// these; then in the last two; then in their position in the file; then any. Of several equal candidates,
/// those with the same need are paired. Cost: n log n.
std::vector<DroppedTangents> dropped_tangents(const TangentNeeds& before, const TangentNeeds& after);

}  // namespace darboux
