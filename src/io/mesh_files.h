/// \file mesh_files.h
/// Files of meshes other than glTF, as an Asset. All throw FileError.
#pragma once

#include <string>

#include <darboux/io.h>

namespace darboux::io {

/// Of those that a primitive keeps: glTF asks readers for two, assimp knows eight.
constexpr int most_uv_sets = 8;

/// A tangent whose w is the side of cross(n, t) that the bitangent lies on, 0 where it lies on none.
inline Vec4<double> with_side(const Vec3<double>& n, const Vec3<double>& t, const Vec3<double>& b) {
  const double side = dot(cross(n, t), b);
  return {t.x, t.y, t.z, side > 0 ? 1.0 : side < 0 ? -1.0 : 0.0};
}

/// What assimp reads.
enum class AssimpFormat { obj, fbx };
/// OBJ and FBX, by assimp in a process of its own.
Asset read_with_assimp(const std::string& path, const std::string& bytes, AssimpFormat format,
                       const ReadOptions& options);

/// COLLADA.
Asset read_collada(const std::string& path, const std::string& bytes, const ReadOptions& options);

// These are read in pieces.
Asset read_ply(const std::string& path, const ReadOptions& options);
Asset read_stl(const std::string& path);

}  // namespace darboux::io
