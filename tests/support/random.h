/// \file random.h
/// Random numbers of tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>

#include <darboux/vector.h>

namespace darboux::test {

/// A random stream whose seed is printed, so that a failure can be run again.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine(seed) { std::cout << "seed " << seed << '\n'; }
  double uniform(double from = 0, double to = 1) {
    return std::uniform_real_distribution<double>(from, to)(engine);
  }
  /// 10^x with x uniform.
  double log_uniform(double from, double to) {
    return std::pow(10.0, uniform(std::log10(from), std::log10(to)));
  }
  double sign() { return engine() % 2 == 0 ? 1 : -1; }
  std::uint64_t bits() { return engine(); }
  Vec3<double> direction() {
    std::normal_distribution<double> normal;
    const Vec3<double> a{normal(engine), normal(engine), normal(engine)};
    return a / std::sqrt(dot(a, a));
  }
  double normal() { return gauss_(engine); }

  std::mt19937_64 engine;

 private:
  std::normal_distribution<double> gauss_;
};

}  // namespace darboux::test
