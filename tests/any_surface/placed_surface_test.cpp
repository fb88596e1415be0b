// The truth at uvs that miss a pole by their roundings.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/placed_surface.h>

namespace darboux::placed_surface_test {
namespace {

// A disk with its centre at v = 0, and no frame of its own: beyond the centre dpdu points the other way, and
// so would t and n.
struct PlainDisk {
  static constexpr SurfaceInfo info{"plain-disk", "a disk", Coordinate::turn, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S zero = lift<S>(0.0), turn = two_pi<S>();
    return {.position = {v * u.cos, v * u.sin, zero},
            .dpdu = {-(turn * v * u.sin), turn * v * u.cos, zero},
            .dpdv = {u.cos, u.sin, zero},
            .d2pdu2 = {-(turn * turn * v * u.cos), -(turn * turn * v * u.sin), zero},
            .d2pduv = {-(turn * u.sin), turn * u.cos, zero},
            .d2pdv2 = {zero, zero, zero}};
  }
};

TEST(PlacedSurface, UvsThatMissAPoleByRoundingsMeanIt) {
  PlacedSurface placed{AnySurface(PlainDisk{})};
  // Small and far off in an atlas: v = 50 stored - 25, which floats round by some 1e-6.
  placed.uv = {"affine", {1, 0, 0, 50, 0, -25}};
  for (const double u : {0.1, 0.35, 0.8}) {
    const double x = 2 * std::numbers::pi * u;
    for (const double off : {-2e-7, -1e-8, 0.0, 1e-8, 2e-7}) {
      const Truth truth = placed.truth({u, 0.5 + off});
      SCOPED_TRACE(::testing::Message() << u << ' ' << off);
      EXPECT_TRUE(truth.pole);
      EXPECT_NEAR(truth.tangent.x, -std::sin(x), 1e-6);
      EXPECT_NEAR(truth.tangent.y, std::cos(x), 1e-6);
      EXPECT_NEAR(std::fabs(truth.normal.z), 1, 1e-12);
      EXPECT_GT(truth.normal.z * placed.truth({u, 0.6}).normal.z, 0);
    }
    EXPECT_FALSE(placed.truth({u, 0.5 + 1e-5}).pole);
  }
}

}  // namespace
}  // namespace darboux::placed_surface_test
