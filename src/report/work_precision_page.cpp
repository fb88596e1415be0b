#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "base/text.h"
#include "html.h"
#include "report_page.h"
#include "svg.h"
#include "work_precision_report.h"

namespace darboux {

extern const std::string_view work_precision_page_js, work_precision_page_js_sha256;

namespace {

using Json = nlohmann::ordered_json;

// Okabe and Ito's palette, which colour-blind readers can tell apart; no two families have both colour and
// shape in common.
struct FamilyLook {
  std::string_view family;
  const char *colour, *shape;  // as Chart.js names it
};
constexpr std::array<FamilyLook, 13> family_looks{{{"darboux", "#0072b2", "circle"},
                                                   {"naive", "#d55e00", "triangle"},
                                                   {"dual", "#009e73", "rectRot"},
                                                   {"differences", "#cc79a7", "rect"},
                                                   {"ridders", "#8c6d31", "star"},
                                                   {"many-digits", "#7f7f7f", "crossRot"},
                                                   {"mikktspace", "#0072b2", "triangle"},
                                                   {"averages", "#d55e00", "rect"},
                                                   {"face", "#7f7f7f", "circle"},
                                                   {"fragment", "#009e73", "star"},
                                                   {"procrustes", "#cc79a7", "crossRot"},
                                                   {"polynomials", "#8c6d31", "rectRot"},
                                                   {"", "#000000", "cross"}}};
const FamilyLook& look_of(std::string_view family) {
  for (const FamilyLook& look : family_looks)
    if (look.family == family) return look;
  return family_looks.back();
}

bool is_single(const WorkSample& s) {
  return s.method.ends_with("-float");
}

// A picture needs only four digits; null if there is no number, or it is infinite.
Json plotted(double x) {
  return std::isfinite(x) ? Json::parse(rounded(x, 4)) : Json(nullptr);
}

Json work_page_data(const std::vector<WorkSample>& samples, const WorkAxes& axes) {
  Json groups = Json::array(), looks = Json::object();
  for (const WorkGroup& group : work_groups(samples)) {
    Json list = Json::array();
    for (const WorkSample* s : group.samples) {
      if (!s->failure.empty()) continue;
      Json values = Json::array();
      for (const double x : s->metric) values.push_back(plotted(x));
      list.push_back({{"name", work_method_name(*s)},
                      {"family", s->family},
                      {"single", is_single(*s)},
                      {"low", plotted(s->time_low)},
                      {"high", plotted(s->time_high)},
                      {"points", s->points},
                      {"values", values}});
      looks[s->family] = {look_of(s->family).colour, look_of(s->family).shape};
    }
    Json labels = Json::object();
    for (const std::string_view metric : work_metrics)
      labels[std::string(metric)] = work_axis(metric, group.domain);
    groups.push_back({{"title", group.title()},
                      {"x", axes.x_of(group.domain)},
                      {"y", axes.y_of(group.domain)},
                      {"labels", labels},
                      {"samples", list}});
  }
  return {{"metrics", work_metrics}, {"looks", looks}, {"groups", groups}};
}

std::string fronts_table(const std::vector<WorkSample>& samples, const WorkAxes& axes) {
  std::string rows;
  for (const WorkGroup& group : work_groups(samples)) {
    const std::string_view x = axes.x_of(group.domain), y = axes.y_of(group.domain);
    for (const WorkSample* s : group.samples)
      if (s->on_front)
        rows += "<tr><th scope=row>" + escape(group.title()) + "<td>" + escape(work_method_name(*s)) +
                "<td class=n>" + work_value(x, (*s)[x]) + "<td>" + work_axis(x, group.domain) +
                "<td class=n>" + work_value(y, (*s)[y]) + "<td>" + work_axis(y, group.domain) + "</tr>\n";
  }
  return "<p class=needs-script hidden><input type=search placeholder=Find aria-label=Find></p>\n<div "
         "class=scroll><table class=adopt data-name=fronts>\n<thead><tr><th scope=col>what<th "
         "scope=col>method"
         "<th scope=col class=n>across<th scope=col>in<th scope=col class=n>upwards<th "
         "scope=col>in</tr></thead>\n"
         "<tbody>\n" +
         rows + "</tbody>\n</table></div>\n";
}

std::string failures_list(const std::vector<WorkSample>& samples) {
  std::string items;
  for (const WorkGroup& group : work_groups(samples))
    for (const WorkSample* s : group.samples)
      if (!s->failure.empty())
        items += "<li>" + escape(work_method_name(*s) + ", " + group.title() + ": " + s->failure) + "</li>\n";
  return items.empty() ? "<p>Nothing.</p>\n" : "<ul>\n" + items + "</ul>\n";
}

}  // namespace

std::string work_page(const std::vector<WorkSample>& samples, const WorkAxes& axes, const Provenance& p) {
  ReportPage page;
  page.title = "Darboux: work against precision";
  page.question = "What does an exact frame cost?";
  page.lead =
      "Every way to a tangent frame: how long it takes, and how wrong it is. Times are medians over rounds "
      "in "
      "which all methods take turns; errors are angles to the same formulas in 40 digits.";
  page.answer = work_summary(samples) + ".";
  page.body =
      R"html(<section class=card id=interactive hidden>
<h2 id=what>Run time against error</h2>
<div class=controls>
<label>What <select id=group></select></label>
<label>Across <select id=x></select></label>
<label>Upwards <select id=y></select></label>
</div>
<fieldset class=legend id=legend aria-label="Families that are drawn"></fieldset>
)html" +
      picture_html("plot",
                   "Down and to the left is better. Dashed: the front, methods that none beats in both. "
                   "Hollow: single precision.") +
      R"html(<p class=needs-script hidden><input type=search id=find placeholder=Find aria-label=Find></p>
<div class=scroll><table id=table></table></div>
</section>
<section class=card>
<h2>Fronts</h2>
<p class=soft>On each surface and mesh the methods that no other beats in both.</p>
)html" +
      fronts_table(samples, axes) + "</section>\n<section class=card>\n<h2>What failed</h2>\n" +
      failures_list(samples) + "</section>\n";
  page.data = work_page_data(samples, axes);
  page.script = work_precision_page_js;
  page.script_sha256 = work_precision_page_js_sha256;
  return report_page(page, p);
}

// ---- the picture ------------------------------------------------------------------------------------------

namespace {

constexpr double work_panel_width = 300, work_panel_height = 210, work_gap = 85;
constexpr std::size_t work_columns = 3, most_panels = 12;
constexpr double least_value = 1e-17;  // smaller values, including 0, are drawn there

// A logarithmic axis from one decade to another.
struct LogAxis {
  int low = 0, high = 1;
  double from, to;
  double at(double x) const { return from + (to - from) * (std::log10(x) - low) / (high - low); }
};
LogAxis axis_over(const std::vector<double>& values, double from, double to) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  LogAxis axis{static_cast<int>(std::floor(std::log10(*least))),
               static_cast<int>(std::ceil(std::log10(*most))), from, to};
  axis.high = std::max(axis.high, axis.low + 1);
  return axis;
}

std::string mark_at(double x, double y, const WorkSample& s) {
  const FamilyLook& look = look_of(s.family);
  const std::string shape = look.shape, start = "<path d=\"M";
  std::string d;
  if (shape == "triangle")
    d = svg::tenths(x) + ' ' + svg::tenths(y - 5) + "l5 9h-10z";
  else if (shape == "rectRot")
    d = svg::tenths(x) + ' ' + svg::tenths(y - 5.5) + "l5.5 5.5l-5.5 5.5l-5.5 -5.5z";
  else if (shape == "rect")
    d = svg::tenths(x - 4) + ' ' + svg::tenths(y - 4) + "h8v8h-8z";
  else if (shape == "circle")
    d = svg::tenths(x - 4.5) + ' ' + svg::tenths(y) + "a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z";
  else
    d = svg::tenths(x - 4) + ' ' + svg::tenths(y - 4) + "l8 8m0 -8l-8 8" +
        (shape == "star" ? "m4 -9v10" : "");
  return start + d + "\" stroke=\"" + look.colour + "\" fill=\"" + (is_single(s) ? "none" : look.colour) +
         "\"/>\n";
}

std::string work_panel(const WorkGroup& group, const WorkAxes& axes, double left, double top) {
  const std::string_view x = axes.x_of(group.domain), y = axes.y_of(group.domain);
  std::vector<const WorkSample*> drawn;
  std::vector<double> xs, ys;
  const auto place_of = [&](const WorkSample& s) { return std::fmax(s[x], least_value); };
  const auto height_of = [&](const WorkSample& s) { return std::fmax(s[y], least_value); };
  for (const WorkSample* s : group.samples)
    if (std::isfinite((*s)[x]) && std::isfinite((*s)[y])) {
      drawn.push_back(s);
      xs.push_back(place_of(*s));
      ys.push_back(height_of(*s));
    }
  std::string out = svg::label(left, top - 10, group.title(), "class=\"t\"");
  if (drawn.empty()) return out;
  const double right = left + work_panel_width, bottom = top + work_panel_height;
  const LogAxis across = axis_over(xs, left, right), up = axis_over(ys, bottom, top);
  for (int d = across.low; d <= across.high; ++d)
    out += svg::line(across.at(std::pow(10, d)), top, across.at(std::pow(10, d)), bottom, "class=\"g\"") +
           svg::label(across.at(std::pow(10, d)), bottom + 16, svg::decade(d), "text-anchor=\"middle\"");
  const int step = std::max(1, (up.high - up.low + 7) / 8);
  for (int d = up.low; d <= up.high; d += step)
    out += svg::line(left, up.at(std::pow(10, d)), right, up.at(std::pow(10, d)), "class=\"g\"") +
           svg::label(left - 5, up.at(std::pow(10, d)) + 4, svg::decade(d), "text-anchor=\"end\"");
  out += svg::label((left + right) / 2, bottom + 32, work_axis(x, group.domain), "text-anchor=\"middle\"") +
         svg::label((left + right) / 2, bottom + 47, "upwards: " + work_axis(y, group.domain),
                    "text-anchor=\"middle\"");
  std::vector<const WorkSample*> front;
  for (const WorkSample* s : drawn)
    if (s->on_front) front.push_back(s);
  std::sort(front.begin(), front.end(),
            [&](const WorkSample* a, const WorkSample* b) { return (*a)[x] < (*b)[x]; });
  std::string path;
  for (const WorkSample* s : front)
    path += (path.empty() ? "M" : "L") + svg::tenths(across.at(place_of(*s))) + ' ' +
            svg::tenths(up.at(height_of(*s)));
  if (front.size() > 1) out += "<path class=\"f\" d=\"" + path + "\"/>\n";
  for (const WorkSample* s : drawn) out += mark_at(across.at(place_of(*s)), up.at(height_of(*s)), *s);
  return out;
}

}  // namespace

std::string work_picture(const std::vector<WorkSample>& samples, const WorkAxes& axes) {
  std::vector<WorkGroup> groups = work_groups(samples);
  const std::size_t all = groups.size();
  if (all > most_panels) groups.resize(most_panels);
  std::vector<const WorkSample*> of_family;
  for (const WorkGroup& group : groups)
    for (const WorkSample* s : group.samples)
      if (std::none_of(of_family.begin(), of_family.end(),
                       [&](const WorkSample* other) { return other->family == s->family; }) &&
          !is_single(*s))
        of_family.push_back(s);
  const std::size_t columns = std::min(work_columns, std::max<std::size_t>(1, groups.size()));
  const std::size_t rows = (groups.size() + columns - 1) / columns;
  const double width = std::max(700.0, static_cast<double>(columns) * (work_panel_width + work_gap) + 30);
  const std::size_t in_line = static_cast<std::size_t>((width - 40) / 130),
                    lines = (of_family.size() + in_line) / in_line;
  const double top = 60 + 22 * static_cast<double>(lines) + 20,
               height = top + static_cast<double>(rows) * (work_panel_height + work_gap) + 10;
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + svg::tenths(width) + "\" height=\"" +
      svg::tenths(height) + "\" viewBox=\"0 0 " + svg::tenths(width) + ' ' + svg::tenths(height) +
      "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#1b2a3a\">\n<title>Work against precision, by "
      "method</title>\n<style>.t{font-size:14px;font-weight:bold}.g{stroke:#e2e7ed;fill:none}"
      ".f{stroke:#5a6675;stroke-dasharray:5 4;fill:none}</style>\n<path fill=\"#fff\" d=\"M0 0h" +
      svg::tenths(width) + 'v' + svg::tenths(height) + "h-" + svg::tenths(width) + "z\"/>\n" +
      svg::label(20, 24, "Work against precision", "class=\"t\"") +
      svg::label(20, 42,
                 "Down and to the left is better; dashed: the front; hollow: single precision" +
                     (all > most_panels ? "; the first " + std::to_string(most_panels) + " of " +
                                              std::to_string(all) + " panels"
                                        : std::string()));
  for (std::size_t k = 0; k < of_family.size(); ++k) {
    const double x = 30 + 130 * static_cast<double>(k % in_line),
                 y = 64 + 22 * static_cast<double>(k / in_line);
    out += mark_at(x, y - 4, *of_family[k]) + svg::label(x + 12, y, of_family[k]->family);
  }
  for (std::size_t i = 0; i < groups.size(); ++i)
    out += work_panel(groups[i], axes, 60 + static_cast<double>(i % columns) * (work_panel_width + work_gap),
                      top + static_cast<double>(i / columns) * (work_panel_height + work_gap));
  return out + "</svg>\n";
}

}  // namespace darboux
