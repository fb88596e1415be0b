// Quantiles, and what is timed in rounds.
#include "base/rounds.h"

#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/quantile.h"

namespace darboux::rounds_test {
namespace {

TEST(Quantile, LiesBetweenTheRanks) {
  const std::vector<double> four{4, 1, 3, 2};
  EXPECT_EQ(quantile(four, 0), 1);
  EXPECT_EQ(quantile(four, 1), 4);
  EXPECT_EQ(quantile(four, 0.5), 2.5);
  EXPECT_EQ(quantile(four, 0.25), 1.75);
  EXPECT_EQ(quantile({7}, 0.75), 7);
}

struct Item {
  std::function<void()> run;
  std::size_t points = 1;
  std::vector<double> ns{};
  std::string failure{};
};

// Every item once per round, whatever else it is.
TEST(Rounds, AllItemsTakeTurns) {
  std::string order;
  const auto slow = [&](char name) {
    return [&order, name] {
      if (order.empty() || order.back() != name) order += name;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
  };
  std::vector<Item> items{{slow('a')}, {slow('b')}};
  time_in_rounds(items, 3, 10, [&] { order += '.'; });
  EXPECT_EQ(order, "abab.ab.ab.");
  for (const Item& item : items) EXPECT_EQ(item.ns.size(), 3u);
}

// A call that becomes slow in some round is a failure; the others go on.
TEST(Rounds, TimeOutInALaterRound) {
  int calls = 0;
  std::vector<Item> items{{[&] {
                            if (++calls > 20) std::this_thread::sleep_for(std::chrono::milliseconds(60));
                            std::this_thread::sleep_for(std::chrono::milliseconds(1));
                          }},
                          {[] {}}};
  time_in_rounds(items, 30, 50e-3, [] {});
  EXPECT_NE(items[0].failure.find("timed out"), std::string::npos) << items[0].failure;
  EXPECT_LT(calls, 25);
  EXPECT_EQ(items[1].ns.size(), 30u);
  EXPECT_EQ(items[1].failure, "");
}

}  // namespace
}  // namespace darboux::rounds_test
