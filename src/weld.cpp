#include <cmath>
#include <cstddef>
#include <numeric>
#include <unordered_map>

#include <darboux/weld.h>

#include "disjoint_sets.h"

namespace darboux {
namespace {

struct Cell {
  std::int64_t x, y, z;
  friend bool operator==(const Cell&, const Cell&) = default;
};

struct CellHash {
  std::size_t operator()(const Cell& c) const {
    std::uint64_t h = 0;
    for (const std::int64_t k : {c.x, c.y, c.z}) {
      h = (h ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15ull;
      h ^= h >> 29;
    }
    return h;
  }
};

}  // namespace

std::vector<std::uint32_t> weld(std::span<const Vec3<double>> points, double tolerance) {
  if (!std::isfinite(tolerance)) tolerance = 0;
  DisjointSets groups(points.size());
  Vec3<double> low{}, high{};
  bool first = true;
  for (const auto& p : points) {
    if (!detail::finite(p)) continue;
    if (first) low = high = p;
    first = false;
    low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y), std::fmin(low.z, p.z)};
    high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y), std::fmax(high.z, p.z)};
  }
  // Cells of eight tolerances: a point is near a cell's face, and its neighbour must be looked at, in one
  // case of four. Never finer than 2^-60 of the extent, so that cell numbers fit 64 bits.
  const double extent = std::fmax(high.x - low.x, std::fmax(high.y - low.y, high.z - low.z));
  const double size =
      std::fmax(8 * tolerance, std::fmax(extent * 0x1p-60, std::numeric_limits<double>::min()));
  // Within a cell only points of different places are kept: duplicates join the one that is there.
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells;
  cells.reserve(points.size());
  const auto near = [&](const Vec3<double>& a, const Vec3<double>& b) {
    return std::fabs(a.x - b.x) <= tolerance && std::fabs(a.y - b.y) <= tolerance &&
           std::fabs(a.z - b.z) <= tolerance;
  };
  const auto number = [&](double x, double origin) {
    return static_cast<std::int64_t>(std::floor((x - origin) / size));
  };
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3<double>& p = points[i];
    if (!detail::finite(p)) continue;
    bool exact_duplicate = false;
    for (std::int64_t x = number(p.x - tolerance, low.x); x <= number(p.x + tolerance, low.x); ++x)
      for (std::int64_t y = number(p.y - tolerance, low.y); y <= number(p.y + tolerance, low.y); ++y)
        for (std::int64_t z = number(p.z - tolerance, low.z); z <= number(p.z + tolerance, low.z); ++z) {
          const auto cell = cells.find({x, y, z});
          if (cell == cells.end()) continue;
          for (const std::uint32_t j : cell->second) {
            if (!near(p, points[j])) continue;
            groups.join(i, j);
            exact_duplicate = exact_duplicate || p == points[j];
          }
        }
    if (!exact_duplicate) cells[{number(p.x, low.x), number(p.y, low.y), number(p.z, low.z)}].push_back(i);
  }
  std::vector<std::uint32_t> representative(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) representative[i] = groups.find(i);
  return representative;
}

}  // namespace darboux
