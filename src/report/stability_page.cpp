#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <string_view>

#include "base/text.h"
#include "html.h"
#include "report_page.h"
#include "stability_report.h"

namespace darboux {

extern const std::string_view stability_page_js, stability_page_js_sha256;

namespace {

using Json = nlohmann::ordered_json;

// The results of one surface in one sweep.
struct SweepCell {
  double error = 0;    // the largest, of curves that lead
  double factor = -1;  // error / bound where it is largest, of these; negative: no bound is stated
  double naive = -1;   // the largest of the naive formulas; negative: not asked
  bool asked = false, beyond = false;
};

struct Overview {
  std::vector<std::string> surfaces;
  std::vector<std::string_view> sweeps;
  std::map<std::pair<std::string, std::string_view>, SweepCell> cells;
};

Overview overview_of(const std::vector<StabilityCurve>& curves) {
  Overview result;
  const auto note = [](auto& list, const auto& item) {
    if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
  };
  for (const StabilityCurve& c : curves) {
    note(result.surfaces, c.surface);
    note(result.sweeps, c.sweep);
    SweepCell& cell = result.cells[{c.surface, c.sweep}];
    const double largest = largest_error(c);
    if (c.route == "naive") cell.naive = std::fmax(cell.naive, largest);
    if (leads(c)) {
      cell.asked = true;
      cell.error = std::fmax(cell.error, largest);
      if (has_bound(c)) cell.factor = std::fmax(cell.factor, c.worst.factor);
    }
    cell.beyond = cell.beyond || !c.holds();
  }
  std::sort(result.sweeps.begin(), result.sweeps.end(), [](std::string_view a, std::string_view b) {
    return &find_stability_sweep(a) < &find_stability_sweep(b);
  });
  return result;
}

std::string digits_or_all(double error) {
  if (!(error < 0x1p53)) return "all";
  char text[32];
  std::snprintf(text, sizeof text, error < 1000 ? "%.2g" : "%.0e", error);
  return text;
}

std::string words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

// Decimal logarithms to a hundredth, enough for a picture; null if there is no number, or it is infinite.
Json logarithms(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double x : values) {
    const double log = std::round(100 * std::log10(std::fmax(x, 0.1))) / 100;
    list.push_back(std::isfinite(log) && !std::isnan(x) ? Json(log) : Json(nullptr));
  }
  return list;
}

// The unit of errors.
std::string_view error_unit(const StabilitySweep& sweep) {
  if (sweep.domain == StabilityDomain::fits) return "error in standard errors";
  if (sweep.name == "jitter" || sweep.name == "slivers") return "error in mesh widths";
  return sweep.domain == StabilityDomain::meshes ? "error in half steps" : "error in roundings";
}

// x are indices into `grids`, all values of x that the curves of a sweep have.
Json page_data(const std::vector<StabilityCurve>& curves) {
  Json list = Json::array(), sweeps = Json::object(), routes = Json::object();
  std::map<std::string_view, std::vector<double>> grids;
  for (const StabilityCurve& c : curves) {
    std::vector<double>& grid = grids[c.sweep];
    std::vector<double> all;
    const bool grows = find_stability_sweep(c.sweep).from < find_stability_sweep(c.sweep).to;
    std::set_union(grid.begin(), grid.end(), c.x.begin(), c.x.end(), std::back_inserter(all),
                   [grows](double a, double b) { return grows ? a < b : a > b; });
    grid = std::move(all);
  }
  for (const StabilityCurve& c : curves) {
    const std::vector<double>& grid = grids[c.sweep];
    Json curve{{"surface", c.surface}, {"sweep", c.sweep}, {"route", c.route}, {"quantity", c.quantity}};
    if (c.x.size() < grid.size()) {
      Json places = Json::array();
      for (const double x : c.x) places.push_back(std::find(grid.begin(), grid.end(), x) - grid.begin());
      curve["at"] = places;
    }
    curve["error"] = logarithms(c.error_u);
    if (leads(c)) curve["bound"] = logarithms(c.bound_u);
    list.push_back(curve);
  }
  for (const StabilitySweep& s : stability_sweeps())
    sweeps[std::string(s.name)] = {
        {"unit", s.unit}, {"summary", s.summary}, {"error", error_unit(s)}, {"x", grids[s.name]}};
  Json falling = Json::array();
  for (const StabilitySweep& s : stability_sweeps())
    if (s.from > s.to) falling.push_back(s.name);
  for (const StabilityRoute& r : stability_routes()) routes[std::string(r.name)] = r.summary;
  return {{"curves", list},
          {"sweeps", sweeps},
          {"routes", routes},
          {"quantities", stability_quantities},
          {"falling", falling}};
}

// How near an error is to its bound, in five steps: up to a tenth, a quarter, a half, all of it, beyond.
std::string_view step_of(const SweepCell& cell) {
  if (cell.beyond) return "s4";
  if (cell.factor < 0) return "unbounded";
  return cell.factor < 0.1 ? "s0" : cell.factor < 0.25 ? "s1" : cell.factor < 0.5 ? "s2" : "s3";
}

// Two digits in little space: 110, 1600, 1e12.
std::string in_cell(double error) {
  std::string text = digits_or_all(error);
  const std::size_t exponent = text.find("e+");
  if (exponent == std::string::npos) return text;
  if (error < 9950) return rounded(std::stod(text), 4);
  return text.erase(exponent + 1, text[exponent + 2] == '0' ? 2 : 1);
}

std::string map_table(const Overview& overview) {
  std::string text = "<thead><tr><th scope=col>surface";
  for (const std::string_view sweep : overview.sweeps) text += "<th scope=col class=n>" + words(sweep);
  text += "</tr></thead>\n<tbody>\n";
  for (const std::string& surface : overview.surfaces) {
    text += "<tr><th scope=row>" + escape(surface.substr(0, surface.find(':')));
    for (const std::string_view sweep : overview.sweeps) {
      const auto cell = overview.cells.find({surface, sweep});
      if (cell == overview.cells.end() || !cell->second.asked) {
        text += "<td>";
        continue;
      }
      const SweepCell& c = cell->second;
      text += "<td class=" + std::string(step_of(c)) + "><button data-surface=\"" + escape(surface) +
              "\" data-sweep=" + std::string(sweep) + " title=\"" + share_text(c.factor) +
              (c.factor < 0 ? "\">" : " of the bound\">") + in_cell(c.error) + "</button>";
    }
    text += "</tr>\n";
  }
  return text + "</tbody>\n";
}

std::string findings_table(const std::vector<StabilityCurve>& curves) {
  std::string rows;
  for (const StabilityCurve& c : curves)
    if (!c.holds())
      rows += "<tr><td>" + escape(c.worst.surface) + "<td>" + words(c.sweep) + "<td>" + std::string(c.route) +
              "<td>" + escape(words(c.worst.member)) + "<td class=n>" + digits_or_all(c.worst.error_u) +
              "<td class=n>" + rounded(c.worst.factor, 2) + "<td class=n>" + rounded(c.worst.x, 3) + "<td>" +
              "<button type=button class=link data-surface=\"" + escape(c.surface) +
              "\" data-sweep=" + std::string(c.sweep) + " data-quantity=" + std::string(c.quantity) + '>' +
              shortest(c.worst.u) + ", " + shortest(c.worst.v) + "</button></tr>\n";
  if (rows.empty()) return "<p>Nothing.</p>\n";
  return "<p class=needs-script hidden><input type=search placeholder=Find aria-label=Find></p>\n<div "
         "class=scroll><table class=adopt data-name=beyond-bound>\n<thead><tr><th scope=col>surface<th "
         "scope=col>sweep<th scope=col>route"
         "<th scope=col>quantity<th scope=col class=n>roundings<th scope=col class=n>times its bound"
         "<th scope=col class=n>at x<th scope=col>u, v</tr></thead>\n<tbody>\n" +
         rows + "</tbody>\n</table></div>\n";
}

}  // namespace

std::string stability_page(const std::vector<StabilityCurve>& curves, const Provenance& p) {
  ReportPage page;
  page.title = "Darboux: numerical stability";
  page.question = "Where do tangent frames lose their digits?";
  page.lead =
      "Each sweep makes evaluation harder by degrees: closer to a pole, farther from the origin, in another "
      "size. Errors are counted in roundings: 1 is 2<sup>&minus;53</sup> in double, 2<sup>&minus;24</sup> in "
      "float. All numbers are compared with the same formulas in 40 digits, beside the bound that is stated "
      "for them.";
  page.answer = stability_summary(curves) + ".";
  page.body = R"html(<section class=card>
<h2>Surfaces by sweeps</h2>
<p class=soft>The largest error of Darboux in double, of every method over meshes, of the fit: in
roundings, in steps of the stored data, in standard errors. The stronger the colour, the nearer to its
bound: a tenth, a quarter, half, all of it; red is beyond, what has no colour has no bound. Large errors
within their bound are the condition's: no formula in these inputs does better. A click shows the
curves.</p>
<div class=scroll><table class="map upright" id=map>
)html" + map_table(overview_of(curves)) +
              R"html(</table></div>
</section>
<section class=card id=interactive hidden>
<h2 id=what>Curves</h2>
<p class=soft id=about></p>
<div class=controls>
<label>Surface <select id=surface></select></label>
<label>Sweep <select id=sweep></select></label>
<label>Quantity <select id=quantity></select></label>
</div>
<fieldset class=legend id=legend aria-label="Routes that are drawn"></fieldset>
)html" +
              picture_html(
                  "plot",
                  "Error against x. Dashed: the bound of Darboux in double, or of the first method that has "
                  "one. A point at the upper edge is no number, or no digit right.") +
              "</section>\n<section class=card>\n<h2>Beyond its bound</h2>\n" + findings_table(curves) +
              "</section>\n";
  page.data = page_data(curves);
  page.script = stability_page_js;
  page.script_sha256 = stability_page_js_sha256;
  return report_page(page, p);
}

std::string stability_markdown(const std::vector<StabilityCurve>& curves, const Provenance& p) {
  const Overview overview = overview_of(curves);
  const auto table = [&](auto text_of) {
    std::string text = "| surface |";
    for (const std::string_view sweep : overview.sweeps) text += ' ' + words(sweep) + " |";
    text += "\n|---|";
    for (std::size_t i = 0; i < overview.sweeps.size(); ++i) text += "---|";
    for (const std::string& surface : overview.surfaces) {
      text += "\n| " + surface.substr(0, surface.find(':')) + " |";
      for (const std::string_view sweep : overview.sweeps) {
        const auto cell = overview.cells.find({surface, sweep});
        text += ' ' + (cell == overview.cells.end() ? std::string() : text_of(cell->second)) + " |";
      }
    }
    return text + "\n\n";
  };
  std::string text =
      "# Numerical stability\n\n" + stability_summary(curves) +
      ".\n\n## Darboux in double\n\nThe largest error in roundings (2^-53), and the share of its "
      "bound that is nearest to it.\n\n" +
      table([](const SweepCell& c) {
        return c.asked ? digits_or_all(c.error) + ", " + share_text(c.factor) : std::string();
      });
  text +=
      "## The naive formulas\n\nTheir largest error in roundings; all: no digit is left, or no number "
      "came.\n\n" +
      table([](const SweepCell& c) { return c.naive < 0 ? std::string() : digits_or_all(c.naive); });
  text += "## Sweeps\n\n| sweep | from | to | x is | |\n|---|---|---|---|---|\n";
  for (const std::string_view name : overview.sweeps) {
    const StabilitySweep& s = find_stability_sweep(name);
    text += "| " + words(s.name) + " | " + shortest(s.from) + " | " + shortest(s.to) + " | " +
            std::string(s.unit) + " | " + std::string(s.summary) + " |\n";
  }
  return text + "\nMade by `" + p.command + "`: Darboux " + p.version + ", " + p.compiler + ", " + p.machine +
         ", " + p.date + ".\n";
}

// ---- the picture ------------------------------------------------------------------------------------------

namespace {

constexpr std::array<std::pair<std::string_view, const char*>, 9> route_colours{{{"double", "#0072b2"},
                                                                                 {"float", "#56b4e9"},
                                                                                 {"naive", "#d55e00"},
                                                                                 {"dual", "#009e73"},
                                                                                 {"central2", "#e69f00"},
                                                                                 {"central4", "#cc79a7"},
                                                                                 {"central6", "#7f7f7f"},
                                                                                 {"central8", "#000000"},
                                                                                 {"ridders", "#8c6d31"}}};
constexpr double panel_width = 300, panel_height = 190, gap = 60;
constexpr double least_log = -1, most_log = 16.5;

std::string coordinate(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", x);
  return text;
}

// One panel: x and errors on logarithmic scales, at (left, top).
std::string panel(const std::vector<const StabilityCurve*>& curves, double left, double top) {
  const StabilitySweep& sweep = find_stability_sweep(curves.front()->sweep);
  const double from = std::log10(sweep.from), to = std::log10(sweep.to);
  const auto at_x = [&](double x) { return left + panel_width * (std::log10(x) - from) / (to - from); };
  const auto at_y = [&](double error) {
    const double log = error > 0 ? std::log10(error) : least_log;
    return top + panel_height *
                     (most_log - std::clamp(std::isnan(log) ? most_log : log, least_log, most_log)) /
                     (most_log - least_log);
  };
  std::string out = "<text class=\"t\" x=\"" + coordinate(left) + "\" y=\"" + coordinate(top - 10) + "\">" +
                    words(sweep.name) + ": " + words(curves.front()->quantity) + "</text>\n";
  for (const int decade : {0, 4, 8, 12, 16})
    out += "<path class=\"g\" d=\"M" + coordinate(left) + ' ' + coordinate(at_y(std::pow(10.0, decade))) +
           'h' + coordinate(panel_width) + "\"/>\n<text x=\"" + coordinate(left - 6) + "\" y=\"" +
           coordinate(at_y(std::pow(10.0, decade)) + 4) + "\" text-anchor=\"end\">" +
           (decade == 0 ? "1" : "1e" + std::to_string(decade)) + "</text>\n";
  for (const auto& [x, anchor] : {std::pair{sweep.from, "start"}, {sweep.to, "end"}})
    out += "<text x=\"" + coordinate(at_x(x)) + "\" y=\"" + coordinate(top + panel_height + 18) +
           "\" text-anchor=\"" + anchor + "\">" + rounded(x, 2) + "</text>\n";
  for (const StabilityCurve* c : curves) {
    const auto colour = std::find_if(route_colours.begin(), route_colours.end() - 1,
                                     [&](const auto& r) { return r.first == c->route; });
    const auto path = [&](const std::vector<double>& values, const std::string& attributes) {
      std::string d;
      for (std::size_t i = 0; i < c->x.size(); ++i)
        if (!std::isnan(values[i]))
          d += (d.empty() ? "M" : "L") + coordinate(at_x(c->x[i])) + ' ' + coordinate(at_y(values[i]));
      return d.empty() ? d : "<path " + attributes + " d=\"" + d + "\"/>\n";
    };
    if (leads(*c)) out += path(c->bound_u, "class=\"b\"");
    out += path(c->error_u, "class=\"l\" stroke=\"" + std::string(colour->second) + '"');
  }
  return out;
}

}  // namespace

std::string stability_picture(const std::vector<StabilityCurve>& curves) {
  std::vector<std::vector<const StabilityCurve*>> panels;
  std::vector<std::string_view> routes;
  if (!curves.empty())
    for (const StabilitySweep& sweep : stability_sweeps()) {
      // The quantity with the largest error of any route.
      const StabilityCurve* worst = nullptr;
      double largest = -1;
      for (const StabilityCurve& c : curves) {
        if (c.surface != curves.front().surface || c.sweep != sweep.name ||
            sweep.domain != StabilityDomain::evaluation)
          continue;
        for (const double error : c.error_u)
          if (!(error <= largest)) {
            worst = &c;
            largest = error;
          }
      }
      if (!worst) continue;
      auto& chosen = panels.emplace_back();
      for (const StabilityCurve& c : curves)
        if (c.surface == worst->surface && c.sweep == worst->sweep && c.quantity == worst->quantity) {
          chosen.push_back(&c);
          if (std::find(routes.begin(), routes.end(), c.route) == routes.end()) routes.push_back(c.route);
        }
    }
  constexpr std::size_t columns = 3;
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  const double width = columns * (panel_width + gap) + 20,
               height = 80 + static_cast<double>(rows) * (panel_height + gap) + 20;
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + coordinate(width) + "\" height=\"" +
      coordinate(height) + "\" viewBox=\"0 0 " + coordinate(width) + ' ' + coordinate(height) +
      "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#1b2a3a\">\n<title>Errors in roundings, "
      "by route</title>\n<style>.t{font-size:14px;font-weight:bold}.g{stroke:#d5dbe2;fill:none}"
      ".b{stroke:#5a6675;stroke-dasharray:5 4;fill:none}.l{stroke-width:2;fill:none}</style>\n"
      "<path fill=\"#fff\" d=\"M0 0h" +
      coordinate(width) + 'v' + coordinate(height) + "h-" + coordinate(width) + "z\"/>\n";
  if (curves.empty()) return out + "</svg>\n";
  out += "<text class=\"t\" x=\"20\" y=\"24\">Errors in roundings: " +
         escape(curves.front().surface.substr(0, curves.front().surface.find(':'))) + "</text>\n";
  double x = 20;
  for (const std::string_view route : routes) {
    const auto colour = std::find_if(route_colours.begin(), route_colours.end(),
                                     [&](const auto& r) { return r.first == route; });
    out += "<path class=\"l\" stroke=\"" + std::string(colour->second) + "\" d=\"M" + coordinate(x) +
           " 44h22\"/>" + "<text x=\"" + coordinate(x + 28) + "\" y=\"48\">" + std::string(route) +
           "</text>\n";
    x += 50 + 7.5 * static_cast<double>(route.size());
  }
  out += "<path class=\"b\" d=\"M" + coordinate(x) + " 44h22\"/><text x=\"" + coordinate(x + 28) +
         "\" y=\"48\">bound of double</text>\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    out += panel(panels[i], 50 + static_cast<double>(column) * (panel_width + gap),
                 90 + static_cast<double>(row) * (panel_height + gap));
  }
  return out + "</svg>\n";
}

}  // namespace darboux
