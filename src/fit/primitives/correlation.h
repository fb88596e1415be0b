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

// If the inliers' errors form two groups, like the two sides of a wall, their distance; else none. The
// kurtosis decides: it is 3 for Gaussian noise, 1.8 for uniform, and below 1.5 for two groups more than five
// times their noise apart.
std::optional<double> distance_of_groups(const PrimitiveFit& fit, const std::vector<bool>& is_inlier);

// Which length (or angle) of the primitive the edge changes, its value, and that without the edge.
struct EdgeEffect {
  std::size_t length;
  double with_edge, without_edge;
};

// Leaves out the tenth of the inliers nearest to each end of a coordinate on the surface, if they do not go
// all round it. \return the length that changes most; none if no length changes by three of its standard
// errors and by five of the difference's [Hausman1978]. If one does, points at the edge belong to a surface
// that joins this one smoothly, such as the planes beside a fillet. One linear step: the value is right to
// first order.
std::optional<EdgeEffect> edge_effect(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                                      const std::vector<bool>& is_inlier);

}  // namespace darboux::fit
