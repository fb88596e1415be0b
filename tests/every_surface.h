// Typed tests over the catalogue, and random parameters for any surface in it.
#pragma once

#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>

namespace darboux::test {

template <class List>
struct SurfaceTypes;
template <template <class> class... Surfaces>
struct SurfaceTypes<SurfaceList<Surfaces...>> {
  using type = ::testing::Types<Surfaces<double>...>;
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

/// Random parameters, each within [smallest, largest]: half of the time of unrelated sizes, else within a
/// factor 4 of each other.
template <class X>
X random_surface(Random& random, double smallest, double largest) {
  X surface;
  const bool related = random.bits() % 2 == 0;
  const double size = random.log_uniform(4 * smallest, largest / 4);
  for_each_parameter<X>([&](const auto& p) {
    const double value = related ? size * random.log_uniform(0.25, 4) : random.log_uniform(smallest, largest);
    if (p.permitted.contains(value)) p.of(surface) = value;
  });
  return surface;
}

/// The side of the surface to which n belongs: the sign of det(dpdu, dpdv, n). Only a surface that states its
/// own orientation has another than +1.
template <class X, class V>
int stated_handedness(const X&, const V&) {
  return 1;
}
/// The torus: n points out of the tube, so -1 where R + r cos 2πv < 0.
template <class T, class S>
int stated_handedness(const Torus<T>& torus, const Turn<S>& v) {
  return lift<S>(torus.major_radius) + lift<S>(torus.minor_radius) * v.cos < 0 ? -1 : 1;
}

}  // namespace darboux::test
