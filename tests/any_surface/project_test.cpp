// Projection of points onto every surface of the catalogue: it undoes P + d n, and agrees with closed forms.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <darboux/project.h>
#include <darboux/shape_operator.h>

#include "every_surface.h"
#include "random.h"
#include "random_pose.h"

namespace darboux::test::project_test {
namespace {

// Sizes here are about 1 to 4, and points lie within half the least radius of curvature: 1 / (1 - d κ) <= 2.
// The rest are some ten roundings of the position.
constexpr double tolerance = 64 * 0x1p-52;

struct Given {
  Vec2<double> uv;
  Vec3<double> foot, p;
  double distance;
};

Given random_point(const AnySurface& surface, Random& random) {
  const double u = random.uniform(), v = random.uniform();
  const Sample<double> s = surface.sample(u, v);
  const ShapeOperator<double> shape = shape_operator(s.jet, s.frame);
  const double curvature = std::fabs((shape.a + shape.c) / 2) + std::hypot((shape.a - shape.c) / 2, shape.m);
  const double d = random.uniform(-1, 1) * std::fmin(0.5 / curvature, 0.3);
  return {{u, v}, s.jet.position, s.jet.position + d * s.frame.n, d};
}

// The foot of P + d n is P, or a point that is nearer: on the far side of a surface that comes near itself.
TEST(Project, UndoesTheStepAlongTheNormal) {
  Random random(1);
  constexpr int points = 500;
  for (const AnySurface& surface : all_surfaces())
    for (const Extent extent : {Extent::extended, Extent::patch}) {
      const Projector project(surface, extent);
      // A grid cell holds two feet where the Klein bottle passes through itself; a superellipsoid's partials
      // are infinite along lines.
      const bool may_miss = surface.info().name == "klein-bottle" || surface.info().name == "superellipsoid";
      const bool one_sided = !surface.info().orientable;
      int back = 0, missed = 0;
      for (int k = 0; k < points; ++k) {
        const Given given = random_point(surface, random);
        const Projection found = project(given.p);
        const auto where = [&] {
          return surface.specification() + " at " + std::to_string(given.uv.x) + ", " +
                 std::to_string(given.uv.y) + ", distance " + std::to_string(given.distance);
        };
        if (!found.converged || std::fabs(found.distance) > std::fabs(given.distance) + tolerance) {
          ++missed;
          EXPECT_TRUE(may_miss) << where() << ", found " << found.distance << " at " << found.uv.x << ", "
                                << found.uv.y;
          continue;
        }
        const Sample<double> s = surface.sample(found.uv.x, found.uv.y);
        EXPECT_EQ(norm(s.jet.position - found.position), 0) << where();
        EXPECT_EQ(norm(s.frame.n - found.normal), 0) << where();
        EXPECT_EQ(s.frame.status, found.status) << where();
        if (std::fabs(found.distance) < std::fabs(given.distance) - tolerance) {
          // Orthogonal, unless on a border.
          const double residual = norm(found.position + found.distance * found.normal - given.p);
          const auto on_border = [&](double x) { return x == 0 || x == 1; };
          EXPECT_TRUE(residual <= tolerance || on_border(found.uv.x) || on_border(found.uv.y)) << where();
          continue;
        }
        ++back;
        EXPECT_LE(norm(found.position - given.foot), tolerance) << where();
        EXPECT_NEAR(one_sided ? std::fabs(found.distance) : found.distance,
                    one_sided ? std::fabs(given.distance) : given.distance, tolerance)
            << where();
      }
      EXPECT_LE(missed, 0.01 * points) << surface.info().name;
      // The Klein bottle passes through itself along a whole circle, near which another sheet is nearer.
      EXPECT_GE(back, surface.info().name == "klein-bottle" ? 0.8 * points : 0.98 * points)
          << surface.info().name;
    }
}

TEST(Project, GoesToTheFootBesideTheStart) {
  Random random(2);
  for (const AnySurface& surface : all_surfaces()) {
    const Projector project(surface);
    for (int k = 0; k < 100; ++k) {
      const Given given = random_point(surface, random);
      const Projection found = project(given.p + 1e-6 * random.direction(), given.uv);
      EXPECT_TRUE(found.converged) << surface.specification() << " at " << given.uv.x << ", " << given.uv.y;
      EXPECT_LE(norm(found.position - given.foot), 4e-6);  // 1 / (1 - d κ) <= 2, and p moved
      EXPECT_LE(found.iterations, 12);
    }
  }
}

// The signed distances of the closed forms, for points anywhere.
TEST(Project, AgreesWithClosedForms) {
  Random random(3);
  for (int k = 0; k < 300; ++k) {
    const Vec3<double> p = random.uniform(0, 3) * random.direction();
    const double rho = std::hypot(p.x, p.y);
    const auto distance = [&](std::string_view surface) {
      const Projection found = project(make_surface(surface), p);
      EXPECT_TRUE(found.converged) << surface << " from " << p.x << ", " << p.y << ", " << p.z;
      return found.distance;
    };
    EXPECT_NEAR(distance("sphere:radius=1.5"), norm(p) - 1.5, tolerance);
    EXPECT_NEAR(distance("torus:major_radius=1.5,minor_radius=0.5"), std::hypot(rho - 1.5, p.z) - 0.5,
                tolerance);
    EXPECT_NEAR(distance("cylinder:radius=1.2,height=0.5"), rho - 1.2, tolerance);
    EXPECT_NEAR(distance("plane:width=0.5,depth=0.25"), p.z, tolerance);
    // The cone ends at its apex (0, 0, 2): beyond the generator's end the apex is nearest.
    const double along = (rho - 0) * 1 - (p.z - 2) * 2, across = (rho * 2 + (p.z - 2) * 1) / std::sqrt(5.0);
    EXPECT_NEAR(distance("cone:radius=1,height=2"), along > 0 ? across : std::hypot(rho, p.z - 2), tolerance);
  }
}

// The greatest of 400 by 200 samples bounds the distance from above, and their spacing from below.
TEST(Project, FindsTheNearestPointOfAnEllipsoid) {
  Random random(4);
  const AnySurface surface = make_surface("ellipsoid:semi_axis_x=1.5,semi_axis_y=1,semi_axis_z=0.4");
  const Projector project(surface);
  constexpr int columns = 400, rows = 200;
  std::vector<Vec3<double>> samples;
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column < columns; ++column)
      samples.push_back(surface.jet(column / double(columns), row / double(rows)).position);
  // Half a cell's diagonal: (2π 1.5 / 400, π 1.5 / 200) / 2.
  constexpr double spacing = 0.5 * std::numbers::pi * 1.5 / 200 * std::numbers::sqrt2;
  for (int k = 0; k < 200; ++k) {
    const Vec3<double> p = random.uniform(0, 2.5) * random.direction();
    double least = 10;
    for (const Vec3<double>& q : samples) least = std::fmin(least, norm(q - p));
    const Projection found = project(p);
    EXPECT_TRUE(found.converged);
    EXPECT_LE(std::fabs(found.distance), least + tolerance);
    EXPECT_GE(std::fabs(found.distance), least - spacing);
    const bool inside = *surface.implicit(p) < 0;
    EXPECT_EQ(found.distance < 0, inside);
  }
}

TEST(Project, StopsAtBordersOfAPatch) {
  const AnySurface cylinder = make_surface("cylinder:radius=1,height=2"), plane = make_surface("plane");
  const Projection rim = project(cylinder, {3, 0, 4}, Extent::patch);
  EXPECT_TRUE(rim.converged);
  EXPECT_EQ(rim.uv, (Vec2<double>{0, 1}));
  EXPECT_NEAR(rim.distance, std::hypot(2, 2), tolerance);
  EXPECT_NEAR(project(cylinder, {3, 0, 4}).uv.y, 2, tolerance);
  EXPECT_EQ(project(cylinder, {3, 0, 4}).status, Status::outside_domain);
  const Projection corner = project(plane, {-2, 3, -1}, Extent::patch);
  EXPECT_TRUE(corner.converged);
  EXPECT_EQ(corner.uv, (Vec2<double>{0, 1}));
  EXPECT_NEAR(corner.distance, -std::sqrt(1.5 * 1.5 + 2.5 * 2.5 + 1), tolerance);
  EXPECT_NEAR(project(plane, {-2000, 3000, -1}).distance, -1, tolerance * 3000);
}

// From every start, also across a pole or an apex.
TEST(Project, PassesThroughPoles) {
  Random random(5);
  const Projector sphere(make_surface("sphere")), cone(make_surface("cone")), disk(make_surface("disk"));
  for (int k = 0; k < 300; ++k) {
    const Vec2<double> start{random.uniform(), random.uniform()};
    Vec3<double> p = random.direction();
    if (k % 3 == 0) p = unit(Vec3<double>{1e-3 * p.x, 1e-3 * p.y, p.z});
    const Projection found = sphere(2.0 * p, start);
    EXPECT_TRUE(found.converged) << start.x << ", " << start.y << " to " << p.x << ", " << p.y << ", " << p.z;
    EXPECT_LE(norm(found.position - p), tolerance);
    const Vec3<double> on_disk{0.3 * p.x, 0.3 * p.y, 0};
    EXPECT_LE(norm(disk(on_disk + Vec3<double>{0, 0, 1}, start).position - on_disk), tolerance);
  }
  // On the axis every meridian is as good.
  for (const double z : {3.0, -3.0}) {
    const Projection pole = sphere({0, 0, z});
    EXPECT_TRUE(pole.converged);
    EXPECT_NEAR(pole.distance, 2, tolerance);
    EXPECT_LE(norm(pole.position - Vec3<double>{0, 0, z / 3}), tolerance);
  }
  const Projection apex = cone({0.1, 0.2, 4});
  EXPECT_TRUE(apex.converged);
  EXPECT_EQ(apex.uv.y, 1);
  EXPECT_TRUE(has(apex.status, Status::dpdu_zero));
}

TEST(Project, WorksInThePlacedSurfacesSpace) {
  Random random(6);
  std::mt19937_64 engine(6);
  PlacedSurface placed{make_surface("torus")};
  placed.placement = random_pose(engine, 3);
  for (int k = 0; k < 20; ++k) {
    const Given given = random_point(placed.surface, random);
    const auto there = [&](const Vec3<double>& a) { return from_eigen(placed.placement * to_eigen(a)); };
    const Projection found = project(placed, there(given.p));
    EXPECT_LE(norm(found.position - there(given.foot)), 4 * tolerance);  // |translation| about 5
    EXPECT_LE(norm(found.position + found.distance * found.normal - there(given.p)), 4 * tolerance);
    EXPECT_NEAR(found.distance, given.distance, 4 * tolerance);
  }
}

TEST(Project, SaysWhenItCannot) {
  const double nan = std::nan("");
  const Projection found = project(make_surface("sphere"), {nan, 0, 0});
  EXPECT_FALSE(found.converged);
  EXPECT_TRUE(has(found.status, Status::non_finite_input));
  EXPECT_FALSE(project(make_surface("sphere"), {HUGE_VAL, 0, 0}).converged);
}

// A focal point: every point of the sphere is nearest to its centre, and the distance is right all the same.
TEST(Project, FocalPointsKeepTheirDistance) {
  EXPECT_NEAR(project(make_surface("sphere"), {0, 0, 0}).distance, -1, tolerance);
  EXPECT_NEAR(project(make_surface("cylinder"), {0, 0, 0.5}).distance, -1, tolerance);
}

}  // namespace
}  // namespace darboux::test::project_test
