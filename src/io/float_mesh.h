/// \file float_mesh.h
/// The triangles of a primitive in single precision, as most files store them: arrays where they lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <darboux/io.h>

#include "gltf_file.h"

namespace darboux::io {

/// Numbers of a file: where they lie, or a copy where they are not tightly packed.
template <class T>
class InPlace {
 public:
  InPlace() = default;
  explicit InPlace(std::span<const T> there) : there_(there) {}
  explicit InPlace(std::vector<T> copy) : copy_(std::move(copy)) {}
  std::span<const T> span() const { return copy_.empty() ? there_ : std::span<const T>(copy_); }

 private:
  std::span<const T> there_;
  std::vector<T> copy_;
};

/// A list of triangles.
struct FloatMesh {
  InPlace<float> positions, normals, uvs;  ///< x, y, z; x, y, z; u, v of each vertex
  InPlace<std::uint32_t> corners;          ///< the vertex of each; none: corner i is vertex i
  std::size_t vertices = 0, triangles = 0;
};

/// The same triangles as those of a Mesh, without its doubles, of a list of triangles with floats for
/// positions, normals and uvs as they are stored: no texture transform, no morph targets. Nothing of others,
/// where a number is not finite, and where all positions or all uvs are below 2^-100. Everything is checked
/// as read_gltf() does, TANGENT too. \param primitive gets what read_gltf() finds beside the numbers
/// \throws FileError
std::optional<FloatMesh> read_float_mesh(const GltfFile& file, const JsonCursor& place, std::uint64_t mode,
                                         Primitive& primitive);

}  // namespace darboux::io
