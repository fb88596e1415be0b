#include "sweeps.h"

#include <algorithm>
#include <cmath>

#include <darboux/bezier_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/error.h>
#include <darboux/placed.h>
#include <darboux/reparametrised.h>

#include "any_surface/compiled_models.h"
#include "base/text.h"
#include "held.h"
#include "measure.h"

DARBOUX_COMPILED_MODEL(darboux::BezierPatch<>)
DARBOUX_COMPILED_MODEL(darboux::BSplinePatch<>)

namespace darboux {
namespace sweeps {
namespace {

double uniform(Random& random, double from = 0.05, double to = 0.95) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

bool periodic(Coordinate kind) {
  return kind == Coordinate::turn || kind == Coordinate::twisted_turn;
}
Coordinate kind_of(const AnySurface& surface, int along) {
  return along == 0 ? surface.info().u : surface.info().v;
}

// The contribution of a patch's control points to the condition, as its header states it.
double condition_of_data(const AnySurface& surface) {
  if (const auto* p = surface.get<BezierPatch<>>()) return 2 * (p->degree_u() + p->degree_v());
  if (const auto* p = surface.get<BSplinePatch<>>())
    return 2 * (p->knots_u().degree() + p->knots_v().degree());
  return 0;
}

Case at(const AnySurface& surface, Random& random) {
  const double u = uniform(random), v = uniform(random);
  return {.surface = surface,
          .u = u,
          .v = v,
          .description = surface.specification(),
          .closed_frame = surface.has_closed_frame(),
          .data_condition = condition_of_data(surface),
          .breaks = {surface.breaks(0), surface.breaks(1)}};
}

// ---- distances --------------------------------------------------------------------------------------------

using Places = std::vector<Case::Distance>;

// Where the chart is singular on a whole line u = c or v = c, c an end or a quarter.
Places poles(const AnySurface& surface) {
  Places result;
  for (const int along : {0, 1})
    for (const double c : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const auto singular = [&](double other) {
        const Frame<double> f = along == 0 ? surface.frame(c, other) : surface.frame(other, c);
        return has(f.status, Status::dpdu_zero | Status::dpdv_zero | Status::parallel);
      };
      if (singular(0.3) && singular(0.62)) result.push_back({along, c});
    }
  return result;
}
bool listed(const Places& places, int along, double centre) {
  return std::any_of(places.begin(), places.end(),
                     [&](const Case::Distance& p) { return p.along == along && p.centre == centre; });
}
Places seams(const AnySurface& surface) {
  Places result;
  const Places singular = poles(surface);
  for (const int along : {0, 1})
    if (periodic(kind_of(surface, along)))
      for (const double c : {0.0, 1.0})
        if (!listed(singular, along, c)) result.push_back({along, c});
  return result;
}
Places edges(const AnySurface& surface) {
  Places result;
  const Places singular = poles(surface);
  for (const int along : {0, 1})
    if (!periodic(kind_of(surface, along)))
      for (const double c : {0.0, 1.0})
        if (!listed(singular, along, c)) result.push_back({along, c});
  return result;
}
Places knots(const AnySurface& surface) {
  Places result;
  const Places singular = poles(surface);
  for (const int along : {0, 1})
    for (const double c : surface.breaks(along))
      if (c > 0 && !listed(singular, along, c)) result.push_back({along, c});
  return result;
}

std::vector<Case> beside(const AnySurface& surface, const Places& places, double x, Random& random) {
  std::vector<Case> result;
  for (const Case::Distance& place : places)
    for (const double side : {1.0, -1.0}) {
      const double coordinate = place.centre + side * x;
      if (!periodic(kind_of(surface, place.along)) && (coordinate < 0 || coordinate > 1)) continue;
      Case c = at(surface, random);
      (place.along == 0 ? c.u : c.v) = coordinate;
      c.distance = place;
      result.push_back(c);
    }
  return result;
}

// ---- sizes ------------------------------------------------------------------------------------------------

// Whether a parameter is a size: its bounds are proven over magnitudes that counts and exponents do not have.
bool is_size(const ParameterValue& p) {
  return p.proven.smallest <= 1e-30 && p.proven.largest >= 1e30;
}
std::size_t sizes(const AnySurface& surface) {
  const auto parameters = surface.parameters();
  return static_cast<std::size_t>(std::count_if(parameters.begin(), parameters.end(), is_size));
}
// The first `count` sizes times x; none if the surface refuses them.
std::vector<Case> resized(const AnySurface& surface, std::size_t count, double x, Random& random) {
  std::vector<double> values;
  for (const ParameterValue& p : surface.parameters()) {
    values.push_back(p.value);
    if (is_size(p) && count > 0) {
      values.back() *= x;
      --count;
    }
  }
  try {
    return {at(surface.with(values), random)};
  } catch (const ParameterError&) {
    return {};
  }
}

template <template <class, class> class Adaptor, class... Arguments>
AnySurface adapted(const AnySurface& surface, const Arguments&... arguments) {
  if (surface.has_closed_frame()) return Adaptor<Held<true>, double>{Held<true>{surface}, arguments...};
  return Adaptor<Held<false>, double>{Held<false>{surface}, arguments...};
}

using Matrix3 = std::array<double, 9>;
Case placed(const AnySurface& surface, const Matrix3& A, const Vec3<double>& translation, Random& random) {
  Case c = at(surface, random);
  c.surface = adapted<Placed>(surface, A, translation);
  const auto number = [](double x) { return shortest(x); };
  if (A != Matrix3{1, 0, 0, 0, 1, 0, 0, 0, 1})
    c.description += " scaled by " + number(A[0]) + ", " + number(A[4]) + ", " + number(A[8]);
  if (!(translation == Vec3<double>{}))
    c.description +=
        " moved by " + number(translation.x) + ", " + number(translation.y) + ", " + number(translation.z);
  return c;
}

std::vector<Case> scaled(const AnySurface& surface, double x, Random& random) {
  if (const std::size_t all = sizes(surface)) return resized(surface, all, x, random);
  return {placed(surface, {x, 0, 0, 0, x, 0, 0, 0, x}, {}, random)};
}
std::vector<Case> stretched(const AnySurface& surface, double x, Random& random) {
  return sizes(surface) >= 2 ? resized(surface, 1, x, random) : std::vector<Case>{};
}
std::vector<Case> moved(const AnySurface& surface, double x, Random& random) {
  return {placed(surface, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, -x, x / 2}, random)};
}

// ---- coordinates ------------------------------------------------------------------------------------------

std::vector<Case> turned(const AnySurface& surface, double x, Random& random) {
  std::vector<Case> result;
  for (const int along : {0, 1})
    if (periodic(kind_of(surface, along)))
      for (const double side : {1.0, -1.0}) {
        Case c = at(surface, random);
        (along == 0 ? c.u : c.v) += side * std::round(x);
        result.push_back(c);
      }
  return result;
}

// (u, v) of the surface = M (u, v) + offset, at the coordinates that give some inner point of it.
std::vector<Case> mapped(const AnySurface& surface, const std::array<double, 4>& M,
                         const std::array<double, 2>& offset, Random& random) {
  Case c = at(surface, random);
  c.surface = adapted<Reparametrised>(surface, M, offset);
  c.mapped = true;
  c.M = M;
  c.offset = offset;
  const Vec2<double> here = c.coordinates({c.u, c.v});
  c.u = here.x;
  c.v = here.y;
  c.description += " over (u, v) = (" + shortest(M[0]) + " u + " + shortest(M[1]) + " v + " +
                   shortest(offset[0]) + ", " + shortest(M[3]) + " v + " + shortest(offset[1]) + ")";
  return {c};
}

template <class Patch>
std::vector<Case> reweighted(const AnySurface& surface, const Patch& patch, auto make, double x,
                             Random& random) {
  std::vector<double> weights = patch.weights();
  if (weights.empty()) weights.assign(patch.control_points().size(), 1.0);
  weights[weights.size() / 2] *= x;
  Case c = at(surface, random);
  c.surface = AnySurface(make(weights));
  c.description += " with weight " + std::to_string(weights.size() / 2) + " times " + shortest(x);
  return {c};
}
std::vector<Case> weighted(const AnySurface& surface, double x, Random& random) {
  if (const auto* p = surface.get<BezierPatch<>>())
    return reweighted(
        surface, *p,
        [&](const auto& weights) {
          return BezierPatch<>(p->degree_u(), p->degree_v(), p->control_points(), weights);
        },
        x, random);
  if (const auto* p = surface.get<BSplinePatch<>>())
    return reweighted(
        surface, *p,
        [&](const auto& weights) {
          return BSplinePatch<>(p->knots_u().degree(), p->knots_v().degree(), p->knots_u().knots(),
                                p->knots_v().knots(), p->control_points(), weights);
        },
        x, random);
  return {};
}

// ---- the list ---------------------------------------------------------------------------------------------

struct Entry {
  StabilitySweep sweep;
  std::vector<Case> (*cases)(const AnySurface&, double x, Random&);
};
constexpr Entry entries[] = {
    {{"pole_distance", "u or v from where a partial vanishes",
      "towards a pole, an apex, or where the surface meets its axis", 0.1, 1e-300},
     [](const AnySurface& s, double x, Random& r) { return beside(s, poles(s), x, r); }},
    {{"seam_distance", "turns from 0 or 1", "towards the seam of a periodic coordinate", 0.1, 1e-300},
     [](const AnySurface& s, double x, Random& r) { return beside(s, seams(s), x, r); }},
    {{"edge_distance", "u or v from 0 or 1", "towards an edge of the domain", 0.1, 1e-300},
     [](const AnySurface& s, double x, Random& r) { return beside(s, edges(s), x, r); }},
    {{"knot_distance", "u or v from a knot", "towards a knot within the domain", 0.1, 1e-15},
     [](const AnySurface& s, double x, Random& r) { return beside(s, knots(s), x, r); }},
    {{"scale", "times the default size", "the whole surface from tiny to huge", 1e-300, 1e300}, scaled},
    {{"aspect", "times the default of one size", "one size against the others", 1e-150, 1e150}, stretched},
    {{"offset", "units from the origin", "far from the origin", 1, 1e16}, moved},
    {{"turns", "whole turns added", "round and round a periodic coordinate", 1, 0x1p50}, turned},
    {{"uv_scale", "u and v of the surface per stored unit", "coordinates stored in another unit", 1e-100,
      1e100},
     [](const AnySurface& s, double x, Random& r) {
       return mapped(s, {x, 0, 0, x}, {0, 0}, r);
     }},
    {{"uv_shift", "added to u and v", "coordinates stored far from the unit square", 1, 0x1p40},
     [](const AnySurface& s, double x, Random& r) {
       return mapped(s, {1, 0, 0, 1}, {-x, -x}, r);
     }},
    {{"condition", "shear of the chart, about 1/sine of the angle between dpdu and dpdv",
      "coordinate lines that become parallel", 1, 1e12},
     [](const AnySurface& s, double x, Random& r) {
       return mapped(s, {1, x, 0, 1}, {0, 0}, r);
     }},
    {{"weights", "times one weight", "weights of rational splines far apart", 1e-12, 1e12}, weighted},
    {{"float_offset", "units from the origin", "meshes far from the origin, positions in float32", 1, 1e7,
      StabilityDomain::meshes},
     nullptr},
    {{"quantisation", "step of positions over the size of the box",
      "positions in steps: float32 is 2^-24, int16 2^-16, float16 2^-11, int8 2^-8", 0x1p-24, 0x1p-6,
      StabilityDomain::meshes},
     nullptr},
    {{"uv_quantisation", "step of u and v", "uvs in steps", 0x1p-24, 0x1p-7, StabilityDomain::meshes},
     nullptr},
    {{"normal_quantisation", "step of each of two numbers in [-1, 1]", "octahedral normals in steps", 0x1p-24,
      0x1p-6, StabilityDomain::meshes},
     nullptr},
    {{"jitter", "share of a cell", "vertices moved within the surface; errors in units of the mesh width",
      1e-3, 0.45, StabilityDomain::meshes},
     nullptr},
    {{"slivers", "height over width of a cell, times the usual",
      "long thin triangles; errors in units of the mesh width", 1, 1e-9, StabilityDomain::meshes},
     nullptr},
    {{"points", "points", "few points, noise 1e-3", 1e4, 30, StabilityDomain::fits}, nullptr},
    {{"outliers", "share", "points that lie anywhere, noise 1e-3", 0.01, 0.5, StabilityDomain::fits},
     nullptr},
    {{"coverage", "share of the chart", "a small patch of the surface, noise 1e-4", 1, 5e-3,
      StabilityDomain::fits},
     nullptr},
    {{"noise", "standard deviation of a coordinate", "noise", 1e-12, 0.1, StabilityDomain::fits}, nullptr},
};
constexpr auto all_sweeps = [] {
  std::array<StabilitySweep, std::size(entries)> result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = entries[i].sweep;
  return result;
}();

}  // namespace

std::vector<double> values_of_x(const StabilityOptions& options, const StabilitySweep& sweep) {
  const int points =
      sweep.domain == StabilityDomain::evaluation ? options.points : std::max(2, options.points / 3);
  std::vector<double> result;
  for (int i = 0; i < points; ++i)
    result.push_back(
        std::exp(std::log(sweep.from) + (std::log(sweep.to) - std::log(sweep.from)) * i / (points - 1)));
  result.front() = sweep.from;
  result.back() = sweep.to;
  return result;
}

std::vector<Case> cases(std::string_view sweep, const AnySurface& surface, double x, Random& random) {
  for (const Entry& entry : entries)
    if (entry.sweep.name == sweep && entry.cases) return entry.cases(surface, x, random);
  return {};
}

}  // namespace sweeps

std::span<const StabilitySweep> stability_sweeps() {
  return sweeps::all_sweeps;
}

const StabilitySweep& find_stability_sweep(std::string_view name) {
  std::vector<std::string> known;
  for (const StabilitySweep& sweep : stability_sweeps()) {
    if (sweep.name == name) return sweep;
    known.emplace_back(sweep.name);
  }
  throw ParameterError("sweep '" + std::string(name) + "'", "unknown, known are " + joined(known));
}

}  // namespace darboux
