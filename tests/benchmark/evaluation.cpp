// Times evaluate() against other methods and against the limits of the machine.
//   benchmark_evaluation [Google Benchmark's options]    one method after the other, e.g.
//                                                        --benchmark_filter=torus/double
//   benchmark_evaluation --table [--quick]               all in turns; writes the tables of
//                                                        docs/reports/evaluation.md
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <darboux/any_surface.h>
#include <darboux/blocks.h>
#include <darboux/catalogue.h>
#include <darboux/evaluate.h>
#include <darboux/placed.h>

#include "baselines.h"
#include "groups.h"
#include "measure.h"
#include "tables.h"

namespace darboux::bench {
namespace {

constexpr std::array all_attributes{Attribute::position, Attribute::dpdu,      Attribute::dpdv,
                                    Attribute::tangent,  Attribute::bitangent, Attribute::normal};

template <class T>
constexpr const char* scalar_name = std::same_as<T, double> ? "double" : "float";
const char* name_of(ByHand surface) {
  return surface == ByHand::torus ? "torus" : "sphere";
}
AnySurface surface_of(ByHand surface) {
  return surface == ByHand::torus ? AnySurface(Torus{1.0, 0.25}) : AnySurface(Sphere{1.0});
}
std::string shape_name(Layout layout, Wanted wanted) {
  if (wanted == Wanted::tangent4) return "tangent4";
  if (wanted == Wanted::position) return "position, separate arrays";
  return std::string(wanted == Wanted::all ? "18" : "t, b, n") +
         (layout == Layout::separate  ? ", separate arrays"
          : layout == Layout::vectors ? ", vec3 arrays"
                                      : ", array of structs");
}

// ---- memory -----------------------------------------------------------------------------------------------

// Sets of outputs, one large buffer: each call takes the next, so that what it writes to is no longer in a
// cache.
class Sets {
 public:
  static Sets& get() {
    static Sets sets;
    return sets;
  }
  char* next() { return buffer_.data() + (turn_++ % count_) * set_; }
  std::size_t count() const { return count_; }
  static constexpr std::size_t bytes() { return set_; }

 private:
  Sets() : count_(std::clamp<std::size_t>(available() / 2 / set_, 4, 16)), buffer_(count_ * set_) {}
  static std::size_t available() {
    std::ifstream file("/proc/meminfo");
    std::string name, unit;
    for (std::size_t kilobytes; file >> name >> kilobytes >> unit;)
      if (name == "MemAvailable:") return kilobytes * 1024;
    return 0;
  }
  static constexpr std::size_t set_ = 18 * (many * sizeof(double) + 320) + 4096 + 64;
  std::size_t count_, turn_ = 0;
  Buffer buffer_;
};

// One set that stays in the cache.
char* reused() {
  static const Buffer buffer(std::size_t{80} << 20);
  return buffer.data();
}

template <class T>
const RandomPoints<T>& inputs() {
  static const RandomPoints<T> points(many);
  return points;
}
template <class T>
Points<T> random_points(std::size_t n) {
  return Points<T>::arrays({inputs<T>().u(), n}, {inputs<T>().v(), n});
}

template <class T>
Outputs<T> outputs(Layout layout, Wanted wanted, const Destination& to, std::size_t n) {
  Outputs<T> out;
  const auto at = [&](std::size_t k) { return number_at<T>(layout, wanted, to, k, 0); };
  if (wanted == Wanted::tangent4) return out.packed(Attribute::tangent4, {at(0), 4 * n});
  const std::size_t first = wanted == Wanted::frame ? 3 : 0,
                    last = wanted == Wanted::position ? 1 : all_attributes.size();
  for (std::size_t a = first; a < last; ++a) {
    const std::size_t k = 3 * (a - first);
    if (layout == Layout::separate)
      out.separate(all_attributes[a],
                   {std::span<T>{at(k), n}, std::span<T>{at(k + 1), n}, std::span<T>{at(k + 2), n}});
    else if (layout == Layout::vectors)
      out.packed(all_attributes[a], {at(k), 3 * n});
    else
      out.member(all_attributes[a], at(k), n, static_cast<std::ptrdiff_t>(numbers_of(wanted) * sizeof(T)));
  }
  return out;
}

// ---- groups of methods that are timed in turns -----------------------------------------------------------

// The naive loop, the limits, and the library's batch, for one shape of results.
template <class T>
void add_shape(Group& group, ByHand kind, Layout layout, Wanted wanted, std::size_t n, bool memory,
               const std::vector<InstructionSet>& sets) {
  const std::string shape = shape_name(layout, wanted);
  const auto place = [=] {
    return destination_of<T>(layout, wanted, memory ? Sets::get().next() : reused(), n);
  };
  const auto by = [=](Method method) {
    return
        [=] { evaluate_by<T>(method, kind, layout, wanted, inputs<T>().u(), inputs<T>().v(), n, place()); };
  };
  group.add(shape, "naive Eigen loop", n, by(Method::naive));
  if (layout == Layout::separate && wanted == Wanted::all) {
    group.add(shape, "closed form, scalar", n, by(Method::closed_form));
    group.add(shape, "dual numbers", n, by(Method::dual));
    group.add(shape, "central differences", n, by(Method::differences));
    if (with_occt && std::same_as<T, double>) {
      group.add(shape, "OCCT, D1 and frame", n, by(Method::occt_d1));
      group.add(shape, "OCCT, D2 and frame", n, by(Method::occt_d2));
    }
  }
  for (const InstructionSet set : sets)
    group.add(shape, ours(set), n,
              [=, surface = surface_of(kind), points = random_points<T>(n),
               fixed = outputs<T>(layout, wanted, destination_of<T>(layout, wanted, reused(), n), n)] {
                const EvaluateOptions options{.instruction_set = set};
                if (memory)
                  surface.evaluate(points, outputs<T>(layout, wanted, place(), n), options);
                else
                  surface.evaluate(points, fixed, options);
              });
  for (const Writer& writer : writers())
    group.add(shape,
              (memory ? "limit: non-temporal stores, " : "limit: plain stores, ") + std::string(writer.name),
              n, [=] { (memory ? writer.past_caches : writer.cached)(place()); });
  if (layout == Layout::separate && wanted == Wanted::all)
    group.add(shape, "copy (memcpy)", n, [=] {
      const Destination from = place();
      const Destination to =
          memory ? place() : destination_of<T>(layout, wanted, reused() + from.arrays * from.stride, n);
      for (std::size_t k = 0; k < to.arrays; ++k)
        std::memcpy(to.base + k * to.stride, from.base + k * from.stride, to.bytes);
    });
}

template <class T>
void add_grid(Group& group, ByHand kind, Layout layout) {
  group.add("grid: " + shape_name(layout, Wanted::all), best_of_ours(), many,
            [=, surface = surface_of(kind), points = Points<T>::grid(1023, 1023)] {
              surface.evaluate(
                  points, outputs<T>(layout, Wanted::all,
                                     destination_of<T>(layout, Wanted::all, Sets::get().next(), many), many));
            });
}

// Adds in eight chains, so that reading is what takes time.
template <class T>
void add_up(std::array<T, 8>& sums, std::span<const T> x) {
  for (std::size_t i = 0; i + 8 <= x.size(); i += 8)  // sizes here are multiples of 8
    for (std::size_t k = 0; k < 8; ++k) sums[k] += x[i + k];
}

// Who only wants the sum of the normals: evaluates all and then reads, or takes block by block.
template <class T>
void add_consumers(Group& group, ByHand kind) {
  const std::string shape = "18, then the sum of the normals";
  group.add(shape, "evaluate(), then read", many, [=, surface = surface_of(kind)] {
    const Destination to = destination_of<T>(Layout::separate, Wanted::all, Sets::get().next(), many);
    surface.evaluate(random_points<T>(many), outputs<T>(Layout::separate, Wanted::all, to, many));
    std::array<std::array<T, 8>, 3> sums{};
    for (std::size_t c = 0; c < 3; ++c)
      add_up(sums[c], {number_at<T>(Layout::separate, Wanted::all, to, 15 + c, 0), many});
    ::benchmark::DoNotOptimize(sums);
  });
  group.add(shape, "for_each_block()", many, [surface = surface_of(kind)] {
    Attributes asked;
    for (const Attribute a : all_attributes) asked |= a;
    std::array<std::array<T, 8>, 3> sums{};
    for_each_block(surface, random_points<T>(many), asked, [&](const Block<T>& block) {
      for (std::size_t c = 0; c < 3; ++c) add_up(sums[c], block(Attribute::normal, c));
    });
    ::benchmark::DoNotOptimize(sums);
  });
}

template <class T>
Group by_hand_group(ByHand kind, bool memory) {
  Group group{std::string(name_of(kind)) + "/" + scalar_name<T> + "/" + (memory ? "memory" : "L2"), {}};
  const std::vector<InstructionSet> sets(instruction_sets().begin(), instruction_sets().end()),
      best{instruction_sets().back()};
  const std::size_t n = memory ? many : few;
  add_shape<T>(group, kind, Layout::separate, Wanted::all, n, memory, sets);
  add_shape<T>(group, kind, Layout::vectors, Wanted::all, n, memory, best);
  add_shape<T>(group, kind, Layout::structs, Wanted::all, n, memory, best);
  if (memory) {
    add_grid<T>(group, kind, Layout::separate);
    add_grid<T>(group, kind, Layout::structs);
    add_consumers<T>(group, kind);
  } else {
    add_shape<T>(group, kind, Layout::separate, Wanted::frame, n, memory, best);
    add_shape<T>(group, kind, Layout::vectors, Wanted::frame, n, memory, best);
    add_shape<T>(group, kind, Layout::structs, Wanted::tangent4, n, memory, best);
  }
  return group;
}

// f(first point, place of that and the following) of as many equal parts.
template <class T, class F>
void in_parts(int parts, std::size_t n, const Destination& to, const F& f) {
  const auto part = [&](int k) {
    const auto count = static_cast<std::size_t>(parts), first = n / count * static_cast<std::size_t>(k);
    f(first, Destination{to.base + first * sizeof(T), to.arrays, to.bytes / count, to.stride});
  };
  if (parts == 1)
    part(0);
  else
    tbb::parallel_for(0, parts, part, tbb::simple_partitioner{});
}

// Beside ours, what two threads are worth on this machine: to the naive loop, which only computes, and to who
// only writes.
template <class T>
Group threads_group(ByHand kind) {
  Group group{std::string(name_of(kind)) + "/" + scalar_name<T> + "/threads", {}};
  for (const std::size_t n : thread_sizes) {
    const auto place = [=] {
      return destination_of<T>(Layout::separate, Wanted::all, n == many ? Sets::get().next() : reused(), n);
    };
    for (const int threads : {1, 2}) {
      const std::string number = std::to_string(threads);
      group.add(size_name(n), number, n, [=, surface = surface_of(kind)] {
        surface.evaluate(random_points<T>(n), outputs<T>(Layout::separate, Wanted::all, place(), n),
                         {.threads = threads});
      });
      group.add(size_name(n), "naive " + number, n, [=] {
        in_parts<T>(threads, n, place(), [&](std::size_t first, const Destination& to) {
          evaluate_by<T>(Method::naive, kind, Layout::separate, Wanted::all, inputs<T>().u() + first,
                         inputs<T>().v() + first, n / static_cast<std::size_t>(threads), to);
        });
      });
      group.add(size_name(n), "limit " + number, n, [=, writer = writers().back()] {
        in_parts<T>(threads, n, place(), [&](std::size_t, const Destination& to) {
          (n == many ? writer.past_caches : writer.cached)(to);
        });
      });
    }
  }
  return group;
}

// The same memory again and again, written only, or written and then read.
template <class T>
Group crossover_group() {
  Group group{std::string("torus/") + scalar_name<T> + "/stores", {}};
  for (const std::size_t megabytes : crossover_sizes) {
    const std::size_t n = (megabytes << 20) / (18 * sizeof(T)) / 64 * 64;
    for (const bool read : {false, true})
      for (const auto& [method, stores] :
           {std::pair{"cached", Stores::cached}, std::pair{"past_caches", Stores::past_caches}})
        group.add(std::to_string(megabytes) + (read ? " MB, then read" : " MB"), method, n,
                  [=, stores = stores, surface = surface_of(ByHand::torus)] {
                    const Destination to = destination_of<T>(Layout::separate, Wanted::all, reused(), n);
                    surface.evaluate(random_points<T>(n), outputs<T>(Layout::separate, Wanted::all, to, n),
                                     {.stores = stores});
                    if (!read) return;
                    std::uint64_t sum = 0;
                    for (std::size_t k = 0; k < to.arrays; ++k)
                      for (std::size_t at = 0; at < to.bytes; at += 64) {
                        std::uint64_t bits;
                        std::memcpy(&bits, to.base + k * to.stride + at, sizeof bits);
                        sum += bits;
                      }
                    ::benchmark::DoNotOptimize(sum);
                  });
  }
  return group;
}

// A B-spline against the textbook: all, less, and on a grid, on every instruction set.
Group spline_group() {
  Group group{"spline/double/L2", {}};
  const auto place = [](Wanted wanted) {
    return destination_of<double>(wanted == Wanted::tangent4 ? Layout::structs : Layout::separate, wanted,
                                  reused(), few);
  };
  group.add(shape_name(Layout::separate, Wanted::all), "textbook loop", few,
            [=] { textbook_spline(inputs<double>().u(), inputs<double>().v(), few, place(Wanted::all)); });
  constexpr int cells = 63;  // few points
  const auto add = [&](const std::string& shape, const Points<double>& points, Wanted wanted) {
    for (const InstructionSet set : instruction_sets())
      if (set != InstructionSet::points)
        group.add(shape, ours(set), few,
                  [=, surface = AnySurface(timed_spline()),
                   out = outputs<double>(Layout::separate, wanted, place(wanted), few)] {
                    surface.evaluate(points, out, {.instruction_set = set});
                  });
  };
  for (const Wanted wanted : {Wanted::all, Wanted::tangent4, Wanted::position}) {
    const std::string shape = shape_name(Layout::separate, wanted);
    add(shape, random_points<double>(few), wanted);
    if (wanted != Wanted::tangent4) add("grid: " + shape, Points<double>::grid(cells, cells), wanted);
  }
  return group;
}

// Point by point, in the caller's own loop.
Group points_group(ByHand kind) {
  Group group{std::string(name_of(kind)) + "/double/points", {}};
  for (const Wanted wanted : {Wanted::all, Wanted::frame})
    for (const auto& [name, method] :
         {std::pair{"naive", Method::naive}, std::pair{"points", Method::points}})
      group.add(shape_name(Layout::separate, wanted), name, few, [=, method = method] {
        evaluate_by<double>(method, kind, Layout::separate, wanted, inputs<double>().u(),
                            inputs<double>().v(), few,
                            destination_of<double>(Layout::separate, wanted, reused(), few));
      });
  return group;
}

Group catalogue_group() {
  Group group{"catalogue/double/L2", {}};
  const std::vector<CatalogueLoops<double>>& loops = catalogue_loops<double>();
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const auto place = [] { return destination_of<double>(Layout::separate, Wanted::all, reused(), few); };
    group.add(std::string(loops[k].surface), "naive", few, [=, naive = loops[k].naive] {
      naive(inputs<double>().u(), inputs<double>().v(), few, place());
    });
    group.add(std::string(loops[k].surface), best_of_ours(), few, [=, surface = all_surfaces()[k]] {
      surface.evaluate(random_points<double>(few),
                       outputs<double>(Layout::separate, Wanted::all, place(), few));
    });
  }
  // As a scene places it: turned, scaled unevenly, moved.
  const AnySurface placed(Placed{Torus{1.0, 0.25}, {0.6, 0, 1.6, 0.8, 0, -1.2, 0, 0.5, 0}, {1, 2, 3}});
  for (const InstructionSet set : {InstructionSet::points, instruction_sets().back()})
    group.add("placed torus", set == InstructionSet::points ? "points" : best_of_ours(), few, [=] {
      placed.evaluate(
          random_points<double>(few),
          outputs<double>(Layout::separate, Wanted::all,
                          destination_of<double>(Layout::separate, Wanted::all, reused(), few), few),
          {.instruction_set = set});
    });
  return group;
}

std::vector<Group> all_groups() {
  std::vector<Group> groups;
  for (const ByHand kind : {ByHand::torus, ByHand::sphere})
    for (const bool memory : {true, false}) {
      groups.push_back(by_hand_group<double>(kind, memory));
      groups.push_back(by_hand_group<float>(kind, memory));
    }
  for (const ByHand kind : {ByHand::torus, ByHand::sphere}) {
    groups.push_back(threads_group<double>(kind));
    groups.push_back(threads_group<float>(kind));
  }
  groups.push_back(crossover_group<double>());
  groups.push_back(crossover_group<float>());
  for (const ByHand kind : {ByHand::torus, ByHand::sphere}) groups.push_back(points_group(kind));
  groups.push_back(spline_group());
  groups.push_back(catalogue_group());
  return groups;
}

// All methods write the same numbers, on a grid and elsewhere; what times something else would be of no use.
template <class T>
void check_numbers(const Group& group, ByHand kind) {
  std::map<std::string, std::vector<double>> expected;
  for (const Timing& timing : group.timings)
    for (const Layout layout : {Layout::separate, Layout::vectors, Layout::structs})
      for (const Wanted wanted : {Wanted::all, Wanted::frame, Wanted::tangent4, Wanted::position}) {
        const std::string shape = shape_name(layout, wanted);
        if ((timing.shape != shape && timing.shape != "grid: " + shape) ||
            (wanted == Wanted::tangent4 && layout != Layout::structs) ||
            (wanted == Wanted::position && layout != Layout::separate) ||
            timing.method.starts_with("limit") || timing.method.starts_with("copy"))
          continue;
        const Destination place = destination_of<T>(layout, wanted, reused(), few);
        std::memset(place.base, 0xff, place.arrays * place.stride);
        timing.run();
        std::vector<double> numbers;
        for (std::size_t i = 0; i < few; ++i)
          for (std::size_t k = 0; k < numbers_of(wanted); ++k)
            numbers.push_back(static_cast<double>(*number_at<T>(layout, wanted, place, k, i)));
        const auto [first, is_new] = expected.try_emplace(timing.shape, numbers);
        const bool differences = timing.method == "central differences";
        const double tolerance =
            std::same_as<T, double> ? (differences ? 1e-5 : 1e-10) : (differences ? 0.3 : 3e-2);
        for (std::size_t k = 0; k < numbers.size(); ++k)
          if (!(std::fabs(numbers[k] - first->second[k]) <= tolerance))
            throw std::runtime_error(group.name + ", " + timing.shape + ": number " + std::to_string(k) +
                                     " by " + timing.method + " is " + std::to_string(numbers[k]) +
                                     ", by the first " + std::to_string(first->second[k]) + " (" +
                                     name_of(kind) + ")");
      }
}

int table(std::vector<Group>& groups, bool quick) {
  for (const Group& group : groups)
    if ((group.name.ends_with("/L2") && !group.name.starts_with("catalogue")) ||
        group.name.ends_with("/points")) {
      const ByHand kind = group.name.starts_with("torus") ? ByHand::torus : ByHand::sphere;
      if (group.name.find("/double/") != std::string::npos)
        check_numbers<double>(group, kind);
      else
        check_numbers<float>(group, kind);
    }
  const int rounds = quick ? 5 : 40;
  for (Group& group : groups) {
    const bool in_cache = group.name.ends_with("/L2") || group.name.ends_with("/points");
    std::cerr << group.name << " ...\n";
    measure(group.timings, in_cache ? 2 * rounds : rounds);
  }
  std::cout << "- points: random, std::mt19937_64, seed " << seed
            << "\n- memory regime: " << Sets::get().count() << " sets of " << Sets::bytes() / 1000000
            << " MB in turn\n- rounds: " << rounds << " in memory, " << 2 * rounds << " in L2"
            << (quick ? " (quick: not for the report)" : "") << "\n- instruction sets:";
  for (const InstructionSet set : instruction_sets()) std::cout << ' ' << darboux::name_of(set);
  std::cout << "; without a name Darboux ran on " << darboux::name_of(instruction_sets().back())
            << "\n- OCCT: " << (with_occt ? "compared with" : "not there, not compared with") << "\n\n";
  write_tables(groups);
  return 0;
}

void add_benchmarks(std::vector<Group>& groups) {
  for (Group& group : groups)
    for (Timing& timing : group.timings) {
      std::string name = group.name + "/" + timing.shape + "/" + timing.method;
      std::replace(name.begin(), name.end(), ' ', '_');
      ::benchmark::RegisterBenchmark(name.c_str(), [&timing](::benchmark::State& state) {
        for (auto _ : state) timing.run();
        state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(timing.points));
      })->UseRealTime();
    }
}

int run(int argc, char** argv) {
  bool as_table = false, quick = false;
  int kept = 1;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--table") == 0)
      as_table = true;
    else if (std::strcmp(argv[k], "--quick") == 0)
      quick = true;
    else
      argv[kept++] = argv[k];
  }
  std::vector<Group> groups = all_groups();
  if (as_table) return table(groups, quick);
  ::benchmark::Initialize(&kept, argv);
  if (::benchmark::ReportUnrecognizedArguments(kept, argv)) return 2;
  add_benchmarks(groups);
  ::benchmark::RunSpecifiedBenchmarks();
  ::benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  try {
    return darboux::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_evaluation: %s\n", error.what());
    return 1;
  }
}
