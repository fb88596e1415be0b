// Compares everything with the same formula in 40 digits.
#include <algorithm>
#include <concepts>
#include <random>

#include <darboux/error.h>

#include "exact.h"

namespace darboux::laws {
namespace {

std::vector<double> special_coordinates() {
  std::vector<double> result{0, 1, 1e-300, 1e-150, 1e-20, 1e-9};
  for (const double x : {0.125, 0.25, 1.0 / 3, 0.5, 2.0 / 3, 0.75, 1.0})
    for (const double y : {std::nextafter(x, 0.0), x, std::nextafter(x, 1.0)}) result.push_back(y);
  return result;
}

// Random parameters within the magnitudes for which the surface is proven, and 1/limit and limit: half of the
// time of related sizes.
AnySurface random_parameters(const AnySurface& surface, std::mt19937_64& random, double limit = 1e150) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto log_uniform = [&](double from, double to) {
    return std::exp(std::log(from) + uniform(random) * (std::log(to) - std::log(from)));
  };
  std::vector<ParameterValue> parameters = surface.parameters();
  for (ParameterValue& p : parameters)
    p.proven = {std::fmax(p.proven.smallest, 1 / limit), std::fmin(p.proven.largest, limit)};
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const bool related = random() % 2 == 0;
    std::vector<double> values;
    double smallest = 1 / limit, largest = limit;
    for (const ParameterValue& p : parameters) {
      smallest = std::fmax(smallest, p.proven.smallest);
      largest = std::fmin(largest, p.proven.largest);
    }
    const double size = smallest < largest ? log_uniform(smallest, largest) : 1;
    for (const ParameterValue& p : parameters) {
      double x = related ? std::clamp(size * log_uniform(0.25, 4), p.proven.smallest, p.proven.largest)
                         : log_uniform(p.proven.smallest, p.proven.largest);
      if (random() % 2 == 0 && p.permitted.contains(-x)) x = -x;
      values.push_back(x);
    }
    try {
      return surface.with(values);
    } catch (const ParameterError&) {
      // These values are incompatible: tries others.
    }
  }
  return surface;
}

template <class S>
double deviation_from_orthonormal(const Frame<S>& f) {
  using Long = long double;
  const auto wide = [](const Vec3<S>& a) { return Vec3<Long>{a.x, a.y, a.z}; };
  const std::array<Vec3<Long>, 3> columns{wide(f.t), wide(f.b), wide(f.n)};
  Long worst = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = i; k < 3; ++k)
      worst = std::fmax(worst, std::fabs(dot(columns[i], columns[k]) - (i == k ? 1 : 0)));
  return static_cast<double>(worst);
}

// The laws of one precision: a double or float surface against 40 digits.
template <class S>
class HighPrecision {
 public:
  static constexpr double roundoff = std::numeric_limits<S>::epsilon() / 2;

  explicit HighPrecision(std::string_view name)
      : route_(std::same_as<S, float> ? "high_precision_float" : "high_precision"),
        tangent_(name, route_, "tangent"),
        bitangent_(name, route_, "bitangent"),
        normal_(name, route_, "normal"),
        orthonormality_(name, route_, "orthonormality"),
        status_(name, route_, "status") {
    for (const std::string_view quantity : names) partials_.emplace_back(name, route_, quantity);
  }

  // \param u, v numbers of type S
  // The scale of a partial is its largest magnitude over the first `random_points`, or its own where that is
  // larger.
  void compare(const AnySurface& surface, const std::vector<Vec2<double>>& uvs, std::size_t random_points,
               const std::string& of) {
    struct At {
      Exact exact;
      Sample<S> sample;
    };
    std::array<double, 6> common_scale{};
    std::vector<At> all;
    for (const Vec2<double>& uv : uvs) {
      At at{Exact(surface, uv.x, uv.y), evaluate(surface, uv)};
      if (all.size() < random_points)
        for (int k = 0; k < 6; ++k) {
          const double size = norm(rounded(partial(at.exact.jet, k)));
          if (std::isfinite(size)) common_scale[k] = std::fmax(common_scale[k], size);
        }
      all.push_back(std::move(at));
    }
    for (double& s : common_scale)
      if (s == 0) s = common_scale[0];
    for (const auto& [exact, sample] : all) {
      const auto& [u, v] = exact.uv;
      const PartialScales scales = partial_scales(exact, common_scale);
      for (int k = 0; k < 6; ++k)
        if (const auto c = compare_partial(exact, scales, sample, k))
          partials_[static_cast<std::size_t>(k)].compare(c->error, c->bound, u, v, of);
      compare_status(exact.uv, sample, exact.jet, scales.scale, scales.condition, of);
      if (has(sample.frame.status, Status::no_frame)) continue;
      // For every frame, whether or not the 40-digit reference has one.
      orthonormality_.compare(deviation_from_orthonormal(sample.frame),
                              (surface.has_closed_frame() ? 8 : 16) * roundoff, u, v, of);
      // Next to a singular curve a partial may vanish or be that of the other side, up to rounding, which was
      // compared above; the same then holds for the frame.
      const auto opposes = [](const Vec3<S>& own, const Vec3<Multiprecision>& other) {
        const Vec3<Multiprecision> wide{own.x, own.y, own.z};
        return norm(other) > Multiprecision(0.0) && !(dot(wide, other) > Multiprecision(0.0));
      };
      if (opposes(sample.jet.dpdu, exact.jet.dpdu) || opposes(sample.jet.dpdv, exact.jet.dpdv)) continue;
      if (const auto frame = compare_frame(surface, exact, scales, sample, surface.has_closed_frame()))
        for (const auto& [law, c] :
             {std::pair{&tangent_, (*frame)[0]}, {&bitangent_, (*frame)[1]}, {&normal_, (*frame)[2]}})
          law->compare(c.error, c.bound, u, v, of);
    }
  }

  void results(Checks& checks) const {
    for (const Law& law : partials_) checks.push_back(law.result("it leaves the range of the number type"));
    for (const Law* law : {&tangent_, &bitangent_, &normal_, &orthonormality_})
      checks.push_back(law->result("no point has a frame in the range of the number type"));
    checks.push_back(status_.result("no point in the range of the number type"));
  }

 private:
  static Sample<S> evaluate(const AnySurface& surface, const Vec2<double>& uv) {
    if constexpr (std::same_as<S, float>)
      return surface.sample_in_float(static_cast<float>(uv.x), static_cast<float>(uv.y));
    else
      return surface.sample(uv.x, uv.y);
  }

  // A partial that vanishes in 40 digits must be reported as zero, and partials that are parallel there as
  // parallel; nothing else, unless it is so to within rounding. A limit, or no frame at all, is claimed only
  // where one of these holds to rounding; and where there is no frame its vectors are NaN, nowhere else.
  void compare_status(const Vec2<double>& uv, const Sample<S>& sample, const Jet2<Multiprecision>& exact,
                      const std::array<double, 6>& scale, const std::array<double, 6>& condition,
                      const std::string& of) {
    const Frame<S>& f = sample.frame;
    const auto compare = [&](bool wrong) { status_.compare(wrong ? 1 : 0, 0, uv.x, uv.y, of); };
    const bool none = std::isnan(f.t.x) && std::isnan(f.b.x) && std::isnan(f.n.x);
    compare(none != has(f.status, Status::no_frame | Status::non_finite_input));
    if (has(f.status, Status::overflow | Status::non_finite_input)) {
      // Overflow may be reported only where a square or a quotient of sizes may overflow.
      const double range = std::sqrt(std::numeric_limits<S>::max());
      bool ordinary = true;
      for (int k = 0; k < 6; ++k)
        if (const double size = norm(rounded(partial(exact, k))); size != 0)
          ordinary = ordinary && 1 / range < size && size < range;
      compare(ordinary);
      return;
    }
    const auto vanishes = [](const Vec3<Multiprecision>& a) { return norm(a) == Multiprecision(0.0); };
    // A formula whose own value does not quite vanish (sin(pi v) with a rounded pi) cannot know.
    const auto compare_bit = [&](Status bit, bool holds, bool own, double size, double rounding) {
      compare(has(f.status, bit) ? !holds && size > rounding : holds && own);
    };
    const Vec3<S>&own_u = sample.jet.dpdu, &own_v = sample.jet.dpdv;
    const std::array<double, 2> rounding{16 * roundoff * (1 + condition[1]) * scale[1],
                                         16 * roundoff * (1 + condition[2]) * scale[2]};
    const bool no_u = vanishes(exact.dpdu), no_v = vanishes(exact.dpdv);
    const double du = norm(rounded(exact.dpdu)), dv = norm(rounded(exact.dpdv));
    compare_bit(Status::dpdu_zero, no_u, own_u == Vec3<S>{}, du, rounding[0]);
    compare_bit(Status::dpdv_zero, no_v, own_v == Vec3<S>{}, dv, rounding[1]);
    bool degenerate = !(du > rounding[0] && dv > rounding[1]);
    if (!no_u && !no_v) {
      const Vec3<Multiprecision> area = cross(unit(exact.dpdu), unit(exact.dpdv));
      const double sine = norm(rounded(area)), of_sine = rounding[0] / du + rounding[1] / dv;
      compare_bit(Status::parallel, vanishes(area), accurate_cross(unit(own_u), unit(own_v)) == Vec3<S>{},
                  sine, of_sine);
      degenerate = degenerate || sine <= of_sine;
    }
    compare(has(f.status, Status::limit_frame | Status::no_frame) && !degenerate);
  }

  std::string_view route_;
  std::vector<Law> partials_;
  Law tangent_, bitangent_, normal_, orthonormality_, status_;
};

}  // namespace

void check_high_precision_forms(const AnySurface& surface, const CheckOptions& options, Checks& checks) {
  std::vector<Law> laws;
  for (const std::string_view name : form_names)
    laws.emplace_back(surface.info().name, "high_precision_forms", name);
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int set = 0; set < std::max(1, options.parameter_sets); ++set) {
    // Beyond some decades 40 digits are no reference for cancelling sums.
    const AnySurface chosen = options.parameter_sets == 0 ? surface : random_parameters(surface, random, 1e4);
    for (int i = 0; i < options.points; ++i) {
      const double u = uniform(random), v = uniform(random);
      const Sample<double> sample = chosen.sample(u, v);
      if (sample.frame.status != Status::regular) continue;
      const auto found =
          compare_forms(chosen, Exact(chosen, u, v), sample.frame.n, form_numbers(chosen, sample));
      for (std::size_t q = 0; q < form_names.size(); ++q)
        if (found[q])
          laws[q].compare(found[q]->error, found[q]->bound, u, v,
                          options.parameter_sets == 0 ? std::string() : chosen.specification());
    }
  }
  for (const Law& law : laws) checks.push_back(law.result("it vanishes"));
}

namespace {

// The nearest float. Through memory: g++ 12 at -O2 drops the conversion there and back from a loop over
// pairs.
double as_float(double x) {
  volatile float result = static_cast<float>(x);
  return result;
}

// The same surface with parameters rounded to float.
AnySurface rounded_to_float(const AnySurface& surface) {
  std::vector<double> values;
  for (const ParameterValue& p : surface.parameters()) values.push_back(as_float(p.value));
  return surface.with(values);
}

}  // namespace

template <class S>
void check_high_precision(const AnySurface& surface, const CheckOptions& options, Checks& checks) {
  HighPrecision<S> laws(surface.info().name);
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const std::vector<double> special = special_coordinates();
  for (int set = 0; set < std::max(1, options.parameter_sets); ++set) {
    AnySurface chosen = options.parameter_sets == 0 ? surface : random_parameters(surface, random);
    if constexpr (std::same_as<S, float>) {
      // Sizes whose squares and quotients are within the range of float.
      const auto fits = [](const ParameterValue& p) {
        return p.value == 0 || (std::fabs(p.value) < 1e18 && std::fabs(p.value) > 1e-18);
      };
      const auto parameters = chosen.parameters();
      if (!std::all_of(parameters.begin(), parameters.end(), fits)) continue;
      chosen = rounded_to_float(chosen);
    }
    std::vector<Vec2<double>> uvs;
    for (int i = 0; i < options.points; ++i) uvs.push_back({uniform(random), uniform(random)});
    for (const double x : special)
      for (int i = 0; i < 2; ++i) {
        uvs.push_back({uniform(random), x});
        uvs.push_back({x, uniform(random)});
        uvs.push_back({special[random() % special.size()], x});
      }
    if constexpr (std::same_as<S, float>)
      for (Vec2<double>& uv : uvs) uv = {as_float(uv.x), as_float(uv.y)};
    laws.compare(chosen, uvs, static_cast<std::size_t>(options.points),
                 options.parameter_sets == 0 ? std::string() : chosen.specification());
  }
  laws.results(checks);
}

template void check_high_precision<double>(const AnySurface&, const CheckOptions&, Checks&);
template void check_high_precision<float>(const AnySurface&, const CheckOptions&, Checks&);

}  // namespace darboux::laws
