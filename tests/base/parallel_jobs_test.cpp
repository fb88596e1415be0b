// Jobs on several threads: each is done once, and an exception waits for all threads to stop.
#include "base/parallel_jobs.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace darboux::parallel_jobs_test {
namespace {

TEST(ParallelJobs, EachIsDoneOnce) {
  for (const int threads : {1, 2, 5, 40}) {
    std::vector<std::atomic<int>> done(33);
    parallel_for(
        done.size(), threads, [&](std::size_t i) { ++done[i]; }, [](double) {});
    for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1) << threads;
  }
}

// Were a thread not waited for, its destructor would end the program.
TEST(ParallelJobs, ExceptionsOfWorkAndProgressAreThrownOn) {
  for (const int threads : {1, 2, 5}) {
    std::atomic<int> running{0};
    const auto work = [&](std::size_t i) {
      ++running;
      std::this_thread::sleep_for(std::chrono::milliseconds(i % 3));
      --running;
    };
    EXPECT_THROW(parallel_for(200, threads, work, [](double) { throw std::runtime_error("progress"); }),
                 std::runtime_error);
    EXPECT_EQ(running, 0);
    EXPECT_THROW(parallel_for(
                     200, threads,
                     [&](std::size_t i) {
                       work(i);
                       if (i == 7) throw std::logic_error("work");
                     },
                     [](double) {}),
                 std::logic_error);
    EXPECT_EQ(running, 0);
  }
}

}  // namespace
}  // namespace darboux::parallel_jobs_test
