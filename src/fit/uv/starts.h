// Where a fit through uvs starts: linear least squares for a convention, and a search over affine ones.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "model.h"

namespace darboux {

/// Values that the user holds, in the units of the points and relative to their centre.
struct UvHeld {
  std::vector<std::optional<double>> parameters;  ///< an entry each, or none at all
  std::optional<Eigen::Isometry3d> placement;
};

struct UvStart {
  UvModel model;
  UvState state;
  double median;  ///< of the points' distances
  /// A lower bound of the rms distance of any state of this kind and convention from the points; 0 where none
  /// is known
  double least_rms = 0;
};

/// The best start of each convention of uv_conventions(), in their order, without those that have none in the
/// range of numbers.
struct ConventionStarts {
  std::vector<UvStart> proper;
  std::vector<UvStart>
      mirrored;  ///< states for the points' image under x -> -x, an improper motion; robust ones only
};

/// \param robust reweighted, so that somewhat less than half of the points may be arbitrary outliers
ConventionStarts convention_starts(const UvKind& kind, const fit::NormalisedPoints& points,
                                   const UvHeld& held, bool robust);

// How far a map takes stored uvs beyond [0, 1], in coordinates that do not turn.
double outside_of_domain(const UvKind& kind, const UvConvention& map, std::span<const Vec2<double>> stored);

/// The best starts with an affine map after a convention, best first.
/// \param sheared slopes Δu/Δv of stored uvs along which v of the surface may run, in addition to those
/// that are always tried
std::vector<UvStart> affine_starts(const UvKind& kind, const fit::NormalisedPoints& points,
                                   const UvHeld& held, bool robust, std::span<const double> sheared = {});

/// The entries of the affine map that the points can distinguish from placement and parameters; the others
/// stay those of the identity, the offset first.
std::vector<int> observable_affine(UvModel model);

}  // namespace darboux
