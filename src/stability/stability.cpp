#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <darboux/error.h>
#include <darboux/stability.h>

#include "base/text.h"
#include "laws/exact.h"
#include "measure.h"
#include "sweeps.h"

namespace darboux {
namespace {

using laws::Comparison;
using laws::Exact;
using sweeps::Case;
using sweeps::Found;
using sweeps::Measurement;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = laws::infinity;

// ---- one point, one route ---------------------------------------------------------------------------------

constexpr std::array<std::size_t, 6> quantity_of_partial{0, 1, 1, 2, 2, 2};
constexpr std::array<std::size_t, 9> quantity_of_form{4, 4, 4, 4, 5, 5, 5, 5, 5};
constexpr std::array<std::string_view, 3> frame_members{"tangent", "bitangent", "normal"};
constexpr std::size_t frame_quantity = 3;

// The surface rounded to float.
std::optional<AnySurface> rounded_to_float(const AnySurface& surface) {
  std::vector<double> values;
  for (const ParameterValue& p : surface.parameters()) {
    const volatile float x = static_cast<float>(p.value);
    if (!std::isfinite(x) || (x == 0 && p.value != 0)) return std::nullopt;
    values.push_back(x);
  }
  if (values.empty()) return surface;
  try {
    return surface.with(values);
  } catch (const ParameterError&) {
    return std::nullopt;
  }
}

// The coordinate without whole periods, exactly: the surface is the same there, and so are its bounds.
double within_a_period(double x, Coordinate kind) {
  if (kind == Coordinate::turn && std::fabs(x) > 1) return x - std::trunc(x);
  if (kind == Coordinate::twisted_turn && std::fabs(x) > 2) return x - 2 * std::trunc(x / 2);
  return x;
}

// The largest magnitude of each partial over the surface, or of the position if the partial vanishes; and of
// d3pdu3, d3pdv3.
struct Scales {
  std::array<double, 6> of_partial{};
  std::array<double, 2> third{};
};
Scales scale_of(const Case& c) {
  // Towards the ends too, where splines whose weights are far apart change fast.
  constexpr std::array near{0.5, 0.25, 0.1, 0.01, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13};
  Scales result;
  const auto note = [](double& largest, double size) {
    if (std::isfinite(size)) largest = std::fmax(largest, size);
  };
  const auto look = [&](double u, double v) {
    const Vec2<double> at = c.coordinates({u, v});
    const Jet2<DualUV> j = c.surface.jet(DualUV::variable(at.x, 0), DualUV::variable(at.y, 1));
    for (int k = 0; k < 6; ++k)
      note(result.of_partial[static_cast<std::size_t>(k)], norm(laws::value(laws::partial(j, k))));
    note(result.third[0], norm(laws::derivative(j.d2pdu2, 0)));
    note(result.third[1], norm(laws::derivative(j.d2pdv2, 1)));
  };
  double other = 0.3;
  for (const double x : near)
    for (const double end : {x, 1 - x}) {
      other = std::fmod(other + 0.6180339887498949, 1);
      look(other, end);
      look(end, other);
    }
  for (double& s : result.of_partial)
    if (s == 0) s = result.of_partial[0];
  return result;
}

// Lengths for steps: the period of a sine with these first, second and third derivatives, limited by the
// nearest break and by the size of the domain.
std::array<double, 2> lengths(const Case& c, const std::array<double, 6>& scale,
                              const std::array<double, 2>& third) {
  std::array<double, 2> result{};
  for (const int along : {0, 1}) {
    const std::size_t first = along == 0 ? 1 : 2, second = along == 0 ? 3 : 5;
    double& length = result[static_cast<std::size_t>(along)];
    double turn = infinity;
    for (const double quotient :
         {scale[first] / scale[second], scale[second] / third[static_cast<std::size_t>(along)]})
      if (quotient > 0) turn = std::fmin(turn, 2 * std::numbers::pi * quotient);
    length = std::isfinite(turn) && turn > 0 ? std::exp2(std::floor(std::log2(turn) + 0.5)) : 1;
    // No route's step is longer than an eighth of it. The derivatives of a nearly straight line would permit
    // steps beyond the domain, so its size limits them.
    const Vec2<double> corner = c.coordinates({0, 0});
    const auto to = [&](const Vec2<double>& other) {
      const Vec2<double> at = c.coordinates(other);
      return std::fabs(along == 0 ? at.x - corner.x : at.y - corner.y);
    };
    const double domain = to({1, 0}) + to({0, 1});
    length = std::fmin(length, 7.5 * std::fmin(domain, c.to_a_break(static_cast<std::size_t>(along))));
  }
  return result;
}

// Whether the magnitudes of all parameters are within the range for which bounds are stated.
bool proven(const AnySurface& surface) {
  const auto parameters = surface.parameters();
  return std::all_of(parameters.begin(), parameters.end(), [](const ParameterValue& p) {
    const double size = std::fabs(p.value);
    return size == 0 || (p.proven.smallest <= size && size <= p.proven.largest);
  });
}

// All data of a point that do not depend on the route.
struct Question {
  Case c;
  Exact exact;
  laws::PartialScales scales;
  std::array<double, 2> length;
  Frame<double> own;  // the surface's frame
  bool stated;        // bounds are

  explicit Question(const Case& given)
      : c(given),
        exact(c.surface, within_a_period(c.u, c.surface.info().u), within_a_period(c.v, c.surface.info().v)),
        own(c.surface.frame(c.u, c.v)),
        stated(proven(c.surface)) {
    const Scales scale = scale_of(c);
    scales = laws::partial_scales(exact, scale.of_partial);
    for (double& condition : scales.condition) condition += c.data_condition;
    length = lengths(c, scale.of_partial, scale.third);
  }
};

class Comparer {
 public:
  Comparer(const Question& question, const StabilityRoute& route, const StabilityAnswer& answer)
      : q_(question), route_(route), answer_(answer) {
    if (route.roundoff > 0x1p-53)
      compare<float>();
    else
      compare<double>();
  }
  std::vector<Found> found;

 private:
  // Derivatives of the position that are not finite report their own failure.
  bool silent(const Vec3<double>& a) const {
    return (route_.bound == StabilityBound::dual || route_.bound == StabilityBound::estimate) &&
           !(std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z));
  }
  void add(std::size_t quantity, std::string_view member, Comparison c) {
    if (std::isnan(c.error)) c.error = infinity;
    if (!q_.stated && route_.bound != StabilityBound::estimate) c.bound = nan;
    found.push_back({quantity, member, c});
  }

  // The bound of a partial by this route; `stated` if the route has the stated bound.
  double partial_bound(std::size_t k, double stated) const {
    const double rounding = 1 + q_.scales.condition[k];
    switch (route_.bound) {
      case StabilityBound::dual:
        return 16 * route_.roundoff * rounding;
      case StabilityBound::estimate:
        return 4 * answer_.estimate[k] / q_.scales.scale[k] + 8 * route_.roundoff * rounding;
      case StabilityBound::stated:
      case StabilityBound::none:
        break;
    }
    return stated;
  }
  // The bound of a frame computed from dpdu and dpdv.
  double frame_bound(double stated) const {
    if (route_.bound != StabilityBound::dual && route_.bound != StabilityBound::estimate) return stated;
    const Jet2<Multiprecision>& j = q_.exact.jet;
    const double sine = norm(laws::rounded(cross(unit(j.dpdu), unit(j.dpdv))));
    double sum = 0;
    for (const std::size_t k : {1u, 2u})
      sum += partial_bound(k, 0) * q_.scales.scale[k] / norm(laws::rounded(k == 1 ? j.dpdu : j.dpdv));
    return sum / sine + 8 * route_.roundoff;
  }

  template <class S>
  void compare() {
    const auto narrow = [](const Vec3<double>& a) {
      return Vec3<S>{static_cast<S>(a.x), static_cast<S>(a.y), static_cast<S>(a.z)};
    };
    Sample<S> sample{};
    if (answer_.frame)
      sample.frame = {narrow(answer_.frame->t), narrow(answer_.frame->b), narrow(answer_.frame->n),
                      static_cast<S>(answer_.frame->handedness), answer_.frame->status};
    const std::array<Vec3<S>*, 6> all{&sample.jet.position, &sample.jet.dpdu,   &sample.jet.dpdv,
                                      &sample.jet.d2pdu2,   &sample.jet.d2pduv, &sample.jet.d2pdv2};
    for (std::size_t k = 0; k < 6; ++k)
      if (answer_.partials[k] && !silent(*answer_.partials[k])) {
        *all[k] = narrow(*answer_.partials[k]);
        if (auto c = laws::compare_partial(q_.exact, q_.scales, sample, static_cast<int>(k))) {
          c->bound = partial_bound(k, c->bound);
          add(quantity_of_partial[k], laws::names[k], *c);
        }
      }
    // Where Darboux has no frame, none is compared.
    if (answer_.frame && !has(q_.own.status, Status::no_frame)) {
      if (route_.bound != StabilityBound::stated) sample.frame.status = Status::regular;
      if (const auto of_frame =
              laws::compare_frame(q_.c.surface, q_.exact, q_.scales, sample, q_.c.closed_frame))
        for (std::size_t k = 0; k < 3; ++k) {
          Comparison c = (*of_frame)[k];
          // A limit frame that is regular in 40 digits, where rounding leaves nothing of the partials.
          if (const double m = laws::magnified(q_.exact, q_.scales);
              has(sample.frame.status, Status::limit_frame) && std::isfinite(m))
            c.bound = std::fmax(c.bound, 8 * route_.roundoff * m);
          c.bound = frame_bound(c.bound);
          add(frame_quantity, frame_members[k], c);
        }
    }
    // Only at regular points, as in `check`.
    const bool forms = std::any_of(answer_.forms.begin(), answer_.forms.end(),
                                   [](const std::vector<double>& f) { return !f.empty(); });
    if (!forms || q_.own.status != Status::regular) return;
    const auto of_forms = laws::compare_forms(q_.c.surface, q_.exact, q_.own.n, answer_.forms,
                                              q_.c.closed_frame ? nullptr : &q_.scales);
    for (std::size_t k = 0; k < of_forms.size(); ++k)
      if (of_forms[k] && !answer_.forms[k].empty())
        add(quantity_of_form[k], laws::form_names[k], *of_forms[k]);
  }

  const Question& q_;
  const StabilityRoute& route_;
  const StabilityAnswer& answer_;
};

// ---- curves -----------------------------------------------------------------------------------------------

double factor(const Comparison& c) {
  return c.bound > 0 ? c.error / c.bound : 0;
}

// By the share of the bound or, without a bound, by the error.
bool is_worse(const Comparison& a, const Comparison& b) {
  return factor(a) != factor(b) ? factor(a) > factor(b) : a.error > b.error;
}

// Keeps, for one x, route and quantity, the point where error / bound is largest.
void extend(StabilityCurve& curve, const Measurement& m) {
  const Comparison& c = m.found.comparison;
  curve.x.push_back(m.x);
  curve.error_u.push_back(c.error / m.unit);
  curve.bound_u.push_back(c.bound / m.unit);
  curve.condition.push_back(c.condition);
  if (c.error > c.bound) curve.within_bound = false;
  if (curve.x.size() == 1 || factor(c) > curve.worst.factor ||
      (factor(c) == curve.worst.factor && c.error / m.unit > curve.worst.error_u))
    curve.worst = {
        m.x, c.error / m.unit, c.bound / m.unit, c.condition, factor(c), std::string(m.found.member), m.u,
        m.v, m.surface};
}

// The cases at x, for the surface rounded to `roundoff`.
std::vector<Question> questions(const StabilityOptions& options, const StabilitySweep& sweep,
                                const AnySurface& surface, double x, std::size_t i, bool in_float) {
  std::vector<Question> result;
  std::optional<AnySurface> held = in_float ? rounded_to_float(surface) : surface;
  if (in_float) {
    // Sizes whose squares and quotients are within the range of float.
    const bool size = sweep.from == 1 / sweep.to || sweep.to > 1;
    if (size && !(1e-18 < x && x < 1e18)) return {};
    x = static_cast<float>(x);
  }
  if (!held || x == 0) return {};
  for (int k = 0; k < options.samples; ++k) {
    sweeps::Random random(options.seed * 1000003 + i * 131 + static_cast<std::uint64_t>(k));
    for (Case& c : sweeps::cases(sweep.name, *held, x, random)) {
      if (in_float) {
        const auto narrow = rounded_to_float(c.surface);
        if (!narrow) continue;
        c.surface = *narrow;
        const volatile float u = static_cast<float>(c.u), v = static_cast<float>(c.v);
        c.u = u;
        c.v = v;
      }
      // A distance that the coordinate cannot represent is a different case.
      if (c.distance) {
        const double away = std::fabs((c.distance->along == 0 ? c.u : c.v) - c.distance->centre);
        if (!(std::fabs(away - x) < 0.01 * x)) continue;
      }
      if (!std::isfinite(c.u) || !std::isfinite(c.v) || !c.within(in_float ? 0x1p-24 : 0x1p-53)) continue;
      Question q(c);
      if (laws::is_number(q.exact.jet)) result.push_back(std::move(q));
    }
  }
  return result;
}

std::vector<Measurement> measure_evaluation(const StabilityOptions& options, const StabilitySweep& sweep,
                                            const AnySurface& surface) {
  std::vector<Measurement> result;
  const std::vector<double> xs = sweeps::values_of_x(options, sweep);
  for (std::size_t i = 0; i < xs.size(); ++i) {
    const double x = xs[i];
    std::array<std::optional<std::vector<Question>>, 2> asked;  // in double, in float
    for (std::size_t r = 0; r < options.routes.size(); ++r) {
      const StabilityRoute& route = *options.routes[r];
      if (route.domain != StabilityDomain::evaluation) continue;
      const bool in_float = route.roundoff > 0x1p-53;
      auto& list = asked[in_float ? 1 : 0];
      if (!list) list = questions(options, sweep, surface, x, i, in_float);
      for (const Question& q : *list) {
        const StabilityAnswer answer = route.answer({q.c.surface, q.c.u, q.c.v, q.length});
        for (const Found& f : Comparer(q, route, answer).found)
          result.push_back({r, x, f, route.roundoff, q.c.u, q.c.v, q.c.description});
      }
    }
  }
  return result;
}

}  // namespace

std::vector<StabilityJob> stability_jobs(const StabilityOptions& options) {
  if (options.points < 2)
    throw ParameterError("points", expected_got("at least 2", std::to_string(options.points)));
  if (options.samples < 1)
    throw ParameterError("samples", expected_got("at least 1", std::to_string(options.samples)));
  std::vector<StabilityJob> jobs;
  for (std::size_t s = 0; s < options.surfaces.size(); ++s)
    for (std::size_t k = 0; k < options.sweeps.size(); ++k) {
      const StabilitySweep& sweep = *options.sweeps[k];
      const AnySurface& surface = options.surfaces[s];
      const bool asked = std::any_of(options.routes.begin(), options.routes.end(),
                                     [&](const StabilityRoute* r) { return r->domain == sweep.domain; });
      sweeps::Random random(1);
      if (asked && (sweep.domain == StabilityDomain::meshes ||
                    (sweep.domain == StabilityDomain::fits && sweeps::is_fitted(surface)) ||
                    !sweeps::cases(sweep.name, surface, sweep.from, random).empty()))
        jobs.push_back({s, k});
    }
  return jobs;
}

std::vector<StabilityCurve> run_stability_job(const StabilityOptions& options, const StabilityJob& job) {
  const AnySurface& surface = options.surfaces[job.surface];
  const StabilitySweep& sweep = *options.sweeps[job.sweep];
  const std::vector<Measurement> all =
      sweep.domain == StabilityDomain::meshes ? sweeps::measure_meshes(options, sweep, surface)
      : sweep.domain == StabilityDomain::fits ? sweeps::measure_fits(options, sweep, surface)
                                              : measure_evaluation(options, sweep, surface);
  const auto harder = [&](double a, double b) { return sweep.from < sweep.to ? a < b : a > b; };
  std::vector<StabilityCurve> curves;
  for (std::size_t r = 0; r < options.routes.size(); ++r)
    for (std::size_t q = 0; q < stability_quantities.size(); ++q) {
      std::map<double, const Measurement*, decltype(harder)> worst(harder);
      for (const Measurement& m : all)
        if (m.route == r && m.found.quantity == q) {
          const auto [at, added] = worst.try_emplace(m.x, &m);
          if (!added && is_worse(m.found.comparison, at->second->found.comparison)) at->second = &m;
        }
      if (worst.empty()) continue;
      StabilityCurve& curve = curves.emplace_back();
      curve.surface = surface.specification();
      curve.sweep = sweep.name;
      curve.route = options.routes[r]->name;
      curve.quantity = stability_quantities[q];
      curve.own = options.routes[r]->own();
      for (const auto& [x, m] : worst) extend(curve, *m);
    }
  return curves;
}

std::vector<StabilityCurve> stability(const StabilityOptions& options,
                                      const std::function<void(double)>& progress) {
  const std::vector<StabilityJob> jobs = stability_jobs(options);
  std::vector<StabilityCurve> result;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    for (StabilityCurve& curve : run_stability_job(options, jobs[i])) result.push_back(std::move(curve));
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(jobs.size()));
  }
  return result;
}

}  // namespace darboux
