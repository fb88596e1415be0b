// Whether what is left of the points is noise.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "refine.h"

namespace darboux::fit {

// Whether the inliers' errors are alike between neighbours, as where the points lie on another surface.
// Groups of 2, 4, 8 and 16 neighbours on the surface: alike where in one of these sizes the intraclass
// correlation is above a quarter, so much that sigma is not the noise, and the variances' ratio is one that
// noise exceeds with a probability of 1e-6 [Fisher1925, sec. 38 to 40].
bool neighbours_are_alike(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                          const std::vector<bool>& is_inlier);

}  // namespace darboux::fit
