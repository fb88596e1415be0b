// Points as every fit sees them: about the origin, of size 1.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
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
// which lie on no surface that could be recognised.
//
// With uvs each point has a column, as one place may have several uvs; the unit is just twice the median
// distance, so that likelihoods, which are of positions in that unit, are the same in any unit of the input.
// Vertices of a mesh, which has no outliers, are centred and scaled by its box, in whose size its tolerances
// are (fit_mesh.cpp).
struct NormalisedPoints {
  Eigen::Matrix3Xd cloud, normals{};
  std::vector<Vec2<double>> uvs{};   // of the columns, where the fit is through them
  std::vector<std::size_t> index{};  // of a column in the input
  std::vector<std::pair<std::size_t, std::size_t>>
      repeated{};          // other points of the input, each with its column
  std::size_t finite = 0;  // points of the input that are
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double scale = 0;  // 0 where all points are at one place
  // Half of the greatest error of a coordinate by how it was stored, as far as its value tells: no noise is
  // taken to be less.
  double rounding = 1e-15;
  // The same of each way of writing that their values agree with, in falling order; 0: none. Of coordinates,
  // and of the stored uvs, which have their own units.
  std::array<double, 3> roundings{}, uv_roundings{};
  // Half of the step of rounded coordinates, where half of the points lie on few of its levels, as on a plane
  // parallel to an axis; 0: they do not. Less noise than that would take one level for the surface, without
  // noise, and its neighbours for outliers.
  double half_step = 0;
  // Whether the coordinates are floats, or nine digits of them, and need all bits of one: whole numbers are
  // floats too, and say nothing of how they were stored.
  bool are_floats = false;

  std::size_t count() const { return static_cast<std::size_t>(cloud.cols()); }
  // What rounding of the input leaves of a coordinate, with room: no noise is taken to be less.
  double least_sigma() const { return 1e-13 + 0x1p-52 * (centre / scale).stableNorm(); }

  // What the file leaves of a coordinate, with room, six decimals of the points' size also where its values
  // do not tell them any more: errors below are the same for all points of a row. Far from the origin floats
  // leave more, four times their greatest error; doubles do not, and there points are judged as they are
  // elsewhere.
  double stored_rounding() const {
    const double relative = are_floats ? 0x1p-22 : 0x1p-52;
    return std::fmax(3 * rounding, 1e-5 + relative * (centre / scale).stableNorm());
  }

  // These columns with their uvs alone, in the same units.
  NormalisedPoints part(const std::vector<Eigen::Index>& columns) const;
  // At most `most` of them, one at random of each stretch: a fixed stride could keep step with the rows of a
  // grid.
  NormalisedPoints chosen(std::size_t most, std::uint64_t seed) const;

  // From one value per column to one per point of the input, whose other points keep theirs.
  void spread(const std::vector<bool>& columns, std::vector<bool>& input) const;
};

// Whether a stored uv says where a point lies: beyond, squares leave the range of numbers.
inline bool usable_uv(const Vec2<double>& uv) {
  return std::fabs(uv.x) <= 1e100 && std::fabs(uv.y) <= 1e100;
}

// \param with_uv a point whose uv is not usable is not finite either
NormalisedPoints normalised(const PointCloud& points, bool with_uv = false);

// Why these points, by their number and size, cannot be fitted; empty where they can. \param fewest one more
// than the kind would fit exactly
std::string against_points(const NormalisedPoints& points, std::size_t fewest, std::string_view kind);

// Whether all of them lie on a line. They are not all one point.
bool on_a_line(const Eigen::Matrix3Xd& cloud);

}  // namespace darboux::fit
