/// \file stability.h
/// Numerical stability: how errors, in units of roundoff, grow as a problem becomes harder. For each route
/// there is a curve of errors with bounds and condition numbers. Target darboux::fit.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>

namespace darboux {

/// What is evaluated: surfaces at points, methods on meshes, fits to points.
enum class StabilityDomain : std::uint8_t { evaluation, meshes, fits };

/// A parameter x that makes a problem harder: from `from`, where it is easy, to `to`, on a logarithmic scale.
struct StabilitySweep {
  std::string_view name, unit, summary;
  double from, to;
  StabilityDomain domain = StabilityDomain::evaluation;
};
/// Of evaluation: pole_distance, seam_distance, edge_distance, knot_distance, scale, aspect, offset, turns,
/// uv_scale, uv_shift, condition, weights. Of meshes: float_offset, quantisation, uv_quantisation,
/// normal_quantisation, jitter, slivers. Of fits: points, outliers, coverage, noise.
std::span<const StabilitySweep> stability_sweeps();
/// \throws ParameterError listing the known names
const StabilitySweep& find_stability_sweep(std::string_view name);

/// The quantities that are compared, by their names in JSON; each is the worst of several members.
inline constexpr std::array<std::string_view, 10> stability_quantities{
    "position",           // P
    "partials",           // dpdu, dpdv
    "second_partials",    // d2pdu2, d2pduv, d2pdv2
    "frame",              // tangent, bitangent, normal
    "curvatures",         // gaussian, mean, principal curvatures and directions
    "forms",              // first and second form, derivatives of the normal, Christoffel symbols
    "mesh_tangents",      // t at the corners of a mesh
    "mesh_normals",       // n there, of methods that make it
    "fitted_parameters",  // of a closed surface fitted to points
    "fitted_frames"};     // its normals

/// A point at which a route is evaluated.
struct StabilityPoint {
  const AnySurface& surface;
  double u, v;
  std::array<double, 2> length;  ///< over which the surface varies like a whole turn along u, v: for steps
};

/// The result of a route; quantities that it does not compute are absent.
struct StabilityAnswer {
  std::array<std::optional<Vec3<double>>, 6> partials;  ///< in the order of Jet2
  std::array<double, 6> estimate{};                     ///< the route's own error estimate of each
  std::optional<Frame<double>> frame;                   ///< n on the side of the surface's own frame
  /// K; H; κ1, κ2; both directions; dndu; dndv; E, F, G; L, M, N; the Christoffel symbols. Empty: not said.
  std::array<std::vector<double>, 9> forms;
};

/// The bound that a route's errors should satisfy.
enum class StabilityBound : std::uint8_t {
  stated,    ///< the bound that `darboux check` tests
  dual,      ///< 16u (1 + condition)
  estimate,  ///< four times the route's own estimate, and 8u (1 + condition)
  none       ///< no bound: errors are shown relative to Darboux's bound
};

/// A method that computes the quantities at (u, v).
struct StabilityRoute {
  std::string_view name, summary;
  StabilityBound bound;
  double roundoff;  ///< u: 2^-53, or 2^-24 where points and parameters are rounded to float first
  StabilityAnswer (*answer)(const StabilityPoint&);  ///< of evaluation alone
  StabilityDomain domain = StabilityDomain::evaluation;

  bool own() const { return bound != StabilityBound::none; }
};
/// double, float, naive, dual, central2, central4, central6, central8, ridders; the methods of
/// frame_methods(), for meshes; fit.
std::span<const StabilityRoute> stability_routes();
/// \throws ParameterError listing the known names
const StabilityRoute& find_stability_route(std::string_view name);

/// An error as a function of x, with its bound and its condition, all in the same unit.
///
/// Evaluation: the error is in units of the route's roundoff, relative to the scale of the quantity. The
/// scale of a partial is its largest magnitude over the surface, or its own magnitude if that is larger; that
/// of a frame is 1; that of curvatures and forms is the quantity itself. The condition is the relative change
/// of the result over a relative change of all inputs.
///
/// Meshes: the error is the angle between what a method makes of the rounded mesh and of the exact mesh, in
/// units of half the step to which the data are rounded. The bound is 16 times the condition. The condition
/// is the size of what is rounded over the lowest altitude of a triangle. For uvs, also if a method itself
/// rounds them to float, the altitude is that in uv, and the condition is multiplied by the stretch: the
/// ratio of the greatest to the least length in space of directions that are unit in uv. For methods that
/// take normals the condition is divided by the squared least cosine between a triangle and its normals. No
/// bound is stated for polynomials through many vertices. In the sweeps jitter and slivers the error is the
/// angle to the truth in units of the mesh width, without a bound.
///
/// Fits: the error is in units of the standard error that the fit states, and the bound is 6. The condition
/// is that standard error over the parameter, or in radians. Fits that are not usable have no values.
struct StabilityCurve {
  std::string surface;  ///< as AnySurface::specification() writes it
  std::string_view sweep, route, quantity;
  bool own;  ///< the route has a bound to keep
  /// For each x, the values at the point and member with the largest error / bound. An infinite error means
  /// that there was no finite result; a NaN bound, that no bound is stated there.
  std::vector<double> x, error_u, condition, bound_u;
  bool within_bound = true;
  struct Worst {
    double x = 0, error_u = 0, bound_u = 0, condition = 0;
    double factor = 0;    ///< error / bound
    std::string member;   ///< "normal"
    double u = 0, v = 0;  ///< of the surface named
    std::string surface;  ///< as it was there
  } worst;                ///< where error / bound is largest

  bool holds() const { return within_bound || !own; }
};

struct StabilityOptions {
  std::vector<AnySurface> surfaces;
  std::vector<const StabilitySweep*> sweeps;
  std::vector<const StabilityRoute*> routes;
  int points = 24;  ///< values of x in each sweep, from..to; a third of that of meshes and fits
  int samples = 3;  ///< random points at each
  std::uint64_t seed = 1;
};

/// A piece of the work: one surface, one sweep.
struct StabilityJob {
  std::size_t surface, sweep;  ///< places in the options
};
/// All that apply: a plane has no pole. \throws ParameterError when points < 2 or samples < 1
std::vector<StabilityJob> stability_jobs(const StabilityOptions& options);
/// Its curves. Depends on the options and the job alone; jobs may run on several threads at once.
std::vector<StabilityCurve> run_stability_job(const StabilityOptions& options, const StabilityJob& job);

/// All of it. \param progress called with the share done, in [0, 1]
std::vector<StabilityCurve> stability(const StabilityOptions& options,
                                      const std::function<void(double)>& progress = {});

}  // namespace darboux
