/// \file parallel.h
/// Loops on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include "task_order.h"

namespace darboux {

/// The number of threads for an option in which 0 means all.
inline std::size_t thread_count(int threads) {
  return static_cast<std::size_t>(threads == 0 ? tbb::info::default_concurrency() : threads);
}

/// Calls f(k) for each k below n, one task each, in the caller's arena, whose workers stay awake between
/// calls. Isolated: a waiting thread takes no other task of the caller's, and cancelling the caller's tasks
/// does not cancel these.
template <class F>
void parallel_tasks(std::size_t n, const F& f) {
  TaskOrder order;
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        std::size_t{0}, n,
        [&](std::size_t k) {
          const TaskOrder::Task task(order);
          f(k);
        },
        tbb::simple_partitioner{}, context);
  });
}

/// The number of ranges into which parallel_ranges() divides [0, n): more than one from n = `least` on, and
/// one more for each further `least`.
constexpr std::size_t range_count(std::size_t n, std::size_t threads, std::size_t least = 1 << 15) {
  return threads <= 1 ? 1 : std::min(n / least + 1, 16 * threads);
}

/// Calls f(begin, end) over ranges that cover [0, n), on several threads: each takes the next range when it
/// has finished one.
template <class F>
void parallel_ranges(std::size_t n, std::size_t threads, const F& f, std::size_t least = 1 << 15) {
  const std::size_t ranges = range_count(n, threads, least);
  if (ranges == 1) return f(std::size_t{0}, n);
  std::atomic<std::size_t> taken = 0;
  parallel_tasks(std::min(threads, ranges), [&](std::size_t) {
    for (std::size_t k; (k = taken++) < ranges;) f(n * k / ranges, n * (k + 1) / ranges);
  });
}

}  // namespace darboux
