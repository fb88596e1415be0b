// Typed tests over the catalogue, and random parameters for any surface in it.
#pragma once

#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>

namespace darboux {

/// What gtest shows of a surface.
inline void PrintTo(const AnySurface& surface, std::ostream* out) {
  *out << surface.specification();
}

}  // namespace darboux

namespace darboux::test {

template <class List>
struct SurfaceTypes;
template <class... Surfaces>
struct SurfaceTypes<SurfaceList<Surfaces...>> {
  using type = ::testing::Types<Surfaces...>;
};
/// The catalogue for TYPED_TEST_SUITE.
using EveryCatalogueSurface = SurfaceTypes<Catalogue>::type;

/// Names the typed tests by surface.
struct SurfaceNames {
  template <class X>
  static std::string GetName(int) {
    return std::string(X::info.name);
  }
};

/// A random stream whose seed is printed, so that a failure can be run again.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) { std::cout << "seed " << seed << '\n'; }
  double uniform(double from = 0, double to = 1) {
    return std::uniform_real_distribution<double>(from, to)(engine_);
  }
  /// 10^x with x uniform.
  double log_uniform(double from, double to) {
    return std::pow(10.0, uniform(std::log10(from), std::log10(to)));
  }
  double sign() { return engine_() % 2 == 0 ? 1 : -1; }
  std::uint64_t bits() { return engine_(); }
  Vec3<double> direction() {
    std::normal_distribution<double> normal;
    const Vec3<double> a{normal(engine_), normal(engine_), normal(engine_)};
    return a / std::sqrt(dot(a, a));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace darboux::test
