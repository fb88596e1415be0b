// Everything against the same formula in 40 digits.
#include <algorithm>
#include <concepts>
#include <random>

#include <darboux/error.h>
#include <darboux/forms.h>

#include "law.h"

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
      // These values do not go together: others.
    }
  }
  return surface;
}

template <class S>
double largest_difference(const Vec3<S>& a, const Vec3<Multiprecision>& b) {
  const Vec3<double> d = rounded(
      Vec3<Multiprecision>{Multiprecision(a.x) - b.x, Multiprecision(a.y) - b.y, Multiprecision(a.z) - b.z});
  const double largest = std::fmax(std::fabs(d.x), std::fmax(std::fabs(d.y), std::fabs(d.z)));
  return std::isnan(d.x + d.y + d.z) ? infinity : largest;
}

struct ExactFrame {
  Vec3<Multiprecision> t, b, n;
};
ExactFrame exact_frame(const Jet2<Multiprecision>& j, double handedness) {
  const Vec3<Multiprecision> t = unit(j.dpdu), n = Multiprecision(handedness) * unit(cross(j.dpdu, j.dpdv));
  return {t, cross(n, t), n};
}

double difference(const ExactFrame& a, const ExactFrame& b) {
  return norm(rounded(a.t - b.t)) + norm(rounded(a.n - b.n));
}

// The share of one input in a frame's condition; none where the frame beside it does not exist.
double change(const ExactFrame& moved, const ExactFrame& at) {
  const double d = difference(moved, at) / relative_change;
  return std::isnan(d) ? 0 : d;
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

// 1e-1500: so near that powers as low as the fourth root outweigh axes whose sizes are 1e300 apart.
const Multiprecision& tiny() {
  static const Multiprecision value = [] {
    Multiprecision product(1.0);
    for (int i = 0; i < 5; ++i) product = product * Multiprecision(1e-300);
    return product;
  }();
  return value;
}

// How far apart the sizes of the parameters are.
double spread(const AnySurface& surface) {
  double smallest = infinity, largest = 0;
  for (const ParameterValue& p : surface.parameters())
    if (p.value != 0) {
      smallest = std::fmin(smallest, std::fabs(p.value));
      largest = std::fmax(largest, std::fabs(p.value));
    }
  return largest / smallest;
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
      Vec2<double> uv;
      Sample<S> sample;
      Jet2<Multiprecision> exact;
      std::vector<Jet2<Multiprecision>> neighbours;
    };
    const std::vector<ParameterValue> parameters = surface.parameters();
    std::array<double, 6> common_scale{};
    std::vector<At> all;
    for (const Vec2<double>& uv : uvs) {
      const Inputs inputs(uv.x, uv.y, parameters);
      At at{uv, evaluate(surface, uv), multiprecision_jet(surface, inputs), {}};
      for_each_neighbour(surface, inputs,
                         [&](const Jet2<Multiprecision>& moved) { at.neighbours.push_back(moved); });
      if (all.size() < random_points)
        for (int k = 0; k < 6; ++k) {
          const double size = norm(rounded(partial(at.exact, k)));
          if (std::isfinite(size)) common_scale[k] = std::fmax(common_scale[k], size);
        }
      all.push_back(std::move(at));
    }
    for (double& s : common_scale)
      if (s == 0) s = common_scale[0];
    for (const At& at : all) {
      const auto& [u, v] = at.uv;
      std::array<double, 6> condition{}, scale = common_scale;
      for (int k = 0; k < 6; ++k) {
        const double size = norm(rounded(partial(at.exact, k)));
        if (!(size <= scale[k])) scale[k] = size;
        for (const Jet2<Multiprecision>& moved : at.neighbours)
          condition[k] +=
              norm(rounded(partial(moved, k) - partial(at.exact, k))) / relative_change / scale[k];
        // Beyond the range of S nothing can be asked of it.
        constexpr double largest = std::numeric_limits<S>::max() / 64,
                         smallest = std::numeric_limits<S>::min() / roundoff;
        if (!(scale[k] < largest && scale[k] > smallest)) continue;
        // Nor where the surface is beyond the sizes it is proven for, and says so.
        if (scale[k] > std::sqrt(largest) && has(at.sample.frame.status, Status::overflow)) continue;
        partials_[static_cast<std::size_t>(k)].compare(
            largest_difference(partial(at.sample.jet, k), partial(at.exact, k)) / scale[k],
            8 * roundoff * (1 + condition[k]), u, v, of);
      }
      compare_status(at.uv, at.sample, at.exact, scale, condition, of);
      compare_frame(surface, at.uv, at.sample, at.exact, at.neighbours, scale, condition, of);
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

  // Errors of a limit frame against the nearest limit that 40 digits show; its condition.
  struct Nearest {
    bool shown = false;
    std::array<double, 3> errors{infinity, infinity, infinity};
    double condition = 0;
  };

  static std::array<double, 3> errors_of(const Frame<S>& f, const ExactFrame& e) {
    return {largest_difference(f.t, e.t), largest_difference(f.b, e.b), largest_difference(f.n, e.n)};
  }

  // The limit along the given u (or v): from inside the domain, from either side of a point within it. At
  // zero a distance may be as small as one likes; elsewhere 40 digits leave 1e-18, which is too coarse
  // for parameters of very different sizes. Where two such distances still give different frames, the
  // limit is approached as by a root, and no distance shows it.
  static Nearest nearest_limit(const AnySurface& surface, const Vec2<double>& uv, const Frame<S>& f) {
    const double u = uv.x, v = uv.y;
    const SurfaceInfo& info = surface.info();
    Nearest nearest;
    for (const double side : {1.0, -1.0})
      for (const bool along_v : {true, false}) {
        if (!has(f.status,
                 along_v ? Status::dpdu_zero | Status::parallel : Status::dpdv_zero | Status::parallel))
          continue;
        const double x = along_v ? v : u;
        const Coordinate kind = along_v ? info.v : info.u;
        const bool bounded = kind == Coordinate::linear || kind == Coordinate::half_turn;
        if ((bounded && ((x == 0 && side < 0) || (x == 1 && side > 0))) || (x != 0 && spread(surface) > 1e6))
          continue;
        const Multiprecision far = x == 0 ? tiny() : Multiprecision(1e-18), near = far * Multiprecision(1e-3);
        const auto approach = [&](const Multiprecision& distance) {
          Inputs inputs(u, v, surface.parameters());
          Multiprecision& moved = along_v ? inputs.v : inputs.u;
          moved = moved + Multiprecision(side) * distance;
          return inputs;
        };
        const Inputs at = approach(near);
        const ExactFrame exact_near = exact_frame(multiprecision_jet(surface, at), f.handedness);
        const ExactFrame exact_far = exact_frame(multiprecision_jet(surface, approach(far)), f.handedness);
        if (!(difference(exact_far, exact_near) < roundoff / 2)) continue;
        nearest.shown = true;
        const std::array<double, 3> found = errors_of(f, exact_near);
        if (!(found[0] + found[1] + found[2] < nearest.errors[0] + nearest.errors[1] + nearest.errors[2]))
          continue;
        nearest.errors = found;
        nearest.condition = 0;
        for_each_neighbour(surface, at, [&](const Jet2<Multiprecision>& moved) {
          nearest.condition += change(exact_frame(moved, f.handedness), exact_near);
        });
      }
    return nearest;
  }

  void compare_frame(const AnySurface& surface, const Vec2<double>& uv, const Sample<S>& sample,
                     const Jet2<Multiprecision>& exact, const std::vector<Jet2<Multiprecision>>& neighbours,
                     const std::array<double, 6>& scale, const std::array<double, 6>& partial_condition,
                     const std::string& of) {
    const Frame<S>& f = sample.frame;
    const double u = uv.x, v = uv.y;
    if (has(f.status, Status::no_frame)) return;
    const SurfaceInfo& info = surface.info();
    const bool closed = surface.has_closed_frame();
    // Of every frame, whatever the oracle can say of its directions.
    orthonormality_.compare(deviation_from_orthonormal(f), (closed ? 8 : 16) * roundoff, u, v, of);
    std::array<double, 3> errors{infinity, infinity, infinity};
    double condition = 0, of_40_digits = 0;
    if (has(f.status, Status::limit_frame)) {
      const Nearest nearest = nearest_limit(surface, uv, f);
      if (!nearest.shown) return;
      errors = nearest.errors;
      condition = nearest.condition;
    } else {
      const ExactFrame e = exact_frame(exact, f.handedness);
      // Where the true partials give no frame, those with their rounding gave an arbitrary one.
      if (!closed && !(norm(rounded(e.t)) > 0 && norm(rounded(e.n)) > 0)) return;
      const Vec3<Multiprecision> area = cross(unit(exact.dpdu), unit(exact.dpdv));
      const double determinant = static_cast<double>(dot(area, Vec3<Multiprecision>{f.n.x, f.n.y, f.n.z}));
      of_40_digits = 1e-38 / norm(rounded(area));  // what they leave of a normal of nearly parallel partials
      if (!(of_40_digits < 1)) return;             // nothing
      // A surface that states its own orientation cannot tell the side where dpdu across dpdv is within
      // rounding of zero.
      if (info.own_orientation && determinant * f.handedness < 0 &&
          norm(rounded(cross(exact.dpdu, unit(exact.dpdv)))) <
              16 * roundoff * (1 + partial_condition[1]) * scale[1])
        return;
      errors = errors_of(f, e);
      for (const Jet2<Multiprecision>& moved : neighbours)
        condition += change(exact_frame(moved, f.handedness), e);
    }
    double frame_bound = info.frame_error * (1 + condition);
    if (!closed) {
      // From partials that are within 8 (1 + condition) of their scale: what that turns t and n by.
      const double du = norm(rounded(exact.dpdu)), dv = norm(rounded(exact.dpdv)),
                   sine = norm(rounded(cross(unit(exact.dpdu), unit(exact.dpdv))));
      const double amplified =
          has(f.status, Status::limit_frame)
              ? 1
              : ((1 + partial_condition[1]) * scale[1] / du + (1 + partial_condition[2]) * scale[2] / dv) /
                    sine;
      frame_bound = 8 * (1 + condition + amplified);
    }
    const double bound = frame_bound * roundoff + of_40_digits;
    tangent_.compare(errors[0], bound, u, v, of);
    bitangent_.compare(errors[1], bound, u, v, of);
    normal_.compare(errors[2], bound, u, v, of);
  }

  std::string_view route_;
  std::vector<Law> partials_;
  Law tangent_, bitangent_, normal_, orthonormality_, status_;
};

// The numbers of a quantity; its error and condition are relative to their 2-norm.
template <class S>
using Numbers = std::vector<S>;
constexpr std::array<std::string_view, 9> form_names{
    "gaussian_curvature", "mean_curvature", "principal_curvatures", "principal_directions", "dndu", "dndv",
    "first_form",         "second_form",    "christoffel"};
constexpr std::size_t k_gaussian = 0, k_mean = 1, k_principal = 2, k_directions = 3;
template <class S>
using AllNumbers = std::array<Numbers<S>, form_names.size()>;

template <class S>
AllNumbers<S> numbers_of(const Curvature<S>& c, const NormalDerivatives<S>& d, const FirstForm<S>& I,
                         const SecondForm<S>& II, const Christoffel<S>& g) {
  const Vec3<S>&p = c.directions[0], &q = c.directions[1];
  return {Numbers<S>{c.gaussian},
          {c.mean},
          {c.principal[0], c.principal[1]},
          {p.x, p.y, p.z, q.x, q.y, q.z},
          {d.dndu.x, d.dndu.y, d.dndu.z},
          {d.dndv.x, d.dndv.y, d.dndv.z},
          {I.E, I.F, I.G},
          {II.L, II.M, II.N},
          {g.u[0], g.u[1], g.u[2], g.v[0], g.v[1], g.v[2]}};
}
AllNumbers<Multiprecision> numbers_of(const Jet2<Multiprecision>& j, double side) {
  const ExactFrame e = exact_frame(j, side);
  const Frame<Multiprecision> f{e.t, e.b, e.n};
  const ShapeOperator<Multiprecision> s = shape_operator(j, f);
  return numbers_of(detail::curvature_of(s, f, Multiprecision(1e-30), Multiprecision(1e-36)),
                    normal_derivatives(s, f), first_form(j), second_form(j, f.n), christoffel(j, f));
}
AllNumbers<double> numbers_of(const AnySurface& surface, const Sample<double>& s) {
  const Frame<double>& f = s.frame;
  return numbers_of(curvature(surface, s.u, s.v, s.jet, f), normal_derivatives(surface, s.u, s.v, s.jet, f),
                    first_form(s.jet), second_form(surface, s.u, s.v, s.jet, f),
                    christoffel(surface, s.u, s.v, s.jet, f));
}

// Of a surface made of control points or a curve each number is an input. All x together, all y and all z are
// counted as one each, and for the rest its bound is four times as large.
bool made_of_data(const AnySurface& surface) {
  return surface.parameters().empty() || surface.info().name == "extrusion";
}

double length(const Numbers<Multiprecision>& q) {
  double sum = 0;
  for (const Multiprecision& x : q) sum = std::hypot(sum, static_cast<double>(x));
  return sum;
}
// a - b, of directions with the sign that brings them together.
template <class S>
Numbers<Multiprecision> difference(const Numbers<S>& a, const Numbers<Multiprecision>& b,
                                   std::size_t quantity) {
  double along = 0;
  if (quantity == k_directions)
    for (std::size_t i = 0; i < 3; ++i) along += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  Numbers<Multiprecision> result;
  for (std::size_t i = 0; i < a.size(); ++i)
    result.push_back(along < 0 ? Multiprecision(a[i]) + b[i] : Multiprecision(a[i]) - b[i]);
  return result;
}

}  // namespace

void check_high_precision_forms(const AnySurface& surface, const CheckOptions& options, Checks& checks) {
  std::vector<Law> laws;
  for (const std::string_view name : form_names)
    laws.emplace_back(surface.info().name, "high_precision_forms", name);
  const bool data = made_of_data(surface);
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int set = 0; set < std::max(1, options.parameter_sets); ++set) {
    // Beyond some decades 40 digits are no oracle for what cancels.
    const AnySurface chosen = options.parameter_sets == 0 ? surface : random_parameters(surface, random, 1e4);
    const std::vector<ParameterValue> parameters = chosen.parameters();
    for (int i = 0; i < options.points; ++i) {
      const double u = uniform(random), v = uniform(random);
      const Sample<double> sample = chosen.sample(u, v);
      if (sample.frame.status != Status::regular) continue;
      const Inputs inputs(u, v, parameters);
      const Jet2<Multiprecision> j = multiprecision_jet(chosen, inputs);
      const Frame<double>& f = sample.frame;
      const double side = dot(rounded(unit(cross(j.dpdu, j.dpdv))), f.n) < 0 ? -1 : 1;
      const AllNumbers<Multiprecision> exact = numbers_of(j, side);
      const AllNumbers<double> own = numbers_of(chosen, sample);
      std::array<double, form_names.size()> condition{};
      const auto add = [&](const Jet2<Multiprecision>& moved) {
        const AllNumbers<Multiprecision> there = numbers_of(moved, side);
        for (std::size_t q = 0; q < form_names.size(); ++q)
          condition[q] += length(difference(there[q], exact[q], q)) / relative_change;
      };
      for_each_neighbour(chosen, inputs, add);
      if (data)
        for (Multiprecision Vec3<Multiprecision>::*axis :
             {&Vec3<Multiprecision>::x, &Vec3<Multiprecision>::y, &Vec3<Multiprecision>::z}) {
          Jet2<Multiprecision> moved = j;
          for (Vec3<Multiprecision>* p :
               {&moved.dpdu, &moved.dpdv, &moved.d2pdu2, &moved.d2pduv, &moved.d2pdv2})
            p->*axis = p->*axis + p->*axis * Multiprecision(relative_change);
          add(moved);
        }
      const double k = length(exact[k_principal]),
                   apart = static_cast<double>(exact[k_principal][0] - exact[k_principal][1]);
      for (std::size_t q = 0; q < form_names.size(); ++q) {
        const double size = length(exact[q]);
        // What vanishes, or so nearly that 40 digits leave no condition, has no relative error.
        const double scale = q == k_gaussian ? k * k : q == k_mean ? k : 0;
        if (!(condition[q] < 1e12 * size) || !(size > 1e-34 * scale)) continue;
        double times = 1 + condition[q] / size;
        if (q <= k_principal) times += 0.5;  // the frame's own 4u
        if (q == k_directions) {
          if (!(apart > 1e-12 * k)) continue;
          times += std::fmin(k / apart, detail::cancellation_of_directions);
        }
        laws[q].compare(length(difference(own[q], exact[q], q)) / size,
                        (data ? 8 : 2) * surface.info().frame_error * unit_roundoff * times, u, v,
                        options.parameter_sets == 0 ? std::string() : chosen.specification());
      }
    }
  }
  for (const Law& law : laws) checks.push_back(law.result("it vanishes"));
}

namespace {

// The nearest number that float holds. Through memory: g++ 12 at -O2 drops the conversion there and back from
// a loop over pairs.
double as_float(double x) {
  volatile float result = static_cast<float>(x);
  return result;
}

// The same surface with parameters that float holds exactly.
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
      // Sizes whose squares and quotients float still holds.
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
