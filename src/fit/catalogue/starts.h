// Starts for the fit of any kind: parts of the default surface placed on the points by their principal axes.
#pragma once

#include <vector>

#include "shape.h"

namespace darboux::fit::catalogue {

struct Start {
  Shape shape;
  double score;
};

// Parts of the surface, with the parameters as they are and each of them halved or doubled, best first.
// Score: the 60 % quantile of the distances of a few points.
std::vector<Start> starts_of(const AnySurface& standard, const std::vector<bool>& lengths,
                             const Positions& points);

}  // namespace darboux::fit::catalogue
