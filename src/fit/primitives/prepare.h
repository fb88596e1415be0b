// The input of the search for surfaces: points with normals.
#pragma once

#include <random>

#include <Eigen/Core>

namespace darboux::fit {

// Points with normals of unknown sign, column by column.
struct OrientedPoints {
  Eigen::Matrix3Xd points, normals;
};

// Points of the cloud, each with a normal. Stored normals are used if there are any: one column per point, of
// any length, zero or not finite for none. Else normals come from the principal axes of the neighbours, or of
// those neighbours that are near one plane. Of these points, the two thirds with the flattest neighbourhoods
// are kept, so that few are outliers; up to 20 points are all kept.
OrientedPoints oriented_points(const Eigen::Matrix3Xd& cloud, const Eigen::Matrix3Xd& normals, bool outliers,
                               std::mt19937_64& random);

}  // namespace darboux::fit
