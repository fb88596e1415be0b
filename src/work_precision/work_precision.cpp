// Fronts, and two runs compared.
#include <algorithm>
#include <cmath>

#include <darboux/work_precision.h>

#include "base/quantile.h"

namespace darboux {

void mark_fronts(std::vector<WorkSample>& samples, const WorkAxes& axes) {
  for (WorkSample& s : samples) {
    const std::size_t x = find_work_metric(axes.x_of(s.domain)), y = find_work_metric(axes.y_of(s.domain));
    // Comparisons with NaN are false, and no finite number exceeds an infinite one: a sample with a metric
    // that is not finite dominates none without.
    s.on_front = s.best_of_family = std::isfinite(s.metric[x]) && std::isfinite(s.metric[y]);
    for (const WorkSample& other : samples) {
      if (other.surface != s.surface || other.domain != s.domain || other.mesh != s.mesh) continue;
      const bool dominates = other.metric[x] <= s.metric[x] && other.metric[y] <= s.metric[y] &&
                             (other.metric[x] < s.metric[x] || other.metric[y] < s.metric[y]);
      if (!dominates) continue;
      s.on_front = false;
      if (other.family == s.family) s.best_of_family = false;
    }
  }
}

TimeRatio time_ratio(std::span<const double> first, std::span<const double> second) {
  std::vector<double> quotients;
  for (const double a : first)
    for (const double b : second) quotients.push_back(b / a);
  if (quotients.empty())
    return {std::numeric_limits<double>::quiet_NaN(), 0, std::numeric_limits<double>::infinity()};
  std::sort(quotients.begin(), quotients.end());
  const std::size_t count = quotients.size();
  TimeRatio result{(quotients[(count - 1) / 2] + quotients[count / 2]) / 2, 0,
                   std::numeric_limits<double>::infinity()};
  // The number of quotients below the true one: mean mn/2, variance mn(m + n + 1)/12, nearly normal from four
  // rounds on each side.
  const auto m = static_cast<double>(first.size()), n = static_cast<double>(second.size());
  const double outside = std::floor(m * n / 2 - 1.959964 * std::sqrt(m * n * (m + n + 1) / 12));
  if (first.size() < 4 || second.size() < 4 || outside < 1) return result;
  const auto k = static_cast<std::size_t>(outside);
  result.low = quotients[k - 1];
  result.high = quotients[count - k];
  return result;
}

bool same_question(const WorkSample& a, const WorkSample& b) {
  // If a mesh cannot be made, there are no points to count.
  const bool failed = !a.failure.empty() || !b.failure.empty();
  return a.surface == b.surface && a.method == b.method && a.mesh == b.mesh && a.resolution == b.resolution &&
         (a.points == b.points || failed);
}

namespace {

bool is_error(std::size_t metric) {
  return work_metrics[metric] != "time_ns" && work_metrics[metric] != "seconds";
}

// Whether the fastest rounds also show that the second takes more than `times` as long: other work on the
// machine only adds time, and may do so in all rounds of one run.
bool fastest_agrees(const WorkComparison& c, double times) {
  const auto fastest = [](const WorkSample& s) {
    return *std::min_element(s.rounds.begin(), s.rounds.end());
  };
  return !c.before.rounds.empty() && !c.after.rounds.empty() && fastest(c.after) > times * fastest(c.before);
}

// Errors are identical in every run of the same program. A change from an error of 0 to any other counts as
// infinitely worse, and so does an error that no longer exists.
void compare_errors(WorkComparison& c) {
  double worst = -1;
  for (std::size_t k = 0; k < work_metrics.size(); ++k) {
    const double before = c.before.metric[k], after = c.after.metric[k];
    if (!is_error(k) || std::isnan(before)) continue;
    const double ratio = before == after     ? 1
                         : std::isnan(after) ? std::numeric_limits<double>::infinity()
                                             : after / before;
    if (!(ratio > worst)) continue;
    worst = ratio;
    c.worst_metric = work_metrics[k];
    c.error_ratio = ratio;
  }
}

}  // namespace

std::vector<WorkComparison> compare_work(const std::vector<WorkSample>& before,
                                         const std::vector<WorkSample>& after, double tolerance) {
  std::vector<WorkComparison> result;
  for (const WorkSample& s : after) {
    const auto other =
        std::find_if(before.begin(), before.end(), [&](const WorkSample& b) { return same_question(b, s); });
    if (other == before.end()) continue;
    WorkComparison c;
    c.before = *other;
    c.after = s;
    if (!s.failure.empty() || !other->failure.empty()) {
      c.verdict = !s.failure.empty() && other->failure.empty() ? "failed" : "same";
    } else {
      c.time = time_ratio(other->rounds, s.rounds);
      compare_errors(c);
      const double more = 1 + tolerance;
      c.verdict = "same";
      if (c.error_ratio > more)
        c.verdict = "less exact";
      else if (std::isinf(c.time.high))
        c.verdict = "undetermined";
      else if (c.time.low > more && fastest_agrees(c, more))
        c.verdict = "slower";
      else if (c.time.high < 1 / more && !fastest_agrees(c, 1 / more))
        c.verdict = "faster";
    }
    result.push_back(std::move(c));
  }
  return result;
}

}  // namespace darboux
