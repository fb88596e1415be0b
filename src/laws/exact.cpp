#include "exact.h"

#include <algorithm>
#include <concepts>

#include <darboux/christoffel.h>
#include <darboux/curvature.h>
#include <darboux/forms.h>
#include <darboux/shape_operator.h>

namespace darboux::laws {
namespace {

double difference(const ExactFrame& a, const ExactFrame& b) {
  return norm(rounded(a.t - b.t)) + norm(rounded(a.n - b.n));
}

// The share of one input in a frame's condition; none if the frame next to it does not exist.
double change(const ExactFrame& moved, const ExactFrame& at) {
  const double d = difference(moved, at) / relative_change;
  return std::isnan(d) ? 0 : d;
}

double size_of(const Vec3<Multiprecision>& a) {
  return norm(rounded(a));
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

// The ratio of the largest size of a parameter to the smallest.
double spread(const AnySurface& surface) {
  double smallest = infinity, largest = 0;
  for (const ParameterValue& p : surface.parameters())
    if (p.value != 0) {
      smallest = std::fmin(smallest, std::fabs(p.value));
      largest = std::fmax(largest, std::fabs(p.value));
    }
  return largest / smallest;
}

// Errors of a limit frame against the nearest limit that 40 digits show; its condition.
struct Nearest {
  bool shown = false;
  std::array<double, 3> errors{infinity, infinity, infinity};
  double condition = 0;
};

template <class S>
std::array<double, 3> errors_of(const Frame<S>& f, const ExactFrame& e) {
  return {largest_difference(f.t, e.t), largest_difference(f.b, e.b), largest_difference(f.n, e.n)};
}

// The limit along the given u (or v): from inside the domain, from either side of a point within it. At zero
// a distance may be arbitrarily small; elsewhere 40 digits allow 1e-18, which is too coarse for parameters of
// very different sizes. If two such distances still give different frames, the limit is approached like a
// root, and no distance shows it.
template <class S>
Nearest nearest_limit(const AnySurface& surface, const Vec2<double>& uv, const Frame<S>& f) {
  constexpr double roundoff = std::numeric_limits<S>::epsilon() / 2;
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

}  // namespace

ExactFrame exact_frame(const Jet2<Multiprecision>& j, double handedness) {
  const Vec3<Multiprecision> t = unit(j.dpdu), n = Multiprecision(handedness) * unit(cross(j.dpdu, j.dpdv));
  return {t, cross(n, t), n};
}

Exact::Exact(const AnySurface& surface, double u, double v) : uv{u, v} {
  const Inputs inputs(u, v, surface.parameters());
  jet = multiprecision_jet(surface, inputs);
  for_each_neighbour(surface, inputs,
                     [&](const Jet2<Multiprecision>& moved) { neighbours.push_back(moved); });
}

double largest_difference(const Vec3<Multiprecision>& a, const Vec3<Multiprecision>& b) {
  const Vec3<double> d = rounded(a - b);
  const double largest = std::fmax(std::fabs(d.x), std::fmax(std::fabs(d.y), std::fabs(d.z)));
  return std::isnan(d.x + d.y + d.z) ? infinity : largest;
}

PartialScales partial_scales(const Exact& exact, const std::array<double, 6>& scale) {
  PartialScales result{scale, {}};
  for (int k = 0; k < 6; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double size = size_of(partial(exact.jet, k));
    if (!(size <= result.scale[i])) result.scale[i] = size;
    for (const Jet2<Multiprecision>& moved : exact.neighbours)
      result.condition[i] +=
          size_of(partial(moved, k) - partial(exact.jet, k)) / relative_change / result.scale[i];
  }
  return result;
}

template <class S>
std::optional<Comparison> compare_partial(const Exact& exact, const PartialScales& scales,
                                          const Sample<S>& sample, int k) {
  constexpr double roundoff = std::numeric_limits<S>::epsilon() / 2;
  constexpr double largest = std::numeric_limits<S>::max() / 64,
                   smallest = std::numeric_limits<S>::min() / roundoff;
  const auto i = static_cast<std::size_t>(k);
  const double scale = scales.scale[i], condition = scales.condition[i];
  if (!(scale < largest && scale > smallest)) return std::nullopt;
  if (scale > std::sqrt(largest) && has(sample.frame.status, Status::overflow)) return std::nullopt;
  return Comparison{largest_difference(partial(sample.jet, k), partial(exact.jet, k)) / scale,
                    8 * roundoff * (1 + condition), condition};
}
template std::optional<Comparison> compare_partial(const Exact&, const PartialScales&, const Sample<double>&,
                                                   int);
template std::optional<Comparison> compare_partial(const Exact&, const PartialScales&, const Sample<float>&,
                                                   int);

double magnified(const Exact& exact, const PartialScales& scales) {
  const double du = size_of(exact.jet.dpdu), dv = size_of(exact.jet.dpdv),
               sine = size_of(cross(unit(exact.jet.dpdu), unit(exact.jet.dpdv)));
  return ((1 + scales.condition[1]) * scales.scale[1] / du +
          (1 + scales.condition[2]) * scales.scale[2] / dv) /
         sine;
}

template <class S>
std::optional<std::array<Comparison, 3>> compare_frame(const AnySurface& surface, const Exact& exact,
                                                       const PartialScales& scales, const Sample<S>& sample,
                                                       bool closed) {
  constexpr double roundoff = std::numeric_limits<S>::epsilon() / 2;
  const Frame<S>& f = sample.frame;
  if (has(f.status, Status::no_frame)) return std::nullopt;
  const SurfaceInfo& info = surface.info();
  const bool limit = has(f.status, Status::limit_frame);
  std::array<double, 3> errors{infinity, infinity, infinity};
  double condition = 0, of_40_digits = 0;
  if (limit) {
    const Nearest nearest = nearest_limit(surface, exact.uv, f);
    if (!nearest.shown) return std::nullopt;
    errors = nearest.errors;
    condition = nearest.condition;
  } else {
    const ExactFrame e = exact_frame(exact.jet, f.handedness);
    // If the true partials give no frame, rounded ones give an arbitrary one.
    if (!closed && !(size_of(e.t) > 0 && size_of(e.n) > 0)) return std::nullopt;
    const Vec3<Multiprecision> area = cross(unit(exact.jet.dpdu), unit(exact.jet.dpdv));
    const double determinant = static_cast<double>(dot(area, Vec3<Multiprecision>{f.n.x, f.n.y, f.n.z}));
    of_40_digits = 1e-38 / size_of(area);          // their error in the normal of nearly parallel partials
    if (!(of_40_digits < 1)) return std::nullopt;  // nothing
    // A surface that states its own orientation cannot tell the side where dpdu across dpdv is within
    // rounding of zero.
    if (info.own_orientation && determinant * f.handedness < 0 &&
        size_of(cross(exact.jet.dpdu, unit(exact.jet.dpdv))) <
            16 * roundoff * (1 + scales.condition[1]) * scales.scale[1])
      return std::nullopt;
    errors = errors_of(f, e);
    for (const Jet2<Multiprecision>& moved : exact.neighbours)
      condition += change(exact_frame(moved, f.handedness), e);
  }
  double times = info.frame_error * (1 + condition);
  // From partials that are within 8 (1 + condition) of their scale: the resulting rotation of t and n.
  if (!closed) times = 8 * (1 + condition + (limit ? 1 : magnified(exact, scales)));
  const double bound = times * roundoff + of_40_digits;
  return std::array{Comparison{errors[0], bound, condition}, Comparison{errors[1], bound, condition},
                    Comparison{errors[2], bound, condition}};
}
template std::optional<std::array<Comparison, 3>> compare_frame(const AnySurface&, const Exact&,
                                                                const PartialScales&, const Sample<double>&,
                                                                bool);
template std::optional<std::array<Comparison, 3>> compare_frame(const AnySurface&, const Exact&,
                                                                const PartialScales&, const Sample<float>&,
                                                                bool);

// ---- curvatures and forms ---------------------------------------------------------------------------------

namespace {

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

// Whether the surface is made of control points or a curve, so that each number is an input. All x together,
// all y and all z are counted as one each; for the rest, its bound is four times as large.
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

AllNumbers<double> form_numbers(const AnySurface& surface, const Sample<double>& s) {
  const Frame<double>& f = s.frame;
  return numbers_of(curvature(surface, s.u, s.v, s.jet, f), normal_derivatives(surface, s.u, s.v, s.jet, f),
                    first_form(s.jet), second_form(surface, s.u, s.v, s.jet, f),
                    christoffel(surface, s.u, s.v, s.jet, f));
}

std::array<std::optional<Comparison>, form_names.size()> compare_forms(const AnySurface& surface,
                                                                       const Exact& at,
                                                                       const Vec3<double>& normal,
                                                                       const AllNumbers<double>& own,
                                                                       const PartialScales* partials) {
  const bool data = made_of_data(surface);
  const Jet2<Multiprecision>& j = at.jet;
  const double side = dot(rounded(unit(cross(j.dpdu, j.dpdv))), normal) < 0 ? -1 : 1;
  const AllNumbers<Multiprecision> exact = numbers_of(j, side);
  std::array<double, form_names.size()> condition{};
  const auto add = [&](std::array<double, form_names.size()>& sum, const Jet2<Multiprecision>& moved) {
    const AllNumbers<Multiprecision> there = numbers_of(moved, side);
    for (std::size_t q = 0; q < form_names.size(); ++q)
      sum[q] += length(difference(there[q], exact[q], q)) / relative_change;
  };
  for (const Jet2<Multiprecision>& moved : at.neighbours) add(condition, moved);
  constexpr std::array axes{&Vec3<Multiprecision>::x, &Vec3<Multiprecision>::y, &Vec3<Multiprecision>::z};
  std::array<double, form_names.size()> of_partials{};
  if (partials)
    for (std::size_t k = 1; k < 6; ++k)
      for (Multiprecision Vec3<Multiprecision>::*axis : axes) {
        Jet2<Multiprecision> moved = j;
        const std::array<Vec3<Multiprecision>*, 6> all{&moved.position, &moved.dpdu,   &moved.dpdv,
                                                       &moved.d2pdu2,   &moved.d2pduv, &moved.d2pdv2};
        all[k]->*axis = all[k]->*axis + Multiprecision(partials->scale[k] * (1 + partials->condition[k])) *
                                            Multiprecision(relative_change);
        add(of_partials, moved);
      }
  if (data)
    for (Multiprecision Vec3<Multiprecision>::*axis : axes) {
      Jet2<Multiprecision> moved = j;
      for (Vec3<Multiprecision>* p : {&moved.dpdu, &moved.dpdv, &moved.d2pdu2, &moved.d2pduv, &moved.d2pdv2})
        p->*axis = p->*axis + p->*axis * Multiprecision(relative_change);
      add(condition, moved);
    }
  const double k = length(exact[k_principal]),
               apart = static_cast<double>(exact[k_principal][0] - exact[k_principal][1]);
  std::array<std::optional<Comparison>, form_names.size()> result;
  for (std::size_t q = 0; q < form_names.size(); ++q) {
    const double size = length(exact[q]);
    const double scale = q == k_gaussian ? k * k : q == k_mean ? k : 0;
    // Beyond the range of double nothing is compared.
    if (!(size < std::numeric_limits<double>::max() / 64 &&
          size > std::numeric_limits<double>::min() / unit_roundoff))
      continue;
    if (own[q].empty() || !(condition[q] < 1e12 * size) || !(size > 1e-34 * scale)) continue;
    double times = 1 + condition[q] / size;
    if (q <= k_principal) times += 0.5;  // the frame's own 4u
    if (q == k_directions) {
      if (!(apart > 1e-12 * k)) continue;
      // The error of the shape operator over the difference of its eigenvalues turns them.
      times += (1 + condition[k_principal] / k) * std::fmin(k / apart, detail::cancellation_of_directions);
    }
    // The digits that 40-digit arithmetic leaves of a cancelling sum.
    const double of_40_digits = 1e-37 * scale / size;
    result[q] = Comparison{length(difference(own[q], exact[q], q)) / size,
                           (data ? 8 : 2) * surface.info().frame_error * unit_roundoff * times +
                               8 * unit_roundoff * of_partials[q] / size + of_40_digits,
                           condition[q] / size};
  }
  return result;
}

}  // namespace darboux::laws
