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

}  // namespace darboux
