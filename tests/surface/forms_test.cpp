// Forms, shape operator, Christoffel symbols, curvature and Darboux frame: against closed forms of do Carmo,
// and over the whole catalogue against derivatives taken in 40 digits.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/christoffel.h>
#include <darboux/curvature.h>
#include <darboux/darboux_frame.h>
#include <darboux/differentiate.h>
#include <darboux/evaluate.h>
#include <darboux/forms.h>
#include <darboux/reparametrised.h>
#include <darboux/shape_operator.h>

#include "multiprecision_forms.h"
#include "random.h"

namespace darboux::test::forms_test {
namespace {

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

// The forms without a jet and a frame are those with them, of types and of AnySurface, and at a pole.
TEST(FundamentalForms, TakeTheSurfaceAlone) {
  const Ellipsoid ellipsoid{1.0, 0.7, 0.5};
  const AnySurface any(ellipsoid);
  for (const double v : {0.0, 0.3}) {
    const Jet2<double> j = jet(ellipsoid, 0.2, v);
    const Frame<double> f = frame(ellipsoid, 0.2, v);
    EXPECT_EQ(second_form(ellipsoid, 0.2, v).N, second_form(ellipsoid, 0.2, v, j, f).N);
    EXPECT_EQ(second_form(any, 0.2, v).N, second_form(ellipsoid, 0.2, v).N);
    const NormalDerivatives<double> d = normal_derivatives(ellipsoid, 0.2, v, j, f);
    EXPECT_EQ(normal_derivatives(ellipsoid, 0.2, v).dndu, d.dndu);
    EXPECT_EQ(normal_derivatives(any, 0.2, v).dndv, d.dndv);
    const double symbol = christoffel(ellipsoid, 0.2, v, j, f).u[1];
    EXPECT_EQ(std::isfinite(symbol), v > 0);
    if (v == 0) continue;
    EXPECT_EQ(christoffel(ellipsoid, 0.2, v).u[1], symbol);
    EXPECT_EQ(christoffel(any, 0.2, v).u[1], symbol);
  }
  EXPECT_EQ(second_form(ellipsoid, 0, 0.5f).L, second_form(ellipsoid, 0.0, 0.5).L);
  EXPECT_EQ(normal_derivatives(ellipsoid, 0, 0.5f).dndu, normal_derivatives(ellipsoid, 0.0, 0.5).dndu);
  EXPECT_EQ(christoffel(ellipsoid, 0, 0.5f).u[1], christoffel(ellipsoid, 0.0, 0.5).u[1]);
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

// ---- the whole catalogue ----------------------------------------------------------------------------------

INSTANTIATE_TEST_SUITE_P(Catalogue, Forms, ::testing::ValuesIn(all_surfaces()), test_name);

// S is the one operator with S dpdu · dpdu = L, S dpdu · dpdv = M, S dpdv · dpdv = N; K is its
// determinant, H half its trace.
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
    // H is the surface's own where a + c cancels: then the error of both κ is left, 8u times
    // (1 + condition), the condition at most 3 here.
    EXPECT_NEAR(c.mean, (c.principal[0] + c.principal[1]) / 2, 32 * roundoff * k);
    // The frame's own deviation from orthonormality, 16u where it is made from partials, and the roundings of
    // the sum.
    EXPECT_LE(norm(c.directions[1] - cross(f.n, c.directions[0])), 32 * roundoff);
    EXPECT_NEAR(norm(c.directions[0]), 1, 32 * roundoff);
    EXPECT_GE(dot(c.directions[0], f.t), -16 * roundoff);
  });
}

// On a surface of revolution one principal direction is t and the other b. Where the first is b it is exactly
// b, not -b by a rounding's sign.
TEST(Forms, PrincipalDirectionsOfRevolutionHaveOneSign) {
  const std::string_view names[] = {"sphere",
                                    "torus",
                                    "cylinder",
                                    "cone",
                                    "catenoid",
                                    "pseudosphere",
                                    "surface-of-revolution",
                                    "ellipsoid:semi_axis_x=0.4,semi_axis_y=0.4,semi_axis_z=1",
                                    "ellipsoid:semi_axis_x=2,semi_axis_y=2,semi_axis_z=0.3",
                                    "elliptic-paraboloid:semi_axis_x=0.7,semi_axis_y=0.7,height=2",
                                    "one-sheet-hyperboloid:waist_radius=0.7",
                                    "two-sheet-hyperboloid:semi_axis_x=0.7,semi_axis_y=0.7"};
  std::size_t along_b = 0;
  for (const std::string_view name : names) {
    const AnySurface surface = make_surface(std::string(name));
    SCOPED_TRACE(name);
    for (int i = 0; i < 61; ++i)
      for (int k = 1; k < 40; ++k) {
        const double u = i / 61.0, v = k / 40.0;
        const Frame<double> f = surface.frame(u, v);
        const Curvature<double> c = curvature(surface, u, v);
        if (has(f.status, Status::no_frame) || std::isnan(c.mean)) continue;
        const double t = dot(c.directions[0], f.t), b = dot(c.directions[0], f.b);
        if (std::fabs(b) > 0.5) {
          ++along_b;
          EXPECT_EQ(c.directions[0], f.b) << u << ' ' << v;
        } else {
          EXPECT_GT(t, 0.5);
          EXPECT_NEAR(b, 0, 1e-10);
        }
      }
  }
  EXPECT_GT(along_b, 5000u);
}

// Meusnier and Euler: a curve through the point bends in the direction of n by κ1 cos² + κ2 sin²,
// whatever the curve. Its second derivative comes from differences of the position: no partials.
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

// Another chart of the same surface, sheared and curved: u = a p + b q + e p q, v = c p + d q. Its partials
// follow by the chain rule; the shape operator, as an operator in space, is the surface's.
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
    // Four times the estimate, which is no bound. Where it cannot tell (a stencil across a knot) nothing is
    // asked.
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
  // The midpoint rule on 2π² sin πv errs by the factor π²/(24 n²), here 1.6e-6 of 4π = 2.0e-5; its
  // next term is that squared.
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
}  // namespace darboux::test::forms_test
