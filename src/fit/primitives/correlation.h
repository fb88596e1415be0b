// Whether what is left of the points is noise.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "refine.h"

namespace darboux::fit {

// Whether the inliers' errors are alike between neighbours, as where the points lie on another surface. Two
// tests; what is alike must be more than a quarter of the errors' variance, so much that sigma is not the
// noise:
// - groups of 2, 4, 8 and 16 neighbours on the surface have other means: analysis of variance [Fisher1925,
//   sec. 38 to 40]. Noise fails with a probability of 1e-6 for each size.
// - polynomials of some degree up to 6 in the places explain the errors, beyond what the surface's own
//   parameters do: the F test for lack of fit [DraperSmith1998, ch. 6]. This sees it in few points too, which
//   have no near neighbours. Noise fails with a probability of 1e-5 for each degree. At most 256 points are
//   taken; those of a grid are not asked, as their roundings repeat.
bool neighbours_are_alike(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                          const std::vector<bool>& is_inlier);

// How far apart the two groups lie that the inliers' errors fall into, as of the two sides of a wall; nothing
// where they are one. Told by their kurtosis: 3 of Gaussian noise, 1.8 of uniform, below 1.5 of two groups
// that lie more than five times their noise apart.
std::optional<double> distance_of_groups(const PrimitiveFit& fit, const std::vector<bool>& is_inlier);

}  // namespace darboux::fit
