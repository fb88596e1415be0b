// The matrix of docs/reports/fit-matrix.md: kinds x parts of the surface x numbers of points x outliers x
// noise, and what one fit of one of its data sets gives. tests/statistics/matrix.cpp runs all of it, and
// tests/fit/fit_matrix_test.cpp some.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/math/distributions/binomial.hpp>
#include <nlohmann/json.hpp>

#include <darboux/fit_points.h>

#include "synthetic_points.h"

namespace darboux::matrix {

inline constexpr std::array<std::string_view, 6> kinds{"plane", "sphere", "cylinder",
                                                       "cone",  "torus",  "ellipsoid"};
inline constexpr std::array<Region, 5> regions{Region::full, Region::half, Region::quarter, Region::patch,
                                               Region::strip};
inline constexpr std::array<std::size_t, 4> counts{10, 50, 1000, 10000};
inline constexpr std::array<double, 3> sigmas{1e-4, 1e-2, 3e-2};

struct Outliers {
  double share;
  OutlierPattern pattern;
};
inline constexpr std::array<Outliers, 7> outliers{{{0, OutlierPattern::scattered},
                                                   {0.3, OutlierPattern::scattered},
                                                   {0.5, OutlierPattern::scattered},
                                                   {0.3, OutlierPattern::cluster},
                                                   {0.5, OutlierPattern::cluster},
                                                   {0.3, OutlierPattern::second_surface},
                                                   {0.5, OutlierPattern::second_surface}}};

inline std::string_view name_of(Region region) {
  constexpr std::array<std::string_view, 5> names{"full", "half", "quarter", "30 degree patch", "thin strip"};
  return names[static_cast<std::size_t>(region)];
}
inline std::string_view name_of(OutlierPattern pattern) {
  constexpr std::array<std::string_view, 3> names{"scattered", "cluster", "second surface"};
  return names[static_cast<std::size_t>(pattern)];
}

struct Cell {
  std::size_t kind, region, count, outliers, sigma;  // indices of the lists above

  std::string key() const {
    std::string text(kinds[kind]);
    text += "/";
    text += name_of(regions[region]);
    text += "/" + std::to_string(counts[count]) + "/";
    const Outliers& o = matrix::outliers[outliers];
    text += std::to_string(static_cast<int>(std::lround(100 * o.share))) + "%";
    if (o.share > 0) (text += " ") += name_of(o.pattern);
    constexpr std::array<std::string_view, 3> levels{"1e-4", "1e-2", "3e-2"};
    text += "/";
    text += levels[sigma];
    return text;
  }
};

// 10 000 points on the full and the half surface only.
inline std::vector<Cell> cells() {
  std::vector<Cell> list;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    for (std::size_t r = 0; r < regions.size(); ++r)
      for (std::size_t n = 0; n < counts.size(); ++n)
        for (std::size_t o = 0; o < outliers.size(); ++o)
          for (std::size_t s = 0; s < sigmas.size(); ++s)
            if (counts[n] < 10000 || r < 2) list.push_back({k, r, n, o, s});
  return list;
}

inline SyntheticPoints points_of(const Cell& cell, std::uint64_t run) {
  const Outliers& o = outliers[cell.outliers];
  SyntheticOptions options;
  options.count = counts[cell.count];
  options.sigma = sigmas[cell.sigma];
  options.outlier_share = o.share;
  options.outlier_pattern = o.pattern;
  options.region = regions[cell.region];
  options.random_shape = kinds[cell.kind] != "torus" || regions[cell.region] != Region::patch;
  options.seed =
      1 + run +
      1000 * ((((cell.kind * 8 + cell.region) * 8 + cell.count) * 8 + cell.outliers) * 8 + cell.sigma);
  return make_points(kinds[cell.kind], options);
}

// What a fit states, and whether the truth lies inside.
struct Run {
  bool usable = false;              // fitted as what it is
  std::string reason{};             // where it is not
  bool is_second = false;           // of the second surface, which is as right
  double mahalanobis = 0;           // squared error over the bound, per parameter
  double told = 0;                  // the same of a fit that is told inliers, noise and truth; 0: not asked
  int parameters = 0, covered = 0;  // of the intervals of the surface's own parameters
  std::optional<bool> axis{}, centre{}, normal{};
  double largest_bound = 0;  // of the standard errors of all parameters: Cramer-Rao, sizes are about 1
  bool automatic = false;    // whether it was fitted under auto as well
  std::string found{};       // under auto; empty where that is not usable
  std::string auto_reason{};
  double seconds = 0;
};

struct Asked {
  bool told = false, automatic = true;
};

Run run_of(const Cell& cell, std::uint64_t number, const Asked& asked = {});

// k of n.
struct Hits {
  std::size_t k = 0, n = 0;
  void add(bool hit) { k += hit, ++n; }
  void operator+=(const Hits& other) { k += other.k, n += other.n; }
  // Whether the odds of so few, or so many, are below one in a million where the true share is p.
  bool below(double p) const { return n > 0 && boost::math::cdf(binomial(p), static_cast<double>(k)) < 1e-6; }
  bool above(double p) const {
    return k > 0 && boost::math::cdf(boost::math::complement(binomial(p), static_cast<double>(k) - 1)) < 1e-6;
  }
  std::string text() const {
    if (n == 0) return "-";
    return std::to_string(
        static_cast<int>(std::lround(100.0 * static_cast<double>(k) / static_cast<double>(n))));
  }

 private:
  boost::math::binomial_distribution<> binomial(double p) const {
    return boost::math::binomial_distribution<>(static_cast<double>(n), p);
  }
};

// All runs of a cell, or of several.
struct Tally {
  static constexpr std::array<const char*, 8> names{
      "usable", "usable_where_bound", "parameters", "axis", "centre", "normals", "wrong_kind", "auto_usable"};
  std::array<Hits, 8> hits{};
  double squares = 0, told = 0, told_of = 0, seconds = 0;  // told_of: the squares of the same runs
  std::size_t asked = 0;
  std::size_t usable = 0;
  std::map<std::string, std::size_t>
      reasons{};  // why not usable, its first words; under auto: what was found

  void add(const Run& run, const Cell& cell) {
    hits[0].add(run.usable);
    if (run.largest_bound < 0.1) hits[1].add(run.usable);
    const std::string& kind = std::string(kinds[cell.kind]);
    if (run.automatic) hits[7].add(!run.found.empty());
    // Where half of the points lie on a second surface, a sphere, either is right.
    if (!run.found.empty()) {
      const bool second = outliers[cell.outliers].pattern == OutlierPattern::second_surface &&
                          outliers[cell.outliers].share >= 0.5 && run.found == "sphere";
      hits[6].add(run.found != kind && !second);
      if (run.found != kind && !second) ++reasons["auto: " + run.found];
    } else if (run.automatic) {
      ++reasons["auto: " + run.auto_reason.substr(0, 60)];
    }
    seconds = std::max(seconds, run.seconds);
    if (!run.usable) {
      ++reasons[run.reason.substr(0, 60)];
      return;
    }
    ++usable;
    squares += run.mahalanobis;
    if (run.told > 0) told += run.told, told_of += run.mahalanobis, ++asked;
    hits[2] += {static_cast<std::size_t>(run.covered), static_cast<std::size_t>(run.parameters)};
    if (run.axis) hits[3].add(*run.axis);
    if (run.centre) hits[4].add(*run.centre);
    if (run.normal) hits[5].add(*run.normal);
  }
  void operator+=(const Tally& other) {
    for (std::size_t k = 0; k < hits.size(); ++k) hits[k] += other.hits[k];
    squares += other.squares, told += other.told, told_of += other.told_of, asked += other.asked;
    usable += other.usable;
    seconds = std::max(seconds, other.seconds);
    for (const auto& [reason, count] : other.reasons) reasons[reason] += count;
  }

  nlohmann::ordered_json json() const {
    nlohmann::ordered_json j;
    for (std::size_t k = 0; k < hits.size(); ++k) j[names[k]] = {hits[k].k, hits[k].n};
    j["squares"] = squares, j["told"] = told, j["told_of"] = told_of, j["asked"] = asked;
    j["seconds"] = seconds;
    j["reasons"] = reasons;
    return j;
  }
  static Tally of(const nlohmann::ordered_json& j) {
    Tally t;
    for (std::size_t k = 0; k < t.hits.size(); ++k)
      t.hits[k] = {j[names[k]][0].get<std::size_t>(), j[names[k]][1].get<std::size_t>()};
    // JSON has no infinity: an error beyond all bounds.
    const auto sum = [&](const char* name) {
      return j[name].is_null() ? std::numeric_limits<double>::infinity() : j[name].get<double>();
    };
    t.squares = sum("squares"), t.told = sum("told"), t.told_of = sum("told_of"), t.asked = j["asked"];
    t.seconds = j["seconds"];
    t.reasons = j["reasons"].get<std::map<std::string, std::size_t>>();
    t.usable = t.hits[0].k;
    return t;
  }

  // Root mean square over the bound.
  double error() const { return usable ? std::sqrt(squares / static_cast<double>(usable)) : 0; }
  double error_over_told() const { return told > 0 ? std::sqrt(told_of / told) : 0; }

  enum class Judge { all, no_times };
  // What is beyond chance; empty where nothing is.
  std::string outside(const Cell& cell, Judge judge = Judge::all) const {
    std::string text;
    for (std::size_t k = 2; k < 6; ++k) {
      if (hits[k].below(0.92)) text += std::string(names[k]) + " " + hits[k].text() + " %, ";
      if (hits[k].above(0.98)) text += std::string(names[k]) + " " + hits[k].text() + " %, ";
    }
    if (hits[6].above(0.01)) text += "wrong kind " + hits[6].text() + " %, ";
    if (hits[1].below(0.9)) text += "usable where the bound is small " + hits[1].text() + " %, ";
    const bool scattered = outliers[cell.outliers].pattern == OutlierPattern::scattered;
    const std::size_t n = counts[cell.count];
    if (n >= 1000 && cell.region < 2 && scattered && hits[0].below(0.99))
      text += "usable " + hits[0].text() + " %, ";
    // A mean of N chi squared of p degrees of freedom, over p.
    const double unknowns = std::array{3., 4., 5., 6., 7., 9.}[cell.kind];
    const double limit = n >= 1000 ? 1.1 : n >= 50 ? 1.25 : 0;
    const double spread =
        1 + 4.75 * std::sqrt(2 / (unknowns * std::max<double>(1, static_cast<double>(usable))));
    if (usable && limit > 0 && cell.sigma < 2 && error() > limit * std::sqrt(spread))
      text += "error " + std::to_string(error()) + ", ";
    if (judge == Judge::all && seconds > 2) text += "slowest " + std::to_string(seconds) + " s, ";
    return text;
  }

  static std::string header() {
    return "| cell | usable | of bound < 0.1 | parameters | axis | centre | normals | wrong | auto usable | "
           "error | over told | slowest |";
  }
  std::string row(const std::string& name) const {
    std::string text = "| " + name + " |";
    for (const Hits& h : hits) text += ' ' + h.text() + " |";
    char numbers[100];
    std::snprintf(numbers, sizeof numbers, " %.2f | %.2f | %.2f |", error(), error_over_told(), seconds);
    return text + numbers;
  }
  std::string reasons_text() const {
    std::vector<std::pair<std::size_t, std::string>> list;
    for (const auto& [reason, count] : reasons) list.emplace_back(count, reason);
    std::sort(list.rbegin(), list.rend());
    std::string text;
    for (std::size_t k = 0; k < std::min<std::size_t>(list.size(), 6); ++k)
      text += "      " + std::to_string(list[k].first) + " x " + list[k].second + "\n";
    return text;
  }
};

}  // namespace darboux::matrix
