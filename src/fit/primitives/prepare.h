// What the search for surfaces begins with: points with normals.
#pragma once

#include <random>

#include <Eigen/Core>

namespace darboux::fit {

// Points with normals of unknown sign, column by column.
struct OrientedPoints {
  Eigen::Matrix3Xd points, normals;
};

// Points of the cloud with a normal each. The stored normals where there are any: as many columns as the
// cloud, of any length, zero or not finite for none. Else from the principal axes of their neighbours, or of
// those neighbours that are near one plane. Of these the two thirds with the flattest neighbourhoods are
// kept, so that few are outliers; all where there are no more than 20.
OrientedPoints oriented_points(const Eigen::Matrix3Xd& cloud, const Eigen::Matrix3Xd& normals, bool outliers,
                               std::mt19937_64& random);

}  // namespace darboux::fit
