// Other programs that fit surfaces to points, where they were there when this was built.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "synthetic_points.h"

namespace darboux {

struct OtherFitter {
  std::string name;
  std::vector<std::string_view> kinds;
  // The kind is told, and the noise as a help; nothing where it finds none.
  std::function<std::optional<PlacedSurface>(const PointCloud&, std::string_view kind, double sigma)> fit;
};

std::vector<OtherFitter> other_fitters();

// One line for each that is missing.
std::vector<std::string> missing_fitters();

}  // namespace darboux
