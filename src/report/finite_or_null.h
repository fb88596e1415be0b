/// \file finite_or_null.h
/// Numbers of reports as JSON.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

namespace darboux {

/// Null for NaN and infinities.
inline nlohmann::ordered_json finite_or_null(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

}  // namespace darboux
