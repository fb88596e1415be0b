/// \file rounds.h
/// Times several alternatives in alternating rounds, so that a drift of the clock affects all of them.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace darboux {

namespace rounds {

inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Whether an item stores its failure; otherwise exceptions propagate.
template <class Item>
constexpr bool keeps_failures = requires(Item& item) {
  item.failure = std::string();
};

struct TimedOut : std::runtime_error {
  explicit TimedOut(double seconds)
      : std::runtime_error("timed out: a call took " + std::to_string(seconds) + " s") {}
};

/// Calls f unless the item has failed.
template <class Item, class F>
void guarded(Item& item, F f) {
  if constexpr (keeps_failures<Item>) {
    if (!item.failure.empty()) return;
    try {
      f();
    } catch (const TimedOut& e) {
      item.failure = e.what();
    } catch (const std::bad_alloc&) {
      item.failure = "failed: needs more memory than there is";
    } catch (const std::exception& e) {
      item.failure = std::string("failed: ") + e.what();
    }
  } else {
    f();
  }
}

}  // namespace rounds

/// Times all items one after the other, for a number of rounds. In a round each is called often enough to
/// fill half a millisecond, at most 200 times; an item whose call takes less than 10 ms is called once
/// untimed directly before. An item has
///   run()                  what is timed
///   std::size_t points     in a call
///   std::vector<double> ns nanoseconds per point, one is added in each round
/// and may have
///   std::string failure    why it has no times: what run() threw, or that a call took more than `timeout`
///                          seconds, in whichever round. It is not called again, the others are. Without it
///                          exceptions pass on.
/// A call is not interrupted: it is judged when it has ended. \param after called after each round
template <class Item, class After>
void time_in_rounds(std::vector<Item>& items, int count, double timeout, After after) {
  const auto seconds = [](Item& item, int calls) {
    const double from = rounds::now();
    for (int i = 0; i < calls; ++i) item.run();
    return rounds::now() - from;
  };
  std::vector<int> calls(items.size(), 1);
  std::vector<bool> warmed(items.size());
  for (std::size_t k = 0; k < items.size(); ++k)
    rounds::guarded(items[k], [&] {
      double once = seconds(items[k], 1);
      if (once <= timeout) once = seconds(items[k], 1);
      if (once > timeout) throw rounds::TimedOut(once);
      warmed[k] = once < 10e-3;
      calls[k] = std::clamp(static_cast<int>(0.5e-3 / std::max(once, 1e-7)), 1, 200);
    });
  for (int round = 0; round < count; ++round) {
    for (std::size_t k = 0; k < items.size(); ++k)
      rounds::guarded(items[k], [&] {
        if (warmed[k]) items[k].run();
        const double once = seconds(items[k], calls[k]) / calls[k];
        if (once > timeout) throw rounds::TimedOut(once);
        items[k].ns.push_back(once * 1e9 / static_cast<double>(items[k].points));
      });
    after();
  }
}

}  // namespace darboux
