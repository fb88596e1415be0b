// Curvature against the closed forms of do Carmo, and by other routes: Euler's formula, another chart,
// Gauss-Bonnet.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

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
  std::cout << worst / roundoff << "u\n";
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

template <class X>
class CurvatureLaws : public ::testing::Test {};
TYPED_TEST_SUITE(CurvatureLaws, EveryCatalogueSurface, SurfaceNames);

TYPED_TEST(CurvatureLaws, PrincipalFrameIsOrdered) {
  Random random(4);
  const TypeParam surface;
  for (int i = 0; i < points; ++i) {
    const double u = random.uniform(), v = random.uniform(0.01, 0.99);
    const Curvature<double> c = curvature_at(surface, u, v);
    const Frame<double> f = frame(surface, u, v);
    const double size = std::fmax(std::fabs(c.principal[0]), std::fabs(c.principal[1]));
    EXPECT_GE(c.principal[0], c.principal[1]);
    EXPECT_NEAR(c.gaussian, c.principal[0] * c.principal[1], 16 * roundoff * size * size);
    EXPECT_NEAR(c.mean, (c.principal[0] + c.principal[1]) / 2, 4 * roundoff * size);
    EXPECT_LE(norm(c.directions[1] - cross(f.n, c.directions[0])), 16 * roundoff);
    EXPECT_NEAR(norm(c.directions[0]), 1, 8 * roundoff);
    EXPECT_GE(dot(c.directions[0], f.t), -4 * roundoff);
  }
}

// Meusnier and Euler: a curve through the point bends in the direction of n by κ1 cos² + κ2 sin², whatever
// the curve. Its second derivative comes from central differences of the position: another formula, no
// partials.
TYPED_TEST(CurvatureLaws, CurvesBendByEulersFormula) {
  Random random(5);
  const TypeParam surface;
  for (int i = 0; i < points / 10; ++i) {
    const double u = random.uniform(0.2, 0.8), v = random.uniform(0.2, 0.8);
    const double du = random.uniform(-1, 1), dv = random.uniform(-1, 1), bend = random.uniform(-1, 1);
    const auto velocity = [&](double x) {
      const auto curve = [&](double s) {
        return jet(surface, u + s * du + s * s * bend, v + s * dv).position;
      };
      return central_difference<8>(curve, x).value;
    };
    const Vec3<double> tangent = velocity(0);
    const DerivativeEstimate acceleration = central_difference<8>(velocity, 0);
    const Frame<double> f = frame(surface, u, v);
    const Curvature<double> c = curvature(jet(surface, u, v), f);
    const double speed = norm(tangent);
    if (speed < 0.5) continue;
    const double along = dot(tangent, c.directions[0]) / speed,
                 across = dot(tangent, c.directions[1]) / speed;
    const double normal_curvature = dot(acceleration.value, f.n) / (speed * speed);
    // The outer difference's inputs err by 1e-13 of the inner one, amplified by 2.4/h = 614.
    EXPECT_NEAR(normal_curvature, c.principal[0] * along * along + c.principal[1] * across * across, 1e-9);
  }
}

// Another chart of the same surface, sheared and curved: u = a p + b q + e p q, v = c p + d q. Its partials
// follow by the chain rule; the curvature is the surface's, and its directions up to the sign that t gives.
TYPED_TEST(CurvatureLaws, DoNotDependOnTheChart) {
  Random random(6);
  const TypeParam surface;
  for (int i = 0; i < points; ++i) {
    const double u = random.uniform(), v = random.uniform(0.1, 0.9);
    const double a = random.uniform(0.5, 2), b = random.uniform(-2, 2), c = random.uniform(-2, 2),
                 d = random.uniform(0.5, 2), e = random.uniform(-1, 1);
    const double determinant = a * d - b * c;
    if (std::fabs(determinant) < 0.25) continue;
    const Jet2<double> j = jet(surface, u, v);
    const auto second = [&](double u1, double v1, double u2, double v2) {
      return u1 * u2 * j.d2pdu2 + (u1 * v2 + u2 * v1) * j.d2pduv + v1 * v2 * j.d2pdv2;
    };
    const Jet2<double> sheared{.position = j.position,
                               .dpdu = a * j.dpdu + c * j.dpdv,
                               .dpdv = b * j.dpdu + d * j.dpdv,
                               .d2pdu2 = second(a, c, a, c),
                               .d2pduv = second(a, c, b, d) + e * j.dpdu,
                               .d2pdv2 = second(b, d, b, d)};
    Frame<double> f = frame_from_partials(sheared.dpdu, sheared.dpdv);
    if (determinant < 0) f.n = -f.n, f.b = -f.b;  // a flipped chart keeps the surface's n
    const Curvature<double> own = curvature(j, frame(surface, u, v)), other = curvature(sheared, f);
    // The shear's condition, at most 40 for these entries and determinants, times dpdu's to dpdv's, at most
    // 10 (sphere at v = 0.1: 0.6; torus 3 to 5; cylinder 2π), enters squared: 32u 160 000 in the worst case.
    const double size = std::fmax(std::fabs(own.principal[0]), std::fabs(own.principal[1]));
    const double bound = 160'000 * 32 * roundoff * size;
    EXPECT_NEAR(other.mean, own.mean, bound);
    EXPECT_NEAR(other.gaussian, own.gaussian, bound * size);
    const double apart = own.principal[0] - own.principal[1];
    if (apart < 0.1 * size)
      continue;  // a sphere: its κ are one double root, whose halves err by the root of errors
    EXPECT_NEAR(other.principal[0], own.principal[0], bound);
    EXPECT_NEAR(other.principal[1], own.principal[1], bound);
    EXPECT_LE(norm(cross(other.directions[0], own.directions[0])), bound / apart);
  }
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
