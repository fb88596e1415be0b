/// \file mesh_files.h
/// Reads mesh formats other than glTF. All functions throw FileError.
#pragma once

#include <string>

#include <darboux/io.h>

namespace darboux::io {

/// The maximum number of uv sets of a primitive: glTF requires two, assimp supports eight.
constexpr int most_uv_sets = 8;

/// A tangent with w = sign of b · cross(n, t); 0 if that is zero.
inline Vec4<double> with_side(const Vec3<double>& n, const Vec3<double>& t, const Vec3<double>& b) {
  const double side = dot(cross(n, t), b);
  return {t.x, t.y, t.z, side > 0 ? 1.0 : side < 0 ? -1.0 : 0.0};
}

/// The formats read through assimp.
enum class AssimpFormat { obj, fbx };
/// OBJ and FBX, by assimp in a separate process.
Asset read_with_assimp(const std::string& path, const std::string& bytes, AssimpFormat format,
                       const ReadOptions& options);

/// COLLADA.
Asset read_collada(const std::string& path, const std::string& bytes, const ReadOptions& options);

// These are read in pieces.
Asset read_ply(const std::string& path, const ReadOptions& options);
Asset read_stl(const std::string& path);

}  // namespace darboux::io
