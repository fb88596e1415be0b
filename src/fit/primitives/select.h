// Selects the primitive that the points support best.
#pragma once

#include <string>
#include <vector>

#include "determinacy.h"

namespace darboux::fit {

struct Selection {
  std::vector<double> bic;         // one per fit
  std::vector<std::size_t> order;  // of the fits: the chosen one, then best first
  bool usable = false;
  bool has_rival = false;  // another surface is equally likely
  std::string reason{};
};

// The fit with the smallest criterion, unless something supports another.
Selection select(const std::vector<PrimitiveFit>& tried, double scale);

}  // namespace darboux::fit
