/// \file measure.h
/// Times several methods of doing the same, in turns, so that a drift of the clock meets all of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/rounds.h"

namespace darboux::bench {

inline constexpr std::uint64_t seed = 20240229;

/// Memory that was written to, aligned to a page.
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t bytes)
      : memory_(static_cast<char*>(std::aligned_alloc(4096, (bytes + 4095) / 4096 * 4096)), &std::free) {
    if (memory_ == nullptr) throw std::bad_alloc();
    std::memset(memory_.get(), 1, bytes);
  }
  char* data() const { return memory_.get(); }

 private:
  std::unique_ptr<char, void (*)(void*)> memory_{nullptr, &std::free};
};

/// Random points in [0, 1)², the same in every run.
template <class T>
class RandomPoints {
 public:
  explicit RandomPoints(std::size_t count)
      : buffer_((2 * count + gap) * sizeof(T)),
        u_(reinterpret_cast<T*>(buffer_.data())),
        v_(u_ + count + gap) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::size_t i = 0; i < count; ++i) {
      u_[i] = static_cast<T>(uniform(random));
      v_[i] = static_cast<T>(uniform(random));
    }
  }
  const T* u() const { return u_; }
  const T* v() const { return v_; }

 private:
  static constexpr std::size_t gap = 320 / sizeof(T);
  Buffer buffer_;
  T *u_, *v_;
};

inline double median(std::vector<double> x) {
  if (x.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

/// Something to be timed.
struct Timing {
  std::string shape;   ///< what is written, e.g. "18, separate arrays"
  std::string method;  ///< by whom
  std::size_t points;  ///< in a call
  std::function<void()> run;
  std::vector<double> ns{};  ///< a point, in each round

  double best() const { return ns.empty() ? median(ns) : *std::min_element(ns.begin(), ns.end()); }
};

/// The median over the rounds of a's time over b's in the same round.
inline double ratio(const Timing& a, const Timing& b) {
  std::vector<double> all;
  for (std::size_t r = 0; r < std::min(a.ns.size(), b.ns.size()); ++r) all.push_back(a.ns[r] / b.ns[r]);
  return median(all);
}

/// Times all of them in turns, so many rounds.
inline void measure(std::vector<Timing>& timings, int rounds) {
  time_in_rounds(timings, rounds, std::numeric_limits<double>::infinity(), [] {});
}

}  // namespace darboux::bench
