#pragma once

#include <numbers>

namespace darboux {

inline constexpr double degrees_per_radian = 180 / std::numbers::pi;

}  // namespace darboux
