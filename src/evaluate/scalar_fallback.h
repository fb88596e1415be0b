// Evaluates by the functions for single points what kernels do not support: coordinates outside the domain or
// not finite, limits, surfaces without a kernel.
#pragma once

#include <algorithm>
#include <array>

#include "call.h"
#include "statuses.h"

namespace darboux::evaluation {

template <class T>
class ScalarFallback {
 public:
  ScalarFallback(const Call<T>& call, const kernels::Work<T>& work,
                 const std::array<kernels::Run<T>, all_components>& runs, Statuses<T>& statuses)
      : call_(call), work_(work), runs_(runs), statuses_(statuses) {}

  // Evaluates `count` points of the work, starting at `begin`. \param work_first index of the first point of
  // the work
  void operator()(std::size_t work_first, std::size_t begin, std::size_t count) {
    detail::PointValues<T> values;
    statuses_.summary.point_by_point += count;
    for (std::size_t i = begin; i < begin + count; ++i) {
      const auto [u, v] = call_.points[work_first + i];
      call_.surface.point(call_.surface.surface, u, v, call_.outputs.attributes(), call_.sign, values);
      statuses_.set(i, values.status);
      for (std::size_t a = 0; a < attribute_count; ++a) {
        const kernels::Slot<T>& slot = work_.slots[a];
        const std::size_t n = attribute_infos[a].components;
        if (slot.arrangement == Arrangement::separate)
          for (std::size_t c = 0; c < n; ++c) slot.component[c][i] = values.values[a][c];
        else if (slot.arrangement == Arrangement::packed)
          std::copy_n(values.values[a].begin(), n, slot.component[0] + n * i);
        else if (slot.arrangement == Arrangement::tiled)
          for (std::size_t c = 0; c < n; ++c) tile_row(slot.row + c)[0] = values.values[a][c];
      }
      for (std::size_t r = 0; r < work_.run_count; ++r)
        for (std::size_t k = 0; k < runs_[r].count; ++k)
          reinterpret_cast<T*>(reinterpret_cast<char*>(runs_[r].first) +
                               runs_[r].stride * static_cast<std::ptrdiff_t>(i))[k] =
              tile_row(runs_[r].row + k)[0];
    }
  }

 private:
  T* tile_row(std::size_t row) const { return work_.tile + row * batch_size<T>; }

  const Call<T>& call_;
  const kernels::Work<T>& work_;
  const std::array<kernels::Run<T>, all_components>& runs_;
  Statuses<T>& statuses_;
};

}  // namespace darboux::evaluation
