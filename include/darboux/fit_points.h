/// \file fit_points.h
/// Fits a surface to sampled points: its parameters and placement, and so the frame at every point, with
/// uncertainties. Target darboux::fit. Method and derivations: docs/theory/fit.md.
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
  std::string surface = "auto";  ///< the kind; auto: the one of found_kinds() that explains the points best
  std::optional<double>
      noise{};  ///< standard deviation of each coordinate, > 0, in the units of the points; empty: estimated
  bool with_uv = false;  ///< model each point as surface(uv) + noise, with one uv convention for all points
  std::optional<PlacedSurface> guess{};    ///< tried beside the starts that the points give;
                                           ///< of the kind named, of any with uvs and `auto`
  std::uint64_t seed = 1;                  ///< of the random samples; equal points and seed give equal bits
  std::function<void(double)> progress{};  ///< called from this thread with the share done, in [0, 1]; 1 last
};

struct StandardError {
  /// What the standard error belongs to. A surface parameter, unless it only bounds the patch. "axis_deg":
  /// the angle of the placement's z (the axis or the normal), as the root of the summed variances in two
  /// directions; not for a sphere. "centre": the placement's translation, as the root of the summed variances
  /// in three directions (cylinder: perpendicular to the axis; plane: along the normal).
  std::string name;
  double value;  ///< in the units of the points, degrees for axis_deg
};

/// The confidence interval of a number, at the level PointFit::level.
struct ConfidenceInterval {
  std::string name;  ///< a parameter, "axis_deg" or "centre", as for the standard errors
  /// In the units of the number. The interval of a parameter encloses the fitted value. Those of axis_deg and
  /// centre run from 0 to a bound on the deviation of the fitted axis or centre from the true one.
  double low, high;
};

/// A candidate surface: the best of its kind. For the chosen kind also others that explain part of the points
/// equally well.
struct FitCandidate {
  std::string name;
  double bic =
      0;  ///< Bayesian information criterion, smaller is better; comparable among the candidates of one fit
  double rms = 0;  ///< root mean square distance of the inliers, in the units of the points
};

/// The uncertainty of a fitted surface.
struct SurfaceUncertainty {
  /// The symmetric covariance matrix of the error δ = (ω, τ, δp). The fitted surface is the true one
  /// after the motion x -> centre + exp(ω) (x - centre) + τ, with ω in radians and τ in the units of the
  /// points, both along the axes of the points' space; δp are the errors of the parameters, in their order.
  /// The variance is zero for what is fixed by convention: degrees of freedom that a symmetry leaves
  /// undetermined, lengths that only bound the patch, and values that were held fixed. If the uv map of a
  /// mesh was estimated, the six numbers of UvConvention::affine follow. If the noise of points was
  /// estimated, the matrix is multiplied by 2 F(2, ν) / χ²(2) at 95 %, ν the degrees of freedom
  /// (docs/theory/fit.md), so that its ellipse covers normals at that level; frames and normal_deg use it as
  /// it is. The confidence intervals have factors of their own.
  Eigen::MatrixXd covariance;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

/// The result of a fit. Only a usable fit has a surface.
struct PointFit : SurfaceUncertainty {
  bool usable = false;
  std::string reason;  ///< one line: why the fit is usable or not, and what would help
  std::optional<PlacedSurface>
      surface;  ///< lengths that only bound the patch (height, width, depth) enclose the inliers
  /// Standard deviation of the noise per coordinate, in the units of the points. If estimated, the divisor is
  /// the number of inliers minus the number of unknowns.
  double sigma = 0;
  double rms = 0;  ///< root mean square distance of the inliers
  std::size_t inliers = 0, outliers = 0;
  std::size_t ignored = 0;      ///< points that are not finite: neither inliers nor outliers
  std::vector<bool> is_inlier;  ///< one entry per point
  bool mirrored = false;        ///< with uvs: the points follow the mirrored surface; not usable then
  std::vector<StandardError> standard_errors;
  std::vector<ConfidenceInterval> intervals;  ///< one per standard error
  /// How the intervals were computed. "t": from the standard errors by Student's t (axis_deg and centre: F),
  /// with estimated sigma. "linear": the same for known noise. Empty: there are none.
  std::string_view interval_method;
  double level = 0.95;                   ///< confidence level of the intervals
  std::vector<FitCandidate> candidates;  ///< the chosen one, then the others, best first
  int iterations = 0;                    ///< iterations of Ceres, over all candidates
  double seconds = 0;
};

/// The kinds that can be fitted without a guess and without uvs: plane, sphere, cylinder, cone,
/// elliptic-paraboloid (with equal semi-axes: a paraboloid of revolution), torus, ellipsoid.
const std::vector<std::string_view>& found_kinds();

/// Fits a surface to points. Most points lie on the surface up to isotropic Gaussian noise of unknown size;
/// the others may lie anywhere. No initial guess is needed. The estimate maximises the likelihood of the
/// orthogonal distances d under a mixture of inliers N(σ² H, σ²) and outliers of locally constant
/// density; H = (k1 + k2) / 2 is the mean curvature, which shifts the mean distance. The optimiser is Ceres.
/// The fit is invariant under scaling and translation: points are centred and scaled first. Points at the
/// same position count once. For found_kinds(), without uvs: a clump (a tenth to two thirds of the points, in
/// a small ball) is excluded, and named in `reason`, if the other points determine a surface that does not
/// contain the clump. The points of a plane are excluded likewise if another kind was named, without a guess;
/// if no fit to all points is usable; and if at least half of the other points lie on a surface of that kind
/// with at most 1.5 times the noise of the plane. That costs two more fits.
///
/// The noise is assumed to be at least half the coarsest rounding detected in the coordinates (to floats, to
/// three to twelve decimals, or to four to twelve significant digits, in floats up to eight). If the noise is
/// no larger than that, the standard errors assume equal rounding errors at all points.
///
/// Gauge of a surface with symmetries (docs/theory/fit.md): the largest component of the axis is positive;
/// the axis of a cone points from base to apex. The origin of u is the projection of the world axis x, y or z
/// that is least parallel to the axis; of equals, the first. Cost: linear in the points.
///
/// auto chooses the kind with the smallest Bayesian information criterion [Schwarz1978]. All kinds are
/// compared with the noise, outliers and inliers of the likeliest one. The chosen kind must explain two
/// fifths of the points. Every other kind must be less likely by odds of exp(5), or be held by the points
/// near a limit in which it degenerates to the chosen kind, as a cone of small half-angle does to a cylinder.
/// Otherwise the fit is not usable ("undetermined: ..."). Nor is it usable if a kind that did not converge or
/// is not determined scores better, or if the distances of neighbouring points are correlated (the points lie
/// on another surface). Self-intersecting tori are not considered. A named kind may be any of the catalogue,
/// except those without parameters, those with more than 12, and the superellipsoid. Kinds that are not in
/// found_kinds() are fitted starting from their default proportions; so is elliptic-paraboloid when named,
/// whose semi-axes may then differ.
///
/// Convergence: the next step of Ceres towards the root of the gradient of the likelihood must move the
/// surface by at most 1e-9 of its standard error, or by less than rounding does. If there is no such root
/// nearby, a step of weighted least squares must move it by at most 1e-6 of its standard error.
///
/// A fit is not usable, and `reason` says why, if it has not converged or if there are - no more distinct
/// points than the surface has unknowns (plane 3, sphere 4, cylinder 5, cone and elliptic-paraboloid 6, torus
/// 7, ellipsoid 9), which are always fitted exactly; or only points on a line - a radius below 5 sigma, a
/// torus whose two sheets are both within the noise, or no more inliers than
///   chance has
/// - two surfaces of the kind that explain the points equally well, "undetermined: torus of ... or of ..."
/// - a motion of the surface that the points do not determine, or a length or angle whose standard error may
///   exceed a fifth of its value, beyond which intervals of a linear model do not hold
/// - a length outside 1e-3 to 1e3 times the size of the points (their median distance from their median)
/// - points of a size outside 1e-152 to 1e152
///
/// \throws ParameterError for an unknown kind, a noise that is not positive, a guess of another kind or not
/// finite; MeshError if an attribute has another length than positions, or for with_uv without uvs. Points
/// that do not determine a surface do not throw: the fit is not usable, and `reason` says why.
PointFit fit_points(const PointCloud& points, const PointFitOptions& options = {});

/// A frame of a fitted surface with its uncertainty.
struct UncertainFrame {
  Vec2<double> uv;        ///< of the surface
  Vec3<double> position;  ///< on the surface
  Vec3<double> t, b, n;   ///< orthonormal, in the points' space
  Status status;
  /// Covariance of the rotation vector (radians) that takes the true frame to this one, in the axes t, b, n,
  /// to first order in δ. If n is known but t is not: the covariance of the rotations about t and b,
  /// infinite variance about n, and zero covariance with n. If n is not known: infinite on the diagonal, zero
  /// elsewhere.
  Eigen::Matrix3d covariance;
  double normal_deg = 0;   ///< standard deviation of the angle of n: sqrt(var t + var b); infinite: see below
  double tangent_deg = 0;  ///< the same for t: sqrt(var b + var n); infinite: see below
  // First order fails, and t is not known, if three standard deviations change dpdu by its own length or
  // more: the point is a pole of the chart, or may be one. n is not known if three standard deviations turn
  // it by a radian; if p is a focal point of the surface; or if such a pole is a point without normal (an
  // apex).
};

/// The frame at the surface point nearest to p, where p is exact and the surface uncertain. Cylinders, cones
/// and planes are unbounded, except for a cone at its apex. Cost: below 1 us for found_kinds() (ellipsoid:
/// 1.2 us), about 10 us for others. \throws ParameterError for a fit without a surface, or if the size of its
/// covariance is not 6 + the number of parameters
UncertainFrame frame_near(const PointFit& fit, const Vec3<double>& p);

/// The same for any surface with a known uncertainty.
UncertainFrame frame_near(const PlacedSurface& placed, const SurfaceUncertainty& uncertainty,
                          const Vec3<double>& p);

/// The frame at (u, v) of the surface, which are exact. The uv convention of the placed surface is not
/// applied. \throws ParameterError as frame_near()
UncertainFrame frame_at(const PointFit& fit, const Vec2<double>& uv);

}  // namespace darboux
