// Points as every fit sees them: about the origin, of size 1.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <darboux/point_cloud.h>

namespace darboux::fit {

// The points centred by their medians and scaled by a power of two to a median distance of about 1: no
// outlier, however far, decides what the digits are spent on. A column for each place: points at one place
// tell no more than one of them. Not those that are not finite, nor those beyond a million median distances,
// which are on no surface that could be told.
struct NormalisedPoints {
  Eigen::Matrix3Xd cloud, normals{};
  std::vector<std::size_t> index{};  // of a column in the input
  std::vector<std::pair<std::size_t, std::size_t>>
      repeated{};          // other points of the input, each with its column
  std::size_t finite = 0;  // points of the input that are
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double scale = 0;  // 0 where all points are at one place

  // From one value per column to one per point of the input, whose other points keep theirs.
  void spread(const std::vector<bool>& columns, std::vector<bool>& input) const;
};

NormalisedPoints normalised(const PointCloud& points);

// Why so many points of this size are not fitted; empty where they are. \param fewest one more than the kind
// would fit exactly
std::string against_points(const NormalisedPoints& points, std::size_t fewest, std::string_view kind);

// Whether all of them lie on a line. They are not all one point.
bool on_a_line(const Eigen::Matrix3Xd& cloud);

}  // namespace darboux::fit
