// Limits that the second partials do not tell: surfaces by their position only, patches with several rows in
// one point.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/evaluate.h>
#include <darboux/from_position.h>
#include <darboux/offset.h>
#include <darboux/placed.h>
#include <darboux/reparametrised.h>

#include "every_surface.h"
#include "expect_limit.h"
#include "random.h"

namespace darboux::test::limit_frames_test {
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
struct Pole {  // u from a point, v round it
  static constexpr SurfaceInfo info{"pole", "", Coordinate::linear, Coordinate::turn};
  template <class S>
  Vec3<S> position(const S& u, const Turn<S>& v) const {
    return {u * v.cos, u * v.sin, u};
  }
};
struct Developable {  // of a twisted cubic
  static constexpr SurfaceInfo info{"developable", "", Coordinate::linear, Coordinate::linear};
  template <class S>
  Vec3<S> position(const S& u, const S& v) const {
    const S two = lift<S>(2.0), three = lift<S>(3.0);
    return {u + v, u * u + two * (u * v), u * u * u + three * (u * u * v)};
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

// A patch of which `rows` rows of the net are one point, at the edge v = 0, v = 1, u = 0 or u = 1 (edge 0 to
// 3), and what leads to that edge.
struct Fan {
  BezierPatch<double> patch;
  Vec2<double> inward;
  Status zero;  // the partial along the edge; the other vanishes too for several rows
  Vec2<double> at(double x) const {
    return inward.y > 0   ? Vec2<double>{x, 0}
           : inward.y < 0 ? Vec2<double>{x, 1}
           : inward.x > 0 ? Vec2<double>{0, x}
                          : Vec2<double>{1, x};
  }
};
Fan fan(Random& random, int rows, int edge) {
  const Vec tip{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
  std::vector<Vec> net(16);
  std::vector<double> weights(16);
  for (int i = 0; i < 4; ++i)      // along the edge
    for (int j = 0; j < 4; ++j) {  // away from it
      const double reach = j < rows ? 0 : 1.0 + 0.2 * j, angle = 0.4 * i + random.uniform(0, 0.1);
      const int along = edge % 2 == 1 ? 3 - j : j, at = edge < 2 ? 4 * i + along : 4 * along + i;
      net[static_cast<std::size_t>(at)] = tip + reach * Vec{std::cos(angle), std::sin(angle), 0.3 * i};
      weights[static_cast<std::size_t>(at)] = random.uniform(0.5, 2);
    }
  constexpr std::array<Vec2<double>, 4> inward{along_v, against_v, along_u, against_u};
  return {BezierPatch<double>(3, 3, net, weights), inward[static_cast<std::size_t>(edge)],
          edge < 2 ? dpdu_zero : dpdv_zero};
}
constexpr Law of_patches{.factor = 5000};

TEST(LimitFrames, OfPatchesWithSeveralRowsInOnePoint) {
  Random random(11);
  for (int rows = 1; rows <= 3; ++rows)
    for (int trial = 0; trial < 8; ++trial) {
      const Fan f = fan(random, rows, trial % 4);
      const Status bits = (rows == 1 ? f.zero : dpdu_zero | dpdv_zero) | limit_frame;
      for (const double x : {0.1, 0.5, 0.8}) expect_limit(f.patch, f.at(x), f.inward, bits, of_patches);
    }
}

// What an adaptor makes of a limit is the limit of what it makes: at the point of the adaptor's square that
// the map takes to (u, v) of the base, approached as the base is.
TEST(LimitFrames, InOtherCoordinates) {
  Random random(12);
  const auto expect_adapted = [](const auto& base, const Vec2<double>& at, const Vec2<double>& inward) {
    const std::array<std::array<double, 4>, 6> maps{
        {{0, 1, 1, 0}, {1, 0, 0, -1}, {1, 0.3, 0, 1}, {1, 0, 0.3, 1}, {0.5, -0.4, 0.3, 0.7}, {1, 0, -1, 1}}};
    for (const auto& M : maps) {
      SCOPED_TRACE(::testing::Message() << M[0] << " " << M[1] << " " << M[2] << " " << M[3] << ", base "
                                        << base.info.name << " at " << at.x << ", " << at.y);
      const double determinant = M[0] * M[3] - M[1] * M[2];
      const auto inverse = [&](const Vec2<double>& p) {
        return Vec2<double>{(M[3] * p.x - M[1] * p.y) / determinant, (M[0] * p.y - M[2] * p.x) / determinant};
      };
      const Vec2<double> here{0.5, 0.5}, step = inverse(inward);  // (0.5, 0.5) goes to `at`
      const Reparametrised adapted{base, M, {at.x - (M[0] + M[1]) / 2, at.y - (M[2] + M[3]) / 2}};
      const Frame<double> f = frame(adapted, here.x, here.y),
                          near = frame(adapted, here.x + 1e-6 * step.x, here.y + 1e-6 * step.y);
      ASSERT_TRUE(finite(f));
      EXPECT_LE(distance(f, near), 5e-3);
      EXPECT_EQ(f.handedness, near.handedness);
      EXPECT_TRUE(has(f.status, limit_frame));
      EXPECT_TRUE(has(f.status, dpdu_zero | dpdv_zero | parallel));
      EXPECT_NEAR(dot(f.t, f.n), 0, 8 * roundoff);
      const ParametricFrame<double> p = parametric_frame(adapted, here.x, here.y),
                                    beside = parametric_frame(adapted, here.x + 1e-6 * step.x,
                                                              here.y + 1e-6 * step.y);
      EXPECT_LE(norm(p.b - beside.b), 5e-3);
    }
  };
  for (int rows = 1; rows <= 3; ++rows)
    for (int edge = 0; edge < 4; ++edge) {
      // On the corners of a binary grid, so that the map leads exactly to the edge.
      const Fan f = fan(random, rows, edge);
      expect_adapted(f.patch, f.at(0.25), f.inward);
      expect_adapted(Placed{f.patch, {0, -1, 0, 2, 0, 0, 0, 0, 1}, Vec{1, 2, 3}}, f.at(0.25), f.inward);
    }
  expect_adapted(FromPosition<SlowSphere>{}, {0.125, 0}, along_v);
  expect_adapted(FromPosition<Pole>{}, {0, 0.125}, along_u);
  expect_adapted(FromPosition<Developable>{}, {0.25, 0}, along_v);
}

// What an adaptor says of the point is what its base says.
TEST(LimitFrames, KeepTheirBitsInAdaptors) {
  const std::array<double, 9> turned{0, -1, 0, 1, 0, 0, 0, 0, 1};
  const Placed<FromPosition<Funnel<1>>> placed{{}, turned, {}};
  EXPECT_EQ(frame(placed, 0.1, 0.5).status, collapsed | crease);
  EXPECT_EQ(frame(flipped_v(FromPosition<Funnel<3>>{}), 0.1, 0.5).status, collapsed | crease);
  EXPECT_EQ(frame(swapped(FromPosition<Funnel<1>>{}), 0.5, 0.1).status, dpdv_zero | limit_frame | crease);
  EXPECT_EQ(frame(Reparametrised<FromPosition<Funnel<1>>>{{}, {1, 0, 0.5, 1}, {0, 0}}, 0.5, 0.25).status,
            parallel | limit_frame | crease);
}

// A parallel surface has its position there, and no frame.
TEST(LimitFrames, OfHigherOrderAreNoneOfAnOffset) {
  Random random(13);
  for (int rows = 2; rows <= 3; ++rows) {
    const Fan f = fan(random, rows, 0);
    const Offset parallel_surface{f.patch, 0.25};
    const Sample<double> s = sample(parallel_surface, 0.5, 0.0);
    const Frame<double> of_base = frame(f.patch, 0.5, 0.0);
    EXPECT_TRUE(has(s.frame.status, no_frame));
    EXPECT_TRUE(all_nan(s.frame));
    EXPECT_LE(norm(s.jet.position - (jet(f.patch, 0.5, 0.0).position + 0.25 * of_base.n)), 16 * roundoff);
  }
}

TEST(LimitFrames, OfASurfaceInDoubleOnly) {
  expect_limit(InDouble{1}, {0.3, 0}, along_v, collapsed);
  EXPECT_EQ(frame(swapped(InDouble{1}), 0.0, 0.3).status, dpdv_zero | limit_frame);
  EXPECT_EQ(frame(swapped(swapped(InDouble{1})), 0.3, 0.0).status, collapsed);
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
    for (const auto& [x, y] : {std::pair{f.t, exact.t}, {f.b, exact.b}, {f.n, exact.n}})
      EXPECT_LE(norm(Vec{x.x, x.y, x.z} - y), 1e-6);
  }
}

}  // namespace
}  // namespace darboux::test::limit_frames_test
