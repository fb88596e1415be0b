// Compiled once for a mutation run and linked with each mutant, which defines mutated_surface(). Exit code: 0
// all laws hold, 1 one does not (told on stdout), 2 wrong usage. Includes no surface: those come from the
// mutant alone.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/error.h>
#include <darboux/testing.h>

#include "base/text.h"

namespace darboux {

// The surface under test with its defaults, and others of its type that its defaults do not show.
std::vector<AnySurface> mutated_surfaces();

// As in any_surface.cpp, which would bring the catalogue unmutated.
std::string AnySurface::specification(int) const {
  std::string text(info().name);
  char separator = ':';
  for (const ParameterValue& p : parameters()) {
    text += separator + std::string(p.name) + "=" + shortest(p.value);
    separator = ',';
  }
  return text;
}

namespace {

bool holds(const AnySurface& surface, const CheckOptions& options) {
  for (const Check& c : check_surface(surface, options))
    if (!c.passed) {
      std::cout << c.route << " of " << c.quantity << " at " << c.worst_u << ", " << c.worst_v << " of "
                << (c.worst_surface.empty() ? surface.specification() : c.worst_surface) << ": "
                << c.max_error << " > " << c.bound << '\n';
      return false;
    }
  return true;
}

// Parameters near the defaults, none equal to another, 0 left as well.
std::vector<AnySurface> varied(const AnySurface& surface, int count) {
  std::vector<AnySurface> result;
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int attempt = 0; attempt < 100 && static_cast<int>(result.size()) < count; ++attempt) {
    std::vector<double> values;
    for (const ParameterValue& p : surface.parameters()) {
      const double factor = std::exp2(2 * uniform(random) - 1), sign = uniform(random) < 0.5 ? -1 : 1;
      double x = p.value == 0 ? sign * factor / 4 : p.value * factor;
      if (!p.permitted.contains(x)) x = std::fabs(x);
      values.push_back(x);
    }
    if (values.empty()) break;
    try {
      result.push_back(surface.with(values));
    } catch (const ParameterError&) {
      // These do not go together: others.
    }
  }
  return result;
}

int check() {
  const std::vector<std::string> quick{"dual", "implicit", "second_formula", "curvature", "periodicity"},
      theorems{"gauss", "codazzi"}, stencils{"central4", "one_sided8"},
      many{"high_precision", "high_precision_float"};
  std::vector<AnySurface> all;
  for (const AnySurface& surface : mutated_surfaces())  // most are found at once
    if (!holds(surface, {.points = 10, .seed = 4, .routes = quick})) return 1;
  for (const AnySurface& surface : mutated_surfaces()) {
    all.push_back(surface);
    for (const AnySurface& other : varied(surface, 4)) all.push_back(other);
  }
  for (const std::vector<std::string>& routes : {quick, theorems})
    for (const AnySurface& surface : all)
      if (!holds(surface, {.points = 150, .seed = 5, .routes = routes})) return 1;
  for (const AnySurface& surface : all)
    if (!holds(surface, {.points = 40, .seed = 6, .routes = many})) return 1;
  for (const AnySurface& surface : mutated_surfaces())
    if (!holds(surface, {.points = 50, .seed = 7, .routes = many, .parameter_sets = 10})) return 1;
  for (const AnySurface& surface : all)
    if (!holds(surface, {.points = 60, .seed = 8, .routes = stencils})) return 1;
  for (const AnySurface& surface : mutated_surfaces())
    if (!holds(surface, {.points = 60,
                         .seed = 9,
                         .routes = {"central2", "central6", "central8", "ridders", "gauss_bonnet"}}))
      return 1;
  return 0;
}

// All that a surface tells, at many points with many parameters, as raw doubles: two mutants with the same
// output are one.
int values() {
  const auto write = [](double x) {
    if (x == 0 || std::isnan(x)) x = std::fabs(x);  // -0 is 0
    std::fwrite(&x, sizeof x, 1, stdout);
  };
  const auto write_vector = [&](const auto& a) { write(a.x), write(a.y), write(a.z); };
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> special{0, 1, 1e-300, 1e-20, 1e-9};
  for (const double x : {0.125, 0.25, 1.0 / 3, 0.5, 2.0 / 3, 0.75, 1.0})
    for (const double y : {std::nextafter(x, 0.0), x, std::nextafter(x, 1.0)}) special.push_back(y);
  for (const AnySurface& surface : mutated_surfaces()) {
    std::vector<AnySurface> all = varied(surface, 20);
    all.insert(all.begin(), surface);
    for (const AnySurface& s : all)
      for (int i = 0; i < 1000; ++i) {
        const double u = i % 4 == 1 ? special[random() % special.size()] : uniform(random),
                     v = i % 4 >= 2 ? special[random() % special.size()] : uniform(random);
        const Sample<double> sample = s.sample(u, v);
        const Jet2<double>& j = sample.jet;
        for (const Vec3<double>* a : {&j.position, &j.dpdu, &j.dpdv, &j.d2pdu2, &j.d2pduv, &j.d2pdv2})
          write_vector(*a);
        for (const Vec3<double>* a : {&sample.frame.t, &sample.frame.b, &sample.frame.n}) write_vector(*a);
        write(sample.frame.handedness), write(static_cast<double>(sample.frame.status));
        Vec3<double> beside = j.position;
        beside = beside + (uniform(random) - 0.5) * Vec3<double>{1, 0.5, uniform(random)};
        for (const Vec3<double>& p : {j.position, beside}) write(s.implicit(p).value_or(0));
        write(s.gaussian_curvature(u, v).value_or(0)), write(s.mean_curvature(u, v).value_or(0));
        write_vector(s.second_formula(u, v).value_or(Vec3<double>{0, 0, 0}));
      }
  }
  return 0;
}

}  // namespace
}  // namespace darboux

int main(int count, char** arguments) {
  if (count == 2 && std::strcmp(arguments[1], "check") == 0) return darboux::check();
  if (count == 2 && std::strcmp(arguments[1], "values") == 0) return darboux::values();
  std::cerr << "usage: mutant check|values\n";
  return 2;
}
