// Finds the part of an unbounded surface that the points cover: outliers on its continuation have high
// leverage, and nothing else reveals them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "primitive.h"

namespace darboux::fit {

// Sets states.in_support. The surface is cut into cells. A cell keeps its points if their density is at least
// 0.3 of the median density over the points. Few points get fewer cells, or none. \return the points of
// sparser cells with hardly any outliers, which may lie on the surface or on one that joins it smoothly
std::vector<Eigen::Index> find_support(const Primitive& primitive, const Eigen::Matrix3Xd& cloud,
                                       const GeometricParameters& surface, const Mixture& mixture,
                                       PointStates& states);

}  // namespace darboux::fit
