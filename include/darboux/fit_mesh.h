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
  /// For a projected chart, P(u, v) = O + a u + b v + s(u, v) d, columns a, b and the unit d, in the mesh's
  /// space.
  Eigen::Matrix3d projection = Eigen::Matrix3d::Zero();
  /// Root mean square of |position - surface(uv)| over the referenced vertices, in the mesh's units. Where
  /// the chart is not the surface's own, that of their distances from the surface.
  double rms = 0;
  double rms_relative = 0;  ///< rms over the bounding box's diagonal
  /// The residual of one coordinate, in the mesh's units: sqrt(Σ |distance|² / (3 vertices - unknowns)). 0
  /// if nothing fits.
  double sigma = 0;
  bool fits = false;  ///< within the limit of its fit, and Ceres converged or roundings leave as much
  std::vector<std::string_view> equivalent{};  ///< other uv conventions that fit as well
  int iterations = 0;                          ///< of Ceres
};

/// Fits a surface of known kind: its proper rigid placement (det +1), the parameters that are not fixed, and
/// the uv convention. The first of uv_conventions() that fits is taken. If none fits, and no other kind fits
/// under one either, an affine map of the stored uvs, named "affine", is taken if its rms is below fits_below
/// / 100. Otherwise the result is the best of what was tried. Both limits are at least 1.5 times the rms
/// distance that rounding of positions and uvs to floats, or to Mesh::half_steps, leaves; rounding of uvs
/// counts up to 10 fits_below. (Where assess() finds a surface by uvs, the plain limits hold.) The
/// start comes in closed form, from least squares on P = O + sum_k A_k ∂P/∂p_k(u, v), linear in O and the
/// A_k. Then Ceres minimises the sum of squared distances over at most 2048 random vertices; what fits these
/// is refined on all vertices. Scale and offset of the data do not matter. Method:
/// docs/theory/fit-with-uvs.md. A kind that is not among fitted_kinds() is taken as exact (the next
/// overload), with default values for parameters that are not given. \param kind name, with the parameters
/// that are held fixed \param placement held fixed when given \throws ParameterError for an unknown kind or
/// parameter, or a placement that is not rigid; UndeterminedError; MeshError when the mesh is inconsistent,
/// or the positions do not follow the uvs at all
MeshFit fit_surface(const Mesh& mesh, const SurfaceSpecification& kind,
                    const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// The same of a surface whose parameters are all known, of any kind, from a file too: its placement and the
/// uv convention: of those that fit, the first whose n is on the side of the mesh's normals, or else of its
/// triangles. \throws as above
MeshFit fit_surface(const Mesh& mesh, const AnySurface& exact,
                    const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// Recognises a surface from the positions alone: the first of found_kinds() that fits, by fit_points(). If
/// there are uvs, also recognises whether they are a projection: the difference between the positions and an
/// affine map of the uvs lies along one direction, up to fits_below of the bounding box's diagonal. A kind
/// fits if the rms distance of all vertices is at most fits_below of that diagonal and no vertex is ten times
/// as far. The fit uses 1024 vertices, the test all. Cost: some 50 ms, and 1 µs per vertex. \param kind the
/// only kind to try, with the parameters given; the result is empty if it is not in found_kinds() \param
/// placement held when given \throws MeshError when the mesh is inconsistent
std::optional<MeshFit> fit_positions(const Mesh& mesh,
                                     const std::optional<SurfaceSpecification>& kind = std::nullopt,
                                     const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// The truth at each vertex by a surface that fits. If the chart is the surface's own: truth_at(), or unknown
/// if all triangles of the vertex lack area in space or uv, as its uv need not name its place then. Otherwise
/// the truth at the position's foot: for a projected chart with t = unit(a - d (n·a) / (n·d)), b likewise;
/// for an unknown chart t and b are NaN, with infinite deviation. Cost: about 1 µs per vertex.
/// \throws ParameterError for a fit without a covariance; MeshError when the mesh is inconsistent, or lacks
/// the uvs of the fit's chart
std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit);

/// The truth at a stored uv, as fit.surface.truth(), with its standard deviations to first order in δ. The
/// deviations assume that the residuals of the positions are independent noise. For a mesh that departs from
/// the surface in waves they are too small. They are infinite where first order fails, as in UncertainFrame.
/// Cost: below 1 us for most kinds, at most 10 us. \throws ParameterError for a fit without a covariance
Truth truth_at(const MeshFit& fit, const Vec2<double>& stored);
/// The same at many. Cost: two thirds of that each.
std::vector<Truth> truths_at(const MeshFit& fit, std::span<const Vec2<double>> stored);

/// The kinds of surface that can be fitted, in the order in which they are tried: plane, disk, sphere,
/// cylinder, cone, torus, ellipsoid, then elliptic-paraboloid, hyperbolic-paraboloid, one-sheet-hyperboloid,
/// two-sheet-hyperboloid, helicoid, catenoid, moebius-strip, klein-bottle, enneper.
const std::vector<std::string_view>& fitted_kinds();

}  // namespace darboux
