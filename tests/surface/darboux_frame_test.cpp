// The Darboux frame of curves whose curvatures are known.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <darboux/darboux_frame.h>
#include <darboux/evaluate.h>

#include "multiprecision_forms.h"
#include "random.h"

namespace darboux::test::darboux_frame_test {
namespace {

// A circle of latitude, eastwards: V points north, and north of the equator the curve turns to it. κg =
// -cot(πv)/r.
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
    // φ' = (x y' - y x')/ρ²; φ'' has the derivative of ρ² only, as x y'' = y x''. With z = -cos πv:
    // z' = π v' sin πv.
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

// A helix that climbs at the angle α on a cylinder: a geodesic, κn = -cos² α / r,
// τg = sin α cos α / r, the torsion of a right-handed helix.
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

}  // namespace
}  // namespace darboux::test::darboux_frame_test
