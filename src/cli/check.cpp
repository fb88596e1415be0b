#include <algorithm>
#include <cstdio>
#include <iostream>

#include "command.h"
#include "parallel.h"

namespace darboux {
namespace {

struct Arguments {
  std::vector<std::string> surfaces;
  CheckOptions options;
};

void print_table(const std::vector<Check>& checks, bool passed) {
  std::printf("%-10s %-12s %-20s %8s %10s %10s  %s\n", "surface", "route", "quantity", "points", "max error",
              "bound", "result");
  const auto text = [](std::string_view s) { return std::string(s); };
  for (const Check& c : checks) {
    const std::string surface = text(c.surface), route = text(c.route), quantity = text(c.quantity);
    if (!c.skipped.empty())
      std::printf("%-10s %-12s %-20s %8s %10s %10s  skipped: %s\n", surface.c_str(), route.c_str(),
                  quantity.c_str(), "", "", "", c.skipped.c_str());
    else
      std::printf(
          "%-10s %-12s %-20s %8d %10.2e %10.2e  %s\n", surface.c_str(), route.c_str(), quantity.c_str(),
          c.points, c.max_error, c.bound,
          c.passed
              ? "passed"
              : ("FAILED, worst at u = " + shortest(c.worst_u) + ", v = " + shortest(c.worst_v)).c_str());
  }
  std::puts(passed ? "all passed" : "FAILED");
}

void run(const Arguments& arguments, Common& common) {
  std::vector<AnySurface> surfaces;
  for (const std::string& text : arguments.surfaces) surfaces.push_back(make_surface(text));
  if (surfaces.empty()) surfaces = all_surfaces();

  Progress progress("check", common);
  std::vector<std::vector<Check>> results(surfaces.size());
  parallel_for(
      surfaces.size(), common.threads,
      [&](std::size_t i) { results[i] = surfaces[i].check(arguments.options); },
      [&](double share) { progress.update(share); });
  std::vector<Check> checks;
  for (const auto& result : results) checks.insert(checks.end(), result.begin(), result.end());
  const bool passed = std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.passed; });
  common.exit_status = passed ? 0 : 1;
  if (!common.json) return print_table(checks, passed);
  Json list = Json::array();
  for (const Check& c : checks) {
    Json entry{{"surface", c.surface}, {"route", c.route}, {"quantity", c.quantity}};
    if (!c.skipped.empty()) {
      entry["skipped"] = c.skipped;
    } else {
      entry["points"] = c.points;
      entry["max_error"] = number(c.max_error);
      entry["bound"] = number(c.bound);
      entry["passed"] = c.passed;
      entry["worst"] = {{"u", number(c.worst_u)}, {"v", number(c.worst_v)}};
    }
    list.push_back(entry);
  }
  print_json({{"checks", list}, {"passed", passed}, {"seed", arguments.options.seed}});
}

}  // namespace

void add_check(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "check",
      "Prove the closed forms: against dual numbers, central differences and the surface's own facts");
  auto arguments = std::make_shared<Arguments>();
  sub.add_option("SURFACE", arguments->surfaces, "name or name:parameter=value,...; all when none is given");
  sub.add_option("--points", arguments->options.points, "random points per surface")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000000));
  sub.add_option("--seed", arguments->options.seed, "of the random points")
      ->capture_default_str()
      ->check(whole_number);
  add_common(sub, common, "darboux check torus:minor_radius=0.4 --points 10000");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
