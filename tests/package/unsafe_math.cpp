// Whether frames and partials are right, to a few roundings, whatever options this is compiled with.
#include <cmath>
#include <cstdio>
#include <numbers>

#include <darboux/catalogue.h>
#include <darboux/evaluate.h>

int main(int argc, char**) {
  double worst = 0;
  const auto compare = [&](double x, double y) {
    if (!(std::fabs(x - y) <= worst)) worst = std::fabs(x - y);
  };
  for (int i = 0; i < 500; ++i) {
    const double u = 0.013 * i * argc, v = 0.0019 * i * argc, angle = 2 * std::numbers::pi * u;
    const auto torus = frame(darboux::Torus{1.0, 0.4}, u, v);
    compare(torus.t.x, -std::sin(angle));
    compare(torus.t.y, std::cos(angle));
    for (const auto& f : {torus, frame(darboux::Sphere{2.0}, u, v), frame(darboux::Catenoid{}, u, v),
                          frame(darboux::Superellipsoid{1.0, 0.7, 0.5, 0.5, 0.7}, u, v)}) {
      compare(dot(f.t, f.n), 0);
      compare(dot(f.t, f.t), 1);
      compare(dot(f.n, f.n), 1);
    }
    compare(darboux::exp(v) / std::exp(v), 1);
    compare(darboux::sincos_turns(1024 + u).sin, std::sin(angle));
  }
  // 1024 + u is rounded by 1e-13 of a turn; a range that is not reduced is off by 1.
  constexpr double tolerance = 1e-11;
  std::printf("worst %.3g\n", worst);
  return worst < tolerance ? 0 : 1;
}
