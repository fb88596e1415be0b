// The tables of docs/reports/mesh-tangents.md, for mesh_tangents.sh:
//   --table FOLDER NODE [--quick]    all of them; NODE is the command of mesh_tangents.mjs up to MAKER, or
//                                    "-REASON" why there is none
//   --measure MAKER MESH [TANGENTS]  one maker in C++, for --table
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/mesh.h>
#include <darboux/mesh_frames.h>

#include "contest.h"
#include "measure.h"
#include "tangent_makers.h"
#include "torus_file.h"

namespace darboux::bench {
namespace {

const Size small{"10^4", 100, 50}, medium{"10^5", 250, 200}, large{"10^6", 1000, 500},
    larger{"5*10^6", 2500, 1000}, huge{"10^7", 2500, 2000};

std::string number(double x, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << std::fixed << x;
  return text.str();
}
std::string millions_a_second(double triangles, double seconds) {
  const double x = triangles / seconds * 1e-6;
  return number(x, x < 1 ? 3 : 2);
}

// "| by | NAME... |" and the line below it.
void header(const std::string& first, const std::vector<std::string>& names,
            const std::string& after_each = "") {
  std::cout << "| " << first << " |";
  for (const std::string& name : names) std::cout << ' ' << name << " |" << after_each;
  std::cout << "\n|---|";
  for (std::size_t k = 0; k < names.size(); ++k) std::cout << (after_each.empty() ? "---:|" : "---:|---:|");
  std::cout << '\n';
}
std::vector<std::string> names_of(const std::vector<Size>& sizes) {
  std::vector<std::string> names;
  for (const Size& size : sizes) names.push_back(size.name);
  return names;
}
void rows(const Contest& contest, const std::function<std::string(const Result&, const Size&)>& cell) {
  for (std::size_t k = 0; k < contest.makers().size(); ++k) {
    std::cout << "| " << contest.makers()[k].name << " |";
    for (std::size_t s = 0; s < contest.sizes().size(); ++s)
      std::cout << ' ' << cell(contest.result(k, s), contest.sizes()[s]) << " |";
    std::cout << '\n';
  }
}

void speed(const Contest& contest) {
  header("by", names_of(contest.sizes()), " × time |");
  rows(contest, [](const Result& x, const Size& size) {
    if (x.samples.empty()) return std::string("not measured |");
    return millions_a_second(size.triangles(), x.seconds()) + " | " + number(x.ratio(), 2);
  });
  for (std::size_t s = 0; s < contest.sizes().size(); ++s)
    for (std::size_t k = 0; k < contest.makers().size(); ++k)
      if (const std::string& why = contest.result(k, s).refusal; !why.empty())
        std::cout << "\nNot measured: " << contest.makers()[k].name << " at " << contest.sizes()[s].name
                  << ": " << why << ".\n";
}

void first_calls(const Contest& contest) {
  header("by", names_of(contest.sizes()));
  rows(contest, [](const Result& x, const Size& size) {
    return x.samples.empty() ? "not measured" : millions_a_second(size.triangles(), x.first_seconds());
  });
}

void memory(const Contest& contest) {
  header("by", names_of(contest.sizes()));
  rows(contest, [](const Result& x, const Size& size) {
    return x.samples.empty() ? "not measured" : number(x.bytes() / size.triangles(), 0);
  });
}

void differences(const Contest& contest) {
  std::cout
      << "| by | corners with Darboux's bits | angle to Darboux's, largest | corners beyond 0.1° | other "
         "signs | angle to dpdu, rms | largest |\n|---|---:|---:|---:|---:|---:|---:|\n";
  std::cout.precision(2);
  std::cout << std::defaultfloat;
  for (std::size_t k = 0; k < contest.makers().size(); ++k)
    if (const Difference* d = contest.compared(k))
      std::cout << "| " << contest.makers()[k].name << " | " << d->same_bits << " of " << d->corners << " | "
                << d->largest << "° | " << d->far << " | " << d->other_signs << " | " << d->rms_from_dpdu
                << "° | " << d->from_dpdu << "° |\n";
    else
      std::cout << "| " << contest.makers()[k].name << " | not measured | | | | | |\n";
}

// The makers of triangle soup, in this order.
enum { one_thread, two_threads, memory_kept, compatible, mikktspace_npm };

void target(const std::string& what, const std::string& required, const Result& needed,
            const std::string& value, bool met) {
  std::cout << "| " << what << " | " << required << " | ";
  if (needed.samples.empty())
    std::cout << "not measured: " << needed.refusal << " | |\n";
  else
    std::cout << value << " | " << (met ? "met" : "**missed**") << " |\n";
}

// The targets that this measures. \param main the size that tangents are compared at
void targets(const Contest& soup, const Contest& indexed, std::size_t main) {
  const std::string at = ", " + soup.sizes()[main].name + " triangles";
  const std::size_t last = soup.sizes().size() - 1;
  std::cout << "| what | required | measured | |\n|---|---|---:|---|\n";
  const Result& npm = soup.result(mikktspace_npm, main);
  const Difference* bits = soup.compared(mikktspace_npm);
  target("the bits of npm mikktspace" + at, "all corners", npm,
         bits == nullptr ? "" : std::to_string(bits->same_bits) + " of " + std::to_string(bits->corners),
         bits != nullptr && bits->same_bits == bits->corners);
  const auto rows = [&](const std::string& what, std::size_t maker, const std::string& required, auto&& least,
                        auto&& value) {
    for (const Contest* contest : {&soup, &indexed}) {
      if (contest == &indexed && maker == mikktspace_npm) continue;  // it takes no indices
      for (std::size_t s = 0; s < contest->sizes().size(); ++s) {
        const Size& size = contest->sizes()[s];
        const Result& x = contest->result(maker, s);
        if (x.samples.empty() && maker == mikktspace_npm) continue;  // gives up
        const double needed = least(size);
        std::ostringstream text;
        text << ">= " << needed << " × " << required;
        target(what + ", " + size.name + (contest == &soup ? ", soup" : ", indexed"), text.str(), x,
               number(value(x), 2), value(x) >= needed);
      }
    }
  };
  const auto times = [](const Result& x) { return x.ratio(); };
  rows(
      "one thread", compatible, "npm meshoptimizer, 'Compatible'", [](const Size&) { return 1.5; }, times);
  rows(
      "one thread", mikktspace_npm, "npm mikktspace", [](const Size&) { return 22.0; }, times);
  rows(
      "two threads", two_threads, "one", [](const Size& size) { return size.triangles() < 1e5 ? 1.3 : 1.6; },
      [](const Result& x) { return 1 / x.ratio(); });
  const auto each = [&](std::size_t s) {
    return soup.result(one_thread, s).seconds() / soup.sizes()[s].triangles();
  };
  target("time per triangle, one thread, " + soup.sizes()[last].name + " triangles",
         "< 1.5 × that at " + soup.sizes()[0].name, soup.result(one_thread, last),
         number(each(last) / each(0), 2), each(last) / each(0) < 1.5);
  double bytes = 0;
  for (const std::size_t maker : {one_thread, two_threads})
    for (std::size_t s = main; s <= last; ++s)
      bytes = std::fmax(bytes, soup.result(maker, s).bytes() / soup.sizes()[s].triangles());
  target("memory beyond input and output, one thread and two, from " + soup.sizes()[main].name + " triangles",
         "<= 150 bytes a triangle", soup.result(one_thread, main), number(bytes, 0), bytes <= 150);
  std::cout << "| the bits of npm mikktspace, other meshes | all corners | | held by "
               "tests/mesh/mikktspace_test.cpp |\n"
               "| orders of the methods of mesh_frames.h | within 0.15 | | held by tests/converge, "
               "tests/mesh/mesh_orders_test.cpp |\n";
}

Mesh mesh_of(const MeshArrays& arrays) {
  Mesh mesh;
  for (std::size_t v = 0; v < arrays.vertex_count(); ++v) {
    const float *p = &arrays.positions[3 * v], *n = &arrays.normals[3 * v], *uv = &arrays.uvs[2 * v];
    mesh.positions.push_back({p[0], p[1], p[2]});
    mesh.normals.push_back({n[0], n[1], n[2]});
    mesh.uvs.push_back({uv[0], uv[1]});
  }
  for (std::size_t c = 0; c < arrays.corner_count(); c += 3)
    mesh.triangles.push_back({arrays.vertex(c), arrays.vertex(c + 1), arrays.vertex(c + 2)});
  return mesh;
}

// All methods, in turns in this process, by one thread and at one size by two.
void methods(const std::vector<Size>& sizes, const Size& twice_at, int rounds) {
  const std::vector<int> cores = allowed_cores();
  std::vector<std::string> titles;
  std::vector<std::vector<Timing>> columns;
  for (const Size& size : sizes) {
    std::cerr << size.name << ": methods ...\n";
    const Mesh mesh = mesh_of(torus(size.columns, size.rows));
    std::vector<Timing> timings;
    const std::size_t most_threads = size.name == twice_at.name && cores.size() > 1 ? 2 : 1;
    for (std::size_t threads = 1; threads <= most_threads; ++threads) {
      const std::vector<int> run_on(cores.begin(), cores.begin() + static_cast<std::ptrdiff_t>(threads));
      for (const FrameMethod& method : frame_methods())
        timings.push_back({"", std::string(method.name), mesh.triangles.size(), [&, run_on] {
                             allow_cores(run_on);
                             mesh_frames(mesh, method, static_cast<int>(run_on.size()));
                           }});
      titles.push_back(size.name + (threads == 2 ? ", two threads" : ""));
    }
    measure(timings, rounds);
    for (auto at = timings.begin(); at != timings.end(); at += std::ssize(frame_methods()))
      columns.emplace_back(at, at + std::ssize(frame_methods()));
  }
  allow_cores(cores);
  header("method", titles);
  for (std::size_t k = 0; k < frame_methods().size(); ++k) {
    std::cout << "| `" << frame_methods()[k].name << "` |";
    for (const std::vector<Timing>& column : columns)
      std::cout << ' ' << millions_a_second(1, median(column[k].ns) * 1e-9) << " |";
    std::cout << '\n';
  }
  if (cores.size() < 2) std::cout << "\nNot measured: two threads: there are too few cores.\n";
}

void table(const std::string& self, const std::filesystem::path& folder, const std::string& node,
           bool quick) {
  const auto own = [&](const std::string& name, const std::string& key, int threads) {
    return Maker{name, key, self + " --measure " + key, threads};
  };
  const auto npm = [&](const std::string& name, const std::string& key) {
    return Maker{name, key, node + " " + key, 1, node.starts_with("-") ? node.substr(1) : ""};
  };
  const Maker ours = own("Darboux, one thread", "darboux-1", 1),
              ours_twice = own("Darboux, two threads", "darboux-2", 2),
              ours_kept = own("Darboux, one thread, memory kept", "darboux-kept", 1),
              compatible = npm("npm meshoptimizer, 'Compatible'", "meshoptimizer-compatible"),
              meshoptimizer = npm("npm meshoptimizer, default", "meshoptimizer"),
              original = npm("npm mikktspace", "mikktspace"),
              assimp = own("assimp, CalcTangentSpace", "assimp", 1);
  const std::vector<Size> sizes =
      quick ? std::vector{small, medium} : std::vector{small, medium, large, larger, huge};
  const std::size_t main = quick ? 1 : 2;
  const int rounds = quick ? 3 : 5;
  Contest soup({ours, ours_twice, ours_kept, compatible, original, meshoptimizer, assimp}, sizes, false),
      indexed({ours, ours_twice, ours_kept, compatible, meshoptimizer, assimp},
              {sizes.begin(), quick ? sizes.end() : sizes.end() - 1}, true);
  soup.run(folder, rounds, sizes[main].name);
  indexed.run(folder, rounds, sizes[main].name);

  std::cout << "- assimp: " << DARBOUX_BENCHMARK_ASSIMP << " by its own account"
            << "\n- pairs: " << rounds << (quick ? " (quick: not for the report)" : "")
            << "\n\n### Targets\n\n";
  targets(soup, indexed, main);
  std::cout << "\n### Triangle soup\n\nMillions of triangles a second; × time is that of Darboux with one "
               "thread.\n\n";
  speed(soup);
  std::cout << "\n### The first call\n\nMillions of triangles a second in a process's first call; triangle "
               "soup.\n\n";
  first_calls(soup);
  std::cout << "\n### Indexed triangles\n\nThe same, vertices shared but at the seams of the uvs.\n\n";
  speed(indexed);
  std::cout << "\n### Memory\n\nBytes a triangle at the peak, beyond input and output; triangle soup.\n\n";
  memory(soup);
  std::cout << "\n### What they make of " << sizes[main].name << " triangles\n\nTriangle soup:\n\n";
  differences(soup);
  std::cout << "\nIndexed:\n\n";
  differences(indexed);
  std::cout << "\n### Methods of mesh_frames.h\n\nMillions of triangles a second on the indexed torus.\n\n";
  methods(quick ? sizes : std::vector{small, medium, large}, medium, rounds);
}

int run(const std::string& self, std::vector<std::string> arguments) {
  const bool quick = std::erase(arguments, "--quick") > 0;
  const std::string mode = arguments.empty() ? "" : arguments[0];
  if (mode == "--table" && arguments.size() == 3) {
    table(self, arguments[1], arguments[2], quick);
    return 0;
  }
  if (mode == "--measure" && (arguments.size() == 3 || arguments.size() == 4)) {
    try {
      const Sample x =
          measure_maker(arguments[1], arguments[2], arguments.size() == 4 ? arguments[3] : std::string());
      std::cout << x.seconds << ' ' << x.first_seconds << ' ' << x.bytes << '\n';
      return 0;
    } catch (const std::exception& error) {
      std::cout << error.what() << '\n';  // where --table looks for it
      return 1;
    }
  }
  std::cerr << "usage: mesh_tangents.sh [--quick]\n";
  return 2;
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  try {
    return darboux::bench::run(argv[0], {argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_mesh_tangents: %s\n", error.what());
    return 1;
  }
}
