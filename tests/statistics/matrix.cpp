// The matrix of docs/reports/fit-matrix.md, for matrix.sh:
//   fit_matrix [--cells PART-OF-KEY]... [--usable N] [--tries N] [--results FILE.jsonl [--shard I/N]]
//              [--threads N] [--list]
// A results file is resumed; `darboux merge` joins those of shards. Prints every cell that is outside, a row
// per kind, region and number of points, and what is pooled.
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <thread>
#include <utility>
#include <vector>

#include "fit_matrix.h"
#include "intervals.h"
#include "study/study.h"

namespace darboux::matrix {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::vector<std::string> parts;
  std::size_t usable = 100, tries = 300;
  StudyOptions study;
  bool list = false;
};

Arguments parse(int count, char** values) {
  Arguments a;
  a.study.threads = static_cast<int>(std::thread::hardware_concurrency());
  for (int k = 1; k < count; ++k) {
    const std::string name = values[k];
    if (name == "--list") {
      a.list = true;
      continue;
    }
    if (k + 1 == count) throw std::runtime_error("expected a value after " + name);
    const std::string value = values[++k];
    if (name == "--cells")
      a.parts.push_back(value);
    else if (name == "--usable")
      a.usable = std::stoul(value);
    else if (name == "--tries")
      a.tries = std::stoul(value);
    else if (name == "--results")
      a.study.results = value;
    else if (name == "--shard")
      a.study.shard = parse_shard(value);
    else if (name == "--threads")
      a.study.threads = std::stoi(value);
    else
      throw std::runtime_error(
          "expected --cells, --usable, --tries, --results, --shard, --threads or --list, got " + name);
  }
  return a;
}

bool wanted(const std::string& key, const std::vector<std::string>& parts) {
  return std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
    return ("/" + key + "/").find(part) != std::string::npos;
  });
}

Json run_cell(const Cell& cell, const Arguments& arguments) {
  Tally tally;
  for (std::uint64_t run = 0; run < arguments.tries && tally.usable < arguments.usable; ++run)
    tally.add(run_of(cell, run, {.told = sigmas[cell.sigma] == 3e-2}), cell);
  return tally.json();
}

// Cells that are asked alike.
struct Pool {
  const char* name;
  bool (*holds)(const Cell&);
};
bool has(const Cell& c, OutlierPattern pattern) {
  return outliers[c.outliers].share > 0 && outliers[c.outliers].pattern == pattern;
}
bool is_large(const Cell& c) {
  return regions[c.region] != Region::patch && regions[c.region] != Region::strip;
}
constexpr Pool pools[]{
    {"no outliers", [](const Cell& c) { return outliers[c.outliers].share == 0; }},
    {"scattered", [](const Cell& c) { return has(c, OutlierPattern::scattered); }},
    {"clusters", [](const Cell& c) { return has(c, OutlierPattern::cluster); }},
    {"a second surface", [](const Cell& c) { return has(c, OutlierPattern::second_surface); }},
    {"no outliers, full, half or quarter, 50 points and more",
     [](const Cell& c) { return outliers[c.outliers].share == 0 && is_large(c) && counts[c.count] >= 50; }},
    {"scattered, full, half or quarter, 1000 points and more",
     [](const Cell& c) {
       return has(c, OutlierPattern::scattered) && is_large(c) && counts[c.count] >= 1000;
     }},
    {"σ 1e-4", [](const Cell& c) { return sigmas[c.sigma] == 1e-4; }},
    {"σ 1e-2", [](const Cell& c) { return sigmas[c.sigma] == 1e-2; }},
    {"σ 3e-2", [](const Cell& c) { return sigmas[c.sigma] == 3e-2; }},
};

std::string share(const Hits& hits) {
  if (hits.n == 0) return "-";
  std::array<char, 16> text;
  std::snprintf(text.data(), text.size(), "%.1f %%",
                100.0 * static_cast<double>(hits.k) / static_cast<double>(hits.n));
  return text.data();
}

int main_of(int count, char** values) {
  const Arguments arguments = parse(count, values);
  std::vector<Cell> chosen;
  std::vector<Job> jobs;
  for (const Cell& cell : cells())
    if (wanted(cell.key(), arguments.parts)) chosen.push_back(cell);
  if (arguments.list) {
    for (const Cell& cell : chosen) std::cout << cell.key() << '\n';
    return 0;
  }
  for (const Cell& cell : chosen)
    jobs.push_back({cell.key(), [cell, &arguments] { return run_cell(cell, arguments); }});
  const StudyIdentity identity{
      "fit_matrix",
      DARBOUX_VERSION,
      {{"cells", arguments.parts}, {"usable", arguments.usable}, {"tries", arguments.tries}},
      Json::object()};
  double shown = 0;
  const std::vector<Json> results = run_study(identity, jobs, arguments.study, [&](double share) {
    if (share >= shown + 0.05) std::fprintf(stderr, "%.0f %%\n", 100 * (shown = share));
  });
  std::vector<std::pair<std::string, Tally>> rows;
  std::vector<Tally> pooled(std::size(pools));
  std::size_t outside = 0;
  std::cout << Tally::header() << '\n';
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (results[k].is_null()) continue;
    const Tally tally = Tally::of(results[k]);
    const Cell& cell = chosen[k];
    const std::string kind(kinds[cell.kind]);
    const std::string row =
        kind + ", " + std::string(name_of(regions[cell.region])) + ", " + std::to_string(counts[cell.count]);
    if (rows.empty() || rows.back().first != row) rows.push_back({row, {}});
    rows.back().second += tally;
    for (std::size_t p = 0; p < pooled.size(); ++p)
      if (pools[p].holds(cell)) pooled[p] += tally;
    const std::string what = tally.outside(cell);
    outside += !what.empty();
    if (!what.empty() || chosen.size() < 50)
      std::cout << tally.row(cell.key()) << ' ' << what << '\n' << tally.reasons_text();
  }
  std::cout << '\n';
  for (const auto& [name, tally] : rows) std::cout << tally.row(name) << '\n';
  std::cout << "\n| | intervals of parameters | of normals | another kind under auto |\n";
  for (std::size_t p = 0; p < pooled.size(); ++p)
    std::printf("| %s | %s | %s | %s |\n", pools[p].name, share(pooled[p].hits[2]).c_str(),
                share(pooled[p].hits[5]).c_str(), share(pooled[p].hits[6]).c_str());
  std::fflush(stdout);
  std::cout << outside << " of " << chosen.size() << " cells outside\n";
  return outside > 0;
}

}  // namespace
}  // namespace darboux::matrix

int main(int count, char** values) {
  try {
    return darboux::matrix::main_of(count, values);
  } catch (const std::exception& error) {
    std::cerr << "fit_matrix: " << error.what() << '\n';
    return 2;
  }
}
