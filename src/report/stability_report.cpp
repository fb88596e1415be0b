#include "stability_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/counted.h"
#include "base/text.h"
#include "csv.h"
#include "finite_or_null.h"

namespace darboux {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(const std::vector<double>& values) {
  Json result = Json::array();
  for (const double x : values) result.push_back(finite_or_null(x));
  return result;
}
std::vector<double> numbers_of(const Json& json, double absent) {
  std::vector<double> result;
  for (const Json& x : json) result.push_back(x.is_null() ? absent : x.get<double>());
  return result;
}
double number_of(const Json& json, double absent) {
  return json.is_null() ? absent : json.get<double>();
}

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double not_stated = std::numeric_limits<double>::quiet_NaN();

// "3.1", "4.5e+09"; "no digits" where none is correct.
std::string roundings(double error) {
  if (!(error < 0x1p53)) return "no digits";
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", error);
  return text;
}

std::string line(std::initializer_list<std::pair<std::string, int>> cells) {
  std::string text;
  for (const auto& [cell, width] : cells) {
    text += cell;
    if (static_cast<int>(cell.size()) < width)
      text.append(static_cast<std::size_t>(width) - cell.size(), ' ');
    text += ' ';
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + '\n';
}

std::string short_surface(const std::string& specification) {
  return specification.substr(0, specification.find(':'));
}

}  // namespace

nlohmann::ordered_json curves_json(const std::vector<StabilityCurve>& curves) {
  Json list = Json::array();
  for (const StabilityCurve& c : curves)
    list.push_back({{"surface", c.surface},
                    {"sweep", c.sweep},
                    {"route", c.route},
                    {"quantity", c.quantity},
                    {"own", c.own},
                    {"x", list_of(c.x)},
                    {"error_u", list_of(c.error_u)},
                    {"condition", list_of(c.condition)},
                    {"bound_u", list_of(c.bound_u)},
                    {"within_bound", c.within_bound},
                    {"worst",
                     {{"x", finite_or_null(c.worst.x)},
                      {"error_u", finite_or_null(c.worst.error_u)},
                      {"bound_u", finite_or_null(c.worst.bound_u)},
                      {"condition", finite_or_null(c.worst.condition)},
                      {"factor", finite_or_null(c.worst.factor)},
                      {"member", c.worst.member},
                      {"u", finite_or_null(c.worst.u)},
                      {"v", finite_or_null(c.worst.v)},
                      {"surface", c.worst.surface}}}});
  return list;
}

StabilityCurve curve_of(const nlohmann::ordered_json& json) {
  StabilityCurve c;
  c.surface = json.at("surface").get<std::string>();
  c.sweep = find_stability_sweep(json.at("sweep").get<std::string>()).name;
  c.route = find_stability_route(json.at("route").get<std::string>()).name;
  const std::string quantity = json.at("quantity").get<std::string>();
  c.quantity = *std::find(stability_quantities.begin(), stability_quantities.end() - 1, quantity);
  c.own = json.at("own").get<bool>();
  c.x = numbers_of(json.at("x"), endless);
  c.error_u = numbers_of(json.at("error_u"), endless);
  c.condition = numbers_of(json.at("condition"), not_stated);
  c.bound_u = numbers_of(json.at("bound_u"), not_stated);
  c.within_bound = json.at("within_bound").get<bool>();
  const Json& w = json.at("worst");
  c.worst = {number_of(w.at("x"), not_stated),       number_of(w.at("error_u"), endless),
             number_of(w.at("bound_u"), not_stated), number_of(w.at("condition"), not_stated),
             number_of(w.at("factor"), endless),     w.at("member").get<std::string>(),
             number_of(w.at("u"), not_stated),       number_of(w.at("v"), not_stated),
             w.at("surface").get<std::string>()};
  return c;
}

std::string curves_csv(const std::vector<StabilityCurve>& curves) {
  std::string text = "surface,sweep,route,quantity,own,x,error_u,bound_u,condition,within_bound\r\n";
  for (const StabilityCurve& c : curves)
    for (std::size_t i = 0; i < c.x.size(); ++i) {
      for (const std::string_view field : {std::string_view(c.surface), c.sweep, c.route, c.quantity})
        text += csv_text(field) + ',';
      text += c.own ? "true" : "false";
      for (const double x : {c.x[i], c.error_u[i], c.bound_u[i], c.condition[i]}) text += ',' + csv_number(x);
      text += c.error_u[i] > c.bound_u[i] ? ",false\r\n" : ",true\r\n";
    }
  return text;
}

bool has_bound(const StabilityCurve& c) {
  return std::any_of(c.bound_u.begin(), c.bound_u.end(), [](double b) { return b > 0; });
}

std::string share_text(double factor) {
  if (factor < 0) return "no bound";
  char text[32];
  std::snprintf(text, sizeof text, factor < 10 ? "%.0f %%" : "%.1g %%", 100 * factor);
  return text;
}

double largest_error(const StabilityCurve& c) {
  const bool stated = has_bound(c);
  double largest = 0;
  for (std::size_t i = 0; i < c.x.size(); ++i)
    if (!stated || c.bound_u[i] > 0) largest = std::fmax(largest, c.error_u[i]);
  return largest;
}

bool leads(const StabilityCurve& c) {
  return c.route == "double" || find_stability_sweep(c.sweep).domain != StabilityDomain::evaluation;
}

std::string stability_summary(const std::vector<StabilityCurve>& curves) {
  const auto count = [&](auto which) { return std::count_if(curves.begin(), curves.end(), which); };
  const auto own = count([&](const StabilityCurve& c) { return c.own && has_bound(c); });
  const auto unbounded = count([&](const StabilityCurve& c) { return c.own && !has_bound(c); });
  const auto broken = count([](const StabilityCurve& c) { return !c.holds(); });
  const auto others = count([](const StabilityCurve& c) { return !c.own; });
  const auto lost = count([](const StabilityCurve& c) { return !c.own && !c.within_bound; });
  std::string text = counted(static_cast<std::size_t>(own), "curve") + " with a bound, " +
                     (broken == 0 ? "all within it" : std::to_string(broken) + " beyond it");
  if (unbounded > 0) text += "; " + std::to_string(unbounded) + " without one";
  if (others > 0)
    text += "; the naive formulas leave Darboux's bound in " + std::to_string(lost) + " of " +
            std::to_string(others);
  return text;
}

std::string stability_text(const std::vector<StabilityCurve>& curves) {
  std::string text =
      "Errors in roundings (2^-53 in double), over meshes in half steps of the stored data, of fits in "
      "standard\n"
      "errors. largest: of the sweep. of its bound, in, at x: where an error comes nearest to its bound, as\n"
      "a share of it. naive: the largest error of textbook formulas; \"no digits\": no correct digit is "
      "left."
      "\n\n" +
      line({{"surface", 22},
            {"sweep", 20},
            {"largest", 11},
            {"of its bound", 13},
            {"in", 24},
            {"at x =", 10},
            {"naive", 0}});
  for (auto begin = curves.begin(); begin != curves.end();) {
    const auto end = std::find_if(begin, curves.end(), [&](const StabilityCurve& c) {
      return c.surface != begin->surface || c.sweep != begin->sweep;
    });
    const StabilityCurve* worst = nullptr;
    double error = 0, naive = -1;
    for (auto c = begin; c != end; ++c) {
      if (c->route == "naive") naive = std::fmax(naive, largest_error(*c));
      if (!leads(*c)) continue;
      error = std::fmax(error, largest_error(*c));
      if (!worst || c->worst.factor > worst->worst.factor) worst = &*c;
    }
    if (worst) {
      const std::string share = share_text(has_bound(*worst) ? worst->worst.factor : -1);
      char x[32];
      std::snprintf(x, sizeof x, "%.2g", worst->worst.x);
      text += line({{short_surface(worst->surface), 22},
                    {std::string(worst->sweep), 20},
                    {roundings(error), 11},
                    {share, 13},
                    {worst->worst.member, 24},
                    {x, 10},
                    {naive < 0 ? "" : roundings(naive), 0}});
    }
    begin = end;
  }
  text += '\n' + stability_summary(curves) + '\n';
  for (const StabilityCurve& c : curves)
    if (!c.holds())
      text += "beyond its bound: " + c.surface + ", " + std::string(c.sweep) + ", " + std::string(c.route) +
              ", " + c.worst.member + ": " + roundings(c.worst.error_u) + " roundings, " +
              rounded(c.worst.factor, 2) + " times the bound, at x = " + shortest(c.worst.x) +
              " (u = " + shortest(c.worst.u) + ", v = " + shortest(c.worst.v) + " of " + c.worst.surface +
              ")\n";
  return text;
}

}  // namespace darboux
