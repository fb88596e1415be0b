// The arguments of every fit of points.
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include <darboux/fit_points.h>

namespace darboux::fit {

// Whether the fit is to find the kind of surface.
inline bool is_automatic(const PointFitOptions& options) {
  return options.surface == "auto";
}

// \throws MeshError if the number of normals or uvs differs from that of positions, or uvs are needed and
// missing; ParameterError for a noise that is not positive and finite, or a guess that is not finite or not
// of the named kind.
void check_arguments(const PointCloud& points, const PointFitOptions& options);

// \throws ParameterError for a placement that scales, shears or mirrors, or is not finite
void check_placement(const std::optional<Eigen::Isometry3d>& placement);

}  // namespace darboux::fit
