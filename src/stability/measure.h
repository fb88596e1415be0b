// Measurements: one member of a quantity by one route at one x.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <darboux/stability.h>

#include "laws/exact.h"

namespace darboux::sweeps {

// A member of a quantity, compared.
struct Found {
  std::size_t quantity;  // place in stability_quantities
  std::string_view member;
  laws::Comparison comparison;
};

struct Measurement {
  std::size_t route;  // place in the options
  double x;
  Found found;
  double unit;          // in which error and bound are counted
  double u, v;          // where
  std::string surface;  // as it was there
};

// The values of x: options.points for evaluation, a third of that for meshes and fits, which take longer.
std::vector<double> values_of_x(const StabilityOptions& options, const StabilitySweep& sweep);

// The sweeps of meshes and of fits, at all x. Empty if the surface cannot be meshed.
std::vector<Measurement> measure_meshes(const StabilityOptions& options, const StabilitySweep& sweep,
                                        const AnySurface& surface);
std::vector<Measurement> measure_fits(const StabilityOptions& options, const StabilitySweep& sweep,
                                      const AnySurface& surface);

// Whether fit_points() finds surfaces of this kind, and fast enough.
bool is_fitted(const AnySurface& surface);

}  // namespace darboux::sweeps
