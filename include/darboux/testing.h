/// \file testing.h
/// Tests the laws that every surface must satisfy, on any surface type:
///     EXPECT_EQ(darboux::broken_laws(MySurface{}), "");
/// `darboux check` and the tests apply them to the catalogue. Link darboux::darboux; no test framework is
/// needed.
///
/// Routes, and what each compares the closed form with:
///   dual            automatic differentiation of the position, of dpdu and of dpdv; the closed frame with
///                   that of the partials
///   central2 ... 8  central differences of that order, judged by their own error estimate
///   one_sided8      one-sided differences of order 8 at the edges of non-periodic coordinates
///   ridders         Ridders' extrapolation
///   continuity      position and first partials between neighbouring doubles, by bisection along 32 lines of
///                   constant u and 32 of constant v: finds corners and cliffs above a millionth of the scale
///                   (positions: of the extent), unless the status says crease, or that partials vanish or
///                   are parallel. What is narrower than 1/256 of a line may be missed
///   high_precision  the same formula in 40 digits; the frame by the cross product of its partials, the
///                   status by which of them vanish or are parallel
///   high_precision_float
///                   the same for evaluation in float
///   high_precision_forms
///                   curvatures, directions, derivatives of the normal, forms and Christoffel symbols of
///                   regular points against 40 digits; takes long, and runs only where it is named
///   implicit, curvature, second_formula
///                   the independent facts the surface states; the normal is the gradient of implicit()
///   gauss           K from the derivatives of E, F, G alone (Gauss's theorem) against K from the second form
///   codazzi         the Mainardi-Codazzi equations, which a second form must satisfy
///   gauss_bonnet    ∫ K dA = 2π χ over a closed surface
///   periodicity     P(u + k, v) = P(u, v), bit for bit
/// All routes but the facts differentiate the formula itself, so a consistently wrong formula passes them;
/// only the facts can detect it. A law that does not apply, or a fact that the surface does not state, is
/// returned as skipped, never as passed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>

namespace darboux {

/// How a surface is checked.
struct CheckOptions {
  int points = 1000;                  ///< random (u, v), uniform in the unit square
  std::uint64_t seed = 1;             ///< of std::mt19937_64
  std::vector<std::string> routes{};  ///< only these; empty: all but high_precision_forms
  /// The high_precision routes only. 0: the surface as given. Otherwise this many random sets of parameters
  /// (log-uniform over the magnitudes for which each parameter is proven), with `points` points each
  int parameter_sets = 0;
};

/// The result of one law. Errors and bounds are relative to the scale of the quantity: its largest magnitude
/// over the points (if it vanishes identically, that of the position).
struct Check {
  std::string_view surface, route, quantity;
  int points = 0;        ///< number of values compared
  double max_error = 0;  ///< at the point where error/bound is largest
  double bound = 0;      ///< there
  bool passed = false;
  double worst_u = 0, worst_v = 0;
  std::string worst_surface{};  ///< with its parameters, if they vary
  std::string skipped{};        ///< why nothing was compared; a failure if `passed` is false
};

/// The names of all routes, in the order they run.
const std::vector<std::string_view>& check_routes();

/// Tests every law on a surface. Deterministic for given options. Violations are reported, not thrown.
/// \throws ParameterError for an unknown route, fewer than one point, or fewer than 0 sets
std::vector<Check> check_surface(const AnySurface& surface, const CheckOptions& options = {});

/// One line per violated law: route, quantity, error, bound, location. Empty if all hold.
std::string broken_laws(const AnySurface& surface, const CheckOptions& options = {});

}  // namespace darboux
