// Fits any surface of the catalogue whose parameters are plain numbers to points, by orthogonal distances.
#pragma once

#include <string>

#include <darboux/fit_points.h>

namespace darboux {

// Placement and parameters by maximum likelihood as in fit_points(), best effort from the kind's default
// proportions: starts are parts of the default surface laid onto the points by their principal axes. What the
// points do not tell because of a symmetry is held where it came to lie, and the reason says so; lengths that
// only bound the patch, and those that may grow together without changing the surface, are such that the
// patch just encloses the inliers, where multiplying them does that. Usable only where Newton's next step is
// below a thousandth of the standard errors, at least half the points are inliers, rms is at most a twentieth
// of the inliers' extent, a plane does not explain them as well, the lengths that make the surface of this
// kind are 1e-3 to 1e3 of the points' size with standard errors below their half, and the points tell every
// movement that the whole patch would tell. Throws ParameterError for a kind unknown or without such
// parameters, a bad noise or a guess of another kind, MeshError for normals or uvs of another length than
// positions. Cost: some 0.5 s, and beyond 2000 points 30 us a point, most of it two or three searches for all
// feet.
PointFit fit_catalogue(const PointCloud& points, const std::string& kind, const PointFitOptions& options);

}  // namespace darboux
