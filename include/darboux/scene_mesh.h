/// \file scene_mesh.h
/// Meshes in a scene: bounds of their triangles, which a plan skips or needs by whole parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/mesh.h>

namespace darboux {

/// Triangles of one material, by bounds in the mesh's own space.
struct SceneMeshPart {
  Eigen::AlignedBox3d box;
  /// A cone that contains the normals of the triangles (by winding): unit axis and half angle; pi if there is
  /// none.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double half_angle_rad = std::numbers::pi;
  std::uint32_t material = 0;  ///< index into those of the scene
  bool moves = false;          ///< as by morph targets: bounds are not known
  std::size_t vertices = 0;

  /// The part that holds all triangles of a mesh; it moves if a position is not finite. Cost: some 30 ns per
  /// triangle.
  static SceneMeshPart of(const Mesh& mesh, std::uint32_t material);
};

struct SceneMesh {
  std::vector<SceneMeshPart> parts;
};

/// An instance of a mesh in a scene. The placement may be singular: a flat instance has no side, and is never
/// skipped for facing away.
struct SceneMeshInstance {
  std::uint32_t mesh = 0;  ///< index into those of the scene
  bool moves = false;      ///< as by a skin or an animation: its place is not known
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
};

}  // namespace darboux
