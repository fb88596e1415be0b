/// \file pieces.h
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

namespace darboux {

// 0 stands for all.
inline std::size_t thread_count(int threads) {
  return static_cast<std::size_t>(threads == 0 ? tbb::info::default_concurrency() : threads);
}

constexpr std::size_t pieces_of(std::size_t n, std::size_t threads, std::size_t least = 1 << 15) {
  return threads <= 1 ? 1 : std::min(n / least + 1, 16 * threads);
}

// f(begin, end) over pieces of [0, n), by so many threads: each takes the next piece when it is done with
// one.
template <class F>
void in_pieces(std::size_t n, std::size_t threads, const F& f, std::size_t least = 1 << 15) {
  const std::size_t pieces = pieces_of(n, threads, least);
  if (pieces == 1) return f(std::size_t{0}, n);
  std::atomic<std::size_t> taken = 0;
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::parallel_for(
      std::size_t{0}, std::min(threads, pieces),
      [&](std::size_t) {
        for (std::size_t k; (k = taken++) < pieces;) f(n * k / pieces, n * (k + 1) / pieces);
      },
      tbb::simple_partitioner{}, context);
}

}  // namespace darboux
