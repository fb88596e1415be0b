// The engine of every fit through uvs: a placed surface at known uvs, its sums over the points, and Ceres
// over them. Formulas: docs/theory/fit-with-uvs.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/fit_points.h>
#include <darboux/placed_surface.h>

#include "fit/common/mixture.h"
#include "fit/common/normalised_points.h"
#include "uv_kinds.h"

namespace darboux {

/// The six numbers of an affine map of uv in the order in which UvConvention has them.
using Affine = std::array<double, 6>;
inline constexpr Affine identity_map{1, 0, 0, 1, 0, 0};

/// The unknowns. (u, v) of the surface = affine(convention(stored u, v)).
struct UvState {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::vector<double> parameters;
  Affine affine = identity_map;
};

/// Weighted normal equations: cost, its gradient and the Gauss-Newton matrix with respect to the rotation
/// vector in the body's axes, the translation, then the free parameters and entries of the affine map.
struct UvSums {
  double cost = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

/// Covariance of an estimate at the noise of its normal equations: rotation vector in the body's axes,
/// translation, all parameters, the affine map. Zero for what is held or at its bound.
struct UvSpread {
  Eigen::MatrixXd covariance;
  std::string undetermined{};  ///< what the points do not determine, and the covariance is zero; empty: they
                               ///< determine all
};

/// How a fit ended.
struct Solved {
  bool converged = false;
  int iterations = 0;
};

/// One kind at the points' uvs.
class UvModel {
 public:
  UvModel(const UvKind& kind, const fit::NormalisedPoints& points, const UvConvention& convention)
      : kind(&kind), points(&points), convention(convention), held(kind.parameters.size(), false) {}

  const UvKind* kind;
  const fit::NormalisedPoints* points;
  UvConvention convention;
  std::vector<bool> held;  ///< parameters that keep their value
  bool placement_held = false;
  std::vector<int> free_affine{};  ///< entries of the affine map that are estimated

  /// Columns of the sums: 6 plus the free unknowns.
  int columns() const { return 6 + static_cast<int>(free_parameters().size() + free_affine.size()); }
  std::vector<int> free_parameters() const;
  /// Numbers that are estimated.
  std::size_t unknowns() const { return static_cast<std::size_t>(columns() - (placement_held ? 6 : 0)); }
  UvState moved(const UvState& state, const Eigen::VectorXd& step) const;

  /// One pass over the points.
  /// \param squares when given: of each point's distance from the surface at its uv
  UvSums sums(const UvState& state, const fit::Mixture& mixture,
              std::vector<double>* squares = nullptr) const;
  std::vector<double> squares(const UvState& state) const;

  /// The vectors from each point to the surface at its uv, and the surface points, in the body's axes.
  struct Residuals {
    Eigen::Matrix3Xd errors, places;
  };
  Residuals residuals(const UvState& state) const;

  /// Jacobian of the positions of some points, in the body's axes, to test its rank.
  Eigen::MatrixXd jacobian(const UvState& state, std::size_t most) const;

  /// Runs Ceres to convergence with the mixture held, or for a number of steps.
  Solved solve(UvState& state, const fit::Mixture& mixture, double tolerance, int most_steps = 50) const;

  /// Newton steps in all unknowns together, to full precision, from a converged state.
  void polish(UvState& state, fit::MixtureInVolume& mixture, int most) const;

  /// Alternates between solving and updating the mixture until it no longer changes.
  Solved maximise(UvState& state, fit::MixtureInVolume& mixture) const;

  UvConvention whole_convention(const UvState& state) const;

  UvSpread spread(const UvState& state, const UvSums& sums) const;

  /// A covariance from spread() in world axes, about `centre` (here still in the points' units).
  SurfaceUncertainty uncertainty(const UvState& state, const Eigen::MatrixXd& covariance,
                                 const Eigen::Vector3d& centre) const;

 private:
  struct Rows;
  void fill(const UvState& state, std::size_t first, std::size_t count, bool derivatives, Rows& to) const;
  // Calls each(first, count, rows) with the residuals of some points at a time, and with their derivatives if
  // requested.
  template <class Each>
  void for_each_block(const UvState& state, bool derivatives, Each each) const;
};

/// Posterior probability that a point at this squared distance is an inlier.
double inlier_probability(const fit::Mixture& mixture, double square);

/// The log likelihood of the points under the mixture, in their units.
double log_likelihood(const fit::MixtureInVolume& mixture, const std::vector<double>& squares);

/// The mixture of greatest likelihood for these squared distances (expectation-maximisation), its volume a
/// ball of twice the inliers' own extent.
void update(fit::MixtureInVolume& mixture, const std::vector<double>& squares,
            const fit::NormalisedPoints& points);

}  // namespace darboux
