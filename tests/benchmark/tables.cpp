#include "tables.h"

#include <cmath>
#include <functional>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <darboux/evaluate.h>

#include "baselines.h"
#include "measure.h"

namespace darboux::bench {
namespace {

std::string number(double x, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << std::fixed << x;
  return text.str();
}
std::string nanoseconds(const Timing& timing) {
  return number(timing.best(), 2) + " / " + number(median(timing.ns), 2);
}

class Report {
 public:
  explicit Report(const std::vector<Group>& groups) : groups_(groups) {}

  void write() const {
    targets();
    std::cout
        << "\n### Torus and sphere\n\n"
           "Columns, for each surface: nanoseconds a point, best / median; how many times as fast as the "
           "naive loop\n"
           "writing the same numbers to the same layout; the time over the write limit of the same layout.\n";
    for (const std::string regime : {"memory", "L2"})
      for (const std::string scalar : {"double", "float"}) by_hand(regime, scalar);
    points();
    splines();
    catalogue();
    threads();
    stores();
  }

 private:
  const Group& group(const std::string& name) const {
    for (const Group& g : groups_)
      if (g.name == name) return g;
    throw std::logic_error("no group " + name);
  }

  // The shape whose naive loop and limit a method is held against.
  static std::string compared_with(const std::string& shape) {
    if (shape.starts_with("grid: ")) return shape.substr(6);
    return shape == "18, then the sum of the normals" ? "18, separate arrays" : shape;
  }
  static double over_naive(const Group& g, const Timing& timing) {
    return ratio(g.at(compared_with(timing.shape), "naive Eigen loop"), timing);
  }
  static double over_limit(const Group& g, const Timing& timing) {
    return ratio(timing, g.limit(compared_with(timing.shape)));
  }

  void by_hand(const std::string& regime, const std::string& scalar) const {
    const Group &torus = group("torus/" + scalar + "/" + regime),
                &sphere = group("sphere/" + scalar + "/" + regime);
    std::cout << "\n#### " << scalar << ", " << regime << "\n\n"
              << "| written | by | torus, ns | × naive | / limit | sphere, ns | × naive | / limit |\n"
              << "|---|---|---:|---:|---:|---:|---:|---:|\n";
    const auto row = [&](const std::string& shape, const std::string& method, auto&& timing_of) {
      std::cout << "| " << shape << " | " << method;
      for (const Group* g : {&torus, &sphere}) {
        const Timing& x = timing_of(*g);
        std::cout << " | " << nanoseconds(x) << " | " << number(over_naive(*g, x), 2) << " | "
                  << number(over_limit(*g, x), 2);
      }
      std::cout << " |\n";
    };
    std::string last_limit;
    for (const Timing& timing : torus.timings) {
      // The registers' widths are told apart for the first shape; of the others the fastest is shown.
      if (!timing.method.starts_with("limit") || timing.shape == torus.timings.front().shape) {
        row(timing.shape, timing.method,
            [&](const Group& g) -> const Timing& { return g.at(timing.shape, timing.method); });
      } else if (timing.shape != last_limit) {
        last_limit = timing.shape;
        row(timing.shape, timing.method.substr(0, timing.method.find(',')),
            [&](const Group& g) -> const Timing& { return g.limit(timing.shape); });
      }
    }
    if (!with_occt && scalar == "double")
      std::cout << "\nWithout OCCT: its development packages were not there when this was built.\n";
  }

  // "grid: 18, separate arrays" in double as "grid: 18 doubles, separate arrays".
  static std::string titled(const std::string& scalar, std::string shape) {
    const std::size_t at = shape.find("18");
    return at == std::string::npos ? shape + " in " + scalar : shape.insert(at + 2, " " + scalar + "s");
  }

  // One row of the targets: the value on each surface, and whether all reach it.
  static void target(const std::string& what, const std::string& required, const std::vector<double>& values,
                     const std::function<bool(double)>& reached, const char* unit) {
    bool all = true;
    std::cout << "| " << what << " | " << required << " |";
    for (const double value : values) {
      std::cout << ' ' << number(value, 2) << unit << " |";
      all = all && reached(value);
    }
    std::cout << (all ? " pass |\n" : " **missed** |\n");
  }

  void targets() const {
    std::cout << "### Targets\n\n";
    if (ours(InstructionSet::avx512) != best_of_ours())
      std::cout << "The targets are for AVX-512, which this machine or build does not have.\n\n";
    std::cout << "| what | required | torus | sphere | |\n|---|---|---:|---:|---|\n";
    const auto both = [&](const std::string& scalar, const std::string& regime, auto&& value) {
      return std::vector{value(group("torus/" + scalar + "/" + regime)),
                         value(group("sphere/" + scalar + "/" + regime))};
    };
    const auto at_most_limit = [&](const std::string& scalar, const std::string& shape,
                                   const std::string& method, double most) {
      target(
          titled(scalar, shape) + ", memory" + (method == best_of_ours() ? "" : ", " + method),
          "<= " + number(most, 2) + " × limit",
          both(scalar, "memory", [&](const Group& g) { return over_limit(g, g.at(shape, method)); }),
          [=](double x) { return x <= most; }, "");
    };
    const auto times_naive = [&](const std::string& scalar, const std::string& regime,
                                 const std::string& shape, const std::string& method, double least) {
      target(
          titled(scalar, shape) + ", " + regime + (method == best_of_ours() ? "" : ", " + method),
          ">= " + number(least, 0) + " × naive",
          both(scalar, regime, [&](const Group& g) { return over_naive(g, g.at(shape, method)); }),
          [=](double x) { return x >= least; }, "");
    };
    const std::string separate = "18, separate arrays", vectors = "18, vec3 arrays",
                      structs = "18, array of structs";
    for (const std::string scalar : {"double", "float"}) {
      at_most_limit(scalar, separate, best_of_ours(), scalar == "double" ? 1.2 : 1.15);
      times_naive(scalar, "memory", separate, best_of_ours(), scalar == "double" ? 7 : 8);
      at_most_limit(scalar, vectors, best_of_ours(), 1.25);
      at_most_limit(scalar, structs, best_of_ours(), 1.3);
      at_most_limit(scalar, "grid: " + separate, best_of_ours(), 1.1);
      at_most_limit(scalar, "grid: " + structs, best_of_ours(), 1.3);
      times_naive(scalar, "L2", separate, best_of_ours(), scalar == "double" ? 13 : 16);
    }
    times_naive("float", "L2", "t, b, n, vec3 arrays", best_of_ours(), 30);
    times_naive("float", "L2", "tangent4", best_of_ours(), 40);
    for (const std::string scalar : {"double", "float"}) {
      if (const std::string avx2 = ours(InstructionSet::avx2);
          group("torus/double/L2").find(separate, avx2)) {
        at_most_limit(scalar, separate, avx2, 1.25);
        times_naive(scalar, "L2", separate, avx2, 10);
      }
      if (const std::string base = ours(InstructionSet::baseline);
          group("torus/double/L2").find(separate, base))
        times_naive(scalar, "L2", separate, base, 5);
    }
    for (const std::string scalar : {"double", "float"})
      for (const std::size_t n : thread_sizes) {
        const auto gain = [&](const Group& g, const std::string& by) {
          return ratio(g.at(size_name(n), by + "1"), g.at(size_name(n), by + "2"));
        };
        // Of what is asked: 1.7, or 0.95 of what two threads gain that only write.
        if (std::thread::hardware_concurrency() >= 2)
          target(
              scalar + ", two threads, " + size_name(n) + " points, over what is asked",
              ">= min(1.7, 0.95 × the limit's gain) × one",
              both(scalar, "threads",
                   [&](const Group& g) { return gain(g, "") / std::fmin(1.7, 0.95 * gain(g, "limit ")); }),
              [](double x) { return x >= 1; }, "");
      }
    const auto tangent4_share = [&](const Group& g) {
      return ratio(g.at("tangent4", best_of_ours()), g.at(separate, best_of_ours()));
    };
    std::cout << "| float, tangent4 alone, L2 | torus: <= 0.25 × the 18 numbers | "
              << number(tangent4_share(group("torus/float/L2")), 2) << " | "
              << number(tangent4_share(group("sphere/float/L2")), 2) << " | "
              << (tangent4_share(group("torus/float/L2")) <= 0.25 ? "pass" : "**missed**") << " |\n";
    points_and_splines();
    std::string below;
    for (const CatalogueLoops<double>& x : catalogue_loops<double>()) {
      if (catalogue_ratio(x) >= 5) continue;
      below += (below.empty() ? "" : ", ") + std::string(x.surface);
    }
    std::cout << "| every surface of the catalogue, double, L2 | >= 5 × its own naive loop | see below | | "
              << (below.empty() ? "pass" : "**missed**: " + below) << " |\n"
              << "| accuracy | frames 4u or 8u, partials 8u, times 1 + condition, on every path | | | held "
                 "by `darboux "
                 "check` and, bit for bit on every instruction set, by tests/evaluate/batch_test.cpp |\n";
  }

  void points_and_splines() const {
    for (const auto& [shape, most] : {std::pair<std::string, double>{"18, separate arrays", 1.0},
                                      std::pair<std::string, double>{"t, b, n, separate arrays", 0.6}}) {
      const auto share = [&](const std::string& surface) {
        const Group& g = group(surface + "/double/points");
        return ratio(g.at(shape, "points"), g.at(shape, "naive"));
      };
      target(
          "single points in double: " + shape, "<= " + number(most, 1) + " × the time of naive",
          {share("torus"), share("sphere")}, [=](double x) { return x <= most; }, "");
    }
    const Group& g = group("spline/double/L2");
    const std::string all = "18, separate arrays", position = "position, separate arrays";
    const Timing& textbook = g.at(all, "textbook loop");
    const auto row = [&](const std::string& what, double least, const std::string& unit, double value) {
      std::cout << "| bicubic B-spline, double, L2: " << what << " | >= " << number(least, 1) << unit << " | "
                << number(value, 2) << " | | " << (value >= least ? "pass" : "**missed**") << " |\n";
    };
    for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
      if (g.find(all, ours(set)) == nullptr) continue;
      const std::string by = ", " + std::string(darboux::name_of(set));
      const auto over_all = [&](const std::string& shape) {
        return ratio(g.at(all, ours(set)), g.at(shape, ours(set)));
      };
      row("18" + by, 4, " × the textbook loop", ratio(textbook, g.at(all, ours(set))));
      row("grid, 18" + by, 10, " × the textbook loop", ratio(textbook, g.at("grid: " + all, ours(set))));
      row("tangent4 alone" + by, 1.5, " × as fast as 18", over_all("tangent4"));
      row("position alone" + by, 2, " × as fast as 18", over_all(position));
    }
  }

  void points() const {
    std::cout << "\n### Single points\n\nDouble, separate arrays, L2, in a loop of the caller's that is "
                 "compiled at -O2: sample() for 18 numbers, frame() for t, b, n. Nanoseconds a "
                 "point, best / median.\n\n"
                 "| surface | written | naive | Darboux | × the time of naive |\n|---|---|---:|---:|---:|\n";
    for (const std::string surface : {"torus", "sphere"})
      for (const std::string shape : {"18, separate arrays", "t, b, n, separate arrays"}) {
        const Group& g = group(surface + "/double/points");
        const Timing &naive = g.at(shape, "naive"), &ours = g.at(shape, "points");
        std::cout << "| " << surface << " | " << shape.substr(0, shape.find(", sep")) << " | "
                  << nanoseconds(naive) << " | " << nanoseconds(ours) << " | "
                  << number(ratio(ours, naive), 2) << " |\n";
      }
  }

  void splines() const {
    const Group& g = group("spline/double/L2");
    const Timing& textbook = g.at("18, separate arrays", "textbook loop");
    std::cout << "\n### A B-spline\n\nBicubic, a net of 8 x 8 points without weights, double, L2; random "
                 "points, and a grid of 64 x 64. The textbook loop finds each point's spans, its basis "
                 "functions and their derivatives, and adds up sixteen control points; × is its time for 18 "
                 "numbers at random points over the row's. Nanoseconds a point, best / median.\n\n"
                 "| written | by | ns | × the textbook loop |\n|---|---|---:|---:|\n";
    for (const Timing& x : g.timings)
      std::cout << "| " << x.shape << " | " << x.method << " | " << nanoseconds(x) << " | "
                << number(ratio(textbook, x), 2) << " |\n";
  }

  double catalogue_ratio(const CatalogueLoops<double>& x) const {
    const Group& g = group("catalogue/double/L2");
    return ratio(g.at(std::string(x.surface), "naive"), g.at(std::string(x.surface), best_of_ours()));
  }

  void catalogue() const {
    const Group& g = group("catalogue/double/L2");
    std::cout
        << "\n### Every surface\n\n18 doubles, separate arrays, L2; best / median nanoseconds a point.\n\n"
           "| surface | its naive loop | Darboux | × naive | |\n|---|---:|---:|---:|---|\n";
    for (const CatalogueLoops<double>& x : catalogue_loops<double>()) {
      const std::string name(x.surface);
      const double times = catalogue_ratio(x);
      std::cout << "| " << name << " | " << nanoseconds(g.at(name, "naive")) << " | "
                << nanoseconds(g.at(name, best_of_ours())) << " | " << number(times, 2) << " | "
                << (times >= 5 ? "" : "**below 5**") << " |\n";
    }
    const Timing &points = g.at("placed torus", "points"), &ours = g.at("placed torus", best_of_ours());
    std::cout << "\nA placed torus: " << nanoseconds(ours) << " ns; point by point " << nanoseconds(points)
              << ", " << number(ratio(points, ours), 1) << " times as long.\n";
  }

  void threads() const {
    std::cout
        << "\n### Two threads\n\n18 separate arrays; 2^20 points into rotating sets, 2^14 into the same "
           "arrays. Beside it what two threads are worth here to others: to the naive loop, which computes, "
           "and to the write limit.\n\n"
           "| surface | scalar | points | one thread, ns | two, ns "
           "| × one | naive: × one | limit: × one |\n"
           "|---|---|---|---:|---:|---:|---:|---:|\n";
    for (const std::string surface : {"torus", "sphere"})
      for (const std::string scalar : {"double", "float"})
        for (const std::size_t n : thread_sizes) {
          const Group& g = group(surface + "/" + scalar + "/threads");
          const Timing &one = g.at(size_name(n), "1"), &two = g.at(size_name(n), "2");
          std::cout << "| " << surface << " | " << scalar << " | " << size_name(n) << " | "
                    << nanoseconds(one) << " | " << nanoseconds(two) << " | " << number(ratio(one, two), 2);
          for (const std::string by : {"naive ", "limit "})
            std::cout << " | "
                      << number(ratio(g.at(size_name(n), by + "1"), g.at(size_name(n), by + "2")), 2);
          std::cout << " |\n";
        }
  }

  void stores() const {
    std::cout << "\n### Cached stores or past the caches\n\n"
                 "Torus, 18 separate arrays, the same memory in each call; median nanoseconds a point.\n";
    for (const std::string scalar : {"double", "float"}) {
      const Group& g = group("torus/" + scalar + "/stores");
      std::cout << "\n| " << scalar
                << ", bytes written | cached | past the caches | past / cached | cached, then read | past, "
                   "then read | past / "
                   "cached |\n|---:|---:|---:|---:|---:|---:|---:|\n";
      for (const std::size_t megabytes : crossover_sizes) {
        std::cout << "| " << megabytes << " MB";
        for (const std::string then : {"", ", then read"}) {
          const std::string shape = std::to_string(megabytes) + " MB" + then;
          const Timing &cached = g.at(shape, "cached"), &past = g.at(shape, "past_caches");
          std::cout << " | " << number(median(cached.ns), 2) << " | " << number(median(past.ns), 2) << " | "
                    << number(ratio(past, cached), 2);
        }
        std::cout << " |\n";
      }
    }
  }

  const std::vector<Group>& groups_;
};

}  // namespace

void write_tables(const std::vector<Group>& groups) {
  Report(groups).write();
}

}  // namespace darboux::bench
