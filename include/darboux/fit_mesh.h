/// \file fit_mesh.h
/// Finds the surface a mesh was made from, from its positions and uvs, with Ceres. Target darboux::fit.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/error.h>
#include <darboux/fit_points.h>
#include <darboux/mesh.h>
#include <darboux/placed_surface.h>

namespace darboux {

/// A mesh with too little to tell one surface from another: fewer than four usable vertices, no extent, no
/// uvs.
class UndeterminedError : public MeshError {
  using MeshError::MeshError;
};

/// A surface counts as the mesh's when the rms distance of the positions from it, at their own uv, is at most
/// this share of the bounding box's diagonal.
inline constexpr double fits_below = 1e-4;

/// How the stored uvs lie on a fitted surface.
enum class UvChart {
  own,        ///< they are the surface's own, through surface.uv
  projected,  ///< an affine map into a plane, from which the surface is seen along one direction:
              ///< MeshFit::projection
  unknown,    ///< they are others, or there are none
};

/// A surface fitted to a mesh. Its covariance is empty where it does not fit.
struct MeshFit : SurfaceUncertainty {
  PlacedSurface surface;
  UvChart chart = UvChart::own;
  /// Of a projected chart: P(u, v) = O + a u + b v + s(u, v) d, columns a, b and the unit d, in the mesh's
  /// space.
  Eigen::Matrix3d projection = Eigen::Matrix3d::Zero();
  /// Of |position - surface(uv)| over the referenced vertices, in the mesh's units; of their distances from
  /// the surface where the chart is not its own.
  double rms = 0;
  double rms_relative = 0;  ///< rms over the bounding box's diagonal
  /// Left of one coordinate, in the mesh's units: sqrt(Σ |distance|² / (3 vertices - unknowns)). 0 where
  /// nothing fits.
  double sigma = 0;
  bool fits = false;  ///< within the limit of its fit, and Ceres converged or roundings leave as much
  std::vector<std::string_view> equivalent{};  ///< other uv conventions that fit as well
  int iterations = 0;                          ///< of Ceres
};

/// Fits a surface of known kind: proper rigid placement (det +1), the parameters not fixed, and the uv
/// convention. The first of uv_conventions() that fits is taken; where none does, and no other kind fits
/// under one either, an affine map of the stored uvs, named "affine", if with it the rms is below
/// fits_below / 100; else the best of what was tried. Both limits are at least 1.5 times the rms distance
/// that roundings of positions and uvs to floats, or to Mesh::half_steps, leave; those of uvs count up to
/// 10 fits_below. (fit_any_surface() has the plain limits.) Start in closed form from least squares on
/// P = O + sum_k A_k ∂P/∂p_k(u, v), linear in O and the A_k; then Ceres minimises the sum of squared
/// distances over at most 2048 vertices at random; what fits these is refined on all vertices. Scale and
/// offset of the data do not matter. Method: docs/theory/fit-with-uvs.md. A kind that is not among
/// fitted_kinds() is taken as exact (the next overload), with default values for parameters that are not
/// given. \param kind name, with the parameters that are held fixed \param placement held fixed when given
/// \throws ParameterError for an unknown kind or parameter, or a placement that is not rigid;
/// UndeterminedError; MeshError when the mesh is inconsistent, or the positions do not follow the uvs at all
MeshFit fit_surface(const Mesh& mesh, const SurfaceSpecification& kind,
                    const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// The same of a surface whose parameters are all known, of any kind, from a file too: its placement and the
/// uv convention: of those that fit, the first whose n is on the side of the mesh's normals, or else of its
/// triangles. \throws as above
MeshFit fit_surface(const Mesh& mesh, const AnySurface& exact,
                    const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// Recognises a surface from the positions alone, the first of found_kinds() by fit_points() that fits, and
/// whether the uvs, where there are any, are a projection: what an affine map of them leaves of the positions
/// lies along one direction, up to fits_below of the bounding box's diagonal. A kind fits where the rms
/// distance of all vertices is at most fits_below of that diagonal and none ten times as far. 1024 vertices
/// are fitted, all are held against it. Cost: some 50 ms, and 1 µs per vertex. \param kind no other than
/// this, with the parameters that are given; nothing where it is not of found_kinds() \param placement held
/// when given \throws MeshError when the mesh is inconsistent
std::optional<MeshFit> fit_positions(const Mesh& mesh,
                                     const std::optional<SurfaceSpecification>& kind = std::nullopt,
                                     const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// The truth at each vertex by a surface that fits. Of a chart that is the surface's own: truth_at(), unknown
/// where all triangles of the vertex lack area, in space or uv, so that its uv need not name its place. Else
/// at the position's foot: for a projected chart with t = unit(a - d (n·a) / (n·d)), b likewise; for an
/// unknown one t and b are NaN, with infinite deviation. Cost: about 1 µs per vertex.
/// \throws ParameterError for a fit without a covariance; MeshError when the mesh is inconsistent, or lacks
/// the uvs of the fit's chart
std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit);

/// The truth at a stored uv, as fit.surface.truth(), with its standard deviations, to first order in δ. They
/// take what is left of the positions for independent noise: a mesh that strays from the surface in waves
/// knows it less well than this says. Infinite where first order fails, as in UncertainFrame. Cost: below 1
/// us for most kinds, at most 10 us. \throws ParameterError for a fit without a covariance
Truth truth_at(const MeshFit& fit, const Vec2<double>& stored);
/// The same at many. Cost: two thirds of that each.
std::vector<Truth> truths_at(const MeshFit& fit, std::span<const Vec2<double>> stored);

/// The kinds of surface that can be fitted, in the order in which they are tried.
const std::vector<std::string_view>& fitted_kinds();

/// Fits the fitted_kinds() in order and returns the first that fits, under the plain conventions first, then
/// with affine uvs: plane, disk, sphere, cylinder, cone, torus, ellipsoid, then elliptic-paraboloid,
/// hyperbolic-paraboloid, one-sheet-hyperboloid, two-sheet-hyperboloid, helicoid, catenoid, moebius-strip,
/// klein-bottle, enneper. When none does, the best of them, `fits` false. About 10 passes over the vertices
/// where one fits.
MeshFit fit_any_surface(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

}  // namespace darboux
