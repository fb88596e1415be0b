/// \file weld.h
/// Finds vertices at the same position.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <darboux/vector.h>

namespace darboux {

/// For each point, the index of the first point of its group. A group consists of points that are at most
/// `tolerance` apart in every coordinate, directly or through a chain of points. Non-finite points form
/// groups of their own. A tolerance that is negative or not finite counts as 0. Cost: linear, unless many
/// points are crowded far below the tolerance: 0.04 µs per point where points mostly equal earlier ones, 0.1
/// to 0.2 µs where they do not; 4 bytes per point and 11 to 32 bytes for each that differs. Crowded: n log
/// n.
std::vector<std::uint32_t> weld(std::span<const Vec3<double>> points, double tolerance);

}  // namespace darboux
