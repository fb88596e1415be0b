// A clump: many of the points within a small ball, such as clutter beside a surface.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace darboux::fit {

// Marks the points of a clump, a tenth to two thirds of all; empty if there is none. A clump is much denser
// than the other points, and about as wide in all directions, unlike a strip or flat patch of a surface. It
// ends 3.5 standard deviations from its mean; a Gaussian clump has 99.3 % of its points within. Deterministic
// for the same points in the same order.
std::vector<bool> dense_clump(const Eigen::Matrix3Xd& cloud);

struct ClumpShape {
  double deviation;   // standard deviation of a coordinate: root of the mean of three variances
  bool fills_a_ball;  // pairs within twice a distance: eight times as many; a surface has four
};
ClumpShape shape_of_clump(const Eigen::Matrix3Xd& cloud, const std::vector<bool>& clump);

}  // namespace darboux::fit
