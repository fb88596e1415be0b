// A chosen primitive as the result of a fit.
#pragma once

#include <optional>
#include <vector>

#include <darboux/fit_points.h>

#include "fit/common/normalised_points.h"
#include "refine.h"

namespace darboux::fit {

// Which columns of the points are inliers.
std::vector<bool> inliers_of(const PrimitiveFit& fit);

// Root mean square of their errors.
double rms_of(const PrimitiveFit& fit, const std::vector<bool>& is_inlier);

// Counts, rms and noise. Returns the factor of sigma squared by which the distances are smaller as the
// unknowns took some of it up.
double report_points(const PrimitiveFit& best, const NormalisedPoints& points,
                     const std::vector<bool>& is_inlier, bool noise_is_known, PointFit& to);

// Surface, covariance and standard errors.
void report_surface(const PrimitiveFit& best, const NormalisedPoints& points, double sigma_squared,
                    PointFit& to);

}  // namespace darboux::fit
