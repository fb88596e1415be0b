// Finds primitives in points, by orthogonal distances.
#pragma once

#include <darboux/fit_points.h>

#include "search.h"

namespace darboux::fit {

// fit_points() without uvs. \param only null for `auto`: whichever explains the points best
PointFit fit_primitives(const PointCloud& points, const PointFitOptions& options, const Primitive* only,
                        Effort effort = Effort::full);

}  // namespace darboux::fit
