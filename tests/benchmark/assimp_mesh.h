/// \file assimp_mesh.h
/// Tangents by assimp's post-processing step CalcTangentSpace, of a mesh in memory.
#pragma once

#include <memory>
#include <vector>

#include "torus_file.h"

namespace darboux::bench {

/// A scene of assimp with one mesh. It wants vertices that are not shared; where they are, each vertex keeps
/// what the last of its triangles wrote, as after reading an indexed glTF file.
class AssimpMesh {
 public:
  /// \throws std::runtime_error
  explicit AssimpMesh(const MeshArrays& arrays);
  ~AssimpMesh();

  /// With the default angle of 45 degrees. Does nothing where there are tangents. \throws std::runtime_error
  void make_tangents();
  void drop_tangents();
  /// x, y, z of the tangent and the raw sign of each corner: that of assimp's bitangent.
  std::vector<float> tangents() const;

 private:
  struct Scene;
  const MeshArrays& arrays_;
  std::unique_ptr<Scene> scene_;
};

}  // namespace darboux::bench
