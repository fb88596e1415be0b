// Fits any surface of the catalogue whose parameters are plain numbers to points, by orthogonal distances.
#pragma once

#include <string>

#include <darboux/fit_points.h>

namespace darboux {

// Fits placement and parameters by maximum likelihood, as fit_points() does, from the kind's default
// proportions: each start places a part of the default surface on the points by their principal axes. Best
// effort.
//
// Directions that the points cannot identify because of a symmetry keep their start's value, and the reason
// says so. Lengths that only bound the patch, and lengths that can grow together without changing the
// surface, are set so that the patch just encloses the inliers.
//
// The fit is usable only if all of these hold:
// - the next Newton step is below a thousandth of the standard errors
// - at least half of the points are inliers, and their rms is at most a twentieth of their extent
// - a plane explains them clearly worse
// - the lengths that define the kind are 1e-3 to 1e3 of the points' size, and their standard errors are below
//   half of them
// - these points identify everything that points over the whole patch would identify
//
// Throws ParameterError for a kind that is unknown or without such parameters, and as check_arguments() does.
// Cost: some 0.5 s, and beyond 2000 points 30 us per point, most of it two or three searches for all feet.
PointFit fit_catalogue(const PointCloud& points, const std::string& kind, const PointFitOptions& options);

}  // namespace darboux
