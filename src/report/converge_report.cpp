#include "converge_report.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/counted.h"
#include "base/text.h"
#include "csv.h"
#include "finite_or_null.h"

namespace darboux {

namespace {

using Json = nlohmann::ordered_json;

std::string_view class_name(const Study& study) {
  return name_in(vertex_class_names, study.vertex_class);
}
std::string_view verdict_name(const Study& study) {
  return name_in(order_verdict_names, study.verdict);
}

// With two decimals; never "-0.00".
std::string fixed(double x) {
  char buffer[64];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, std::round(100 * x) / 100 + 0.0,
                                std::chars_format::fixed, 2)
                      .ptr};
}

}  // namespace

nlohmann::ordered_json studies_json(const std::vector<Study>& studies) {
  Json list = Json::array();
  for (const Study& s : studies) {
    const auto column = [&](auto member) {
      Json values = Json::array();
      for (const Level& level : s.levels) values.push_back(level.*member);
      return values;
    };
    list.push_back({{"surface", s.surface},
                    {"v_range", {s.v_first, s.v_last}},
                    {"mesh", s.mesh},
                    {"method", s.method},
                    {"class", class_name(s)},
                    {"quantity", s.quantity},
                    {"resolutions", column(&Level::resolution)},
                    {"h", column(&Level::h)},
                    {"max_deg", column(&Level::max_deg)},
                    {"rms_deg", column(&Level::rms_deg)},
                    {"p95_deg", column(&Level::p95_deg)},
                    {"rms_deg_of_mesh", column(&Level::rms_of_mesh)},
                    {"seconds", column(&Level::seconds)},
                    {"corners", column(&Level::corners)},
                    {"fallback_corners", column(&Level::fallback)},
                    {"used", column(&Level::used)},
                    {"order", finite_or_null(s.order)},
                    {"order_ci", {finite_or_null(s.order_low), finite_or_null(s.order_high)}},
                    {"max_order", finite_or_null(s.max_order)},
                    {"expected_order", s.expected_order},
                    {"floor_deg", s.levels.back().floor_deg},
                    {"floors_deg", column(&Level::floor_deg)},
                    {"verdict", verdict_name(s)}});
  }
  return list;
}

std::string studies_csv(const std::vector<Study>& studies) {
  std::string text =
      "surface,mesh,method,class,quantity,resolution,h,max_deg,rms_deg,rms_deg_least,rms_deg_most,p95_deg,"
      "floor_deg,seconds,corners,fallback_corners,used,order,order_low,order_high,max_order,expected_order,"
      "verdict\r\n";
  for (const Study& s : studies)
    for (const Level& l : s.levels) {
      for (const std::string_view field :
           {std::string_view(s.surface), s.mesh, s.method, class_name(s), s.quantity})
        text += csv_text(field) + ',';
      text += std::to_string(l.resolution);
      const auto [least, most] = std::minmax_element(l.rms_of_mesh.begin(), l.rms_of_mesh.end());
      for (const double x : {l.h, l.max_deg, l.rms_deg, *least, *most, l.p95_deg, l.floor_deg, l.seconds})
        text += ',' + csv_number(x);
      text +=
          ',' + std::to_string(l.corners) + ',' + std::to_string(l.fallback) + (l.used ? ",true" : ",false");
      for (const double x : {s.order, s.order_low, s.order_high, s.max_order, s.expected_order})
        text += ',' + csv_number(x);
      text += ',' + csv_text(verdict_name(s)) + "\r\n";
    }
  return text;
}

std::string verdict_summary(const std::vector<Study>& studies) {
  std::string text = counted(studies.size(), "study", "studies");
  const char* separator = ": ";
  const auto add = [&](OrderVerdict verdict, bool holds, const char* words) {
    const auto count = std::count_if(studies.begin(), studies.end(), [&](const Study& s) {
      return s.verdict == verdict && s.holds() == holds;
    });
    if (count == 0) return;
    text += separator + std::to_string(count) + ' ' + words;
    separator = ", ";
  };
  add(OrderVerdict::as_expected, true, "as expected");
  add(OrderVerdict::faster, true, "faster");
  add(OrderVerdict::at_the_floor, true, "at the floor");
  add(OrderVerdict::does_not_converge, true, "without convergence, where none is expected");
  add(OrderVerdict::slower, false, "slower than expected");
  add(OrderVerdict::does_not_converge, false, "without convergence, where it is expected");
  const auto rare = std::count_if(studies.begin(), studies.end(), [](const Study& s) {
    return s.verdict != OrderVerdict::does_not_converge && !s.max_converges();
  });
  if (rare > 0)
    text += "; in " + std::to_string(rare) + " of those that converge, the largest error does not";
  return text;
}

namespace {

// Orders of the tangents on one family of meshes of one surface.
struct OrderTable {
  std::string surface, mesh;
  std::vector<std::string_view> classes, methods;
  std::map<std::pair<std::string_view, std::string_view>, std::string> cells;  // of method and class

  std::string cell(std::string_view method, std::string_view of_class) const {
    const auto found = cells.find({method, of_class});
    return found == cells.end() ? "" : found->second;
  }
};

// "2.00 [1.99, 2.01] !": !: less than expected; *: the largest error does not converge
std::string order_cell(const Study& s) {
  if (s.verdict == OrderVerdict::at_the_floor) return "at the floor";
  const std::string mark = !s.holds() ? " !" : s.max_converges() ? "" : " *";
  if (s.verdict == OrderVerdict::does_not_converge) return s.holds() ? "does not converge" : "none" + mark;
  return fixed(s.order) + " [" + fixed(s.order_low) + ", " + fixed(s.order_high) + ']' + mark;
}

std::vector<OrderTable> order_tables(const std::vector<Study>& studies) {
  std::vector<OrderTable> tables;
  std::vector<std::map<VertexClass, bool, std::greater<>>> classes;
  for (const Study& s : studies) {
    if (tables.empty() || s.surface != tables.back().surface || s.mesh != tables.back().mesh) {
      tables.push_back({s.surface, std::string(s.mesh), {}, {}, {}});
      classes.emplace_back();
    }
    if (s.quantity != "tangent") continue;
    OrderTable& table = tables.back();
    if (std::find(table.methods.begin(), table.methods.end(), s.method) == table.methods.end())
      table.methods.push_back(s.method);
    classes.back()[s.vertex_class] = true;
    table.cells[{s.method, class_name(s)}] = order_cell(s);
  }
  for (std::size_t i = 0; i < tables.size(); ++i)
    for (const auto& [of_class, there] : classes[i])
      tables[i].classes.push_back(name_in(vertex_class_names, of_class));
  return tables;
}

}  // namespace

std::string orders_text(const std::vector<Study>& studies) {
  std::string text =
      "Order of convergence of the tangents, with its 95 % interval; !: below what is expected;\n"
      "*: the largest error does not converge:\n";
  for (const OrderTable& table : order_tables(studies)) {
    const auto row = [&](std::string_view first, const auto& cell) {
      std::string line = "  " + padded(std::string(first), 18);
      for (const std::string_view of_class : table.classes) line += ' ' + padded(cell(of_class), 20);
      return line.erase(line.find_last_not_of(' ') + 1) + '\n';
    };
    text += '\n' + table.surface + ", " + table.mesh + '\n';
    text += row("", [](std::string_view of_class) { return std::string(of_class); });
    for (const std::string_view method : table.methods)
      text += row(method, [&](std::string_view of_class) { return table.cell(method, of_class); });
  }
  return text + '\n';
}

std::vector<std::string> unexpected(const std::vector<Study>& studies) {
  std::vector<std::string> lines;
  for (const Study& s : studies) {
    if (s.holds()) continue;
    std::vector<const Level*> used;  // three at least, their h falls
    for (const Level& level : s.levels)
      if (level.used) used.push_back(&level);
    const Level &coarse = *used[used.size() - 2], &fine = *used.back();
    char numbers[160];
    std::snprintf(numbers, sizeof numbers,
                  "order %.2f [%.2f, %.2f], %.2f between the two finest meshes used, expected %g", s.order,
                  s.order_low, s.order_high,
                  std::log(coarse.rms_deg / fine.rms_deg) / std::log(coarse.h / fine.h), s.expected_order);
    lines.push_back(std::string(verdict_name(s)) + ": " + s.surface + ", " + std::string(s.mesh) + " mesh, " +
                    std::string(s.method) + ", " + std::string(s.quantity) + " of the " +
                    std::string(class_name(s)) + ": " + numbers);
  }
  return lines;
}

namespace {

// For the tangents on one family of meshes of one surface: the error and run time of each method.
std::string levels_markdown(const std::vector<Study>& studies, const OrderTable& table) {
  std::vector<const Study*> rows;
  std::set<int> resolutions;
  for (const Study& s : studies) {
    if (s.surface != table.surface || s.mesh != table.mesh || s.quantity != "tangent") continue;
    rows.push_back(&s);
    for (const Level& level : s.levels) resolutions.insert(level.resolution);
  }
  const auto head = [&](std::string text) {
    std::string rule = "\n|---|";
    for (const int n : resolutions) text += ' ' + std::to_string(n) + " |", rule += "---|";
    return text + rule;
  };
  const auto cells = [&](const Study& s, double Level::*member) {
    std::string text;
    for (const int n : resolutions) {
      const auto at = std::find_if(s.levels.begin(), s.levels.end(),
                                   [n](const Level& level) { return level.resolution == n; });
      text += ' ' + (at == s.levels.end() ? std::string() : rounded((*at).*member, 3)) + " |";
    }
    return text;
  };
  std::string errors = head("\nDegrees, rms, by rows of the mesh:\n\n| method, class |"),
              seconds = head("\n\nSeconds of the method on the mesh, one thread:\n\n| method |");
  std::string_view timed;
  for (const Study* s : rows) {
    errors += "\n| " + std::string(s->method) + ", " + std::string(class_name(*s)) + " |" +
              cells(*s, &Level::rms_deg);
    if (std::exchange(timed, s->method) != s->method)
      seconds += "\n| " + std::string(s->method) + " |" + cells(*s, &Level::seconds);
  }
  return errors + seconds + '\n';
}

}  // namespace

std::string converge_markdown(const std::vector<Study>& studies, const Provenance& p) {
  std::string text = "# Orders of convergence\n\n" + verdict_summary(studies) +
                     ".\n\nOf the tangents: orders with their 95 % intervals, errors, run times. !: below "
                     "what is expected; *: the largest error "
                     "does not converge.\n";
  for (const OrderTable& table : order_tables(studies)) {
    text += "\n## " + table.surface + ", " + table.mesh + "\n\n| method |";
    for (const std::string_view of_class : table.classes) text += ' ' + std::string(of_class) + " |";
    text += "\n|---|";
    for (std::size_t i = 0; i < table.classes.size(); ++i) text += "---|";
    for (const std::string_view method : table.methods) {
      text += "\n| " + std::string(method) + " |";
      for (const std::string_view of_class : table.classes) text += ' ' + table.cell(method, of_class) + " |";
    }
    text += '\n' + levels_markdown(studies, table);
  }
  if (const auto lines = unexpected(studies); !lines.empty()) {
    text += "\n## Not as expected\n\n";
    for (const std::string& line : lines) text += "- " + line + '\n';
  }
  return text + "\nMade by `" + p.command + "`: Darboux " + p.version + ", " + p.compiler + ", " + p.machine +
         ", " + p.date + ".\n";
}

}  // namespace darboux
