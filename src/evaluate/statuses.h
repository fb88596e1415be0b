// The statuses of a block of points: writes and counts them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include <darboux/evaluate.h>

#include "block.h"

namespace darboux::evaluation {

template <class T>
class Statuses {
 public:
  // \param points that are evaluated in all
  Statuses(const Outputs<T>& outputs, std::size_t points) : outputs_(outputs) {
    std::fill_n(status_.begin(), std::min(points, block_room<T>), 0u);
  }

  std::uint32_t* data() { return status_.data(); }
  void set(std::size_t i, Status status) { status_[i] = static_cast<std::uint32_t>(status); }

  // Records the statuses of `count` points (all zero unless `any`), and clears them.
  void note(std::size_t first, std::size_t count, bool any) {
    if (Status* to = outputs_.status_place(); to != nullptr) {
      const std::ptrdiff_t stride = outputs_.status_stride();
      to = reinterpret_cast<Status*>(reinterpret_cast<char*>(to) +
                                     stride * static_cast<std::ptrdiff_t>(first));
      if (stride == sizeof(Status) && !any)
        std::fill_n(to, count, Status::regular);
      else
        for (std::size_t i = 0; i < count; ++i)
          *reinterpret_cast<Status*>(reinterpret_cast<char*>(to) + stride * static_cast<std::ptrdiff_t>(i)) =
              static_cast<Status>(status_[i]);
    }
    if (!any) return;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::uint32_t bits = status_[i]; bits != 0; bits &= bits - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(bits));
        summary.first[k] = summary.count[k] == 0 ? first + i : std::min(summary.first[k], first + i);
        ++summary.count[k];
      }
      status_[i] = 0;
    }
  }

  StatusSummary summary;

 private:
  const Outputs<T>& outputs_;
  std::array<std::uint32_t, block_room<T>> status_;  // zero between the blocks
};

}  // namespace darboux::evaluation
