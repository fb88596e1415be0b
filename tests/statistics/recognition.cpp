// What recognition claims of random meshes that are no surface, and finds of those that are: recognition.sh
// writes the report.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include <unistd.h>

#include "random_meshes.h"

namespace {

using namespace darboux;
using Clock = std::chrono::steady_clock;

struct Arguments {
  std::size_t count = 100000;  // meshes that are no surface, over all families
  std::string only;            // part of a family's name
  std::uint64_t seed = 1;
  bool replay = false;  // one mesh of `only`, with that seed
};

// Calls f(i) for 0 .. n-1 on two threads, with a bar on a terminal.
template <class F>
double for_each(std::size_t n, const std::string& what, F f) {
  const Clock::time_point begun = Clock::now();
  std::atomic<std::size_t> next = 0;
  const bool bar = isatty(STDERR_FILENO) == 1;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < n;) {
      f(i);
      if (bar && i % 100 == 0) std::fprintf(stderr, "\r%-60s %3zu %%", what.c_str(), 100 * i / n);
    }
  };
  std::thread other(work);
  work();
  other.join();
  if (bar) std::fprintf(stderr, "\r%-66s\r", "");
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

bool wanted(const Arguments& arguments, std::string_view name) {
  return name.find(arguments.only) != std::string_view::npos;
}

void replay(const Arguments& arguments) {
  for (const test::NegativeFamily& family : test::negative_families())
    if (wanted(arguments, family.name))
      for (const Assessment& j : assess_parts(test::negative(family, arguments.seed))) {
        std::printf("%s, seed %llu: %zu corners, %s\n", std::string(family.name).c_str(),
                    static_cast<unsigned long long>(arguments.seed), j.report.corners,
                    j.fit && j.fit->fits ? j.fit->surface.surface.specification(6).c_str() : "none");
        for (const Finding& f : j.report.findings)
          if (f.severity != Severity::info)
            std::printf("  %s (%zu): %s\n", std::string(f.code).c_str(), f.count, f.message.c_str());
      }
}

void negatives(const Arguments& arguments) {
  std::printf(
      "\n### Meshes that are no surface\n\n| family | meshes | false claims and failures | kinds, or fail, "
      "and first seeds | ms per "
      "mesh |\n|---|---|---|---|---|\n");
  std::size_t all = 0, wrong = 0;
  for (const test::NegativeFamily& family : test::negative_families()) {
    if (!wanted(arguments, family.name)) continue;
    const std::size_t n = arguments.count / test::negative_families().size();
    std::mutex mutex;
    std::map<std::string, std::uint64_t> first;
    std::size_t claims = 0;
    const double seconds = for_each(n, std::string(family.name), [&](std::size_t i) {
      const std::uint64_t seed = arguments.seed + i;
      const std::string kind = test::false_claim(family, test::negative(family, seed));
      if (kind.empty()) return;
      const std::lock_guard lock(mutex);
      ++claims;
      const auto [at, is_new] = first.try_emplace(kind, seed);
      if (!is_new) at->second = std::min(at->second, seed);
    });
    std::string kinds;
    for (const auto& [kind, seed] : first)
      kinds += (kinds.empty() ? "" : ", ") + kind + " " + std::to_string(seed);
    std::printf("| %s | %zu | %zu | %s | %.1f |\n", std::string(family.name).c_str(), n, claims,
                kinds.c_str(), 2e3 * seconds / static_cast<double>(std::max<std::size_t>(n, 1)));
    all += n, wrong += claims;
  }
  std::printf("| all | %zu | %zu | asked: at most 1 in 10 000%s | |\n", all, wrong,
              10000 * wrong > all ? ", **missed**" : "");
}

void positives(const Arguments& arguments) {
  std::printf(
      "\n### Meshes that are one\n\nThe share recognised as the right kind, in per cent, without uvs and "
      "with their own.\n\n"
      "| family | meshes each | float32 | float16 | int16 | float32, uvs | float16, uvs | int16, uvs "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const test::PositiveFamily& family : test::positive_families()) {
    if (!wanted(arguments, family.name)) continue;
    const std::size_t n = std::max<std::size_t>(20, arguments.count / 200);
    std::printf("| %s | %zu", std::string(family.name).c_str(), n);
    for (const bool uvs : {false, true})
      for (const auto storage : {test::Storage::single, test::Storage::half, test::Storage::int16}) {
        std::atomic<std::size_t> found = 0;
        for_each(n, std::string(family.name), [&](std::size_t i) {
          found += test::is_recognised(family, test::positive(family, storage, uvs, arguments.seed + i));
        });
        const double share = 100 * static_cast<double>(found) / static_cast<double>(n);
        std::printf(" | %.4g%s", share, share < 99 ? " **missed**" : "");
      }
    std::printf(" |\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    const auto value = [&]() -> std::string { return i + 1 < argc ? argv[++i] : ""; };
    if (option == "--quick")
      arguments.count = 5000;
    else if (option == "--count")
      arguments.count = std::stoull(value());
    else if (option == "--only")
      arguments.only = value();
    else if (option == "--replay")
      arguments.replay = true, arguments.seed = std::stoull(value());
    else {
      std::fprintf(stderr, "usage: %s [--quick | --count N] [--only FAMILY] [--replay SEED]\n", argv[0]);
      return 2;
    }
  }
  if (arguments.replay) {
    replay(arguments);
    return 0;
  }
  negatives(arguments);
  positives(arguments);
}
