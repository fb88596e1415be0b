#include <algorithm>
#include <cstdio>
#include <iostream>

#include <darboux/testing.h>

#include "command.h"
#include "parallel.h"

namespace darboux {
namespace {

struct Arguments {
  std::vector<std::string> surfaces;
  CheckOptions options;
};

void print_table(const std::vector<Check>& checks, bool passed) {
  std::size_t widest = 7;
  for (const Check& c : checks) widest = std::max(widest, c.surface.size());
  const int width = static_cast<int>(widest);
  std::printf("%-*s %-20s %-20s %8s %10s %10s  %s\n", width, "surface", "route", "quantity", "points", "max error",
              "bound", "result");
  const auto text = [](std::string_view s) { return std::string(s); };
  for (const Check& c : checks) {
    const std::string surface = text(c.surface), route = text(c.route), quantity = text(c.quantity);
    std::printf("%-*s %-20s %-20s ", width, surface.c_str(), route.c_str(), quantity.c_str());
    if (!c.skipped.empty()) {
      std::printf("%8s %10s %10s  %s: %s\n", "", "", "", c.passed ? "skipped" : "FAILED", c.skipped.c_str());
      continue;
    }
    std::string result = "passed";
    if (!c.passed) {
      result = "FAILED, worst at u = " + shortest(c.worst_u) + ", v = " + shortest(c.worst_v);
      if (!c.worst_surface.empty()) result += " of " + c.worst_surface;
    }
    std::printf("%8d %10.2e %10.2e  %s\n", c.points, c.max_error, c.bound, result.c_str());
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
      [&](std::size_t i) { results[i] = check_surface(surfaces[i], arguments.options); },
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
      if (!c.worst_surface.empty()) entry["worst"]["surface"] = c.worst_surface;
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
  std::vector<std::string> routes;
  for (const std::string_view route : check_routes()) routes.emplace_back(route);
  sub.add_option("--routes", arguments->options.routes, "comma-separated, only these; all when none is given")
      ->delimiter(',')
      ->check(CLI::IsMember(routes));
  sub.add_option("--parameter-sets", arguments->options.parameter_sets,
                 "routes high_precision*: that many random sets of parameters instead of those given")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000));
  add_common(sub, common, "darboux check torus:minor_radius=0.4 --points 10000");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
