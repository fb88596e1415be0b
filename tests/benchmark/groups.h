/// \file groups.h
/// What is timed in turns: groups of ways, by name.
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
  std::vector<Way> ways;

  void add(const std::string& shape, const std::string& method, std::size_t points,
           std::function<void()> run) {
    ways.push_back({shape, method, points, std::move(run)});
  }
  const Way* find(const std::string& shape, const std::string& method) const {
    for (const Way& way : ways)
      if (way.shape == shape && way.method == method) return &way;
    return nullptr;
  }
  const Way& at(const std::string& shape, const std::string& method) const {
    if (const Way* way = find(shape, method)) return *way;
    throw std::logic_error("no way " + shape + " / " + method + " in " + name);
  }
  // The fastest way to write what has this shape.
  const Way& limit(const std::string& shape) const {
    const Way* best = nullptr;
    for (const Way& way : ways)
      if (way.shape == shape && way.method.starts_with("limit") &&
          (best == nullptr || median(way.ns) < median(best->ns)))
        best = &way;
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
