// Curvature at poles, tips and collapsed edges: its limit, or nothing.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <darboux/evaluate.h>
#include <darboux/from_position.h>

#include "multiprecision_forms.h"
#include "random.h"

namespace darboux::test::forms_singular_test {
namespace {

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

// z = α x² + 2β x y + γ y² + x³/4 over x = 2ρ cos, y = ρ sin + ρ²/2: the chart is skew at its tip,
// and every term of the limit is at work.
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
    // Derivatives up to 2 (2π)² 2² of each, over |d2pduv|² >= (2π)² and |dpdv · b| >= 1: terms up to
    // 64, some 32 roundings.
    EXPECT_NEAR(s.a, hessian(f.t, f.t), 64 * 32 * roundoff) << u;
    EXPECT_NEAR(s.m, hessian(f.t, f.b), 64 * 32 * roundoff) << u;
    EXPECT_NEAR(s.c, hessian(f.b, f.b), 64 * 32 * roundoff) << u;
    const Curvature<double> c = curvature(AnySurface(cup), u, 0.0);
    EXPECT_NEAR(c.gaussian, 4 * (cup.alpha * cup.gamma - cup.beta * cup.beta), 4 * 64 * 32 * roundoff);
    EXPECT_NEAR(c.mean, f.n.z * (cup.alpha + cup.gamma), 64 * 32 * roundoff);
    EXPECT_NEAR(hessian(c.directions[0], c.directions[1]), 0, 4 * 64 * 32 * roundoff);
  }
}

// What the curvature tends to near every singular point of the catalogue is what it is there, or it has no
// limit.
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
      // Extrapolated linearly: what is left is of second order, 6e-8 times half the second derivative, some
      // (2π)² of κ.
      EXPECT_NEAR(c.mean, 2 * nearer.mean - near.mean, 1e-5 * k) << u;
      EXPECT_NEAR(c.gaussian, 2 * nearer.gaussian - near.gaussian, 1e-5 * k * k) << u;
    }
  EXPECT_GT(singular, 0);
}

// As close to a pole as numbers go, where products of partials underflow and quotients overflow, a point that
// is regular has the curvature of the pole. Batches too.
TEST_P(FormsAtEdges, CurvatureReachesItAtDenormalDistances) {
  const auto expect_limit = [&](double u, double v, double u_edge, double v_edge) {
    const Curvature<double> c = curvature(surface(), u, v), limit = curvature(surface(), u_edge, v_edge);
    if (c.status != Status::regular && c.status != Status::umbilic) return;
    SCOPED_TRACE(::testing::Message() << "u " << u << " v " << v);
    if (std::isnan(limit.mean)) return;  // a cone, a superellipsoid
    const double k = std::fabs(limit.principal[0]) + std::fabs(limit.principal[1]);
    // Some hundred roundings of terms in which derivatives to fourth order take part.
    EXPECT_NEAR(c.mean, limit.mean, 1e-12 * k);
    EXPECT_NEAR(c.gaussian, limit.gaussian, 1e-12 * k * k);
    std::array<double, 1> mean{}, gaussian{};
    Outputs<double> out;
    out.packed(Attribute::mean_curvature, std::span<double>(mean));
    out.packed(Attribute::gaussian_curvature, std::span<double>(gaussian));
    const std::array<double, 2> uv{u, v};
    surface().evaluate(Points<double>::interleaved(uv), out);
    EXPECT_EQ(mean[0], c.mean);
    EXPECT_EQ(gaussian[0], c.gaussian);
  };
  for (const double distance : {5e-324, 1e-320, 1e-310, 1e-308, 1e-307, 1e-305, 1e-300, 1e-290})
    for (const double at : {0.0, 0.1, 0.37, 0.9}) {
      expect_limit(at, distance, at, 0);
      expect_limit(distance, at, 0, at);
    }
}

// Close to the pole of an ellipsoid with three axes the first direction is that of the pole, x, whatever u:
// the terms whose sum is m grow there, but not what rounding leaves of them.
TEST(SingularPoints, AreApproachedByThePrincipalDirections) {
  for (const double distance : {1e-10, 1e-12, 1e-13, 1e-14, 1e-16, 1e-100, 1e-200})
    for (int i = 0; i < 500; ++i) {
      const double u = (i + 0.37) / 500;
      for (const AnySurface& surface :
           {AnySurface(Ellipsoid{1.0, 0.9, 0.5}), AnySurface(EllipticParaboloid{1.0, 0.9, 1e-8})}) {
        const Curvature<double> c = curvature(surface, u, distance);
        // -1/a² is above -1/b² for a > b. The curvatures differ by a fifth of themselves.
        EXPECT_LE(norm(cross(c.directions[0], Vec3<double>{1, 0, 0})), 1e-6)
            << surface.specification() << ' ' << u << ' ' << distance;
      }
    }
}

// The apex of a cone: the curvature across grows like 1 over the distance. Nothing is said.
TEST(SingularPoints, OfAConeHasNoCurvature) {
  const Curvature<double> c = curvature(Cone{1.0, 2.0}, 0.3, 1.0);
  for (const double x : {c.gaussian, c.mean, c.principal[0], c.principal[1], c.directions[0].x})
    EXPECT_TRUE(std::isnan(x));
  EXPECT_FALSE(has(c.status, Status::umbilic));
}

}  // namespace
}  // namespace darboux::test::forms_singular_test
