// Fits any surface of the catalogue whose parameters are plain numbers to points, by orthogonal distances.
#pragma once

#include <string>

#include <darboux/fit_points.h>

namespace darboux {

// Placement and parameters by maximum likelihood as in fit_points(), best effort from the kind's default proportions: starts
// are parts of the default surface laid onto the points by their principal axes. What the points do not tell (a symmetry,
// a length that only bounds the patch) is held where it came to lie, and the reason says so. Usable only where Ceres
// converged, at least half the points are inliers and rms is at most a twentieth of the points' size.
// Throws ParameterError for a kind unknown or without such parameters, a bad noise or a guess of another kind, MeshError
// for normals or uvs of another length than positions.
PointFit fit_any_kind(const PointCloud& points, const std::string& kind, const PointFitOptions& options);

}  // namespace darboux
