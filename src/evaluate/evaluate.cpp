#include <algorithm>
#include <string>

#include <darboux/error.h>
#include <darboux/evaluate.h>

#include "base/parallel.h"
#include "placed_worker.h"
#include "worker.h"

namespace darboux {
namespace {

// The minimum number of points per thread.
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
  using evaluation::PlacedWorker;
  const auto place = PlacedWorker<T>::kernel_for(surface, outputs, options);
  const evaluation::Call<T> call(surface, points, outputs, options);
  const auto run = [&](std::size_t first, std::size_t last) {
    return place != nullptr ? PlacedWorker<T>(place, surface, points, outputs, options).run(first, last)
                            : evaluation::Worker<T>(call, last - first).run(first, last);
  };
  const std::size_t threads =
      std::min({thread_count(options.threads), n / least_per_thread, std::size_t{1024}});
  if (threads <= 1) return run(0, n);
  std::array<StatusSummary, 1024> part;
  const auto begin_of = [&](std::size_t k) {
    return k == threads ? n : n / threads * k / kernels::batch_size<T> * kernels::batch_size<T>;
  };
  // One chunk per thread: more would keep no more threads busy.
  parallel_tasks(threads, [&](std::size_t k) { part[k] = run(begin_of(k), begin_of(k + 1)); });
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
