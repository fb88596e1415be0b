// The kinds of surface that are fitted through their uvs, behind one type.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <darboux/any_surface.h>

namespace darboux {

/// Values at some uvs; point i has the rows 3i, 3i + 1, 3i + 2. Derivatives that are not requested have no
/// rows.
struct UvBlock {
  Eigen::VectorXd position;
  Eigen::MatrixXd by_parameter;  ///< one column per parameter
  Eigen::MatrixXd by_uv;         ///< dpdu, dpdv
};

/// One kind. Its position is homogeneous of degree 1 in its lengths:
///   P = sum over the lengths of p_k ∂P/∂p_k
struct UvKind {
  std::string_view name;
  std::vector<ParameterValue> parameters;
  std::vector<bool> length;  ///< whether a parameter is one; the others are numbers that give the shape
  /// Values of all parameters at which the linear start evaluates ∂P/∂p_k. Where P is linear in the
  /// lengths, only the shape parameters matter; without any, one entry is enough.
  std::vector<std::vector<double>> starts;
  /// Position and derivatives of the surface with these parameters at each uv. Blocks have room for all of
  /// them.
  std::function<void(const double* parameters, std::span<const Vec2<double>> uvs, UvBlock& block)> evaluate;

  /// For each parameter, the length to which the linear start ties it, in the ratio of `starts`; itself if it
  /// is not tied. Needed where P is linear only in several lengths together, such as height and semi_axis_z
  /// of the one-sheet hyperboloid.
  std::vector<int> tied_to{};
  std::array<Coordinate, 2> coordinates{};  ///< what u and v are
  std::vector<bool> may_be_zero{};          ///< whether the surface is of this kind with 0 for a parameter

  int parameter_count() const { return static_cast<int>(parameters.size()); }
  /// Whether positions are linear in the parameters: all are lengths, and none is tied.
  bool linear() const;
  /// Whether the k-th parameter, over the size of the points, has shrunk the surface to a line, a point or
  /// another kind. \param rounding of the points, over their size: any length below counts as 0
  bool vanishes(int k, double value, double rounding = 0) const;
};

/// In the order of preference, in which they are tried: a sphere is an ellipsoid too.
const std::vector<UvKind>& uv_kinds();

/// The names of all of them, "plane, disk, ...", for messages.
std::string uv_kind_names();

/// A known surface of unknown placement and scale: its one length multiplies all of it.
UvKind rigid_kind(const AnySurface& surface);

/// The kind of that name; null if there is none.
const UvKind* find_uv_kind(std::string_view name);

}  // namespace darboux
