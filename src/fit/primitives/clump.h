// A clump: many of the points within a small ball, as clutter beside a surface is.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace darboux::fit {

// Which points are one, a tenth to two thirds of all; empty where there is none. It is much denser than where
// others lie, about as wide in all directions (no patch or strip of a surface is), and ends 3.5 standard
// deviations from its mean, where a Gaussian one has 99.3 % of its points. The same for the same points.
std::vector<bool> dense_clump(const Eigen::Matrix3Xd& cloud);

}  // namespace darboux::fit
