// Cylinders and cones by linear equations for every direction of the axis, without normals: points on a few
// circles, as measuring machines take them, have neighbours along one curve only, which determine no normal.
#pragma once

#include <vector>

#include "primitive.h"

namespace darboux::fit {

// With z along the axis the radius is alpha + beta z, for a cylinder beta = 0:
//   x^2 + y^2 - beta^2 z^2 = 2 a x + 2 b y + c + 2 alpha beta z,  c = alpha^2 - a^2 - b^2
struct RoundAboutAxis {
  Vector3d centre, axis;  // a point of the axis, where z = 0
  double radius, slope;   // alpha, beta
  double residual;        // rms of the equation's residual over twice the radius: about the distance
};

// The local minima of the residual over all directions, the least first, at most four of them. At most some
// hundred points of the sample are used. \param tapers whether beta is estimated
std::vector<RoundAboutAxis> round_about_axes(const Eigen::Matrix3Xd& sample, bool tapers);

}  // namespace darboux::fit
