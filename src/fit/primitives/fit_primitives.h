// Finds a surface of one of found_kinds() in points, by orthogonal distances, each kind with formulas of its
// own.
#pragma once

#include <darboux/fit_points.h>

namespace darboux {

// fit_points() without uvs where options.surface is auto or one of found_kinds().
PointFit fit_by_kind(const PointCloud& points, const PointFitOptions& options);

}  // namespace darboux
