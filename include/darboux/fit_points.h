/// \file fit_points.h
/// Recovers a surface, its placement and so the frame at every point from sampled points, with its
/// uncertainty. Target darboux::fit. The method and its laws: docs/theory/fit.md.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <darboux/placed_surface.h>
#include <darboux/point_cloud.h>

namespace darboux {

struct PointFitOptions {
  std::string surface = "auto";  ///< the kind; auto: whichever of found_kinds() explains the points best
  std::optional<double>
      noise{};  ///< standard deviation of each coordinate, > 0, in the units of the points; none: estimated
  bool with_uv = false;  ///< take each point as surface(uv) + noise, with one uv convention for all points
  std::optional<PlacedSurface> guess{};    ///< tried beside the starts that the points give;
                                           ///< of the kind named, of any with uvs and `auto`
  std::uint64_t seed = 1;                  ///< of the random samples: same points, same seed, same bits
  std::function<void(double)> progress{};  ///< called from this thread with the share done, in [0, 1]; 1 last
};

struct StandardError {
  /// A parameter of the surface that does not only bound the patch; "axis_deg": angle of the placement's z,
  /// the axis or the normal, the root of the sum of its variances in two directions (not for a sphere);
  /// "centre": the root of the sum of the variances of the placement's translation in three directions
  /// (cylinder: across the axis; plane: along the normal).
  std::string name;
  double value;  ///< in the units of the points, degrees for axis_deg
};

/// Where a number lies with the probability PointFit::level.
struct ConfidenceInterval {
  std::string name;  ///< a parameter's, "axis_deg" or "centre", as in the standard errors
  /// In its own units. A parameter's interval lies about the fitted value. Those of axis_deg and centre run
  /// from 0 to a bound: how far the fitted axis or centre is off the true one.
  double low, high;
};

/// A surface that was tried: the best of its kind; for the first kind also others that explain part of the
/// points equally well.
struct FitCandidate {
  std::string name;
  double bic =
      0;  ///< Bayesian information criterion, smaller is better; comparable among the candidates of one fit
  double rms = 0;  ///< root mean square of the inliers' distances, in the units of the points
};

/// How far a fitted surface may be from the true one.
struct SurfaceUncertainty {
  /// The symmetric covariance of δ = (ω, τ, δp): the fitted surface's place and parameters are those of
  /// the true one after x -> centre + exp(ω) (x - centre) + τ, ω in radians, τ in the units of the
  /// points, both along the axes of the points' space; then the parameters in their order. What the points
  /// cannot tell because of a symmetry, lengths that only bound the patch, and what is held, are fixed by
  /// convention: their variance is zero. Where a mesh's uv map was estimated, the six numbers of
  /// UvConvention::affine follow. Where the noise of points was estimated, it is widened by 2 F(2, ν) /
  /// χ²(2) at 95 %, ν the degrees of freedom left (docs/theory/fit.md), so that normals stay within its
  /// ellipse at that level; frames and normal_deg take it as it is. The intervals of numbers have their own
  /// factors.
  Eigen::MatrixXd covariance;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

/// What a fit found. Only a usable one has a surface.
struct PointFit : SurfaceUncertainty {
  bool usable = false;
  std::string reason;  ///< one line: why it is usable or not, and what would help
  std::optional<PlacedSurface>
      surface;  ///< lengths that only bound the patch (height, width, depth) enclose the inliers
  /// Noise of one coordinate, in the units of the points; where it is estimated, over the inliers less the
  /// unknowns.
  double sigma = 0;
  double rms = 0;  ///< root mean square of the inliers' distances
  std::size_t inliers = 0, outliers = 0;
  std::size_t ignored = 0;      ///< points that are not finite, counted in neither
  std::vector<bool> is_inlier;  ///< one entry per point
  bool mirrored = false;        ///< with uvs: they follow the mirror image of the surface; not usable then
  std::vector<StandardError> standard_errors;
  std::vector<ConfidenceInterval> intervals;  ///< one for each standard error
  /// How they were found: "t", from the standard errors by Student's t (axis_deg and centre: F), sigma being
  /// estimated; "linear", the same where the noise is known; empty where there are none.
  std::string_view interval_method;
  double level = 0.95;                   ///< of the intervals
  std::vector<FitCandidate> candidates;  ///< the chosen one first, then best first
  int iterations = 0;                    ///< of Ceres, over all candidates
  double seconds = 0;
};

/// The kinds that are found without a guess and without uvs: plane, sphere, cylinder, cone,
/// elliptic-paraboloid (with equal semi-axes: a paraboloid of revolution), torus, ellipsoid.
const std::vector<std::string_view>& found_kinds();

/// Fits a surface to points, most of which lie on it up to isotropic Gaussian noise of unknown size; the
/// others may lie anywhere. No start is needed. The estimate is that of maximum likelihood over orthogonal
/// distances d for a mixture of inliers N(σ² H, σ²) and outliers of locally constant density, H = (k1 +
/// k2) / 2 the curvature that moves the mean distance, found by Ceres. The size and the place of the points
/// do not matter: they are centred and scaled first. Points at one place count once in the estimate. For
/// found_kinds(), without uvs: a clump (a tenth to two thirds of the points, in a small ball) is left out,
/// and named in `reason`, where the other points determine a surface that the clump is not on.
/// So is a plane where another kind is named, without a guess: where all points are refused, and at least
/// half of the others lie on a surface of that kind with at most 1.5 times the plane's noise. That costs two
/// more fits.
///
/// The noise is taken to be at least half of the greatest rounding that the coordinates show (that of floats,
/// of three to twelve decimals, of four to twelve significant digits, in floats up to eight). Where there is
/// no more noise than that, standard errors take the roundings to be alike at all points.
///
/// The gauge, where the surface has symmetries (docs/theory/fit.md): the axis points along the positive side
/// of its largest component, a cone's from base to apex; the u origin is the world axis x, y or z least
/// parallel to the axis, in that order, projected. Cost: linear in the points.
///
/// auto takes the kind with the smallest Bayesian information criterion [Schwarz1978]; all kinds are judged
/// with the noise, outliers and inliers of the likeliest one. The chosen kind must have two fifths of the
/// points. Every other kind must be less likely by odds of exp(5), or the points must hold it near a limit in
/// which it is the chosen kind, as a cone of small half-angle beside a cylinder. Otherwise the fit is not
/// usable ("undetermined: ..."). Nor is it usable if a kind that did not converge or is not determined does
/// better, or if the distances of neighbouring points are correlated (another surface). A torus that crosses
/// itself is not among the choices. A named kind may be any of the catalogue, except those without
/// parameters, those with more than 12, and the superellipsoid. Kinds that are not in found_kinds() are
/// fitted from their default proportions; so is elliptic-paraboloid, whose semi-axes may then differ.
///
/// The fit has converged when the next step of Ceres towards the root of the likelihood's gradient moves the
/// surface by at most 1e-9 of its standard error, or by less than rounding does. Where there is no such root
/// nearby, weighted least squares must move it by at most 1e-6 of its standard error.
///
/// A fit is not usable, with the reason, where it has not converged or where there are
/// - fewer different points than one more than a surface has unknowns (plane 3, sphere 4, cylinder 5, cone
///   and elliptic-paraboloid 6, torus 7, ellipsoid 9; that many are always fitted exactly), or points on a
///   line
/// - a radius below 5 sigma, a torus whose two sheets are both within the noise, or no more inliers than
///   chance has
/// - two surfaces of the kind that explain the points equally well, "undetermined: torus of ... or of ..."
/// - a movement of the surface that the points do not identify, or a length or angle whose standard error
///   may be above a fifth of it: intervals of a linear model hold below
/// - a length beyond 1e-3 to 1e3 of the points' size (their median distance from their median)
/// - points of a size beyond 1e-152 to 1e152
///
/// \throws ParameterError for an unknown kind, a noise that is not positive, a guess of another kind or not
/// finite; MeshError for attributes of another length than positions, or with_uv without uvs. Points that do
/// not determine a surface give a fit that is not usable, and say why.
PointFit fit_points(const PointCloud& points, const PointFitOptions& options = {});

/// A frame of a fitted surface with its uncertainty.
struct UncertainFrame {
  Vec2<double> uv;        ///< of the surface
  Vec3<double> position;  ///< on the surface
  Vec3<double> t, b, n;   ///< orthonormal, in the points' space
  Status status;
  /// Covariance of the rotation vector (radians) that takes the true frame to this one, in the axes t, b, n,
  /// to first order in δ. Where n is known and t is not, that of the turns about t and b, infinite about n,
  /// the others zero; where n is not known, infinite on the diagonal and zero beside it.
  Eigen::Matrix3d covariance;
  double normal_deg = 0;   ///< standard deviation of the angle of n: sqrt(var t + var b); infinite: see below
  double tangent_deg = 0;  ///< the same for t: sqrt(var b + var n); infinite: see below
  // First order fails, and t is not known, where three standard deviations change dpdu by its own length or
  // more: a pole of the chart is within reach, or this is one. n is not known where three standard deviations
  // turn it by a radian, where p is a focal point of the surface, and where such a pole is a point without
  // normal (an apex).
};

/// The frame at the surface point nearest to p: p is fixed, the surface uncertain. A cylinder, cone and plane
/// do not end, but for the cone at its apex. Cost: below 1 us for found_kinds() (ellipsoid: 1.2 us), about 10
/// us for others. \throws ParameterError for a fit without a surface, or whose covariance has another size
/// than 6 + parameters
UncertainFrame frame_near(const PointFit& fit, const Vec3<double>& p);

/// The same of any surface that is known to some uncertainty.
UncertainFrame frame_near(const PlacedSurface& placed, const SurfaceUncertainty& uncertainty,
                          const Vec3<double>& p);

/// The frame at the surface's own (u, v), which are held fixed. The placed surface's convention for stored
/// uvs is not applied. \throws ParameterError as frame_near()
UncertainFrame frame_at(const PointFit& fit, const Vec2<double>& uv);

}  // namespace darboux
