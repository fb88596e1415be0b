/// \file groups.h
/// What is timed in turns: groups of methods, by name.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <darboux/evaluate.h>

#include "measure.h"

namespace darboux::bench {

inline constexpr std::size_t many = std::size_t{1} << 20, few = 4096;
inline constexpr std::array<std::size_t, 2> thread_sizes{many, std::size_t{1} << 14};
inline std::string size_name(std::size_t n) {
  return "2^" + std::to_string(static_cast<int>(std::log2(static_cast<double>(n))));
}

inline constexpr std::array<std::size_t, 12> crossover_sizes{1, 2, 4, 6, 8, 10, 12, 16, 24, 32, 48, 64};

struct Group {
  std::string name;  // surface/scalar/regime
  std::vector<Timing> timings;

  void add(const std::string& shape, const std::string& method, std::size_t points,
           std::function<void()> run) {
    timings.push_back({shape, method, points, std::move(run)});
  }
  const Timing* find(const std::string& shape, const std::string& method) const {
    for (const Timing& timing : timings)
      if (timing.shape == shape && timing.method == method) return &timing;
    return nullptr;
  }
  const Timing& at(const std::string& shape, const std::string& method) const {
    if (const Timing* timing = find(shape, method)) return *timing;
    throw std::logic_error("no timing of " + shape + " / " + method + " in " + name);
  }
  // The fastest method of writing what has this shape.
  const Timing& limit(const std::string& shape) const {
    const Timing* best = nullptr;
    for (const Timing& timing : timings)
      if (timing.shape == shape && timing.method.starts_with("limit") &&
          (best == nullptr || median(timing.ns) < median(best->ns)))
        best = &timing;
    if (best == nullptr) throw std::logic_error("no limit for " + shape + " in " + name);
    return *best;
  }
};

inline std::string ours(InstructionSet set) {
  return "Darboux, " + std::string(darboux::name_of(set));
}
inline std::string best_of_ours() {
  return ours(instruction_sets().back());
}

}  // namespace darboux::bench
