// Parts of meshes before a camera, by their bounds.
#pragma once

#include <darboux/scene_mesh.h>

#include "view.h"

namespace darboux {

// Whether all of it lies beyond a plane of the frustum.
bool is_outside(const SceneMeshPart& part, const Eigen::Affine3d& placement, double displacement,
                const View& view);
// Whether all triangles show their back. Not known of what is flat, or nearly so.
bool faces_away(const SceneMeshPart& part, const Eigen::Affine3d& placement, const View& view);

}  // namespace darboux
