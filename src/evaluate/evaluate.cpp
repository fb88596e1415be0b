#include <algorithm>
#include <string>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <darboux/error.h>
#include <darboux/evaluate.h>

#include "worker.h"

namespace darboux {
namespace {

// A thread gets this many points at least.
constexpr std::size_t least_per_thread = 2048;

template <class T>
StatusSummary evaluate_all(const detail::ErasedSurface<T>& surface, const Points<T>& points,
                           const Outputs<T>& outputs, const EvaluateOptions& options) {
  const std::size_t n = points.size();
  const auto check_room = [&](std::string_view name, std::size_t room) {
    if (room < n)
      throw ParameterError(std::string(name),
                           "expected room for " + std::to_string(n) + " points, got " + std::to_string(room));
  };
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (const auto attribute = static_cast<Attribute>(a); outputs.attributes().has(attribute))
      check_room(info_of(attribute).name, outputs.place(attribute).points);
  if (outputs.status_place() != nullptr) check_room("status", outputs.status_points());
  if (options.threads < 0)
    throw ParameterError("threads", "expected 0 (all) or more, got " + std::to_string(options.threads));
  const evaluation::Call<T> call(surface, points, outputs, options);
  const std::size_t wanted = options.threads == 0 ? static_cast<std::size_t>(tbb::info::default_concurrency())
                                                  : static_cast<std::size_t>(options.threads);
  const std::size_t threads = std::min({wanted, n / least_per_thread, std::size_t{1024}});
  if (threads <= 1) return evaluation::Worker<T>(call, n).run(0, n);
  std::array<StatusSummary, 1024> part;
  const auto begin_of = [&](std::size_t k) {
    return k == threads ? n : n / threads * k / kernels::batch_size<T> * kernels::batch_size<T>;
  };
  // In the caller's arena, whose workers stay awake from call to call; as many chunks as threads keep no more
  // busy. Isolated: no other task of the caller begins here, and its cancellation leaves nothing out.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, threads, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t k = range.begin(); k < range.end(); ++k)
            part[k] =
                evaluation::Worker<T>(call, begin_of(k + 1) - begin_of(k)).run(begin_of(k), begin_of(k + 1));
        },
        tbb::simple_partitioner{}, context);
  });
  StatusSummary total;
  for (std::size_t k = 0; k < threads; ++k) {
    total.points += part[k].points;
    total.point_by_point += part[k].point_by_point;
    for (std::size_t s = 0; s < total.count.size(); ++s) {
      if (total.count[s] == 0) total.first[s] = part[k].first[s];
      total.count[s] += part[k].count[s];
    }
  }
  return total;
}

}  // namespace

namespace detail {

StatusSummary evaluate(const ErasedSurface<double>& surface, const Points<double>& points,
                       const Outputs<double>& outputs, const EvaluateOptions& options) {
  return evaluate_all(surface, points, outputs, options);
}
StatusSummary evaluate(const ErasedSurface<float>& surface, const Points<float>& points,
                       const Outputs<float>& outputs, const EvaluateOptions& options) {
  return evaluate_all(surface, points, outputs, options);
}

}  // namespace detail

StatusSummary& StatusSummary::operator+=(const StatusSummary& next) {
  for (std::size_t s = 0; s < count.size(); ++s) {
    if (count[s] == 0 && next.count[s] > 0) first[s] = next.first[s] + points;
    count[s] += next.count[s];
  }
  points += next.points;
  point_by_point += next.point_by_point;
  return *this;
}

}  // namespace darboux
