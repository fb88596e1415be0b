// Time against measured error of every method of evaluation, on every surface of the catalogue, in double and
// float: CSV on stdout. 4096 random points into memory that stays in the cache; errors at the first 2000 of
// them against 40 digits.
//   benchmark_work_precision [--quick]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>
#include <darboux/evaluate.h>
#include <darboux/multiprecision.h>

#include "baselines.h"
#include "measure.h"

namespace darboux::bench {
namespace {

constexpr std::size_t timed_points = 4096, checked_points = 2000;
constexpr Layout layout = Layout::separate;
constexpr Wanted wanted = Wanted::all;

char* memory() {
  static const Buffer buffer(18 * (timed_points * sizeof(double) + 320));
  return buffer.data();
}

// The 18 numbers of each point that is checked, in 40 digits.
using Exact = std::vector<std::array<Multiprecision, 18>>;
template <class T>
Exact exact(const AnySurface& surface, const RandomPoints<T>& points) {
  Exact result(checked_points);
  for (std::size_t i = 0; i < checked_points; ++i) {
    const auto u = static_cast<double>(points.u()[i]), v = static_cast<double>(points.v()[i]);
    const Jet2<Multiprecision> j = surface.jet(Multiprecision(u), Multiprecision(v));
    const Vec3<Multiprecision> t = unit(j.dpdu), n = unit(cross(j.dpdu, j.dpdv));
    std::size_t k = 0;
    for (const Vec3<Multiprecision>& a : {j.position, j.dpdu, j.dpdv, t, cross(n, t), n}) {
      result[i][k++] = a.x;
      result[i][k++] = a.y;
      result[i][k++] = a.z;
    }
  }
  return result;
}

struct Errors {
  double frame = 0, partials = 0;
};
// Of the numbers in memory: components of t, b, n; of position, dpdu and dpdv over the longest of each.
template <class T>
Errors errors(const Exact& exact, const Destination& place) {
  Errors result;
  for (std::size_t vector = 0; vector < 6; ++vector) {
    double largest = 0, length = vector < 3 ? 0 : 1;
    for (std::size_t i = 0; i < checked_points; ++i) {
      double square = 0;
      for (std::size_t k = 3 * vector; k < 3 * vector + 3; ++k) {
        const auto computed = static_cast<double>(*number_at<T>(layout, wanted, place, k, i));
        const auto error = std::isfinite(computed)
                               ? std::fabs(static_cast<double>(Multiprecision(computed) - exact[i][k]))
                               : std::numeric_limits<double>::infinity();
        largest = std::max(largest, error);
        const auto size = static_cast<double>(exact[i][k]);
        square += size * size;
      }
      length = std::max(length, std::sqrt(square));
    }
    double& error = vector < 3 ? result.partials : result.frame;
    error = std::max(error, largest / length);
  }
  return result;
}

template <class T>
void rows(const AnySurface& surface, const CatalogueLoops<T>& loops, int rounds) {
  static const RandomPoints<T> points(timed_points);
  const Destination place = destination_of<T>(layout, wanted, memory(), timed_points);
  std::vector<Timing> timings;
  const auto add = [&](const std::string& method, std::function<void()> run) {
    timings.push_back({"", method, timed_points, std::move(run)});
  };
  const auto add_loop = [&](const std::string& method, typename CatalogueLoops<T>::Loop loop) {
    add(method, [=] { loop(points.u(), points.v(), timed_points, place); });
  };
  const auto add_by_hand = [&](const std::string& method, Method by, ByHand kind) {
    add(method,
        [=] { evaluate_by<T>(by, kind, layout, wanted, points.u(), points.v(), timed_points, place); });
  };
  const bool torus = loops.surface == "torus", sphere = loops.surface == "sphere";
  const ByHand kind = torus ? ByHand::torus : ByHand::sphere;
  if (torus || sphere) {
    add_by_hand("naive", Method::naive, kind);
    add_by_hand("closed-form", Method::closed_form, kind);
    add_by_hand("dual", Method::dual, kind);
    if (with_occt && std::same_as<T, double>) {
      add_by_hand("occt-d1", Method::occt_d1, kind);
      add_by_hand("occt-d2", Method::occt_d2, kind);
    }
  } else {
    add_loop("naive", loops.naive);
    add_loop("dual", loops.dual);
  }
  for (std::size_t k = 0; k < loops.differences.size(); ++k)
    add_loop("differences-" + std::to_string(2 * k + 2), loops.differences[k]);

  Outputs<T> outputs;
  constexpr std::array attributes{Attribute::position, Attribute::dpdu,      Attribute::dpdv,
                                  Attribute::tangent,  Attribute::bitangent, Attribute::normal};
  for (std::size_t a = 0; a < attributes.size(); ++a) {
    std::array<std::span<T>, 3> arrays;
    for (std::size_t c = 0; c < 3; ++c)
      arrays[c] = {number_at<T>(layout, wanted, place, 3 * a + c, 0), timed_points};
    outputs.separate(attributes[a], arrays);
  }
  for (const InstructionSet set : instruction_sets())
    add("darboux-" + std::string(name_of(set)), [&, set] {
      surface.evaluate(Points<T>::arrays({points.u(), timed_points}, {points.v(), timed_points}), outputs,
                       {.instruction_set = set});
    });

  measure(timings, rounds);
  const Exact truth = exact(surface, points);
  for (const Timing& timing : timings) {
    std::memset(memory(), 0xff, 18 * place.stride);
    timing.run();
    const Errors e = errors<T>(truth, place);
    std::printf("%s,%s,%s,%.3g,%.3g,%.3g\n", std::string(loops.surface).c_str(),
                std::same_as<T, double> ? "double" : "float", timing.method.c_str(), median(timing.ns),
                e.frame, e.partials);
  }
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  using namespace darboux;
  using namespace darboux::bench;
  const int rounds = argc > 1 && std::strcmp(argv[1], "--quick") == 0 ? 3 : 20;
  try {
    std::puts("surface,scalar,method,ns_per_point,frame_error,partial_error");
    std::size_t k = 0;
    Catalogue::for_each([&]<class X>(const X& surface) {
      std::fprintf(stderr, "%s ...\n", std::string(X::info.name).c_str());
      rows<double>(surface, catalogue_loops<double>()[k], rounds);
      // In float the parameters are those rounded to float.
      rows<float>(rebind<double>(rebind<float>(surface)), catalogue_loops<float>()[k], rounds);
      ++k;
    });
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_work_precision: %s\n", error.what());
    return 1;
  }
}
