#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <darboux/weld.h>

#include "disjoint_sets.h"
#include "hash_table.h"

namespace darboux {
namespace {

std::uint32_t hash_of_cell(std::int64_t x, std::int64_t y, std::int64_t z) {
  const std::uint64_t sum = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15 +
                            static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4f +
                            static_cast<std::uint64_t>(z) * 0x165667b19e3779f9;
  return static_cast<std::uint32_t>((sum ^ sum >> 32) * 0xd6e8feb86659fd93 >> 32);
}

}  // namespace

std::vector<std::uint32_t> weld(std::span<const Vec3<double>> points, double tolerance) {
  if (!std::isfinite(tolerance)) tolerance = 0;
  double largest = 0;
  for (const auto& p : points)
    if (detail::finite(p)) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  // Cells of 16 tolerances: a point is near a cell's face, and its neighbour must be looked at, in one case of
  // eight. Never finer than 2^-60 of the largest coordinate, so that cell numbers fit 64 bits.
  const double size = std::max({16 * tolerance, largest * 0x1p-60, std::numeric_limits<double>::min()});
  const auto cell = [inverse = 1 / size](double x) { return static_cast<std::int64_t>(x * inverse); };
  const auto first_cell = [&](double x) { return cell(std::max(x - tolerance, -largest)); };
  const auto last_cell = [&](double x) { return cell(std::min(x + tolerance, largest)); };

  DisjointSets groups(points.size());
  HashTable distinct;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3<double>& p = points[i];
    if (!detail::finite(p)) continue;
    const std::uint32_t hash = hash_of_cell(cell(p.x), cell(p.y), cell(p.z));
    const auto joins_its_equal = [&](std::uint32_t j) {
      if (!(p == points[j])) return false;
      groups.join(i, j);
      return true;
    };
    if (distinct.any_of(hash, joins_its_equal)) continue;
    const auto join_if_near = [&](std::uint32_t j) {
      const Vec3<double> d = p - points[j];
      if (std::fabs(d.x) <= tolerance && std::fabs(d.y) <= tolerance && std::fabs(d.z) <= tolerance)
        groups.join(i, j);
      return false;  // there may be more
    };
    const std::int64_t x_end = last_cell(p.x), y_end = last_cell(p.y), z_end = last_cell(p.z);
    for (std::int64_t x = first_cell(p.x); x <= x_end; ++x)
      for (std::int64_t y = first_cell(p.y); y <= y_end; ++y)
        for (std::int64_t z = first_cell(p.z); z <= z_end; ++z)
          distinct.any_of(hash_of_cell(x, y, z), join_if_near);
    distinct.insert(hash, i);
  }
  return groups.representatives();
}

}  // namespace darboux
