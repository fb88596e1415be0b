// The principal axes of points.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace darboux::fit::catalogue {

struct Principal {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;
  double size;       // rms distance from the centre
  double thickness;  // rms distance from the plane of the other two axes
  // Axes about which the spread is nearly circular, so that the other two axes are arbitrary.
  std::vector<int> round;
};

Principal principal(const std::vector<Eigen::Vector3d>& points);

}  // namespace darboux::fit::catalogue
