// Forms, shape operator, Christoffel symbols, curvature and Darboux frame: against closed forms of do Carmo, and over the
// whole catalogue against derivatives taken in 40 digits.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include <darboux/adaptors.h>
#include <darboux/any_surface.h>
#include <darboux/differentiate.h>
#include <darboux/evaluate.h>
#include <darboux/forms.h>

#include "every_surface.h"

namespace darboux::test {
namespace {

constexpr double roundoff = 0x1p-53;
constexpr int points = 5'000;

template <class X>
Curvature<double> curvature_at(const X& surface, double u, double v) {
  return curvature(jet(surface, u, v), frame(surface, u, v));
}

TEST(FundamentalForms, AreThoseOfTheClosedForms) {
  const Torus torus{2.0, 0.5};
  const double u = 0.15, v = 0.3, tau = two_pi<double>(), rho = 2 + 0.5 * sincos_turns(v).cos;
  const Jet2<double> j = jet(torus, u, v);
  const FirstForm<double> I = first_form(j);
  const SecondForm<double> II = second_form(j, frame(torus, u, v).n);
  // A few roundings of terms of the size of the result or of E.
  const double size = tau * tau * rho * rho;
  EXPECT_NEAR(I.E, size, 8 * roundoff * size);
  EXPECT_NEAR(I.F, 0, 8 * roundoff * size);
  EXPECT_NEAR(I.G, tau * tau * 0.25, 8 * roundoff * size);
  EXPECT_NEAR(II.L, -tau * tau * rho * sincos_turns(v).cos, 8 * roundoff * size);
  EXPECT_NEAR(II.M, 0, 8 * roundoff * size);
  EXPECT_NEAR(II.N, -tau * tau * 0.5, 8 * roundoff * size);
  EXPECT_NEAR(gaussian_curvature(I, II), torus.gaussian_curvature(sincos_turns(u), sincos_turns(v)),
              32 * roundoff);
  EXPECT_NEAR(mean_curvature(I, II), -(2 + 2 * 0.5 * sincos_turns(v).cos) / (2 * 0.5 * rho), 32 * roundoff);
}

// H = κ1 = κ2 = -1/r with n outward, K = 1/r², every point umbilic. At radii whose square overflows or
// underflows the κ stay right.
TEST(Curvature, OfTheSphere) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < points; ++i) {
    const double r = random.log_uniform(1e-150, 1e150);
    const Curvature<double> c = curvature_at(Sphere{r}, random.uniform(), random.uniform(1e-6, 1));
    for (const double kappa : {c.principal[0], c.principal[1], c.mean})
      worst = std::fmax(worst, std::fabs(kappa * r + 1));
    EXPECT_LE(std::fabs(c.gaussian * r * r - 1), 64 * roundoff);
    EXPECT_TRUE(has(c.status, Status::umbilic));
  }
  // L/e² from a jet of 8u: some 8 + 2·4 roundings, and as many in m.
  EXPECT_LE(worst, 32 * roundoff);
}

TEST(Curvature, OfTheTorus) {
  Random random(2);
  for (int i = 0; i < points; ++i) {
    const double r = random.log_uniform(1e-150, 1e150), R = r * random.uniform(1.5, 10);
    const double u = random.uniform(), v = random.uniform();
    const Torus torus{R, r};
    const Frame<double> f = frame(torus, u, v);
    const Curvature<double> c = curvature_at(torus, u, v);
    const double cosine = sincos_turns(v).cos, rho = R + r * cosine;
    // Along t the circle of latitude, along b the tube. As above, relative to the larger, 1/r <= 2/(R - r)
    // ...
    const double bound = 32 * roundoff / r;
    EXPECT_NEAR(c.principal[0], -cosine / rho, bound);
    EXPECT_NEAR(c.principal[1], -1 / r, bound);
    EXPECT_NEAR(c.mean, -(R + 2 * r * cosine) / (2 * r * rho), bound);
    EXPECT_NEAR(c.gaussian * r * r, cosine * r / rho, 64 * roundoff);
    // κ1 - κ2 = R/(r ρ) is at least 0.6/r here: the directions err by the κ's error over that.
    EXPECT_LE(norm(c.directions[0] - f.t), 2 * 32 * roundoff);
    EXPECT_LE(norm(c.directions[1] - f.b), 2 * 32 * roundoff);
    EXPECT_FALSE(has(c.status, Status::umbilic));
  }
}

TEST(Curvature, OfTheCylinder) {
  Random random(3);
  for (int i = 0; i < points; ++i) {
    const double r = random.log_uniform(1e-150, 1e150), h = random.log_uniform(1e-150, 1e150);
    const Cylinder cylinder{r, h};
    const double u = random.uniform(), v = random.uniform();
    const Curvature<double> c = curvature_at(cylinder, u, v);
    const Frame<double> f = frame(cylinder, u, v);
    EXPECT_EQ(c.principal[0], 0);
    EXPECT_NEAR(c.principal[1] * r, -1, 32 * roundoff);
    EXPECT_NEAR(c.mean * r, -0.5, 16 * roundoff);
    EXPECT_EQ(c.gaussian, 0);
    EXPECT_LE(norm(c.directions[0] - f.b), 4 * roundoff);
    EXPECT_LE(norm(c.directions[1] - -f.t), 4 * roundoff);
  }
}

// ---- the whole catalogue ---------------------------------------------------------------------------------------

// The forms take any scalar. In 40 digits an identity holds to 1e-20 of its terms or it is wrong: rounding and truncation of
// the differences are below that at every point whose conditions are below 1e10.
using M = ManyDigits;
constexpr double identity = 1e-20;

double size(const Vec3<M>& a) {
  return norm(Vec3<double>{static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)});
}
double size(const M& a) {
  return std::fabs(static_cast<double>(a));
}

Frame<M> frame_of(const Jet2<M>& j) {
  const Vec3<M> t = unit(j.dpdu), n = unit(cross(j.dpdu, j.dpdv));
  return {t, cross(n, t), n};
}

// f'(x) and f''(x) by central differences of order 8, steps of 1e-6: truncated at (2π 1e-6)^8, rounded at 1e-33 and 1e-27.
constexpr double step = 1e-6;
template <class F>
auto first_derivative(F f, const M& x) {
  const M h(step);
  const auto pair = [&](double k) { return f(x + M(k) * h) - f(x - M(k) * h); };
  return (M(4.0) / M(5.0) * pair(1) - M(1.0) / M(5.0) * pair(2) + M(4.0) / M(105.0) * pair(3) -
          M(1.0) / M(280.0) * pair(4)) /
         h;
}
template <class F>
auto second_derivative(F f, const M& x) {
  const M h(step);
  const auto pair = [&](double k) { return f(x + M(k) * h) + f(x - M(k) * h); };
  return (M(8.0) / M(5.0) * pair(1) - M(1.0) / M(5.0) * pair(2) + M(8.0) / M(315.0) * pair(3) -
          M(1.0) / M(560.0) * pair(4) - M(205.0) / M(72.0) * f(x)) /
         (h * h);
}

// The sizes of the terms in the shape operator's entries, from the lengths of the partials.
struct TermSizes {
  double a, m, c;
  explicit TermSizes(const Jet2<double>& j, const Frame<double>& f) {
    const double e = std::fabs(dot(j.dpdu, f.t)), g = std::fabs(dot(j.dpdv, f.b)), along = norm(j.dpdv);
    a = norm(j.d2pdu2) / e / e;
    m = (norm(j.d2pduv) / e + along * a) / g;
    c = (norm(j.d2pdv2) + 2 * along * m + along * along / g * a) / g;
  }
  double largest() const { return std::fmax(a, std::fmax(m, c)); }
};

// The largest relative error of what the forms are given in double: the partials (those that vanish identically are exact)
// and the frame.
double input_error(const Jet2<double>& j, const Frame<double>& f, const Jet2<M>& exact) {
  const auto wide = [](const Vec3<double>& a) { return Vec3<M>{a.x, a.y, a.z}; };
  double worst = 0;
  for (const auto& [is, should] : {std::pair{j.dpdu, exact.dpdu},
                                   {j.dpdv, exact.dpdv},
                                   {j.d2pdu2, exact.d2pdu2},
                                   {j.d2pduv, exact.d2pduv},
                                   {j.d2pdv2, exact.d2pdv2}})
    if (size(should) > 0) worst = std::fmax(worst, size(wide(is) - should) / size(should));
  const Frame<M> e = frame_of(exact);
  return std::fmax(worst, size(wide(f.t) - e.t) + size(wide(f.n) - e.n));
}

class Forms : public ::testing::TestWithParam<AnySurface> {
 protected:
  const AnySurface& surface() const { return GetParam(); }
  Jet2<M> jet(const M& u, const M& v) const { return surface().jet(u, v); }
  // Points within the chart: what singular points do is tested by themselves.
  template <class F>
  void for_points(std::uint64_t seed, int n, F f) const {
    Random random(seed);
    for (int i = 0; i < n; ++i) {
      const double u = random.uniform(0.02, 0.98), v = random.uniform(0.05, 0.95);
      f(u, v, random);
      if (HasFailure()) {
        ADD_FAILURE() << surface().info().name << " at u = " << u << ", v = " << v;
        return;
      }
    }
  }
};
std::string test_name(const ::testing::TestParamInfo<AnySurface>& info) {
  std::string name(info.param.info().name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Catalogue, Forms, ::testing::ValuesIn(all_surfaces()), test_name);

// S is the one operator with S dpdu · dpdu = L, S dpdu · dpdv = M, S dpdv · dpdv = N; K is its determinant, H half its trace.
TEST_P(Forms, ShapeOperatorIsThatOfTheSecondForm) {
  for_points(1, 20, [&](double u, double v, Random&) {
    const Jet2<M> j = jet(u, v);
    const Frame<M> f = frame_of(j);
    const ShapeOperator<M> s = shape_operator(j, f);
    const auto apply = [&](const Vec3<M>& x) {
      const M t = dot(x, f.t), b = dot(x, f.b);
      return (s.a * t + s.m * b) * f.t + (s.m * t + s.c * b) * f.b;
    };
    const FirstForm<M> I = first_form(j);
    const SecondForm<M> II = second_form(j, f.n);
    const double seconds = size(j.d2pdu2) + size(j.d2pduv) + size(j.d2pdv2);
    EXPECT_LE(size(dot(apply(j.dpdu), j.dpdu) - II.L), identity * seconds);
    EXPECT_LE(size(dot(apply(j.dpdu), j.dpdv) - II.M), identity * seconds);
    EXPECT_LE(size(dot(apply(j.dpdv), j.dpdv) - II.N), identity * seconds);
    const double k = size(s.a) + size(s.m) + size(s.c);
    EXPECT_LE(size(gaussian_curvature(I, II) - (s.a * s.c - s.m * s.m)), identity * (1 + k * k));
    EXPECT_LE(size(mean_curvature(I, II) - (s.a + s.c) / M(2.0)), identity * (1 + k));
    EXPECT_LE(size(s.e * f.t - j.dpdu) + size(s.f * f.t + s.g * f.b - j.dpdv),
              identity * (size(j.dpdu) + size(j.dpdv)));
    EXPECT_LE(size(area_element(s) * area_element(s) - (I.E * I.G - I.F * I.F)), identity * size(I.E * I.G));
  });
}

TEST_P(Forms, NormalDerivativesAreThoseOfTheNormal) {
  for_points(2, 10, [&](double u, double v, Random&) {
    const Jet2<M> j = jet(u, v);
    const Frame<M> f = frame_of(j);
    const NormalDerivatives<M> n = normal_derivatives(shape_operator(j, f), f);
    const Vec3<M> du = first_derivative([&](const M&x) { return frame_of(jet(x, v)).n; }, u),
                  dv = first_derivative([&](const M&x) { return frame_of(jet(u, x)).n; }, v);
    const double terms = size(j.d2pdu2) / size(j.dpdu) + size(j.d2pduv) / size(j.dpdu) +
                         size(j.d2pduv) / size(j.dpdv) + size(j.d2pdv2) / size(j.dpdv);
    EXPECT_LE(size(n.dndu - du), identity * terms);
    EXPECT_LE(size(n.dndv - dv), identity * terms);
  });
}

// The classical formulas, from E, F, G and their derivatives alone. [doCarmo2016, sec. 4-3]
TEST_P(Forms, ChristoffelSymbolsAreThoseOfTheMetric) {
  for_points(3, 10, [&](double u, double v, Random&) {
    const Jet2<M> j = jet(u, v);
    const auto [gu, gv] = christoffel(j, frame_of(j));
    const auto metric = [](const Jet2<M>& at) {
      const FirstForm<M> I = first_form(at);
      return Vec3<M>{I.E, I.F, I.G};
    };
    const auto [E, F, G] = metric(j);
    const auto [Eu, Fu, Gu] = first_derivative([&](const M& x) { return metric(jet(x, v)); }, u);
    const auto [Ev, Fv, Gv] = first_derivative([&](const M& x) { return metric(jet(u, x)); }, v);
    const M two(2.0), W = two * (E * G - F * F);
    const std::array<M, 3> on_u{(G * Eu - two * F * Fu + F * Ev) / W, (G * Ev - F * Gu) / W,
                                (two * G * Fv - G * Gu - F * Gv) / W},
        on_v{(two * E * Fu - E * Ev - F * Eu) / W, (E * Gu - F * Ev) / W,
             (E * Gv - two * F * Fv + F * Gu) / W};
    const double seconds = size(j.d2pdu2) + size(j.d2pduv) + size(j.d2pdv2),
                 firsts = 1 / size(j.dpdu) + 1 / size(j.dpdv);
    const double sine = size(cross(unit(j.dpdu), unit(j.dpdv)));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(size(gu[k] - on_u[k]), identity * seconds * firsts / sine / sine) << k;
      EXPECT_LE(size(gv[k] - on_v[k]), identity * seconds * firsts / sine / sine) << k;
    }
  });
}

// In double: each entry is a handful of roundings of its terms, for the inputs as they are.
TEST_P(Forms, RoundOnlyAHandfulOfTimes) {
  for_points(4, 200, [&](double u, double v, Random&) {
    const Jet2<double> j = surface().jet(u, v);
    const Frame<double> f = surface().frame(u, v);
    const auto wide = [](const Vec3<double>& a) { return Vec3<M>{a.x, a.y, a.z}; };
    const Jet2<M> same{wide(j.position), wide(j.dpdu),   wide(j.dpdv),
                       wide(j.d2pdu2),   wide(j.d2pduv), wide(j.d2pdv2)};
    const Frame<M> same_frame{wide(f.t), wide(f.b), wide(f.n)};
    const TermSizes terms(j, f);
    const ShapeOperator<double> s = shape_operator(j, f);
    const ShapeOperator<M> exact = shape_operator(same, same_frame);
    // 5 roundings a dot product and 2 divisions, through at most 3 levels of terms.
    EXPECT_LE(size(M(s.a) - exact.a), 16 * roundoff * terms.a);
    EXPECT_LE(size(M(s.m) - exact.m), 32 * roundoff * (terms.m + terms.a));
    EXPECT_LE(size(M(s.c) - exact.c), 64 * roundoff * (terms.c + terms.m + terms.a));
    const Christoffel<double> g = christoffel(j, f);
    const Christoffel<M> exact_g = christoffel(same, same_frame);
    const double e = std::fabs(s.e), across = std::fabs(s.g), along = norm(j.dpdv);
    const std::array<double, 3> second{norm(j.d2pdu2), norm(j.d2pduv), norm(j.d2pdv2)};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(size(M(g.v[k]) - exact_g.v[k]), 16 * roundoff * second[k] * along / across / across);
      EXPECT_LE(size(M(g.u[k]) - exact_g.u[k]),
                32 * roundoff * second[k] * along / across * along / across / e);
    }
  });
}

TEST_P(Forms, PrincipalFrameIsOrdered) {
  for_points(5, 1000, [&](double u, double v, Random&) {
    const Frame<double> f = surface().frame(u, v);
    const Curvature<double> c = curvature(surface(), u, v);
    const double k = std::fmax(std::fabs(c.principal[0]), std::fabs(c.principal[1]));
    EXPECT_GE(c.principal[0], c.principal[1]);
    // a, c and m are at most k: both sides are a few roundings of them.
    EXPECT_NEAR(c.gaussian, c.principal[0] * c.principal[1], 16 * roundoff * k * k);
    EXPECT_NEAR(c.mean, (c.principal[0] + c.principal[1]) / 2, 4 * roundoff * k);
    // The frame's own deviation from orthonormality, 16u where it is made from partials, and the roundings of the sum.
    EXPECT_LE(norm(c.directions[1] - cross(f.n, c.directions[0])), 32 * roundoff);
    EXPECT_NEAR(norm(c.directions[0]), 1, 32 * roundoff);
    EXPECT_GE(dot(c.directions[0], f.t), -16 * roundoff);
  });
}

// Meusnier and Euler: a curve through the point bends in the direction of n by κ1 cos² + κ2 sin², whatever the curve. Its
// second derivative comes from differences of the position: no partials.
TEST_P(Forms, CurvesBendByEulersFormula) {
  for_points(6, 20, [&](double u, double v, Random& random) {
    const double du = random.uniform(-1, 1), dv = random.uniform(-1, 1), bend = random.uniform(-1, 1);
    const auto curve = [&](const M& s) {
      return jet(M(u) + s * M(du) + s * s * M(bend), M(v) + s * M(dv)).position;
    };
    const Vec3<M> velocity = first_derivative(curve, M(0.0)), acceleration = second_derivative(curve, M(0.0));
    const Jet2<M> exact = jet(u, v);
    const double normal_curvature =
        static_cast<double>(dot(acceleration, frame_of(exact).n) / dot(velocity, velocity));
    const Jet2<double> j = surface().jet(u, v);
    const Frame<double> f = surface().frame(u, v);
    const Curvature<double> c = curvature(j, f);
    const Vec3<double> T = unit(du * j.dpdu + dv * j.dpdv);
    const double along = dot(T, c.directions[0]), across = dot(T, c.directions[1]);
    // The inputs' errors enter every factor of the terms, T by its share of the partials.
    const double share =
        (std::fabs(du) * norm(j.dpdu) + std::fabs(dv) * norm(j.dpdv)) / norm(du * j.dpdu + dv * j.dpdv);
    const double bound = 16 * (input_error(j, f, exact) + 8 * roundoff) * share * TermSizes(j, f).largest();
    EXPECT_NEAR(normal_curvature, c.principal[0] * along * along + c.principal[1] * across * across, bound);
  });
}

// Another chart of the same surface, sheared and curved: u = a p + b q + e p q, v = c p + d q. Its partials follow by the
// chain rule; the shape operator, as an operator in space, is the surface's.
TEST_P(Forms, ShapeOperatorDoesNotDependOnTheChart) {
  for_points(7, 50, [&](double u, double v, Random& random) {
    const M a(random.uniform(0.5, 2)), b(random.uniform(-2, 2)), c(random.uniform(-2, 2)),
        d(random.uniform(0.5, 2)), e(random.uniform(-1, 1));
    const M determinant = a * d - b * c;
    if (size(determinant) < 0.25) return;
    const Jet2<M> j = jet(u, v);
    const auto second = [&](const M& u1, const M& v1, const M& u2, const M& v2) {
      return u1 * u2 * j.d2pdu2 + (u1 * v2 + u2 * v1) * j.d2pduv + v1 * v2 * j.d2pdv2;
    };
    const Jet2<M> sheared{.position = j.position,
                          .dpdu = a * j.dpdu + c * j.dpdv,
                          .dpdv = b * j.dpdu + d * j.dpdv,
                          .d2pdu2 = second(a, c, a, c),
                          .d2pduv = second(a, c, b, d) + e * j.dpdu,
                          .d2pdv2 = second(b, d, b, d)};
    const Frame<M> f = frame_of(j);
    Frame<M> g = frame_of(sheared);
    if (determinant < M(0.0)) g.n = -g.n, g.b = -g.b;  // a flipped chart keeps the surface's n
    const auto apply = [](const ShapeOperator<M>& s, const Frame<M>& at, const Vec3<M>& x) {
      const M t = dot(x, at.t), y = dot(x, at.b);
      return (s.a * t + s.m * y) * at.t + (s.m * t + s.c * y) * at.b;
    };
    const ShapeOperator<M> own = shape_operator(j, f), other = shape_operator(sheared, g);
    const double k = size(own.a) + size(own.m) + size(own.c);
    for (const Vec3<M>& x : {f.t, f.b})
      EXPECT_LE(size(apply(own, f, x) - apply(other, g, x)), identity * (1 + k));
  });
}

// T' = κg V + κn n, V' = -κg T + τg n, n' = -κn T - τg V along any curve, by differences along it.
TEST_P(Forms, DarbouxFrameMovesByItsEquations) {
  for_points(8, 20, [&](double u, double v, Random& random) {
    const CurveOnSurface<double> curve{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1),
                                       random.uniform(-1, 1)};
    const auto at = [&](const M& s) {
      const M half = s * s / M(2.0);
      const Jet2<M> j =
          jet(M(u) + s * M(curve.du) + half * M(curve.d2u), M(v) + s * M(curve.dv) + half * M(curve.d2v));
      const Vec3<M> velocity =
          (M(curve.du) + s * M(curve.d2u)) * j.dpdu + (M(curve.dv) + s * M(curve.d2v)) * j.dpdv;
      struct {
        Vec3<M> T, V, n;
        M speed;
      } result{unit(velocity), {}, frame_of(j).n, norm(velocity)};
      result.V = cross(result.n, result.T);
      return result;
    };
    const auto here = at(M(0.0));
    const auto by_arc_length = [&](auto member) {
      const Vec3<M> d = first_derivative([&](const M& s) { return member(at(s)); }, M(0.0)) / here.speed;
      return Vec3<double>{static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z)};
    };
    const Vec3<double> dT = by_arc_length([](const auto&x) { return x.T; }),
                       dV = by_arc_length([](const auto&x) { return x.V; }),
                       dn = by_arc_length([](const auto&x) { return x.n; });
    const Jet2<double> j = surface().jet(u, v);
    const Frame<double> f = surface().frame(u, v);
    const DarbouxFrame<double> d = darboux_frame(j, f, curve);
    const double kn = d.normal_curvature, kg = d.geodesic_curvature, tg = d.geodesic_torsion;
    // As for Euler's formula, and the terms of the geodesic curvature.
    const double speed = norm(curve.du * j.dpdu + curve.dv * j.dpdv), pu = std::fabs(curve.du) / speed,
                 pv = std::fabs(curve.dv) / speed, share = pu * norm(j.dpdu) + pv * norm(j.dpdv);
    const double terms =
        share * TermSizes(j, f).largest() + pu * pu * norm(j.d2pdu2) + 2 * pu * pv * norm(j.d2pduv) +
        pv * pv * norm(j.d2pdv2) +
        (std::fabs(curve.d2u) * norm(j.dpdu) + std::fabs(curve.d2v) * norm(j.dpdv)) / speed / speed;
    const double bound = 16 * (input_error(j, f, jet(u, v)) + 8 * roundoff) * share * terms;
    EXPECT_LE(norm(dT - (kg * d.V + kn * d.n)), bound);
    EXPECT_LE(norm(dV - (tg * d.n - kg * d.T)), bound);
    EXPECT_LE(norm(dn - (-kn * d.T - tg * d.V)), bound);
    EXPECT_LE(norm(d.V - cross(d.n, d.T)), 8 * roundoff);
    EXPECT_EQ(d.n, f.n);
  });
}

// The same equations in double, by the frame as it is given: differences of frame().n.
TEST_P(Forms, NormalDerivativesAreThoseOfTheFrame) {
  int compared = 0;
  for_points(9, 50, [&](double u, double v, Random&) {
    const Jet2<double> j = surface().jet(u, v);
    const Frame<double> f = surface().frame(u, v);
    const NormalDerivatives<double> n = normal_derivatives(shape_operator(j, f), f);
    const auto du = central_difference<6>([&](double x) { return surface().frame(x, v).n; }, u, 0x1p-10),
               dv = central_difference<6>([&](double x) { return surface().frame(u, x).n; }, v, 0x1p-10);
    const double terms = TermSizes(j, f).largest() * (norm(j.dpdu) + norm(j.dpdv));
    const double own = 16 * (input_error(j, f, jet(u, v)) + 8 * roundoff) * terms;
    // Four times the estimate, which is no bound. Where it cannot tell (a stencil across a knot) nothing is asked.
    if (du.error + dv.error > 1e-5 * std::fmax(1, terms)) return;
    ++compared;
    EXPECT_LE(norm(n.dndu - du.value), 4 * du.error + own);
    EXPECT_LE(norm(n.dndv - dv.value), 4 * dv.error + own);
  });
  EXPECT_GE(compared, 25);
}

// And by dual numbers through the closed-form frame, where there is one.
TEST(NormalDerivatives, AreTheDualNumbersOfTheClosedFrame) {
  int surfaces = 0;
  Catalogue::for_each([&](const auto& surface) {
    using X = std::remove_cvref_t<decltype(surface)>;
    if constexpr (HasClosedFrame<X>) {
      ++surfaces;
      Random random(10);
      for (int i = 0; i < 100; ++i) {
        const double u = random.uniform(0.02, 0.98), v = random.uniform(0.05, 0.95);
        const Jet2<double> j = jet(surface, u, v);
        const Frame<double> f = frame(surface, u, v);
        const NormalDerivatives<double> n = normal_derivatives(shape_operator(j, f), f);
        const Vec3<DualUV> dual =
            surface
                .frame(prepare<X::info.u>(DualUV::variable(u, 0)), prepare<X::info.v>(DualUV::variable(v, 1)))
                .n;
        const auto by = [&](std::size_t k) {
          return Vec3<double>{dual.x.derivative[k], dual.y.derivative[k], dual.z.derivative[k]};
        };
        const double bound = 32 * (input_error(j, f, AnySurface(surface).jet(M(u), M(v))) + 8 * roundoff) *
                             TermSizes(j, f).largest() * (norm(j.dpdu) + norm(j.dpdv));
        EXPECT_LE(norm(n.dndu - by(0)), bound) << X::info.name << ' ' << u << ' ' << v;
        EXPECT_LE(norm(n.dndv - by(1)), bound) << X::info.name << ' ' << u << ' ' << v;
      }
    }
  });
  EXPECT_GT(surfaces, 15);
}

// ---- curves with known curvatures ------------------------------------------------------------------------------

// A circle of latitude, eastwards: V points north, and north of the equator the curve turns to it. κg = -cot(πv)/r.
TEST(DarbouxFrame, OfCirclesOnASphere) {
  Random random(12);
  for (int i = 0; i < 500; ++i) {
    const double r = random.log_uniform(1e-100, 1e100), u = random.uniform(), v = random.uniform(0.1, 0.9);
    const Sphere sphere{r};
    const DarbouxFrame<double> parallel = darboux_frame(sphere, u, v, {1, 0, 0, 0});
    const Turn<double> polar = sincos_half_turns(v);
    // A dot product of partials over the square of the speed, each within 8u; cot is at most 3.1.
    EXPECT_NEAR(parallel.geodesic_curvature * r, -polar.cos / polar.sin, 4 * 32 * roundoff);
    EXPECT_NEAR(parallel.normal_curvature * r, -1, 32 * roundoff);
    EXPECT_NEAR(parallel.geodesic_torsion * r, 0, 32 * roundoff);
    EXPECT_GT(parallel.V.z, 0);
    // Westwards V points south: κg changes its sign, κn does not.
    const DarbouxFrame<double> back = darboux_frame(sphere, u, v, {-2, 0, 0, 0});
    EXPECT_NEAR(back.geodesic_curvature * r, polar.cos / polar.sin, 4 * 32 * roundoff);
    EXPECT_NEAR(back.normal_curvature * r, -1, 32 * roundoff);
  }
}

// Along a meridian through the pole, where dpdu vanishes: a line of curvature there too.
TEST(DarbouxFrame, OfAMeridianAtThePole) {
  for (const double v : {0.0, 1.0}) {
    const DarbouxFrame<double> d = darboux_frame(Sphere{2.0}, 0.3, v, {0, 1, 0, 0});
    EXPECT_NEAR(d.normal_curvature, -0.5, 8 * roundoff);
    EXPECT_NEAR(d.geodesic_curvature, 0, 8 * roundoff);
    EXPECT_NEAR(d.geodesic_torsion, 0, 8 * roundoff);
    EXPECT_EQ(d.status, Status::dpdu_zero | Status::limit_frame);
  }
}

// Every great circle is a geodesic: u(s), v(s) of cos s p + sin s q at s = 0, differentiated by hand.
TEST(DarbouxFrame, OfGreatCirclesHasNoGeodesicCurvature) {
  Random random(13);
  for (int i = 0; i < 500; ++i) {
    const Vec3<double> p = random.direction(), q = unit(cross(p, random.direction()));
    const double rho = std::hypot(p.x, p.y);
    if (rho < 0.2) continue;
    // φ' = (x y' - y x')/ρ²; φ'' has the derivative of ρ² only, as x y'' = y x''. With z = -cos πv: z' = π v' sin πv.
    const double phi1 = (p.x * q.y - p.y * q.x) / (rho * rho),
                 phi2 = -phi1 * 2 * (p.x * q.x + p.y * q.y) / (rho * rho), theta1 = q.z / rho,
                 theta2 = (-p.z + p.z * theta1 * theta1) / rho;
    constexpr double pi = std::numbers::pi;
    const DarbouxFrame<double> d =
        darboux_frame(Sphere{1.0}, std::atan2(p.y, p.x) / (2 * pi), std::acos(-p.z) / pi,
                      {phi1 / (2 * pi), theta1 / pi, phi2 / (2 * pi), theta2 / pi});
    // Terms up to 1/ρ³ = 125, from coordinates whose errors are amplified as much.
    EXPECT_NEAR(d.geodesic_curvature, 0, 125 * 125 * 8 * roundoff);
    EXPECT_NEAR(d.normal_curvature, -1, 125 * 125 * 8 * roundoff);
    EXPECT_LE(norm(d.T - q), 125 * 8 * roundoff);
  }
}

// Coordinate lines of surfaces of revolution are lines of curvature; meridians are geodesics, too.
TEST(DarbouxFrame, OfLinesOfCurvatureHasNoGeodesicTorsion) {
  Random random(14);
  const std::vector<AnySurface> surfaces{Torus{1.0, 0.4}, Catenoid<double>(), Cylinder{1.0, 2.0},
                                         OneSheetHyperboloid<double>()};
  for (const AnySurface& s : surfaces)
    for (int i = 0; i < 200; ++i) {
      const double u = random.uniform(), v = random.uniform(0.1, 0.9);
      const Jet2<double> j = s.jet(u, v);
      const Frame<double> f = s.frame(u, v);
      const double bound = 32 * roundoff * TermSizes(j, f).largest();
      EXPECT_NEAR(darboux_frame(j, f, {1, 0, 0, 0}).geodesic_torsion, 0, bound) << s.info().name;
      const DarbouxFrame<double> meridian = darboux_frame(j, f, {0, 1, 0, 0});
      EXPECT_NEAR(meridian.geodesic_torsion, 0, bound) << s.info().name;
      EXPECT_NEAR(meridian.geodesic_curvature, 0, bound) << s.info().name;
    }
}

// A helix that climbs at the angle α on a cylinder: a geodesic, κn = -cos² α / r, τg = sin α cos α / r, the torsion of a
// right-handed helix.
TEST(DarbouxFrame, OfHelicesOnACylinder) {
  Random random(15);
  for (int i = 0; i < 500; ++i) {
    const double r = random.uniform(0.5, 2), h = random.uniform(0.5, 2), du = random.uniform(-1, 1),
                 dv = random.uniform(-1, 1);
    const double across = 2 * std::numbers::pi * r * du, up = h * dv, speed = std::hypot(across, up);
    const DarbouxFrame<double> d =
        darboux_frame(Cylinder{r, h}, random.uniform(), random.uniform(), {du, dv, 0, 0});
    const double cosine = across / speed, sine = up / speed;
    EXPECT_NEAR(d.normal_curvature, -cosine * cosine / r, 64 * roundoff / r);
    EXPECT_NEAR(d.geodesic_curvature, 0, 64 * roundoff / r);
    EXPECT_NEAR(d.geodesic_torsion, sine * cosine / r, 64 * roundoff / r);
  }
}

TEST(DarbouxFrame, OfAPointIsNone) {
  for (const auto& [v, curve] :
       {std::pair{0.3, CurveOnSurface<double>{0, 0, 1, 1}}, {0.0, CurveOnSurface<double>{1, 0, 0, 0}}}) {
    const DarbouxFrame<double> d = darboux_frame(Sphere{1.0}, 0.3, v, curve);
    EXPECT_TRUE(has(d.status, Status::no_frame)) << v;
    EXPECT_TRUE(std::isnan(d.T.x) && std::isnan(d.normal_curvature) && std::isnan(d.geodesic_torsion)) << v;
  }
}

// ---- singular points -------------------------------------------------------------------------------------------

// At the poles of an ellipsoid κ = -c/a² and -c/b² along the axes, whatever u; for any sizes.
TEST(SingularPoints, OfEllipsoidsHaveTheirCurvature) {
  Random random(16);
  for (int i = 0; i < 500; ++i) {
    const double scale = random.log_uniform(1e-100, 1e100), a = scale * random.uniform(0.5, 2),
                 b = scale * random.uniform(0.5, 2), c = scale * random.uniform(0.5, 2), u = random.uniform();
    const double along_x = -c / a / a, along_y = -c / b / b;
    for (const double pole : {0.0, 1.0}) {
      const Curvature<double> k = curvature(Ellipsoid{a, b, c}, u, pole);
      // Terms of the size 1/|d2pduv|² |dpdv|... are at most (2/0.5)² of κ; each a few roundings.
      const double bound = 16 * 32 * roundoff * std::fabs(along_x + along_y);
      EXPECT_NEAR(k.principal[0], std::fmax(along_x, along_y), bound);
      EXPECT_NEAR(k.principal[1], std::fmin(along_x, along_y), bound);
      EXPECT_NEAR(k.gaussian / along_x / along_y, 1, 16 * 64 * roundoff * 16);
      const Vec3<double> first = along_x > along_y ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
      const double apart = std::fabs(along_x - along_y);
      EXPECT_LE(norm(cross(k.directions[0], first)), bound / apart + 8 * roundoff);
      EXPECT_TRUE(has(k.status, Status::limit_frame));
    }
  }
}

TEST(SingularPoints, HaveTheCurvatureOfTheirClosedForms) {
  Random random(17);
  for (int i = 0; i < 100; ++i) {
    const double u = random.uniform(), r = random.log_uniform(1e-150, 1e150), h = random.uniform(0.5, 2);
    for (const double pole : {0.0, 1.0}) {
      const Curvature<double> sphere = curvature(Sphere{r}, u, pole);
      EXPECT_NEAR(sphere.mean * r, -1, 16 * roundoff);
      EXPECT_NEAR(sphere.gaussian * r * r, 1, 32 * roundoff);
      EXPECT_TRUE(has(sphere.status, Status::umbilic));
    }
    // z = h ρ²: κ = -2h, n down and out. z = c sqrt(1 + ρ²/a²): -c/a². A disk is flat.
    const Curvature<double> cup = curvature(EllipticParaboloid{1.0, 1.0, h}, u, 0.0);
    EXPECT_NEAR(cup.principal[0], -2 * h, 32 * roundoff * h);
    EXPECT_NEAR(cup.principal[1], -2 * h, 32 * roundoff * h);
    EXPECT_NEAR(curvature(TwoSheetHyperboloid{2.0, 2.0, h, 1.0}, u, 0.0).mean, -h / 4, 32 * roundoff * h);
    const Curvature<double> disk = curvature(Disk{1.0, 0.0}, u, 1.0);
    EXPECT_EQ(disk.gaussian, 0);
    EXPECT_EQ(disk.mean, 0);
  }
}

// z = α x² + 2β x y + γ y² + x³/4 over x = 2ρ cos, y = ρ sin + ρ²/2: the chart is skew at its tip, and every term of the
// limit is at work.
struct Cup {
  double alpha, beta, gamma;
  static constexpr SurfaceInfo info{"cup", "a quadric and more, in skew polar coordinates", Coordinate::turn,
                                    Coordinate::linear};
  template <class S>
  Vec3<S> position(const Turn<S>& u, const S& v) const {
    const S two = lift<S>(2.0), x = two * v * u.cos, y = v * u.sin + v * v / two;
    return {x, y,
            lift<S>(alpha) * x * x + two * lift<S>(beta) * x * y + lift<S>(gamma) * y * y +
                x * x * x / lift<S>(4.0)};
  }
};

// At its tip a graph with a horizontal tangent plane has its second derivatives as second form.
TEST(SingularPoints, OfAnyCupHaveItsSecondDerivatives) {
  Random random(18);
  for (int i = 0; i < 500; ++i) {
    const FromPosition<Cup> cup{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
    const double u = random.uniform();
    const Jet2<double> j = jet(cup, u, 0.0);
    const Frame<double> f = frame(cup, u, 0.0);
    ASSERT_TRUE(has(f.status, Status::dpdu_zero) && has(f.status, Status::limit_frame));
    const auto hessian = [&](const Vec3<double>& a, const Vec3<double>& b) {
      return f.n.z * 2 * (cup.alpha * a.x * b.x + cup.beta * (a.x * b.y + a.y * b.x) + cup.gamma * a.y * b.y);
    };
    const ShapeOperator<double> s = shape_operator(cup, u, 0.0, j, f);
    // Derivatives up to 2 (2π)² 2² of each, over |d2pduv|² >= (2π)² and |dpdv · b| >= 1: terms up to 64, some 32 roundings.
    EXPECT_NEAR(s.a, hessian(f.t, f.t), 64 * 32 * roundoff) << u;
    EXPECT_NEAR(s.m, hessian(f.t, f.b), 64 * 32 * roundoff) << u;
    EXPECT_NEAR(s.c, hessian(f.b, f.b), 64 * 32 * roundoff) << u;
    const Curvature<double> c = curvature(AnySurface(cup), u, 0.0);
    EXPECT_NEAR(c.gaussian, 4 * (cup.alpha * cup.gamma - cup.beta * cup.beta), 4 * 64 * 32 * roundoff);
    EXPECT_NEAR(c.mean, f.n.z * (cup.alpha + cup.gamma), 64 * 32 * roundoff);
    EXPECT_NEAR(hessian(c.directions[0], c.directions[1]), 0, 4 * 64 * 32 * roundoff);
  }
}

// What the curvature tends to near every singular point of the catalogue is what it is there, or it has no limit.
class FormsAtEdges : public Forms {};
std::vector<AnySurface> singular_at_edges() {
  std::vector<AnySurface> list;
  for (const AnySurface& surface : all_surfaces())
    if (has(surface.frame(0.3, 0).status | surface.frame(0.3, 1).status, Status::limit_frame))
      list.push_back(surface);
  return list;
}
INSTANTIATE_TEST_SUITE_P(Catalogue, FormsAtEdges, ::testing::ValuesIn(singular_at_edges()), test_name);

TEST_P(FormsAtEdges, CurvatureIsItsLimit) {
  int singular = 0;
  for (const double edge : {0.0, 1.0})
    for (const double u : {0.0, 0.3, 0.7}) {
      const Frame<double> f = surface().frame(u, edge);
      if (!has(f.status, Status::limit_frame)) continue;
      ++singular;
      const Curvature<double> c = curvature(surface(), u, edge);
      const auto at = [&](double distance) {
        return curvature(surface(), u, edge == 0 ? distance : 1 - distance);
      };
      const Curvature<double> near = at(0x1p-12), nearer = at(0x1p-13);
      const double k = std::fabs(nearer.principal[0]) + std::fabs(nearer.principal[1]);
      if (std::isnan(c.mean)) {
        // No limit: it grows without bound (cone), or its derivatives do not exist (superellipsoid).
        EXPECT_TRUE(surface().info().name == "cone" || surface().info().name == "superellipsoid");
        continue;
      }
      // Extrapolated linearly: what is left is of second order, 6e-8 times half the second derivative, some (2π)² of κ.
      EXPECT_NEAR(c.mean, 2 * nearer.mean - near.mean, 1e-5 * k) << u;
      EXPECT_NEAR(c.gaussian, 2 * nearer.gaussian - near.gaussian, 1e-5 * k * k) << u;
    }
  EXPECT_GT(singular, 0);
}

// The apex of a cone: the curvature across grows like 1 over the distance. Nothing is said.
TEST(SingularPoints, OfAConeHasNoCurvature) {
  const Curvature<double> c = curvature(Cone{1.0, 2.0}, 0.3, 1.0);
  for (const double x : {c.gaussian, c.mean, c.principal[0], c.principal[1], c.directions[0].x})
    EXPECT_TRUE(std::isnan(x));
  EXPECT_FALSE(has(c.status, Status::umbilic));
}

// Gauss-Bonnet: the integral of K over a closed surface is 2π times its Euler characteristic.
template <class X>
double total_curvature(const X& surface, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const Jet2<double> j = jet(surface, (i + 0.5) / n, (k + 0.5) / n);
      sum += curvature(j, frame_from_partials(j.dpdu, j.dpdv)).gaussian * norm(cross(j.dpdu, j.dpdv));
    }
  return sum / (n * n);
}

TEST(GaussBonnet, TorusHasNone) {
  // Periodic and analytic: the midpoint sum converges like exp(-n), and 64 leaves rounding. K dA is below 40.
  EXPECT_NEAR(total_curvature(Torus{1.0, 0.4}, 64), 0, 40 * 32 * roundoff);
}

TEST(GaussBonnet, SphereHasFourPi) {
  // The midpoint rule on 2π² sin πv errs by the factor π²/(24 n²), here 1.6e-6 of 4π = 2.0e-5; its next term
  // is that squared.
  constexpr int n = 512;
  constexpr double full = 4 * std::numbers::pi, slack = std::numbers::pi * std::numbers::pi / (24.0 * n * n);
  EXPECT_NEAR(total_curvature(Sphere{3.0}, n), full * (1 + slack), full * 2 * slack * slack + 1e-12);
}

TEST(Curvature, WithoutAPlaneIsNan) {
  const Jet2<double> flat{.position = {},
                          .dpdu = {1, 0, 0},
                          .dpdv = {2, 0, 0},
                          .d2pdu2 = {0, 0, 1},
                          .d2pduv = {},
                          .d2pdv2 = {0, 0, 1}};
  const Curvature<double> c = curvature(flat, frame_from_partials(flat.dpdu, flat.dpdv));
  EXPECT_TRUE(std::isnan(c.mean) && std::isnan(c.gaussian) && std::isnan(c.principal[0]));
  EXPECT_TRUE(std::isnan(c.directions[0].x));
  EXPECT_TRUE(has(c.status, Status::no_frame));
  EXPECT_FALSE(has(c.status, Status::umbilic));
}

}  // namespace
}  // namespace darboux::test
