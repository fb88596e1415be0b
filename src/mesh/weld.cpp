#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include <darboux/weld.h>

#include "base/disjoint_sets.h"
#include "base/hash_table.h"
#include "largest_coordinate.h"

namespace darboux {
namespace {

std::uint32_t hash_of_cell(std::int64_t x, std::int64_t y, std::int64_t z) {
  const std::uint64_t sum = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15 +
                            static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4f +
                            static_cast<std::uint64_t>(z) * 0x165667b19e3779f9;
  return static_cast<std::uint32_t>((sum ^ sum >> 32) * 0xd6e8feb86659fd93 >> 32);
}

double Vec3<double>::*const axes[] = {&Vec3<double>::x, &Vec3<double>::y, &Vec3<double>::z};

bool near(const Vec3<double>& difference, double tolerance) {
  return std::fabs(difference.x) <= tolerance && std::fabs(difference.y) <= tolerance &&
         std::fabs(difference.z) <= tolerance;
}

struct Box {
  Vec3<double> low, high;
  Vec3<double> size() const { return high - low; }
  double Vec3<double>::*longest_axis() const {
    return *std::max_element(std::begin(axes), std::end(axes),
                             [size = size()](auto a, auto b) { return size.*a < size.*b; });
  }
};

Box around(const Box& a, const Box& b) {
  Box result;
  for (const auto axis : axes) {
    result.low.*axis = std::min(a.low.*axis, b.low.*axis);
    result.high.*axis = std::max(a.high.*axis, b.high.*axis);
  }
  return result;
}

// The gap between two boxes along each axis; 0 where they overlap.
Vec3<double> gap(const Box& a, const Box& b) {
  Vec3<double> result;
  for (const auto axis : axes)
    result.*axis = std::max({a.low.*axis - b.high.*axis, b.low.*axis - a.high.*axis, 0.0});
  return result;
}

// Finds the groups by boxes, each halved at the median of its longest side until its points are near each
// other. Pairs of boxes that are apart, near as a whole, or already joined are not searched.
class Boxes {
 public:
  Boxes(std::span<const Vec3<double>> points, double tolerance)
      : points_(points), tolerance_(tolerance), groups_(points.size()) {
    for (std::uint32_t i = 0; i < points.size(); ++i)
      if (detail::finite(points[i])) order_.push_back(i);
    if (!order_.empty()) build(order_);
  }
  std::vector<std::uint32_t> representatives() { return groups_.representatives(); }

 private:
  using Indices = std::span<std::uint32_t>;
  struct Node {
    Box box;
    Indices points;
    std::uint32_t second =
        0;  // the second half; the first is the next node. 0 where the points are near each other
    bool joined = false;  // the points are one group
  };

  Box box_of(Indices points) const {
    Box box{points_[points[0]], points_[points[0]]};
    for (const std::uint32_t i : points) box = around(box, {points_[i], points_[i]});
    return box;
  }
  std::pair<Indices, Indices> halves(Indices points, double Vec3<double>::*axis) const {
    const std::size_t middle = points.size() / 2;
    std::nth_element(
        points.begin(), points.begin() + static_cast<std::ptrdiff_t>(middle), points.end(),
        [this, axis](std::uint32_t i, std::uint32_t j) { return points_[i].*axis < points_[j].*axis; });
    return {points.first(middle), points.subspan(middle)};
  }

  std::uint32_t build(Indices points) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({box_of(points), points});
    if (near(nodes_[number].box.size(), tolerance_)) {
      for (const std::uint32_t i : points) groups_.join(points[0], i);
      nodes_[number].joined = true;
      return number;
    }
    const auto [first, second] = halves(points, nodes_[number].box.longest_axis());
    build(first);
    nodes_[number].second = build(second);
    join(number + 1, nodes_[number].second);
    nodes_[number].joined = are_joined(number + 1, nodes_[number].second);
    return number;
  }

  bool are_joined(std::uint32_t a, std::uint32_t b) {
    return nodes_[a].joined && nodes_[b].joined &&
           groups_.find(nodes_[a].points[0]) == groups_.find(nodes_[b].points[0]);
  }
  // Joins every point of one node with every near point of the other.
  void join(std::uint32_t a, std::uint32_t b) {
    if (!near(gap(nodes_[a].box, nodes_[b].box), tolerance_) || are_joined(a, b)) return;
    if (nodes_[a].points.size() < nodes_[b].points.size()) std::swap(a, b);
    if (nodes_[a].second == 0) std::swap(a, b);
    if (const std::uint32_t second = nodes_[a].second) {
      join(a + 1, b);
      join(second, b);
    } else if (any_near(nodes_[a].points, nodes_[b].points)) {
      groups_.join(nodes_[a].points[0], nodes_[b].points[0]);
    }
  }
  bool any_near(Indices a, Indices b) const {
    const Box box_a = box_of(a), box_b = box_of(b);
    if (!near(gap(box_a, box_b), tolerance_)) return false;
    // Along an axis that is not open, all points are near. If one axis is open, the two points nearest along
    // it decide. If more are, the box that is longest along one of them is halved.
    const Vec3<double> all = around(box_a, box_b).size();
    double Vec3<double>::*along = nullptr;
    double longest = -1;
    bool halve_a = true;
    int open = 0;
    for (const auto axis : axes) {
      if (all.*axis <= tolerance_) continue;
      ++open;
      for (const bool is_a : {true, false})
        if (const double length = (is_a ? box_a : box_b).size().*axis; length > longest)
          along = axis, longest = length, halve_a = is_a;
    }
    if (open <= 1) return true;
    const auto [first, second] = halves(halve_a ? a : b, along);
    const Indices other = halve_a ? b : a;
    return any_near(first, other) || any_near(second, other);
  }

  std::span<const Vec3<double>> points_;
  double tolerance_;
  DisjointSets groups_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<std::uint32_t> weld(std::span<const Vec3<double>> points, double tolerance) {
  if (!(tolerance >= 0 && std::isfinite(tolerance))) tolerance = 0;
  const double largest = largest_coordinate(points);
  // Cells of 16 tolerances: one point in eight is near a cell's face, so that the neighbouring cell must be
  // searched. Never finer than 2^-60 of the largest coordinate, so that cell numbers fit 64 bits.
  const double size = std::max({16 * tolerance, largest * 0x1p-60, std::numeric_limits<double>::min()});
  const auto cell = [inverse = 1 / size](double x) { return static_cast<std::int64_t>(x * inverse); };
  const auto first_cell = [&](double x) { return cell(std::max(x - tolerance, -largest)); };
  const auto last_cell = [&](double x) { return cell(std::min(x + tolerance, largest)); };

  std::vector<std::uint32_t> hashes(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const Vec3<double>& p = points[i]; detail::finite(p))
      hashes[i] = hash_of_cell(cell(p.x), cell(p.y), cell(p.z));

  DisjointSets groups(points.size());
  HashTable distinct;
  std::size_t asked = 0;  // compared pairs
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    // Boxes are faster if cells are crowded, as when all points but one lie within the tolerance of each
    // other.
    if (asked > 32 * (std::size_t{i} + 1000)) return Boxes(points, tolerance).representatives();
    if (i + HashTable::soon < hashes.size()) distinct.prefetch(hashes[i + HashTable::soon]);
    const Vec3<double>& p = points[i];
    if (!detail::finite(p)) continue;
    const std::uint32_t hash = hashes[i];
    const auto joins_its_equal = [&](std::uint32_t j) {
      ++asked;
      if (!(p == points[j])) return false;
      groups.join(i, j);
      return true;
    };
    if (distinct.any_of(hash, joins_its_equal)) continue;
    const auto join_if_near = [&](std::uint32_t j) {
      ++asked;
      if (near(p - points[j], tolerance)) groups.join(i, j);
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
