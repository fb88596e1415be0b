// Tests parts of meshes against a camera, by their bounds.
#pragma once

#include <darboux/scene.h>

#include "occlusion.h"
#include "tile_culling.h"
#include "view.h"

namespace darboux {

// Whether the part lies entirely outside a plane of the frustum.
bool is_outside(const SceneMeshPart& part, const Eigen::Affine3d& placement, double displacement,
                const View& view);
// Whether all triangles are back-facing. Unknown for flat or nearly flat placements.
bool faces_away(const SceneMeshPart& part, const Eigen::Affine3d& placement, const View& view);

// Adds the needed parts of the scene's meshes to a plan, each part of an instance as one tile. Nothing is
// evaluated for them. \throws ParameterError for an unknown mesh or material, or a placement that is not
// finite
void plan_mesh_parts(const Scene& scene, const SceneRequest& request, const TileCulling& tests,
                     const Occlusion& occlusion, ScenePlan& plan);

}  // namespace darboux
