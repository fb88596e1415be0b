/// \file parallel_jobs.h
/// Jobs of any size on several threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace darboux {

/// Calls work(i) for each i below n on `threads` threads (including this one), and progress(share) after
/// each, on this thread only. Results must not depend on the order. The first exception, of either, is
/// rethrown when all threads have stopped.
template <class Work, class Progress>
void parallel_for(std::size_t n, int threads, Work work, Progress progress) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  const auto run = [&](bool report) {
    for (std::size_t i = next++; i < n; i = next++) {
      try {
        work(i);
        if (report) progress(static_cast<double>(i + 1) / static_cast<double>(n));
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next = n;
      }
    }
  };
  std::vector<std::jthread> pool;
  try {
    for (std::size_t t = 1; t < static_cast<std::size_t>(threads) && t < n; ++t)
      pool.emplace_back(run, false);
  } catch (const std::exception&) {
    // No thread, or no memory for one: fewer threads than requested do the same work.
  }
  run(true);
  pool.clear();  // waits for each
  if (error) std::rethrow_exception(error);
}

}  // namespace darboux
