// Point fits with uvs: P = placement(surface(uv)) + noise, one uv convention for all points.
#pragma once

#include <darboux/fit_points.h>

namespace darboux {

/// fit_points() where options.with_uv: the kinds are those of fitted_kinds(), `auto` tries them all. The
/// distance of a point is that from the surface at its own uv, so that the noise is in all three coordinates,
/// and seams and poles are points like others. The uv convention is the first of uv_conventions() that
/// explains the points as well as the best of them, or else "affine". Noise-free points give the parameters
/// to 1e-13 of the size. \throws as fit_points()
PointFit fit_points_with_uv(const PointCloud& points, const PointFitOptions& options);

}  // namespace darboux
