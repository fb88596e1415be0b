// The arguments of every fit of points.
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include <darboux/fit_points.h>

namespace darboux::fit {

// Whether the kind of surface is to be found out.
inline bool is_automatic(const PointFitOptions& options) {
  return options.surface == "auto";
}

// \throws MeshError for normals or uvs of another number than positions, or none where uvs are needed;
// ParameterError for a noise that is not positive and finite, a guess that is not finite or of another kind
// than the one that is named.
void check_arguments(const PointCloud& points, const PointFitOptions& options);

// \throws ParameterError for a placement that scales, shears or mirrors, or is not finite
void check_placement(const std::optional<Eigen::Isometry3d>& placement);

}  // namespace darboux::fit
