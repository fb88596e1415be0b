/// \file local_jets.h
/// Estimates normals, curvatures and partial derivatives of a surface from points alone, with error
/// estimates, by fitting polynomials to the neighbours of a point. Method and derivations:
/// docs/theory/local-jets.md.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <darboux/curvature.h>
#include <darboux/point_cloud.h>
#include <darboux/surface.h>

namespace darboux {

/// A polynomial of degree d in two variables has (d + 1)(d + 2)/2 coefficients.
constexpr std::size_t jet_coefficients(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
}

struct JetOptions {
  int degree = 3;  ///< of the polynomial, 2 to 4
  /// One weight per neighbour, proportional to 1/variance. Empty: equal weights.
  std::span<const double> weights{};
  /// n is oriented so that n · side > 0. If side is zero or perpendicular to n, the largest component of n
  /// (the first of equals) is positive.
  Vec3<double> side{};
  bool u_periodic = false, v_periodic = false;  ///< with period 1: uvs are then taken nearest to the query's
};

/// The surface at one point, from its neighbours. Members `..._error` are standard errors: the root of the
/// expected squared error, from noise and truncation together. Twice the standard error covers at least 95 %
/// of the cases if noise dominates or the neighbours lie within an eighth of the smallest radius of
/// curvature, and at least 88 % within three eighths. It is infinite if the neighbours determine a jet but
/// not its error: if they are fewer than jet_coefficients(degree + 1) + 3, or lie on an algebraic curve of
/// degree + 1. It is NaN if there is no jet.
struct LocalJet {
  Vec3<double>
      position;    ///< on the fitted surface, above or below the query along the neighbours' plane normal
  Vec3<double> n;  ///< unit
  Curvature<double>
      curvature;  ///< with respect to n, 1/length; status umbilic only if κ1 = κ2 up to rounding error
  double normal_error = 0;         ///< radians
  double principal_error[2] = {};  ///< of κ1 and κ2, 1/length
  double direction_error = 0;      ///< of the principal directions, radians; infinite where κ1 = κ2
  /// ||A||_F ||A⁺||_F of the system matrix A in coordinates scaled by the neighbourhood's size: 1 to N
  /// times its condition number, N = jet_coefficients(degree). A rotation does not change it.
  double condition = 0;
  double residual_rms =
      0;  ///< weighted rms of the heights above the fitted polynomial, in the units of the points
  Status status = Status::regular;
};

/// P(u, v) at one point, from its neighbours. Errors as in LocalJet; for vectors, the length of the error
/// vector.
struct UvJet {
  Jet2<double> jet;
  Frame<double> frame;                     ///< of the jet, with its status
  double dpdu_error = 0, dpdv_error = 0;   ///< in units of the points
  double tangent_error = 0;                ///< of frame.t, radians
  double normal_error = 0;                 ///< of frame.n, radians
  double condition = 0, residual_rms = 0;  ///< as in LocalJet; the residuals are distances
};

/// Fits z = Σ c_ij x^i y^j, i + j <= degree, by weighted least squares (Householder QR) to the heights z of
/// the neighbours above their least-squares plane, with the origin at `at`, and computes normal and
/// curvatures from it [Cazals2005]. With neighbours within a distance h, the error of the normal is O(h^d)
/// and that of the curvatures O(h^(d - 1)), d the degree. Exact for graphs of such polynomials over the
/// neighbours' plane. If the neighbours determine no polynomial (too few, coincident, collinear, or on one
/// algebraic curve of that degree: condition above 1e12), the result is NaN with the status no_frame; for NaN
/// or infinite neighbours also non_finite_input. Cost: linear in the neighbours; about 2, 3 and 5 µs for 20,
/// 30 and 42 of them and degree 2, 3, 4. \throws ParameterError for a degree outside 2 to 4, and for weights
/// that are not positive and finite or not one per neighbour
LocalJet local_jet(std::span<const Vec3<double>> neighbours, const Vec3<double>& at,
                   const JetOptions& options = {});

/// Fits P(u, v), a vector-valued polynomial in u - at.x and v - at.y, likewise. Errors: O(h^d) for dpdu and
/// dpdv, O(h^(d - 1)) for second partials. No plane, normal or side is needed; winding and mirroring of the
/// uvs do not matter. At a pole or seam of the chart the uvs are not smooth coordinates, and the error
/// estimates are large. \throws ParameterError as local_jet, and unless there is one uv per position
UvJet uv_jet(std::span<const Vec2<double>> uvs, std::span<const Vec3<double>> positions,
             const Vec2<double>& at, const JetOptions& options = {});

struct CloudJetOptions {
  int degree = 3;  ///< 2 to 4
  std::size_t neighbours =
      0;  ///< nearest points, including the point itself; 0: 2 jet_coefficients(degree + 1)
  bool u_periodic = false, v_periodic = false;
  int threads = 1;  ///< 0: as many as the machine has; results do not depend on it
};

/// local_jet() at each point of a cloud, from its nearest finite points, oriented by its stored normal if it
/// has one. \throws ParameterError for a degree outside 2 to 4, fewer neighbours than coefficients, or
/// threads < 0; MeshError for attributes of another length than positions
std::vector<LocalJet> local_jets(const PointCloud& cloud, const CloudJetOptions& options = {});

/// uv_jet at each point of a cloud, likewise; several at once by SIMD instructions, to the same bits.
/// \throws as local_jets, MeshError for a cloud without uvs, ParameterError where DARBOUX_ISA names no
/// instruction set
std::vector<UvJet> uv_jets(const PointCloud& cloud, const CloudJetOptions& options = {});

}  // namespace darboux
