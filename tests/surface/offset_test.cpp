// Offset: parallel surfaces, their curvatures, and what happens at focal points.
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/curvature.h>
#include <darboux/offset.h>
#include <darboux/reparametrised.h>
#include <darboux/testing.h>

#include "adapted.h"
#include "random.h"

namespace darboux::test::offset_test {
namespace {

std::vector<Adapted> every_offset() {
  std::vector<Adapted> all = every_adapted();
  std::erase_if(all, [](const Adapted& x) { return x.distance == 0; });
  return all;
}
class EveryOffset : public ::testing::TestWithParam<Adapted> {};
INSTANTIATE_TEST_SUITE_P(Adaptors, EveryOffset, ::testing::ValuesIn(every_offset()),
                         [](const auto& info) { return info.param.name; });

// Where the base's partials are infinite its frame is still a limit; so is that of the parallel surface.
TEST(Offset, KeepsTheLimitWherePartialsAreInfinite) {
  const Superellipsoid<double> base;
  const Frame<double> f = frame(base, 0.0, 0.3), offset = frame(Offset{base, 0.25}, 0.0, 0.3);
  EXPECT_TRUE(has(offset.status, Status::overflow) && has(offset.status, Status::limit_frame));
  EXPECT_EQ(offset.t, f.t);
  EXPECT_EQ(offset.n, f.n);
}

// Principal curvatures of the parallel surface are κ / (1 - d κ), the directions the base's.
TEST_P(EveryOffset, HasTheCurvaturesOfAParallelSurface) {
  const Adapted& x = GetParam();
  Random random(17);
  for (int i = 0; i < 200; ++i) {
    const double u = random.uniform(0.05, 0.95), v = random.uniform(0.05, 0.95);
    const Vec2<double> at = x.at(u, v);
    const Curvature<double> own = curvature(x.surface, u, v), base = curvature(x.base, at.x, at.y);
    const double k1 = base.principal[0] / (1 - x.distance * base.principal[0]),
                 k2 = base.principal[1] / (1 - x.distance * base.principal[1]);
    const double size = std::fmax(std::fabs(k1), std::fabs(k2));
    // Jets of nested dual numbers, some 100 roundings, over the focal distance (at least a fifth) and dpdu's
    // share of its scale (at least a seventh).
    const double bound = 100 * 5 * 7 * roundoff * (1 + size);
    EXPECT_NEAR(own.principal[0], k1, bound);
    EXPECT_NEAR(own.principal[1], k2, bound);
    EXPECT_NEAR(own.mean, (k1 + k2) / 2, bound);
  }
}

// The apex of a cone: its normal depends on u, so that the parallel surface has a rim there, and a chart
// without fault.
TEST(Offset, OfAConicalPointIsRegular) {
  const Cone cone{1.0, 2.0};
  for (const double d : {0.25, -0.25})
    for (const AnySurface& s : {AnySurface(Offset{cone, d}), AnySurface(swapped(Offset{swapped(cone), d}))}) {
      const Frame<double> f = s.frame(0.3, 1.0), near = s.frame(0.3, 1 - 0x1p-20);
      EXPECT_EQ(f.status, Status::regular);
      EXPECT_LE(norm(f.t - near.t) + norm(f.b - near.b) + norm(f.n - near.n), 8 * roundoff);
      EXPECT_EQ(f.n, frame(cone, 0.3, 1.0).n);
      EXPECT_EQ(det_sign(s.jet(0.3, 1.0), f.n), f.handedness);
      EXPECT_EQ(f.handedness, d > 0 ? 1 : -1);  // inwards the focal points of the apex lie at 0
      EXPECT_NEAR(curvature(s, 0.3, 1.0).mean, -1 / (2 * d), 64 * roundoff);  // a circle's, of the radius d
    }
}

// Past one focal point of each normal the chart turns over, past both it is as before; n never changes.
TEST(Offset, TurnsOverAtFocalPoints) {
  const Torus torus{1.0, 0.25};
  Random random(9);
  int turned = 0, twice = 0;
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform(), v = random.uniform(), d = random.uniform(-2, 2);
    const Curvature<double> c = curvature(torus, u, v);
    const double first = 1 - d * c.principal[0], second = 1 - d * c.principal[1];
    if (std::fabs(first) < 1e-6 || std::fabs(second) < 1e-6) continue;  // at the focal point itself
    const AnySurface offset = Offset{torus, d};
    const Frame<double> f = offset.frame(u, v);
    EXPECT_EQ(f.handedness, first * second < 0 ? -1 : 1) << d << ' ' << u << ' ' << v;
    EXPECT_EQ(f.n, frame(torus, u, v).n);
    EXPECT_EQ(det_sign(offset.jet(u, v), f.n), f.handedness);
    // t stays on its side until the circle of latitude it runs along is turned inside out.
    const double along = 1 - d * (-sincos_turns(v).cos / (1 + 0.25 * sincos_turns(v).cos));
    EXPECT_EQ(dot(f.t, frame(torus, u, v).t) < 0, along < 0);
    if (first * second < 0) ++turned;
    if (first < 0 && second < 0) ++twice;
  }
  EXPECT_GT(turned, 100);
  EXPECT_GT(twice, 10);
}

TEST(Offset, BeyondItsFocalPointsHasAllLaws) {
  EXPECT_EQ(broken_laws(Offset{Sphere{1.0}, -1.5}, {.points = 50}), "");       // past both
  EXPECT_EQ(broken_laws(Offset{Torus{1.0, 0.25}, -0.5}, {.points = 50}), "");  // past that of the tube
  EXPECT_EQ(broken_laws(Offset{Cylinder{1.0, 1.0}, -2.0}, {.points = 50}), "");
}

// At the pole of an ellipsoid: the same, from the limits of the partials.
TEST(Offset, TurnsOverAtFocalPointsOfAPole) {
  const Ellipsoid ellipsoid{1.0, 0.7, 0.5};  // radii of curvature 2 and 0.98 at the poles
  for (const double edge : {0.0, 1.0})
    for (const auto& [d, handedness] :
         std::vector<std::pair<double, double>>{{-0.9, 1}, {-1.5, -1}, {-2.5, 1}, {3, 1}}) {
      EXPECT_EQ(AnySurface(Offset{ellipsoid, d}).frame(0.3, edge).handedness, handedness) << d;
      EXPECT_EQ(AnySurface(Offset{swapped(ellipsoid), d}).frame(edge, 0.3).handedness, -handedness) << d;
      const Reparametrised<Ellipsoid<double>> slanted{ellipsoid, {0.5, -0.5, 0.5, 0.5}, {0.25, 0}};
      EXPECT_EQ(AnySurface(Offset{slanted, d}).frame(edge, edge).handedness, handedness) << d;
    }
}

// At the focal distance itself: a line or point has no tangents; where the tube shrinks to its centre circle,
// t and n are still known.
TEST(Offset, AtItsFocalPointsSaysSo) {
  const AnySurface line = Offset{Cylinder{1.0, 1.0}, -1.0}, point = Offset{Sphere{2.0}, -2.0},
                   circle = Offset{Torus{1.0, 0.25}, -0.25};
  Random random(21);
  for (int i = 0; i < 100; ++i) {
    const double u = random.uniform(), v = random.uniform(0.01, 0.99);
    for (const AnySurface* s : {&line, &point}) {
      const Frame<double> f = s->frame(u, v);
      EXPECT_TRUE(has(f.status, Status::no_frame) && has(f.status, Status::dpdu_zero));
      EXPECT_TRUE(std::isnan(f.t.x) && std::isnan(f.n.x));
    }
    const Frame<double> f = circle.frame(u, v);
    EXPECT_TRUE(has(f.status, Status::limit_frame) && has(f.status, Status::dpdv_zero));
    EXPECT_LE(norm(f.t - frame(Torus{1.0, 0.25}, u, v).t), 16 * roundoff);
  }
}

// Beside a focal curve dpdu is a difference of nearly equal numbers: the frame is orthonormal all the same, t
// has half its digits, or the status says that it has not.
template <class S>
void expect_orthonormal_beside_focal_points(double d) {
  const Offset<Torus<S>, S> offset{{S(1), S(0.4)}, static_cast<S>(d)};
  const S u_roundoff = std::numeric_limits<S>::epsilon() / 2;
  Random random(33);
  for (int i = 0; i < 2000; ++i) {
    const S u = static_cast<S>(random.uniform()),
            v = static_cast<S>(i % 2 == 0 ? random.log_uniform(1e-9, 0.5) : 0.0683988 + 1e-6 * i / 2000);
    const Frame<S> f = frame(offset, u, v);
    if (has(f.status, Status::no_frame)) continue;
    for (const S off : {dot(f.t, f.n), dot(f.b, f.n), dot(f.t, f.b), norm(f.t) - 1, norm(f.b) - 1})
      ASSERT_LE(std::fabs(off), 8 * u_roundoff) << "d = " << d << ", v = " << v;
    const Frame<S> base = frame(offset.base, u, v);
    const S along = dot(f.t, base.t) < 0 ? S(-1) : S(1);  // on a torus t stays parallel
    if (has(f.status, Status::ill_conditioned)) continue;
    ASSERT_LE(norm(f.t - along * base.t), std::sqrt(u_roundoff)) << "d = " << d << ", v = " << v;
  }
}
TEST(Offset, IsOrthonormalBesideFocalPoints) {
  for (const double d : {-3.0, -1.5, -1.4, -0.5, -0.45, 1.0, 3.0}) {
    expect_orthonormal_beside_focal_points<double>(d);
    expect_orthonormal_beside_focal_points<float>(d);
  }
}

TEST(Offset, BesideItsFocalPointsIsIllConditioned) {
  const Offset<Torus<float>, float> torus{{1.0F, 0.4F}, -1.5F};
  EXPECT_EQ(frame(torus, 0.3F, 0.0683988F).status, Status::ill_conditioned);
  EXPECT_EQ(frame(torus, 0.3F, 0.08F).status, Status::regular);
  EXPECT_EQ(frame(Offset{Sphere{1.0}, -1 + 1e-9}, 0.3, 0.4).status, Status::ill_conditioned);
  EXPECT_EQ(frame(Offset{Sphere{1.0}, -1 + 1e-6}, 0.3, 0.4).status, Status::regular);
  // At the pole, and where the distance is that of the focal point there, t is no more known.
  EXPECT_TRUE(has(frame(Offset{Sphere{1.0}, -1 + 1e-9}, 0.3, 0.0).status, Status::ill_conditioned));
  EXPECT_TRUE(has(frame(Offset{Sphere{2.0}, -2.0}, 0.3, 0.0).status, Status::no_frame));
}

}  // namespace
}  // namespace darboux::test::offset_test
