/// \file fit_mesh.h
/// Recovers the surface from which a mesh was made, from its positions and uvs, with Ceres. Target
/// darboux::fit.
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

/// A mesh that does not determine a surface: fewer than four usable vertices, no extent, or no uvs.
class UndeterminedError : public MeshError {
  using MeshError::MeshError;
};

/// A surface fits a mesh if the rms distance between the positions and the surface points at their uvs is at
/// most this share of the bounding box diagonal.
inline constexpr double fits_below = 1e-4;

/// How the stored uvs relate to a fitted surface.
enum class UvChart {
  own,        ///< they are coordinates of the surface, through surface.uv
  projected,  ///< a parallel projection of the surface onto a plane, up to an affine map: MeshFit::projection
  unknown,    ///< anything else, or there are no uvs
};

/// A surface fitted to a mesh. The covariance is empty if it does not fit.
struct MeshFit : SurfaceUncertainty {
  PlacedSurface surface;
  UvChart chart = UvChart::own;
  /// For a projected chart P(u, v) = O + a u + b v + s(u, v) d: the columns a, b and the unit vector d, in
  /// the local space of the mesh.
  Eigen::Matrix3d projection = Eigen::Matrix3d::Zero();
  /// Root mean square of |position - surface(uv)| over the vertices used by triangles, in the units of the
  /// mesh. If uv_chart is not `own`, that of the distances from the surface.
  double rms = 0;
  double rms_relative = 0;  ///< rms / diagonal of the bounding box
  /// Residual standard deviation per coordinate, in the units of the mesh: sqrt(Σ |distance|² / (3 vertices
  /// - unknowns)). 0 if nothing fits.
  double sigma = 0;
  bool fits = false;  ///< rms within the limit, and Ceres converged or the residual is at rounding level
  std::vector<std::string_view> equivalent{};  ///< other uv conventions that fit equally well
  int iterations = 0;                          ///< of Ceres
};

/// Fits a surface of known kind: its proper rigid placement (det +1), the parameters that are not fixed, and
/// the uv convention. The first of uv_conventions() that fits is used. If none fits, and no other kind fits
/// under one either, an affine map of the stored uvs, named "affine", is used if its rms is below fits_below
/// / 100. Otherwise the best attempt is returned. Both limits are at least 1.5 times the rms distance caused
/// by rounding of positions and uvs to floats, or to Mesh::half_steps; rounding of uvs counts up to 10
/// fits_below. (If assess() finds a surface by uvs, the plain limits hold.) The initial guess is in closed
/// form: linear least squares on P = O + sum_k A_k ∂P/∂p_k(u, v) for O and the A_k. Ceres then minimises
/// the sum of squared distances over at most 2048 random vertices; if these fit, the result is refined on all
/// vertices. The fit is invariant under scaling and translation. Method: docs/theory/fit-with-uvs.md. A kind
/// that is not in fitted_kinds() is not fitted but used as exact (the next overload), with default values for
/// parameters that are not given. \param kind name, with the parameters to be held fixed \param placement if
/// given, held fixed \throws ParameterError for an unknown kind or parameter, or a placement that is not
/// rigid; UndeterminedError; MeshError if the mesh is inconsistent, or the positions are unrelated to the uvs
MeshFit fit_surface(const Mesh& mesh, const SurfaceSpecification& kind,
                    const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// The same for a surface whose parameters are all known, of any kind, including surfaces from files: fits
/// only the placement and the uv convention. Of the conventions that fit, the first is used whose n agrees
/// with the normals of the mesh or, without normals, with its triangles. \throws as above
MeshFit fit_surface(const Mesh& mesh, const AnySurface& exact,
                    const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// Recognises a surface from the positions alone: the first of found_kinds() that fits, by fit_points(). If
/// there are uvs, also detects whether they are a parallel projection: whether the positions minus an affine
/// map of the uvs lie along one direction, up to fits_below of the bounding box diagonal. A kind fits if the
/// rms distance of all vertices is at most fits_below of that diagonal and no vertex is ten times as far. The
/// fit uses 1024 vertices, the test all. Cost: some 50 ms, plus 1 µs per vertex. \param kind the only kind
/// to try, with the given parameters; the result is empty if it is not in found_kinds() \param placement if
/// given, held fixed \throws MeshError if the mesh is inconsistent
std::optional<MeshFit> fit_positions(const Mesh& mesh,
                                     const std::optional<SurfaceSpecification>& kind = std::nullopt,
                                     const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// The truth at each vertex, from a surface that fits. If uv_chart is `own`, it is truth_at(); it is unknown
/// if all triangles of the vertex lack area in space or uv, since its uv may then belong to another position.
/// Otherwise it is the truth at the foot point of the position: for a projected chart t = unit(a - d (n·a) /
/// (n·d)), and b likewise; for an unknown chart t and b are NaN with infinite deviation. Cost: about 1 µs
/// per vertex.
/// \throws ParameterError for a fit without a covariance; MeshError if the mesh is inconsistent, or lacks the
/// uvs that uv_chart requires
std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit);

/// The truth at a stored uv, as fit.surface.truth(), with its standard deviations to first order in δ. The
/// deviations assume that the residuals of the positions are independent. They are too small for a mesh with
/// smooth, correlated residuals. They are infinite where first order fails, as in UncertainFrame. Cost: below
/// 1 us for most kinds, at most 10 us. \throws ParameterError for a fit without a covariance
Truth truth_at(const MeshFit& fit, const Vec2<double>& stored);
/// The same for many uvs. Cost: two thirds of that per uv.
std::vector<Truth> truths_at(const MeshFit& fit, std::span<const Vec2<double>> stored);

/// The kinds of surface that can be fitted, in the order in which they are tried: plane, disk, sphere,
/// cylinder, cone, torus, ellipsoid, then elliptic-paraboloid, hyperbolic-paraboloid, one-sheet-hyperboloid,
/// two-sheet-hyperboloid, helicoid, catenoid, moebius-strip, klein-bottle, enneper.
const std::vector<std::string_view>& fitted_kinds();

}  // namespace darboux
