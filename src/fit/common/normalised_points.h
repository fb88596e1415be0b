// Points as every fit uses them: about the origin, of size 1.
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

// The points centred by their medians and scaled by a power of two to a median distance of about 1, so that
// no outlier, however far, costs digits. One column per place: several points at one place carry no more
// information than one. Points that are not finite are dropped, and so are those beyond a million median
// distances, which lie on no surface that could be recognised.
//
// With uvs each point has a column, as one place may have several uvs; the unit is exactly twice the median
// distance, so that likelihoods, which are for positions in that unit, are the same in any unit of the input.
// Vertices of a mesh, which has no outliers, are centred and scaled by its box, in whose size its tolerances
// are (fit_mesh.cpp).
struct NormalisedPoints {
  Eigen::Matrix3Xd cloud, normals{};
  std::vector<Vec2<double>> uvs{};   // of the columns, if the fit uses uvs
  std::vector<std::size_t> index{};  // of a column in the input
  std::vector<std::pair<std::size_t, std::size_t>>
      repeated{};          // further points of the input at these places, each with its column
  std::size_t finite = 0;  // number of finite points of the input
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double scale = 0;  // 0 if all points are at one place
  // Half of the greatest error with which coordinates were stored, as far as their values show it. The noise
  // is never estimated below this.
  double rounding = 1e-15;
  // The same for each way of writing that agrees with the values, in descending order; 0: none. For
  // coordinates, and for the stored uvs, which have their own units.
  std::array<double, 3> roundings{}, uv_roundings{};
  // Half of the step of rounded coordinates, if half of the points lie on few of its levels, as on a plane
  // parallel to an axis; else 0. With less noise than this, a fit would take one level for the surface,
  // without noise, and its neighbours for outliers.
  double half_step = 0;
  // The step of which all coordinates are whole multiples, if that is at least a thousandth of the size; else
  // 0.
  double common_step = 0;
  // Whether the coordinates are floats, or nine digits of them, and need all bits of one: whole numbers are
  // floats too, and do not show how they were stored.
  bool are_floats = false;

  std::size_t count() const { return static_cast<std::size_t>(cloud.cols()); }
  // The error of a coordinate by rounding of the input, with a margin. The noise is never estimated below
  // this.
  double least_sigma() const { return 1e-13 + 0x1p-52 * (centre / scale).stableNorm(); }

  // The error of a coordinate by storage in the file, with a margin. At least six decimals of the points'
  // size, even if the values show no rounding: smaller errors are the same for all points of a row. Far from
  // the origin, floats err more: four times their greatest error counts. Doubles do not, and points are
  // judged there as elsewhere.
  double stored_rounding() const {
    const double relative = are_floats ? 0x1p-22 : 0x1p-52;
    return std::fmax(3 * rounding, 1e-5 + relative * (centre / scale).stableNorm());
  }

  // Only these columns with their uvs, in the same units.
  NormalisedPoints part(const std::vector<Eigen::Index>& columns) const;
  // At most `most` of them, one at random from each interval: a fixed stride could coincide with the rows of
  // a grid.
  NormalisedPoints chosen(std::size_t most, std::uint64_t seed) const;

  // Expands one value per column to one per point of the input; points without a column keep their value.
  void spread(const std::vector<bool>& columns, std::vector<bool>& input) const;
};

// Whether a stored uv is usable: squares of larger ones would overflow.
inline bool usable_uv(const Vec2<double>& uv) {
  return std::fabs(uv.x) <= 1e100 && std::fabs(uv.y) <= 1e100;
}

// \param with_uv a point whose uv is not usable is not finite either
NormalisedPoints normalised(const PointCloud& points, bool with_uv = false);

// Why these points cannot be fitted, by their number and size; empty if they can. \param fewest one more than
// the kind would fit exactly
std::string against_points(const NormalisedPoints& points, std::size_t fewest, std::string_view kind);

// Whether all of them lie on a line. They are not all one point.
bool on_a_line(const Eigen::Matrix3Xd& cloud);

}  // namespace darboux::fit
