// Parts of meshes before a camera, by their bounds.
#pragma once

#include <darboux/scene.h>

#include "occlusion.h"
#include "tile_tests.h"
#include "view.h"

namespace darboux {

// Whether all of it lies beyond a plane of the frustum.
bool is_outside(const SceneMeshPart& part, const Eigen::Affine3d& placement, double displacement,
                const View& view);
// Whether all triangles show their back. Not known of what is flat, or nearly so.
bool faces_away(const SceneMeshPart& part, const Eigen::Affine3d& placement, const View& view);

// Adds what is needed of the scene's meshes to a plan, each part of an instance as one tile: nothing of them
// is evaluated. \throws ParameterError for a mesh or a material that the scene lacks, or a placement that is
// not finite
void plan_mesh_parts(const Scene& scene, const SceneRequest& request, const TileTests& tests,
                     const Occlusion& occlusion, ScenePlan& plan);

}  // namespace darboux
