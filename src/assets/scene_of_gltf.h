/// \file scene_of_gltf.h
/// Plans the triangles of a glTF file for its cameras, by whole primitives.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <darboux/io.h>
#include <darboux/scene.h>

#include "camera_motion.h"
#include "io/scene_file.h"

namespace darboux {

/// Each mesh of a file, a part for each of its primitives of triangles, whose material has what it reads.
struct GltfScene {
  Scene scene;
  std::size_t primitive_instances = 0;   ///< how many parts its instances show
  std::vector<io::NamedCamera> cameras;  ///< one per node that has one, else one that sees all
  std::optional<CameraMotion> motion{};  ///< of the first of them that an animation moves,
  std::size_t moving_camera = 0;         ///< this one
};

/// Reads nodes, cameras, EXT_mesh_gpu_instancing, and the triangles with what their materials read.
/// \param with_motion whether keys of animations are read, and GltfScene::motion is found
/// \throws FileError for an inconsistent file, cyclic nodes, a camera that sees nothing, or more than 10^7
/// instances of primitives
GltfScene scene_of_gltf(const std::string& path, const ReadOptions& options = {}, bool with_motion = false);

}  // namespace darboux
