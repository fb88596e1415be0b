/// \file fit.h
/// Finds the surface a mesh was made from, from its positions and uvs, with Ceres. Target darboux::fit.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/fit_points.h>
#include <darboux/mesh.h>
#include <darboux/placed_surface.h>

namespace darboux {

/// A surface counts as the mesh's when the rms distance of the positions from it, at their own uv, is at most
/// this share of the bounding box's diagonal.
inline constexpr double fits_below = 1e-4;

/// A surface fitted to a mesh. Its covariance is empty where it does not fit.
struct MeshFit : SurfaceUncertainty {
  PlacedSurface surface;
  double rms = 0;           ///< of |position - surface(uv)| over the referenced vertices, in the mesh's units
  double rms_relative = 0;  ///< rms over the bounding box's diagonal
  /// Left of one coordinate, in the mesh's units: sqrt(Σ |distance|² / (3 vertices - unknowns)). 0 where nothing fits.
  double sigma = 0;
  bool fits = false;                           ///< rms_relative <= fits_below, and Ceres converged
  std::vector<std::string_view> equivalent{};  ///< other uv conventions that fit as well
  int iterations = 0;                          ///< of Ceres
};

/// Fits a surface of known kind: proper rigid placement (det +1), the parameters not fixed, and the uv
/// convention. The first of uv_conventions() that fits is taken; where none does, and no other kind fits under one either, an
/// affine map of the stored uvs, named "affine", if with it the rms is below fits_below / 100; else the best of what was
/// tried. Start in closed form from least squares on P = O + sum_k A_k ∂P/∂p_k(u, v), linear in O and the A_k; then Ceres
/// minimises the sum of squared distances over at most 2048 vertices at random; what fits these is refined on all vertices.
/// Scale and offset of the data do not matter. Method: docs/theory/fit-with-uvs.md.
/// \param kind name, with the parameters that are held
/// \param placement held when given
/// \throws ParameterError for an unknown kind or parameter, or a kind other than those of fitted_kinds(); MeshError without uvs or with fewer than four usable vertices
MeshFit fit_surface(const Mesh& mesh, const SurfaceSpecification& kind,
                    const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

/// The truth at a stored uv, as fit.surface.truth(), with its standard deviations, to first order in δ. They take what is
/// left of the positions for independent noise: a mesh that strays from the surface in waves knows it less well than
/// this says. Infinite where first order fails, as in UncertainFrame. Cost: below 1 us for most kinds, at most 10 us.
/// \throws ParameterError for a fit without a covariance
Truth truth_at(const MeshFit& fit, const Vec2<double>& stored);

/// The kinds of surface that can be fitted, in the order in which they are tried.
const std::vector<std::string_view>& fitted_kinds();

/// Fits the fitted_kinds() in order and returns the first that fits, under the plain conventions first, then with affine uvs:
/// plane, disk, sphere, cylinder, cone, torus, ellipsoid, then elliptic-paraboloid, hyperbolic-paraboloid,
/// one-sheet-hyperboloid, two-sheet-hyperboloid, helicoid, catenoid, moebius-strip, klein-bottle, enneper. When none does, the
/// best of them, `fits` false. About 10 passes over the vertices where one fits.
MeshFit fit_any_surface(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement = std::nullopt);

}  // namespace darboux
