/// \file point_cloud.h
/// Sampled points without triangles. A cloud knows no surface.
#pragma once

#include <vector>

#include <darboux/vector.h>

namespace darboux {

/// Points with what is known about each. An attribute that the cloud lacks is empty; any other has one entry
/// per point.
struct PointCloud {
  std::vector<Vec3<double>> positions;
  std::vector<Vec3<double>> normals;  ///< as stored, of either side and any length
  std::vector<Vec2<double>> uvs;      ///< as stored, unflipped
};

}  // namespace darboux
