// Whether the residuals of a primitive are noise.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "refine.h"

namespace darboux::fit {

// See fit/common/lack_of_fit.h.
bool neighbours_are_alike(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                          const std::vector<bool>& is_inlier);

// How far apart the two groups lie that the inliers' errors fall into, as of the two sides of a wall; nothing
// where they are one. Told by their kurtosis: 3 of Gaussian noise, 1.8 of uniform, below 1.5 of two groups
// that lie more than five times their noise apart.
std::optional<double> distance_of_groups(const PrimitiveFit& fit, const std::vector<bool>& is_inlier);

}  // namespace darboux::fit
