// The kinds that fits through uvs know: what linear() says holds.
#include "fit/uv/uv_kinds.h"

#include <iostream>
#include <random>

#include <gtest/gtest.h>

namespace darboux::uv_kinds_test {
namespace {

constexpr std::uint64_t seed = 42;

Eigen::VectorXd positions(const UvKind& kind, const std::vector<double>& parameters,
                          const std::vector<Vec2<double>>& uvs) {
  UvBlock block{Eigen::VectorXd(3 * static_cast<Eigen::Index>(uvs.size())), {}, {}};
  kind.evaluate(parameters.data(), uvs, block);
  return block.position;
}

// P(p + q) = P(p) + P(q), to rounding; at least one of each is among the kinds.
TEST(UvKinds, LinearOnesAre) {
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  int linear = 0, others = 0;
  for (const UvKind& kind : uv_kinds()) {
    std::vector<Vec2<double>> uvs(50);
    for (Vec2<double>& uv : uvs) uv = {uniform(random), uniform(random)};
    std::vector<double> p, q, sum;
    for (int k = 0; k < kind.parameter_count(); ++k) {
      p.push_back(uniform(random)), q.push_back(uniform(random));
      sum.push_back(p.back() + q.back());
    }
    const Eigen::VectorXd both = positions(kind, p, uvs) + positions(kind, q, uvs);
    const double off = (positions(kind, sum, uvs) - both).norm() / both.norm();
    if (kind.linear())
      EXPECT_LT(off, 1e-14) << kind.name;
    else
      EXPECT_GT(off, 1e-3) << kind.name;
    ++(kind.linear() ? linear : others);
  }
  EXPECT_GT(linear, 0);
  EXPECT_GT(others, 0);
}

}  // namespace
}  // namespace darboux::uv_kinds_test
