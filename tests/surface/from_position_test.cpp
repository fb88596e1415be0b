// FromPosition: a surface by its position alone.
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/from_position.h>
#include <darboux/multiprecision.h>
#include <darboux/offset.h>
#include <darboux/placed.h>
#include <darboux/testing.h>

#include "adapted.h"
#include "random.h"

namespace darboux::test::from_position_test {
namespace {

// What is made of the sphere by position alone.
struct Bump {
  static constexpr SurfaceInfo info{"bump", "a wavy ellipsoid by its position alone", Coordinate::turn,
                                    Coordinate::half_turn};
  template <class S>
  Vec3<S> position(const Turn<S>& u, const Turn<S>& v) const {
    const S one = lift<S>(1.0), wave = one + lift<S>(0.125) * v.cos * v.cos * v.cos;
    return {wave * v.sin * u.cos, lift<S>(0.75) * wave * v.sin * u.sin, -(wave * v.cos)};
  }
};
struct Valley {
  static constexpr SurfaceInfo info{"valley", "z = u² v + v³ over the unit square", Coordinate::linear,
                                    Coordinate::linear};
  template <class S>
  Vec3<S> position(const S& u, const S& v) const {
    return {u, v, u * u * v + v * v * v};
  }
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S two = lift<S>(2.0), three = lift<S>(3.0), one = lift<S>(1.0), xx = p.x * p.x, yy = p.y * p.y;
    return (p.z - xx * p.y - yy * p.y) / norm(Vec3<S>{two * (p.x * p.y), xx + three * yy, one});
  }
};
// The torus of the catalogue, by its position and parameters alone.
template <class T = double>
struct Ring {
  T major_radius{1}, minor_radius{0.25};
  static constexpr SurfaceInfo info{"ring", "a torus by its position alone", Coordinate::turn,
                                    Coordinate::turn};
  static constexpr auto parameters() {
    return std::array{parameter<&Ring::major_radius>("major_radius", Range::positive(), "length"),
                      parameter<&Ring::minor_radius>("minor_radius", Range::positive(), "length")};
  }
  template <class S>
  Vec3<S> position(const Turn<S>& u, const Turn<S>& v) const {
    const S rho = lift<S>(major_radius) + lift<S>(minor_radius) * v.cos;
    return {rho * u.cos, rho * u.sin, lift<S>(minor_radius) * v.sin};
  }
};

TEST(FromPosition, ObeysAllLaws) {
  EXPECT_EQ(broken_laws(FromPosition<Bump>{}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(FromPosition<Valley>{}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(FromPosition<Ring<>>{{1.0, 0.4}}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(Placed{FromPosition<Valley>{}, mirror, {1, 2, 3}}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(Offset{FromPosition<Ring<>>{{1.0, 0.4}}, 0.125}, {.points = law_points}), "");
}

TEST(FromPosition, HasThePartialsOfTheClosedForm) {
  const Torus<double> closed{1.5, 0.25};
  const AnySurface ring = FromPosition<Ring<>>{{1.5, 0.25}};
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform(), v = random.uniform();
    const Jet2<double> a = jet(closed, u, v), b = ring.jet(u, v);
    // Two roundings of the same sums of products, each within 8u of the scale (2π)² 1.75.
    const double bound = 16 * roundoff * 4 * std::numbers::pi * std::numbers::pi * 1.75;
    for (const auto& [x, y] : {std::pair{a.position, b.position},
                               {a.dpdu, b.dpdu},
                               {a.dpdv, b.dpdv},
                               {a.d2pdu2, b.d2pdu2},
                               {a.d2pduv, b.d2pduv},
                               {a.d2pdv2, b.d2pdv2}})
      EXPECT_LE(norm(x - y), bound);
  }
}

// Parameters are those of X: they can be set, and go to other scalars.
TEST(FromPosition, PassesParametersOn) {
  const AnySurface ring = FromPosition<Ring<>>{};
  EXPECT_EQ(ring.parameters().size(), 2U);
  EXPECT_EQ(ring.with(std::vector{3.0, 0.5}).jet(0.0, 0.0).position, (Vec3<double>{3.5, 0, 0}));
  const Multiprecision third = Multiprecision(1.0) / Multiprecision(3.0);
  const std::vector<Multiprecision> values{Multiprecision(1.0), third};
  EXPECT_EQ(ring.jet(Multiprecision(0.0), Multiprecision(0.0), values).position.x,
            Multiprecision(1.0) + third);
  EXPECT_THROW(AnySurface(FromPosition<Ring<>>{{-1.0, 0.25}}), ParameterError);
}

// At the poles of a surface by its position alone the frame is that of d2pduv.
TEST(FromPosition, HasLimitFramesAtPoles) {
  const AnySurface bump = FromPosition<Bump>{};
  for (const double pole : {0.0, 1.0}) {
    const Frame<double> f = bump.frame(0.3, pole), near = bump.frame(0.3, pole == 0 ? 1e-7 : 1 - 1e-7);
    EXPECT_TRUE(has(f.status, Status::dpdu_zero) && has(f.status, Status::limit_frame));
    EXPECT_LE(norm(f.t - near.t) + norm(f.n - near.n), 1e-5);
  }
}

}  // namespace
}  // namespace darboux::test::from_position_test
