/// \file neighbours.h
/// The points of a cloud nearest to a query.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include <nanoflann.hpp>

#include <darboux/vector.h>

namespace darboux {

/// A k-d tree over those points that are finite; indices are those of the span from which it is built.
/// Components must be within 1e-150 to 1e150 in magnitude. O(n log n) to build; a query takes O(k log k + log
/// n) on points of a surface.
class Neighbours {
 public:
  explicit Neighbours(std::span<const Vec3<double>> points) {
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0U);
    take(points, all);
  }
  Neighbours(std::span<const Vec3<double>> points, std::span<const std::uint32_t> subset) {
    take(points, subset);
  }
  Neighbours(const Neighbours&) = delete;
  Neighbours& operator=(const Neighbours&) = delete;

  std::size_t size() const { return points_.size(); }

  /// Writes the indices.size() points nearest to the finite `query`, nearest first, a point at the query
  /// itself among them, and their squared distances. Returns how many there were.
  std::size_t nearest(const Vec3<double>& query, std::span<std::uint32_t> indices,
                      std::span<double> squared) const {
    if (points_.empty()) return 0;
    const std::size_t found = tree_.knnSearch(&query.x, indices.size(), indices.data(), squared.data());
    for (std::uint32_t& i : indices.first(found)) i = index_[i];
    return found;
  }

  // The interface that nanoflann requires.
  std::size_t kdtree_get_point_count() const { return points_.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return (&points_[i].x)[axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

 private:
  void take(std::span<const Vec3<double>> points, std::span<const std::uint32_t> subset) {
    for (const std::uint32_t i : subset) {
      if (!detail::finite(points[i])) continue;
      points_.push_back(points[i]);
      index_.push_back(i);
    }
    if (!points_.empty()) tree_.buildIndex();
  }

  using Metric = nanoflann::L2_Simple_Adaptor<double, Neighbours>;
  std::vector<Vec3<double>> points_;
  std::vector<std::uint32_t> index_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, Neighbours, 3, std::uint32_t> tree_{3, *this};
};

}  // namespace darboux
