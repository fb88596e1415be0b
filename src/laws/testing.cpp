#include <algorithm>
#include <array>
#include <cmath>

#include <darboux/error.h>
#include <darboux/testing.h>

#include "base/text.h"
#include "law.h"

namespace darboux {
namespace {

using namespace laws;

struct Route {
  std::string_view name;
  void (*run)(const AnySurface&, const laws::Points&, Checks&);
};
constexpr std::array routes{Route{"dual", check_dual},
                            Route{"central2", check_central<2>},
                            Route{"central4", check_central<4>},
                            Route{"central6", check_central<6>},
                            Route{"central8", check_central<8>},
                            Route{"one_sided8", check_one_sided},
                            Route{"ridders", check_ridders},
                            Route{"continuity", check_continuity},
                            Route{"implicit", check_implicit},
                            Route{"second_formula", check_second_formula},
                            Route{"curvature", check_curvature},
                            Route{"gauss", check_gauss},
                            Route{"codazzi", check_codazzi},
                            Route{"gauss_bonnet", check_gauss_bonnet},
                            Route{"periodicity", check_periodicity}};

}  // namespace

const std::vector<std::string_view>& check_routes() {
  static const std::vector<std::string_view> all = [] {
    std::vector<std::string_view> list;
    for (const Route& route : routes) list.push_back(route.name);
    list.insert(list.end(), {"high_precision", "high_precision_float", "high_precision_forms"});
    return list;
  }();
  return all;
}

std::vector<Check> check_surface(const AnySurface& surface, const CheckOptions& options) {
  if (options.points < 1)
    throw ParameterError("points", expected_got("1 or more", std::to_string(options.points)));
  if (options.parameter_sets < 0)
    throw ParameterError("parameter_sets", expected_got("0 or more", std::to_string(options.parameter_sets)));
  for (const std::string& route : options.routes)
    if (std::find(check_routes().begin(), check_routes().end(), route) == check_routes().end()) {
      std::string known;
      for (const std::string_view name : check_routes())
        known += (known.empty() ? "" : ", ") + std::string(name);
      throw ParameterError("route", "'" + route + "' is unknown, known are " + known);
    }
  const auto wanted = [&](std::string_view name) {
    return options.routes.empty() ||
           std::find(options.routes.begin(), options.routes.end(), name) != options.routes.end();
  };
  std::vector<Check> checks;
  const bool any_double =
      std::any_of(routes.begin(), routes.end(), [&](const Route& r) { return wanted(r.name); });
  if (any_double) {
    const laws::Points points(surface, options);
    if (points.not_a_number) {
      Law law(points.name, "dual", "position");
      law.compare(std::nan(""), 0, points.not_a_number->x, points.not_a_number->y);
      checks.push_back(law.result());
    } else if (!points.representable) {
      checks.push_back(Law(points.name, "dual", "position")
                           .result("positions or partials leave the range of double at these parameters"));
    } else {
      for (const Route& route : routes)
        if (wanted(route.name)) route.run(surface, points, checks);
    }
  }
  if (wanted("high_precision")) check_high_precision<double>(surface, options, checks);
  if (wanted("high_precision_float")) check_high_precision<float>(surface, options, checks);
  // Takes some ms per point, so it runs only if named.
  if (!options.routes.empty() && wanted("high_precision_forms"))
    check_high_precision_forms(surface, options, checks);
  return checks;
}

std::string broken_laws(const AnySurface& surface, const CheckOptions& options) {
  std::string text;
  for (const Check& c : check_surface(surface, options))
    if (!c.passed)
      text +=
          std::string(c.surface) + ": " + std::string(c.route) + " of " + std::string(c.quantity) + ": " +
          (c.points == 0 ? c.skipped
                         : expected_got("an error of at most " + shortest(c.bound), shortest(c.max_error)) +
                               " at u = " + shortest(c.worst_u) + ", v = " + shortest(c.worst_v)) +
          "\n";
  return text;
}

}  // namespace darboux