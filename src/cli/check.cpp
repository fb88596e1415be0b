#include <algorithm>
#include <cstdio>
#include <iostream>

#include <darboux/testing.h>

#include "base/parallel_jobs.h"
#include "command.h"

namespace darboux {
namespace {

struct CheckArguments {
  std::vector<std::string> surfaces;
  CheckOptions options;
  bool markdown = false;
};

void print_table(const std::vector<Check>& checks, const char* verdict) {
  std::size_t widest = 7;
  for (const Check& c : checks) widest = std::max(widest, c.surface.size());
  const int width = static_cast<int>(widest);
  std::printf("%-*s %-20s %-20s %8s %10s %10s  %s\n", width, "surface", "route", "quantity", "points",
              "max error", "bound", "result");
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
  std::puts(verdict);
}

// One table per route: surfaces by quantities, with the worst error and its bound in roundings.
void print_markdown(const std::vector<Check>& checks) {
  std::vector<std::string_view> routes, surfaces;
  const auto note = [](std::vector<std::string_view>& list, std::string_view name) {
    if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
  };
  for (const Check& c : checks) {
    note(routes, c.route);
    note(surfaces, c.surface);
  }
  for (const std::string_view route : routes) {
    std::vector<std::string_view> quantities;
    for (const Check& c : checks)
      if (c.route == route) note(quantities, c.quantity);
    const double roundoff = route.ends_with("float") ? 0x1p-24 : 0x1p-53;
    std::cout << "## " << route << "\n\n| surface |";
    for (const std::string_view quantity : quantities) std::cout << ' ' << quantity << " |";
    std::cout << "\n|---|";
    for (std::size_t i = 0; i < quantities.size(); ++i) std::cout << "---|";
    for (const std::string_view surface : surfaces) {
      std::cout << "\n| " << surface << " |";
      for (const std::string_view quantity : quantities) {
        const auto c = std::find_if(checks.begin(), checks.end(), [&](const Check& k) {
          return k.route == route && k.surface == surface && k.quantity == quantity;
        });
        if (c == checks.end() || !c->skipped.empty())
          std::cout << " – |";
        else
          std::cout << ' ' << (c->passed ? "" : "**FAILED** ") << rounded(c->max_error / roundoff, 2) << " / "
                    << rounded(c->bound / roundoff, 2) << " |";
      }
    }
    std::cout << "\n\n";
  }
}

void run_check(const CheckArguments& arguments, Common& common) {
  std::vector<AnySurface> surfaces;
  for (const std::string& text : arguments.surfaces) surfaces.push_back(surface_argument(text));
  if (surfaces.empty()) surfaces = all_surfaces();

  Progress progress("check", common);
  std::vector<std::vector<Check>> results(surfaces.size());
  parallel_for(
      surfaces.size(), common.threads,
      [&](std::size_t i) { results[i] = check_surface(surfaces[i], arguments.options); },
      [&](double share) { progress.update(share); });
  std::vector<Check> checks;
  for (const auto& result : results) checks.insert(checks.end(), result.begin(), result.end());
  const bool failed = std::any_of(checks.begin(), checks.end(), [](const Check& c) { return !c.passed; });
  const bool any =
      std::any_of(checks.begin(), checks.end(), [](const Check& c) { return c.skipped.empty(); });
  const bool passed = any && !failed;
  const char* verdict = failed ? "FAILED" : any ? "all passed" : "nothing checked: each route was skipped";
  common.exit_status = passed ? 0 : 1;
  if (arguments.markdown) return print_markdown(checks);
  if (!common.json && common.quiet) return void(std::puts(verdict));
  if (!common.json) return print_table(checks, verdict);
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
      "Check the closed forms against dual numbers, differences, 40 digits and the laws of geometry");
  auto arguments = std::make_shared<CheckArguments>();
  sub.add_option("SURFACE", arguments->surfaces, std::string(surface_help) + "; all when none is given");
  sub.add_option("--points", arguments->options.points, "random points per surface")
      ->capture_default_str()
      ->check(whole_number_between(1, 100000000));
  sub.add_option("--seed", arguments->options.seed, "seed of the random points")
      ->capture_default_str()
      ->check(whole_number);
  std::vector<std::string> routes;
  for (const std::string_view route : check_routes()) routes.emplace_back(route);
  sub.add_option("--routes", arguments->options.routes,
                 "only these routes, separated by commas; all when none is given")
      ->delimiter(',')
      ->check(CLI::IsMember(routes));
  sub.add_option(
         "--parameter-sets", arguments->options.parameter_sets,
         "for the routes high_precision*: use this many random sets of parameters instead of those given")
      ->capture_default_str()
      ->check(whole_number_between(0, 1000000));
  sub.add_flag("--markdown", arguments->markdown,
               "print tables of the worst error and its bound, in roundings, per surface and quantity");
  add_common(sub, common, "darboux check torus:minor_radius=0.4 --points 10000");
  sub.callback([arguments, &common] { run_check(*arguments, common); });
}

}  // namespace darboux
