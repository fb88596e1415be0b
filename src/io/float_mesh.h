/// \file float_mesh.h
/// The triangles of a primitive in single precision, as most files store them, without copying the arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <darboux/io.h>

#include "gltf_file.h"

namespace darboux::io {

/// Numbers of a file: a view if they are tightly packed, else a copy.
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
  InPlace<std::uint32_t> corners;          ///< the vertex of each corner; empty: corner i is vertex i
  std::size_t vertices = 0, triangles = 0;
};

/// Reads the same triangles as a Mesh, but as floats. Only for triangle lists whose positions, normals and
/// uvs are stored as floats, without texture transform or morph targets. Empty for other primitives, if a
/// number is not finite, and if all positions or all uvs are below 2^-100. Everything is checked as by
/// read_gltf(), including TANGENT. \param primitive receives what read_gltf() reads besides the numbers
/// \throws FileError
std::optional<FloatMesh> read_float_mesh(const GltfFile& file, const JsonCursor& place, std::uint64_t mode,
                                         Primitive& primitive);

}  // namespace darboux::io
