// Limits that the second partials do not tell: surfaces by their position only, patches with several rows in one point.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/adaptors.h>
#include <darboux/bezier_patch.h>
#include <darboux/evaluate.h>

#include "every_surface.h"
#include "expect_limit.h"

namespace darboux::test {
namespace {

using Vec = Vec3<double>;

constexpr Status collapsed = dpdu_zero | limit_frame;

struct Horn {  // a torus with R = r = 1: at the axis dpdu goes with the square of the way there
  static constexpr SurfaceInfo info{"horn", "", Coordinate::turn, Coordinate::turn};
  template <class S>
  Vec3<S> position(const Turn<S>& u, const Turn<S>& v) const {
    const S d = lift<S>(1.0) + v.cos;
    return {d * u.cos, d * u.sin, v.sin};
  }
};
struct SlowSphere {  // polar angle π v²/2: both partials vanish at the south pole
  static constexpr SurfaceInfo info{"slow-sphere", "", Coordinate::turn, Coordinate::linear};
  template <class S>
  Vec3<S> position(const Turn<S>& u, const S& v) const {
    const Turn<S> w = sincos_half_turns(S(v * v * lift<S>(0.5)));
    return {w.sin * u.cos, w.sin * u.sin, lift<S>(0.0) - w.cos};
  }
};
template <int power>
struct Funnel {  // radius |v - 1/2|^power with its sign: the power is the order of dpdu's zero
  static constexpr SurfaceInfo info{"funnel", "", Coordinate::turn, Coordinate::linear};
  template <class S>
  Vec3<S> position(const Turn<S>& u, const S& v) const {
    const S w = v - lift<S>(0.5);
    S radius = w;
    for (int k = 1; k < power; ++k) radius = radius * w;
    return {radius * u.cos, radius * u.sin, w};
  }
};
struct Corner {  // both partials vanish at (0, 0): along v the normal is -x, along u it is -y
  static constexpr SurfaceInfo info{"corner", "", Coordinate::linear, Coordinate::linear};
  template <class S>
  Vec3<S> position(const S& u, const S& v) const {
    return {u * u, v * v, u * v};
  }
};
struct Blunt {  // both partials vanish along u = 0 and along v = 0; a plane all the same
  static constexpr SurfaceInfo info{"blunt", "", Coordinate::linear, Coordinate::linear};
  template <class S>
  Vec3<S> position(const S& u, const S& v) const {
    return {u * u, v * v * v, lift<S>(0.0)};
  }
};
struct InDouble {  // knows no other scalar
  static constexpr SurfaceInfo info{"in-double", "", Coordinate::linear, Coordinate::linear};
  int order = 1;
  Jet2<double> jet(double u, double v) const {
    if (order == 1) return {{u * v, v, 0}, {v, 0, 0}, {u, 1, 0}, {}, {1, 0, 0}, {}};
    return {{u * v * v, v, 0}, {v * v, 0, 0}, {2 * u * v, 1, 0}, {}, {2 * v, 0, 0}, {2 * u, 0, 0}};
  }
};

const std::vector<double> turns{0, 0.1, 0.25, 0.6, 0.9};

// Nearer than 2^-26 its own distance from the axis, 1 + cos 2πv, is rounded to zero.
TEST(LimitFrames, OfAHornTorusByItsPosition) {
  for (const double u : turns)
    for (const auto& side : {along_v, against_v})
      expect_limit(FromPosition<Horn>{}, {u, 0.5}, side, collapsed, {.decades = 7});
}

TEST(LimitFrames, WhereBothPartialsVanish) {
  for (const double u : turns)
    expect_limit(FromPosition<SlowSphere>{}, {u, 0}, along_v, collapsed | dpdv_zero);
  expect_no_limit(FromPosition<Corner>{}, {0, 0}, dpdu_zero | dpdv_zero);
  for (const double v : {0.2, 0.7}) {
    expect_limit(FromPosition<Blunt>{}, {0, v}, along_u, collapsed);
    expect_limit(FromPosition<Blunt>{}, {v, 0}, along_v, dpdv_zero | limit_frame);
  }
}

// An odd zero inside the domain turns t over, and n with it: one side's frame, and the bit that says so.
TEST(LimitFrames, OfOddOrderJumpInsideTheDomain) {
  for (const double u : turns) {
    expect_limit(FromPosition<Funnel<1>>{}, {u, 0.5}, along_v, collapsed | crease);
    expect_limit(FromPosition<Funnel<3>>{}, {u, 0.5}, along_v, collapsed | crease);
    for (const auto& side : {along_v, against_v})
      expect_limit(FromPosition<Funnel<2>>{}, {u, 0.5}, side, collapsed);
    const auto jump = [&](const auto& surface) {
      return distance(frame(surface, u, 0.5), frame(surface, u, 0.5 - 1e-9));
    };
    EXPECT_NEAR(jump(FromPosition<Funnel<1>>{}), 2, 1e-6);
    EXPECT_NEAR(jump(FromPosition<Funnel<3>>{}), 2, 1e-6);
  }
}

// The series end at the third order.
TEST(LimitFrames, OfFourthOrderAreNotFound) {
  for (const double u : turns) {
    const Frame<double> f = frame(FromPosition<Funnel<4>>{}, u, 0.5);
    EXPECT_EQ(f.status, dpdu_zero | no_frame);
    EXPECT_TRUE(all_nan(f));
  }
}

// A net whose first `rows` rows are one point, at any of the four edges.
TEST(LimitFrames, OfPatchesWithSeveralRowsInOnePoint) {
  Random random(11);
  for (int rows = 1; rows <= 3; ++rows)
    for (int trial = 0; trial < 10; ++trial) {
      // P_ij = tip + reach_j (cos φ_i, sin φ_i, 0.3 i) + a lift of the whole row
      const Vec tip{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
      std::vector<Vec> net(16);
      std::vector<double> weights(16);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
          const double reach = j < rows ? 0 : 1.0 + 0.2 * j, angle = 0.4 * i + random.uniform(0, 0.1);
          const auto at = static_cast<std::size_t>(4 * i + j);
          net[at] = tip + reach * Vec{std::cos(angle), std::sin(angle), 0.3 * i};
          weights[at] = random.uniform(0.5, 2);
        }
      const BezierPatch<double> patch(3, 3, net, weights);
      const Status both = rows == 1 ? collapsed : collapsed | dpdv_zero;
      for (const double u : {0.1, 0.5, 0.8}) {
        expect_limit(patch, {u, 0}, along_v, both, {.factor = 2000});
        const Reparametrised<BezierPatch<double>> back{patch, {1, 0, 0, -1}, {0, 1}};
        const Frame<double> a = frame(patch, u, 0.0), b = frame(back, u, 1.0);
        EXPECT_LE(norm(a.t - b.t) + norm(a.n - b.n), 64 * roundoff);
        EXPECT_EQ(b.handedness, -1);
      }
    }
}

TEST(LimitFrames, InOtherCoordinates) {
  const Reparametrised<FromPosition<SlowSphere>> swapped_sphere{{}, {0, 1, 1, 0}, {0, 0}},
      sheared{{}, {1, 0.5, 0, 1}, {0, 0}};
  for (const double x : {0.1, 0.3, 0.8}) {
    const Frame<double> f = frame(swapped_sphere, 0.0, x), near = frame(swapped_sphere, 1e-7, x);
    EXPECT_LE(distance(f, near), 1e-5);
    EXPECT_TRUE(has(f.status, limit_frame));
    const Frame<double> g = frame(sheared, x, 0.0), beside = frame(sheared, x, 1e-7);
    EXPECT_LE(distance(g, beside), 1e-5);
  }
}

TEST(LimitFrames, OfASurfaceInDoubleOnly) {
  expect_limit(InDouble{1}, {0.3, 0}, along_v, collapsed);
  const Frame<double> f = frame(InDouble{2}, 0.3, 0.0);  // would take series, and they other scalars
  EXPECT_EQ(f.status, dpdu_zero | no_frame);
  EXPECT_TRUE(all_nan(f));
}

// The same limits in single precision.
TEST(LimitFrames, InFloat) {
  for (const double u : turns) {
    const Frame<double> exact = frame(FromPosition<Horn>{}, u, 0.5);
    const Frame<float> f = frame(FromPosition<Horn>{}, static_cast<float>(u), 0.5f);
    EXPECT_EQ(f.status, exact.status);
    EXPECT_NEAR(f.t.x, exact.t.x, 1e-6);
    EXPECT_NEAR(f.n.x, exact.n.x, 1e-6);
    EXPECT_NEAR(f.n.z, exact.n.z, 1e-6);
  }
}

}  // namespace
}  // namespace darboux::test
