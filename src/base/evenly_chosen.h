// Chooses some of many, spread evenly. A fixed stride could coincide with the row length of a grid and sample
// only one column.

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace darboux {

/// Indices below `of`, ascending: one at random from each of `count` intervals; all indices if there are no
/// more than that.
inline std::vector<std::ptrdiff_t> evenly_chosen(std::ptrdiff_t of, std::ptrdiff_t count,
                                                 std::mt19937_64& random) {
  count = std::min(of, count);
  std::vector<std::ptrdiff_t> chosen;
  chosen.reserve(static_cast<std::size_t>(count));
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t from = i * of / count, to = (i + 1) * of / count;
    chosen.push_back(from + static_cast<std::ptrdiff_t>(random() % static_cast<std::uint64_t>(to - from)));
  }
  return chosen;
}

/// The same choice on every call.
inline std::vector<std::size_t> evenly_chosen(std::size_t of, std::size_t count) {
  std::vector<std::size_t> chosen;
  if (of <= count) {
    for (std::size_t i = 0; i < of; ++i) chosen.push_back(i);
    return chosen;
  }
  std::mt19937_64 random(1);
  for (const std::ptrdiff_t i :
       evenly_chosen(static_cast<std::ptrdiff_t>(of), static_cast<std::ptrdiff_t>(count), random))
    chosen.push_back(static_cast<std::size_t>(i));
  return chosen;
}

}  // namespace darboux
