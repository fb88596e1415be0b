// A chosen primitive as the result of a fit.
#pragma once

#include <optional>
#include <vector>

#include <darboux/fit_points.h>

#include "fit/common/normalised_points.h"
#include "refine.h"

namespace darboux::fit {

// Root mean square of their errors.
double rms_of(const PrimitiveFit& fit, const std::vector<bool>& is_inlier);

// How well the noise is known.
struct NoiseKnowledge {
  double squared_factor;      // distances are smaller than the noise, part of which the unknowns absorb
  double degrees_of_freedom;  // infinite where the noise was given
};

// Counts, rms and noise.
NoiseKnowledge report_points(const PrimitiveFit& best, const NormalisedPoints& points,
                             const std::vector<bool>& is_inlier, bool noise_is_known, PointFit& to);

// Surface, covariance, standard errors and intervals.
void report_surface(const PrimitiveFit& best, const NormalisedPoints& points, const NoiseKnowledge& noise,
                    PointFit& to);

}  // namespace darboux::fit
