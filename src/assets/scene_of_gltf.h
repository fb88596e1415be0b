/// \file scene_of_gltf.h
/// What a camera of a glTF file needs of its triangles: by whole primitives.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/io.h>
#include <darboux/scene.h>

#include "io/scene_file.h"

namespace darboux {

/// A primitive as planning sees it, in its mesh's own space.
struct ScenePrimitive {
  Eigen::AlignedBox3d box;
  /// The cone that holds the normals of its triangles: unit axis and half the angle, pi where there is none.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double half_angle_rad = 3.141592653589793;
  bool double_sided = false;
  bool moves = false;  ///< by morph targets: the box is not known
  bool needs_tangents = false;
  std::size_t vertices = 0;
};

struct SceneMeshInstance {
  std::size_t mesh;
  bool moves;  ///< by a skin or an animation: neither box nor placement are known
  Eigen::Affine3d placement;
};

struct GltfScene {
  std::vector<ScenePrimitive> primitives;
  std::vector<std::vector<std::uint32_t>> primitives_of_mesh;
  std::deque<SceneMeshInstance> instances;  ///< each shows all primitives of its mesh
  std::size_t primitive_instances = 0;      ///< how many those are
  std::vector<io::NamedCamera> cameras;     ///< one per node that has one, else one that sees all
};

/// Reads nodes, cameras, EXT_mesh_gpu_instancing, and the triangles with what their materials read.
/// \throws FileError for a file that contradicts itself, cyclic nodes, a camera that sees nothing, more than
/// 10^7 instances of primitives
GltfScene scene_of_gltf(const std::string& path, const ReadOptions& options = {});

/// A plan without patches. Its tiles are instances of primitives, each of one level; its samples are their
/// vertices, of which tangent4 counts those whose material reads tangents. Skipped are those outside the
/// frustum, those that wholly face away and are single-sided, and duplicates, whose vertices another instance
/// needs already. tiles_unbounded counts what morph targets, a skin or an animation moves, which is needed
/// always.
ScenePlan plan_primitives(const GltfScene& scene, const Camera& camera);

}  // namespace darboux
