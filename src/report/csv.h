/// \file csv.h
/// Fields of the CSV files that report commands write: RFC 4180 quoting, numbers that read back to the same
/// bits.
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "base/text.h"

namespace darboux {

inline std::string csv_text(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// Empty where there is no number.
inline std::string csv_number(double x) {
  return std::isfinite(x) ? shortest(x) : std::string();
}

}  // namespace darboux
