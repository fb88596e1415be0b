/// \file scene_tiles.h
/// Writes the tiles of a scene as a GLB.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <darboux/scene.h>

namespace darboux {
struct GltfFile;
}

namespace darboux::io {

/// Collects tiles: one mesh per patch and material, with POSITION, NORMAL, TEXCOORD_0 and TANGENT of the
/// samples as float32, if evaluated, in the space of the surface; and one node per tile with its placement.
/// So data shared by several instances are stored once. What a material reads is only stated in its name.
class SceneTiles {
 public:
  SceneTiles(const std::string& path, const Scene& scene, std::vector<std::string> surface_names);
  ~SceneTiles();

  /// \throws MeshError if a position is not finite as a float
  void add(const TileSamples& tile);
  /// \throws FileError for 4 GiB and more
  std::string to_glb() const;

 private:
  std::size_t material(std::uint32_t index);

  const Scene& scene_;
  std::vector<std::string> surface_names_;
  std::unique_ptr<GltfFile> file_;
  std::map<std::uint32_t, std::size_t> materials_;  // index in the file by material of the scene
};

}  // namespace darboux::io
