#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include <darboux/differentiate.h>
#include <darboux/error.h>
#include <darboux/forms.h>
#include <darboux/testing.h>

#include "text.h"

namespace darboux {
namespace {

constexpr double unit_roundoff = 0x1p-53;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The partials in the order of Jet2, with the names of eval's keys.
constexpr std::array<std::string_view, 6> names{"position", "dpdu", "dpdv", "d2pdu2", "d2pduv", "d2pdv2"};
template <class S>
const Vec3<S>& partial(const Jet2<S>& j, int k) {
  const std::array<const Vec3<S>*, 6> all{&j.position, &j.dpdu, &j.dpdv, &j.d2pdu2, &j.d2pduv, &j.d2pdv2};
  return *all[static_cast<std::size_t>(k)];
}

// Each first derivative the routes look at: partial `of` differentiated along `along` (0: u, 1: v) is `is`.
struct Derivative {
  int of, along, is;
};
constexpr std::array<Derivative, 6> derivatives{
    {{0, 0, 1}, {0, 1, 2}, {1, 0, 3}, {1, 1, 4}, {2, 0, 4}, {2, 1, 5}}};

template <class S>
Vec3<double> rounded(const Vec3<S>& a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}
template <class T>
Vec3<T> derivative(const Vec3<Dual<T, 2>>& a, std::size_t k) {
  return {a.x.derivative[k], a.y.derivative[k], a.z.derivative[k]};
}
template <class T>
Vec3<T> value(const Vec3<Dual<T, 2>>& a) {
  return {a.x.value, a.y.value, a.z.value};
}

// Keeps the point with the worst error / bound of one law.
class Law {
 public:
  Law(std::string_view surface, std::string_view route, std::string_view quantity) {
    check_.surface = surface;
    check_.route = route;
    check_.quantity = quantity;
    check_.passed = true;
  }

  void compare(double error, double bound, double u, double v, const std::string& of = {}) {
    ++check_.points;
    // Written so that a NaN fails.
    const bool within = error <= bound;
    const double ratio = bound > 0 ? error / bound : (within ? 0 : infinity);
    if (check_.points == 1 || (!(ratio <= worst_ratio_) && !std::isnan(worst_ratio_))) {
      worst_ratio_ = ratio;
      check_.max_error = error;
      check_.bound = bound;
      check_.worst_u = u;
      check_.worst_v = v;
      check_.worst_surface = of;
    }
    check_.passed = check_.passed && within;
  }

  // \param nothing_compared why, where no point could be compared; empty: that is a failure
  Check result(std::string_view nothing_compared = {}) const {
    Check c = check_;
    if (c.points == 0) {
      c.passed = !nothing_compared.empty();
      c.skipped = c.passed ? nothing_compared : "no point could be compared";
    }
    return c;
  }

 private:
  Check check_;
  double worst_ratio_ = 0;
};

// ---- conditions ------------------------------------------------------------------------------------------------

// The inputs of a surface's formula in 40 digits: u, v and the parameters.
struct Inputs {
  ManyDigits u, v;
  std::vector<ManyDigits> parameters;

  Inputs(double u_, double v_, const std::vector<ParameterValue>& values) : u(u_), v(v_) {
    for (const ParameterValue& p : values) parameters.emplace_back(p.value);
  }
  ManyDigits& at(std::size_t k) { return k == 0 ? u : k == 1 ? v : parameters[k - 2]; }
  std::size_t size() const { return 2 + parameters.size(); }
};

Jet2<ManyDigits> many_digit_jet(const AnySurface& surface, const Inputs& x) {
  return surface.jet(x.u, x.v, x.parameters);
}

// Calls f(jet) for the jet with each input moved by a relative 1e-20 in turn: what that changes, times 1e20, is the sum
// over the inputs of |x ∂/∂x|, the condition that no formula in these inputs can undercut.
constexpr double relative_change = 1e-20;
template <class F>
void for_each_neighbour(const AnySurface& surface, Inputs x, F f) {
  for (std::size_t k = 0; k < x.size(); ++k) {
    const ManyDigits kept = x.at(k);
    if (kept == ManyDigits(0.0)) continue;
    x.at(k) = kept + kept * ManyDigits(relative_change);
    f(many_digit_jet(surface, x));
    x.at(k) = kept;
  }
}

// ---- points ----------------------------------------------------------------------------------------------------

struct Point {
  double u, v;
  Jet2<double> j;
  Frame<double> f;
  std::array<double, 6> condition{};  // of each partial, relative to its scale
};

struct Points {
  std::string_view name;
  std::vector<Point> list;
  std::array<double, 6> scale{};  // largest magnitude of each partial over the points
  std::array<double, 2> third{};  // the same of d3pdu3, d3pdv3
  bool representable = true;
  std::optional<Vec2<double>> not_a_number;  // where a partial is NaN

  Points(const AnySurface& surface, const CheckOptions& options) : name(surface.info().name) {
    std::mt19937_64 random(options.seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int i = 0; i < options.points; ++i) {
      const double u = uniform(random), v = uniform(random);
      list.push_back({u, v, surface.jet(u, v), surface.frame(u, v)});
      for (int k = 0; k < 6; ++k) {
        const double size = norm(partial(list.back().j, k));
        if (!(size <= scale[k])) scale[k] = size;
        if (std::isnan(size)) not_a_number = {u, v};
      }
      const Jet2<DualUV> d = surface.jet(DualUV::variable(u, 0), DualUV::variable(v, 1));
      third[0] = std::fmax(third[0], norm(derivative(d.d2pdu2, 0)));
      third[1] = std::fmax(third[1], norm(derivative(d.d2pdv2, 1)));
    }
    for (double& s : scale) {
      if (s == 0) s = scale[0];
      representable = representable && s < 1e300 && s > 1e-290;
    }
    if (!representable) return;
    const std::vector<ParameterValue> parameters = surface.parameters();
    for (Point& p : list) {
      const Inputs inputs(p.u, p.v, parameters);
      const Jet2<ManyDigits> exact = many_digit_jet(surface, inputs);
      for_each_neighbour(surface, inputs, [&](const Jet2<ManyDigits>& moved) {
        for (int k = 0; k < 6; ++k)
          p.condition[k] += norm(rounded(partial(moved, k) - partial(exact, k))) / relative_change / scale[k];
      });
    }
  }
};

// ---- derivative routes -----------------------------------------------------------------------------------------

void check_dual(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  std::vector<Law> laws;
  for (int is = 1; is < 6; ++is) laws.emplace_back(points.name, "dual", names[is]);
  Law tangent(points.name, "dual", "tangent"), normal(points.name, "dual", "normal"),
      bitangent(points.name, "dual", "bitangent"), handedness(points.name, "dual", "handedness");
  for (const Point& p : points.list) {
    const Jet2<DualUV> d = surface.jet(DualUV::variable(p.u, 0), DualUV::variable(p.v, 1));
    for (const Derivative& dual : derivatives) {
      const Vec3<double> found = derivative(partial(d, dual.of), dual.along);
      // Two roundings of the same value, each within 8u (1 + condition).
      laws[dual.is - 1].compare(norm(found - partial(p.j, dual.is)) / points.scale[dual.is],
                                16 * unit_roundoff * (1 + p.condition[dual.is]), p.u, p.v);
    }
    const Vec3<double> du = derivative(d.position, 0), dv = derivative(d.position, 1);
    const Frame<double> generic = frame_from_partials(du, dv);
    if (has(p.f.status, Status::limit_frame | Status::no_frame) || has(generic.status, Status::no_frame))
      continue;
    // A partial that is small against its scale has lost the same share of its digits, and nearly parallel partials
    // leave less of the normal.
    const double sine = norm(cross(unit(du), unit(dv)));
    const double condition = (points.scale[1] / norm(du) * (1 + p.condition[1]) +
                              points.scale[2] / norm(dv) * (1 + p.condition[2])) /
                             sine;
    const double bound = 16 * unit_roundoff * (1 + condition);
    tangent.compare(norm(p.f.t - generic.t), bound, p.u, p.v);
    normal.compare(norm(p.f.n - p.f.handedness * generic.n), bound, p.u, p.v);
    bitangent.compare(norm(p.f.b - cross(p.f.n, p.f.t)), 16 * unit_roundoff, p.u, p.v);
    const double determinant = dot(cross(unit(du), unit(dv)), p.f.n);
    const bool right =
        (surface.info().own_orientation || p.f.handedness == 1) && determinant * p.f.handedness > 0;
    if (bound < 1) handedness.compare(right ? 0 : 1, 0, p.u, p.v);
  }
  for (const Law& law : laws) checks.push_back(law.result());
  for (const Law* law : {&tangent, &bitangent, &normal, &handedness}) checks.push_back(law->result());
}

// Numerical differentiation by one method, f: double -> Vec3<double>, with its estimate.
using Differentiate =
    std::function<DerivativeEstimate<>(const std::function<Vec3<double>(double)>&, double x, double length)>;

// The length over which the surface varies like a whole turn, at most 1: 2π times the ratio of the first to the second
// derivative along u or v, or of the second to the third, rounded to a power of two.
double variation(const Points& points, int along) {
  const double first = points.scale[along == 0 ? 1 : 2], second = points.scale[along == 0 ? 3 : 5],
               third = points.third[along];
  const double shortest = std::fmin(first / second, third > 0 ? second / third : 1);
  return std::fmin(1, std::exp2(std::floor(std::log2(2 * std::numbers::pi * shortest) + 0.5)));
}

// An estimate above this share of the scale would hide a wrong formula: such a point is not compared.
constexpr double worst_estimate = 1e-6;

void compare_numeric(const AnySurface& surface, const Points& points, std::string_view route,
                     const Differentiate& differentiate, bool at_edges, std::vector<Check>& checks) {
  const std::array<double, 2> length{variation(points, 0), variation(points, 1)};
  const std::array<std::vector<double>, 2> breaks{surface.breaks(0), surface.breaks(1)};
  for (int is = 1; is < 6; ++is) {
    Law law(points.name, route, names[is]);
    for (const Point& p : points.list) {
      for (const Derivative& d : derivatives) {
        if (d.is != is) continue;
        double u = p.u, v = p.v;
        Vec3<double> closed = partial(p.j, is);
        double condition = p.condition[is];
        if (at_edges) {
          const Coordinate kind = d.along == 0 ? surface.info().u : surface.info().v;
          if (kind != Coordinate::linear && kind != Coordinate::half_turn) continue;
          double& edge = d.along == 0 ? u : v;
          edge = edge < 0.5 ? 0 : 1;
          closed = partial(surface.jet(u, v), is);
        }
        const auto along = [&](double x) {
          return partial(d.along == 0 ? surface.jet(x, v) : surface.jet(u, x), d.of);
        };
        // No stencil reaches farther than a sixteenth of the length: it stays on one smooth piece.
        double stretch = length[d.along];
        for (const double x : breaks[d.along])
          stretch = std::fmin(stretch, 15 * std::fabs(x - (d.along == 0 ? u : v)));
        if (stretch == 0) continue;
        const DerivativeEstimate<> numeric = differentiate(along, d.along == 0 ? u : v, stretch);
        // Four times the estimate: it is no bound, and it cannot see that a formula has rounded more than once. The closed
        // form's own error is 8u (1 + condition).
        const double bound = 4 * numeric.error / points.scale[is] + 8 * unit_roundoff * (1 + condition);
        if (bound <= worst_estimate)
          law.compare(norm(numeric.value - closed) / points.scale[is], bound, u, v);
      }
    }
    checks.push_back(law.result(at_edges
                                    ? "neither coordinate along which it is differentiated has an edge"
                                    : "the route's own error estimate exceeds 1e-6 of the scale everywhere"));
  }
}

constexpr std::array<std::string_view, 4> central_names{"central2", "central4", "central6", "central8"};

template <int order>
void check_central(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  compare_numeric(
      surface, points, central_names[order / 2 - 1],
      [](const auto& f, double x, double length) {
        return central_difference<order>(f, x, central_step<order>(length));
      },
      false, checks);
}

void check_one_sided(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  compare_numeric(
      surface, points, "one_sided8",
      [](const auto& f, double x, double length) {
        const double h = one_sided_step<8>(length);
        return one_sided_difference<8>(f, x, x < 0.5 ? h : -h);
      },
      true, checks);
}

void check_ridders(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  compare_numeric(
      surface, points, "ridders",
      [](const auto& f, double x, double length) { return ridders(f, x, length / 16); }, false, checks);
}

// ---- forms, routes to curvature ---------------------------------------------------------------------------------

// What a point knows for the laws of curvature, and the sizes of the terms that rounding is relative to.
struct Curved {
  Curvature<double> c;
  ShapeOperator<double> s;
  double a, m, cc;  // bounds of the sizes of the terms in the shape operator's entries
  double condition;

  explicit Curved(const Point& p) : c(curvature(p.j, p.f)), s(shape_operator(p.j, p.f)) {
    const double e = std::fabs(s.e), g = std::fabs(s.g), slant = 1 + std::fabs(s.f / s.g);
    a = norm(p.j.d2pdu2) / e / e;
    m = (norm(p.j.d2pduv) / e + std::fabs(s.f) * a) / g;
    cc = (norm(p.j.d2pdv2) / g + std::fabs(s.f) * (a * std::fabs(s.f / s.g) + 2 * m)) / g;
    condition = slant * (1 + *std::max_element(p.condition.begin(), p.condition.end()));
  }
  // Each entry is a quotient of dot products of partials, within 8u (1 + condition) each; the frame adds as much.
  double gaussian_error() const { return 64 * unit_roundoff * condition * (a * cc + m * m); }
  double mean_error() const { return 64 * unit_roundoff * condition * (a + cc); }
};

// A fact or theorem in one number per point: what one side says, what the other says, the error rounding explains.
struct Pair {
  double u, v, one, other, error;
};
// The scale is the largest value, or the given one where that is larger.
Check compared(const Points& points, std::string_view route, std::string_view quantity,
               const std::vector<Pair>& pairs, double scale, std::string_view not_stated = {}) {
  Law law(points.name, route, quantity);
  for (const Pair& p : pairs)
    if (std::isfinite(p.one)) scale = std::fmax(scale, std::fabs(p.one));
  for (const Pair& p : pairs) {
    const double bound = p.error / scale + 8 * unit_roundoff;
    if (bound <= worst_estimate) law.compare(std::fabs(p.one - p.other) / scale, bound, p.u, p.v);
  }
  return law.result(not_stated.empty() ? "rounding would explain an error above 1e-6 everywhere"
                                       : not_stated);
}

bool curvable(const Point& p) {
  return !has(p.f.status, Status::limit_frame | Status::no_frame | Status::overflow);
}

bool states(const AnySurface& surface, std::string_view fact) {
  const auto all = surface.facts();
  return std::find(all.begin(), all.end(), fact) != all.end();
}

void check_implicit(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  Law law(points.name, "implicit", "position");
  if (states(surface, "implicit"))
    for (const Point& p : points.list)
      // implicit() is a length: position and equation each err by a few roundings of the largest length.
      law.compare(std::fabs(*surface.implicit(p.j.position)) / points.scale[0],
                  16 * unit_roundoff * (1 + p.condition[0]), p.u, p.v);
  checks.push_back(law.result("the surface states no implicit equation"));
}

void check_second_formula(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  Law law(points.name, "second_formula", "position");
  if (states(surface, "position_again"))
    for (const Point& p : points.list)
      law.compare(norm(*surface.position_again(p.u, p.v) - p.j.position) / points.scale[0],
                  16 * unit_roundoff * (1 + p.condition[0]), p.u, p.v);
  checks.push_back(law.result("the surface states no second formula of its position"));
}

void check_curvature(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  const double size = points.scale[0];
  std::vector<Pair> gaussian, mean;
  const bool states_gaussian = states(surface, "gaussian_curvature"),
             states_mean = states(surface, "mean_curvature");
  for (const Point& p : points.list) {
    if (!curvable(p)) continue;
    const Curved k(p);
    if (states_gaussian)
      gaussian.push_back({p.u, p.v, *surface.gaussian_curvature(p.u, p.v), k.c.gaussian, k.gaussian_error()});
    if (states_mean) mean.push_back({p.u, p.v, *surface.mean_curvature(p.u, p.v), k.c.mean, k.mean_error()});
  }
  checks.push_back(compared(points, "curvature", "gaussian_curvature", gaussian, 1e-6 / size / size,
                            states_gaussian ? "" : "the surface states no Gaussian curvature"));
  checks.push_back(compared(points, "curvature", "mean_curvature", mean, 1e-6 / size,
                            states_mean ? "" : "the surface states no mean curvature"));
}

// K from E, F, G and their derivatives alone (Brioschi's formula), by nested duals of dpdu and dpdv.
void check_gauss(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  std::vector<Pair> pairs;
  for (const Point& p : points.list) {
    if (!curvable(p)) continue;
    using N = NestedDualUV;
    const Jet2<N> j =
        surface.jet(N::variable(DualUV::variable(p.u, 0), 0), N::variable(DualUV::variable(p.v, 1), 1));
    const auto metric = [](const Vec3<N>& a, const Vec3<N>& b) { return dot(a, b); };
    const N nE = metric(j.dpdu, j.dpdu), nF = metric(j.dpdu, j.dpdv), nG = metric(j.dpdv, j.dpdv);
    const auto first = [](const N& x, std::size_t i) { return x.value.derivative[i]; };
    const auto second = [](const N& x, std::size_t i, std::size_t k) {
      return x.derivative[i].derivative[k];
    };
    const double E = nE.value.value, F = nF.value.value, G = nG.value.value, area2 = E * G - F * F;
    const double corner = -second(nE, 1, 1) / 2 + second(nF, 0, 1) - second(nG, 0, 0) / 2;
    using Matrix = std::array<std::array<double, 3>, 3>;
    const auto determinant = [](const Matrix& x, double sign) {
      return x[0][0] * (x[1][1] * x[2][2] + sign * x[1][2] * x[2][1]) +
             sign * x[0][1] * (x[1][0] * x[2][2] + sign * x[1][2] * x[2][0]) +
             x[0][2] * (x[1][0] * x[2][1] + sign * x[1][1] * x[2][0]);
    };
    const Matrix one{{{corner, first(nE, 0) / 2, first(nF, 0) - first(nE, 1) / 2},
                      {first(nF, 1) - first(nG, 0) / 2, E, F},
                      {first(nG, 1) / 2, F, G}}};
    const Matrix other{
        {{0, first(nE, 1) / 2, first(nG, 0) / 2}, {first(nE, 1) / 2, E, F}, {first(nG, 0) / 2, F, G}}};
    // The sizes of what was added up in each entry, by the norms of the vectors.
    const auto size = [](const Vec3<N>& x) { return norm(value(value(x))); };
    const double u = size(j.dpdu), v = size(j.dpdv), uu = size(j.d2pdu2), uv = size(j.d2pduv),
                 vv = size(j.d2pdv2);
    const double uuv = norm(value(derivative(j.d2pduv, 0))), uvv = norm(value(derivative(j.d2pduv, 1)));
    const double corner_size = 2 * uv * uv + 2 * u * uvv + 2 * v * uuv + uu * vv;
    const Matrix size_one{{{corner_size, u * uu, 2 * u * uv + v * uu},
                           {2 * v * uv + u * vv, u * u, u * v},
                           {v * vv, u * v, v * v}}};
    const Matrix size_other{{{0, u * uv, v * uv}, {u * uv, u * u, u * v}, {v * uv, u * v, v * v}}};
    const double K = (determinant(one, -1) - determinant(other, -1)) / area2 / area2;
    const Curved k(p);
    const double error = 32 * unit_roundoff * k.condition *
                         ((determinant(size_one, 1) + determinant(size_other, 1)) / area2 / area2 +
                          std::fabs(K) * u * u * v * v / area2);
    pairs.push_back({p.u, p.v, k.c.gaussian, K, error + k.gaussian_error()});
  }
  checks.push_back(
      compared(points, "gauss", "gaussian_curvature", pairs, 1e-6 / points.scale[0] / points.scale[0]));
}

// L_v - M_u = L Γ^u_uv + M (Γ^v_uv - Γ^u_uu) - N Γ^v_uu,   M_v - N_u = L Γ^u_vv + M (Γ^v_vv - Γ^u_uv) - N Γ^v_uv
void check_codazzi(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  std::array<std::vector<Pair>, 2> pairs;
  for (const Point& p : points.list) {
    if (!curvable(p)) continue;
    const Jet2<DualUV> j = surface.jet(DualUV::variable(p.u, 0), DualUV::variable(p.v, 1));
    const Vec3<DualUV> n = unit(cross(j.dpdu, j.dpdv));
    const DualUV L = dot(n, j.d2pdu2), M = dot(n, j.d2pduv), N = dot(n, j.d2pdv2);
    const auto [gu, gv] = christoffel(p.j, p.f);
    const std::array<double, 2> left{L.derivative[1] - M.derivative[0], M.derivative[1] - N.derivative[0]};
    const std::array<double, 2> right{L.value * gu[1] + M.value * (gv[1] - gu[0]) - N.value * gv[0],
                                      L.value * gu[2] + M.value * (gv[2] - gu[1]) - N.value * gv[1]};
    // Sizes: n' is at most |second partials| / |first partials| over the sine of their angle.
    const double u = norm(p.j.dpdu), v = norm(p.j.dpdv), uu = norm(p.j.d2pdu2), uv = norm(p.j.d2pduv),
                 vv = norm(p.j.d2pdv2), sine = norm(cross(unit(p.j.dpdu), unit(p.j.dpdv)));
    const double nu = (uu / u + uv / v) / sine, nv = (uv / u + vv / v) / sine;
    const double uuv = norm(derivative(j.d2pduv, 0)), uvv = norm(derivative(j.d2pduv, 1));
    const Curved k(p);
    const std::array<double, 2> sizes{
        2 * uuv + nv * uu + nu * uv +
            (uu * (uv / u + uv / v) + uv * (uv / v + uv / u + uu / u + uu / v) + vv * (uu / v + uu / u)) /
                sine,
        2 * uvv + nv * uv + nu * vv +
            (uu * (vv / u + vv / v) + uv * (vv / v + vv / u + uv / u + uv / v) + vv * (uv / v + uv / u)) /
                sine};
    for (std::size_t i = 0; i < 2; ++i)
      pairs[i].push_back({p.u, p.v, left[i], right[i], 64 * unit_roundoff * k.condition * sizes[i] / sine});
  }
  // Where both sides vanish identically the scale is that of the second form.
  const double least = std::fmax(points.scale[3], points.scale[5]);
  checks.push_back(compared(points, "codazzi", "dL/dv - dM/du", pairs[0], least));
  checks.push_back(compared(points, "codazzi", "dM/dv - dN/du", pairs[1], least));
}

// ∫ K dA by the trapezoidal rule along periodic coordinates and Gauss-Legendre along the others, twice as fine until it
// no longer changes.
void check_gauss_bonnet(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  Law law(points.name, "gauss_bonnet", "gaussian_curvature");
  const SurfaceInfo& info = surface.info();
  const bool inside_out = std::any_of(points.list.begin(), points.list.end(), [](const Point& p) {
    return has(p.f.status, Status::self_intersecting);
  });
  if (!info.euler_characteristic || inside_out) {
    checks.push_back(law.result(info.euler_characteristic ? "the surface passes through its own inside"
                                                          : "the surface is not closed and smooth"));
    return;
  }
  const auto nodes = [](Coordinate kind, int n) {
    std::vector<std::pair<double, double>> result;  // x, weight
    if (kind == Coordinate::turn || kind == Coordinate::twisted_turn) {
      for (int i = 0; i < n; ++i) result.emplace_back((i + 0.5) / n, 1.0 / n);
      return result;
    }
    for (int i = 0; i < n; ++i) {  // zeros of the Legendre polynomial by Newton's method
      double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
      for (int step = 0; step < 100; ++step) {
        double p0 = 1, p1 = x;
        for (int k = 2; k <= n; ++k) {
          const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
          p0 = p1;
          p1 = p2;
        }
        slope = n * (x * p1 - p0) / (x * x - 1);
        const double dx = p1 / slope;
        x -= dx;
        if (std::fabs(dx) < 1e-15) break;
      }
      result.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
    }
    return result;
  };
  const double expected = 2 * std::numbers::pi * *info.euler_characteristic;
  double total = infinity;
  for (int n = 64; n <= 2048; n *= 2) {
    double sum = 0, lost = 0;  // Kahan's compensated summation
    for (const auto& [u, wu] : nodes(info.u, n))
      for (const auto& [v, wv] : nodes(info.v, n)) {
        const Jet2<double> j = surface.jet(u, v);
        const Frame<double> f = surface.frame(u, v);
        const ShapeOperator<double> s = shape_operator(j, f);
        const double term = wu * wv * (s.a * s.c - s.m * s.m) * area_element(s) - lost, next = sum + term;
        lost = (next - sum) - term;
        sum = next;
      }
    const bool settled = std::fabs(sum - total) < 1e-12;
    total = sum;
    if (settled) break;
  }
  // 1e-10 as the project asks, relative to a sphere's 4π.
  law.compare(std::fabs(total - expected) / (4 * std::numbers::pi), 1e-10 / (4 * std::numbers::pi), 0, 0);
  checks.push_back(law.result());
}

// P(u + k, v) = P(u, v) for a turn, P(u + 1, v) = P(u, 1 - v) and n(u + 1, v) = -n(u, 1 - v) for a twisted one, bit for
// bit where u + k is exact.
void check_periodicity(const AnySurface& surface, const Points& points, std::vector<Check>& checks) {
  const SurfaceInfo& info = surface.info();
  // What stands on one side of a one-sided surface (its offset) comes back after two turns, without a twist.
  const bool one_sided = info.u == Coordinate::twisted_turn, twisted = one_sided && !info.own_orientation;
  const double turns = one_sided && !twisted ? 2 : 1;
  const bool periodic_u = info.u == Coordinate::turn || one_sided, periodic_v = info.v == Coordinate::turn;
  if (!periodic_u && !periodic_v) {
    checks.push_back(Law(points.name, "periodicity", "position").result("neither coordinate is periodic"));
    return;
  }
  Law position(points.name, "periodicity", "position"), normal(points.name, "periodicity", "normal");
  for (const Point& p : points.list) {
    const double u = std::ldexp(std::floor(std::ldexp(p.u, 30)), -30),
                 v = std::ldexp(std::floor(std::ldexp(p.v, 30)), -30);
    const Vec3<double> at = surface.jet(u, v).position, n = surface.frame(u, v).n;
    for (const double k : {1.0, -3.0, 0x1p20 - 1}) {  // odd, to show the twist
      const double there_u = periodic_u ? u + turns * k : u, moved_v = periodic_v && !twisted ? v - k : v,
                   there_v = twisted ? 1 - moved_v : moved_v;
      const Vec3<double> m = surface.frame(there_u, there_v).n;
      position.compare(at == surface.jet(there_u, there_v).position ? 0 : 1, 0, u, v);
      normal.compare(n == (twisted ? -m : m) || has(surface.frame(u, v).status, Status::no_frame) ? 0 : 1, 0,
                     u, v);
    }
  }
  checks.push_back(position.result());
  checks.push_back(normal.result());
}

// ---- many digits -----------------------------------------------------------------------------------------------

std::vector<double> special_coordinates() {
  std::vector<double> result{0, 1, 1e-300, 1e-150, 1e-20, 1e-9};
  for (const double x : {0.125, 0.25, 1.0 / 3, 0.5, 2.0 / 3, 0.75, 1.0})
    for (const double y : {std::nextafter(x, 0.0), x, std::nextafter(x, 1.0)}) result.push_back(y);
  return result;
}

// Random parameters within the magnitudes for which the surface is proven: half of the time of related sizes.
AnySurface random_parameters(const AnySurface& surface, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto log_uniform = [&](double from, double to) {
    return std::exp(std::log(from) + uniform(random) * (std::log(to) - std::log(from)));
  };
  const std::vector<ParameterValue> parameters = surface.parameters();
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const bool related = random() % 2 == 0;
    std::vector<double> values;
    double smallest = 1e-150, largest = 1e150;
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
double largest_difference(const Vec3<S>& a, const Vec3<ManyDigits>& b) {
  const Vec3<double> d =
      rounded(Vec3<ManyDigits>{ManyDigits(a.x) - b.x, ManyDigits(a.y) - b.y, ManyDigits(a.z) - b.z});
  const double largest = std::fmax(std::fabs(d.x), std::fmax(std::fabs(d.y), std::fabs(d.z)));
  return std::isnan(d.x + d.y + d.z) ? infinity : largest;
}

struct ExactFrame {
  Vec3<ManyDigits> t, b, n;
};
ExactFrame exact_frame(const Jet2<ManyDigits>& j, double handedness) {
  const Vec3<ManyDigits> t = unit(j.dpdu), n = ManyDigits(handedness) * unit(cross(j.dpdu, j.dpdv));
  return {t, cross(n, t), n};
}

double difference(const ExactFrame& a, const ExactFrame& b) {
  return norm(rounded(a.t - b.t)) + norm(rounded(a.n - b.n));
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
const ManyDigits& tiny() {
  static const ManyDigits value = [] {
    ManyDigits product(1.0);
    for (int i = 0; i < 5; ++i) product = product * ManyDigits(1e-300);
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
        orthonormality_(name, route_, "orthonormality") {
    for (const std::string_view quantity : names) partials_.emplace_back(name, route_, quantity);
  }

  // \param u, v numbers of type S
  // The scale of a partial is its largest magnitude over the first `random_points`, or its own where that is larger.
  void compare(const AnySurface& surface, const std::vector<Vec2<double>>& uvs, std::size_t random_points,
               const std::string& of) {
    struct At {
      Vec2<double> uv;
      Sample<S> sample;
      Jet2<ManyDigits> exact;
      std::vector<Jet2<ManyDigits>> neighbours;
    };
    const std::vector<ParameterValue> parameters = surface.parameters();
    std::array<double, 6> common_scale{};
    std::vector<At> all;
    for (const Vec2<double>& uv : uvs) {
      const Inputs inputs(uv.x, uv.y, parameters);
      At at{uv, evaluate(surface, uv), many_digit_jet(surface, inputs), {}};
      for_each_neighbour(surface, inputs,
                         [&](const Jet2<ManyDigits>& moved) { at.neighbours.push_back(moved); });
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
        for (const Jet2<ManyDigits>& moved : at.neighbours)
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
      compare_frame(surface, at.uv, at.sample, at.exact, at.neighbours, scale, condition, of);
    }
  }

  void results(std::vector<Check>& checks) const {
    for (const Law& law : partials_) checks.push_back(law.result("it leaves the range of the number type"));
    for (const Law* law : {&tangent_, &bitangent_, &normal_, &orthonormality_})
      checks.push_back(law->result("no point has a frame in the range of the number type"));
  }

 private:
  static Sample<S> evaluate(const AnySurface& surface, const Vec2<double>& uv) {
    if constexpr (std::same_as<S, float>)
      return surface.sample_in_float(static_cast<float>(uv.x), static_cast<float>(uv.y));
    else
      return surface.sample(uv.x, uv.y);
  }

  void compare_frame(const AnySurface& surface, const Vec2<double>& uv, const Sample<S>& sample,
                     const Jet2<ManyDigits>& exact, const std::vector<Jet2<ManyDigits>>& neighbours,
                     const std::array<double, 6>& scale, const std::array<double, 6>& partial_condition,
                     const std::string& of) {
    const Frame<S>& f = sample.frame;
    const double u = uv.x, v = uv.y;
    if (has(f.status, Status::no_frame)) return;
    const SurfaceInfo& info = surface.info();
    const auto error = [&](const ExactFrame& e) {
      return std::array{largest_difference(f.t, e.t), largest_difference(f.b, e.b),
                        largest_difference(f.n, e.n)};
    };
    std::array<double, 3> errors{infinity, infinity, infinity};
    double condition = 0;
    if (has(f.status, Status::limit_frame)) {
      // The limit along the given u (or v): from inside the domain, from either side of a point within it. At zero a
      // distance may be as small as one likes; elsewhere 40 digits leave 1e-18, which is too coarse for parameters of
      // very different sizes. Where two such distances still give different frames, the limit is approached as by a
      // root, and no distance shows it.
      bool shown = false;
      for (const double side : {1.0, -1.0})
        for (const bool along_v : {true, false}) {
          if (!has(f.status,
                   along_v ? Status::dpdu_zero | Status::parallel : Status::dpdv_zero | Status::parallel))
            continue;
          const double x = along_v ? v : u;
          const Coordinate kind = along_v ? info.v : info.u;
          const bool bounded = kind == Coordinate::linear || kind == Coordinate::half_turn;
          if ((bounded && ((x == 0 && side < 0) || (x == 1 && side > 0))) ||
              (x != 0 && spread(surface) > 1e6))
            continue;
          const ManyDigits far = x == 0 ? tiny() : ManyDigits(1e-18), near = far * ManyDigits(1e-3);
          const auto approach = [&](const ManyDigits& distance) {
            Inputs inputs(u, v, surface.parameters());
            ManyDigits& moved = along_v ? inputs.v : inputs.u;
            moved = moved + ManyDigits(side) * distance;
            return inputs;
          };
          const Inputs at = approach(near);
          const ExactFrame exact_near = exact_frame(many_digit_jet(surface, at), f.handedness);
          const ExactFrame exact_far = exact_frame(many_digit_jet(surface, approach(far)), f.handedness);
          if (!(difference(exact_far, exact_near) < roundoff / 2)) continue;
          shown = true;
          const std::array<double, 3> found = error(exact_near);
          if (!(found[0] + found[1] + found[2] < errors[0] + errors[1] + errors[2])) continue;
          errors = found;
          condition = 0;
          for_each_neighbour(surface, at, [&](const Jet2<ManyDigits>& moved) {
            condition += difference(exact_frame(moved, f.handedness), exact_near) / relative_change;
          });
        }
      if (!shown) return;
    } else {
      const ExactFrame e = exact_frame(exact, f.handedness);
      // Where the true partials give no frame, those with their rounding gave an arbitrary one.
      if (!surface.has_closed_frame() && !(norm(rounded(e.t)) > 0 && norm(rounded(e.n)) > 0)) return;
      const double determinant = static_cast<double>(
          dot(cross(unit(exact.dpdu), unit(exact.dpdv)), Vec3<ManyDigits>{f.n.x, f.n.y, f.n.z}));
      // A surface that states its own orientation cannot tell the side where dpdu is within rounding of zero.
      if (info.own_orientation && determinant * f.handedness < 0 &&
          norm(rounded(exact.dpdu)) < 16 * roundoff * (1 + partial_condition[1]) * scale[1])
        return;
      errors = error(e);
      for (const Jet2<ManyDigits>& moved : neighbours)
        condition += difference(exact_frame(moved, f.handedness), e) / relative_change;
    }
    const bool closed = surface.has_closed_frame();
    double frame_bound = info.frame_error * (1 + condition), orthonormality_bound = 8;
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
      orthonormality_bound = 16;
    }
    tangent_.compare(errors[0], frame_bound * roundoff, u, v, of);
    bitangent_.compare(errors[1], frame_bound * roundoff, u, v, of);
    normal_.compare(errors[2], frame_bound * roundoff, u, v, of);
    orthonormality_.compare(deviation_from_orthonormal(f), orthonormality_bound * roundoff, u, v, of);
  }

  std::string_view route_;
  std::vector<Law> partials_;
  Law tangent_, bitangent_, normal_, orthonormality_;
};

// The nearest number that float holds. Through memory: g++ 12 at -O2 drops the conversion there and back from a loop
// over pairs.
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

template <class S>
void check_high_precision(const AnySurface& surface, const CheckOptions& options,
                          std::vector<Check>& checks) {
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

// ---- all of them -----------------------------------------------------------------------------------------------

struct Route {
  std::string_view name;
  void (*run)(const AnySurface&, const Points&, std::vector<Check>&);
};
constexpr std::array routes{Route{"dual", check_dual},
                            Route{"central2", check_central<2>},
                            Route{"central4", check_central<4>},
                            Route{"central6", check_central<6>},
                            Route{"central8", check_central<8>},
                            Route{"one_sided8", check_one_sided},
                            Route{"ridders", check_ridders},
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
    list.insert(list.end(), {"high_precision", "high_precision_float"});
    return list;
  }();
  return all;
}

std::vector<Check> check_surface(const AnySurface& surface, const CheckOptions& options) {
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
    const Points points(surface, options);
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
  return checks;
}

std::string broken_laws(const AnySurface& surface, const CheckOptions& options) {
  std::string text;
  for (const Check& c : check_surface(surface, options))
    if (!c.passed)
      text += std::string(c.surface) + ": " + std::string(c.route) + " of " + std::string(c.quantity) +
              " is off by " + shortest(c.max_error) + ", permitted is " + shortest(c.bound) +
              ", worst at u = " + shortest(c.worst_u) + ", v = " + shortest(c.worst_v) + "\n";
  return text;
}

}  // namespace darboux
