#include "corner_counts.h"

#include <cmath>

#include "base/text.h"

namespace darboux {

void Lengths::add(double length) {
  least_ = std::fmin(least_, length), most_ = std::fmax(most_, length);
}

std::string Lengths::text() const {
  const std::string from = rounded(least_, 4), to = rounded(most_, 4);
  return from == to ? " (length " + to + ")" : " (lengths " + from + " to " + to + ")";
}

Finding warning(Code code, std::size_t count, const std::string& more, const Reason& reason) {
  Finding result = warning(code, count, more + std::string(reason.why));
  if (!reason.to_do.empty()) result.to_do = reason.to_do;
  return result;
}

bool CornerCounts::are_few(Code code, std::size_t corners, double limit_deg) const {
  constexpr std::size_t most = 24, most_near = 12;
  const bool near = tangents.by_triangles <= most_near && tangents.worst <= 2.5 * limit_deg;
  const std::size_t in = near ? 80 : 500;
  return code == Code::tangent_angle && tangents.by_surface == 0 && in * tangents.by_triangles < corners &&
         tangents.by_triangles <= most;
}

}  // namespace darboux
