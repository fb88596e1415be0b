// The tables of docs/reports/tools.md, for tools.sh:
//   benchmark_tools WORK MAKE MODELS FIGURES KEPT [--quick]
//   benchmark_tools WORK MAKE FIGURES --check: holds the orders against those of earlier.csv, for
//   tools_orders.sh
// WORK is an empty folder, MAKE the command of tools/make.mjs, MODELS the folder of Khronos's sample models,
// FIGURES that of earlier.csv and earlier_models.csv, KEPT that of the files NAME_N.TOOL.glb which tools made
// earlier.
#include "tools.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "tool_accuracy.h"

namespace darboux::bench {

std::vector<Line> read_figures(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  const auto cells_of = [](const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream rest(line);
    for (std::string cell; std::getline(rest, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::vector<std::string> names;
  std::vector<Line> lines;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> cells = cells_of(line);
    if (names.empty()) {
      names = cells;
      continue;
    }
    cells.resize(names.size());  // empty ones at the end are not read
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (k == 0) lines.emplace_back();
      lines.back()[names[k]] = cells[k];
    }
  }
  return lines;
}

bool reproduces(const std::string& figure, double value) {
  const std::size_t exponent_at = figure.find('e'), point = figure.find('.');
  const int exponent = exponent_at == std::string::npos ? 0 : std::stoi(figure.substr(exponent_at + 1));
  const std::size_t end = std::min(exponent_at, figure.size());
  const int decimals = point == std::string::npos ? 0 : static_cast<int>(end - point - 1);
  const double unit = std::pow(10.0, exponent - decimals);
  constexpr double own_rounding = 1e-9;  // a share: that of the figure and the unit in double
  return std::fabs(value - std::stod(figure)) <= unit / 2 * (1 + own_rounding);
}

std::string significant(double x, int digits) {
  if (x == 0) return "0";
  char text[32];
  std::snprintf(text, sizeof text, "%#.*g", digits, x);
  std::string result = text;
  if (result.back() == '.') result.pop_back();
  return result;
}

namespace {

const std::vector<int> resolutions{8, 16, 32, 64, 128, 256}, quick_resolutions{8, 16, 32};
constexpr int coarse = 64, fine = 128;  // of the orders

// The reports by shape, tool and resolution.
class Reports {
 public:
  void add(std::vector<ToolReport> reports) {
    for (ToolReport& r : reports) {
      if (std::find(n_.begin(), n_.end(), r.n) == n_.end()) n_.push_back(r.n);
      at_.emplace(std::tuple{r.shape, r.tool, r.n}, std::move(r.report));
    }
  }
  const std::vector<int>& resolutions() const { return n_; }
  const MeshReport* find(std::string_view shape, std::string_view tool, int n) const {
    const auto at = at_.find({shape, tool, n});
    return at == at_.end() ? nullptr : &at->second;
  }
  const ClassReport* find(std::string_view shape, std::string_view tool, int n,
                          std::string_view vertex_class) const {
    if (const MeshReport* report = find(shape, tool, n))
      for (const ClassReport& c : report->classes)
        if (vertex_class_names[static_cast<std::size_t>(c.vertex_class)] == vertex_class) return &c;
    return nullptr;
  }
  bool has_orders() const { return std::find(n_.begin(), n_.end(), fine) != n_.end(); }
  double order(std::string_view shape, std::string_view tool, std::string_view vertex_class) const {
    return std::log2(rms(shape, tool, coarse, vertex_class) / rms(shape, tool, fine, vertex_class));
  }
  double rms(std::string_view shape, std::string_view tool, int n, std::string_view vertex_class) const {
    const ClassReport* c = find(shape, tool, n, vertex_class);
    return c != nullptr && c->tangent_deg ? c->tangent_deg->rms : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  std::vector<int> n_;
  std::map<std::tuple<std::string_view, std::string_view, int>, MeshReport> at_;
};

// What the rounding of uvs to floats may cause, in degrees: two ends of an edge of 1/2n of the chart, each
// off by up to 2^-25.
double floor_deg(int n) {
  return 0x1p-24 * 2 * n * 180 / std::numbers::pi;
}

std::string order_text(const Reports& reports, std::string_view shape, std::string_view tool,
                       std::string_view vertex_class) {
  if (!reports.has_orders()) return "";
  const double order = reports.order(shape, tool, vertex_class);
  if (reports.rms(shape, tool, coarse, vertex_class) <= floor_deg(coarse) ||
      reports.rms(shape, tool, fine, vertex_class) <= floor_deg(fine))
    return "floor";
  std::ostringstream text;
  text.precision(2);
  text << std::fixed << order;
  return text.str();
}

std::string error_text(const ClassReport& report) {
  const std::size_t zero = without_direction(report);
  return (report.tangent_deg
              ? significant(report.tangent_deg->max, 2) + " / " + significant(report.tangent_deg->rms, 2)
              : "") +
         (zero > 0 ? " +" + std::to_string(zero) + " zero" : "");
}

void errors(const Reports& reports) {
  for (const std::string_view shape : shapes()) {
    std::cout << "\n### " << shape << "\n\n| vertices | tool |";
    for (const int n : reports.resolutions()) std::cout << " n = " << n << " |";
    std::cout << " p |\n|---|---|";
    for (std::size_t k = 0; k <= reports.resolutions().size(); ++k) std::cout << "---:|";
    std::cout << '\n';
    for (const std::string_view vertex_class : vertex_class_names)
      for (const std::string_view tool : tools()) {
        std::string cells;
        bool any = false;
        for (const int n : reports.resolutions()) {
          const ClassReport* c = reports.find(shape, tool, n, vertex_class);
          any = any || c != nullptr;
          cells += ' ' + (c != nullptr ? error_text(*c) : "") + " |";
        }
        if (any)
          std::cout << "| " << vertex_class << " | " << tool << " |" << cells << ' '
                    << order_text(reports, shape, tool, vertex_class) << " |\n";
      }
  }
}

// Each figure that was measured earlier, and the tallies by what it is.
void beside_earlier(const Reports& reports, const std::vector<Line>& earlier,
                    std::map<std::string, Tally>& tallies, std::ostream& out) {
  out << "| mesh | vertices | tool | n | max | rms | p | zero | "
         "|\n|---|---|---|---:|---:|---:|---:|---:|---|\n";
  for (const Line& line : earlier) {
    const std::string &shape = line.at("shape"), &vertex_class = line.at("class"), &tool = line.at("tool");
    const int n = std::stoi(line.at("n"));
    const auto known = [](std::span<const std::string_view> names, const std::string& name) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    if (!known(shapes(), shape) || !known(tools(), tool) || !known(vertex_class_names, vertex_class))
      throw std::runtime_error("earlier figures: no " + shape + ", " + vertex_class + ", " + tool);
    const ClassReport* c = reports.find(shape, tool, n, vertex_class);
    if (c == nullptr) {
      if (std::find(reports.resolutions().begin(), reports.resolutions().end(), n) !=
          reports.resolutions().end())
        throw std::runtime_error("earlier figures: the " + shape + " has no " + vertex_class);
      continue;  // --quick
    }
    const auto angle = [&](double Statistics::*part) {
      return c->tangent_deg ? (*c->tangent_deg).*part : std::numeric_limits<double>::quiet_NaN();
    };
    // What a figure is called, and its value now.
    const std::pair<std::string, double> values[]{{"max", angle(&Statistics::max)},
                                                  {"rms", angle(&Statistics::rms)},
                                                  {"order", reports.order(shape, tool, vertex_class)},
                                                  {"zero", static_cast<double>(without_direction(*c))}};
    const bool below_rounding = std::stod(line.at("max")) < 1e-13;
    std::string missed;
    out << "| " << shape << " | " << vertex_class << " | " << tool << " | " << n;
    for (const auto& [name, now] : values) {
      const std::string& figure = line.at(name);
      out << " | ";
      if (figure.empty() || (name == "order" && !reports.has_orders())) continue;
      out << figure << " → "
          << (name == "zero" ? std::to_string(without_direction(*c)) : significant(now, 3));
      const bool met = reproduces(figure, now);
      Tally& tally = tallies[below_rounding ? "errors that were below 1e-13°" : name];
      ++(met ? tally.met : tally.missed);
      if (!met) missed += (missed.empty() ? "" : ", ") + name;
    }
    out << " | " << (missed.empty() ? "met" : "**missed**: " + missed) << " |\n";
  }
}

void targets(const std::map<std::string, Tally>& tallies) {
  std::cout << "| figures | met | missed |\n|---|---:|---:|\n";
  for (const auto& [what, tally] : tallies)
    std::cout << "| " << what << " | " << tally.met << " | " << tally.missed << " |\n";
}

// Names of the tools over the columns of a table.
void tool_header(const std::string& first) {
  std::cout << "| " << first << " |";
  for (const std::string_view tool : tools()) std::cout << ' ' << tool << " |";
  std::cout << "\n|---|";
  for (std::size_t k = 0; k < tools().size(); ++k) std::cout << "---|";
  std::cout << '\n';
}
void shape_rows(const Reports& reports, int n, const std::function<std::string(const MeshReport&)>& cell) {
  for (const std::string_view shape : shapes()) {
    std::cout << "| " << shape << " |";
    for (const std::string_view tool : tools())
      std::cout << ' ' << cell(*reports.find(shape, tool, n)) << " |";
    std::cout << '\n';
  }
}

std::string interior_bitangent(const MeshReport& report) {
  for (const ClassReport& c : report.classes)
    if (c.vertex_class == VertexClass::interior && c.bitangent_deg)
      return significant(c.bitangent_deg->max, 2) + " / " + significant(c.bitangent_deg->rms, 2);
  return "";
}
std::string sign_convention(const MeshReport& report) {
  const Handedness& h = report.handedness;
  return std::string(handedness_convention_names[static_cast<std::size_t>(h.convention)]) +
         (h.wrong > 0 ? ", " + std::to_string(h.wrong) + " not" : "");
}

// The meshes of one resolution, with the tangents of the tools that run in node.
void make_meshes(const std::filesystem::path& work, const std::string& make, int n) {
  std::cerr << "n = " << n << " ...\n";
  const std::string command = make + " " + work.string() + " " + std::to_string(n);
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

// Every row that was measured earlier at n = 64: an order that was noted within 0.15; what was noted as the
// noise of floats at the floor; as many zero tangents. \returns whether all hold
bool check_orders(const std::filesystem::path& work, const std::string& make,
                  const std::filesystem::path& figures) {
  constexpr double tolerance = 0.15;
  Reports reports;
  for (const int n : {coarse, fine}) {
    make_meshes(work, make, n);
    reports.add(assess_tools(work, n));
  }
  std::size_t orders = 0, floors = 0, failed = 0;
  for (const Line& line : read_figures(figures / "earlier.csv")) {
    if (line.at("n") != std::to_string(coarse)) continue;
    const std::string &shape = line.at("shape"), &vertex_class = line.at("class"), &tool = line.at("tool"),
                      &figure = line.at("order");
    const double rms = reports.rms(shape, tool, coarse, vertex_class);
    const bool at_floor = rms <= floor_deg(coarse);
    // Of errors that were below what rounding may cause an order is noted too, but says nothing.
    const bool was_at_floor = figure.empty() || std::stod(line.at("rms")) <= floor_deg(coarse);
    const double order = reports.order(shape, tool, vertex_class);
    const ClassReport* c = reports.find(shape, tool, coarse, vertex_class);
    const std::size_t zero = c != nullptr ? without_direction(*c) : 0;
    const bool good = (was_at_floor ? at_floor : std::fabs(order - std::stod(figure)) <= tolerance) &&
                      std::to_string(zero) == line.at("zero");
    ++(was_at_floor ? floors : orders);
    if (good) continue;
    ++failed;
    std::cout << "FAILED: " << shape << ' ' << vertex_class << ' ' << tool << ": rms " << rms << ", order "
              << order << ", " << zero << " zero, earlier rms " << line.at("rms") << ", order " << figure
              << ", " << line.at("zero") << " zero\n";
  }
  std::cout << orders << " orders, " << floors << " at the floor, " << failed << " failed\n";
  return failed == 0 && orders > 0 && floors > 0;
}

void run(const std::filesystem::path& work, const std::string& make, const std::filesystem::path& models,
         const std::filesystem::path& figures, const std::filesystem::path& kept, bool quick) {
  Reports reports;
  std::ostringstream kept_rows;
  for (const int n : quick ? quick_resolutions : resolutions) {
    make_meshes(work, make, n);
    reports.add(assess_tools(work, n));
    beside_kept(work, n, kept, kept_rows);
  }
  std::map<std::string, Tally> tallies;
  std::ostringstream figure_rows, model_rows;
  beside_earlier(reports, read_figures(figures / "earlier.csv"), tallies, figure_rows);
  sample_models(models, read_figures(figures / "earlier_models.csv"), tallies["sample models"], model_rows);

  std::cout << "- assimp: " << DARBOUX_BENCHMARK_ASSIMP << " by its own account\n";
  if (quick) std::cout << "- quick: not for the report\n";
  std::cout << "\n### Beside figures measured earlier\n\n";
  targets(tallies);
  std::cout << '\n' << figure_rows.str();
  std::cout << "\n### The same meshes\n\nCorners whose bits are those of a file that was made earlier.\n\n"
               "| file | corners | the same position, normal, uv | the same tangent |\n|---|---:|---:|---:|\n"
            << kept_rows.str();
  errors(reports);
  const int n = std::min(coarse, reports.resolutions().back());
  std::cout << "\n### Verdicts\n\nWhat `validate()` says with its limit of 5°, n = " << n << ".\n\n";
  tool_header("mesh");
  shape_rows(reports, n, [](const MeshReport& r) {
    return std::string(verdict_names[static_cast<std::size_t>(r.verdict)]) +
           (r.verdict == Verdict::fail ? ": " + std::string(r.findings.front().code) : "");
  });
  std::cout << "\n### The sign w\n\nThe convention that the corners follow, n = " << n << ".\n\n";
  tool_header("mesh");
  shape_rows(reports, n, sign_convention);
  std::cout << "\n### The bitangent that w gives\n\nw · cross(N, T) against the derivative by the stored v, "
               "max / rms in the interior, n = "
            << n << ".\n\n";
  tool_header("mesh");
  shape_rows(reports, n, interior_bitangent);
  std::cout << "\n### Official sample models\n\n" << model_rows.str();
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  try {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    if (std::erase(arguments, "--check") > 0 && arguments.size() == 3)
      return darboux::bench::check_orders(arguments[0], arguments[1], arguments[2]) ? 0 : 1;
    const bool quick = std::erase(arguments, "--quick") > 0;
    if (arguments.size() != 5) throw std::runtime_error("usage: tools.sh [--quick]");
    darboux::bench::run(arguments[0], arguments[1], arguments[2], arguments[3], arguments[4], quick);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_tools: %s\n", error.what());
    return 1;
  }
}
