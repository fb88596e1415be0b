// The measured part of docs/reports/fit.md, for fit.sh:
//   fit_statistics [--quick] [--row NAME] [--sets N]   all rows or one, with so many data sets instead of its
//                                                      own number
//   fit_statistics --replay ROW SEED [POINTS]          one data set, with all that its fit says
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <thread>

#include "intervals.h"
#include "others.h"
#include "rows.h"

namespace darboux {
namespace {

std::string fixed(double x, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, x);
  return text;
}
std::string scientific(double x) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1e", x);
  return text;
}
std::string interval(const Estimate& e, int digits, double unit = 1) {
  return fixed(unit * e.low, digits) + " to " + fixed(unit * e.high, digits);
}

struct Target {
  std::string what, required, measured;
  bool met;
};

// Tables of one row, and its lines of the targets.
struct Report {
  std::vector<Target> targets;
  std::string tables;
  void line(std::initializer_list<std::string> cells) {
    tables += '|';
    for (const std::string& cell : cells) tables += ' ' + cell + " |";
    tables += '\n';
  }
  void header(const std::string& title, std::initializer_list<std::string> cells) {
    tables += "\n### " + title + "\n\n";
    line(cells);
    tables += "|---|";
    for (std::size_t k = 1; k < cells.size(); ++k) tables += "---:|";
    tables += '\n';
  }
};

// All sets of a row, seeds from 0, on two threads.
std::vector<Outcome> run_sets(std::string_view row, std::size_t sets,
                              Outcome (*fit)(std::string_view, std::uint64_t) = outcome_of) {
  std::vector<Outcome> outcomes(sets);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t k = next++; k < sets; k = next++) {
      try {
        outcomes[k] = fit(row, k);
      } catch (const std::exception& error) {
        outcomes[k].reason = std::string("exception: ") + error.what();
      }
      if (k % std::max<std::size_t>(1, sets / 20) == 0)
        std::cerr << row << ": " << k << " of " << sets << std::endl;  // flushed
    }
  };
  std::thread second(work);
  work();
  second.join();
  return outcomes;
}

// The groups of a row in order of appearance, with the seeds of each.
std::vector<std::pair<std::string, std::vector<std::size_t>>> groups(std::string_view row, std::size_t sets) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> list;
  for (std::size_t seed = 0; seed < sets; ++seed) {
    const std::string group = case_of(row, seed).group;
    auto at = std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.first == group; });
    if (at == list.end()) at = list.insert(at, {group, {}});
    at->second.push_back(seed);
  }
  std::stable_sort(list.begin(), list.end(), [&](const auto& a, const auto& b) {
    return a.second.front() % judged_kinds.size() < b.second.front() % judged_kinds.size();
  });
  return list;
}

// The seeds for which `bad` is largest, those of bad <= floor left out.
std::string worst(std::vector<std::size_t> seeds, std::size_t count, double floor,
                  const std::function<double(std::size_t)>& bad) {
  std::stable_sort(seeds.begin(), seeds.end(), [&](std::size_t a, std::size_t b) { return bad(a) > bad(b); });
  std::string text;
  for (std::size_t k = 0; k < std::min(count, seeds.size()) && bad(seeds[k]) > floor; ++k)
    text += (k ? " " : "") + std::to_string(seeds[k]);
  return text;
}

Report efficiency(std::size_t sets) {
  const std::vector<Outcome> outcomes = run_sets("efficiency", sets),
                             told = run_sets("efficiency", sets, told_outcome_of);
  Report report;
  report.header("Error in units of the Cramér-Rao bound, 20 % outliers",
                {"kind, sigma", "error", "95 % interval", "required", "told the inliers", "95 % interval",
                 "runs", "failed", "estimated over true sigma", "worst seeds"});
  for (const auto& [group, seeds] : groups("efficiency", sets)) {
    const auto error_of = [&seeds = seeds](const std::vector<Outcome>& of) {
      std::vector<double> squares;
      for (const std::size_t s : seeds)
        if (of[s].success()) squares.push_back(of[s].mahalanobis);
      return std::pair(root_mean(squares), seeds.size() - squares.size());
    };
    double ratio = 0;
    for (const std::size_t s : seeds)
      if (outcomes[s].success()) ratio += outcomes[s].sigma_ratio;
    const auto [error, failed] = error_of(outcomes);
    const Estimate least = error_of(told).first;
    const double required = required_efficiency(case_of("efficiency", seeds.front()).kind);
    const bool met = error.value <= required && failed == 0;
    report.line({group, fixed(error.value, 3), interval(error, 3), fixed(required, 2), fixed(least.value, 3),
                 interval(least, 3), std::to_string(seeds.size()), std::to_string(failed),
                 fixed(ratio / static_cast<double>(seeds.size() - failed), 4),
                 worst(seeds, 3, 3, [&](std::size_t s) { return outcomes[s].mahalanobis; })});
    report.targets.push_back({"error over the bound, " + group, "<= " + fixed(required, 2),
                              fixed(error.value, 3) + " (" + interval(error, 3) + ")" +
                                  (failed > 0 ? ", " + std::to_string(failed) + " failed" : ""),
                              met});
  }
  return report;
}

Report success(std::string_view row, std::size_t sets) {
  const bool few = row == "success-20";
  const std::vector<Outcome> outcomes = run_sets(row, sets);
  Report report;
  report.header(
      std::string("Success, ") + (few ? "20 % outliers, sigma 0.1, 1 and 3 %" : "40 % outliers, sigma 1 %"),
      {"kind", "runs", "failed", "share of successes, %", "95 % interval", "seeds of failures"});
  std::size_t failed = 0;
  const auto bad = [&](std::size_t s) {
    return outcomes[s].success() ? 0.0 : 1 + std::min(1e9, outcomes[s].mahalanobis);
  };
  for (const auto& [group, seeds] : groups(row, sets)) {
    const auto failures = static_cast<std::size_t>(
        std::count_if(seeds.begin(), seeds.end(), [&](std::size_t s) { return !outcomes[s].success(); }));
    failed += failures;
    const Estimate e = share(seeds.size() - failures, seeds.size());
    report.line({group, std::to_string(seeds.size()), std::to_string(failures), fixed(100 * e.value, 2),
                 interval(e, 2, 100), worst(seeds, 8, 0, bad)});
  }
  const Estimate e = share(sets - failed, sets);
  report.targets.push_back({std::string("success, ") + (few ? "20" : "40") + " % outliers",
                            few ? "0 failures" : ">= 99 %",
                            std::to_string(failed) + " of " + std::to_string(sets) +
                                " failed: " + fixed(100 * e.value, 2) + " % (" + interval(e, 2, 100) + ")",
                            few ? failed == 0 : e.value >= 0.99});
  return report;
}

Report frames(std::size_t sets) {
  const std::vector<Outcome> outcomes = run_sets("frames", sets),
                             told = run_sets("frames", sets, told_outcome_of);
  Report report;
  report.header("Coverage of 95 % intervals of a frame, %",
                {"kind", "runs", "n", "95 % interval", "told the inliers", "t, b, n", "95 % interval",
                 "told the inliers", "t said to be unknown", "worst seeds"});
  for (const auto& [group, seeds] : groups("frames", sets)) {
    // Share of true frames inside; a failed fit does not cover, a frame said to be unknown is not counted.
    const auto covered = [&seeds = seeds](const std::vector<Outcome>& of, std::size_t degrees,
                                          std::optional<double> Outcome::*distance) {
      std::size_t inside = 0, all = 0;
      for (const std::size_t s : seeds) {
        const std::optional<double>& d = of[s].*distance;
        if (!d && of[s].success()) continue;
        ++all;
        inside += d && *d <= chi_squared_95[degrees] ? 1 : 0;
      }
      return std::pair(share(inside, all), seeds.size() - all);
    };
    const auto add = [&, &group = group](const std::string& what, const Estimate& e, std::size_t unknown,
                                         std::size_t all) {
      report.targets.push_back({"95 % of " + what + ", " + group, "93 to 97 %",
                                fixed(100 * e.value, 1) + " % (" + interval(e, 1, 100) + ")",
                                e.value >= 0.93 && e.value <= 0.97 && 20 * unknown <= all});
    };
    const auto [n, no_normals] = covered(outcomes, 2, &Outcome::normal);
    add("normals", n, no_normals, seeds.size());
    const bool whole = group != "plane" && group != "sphere";
    const auto [frame, no_frames] = covered(outcomes, 3, &Outcome::frame);
    if (whole) add("frames", frame, no_frames, seeds.size());
    const auto in_told = [&](std::size_t degrees, std::optional<double> Outcome::*distance) {
      return fixed(100 * covered(told, degrees, distance).first.value, 1);
    };
    report.line({group, std::to_string(seeds.size()), fixed(100 * n.value, 1), interval(n, 1, 100),
                 in_told(2, &Outcome::normal), whole ? fixed(100 * frame.value, 1) : "",
                 whole ? interval(frame, 1, 100) : "", whole ? in_told(3, &Outcome::frame) : "",
                 whole ? std::to_string(no_frames) : "", worst(seeds, 3, 12, [&](std::size_t s) {
                   return outcomes[s].success()
                              ? std::max(outcomes[s].normal.value_or(0), outcomes[s].frame.value_or(0))
                              : 1e9;
                 })});
  }
  return report;
}

Report recognition(std::size_t sets) {
  const std::vector<Outcome> outcomes = run_sets("auto", sets);
  Report report;
  report.header("Which kind, not told, sigma 1 %, 20 % outliers",
                {"kind", "runs", "right, %", "undetermined", "wrong", "taken for",
                 "seeds of those that are not right"});
  std::size_t right = 0, wrong = 0;
  for (const auto& [group, seeds] : groups("auto", sets)) {
    std::size_t right_here = 0, undetermined = 0;
    std::map<std::string, int> taken;
    for (const std::size_t s : seeds) {
      if (!outcomes[s].usable)
        ++undetermined;
      else if (outcomes[s].found == group)
        ++right_here;
      else
        ++taken[outcomes[s].found];
    }
    std::string names;
    for (const auto& [name, count] : taken)
      names += (names.empty() ? "" : ", ") + name + " " + std::to_string(count);
    const std::size_t wrong_here = seeds.size() - right_here - undetermined;
    report.line(
        {group, std::to_string(seeds.size()),
         fixed(100.0 * static_cast<double>(right_here) / static_cast<double>(seeds.size()), 2),
         std::to_string(undetermined), std::to_string(wrong_here), names,
         worst(seeds, 8, 0, [&](std::size_t s) {
           return !outcomes[s].usable ? 1.0 : outcomes[s].found == case_of("auto", s).kind ? 0.0 : 2.0;
         })});
    right += right_here;
    wrong += wrong_here;
  }
  const Estimate e = share(right, sets);
  report.targets.push_back({"the right kind", ">= 99.5 %",
                            fixed(100 * e.value, 2) + " % (" + interval(e, 2, 100) + ")", e.value >= 0.995});
  report.targets.push_back(
      {"a wrong kind", "never", std::to_string(wrong) + " of " + std::to_string(sets), wrong == 0});
  return report;
}

Report exactness(std::string_view row, std::size_t sets) {
  const bool far = row == "far";
  const std::vector<Outcome> outcomes = run_sets(row, sets);
  Report report;
  report.header(far ? "Noise-free and far away: the largest error"
                    : "Noise-free, scales 1e-150 to 1e150: the largest relative error",
                {far ? "kind" : "kind, all scales", "sets", "error", "required", "worst seeds"});
  double largest = 0;  // over what is required
  for (const auto& [group, seeds] : groups(row, sets)) {
    double error = 0;
    for (const std::size_t s : seeds) error = std::max(error, outcomes[s].error);
    const double required = required_exactness(row, case_of(row, seeds.front()).options);
    largest = std::max(largest, error / required);
    report.line({group, std::to_string(seeds.size()), scientific(error), scientific(required),
                 worst(seeds, 3, required, [&](std::size_t s) { return outcomes[s].error; })});
  }
  report.targets.push_back(far ? Target{"noise-free, far away", "<= 2 eps offset",
                                        fixed(2 * largest, 2) + " eps offset", largest <= 1}
                               : Target{"noise-free", "<= 1e-12", scientific(1e-12 * largest), largest <= 1});
  return report;
}

struct Seconds {
  double wall, processor;  // the latter of all threads together
};
Seconds timed(const std::function<void()>& work) {
  const auto processor = [] {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double before = processor();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), processor() - before};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// The median over data sets of so many points.
Seconds time_of(std::string_view row, std::string_view kind, const std::string& fitted_as, std::size_t count,
                std::size_t sets) {
  const auto index = static_cast<std::size_t>(std::find(judged_kinds.begin(), judged_kinds.end(), kind) -
                                              judged_kinds.begin());
  std::vector<double> wall, processor;
  for (std::size_t k = 0; k < sets; ++k) {
    Case c = case_of(row, index + judged_kinds.size() * k);
    c.options.count = count;
    c.fitted_as = fitted_as;
    const SyntheticPoints points = make_points(c.kind, c.options);
    const Seconds s = timed([&] { fit_of(c, points); });
    wall.push_back(s.wall);
    processor.push_back(s.processor);
  }
  std::cerr << row << ": " << kind << ", " << count << " points: " << 1e3 * median(processor) << " ms"
            << std::endl;
  return {median(wall), median(processor)};
}

Report time_rows(std::string_view row, std::size_t sets) {
  const bool with_uv = row == "time-uv";
  Report report;
  const std::string what = with_uv ? "with uvs" : "without uvs";
  report.header("Time " + what + ", ms of the processor (all threads together), in brackets by the clock",
                {"kind", "10^4 points", "10^5", "10^6", "10^6 over 100 × 10^4", "auto, 10^4"});
  std::vector<Target> linear;
  for (const std::string_view kind : judged_kinds) {
    const std::string name(kind);
    std::array<Seconds, 3> t{};
    std::array<std::string, 3> cells;
    for (std::size_t k = 0; k < 3; ++k) {
      t[k] = time_of(row, kind, name,
                     k == 0   ? 10000
                     : k == 1 ? 100000
                              : 1000000,
                     k == 0   ? sets
                     : k == 1 ? (sets + 1) / 2
                              : 1 + sets / 5);
      cells[k] = fixed(1e3 * t[k].processor, 1) + " (" + fixed(1e3 * t[k].wall, 1) + ")";
    }
    const double growth = t[2].processor / (100 * t[0].processor);
    std::string automatic;
    if (!with_uv) {
      const Seconds s = time_of(row, kind, "auto", 10000, sets);
      automatic = fixed(1e3 * s.processor, 1) + " (" + fixed(1e3 * s.wall, 1) + ")";
    }
    report.line({name, cells[0], cells[1], cells[2], fixed(growth, 2), automatic});
    report.targets.push_back({"time of 10^4 points, " + what + ", " + name, "<= 20 ms",
                              fixed(1e3 * t[0].processor, 1) + " ms", t[0].processor <= 0.020});
    linear.push_back({"linear to 10^6 points, " + what + ", " + name, "10^6 <= 1.5 × 100 × 10^4",
                      fixed(growth, 2), growth <= 1.5});
  }
  report.targets.insert(report.targets.end(), linear.begin(), linear.end());
  return report;
}

Report public_points(std::string_view, std::size_t) {
  Report report;
  report.header(
      "Public point sets (PCL's tests)",
      {"set", "points", "fit", "inliers", "largest difference from what is stated", "tolerance", "as auto"});
  std::size_t stated = 0, met = 0;
  for (const PublicFile& file : public_files) {
    const PublicPoints points = read_public_points(DARBOUX_SHARED "/points", file.name);
    const std::string name(file.name);
    if (!points.found) {
      report.line({name, "not there", "", "", "", "", ""});
      continue;
    }
    const PointFit fit = fit_points(points.cloud, {.surface = std::string(file.kind)});
    const PointFit any = fit_points(points.cloud);
    const bool has = fit.usable && fit.surface;
    double error = std::numeric_limits<double>::infinity();
    if (has) error = public_error(points.expected, pcl_coefficients(*fit.surface));
    if (!points.expected.empty()) {
      ++stated;
      met += error <= points.tolerance ? 1 : 0;
    }
    report.line({name, std::to_string(points.cloud.positions.size()),
                 has ? fit.surface->surface.specification(5) : fit.reason, std::to_string(fit.inliers),
                 points.expected.empty() ? "nothing stated" : scientific(error), number(points.tolerance),
                 any.usable ? std::string(any.surface->surface.info().name) : any.reason});
  }
  report.targets.push_back({"public point sets", "all within PCL's tolerance",
                            std::to_string(met) + " of " + std::to_string(stated),
                            met == stated && stated > 0});
  return report;
}

Report others(std::string_view, std::size_t sets) {
  std::vector<OtherFitter> fitters = other_fitters();
  fitters.insert(fitters.begin(), {"Darboux",
                                   {judged_kinds.begin(), judged_kinds.end()},
                                   [](const PointCloud& cloud, std::string_view kind, double) {
                                     PointFit fit = fit_points(cloud, {.surface = std::string(kind)});
                                     return fit.usable ? fit.surface : std::nullopt;
                                   }});
  Report report;
  report.header("Beside other programs: the same points, sigma 1 %, 20 % outliers",
                {"kind", "by", "found, %", "largest error of a parameter, median",
                 "error over the bound, median", "processor, median ms"});
  for (std::size_t k = 0; k < judged_kinds.size(); ++k)
    for (const OtherFitter& other : fitters) {
      if (std::find(other.kinds.begin(), other.kinds.end(), judged_kinds[k]) == other.kinds.end()) continue;
      std::vector<double> errors, over_bound, times;
      std::size_t found = 0;
      for (std::size_t s = 0; s < sets; ++s) {
        const Case c = case_of("others", k + judged_kinds.size() * s);
        const SyntheticPoints points = make_points(c.kind, c.options);
        std::optional<PlacedSurface> surface;
        times.push_back(timed([&] { surface = other.fit(points.cloud, c.kind, points.sigma); }).processor);
        const double error = surface ? parameter_error(points, *surface).cwiseAbs().maxCoeff() : INFINITY;
        found += error < 0.5 ? 1 : 0;  // half the size: any surface near the points
        errors.push_back(error);
        over_bound.push_back(surface ? std::sqrt(mahalanobis_per_parameter(points, *surface)) : INFINITY);
      }
      std::cerr << "others: " << other.name << ", " << judged_kinds[k] << std::endl;
      report.line({std::string(judged_kinds[k]), other.name,
                   fixed(100.0 * static_cast<double>(found) / static_cast<double>(sets), 0),
                   scientific(median(errors)), fixed(median(over_bound), 2), fixed(1e3 * median(times), 1)});
    }
  report.tables += "\nFound: every parameter within 0.5 of the truth, sizes being about 1.\n";
  for (const std::string& missing : missing_fitters()) report.tables += '\n' + missing + '\n';
  return report;
}

struct Row {
  std::string_view name;
  std::size_t sets;
  std::function<Report(std::string_view, std::size_t)> run;
};

// Times first: nothing else runs then.
const std::vector<Row>& all_rows() {
  static const std::vector<Row> rows{
      {"time", 9, time_rows},
      {"time-uv", 9, time_rows},
      {"others", 9, others},
      {"noise-free", 540, exactness},
      {"far", 180, exactness},
      {"points", 1, public_points},
      {"efficiency", 18000, [](std::string_view, std::size_t n) { return efficiency(n); }},
      {"success-20", 10000, success},
      {"success-40", 3000, success},
      {"frames", 12000, [](std::string_view, std::size_t n) { return frames(n); }},
      {"auto", 5000, [](std::string_view, std::size_t n) { return recognition(n); }},
  };
  return rows;
}

void replay(std::string_view row, std::uint64_t seed, std::size_t count) {
  Case c = case_of(row, seed);
  if (count > 0) c.options.count = count;
  const SyntheticPoints points = make_points(c.kind, c.options);
  const PointFit fit = fit_of(c, points);
  std::cout << c.group << ", fitted as " << c.fitted_as << ", options.seed " << c.options.seed << "\ntruth "
            << points.truth.surface.specification(6) << '\n'
            << points.truth.placement.matrix() << "\nsigma " << points.sigma << ", inliers "
            << points.feet.size() << "\nusable " << fit.usable << ": " << fit.reason << "\nsigma "
            << fit.sigma << ", rms " << fit.rms << ", inliers " << fit.inliers << ", outliers "
            << fit.outliers << ", iterations " << fit.iterations << ", seconds " << fit.seconds << '\n';
  for (const FitCandidate& candidate : fit.candidates)
    std::cout << "candidate " << candidate.name << ", bic " << candidate.bic << ", rms " << candidate.rms
              << '\n';
  if (!fit.surface) return;
  std::cout << "fit " << fit.surface->surface.specification(6) << '\n'
            << fit.surface->placement.matrix() << '\n';
  for (const StandardError& e : fit.standard_errors)
    std::cout << "standard error " << e.name << ' ' << e.value << '\n';
  const Eigen::VectorXd error = parameter_error(points, *fit.surface);
  std::cout << "error        " << error.transpose() << '\n';
  if (points.sigma == 0) return;
  const Eigen::VectorXd bound =
      points.sigma / points.scale * unit_information(points).inverse().diagonal().cwiseSqrt();
  std::cout << "bound        " << bound.transpose() << "\nsquared Mahalanobis distance over parameters "
            << mahalanobis_per_parameter(points, *fit.surface) << '\n';
  if (row != "frames") return;
  Outcome outcome;
  judge_frame(points, fit, c.options.seed, outcome);
  std::cout << "normal " << outcome.normal.value_or(NAN) << ", frame " << outcome.frame.value_or(NAN) << '\n';
}

int run(const std::vector<std::string>& arguments) {
  bool quick = false;
  std::string only;
  std::size_t sets = 0;
  for (auto a = arguments.begin(); a != arguments.end(); ++a) {
    if (*a == "--quick") {
      quick = true;
    } else if (*a == "--row" && std::next(a) != arguments.end()) {
      only = *++a;
    } else if (*a == "--sets" && std::next(a) != arguments.end()) {
      sets = std::stoul(*++a);
    } else if (*a == "--replay" && arguments.end() - a > 2) {
      replay(a[1], std::stoull(a[2]), arguments.end() - a > 3 ? std::stoull(a[3]) : 0);
      return 0;
    } else {
      throw std::runtime_error("unknown argument " + *a +
                               ", expected --quick, --row NAME, --sets N, --replay ROW SEED");
    }
  }
  std::vector<Target> targets;
  std::string tables;
  bool any = false;
  for (const Row& row : all_rows()) {
    if (!only.empty() && row.name != only) continue;
    any = true;
    const Report report = row.run(row.name, sets    ? sets
                                            : quick ? std::max<std::size_t>(1, row.sets / 20)
                                                    : row.sets);
    targets.insert(targets.end(), report.targets.begin(), report.targets.end());
    tables += report.tables;
  }
  if (!any) {
    std::string names;
    for (const Row& row : all_rows()) names += (names.empty() ? "" : ", ") + std::string(row.name);
    throw std::runtime_error("unknown row " + only + "; rows: " + names);
  }
  std::cout << "\n### Targets\n\n| what | required | measured | |\n|---|---|---:|---|\n";
  for (const Target& t : targets)
    std::cout << "| " << t.what << " | " << t.required << " | " << t.measured << " | "
              << (t.met ? "met" : "**missed**") << " |\n";
  std::cout << tables;
  return 0;
}

}  // namespace
}  // namespace darboux

int main(int argc, char** argv) {
  try {
    return darboux::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "fit_statistics: " << error.what() << '\n';
    return 2;
  }
}
