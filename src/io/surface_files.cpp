// Control points, weights and knots of patches and profiles from JSON.
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <darboux/bezier_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/io.h>
#include <darboux/surface_of_revolution.h>

#include "any_surface/compiled_models.h"
#include "base/text.h"
#include "json_cursor.h"

DARBOUX_COMPILED_MODEL(darboux::BezierPatch<>)
DARBOUX_COMPILED_MODEL(darboux::BSplinePatch<>)
DARBOUX_COMPILED_MODEL(darboux::SurfaceOfRevolution<>)

namespace darboux {
namespace {

using io::Json;
using io::JsonCursor;

Json parse(const std::string& path) {
  const std::string text = io::read_file(path);
  const auto refuse = [&](const std::string& got) {
    throw FileError(path, expected_got("a JSON object such as {\"points\": [[0, 0], [1, 1]]}", got));
  };
  if (std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) <= ' '; }))
    refuse("an empty file");
  Json json = io::parse_json(path, text);
  if (!json.is_object()) refuse(std::string("a JSON ") + json.type_name());
  return json;
}

void refuse_other_keys(const JsonCursor& document, const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& key : known) list += (list.empty() ? "" : ", ") + key;
  for (const auto& [key, value] : document.json().items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      document.fail("keys among " + list, io::in_quotes(key));
}

double positive(const JsonCursor& place) {
  const double x = place.number();
  if (!(x > 0)) place.fail("a positive number");
  return x;
}

// The size of an array, which must be from `least` to `most`.
std::size_t count(const JsonCursor& place, std::size_t least, std::size_t most, const std::string& of) {
  const std::size_t n = place.size();
  if (n < least || n > most)
    place.fail((least == most ? std::to_string(least)
                : n < least   ? "at least " + std::to_string(least)
                              : "at most " + std::to_string(most)) +
                   " " + of,
               std::to_string(n));
  return n;
}

std::vector<double> coordinates(const JsonCursor& place, std::size_t n, const std::string& as) {
  if (!place.json().is_array()) place.fail("a point " + as);
  if (place.size() != n) place.fail(std::to_string(n) + " coordinates, " + as, std::to_string(place.size()));
  std::vector<double> result;
  for (std::size_t k = 0; k < n; ++k) result.push_back(place.at(k).number());
  return result;
}

constexpr std::size_t most_points = 10000000;

struct Net {
  std::size_t rows, columns;
  std::vector<Vec3<double>> points;
  std::vector<double> weights;
};

Net read_net(const JsonCursor& document, std::size_t least_rows, std::size_t least_columns,
             std::size_t most) {
  const JsonCursor points = document.at("points");
  Net net{count(points, least_rows, most, "rows"), 0, {}, {}};
  net.columns = count(points.at(std::size_t{0}), least_columns, most, "points");
  for (std::size_t i = 0; i < net.rows; ++i) {
    const JsonCursor row = points.at(i);
    if (row.size() != net.columns)
      row.fail(std::to_string(net.columns) + " points, as many as in the first row",
               std::to_string(row.size()));
    for (std::size_t k = 0; k < net.columns; ++k) {
      const auto p = coordinates(row.at(k), 3, "[x, y, z]");
      net.points.push_back({p[0], p[1], p[2]});
    }
  }
  if (document.has("weights")) {
    const JsonCursor weights = document.at("weights");
    count(weights, net.rows, net.rows, "rows");
    for (std::size_t i = 0; i < net.rows; ++i) {
      count(weights.at(i), net.columns, net.columns, "weights");
      for (std::size_t k = 0; k < net.columns; ++k) net.weights.push_back(positive(weights.at(i).at(k)));
    }
  }
  return net;
}

int read_degree(const JsonCursor& place) {
  return static_cast<int>(place.integer(1, max_spline_degree));
}

// The knots under a key for this number of control points; clamped ones by default.
std::vector<double> read_knots(const JsonCursor& document, const char* key, int degree, std::size_t points) {
  if (!document.has(key)) return clamped_knots(degree, static_cast<int>(points));
  const JsonCursor place = document.at(key);
  const std::size_t n = points + static_cast<std::size_t>(degree) + 1;
  if (place.size() != n)
    place.fail(std::to_string(n) + " knots, for " + std::to_string(points) + " points and degree " +
                   std::to_string(degree),
               std::to_string(place.size()));
  std::vector<double> knots;
  for (std::size_t i = 0; i < n; ++i) {
    knots.push_back(place.at(i).number());
    if (i > 0 && knots[i] < knots[i - 1])
      place.at(i).fail("knots that do not decrease",
                       place.at(i).shown() + " after " + place.at(i - 1).shown());
  }
  if (const std::string why = KnotVector<double>::refusal(degree, knots); !why.empty()) place.refuse(why);
  return knots;
}

AnySurface read_bezier_patch(const JsonCursor& document) {
  refuse_other_keys(document, {"points", "weights", "degree_u", "degree_v"});
  Net net = read_net(document, 2, 2, max_spline_degree + 1);
  const auto agree = [&](const char* key, std::size_t degree, const char* what) {
    if (document.has(key) && document.at(key).integer(1, max_spline_degree) != degree)
      document.at(key).fail(std::to_string(degree) + ", one less than there are " + what);
  };
  agree("degree_u", net.rows - 1, "rows of points");
  agree("degree_v", net.columns - 1, "points in a row");
  return BezierPatch<double>(static_cast<int>(net.rows) - 1, static_cast<int>(net.columns) - 1,
                             std::move(net.points), std::move(net.weights));
}

AnySurface read_bspline_patch(const JsonCursor& document) {
  refuse_other_keys(document, {"points", "weights", "degree_u", "degree_v", "knots_u", "knots_v"});
  const int p = read_degree(document.at("degree_u")), q = read_degree(document.at("degree_v"));
  Net net = read_net(document, static_cast<std::size_t>(p) + 1, static_cast<std::size_t>(q) + 1, most_points);
  std::vector<double> knots_u = read_knots(document, "knots_u", p, net.rows),
                      knots_v = read_knots(document, "knots_v", q, net.columns);
  return BSplinePatch<double>(p, q, std::move(knots_u), std::move(knots_v), std::move(net.points),
                              std::move(net.weights));
}

AnySurface read_surface_of_revolution(const JsonCursor& document) {
  refuse_other_keys(document, {"points", "weights", "degree", "knots"});
  const int degree = document.has("degree") ? read_degree(document.at("degree")) : 1;
  const JsonCursor points = document.at("points");
  const std::size_t n = count(points, static_cast<std::size_t>(degree) + 1, most_points, "points");
  std::vector<Vec3<double>> profile;
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = coordinates(points.at(i), 2, "[rho, z]");
    profile.push_back({p[0], 0, p[1]});
  }
  std::vector<double> weights;
  if (document.has("weights")) {
    const JsonCursor place = document.at("weights");
    count(place, n, n, "weights");
    for (std::size_t i = 0; i < n; ++i) weights.push_back(positive(place.at(i)));
  }
  std::vector<double> knots = read_knots(document, "knots", degree, n);
  return SurfaceOfRevolution<>{
      BSplineCurve<double>(degree, std::move(knots), std::move(profile), std::move(weights))};
}

struct Kind {
  std::string_view name;
  AnySurface (*read)(const JsonCursor&);
};
constexpr std::array kinds{Kind{"bezier-patch", read_bezier_patch}, Kind{"bspline-patch", read_bspline_patch},
                           Kind{"surface-of-revolution", read_surface_of_revolution}};

}  // namespace

const std::vector<std::string_view>& surface_file_kinds() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for (const Kind& kind : kinds) list.push_back(kind.name);
    return list;
  }();
  return names;
}

AnySurface read_surface_file(std::string_view kind, const std::string& path) {
  for (const Kind& k : kinds) {
    if (k.name != kind) continue;
    const Json json = parse(path);
    try {
      return k.read(JsonCursor(path, json, "the document")).from_file(path);
    } catch (const ParameterError& error) {  // whatever the readers above let through
      throw FileError(path, error.what());
    }
  }
  std::string known;
  for (const std::string_view name : surface_file_kinds())
    known += (known.empty() ? "" : ", ") + std::string(name);
  throw ParameterError(std::string(kind),
                       expected_got("a kind that is read from files: one of " + known, std::string(kind)));
}

}  // namespace darboux
