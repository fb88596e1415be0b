// A clump: many of the points within a small ball, as clutter beside a surface is.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace darboux::fit {

// The points of a clump, a tenth to two thirds of all; empty where there is none. It is much denser than
// where others lie, about as wide in all directions, as no strip or flat patch of a surface is, and ends 3.5
// standard deviations from its mean, where a Gaussian one has 99.3 % of its points. The same for the same
// points in the same order.
std::vector<bool> dense_clump(const Eigen::Matrix3Xd& cloud);

struct ClumpShape {
  double deviation;   // standard, of a coordinate: the root of the mean of the three variances
  bool fills_a_ball;  // of a surface there are four times as many pairs within twice a distance, here eight
};
ClumpShape shape_of_clump(const Eigen::Matrix3Xd& cloud, const std::vector<bool>& clump);

}  // namespace darboux::fit
