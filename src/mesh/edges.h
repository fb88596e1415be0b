// The edges of triangles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace darboux {

// The edges between nodes, grouped by the smaller node of each, for as many triangles as check_consistent()
// permits. Edge 3t + k runs from corner k of triangle t to the next corner.
class EdgesByNode {
 public:
  // \param node node(t, k) is the node of corner k of triangle t
  template <class Node>
  EdgesByNode(std::size_t triangles, std::size_t nodes, const Node& node)
      : begin_(nodes + 2, 0), edges_(3 * triangles) {
    const auto for_each = [&](auto f) {
      for (std::uint32_t t = 0, edge = 0; t < triangles; ++t) {
        const std::uint32_t a = node(t, 0), b = node(t, 1), c = node(t, 2);
        for (const std::uint32_t smaller : {std::min(a, b), std::min(b, c), std::min(c, a)})
          f(smaller, edge++);
      }
    };
    for_each([&](std::uint32_t smaller, std::uint32_t) { ++begin_[smaller + 2]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    for_each([&](std::uint32_t smaller, std::uint32_t edge) { edges_[begin_[smaller + 1]++] = edge; });
  }

  std::uint32_t nodes() const { return static_cast<std::uint32_t>(begin_.size() - 2); }
  // The edges whose smaller node this is, in the order of the triangles.
  std::span<const std::uint32_t> operator[](std::uint32_t node) const {
    return {edges_.data() + begin_[node], edges_.data() + begin_[node + 1]};
  }

 private:
  std::vector<std::uint32_t> begin_, edges_;
};

}  // namespace darboux
