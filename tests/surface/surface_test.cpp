#include <limits>
#include <string>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/surface.h>

#include "every_surface.h"

namespace darboux::test::surface_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Status, EveryBitHasItsName) {
  for (std::size_t bit = 0; bit < status_names.size(); ++bit) EXPECT_FALSE(status_names[bit].empty()) << bit;
  EXPECT_EQ(static_cast<std::uint32_t>(Status::ill_conditioned), 1U << (status_names.size() - 1));
  EXPECT_EQ(status_names[0], "dpdu_zero");
  EXPECT_EQ(status_names[10], "overflow");
}

TEST(Status, IsAMask) {
  Status mask = Status::regular;
  EXPECT_FALSE(has(mask, Status::parallel));
  mask |= Status::parallel | Status::crease;
  EXPECT_TRUE(has(mask, Status::parallel));
  EXPECT_TRUE(has(mask, Status::crease | Status::overflow));
  EXPECT_FALSE(has(mask, Status::overflow));
}

TEST(Range, ContainsItsInteriorAndTheEndItIncludes) {
  EXPECT_TRUE(Range::positive().contains(std::numeric_limits<double>::denorm_min()));
  EXPECT_FALSE(Range::positive().contains(0));
  EXPECT_TRUE(Range::not_negative().contains(0));
  EXPECT_FALSE(Range::not_negative().contains(-1e-300));
  for (const Range& r : {Range::positive(), Range::not_negative(), Range{}}) {
    EXPECT_FALSE(r.contains(infinity));
    EXPECT_FALSE(r.contains(-infinity));
    EXPECT_FALSE(r.contains(std::numeric_limits<double>::quiet_NaN()));
    EXPECT_TRUE(r.contains(1));
  }
  EXPECT_EQ(describe(Range::positive(), "radius"), "0 < radius < inf");
  EXPECT_EQ(describe(Range::not_negative(), "radius"), "0 <= radius < inf");
}

TEST(Checked, NamesSurfaceParameterValueAndRange) {
  for (const auto& [radius, text] : {std::pair{0.0, "0"}, {-1.5, "-1.5"}, {infinity, "inf"}}) {
    try {
      checked(Sphere{radius});
      ADD_FAILURE() << radius << " was accepted";
    } catch (const ParameterError& error) {
      EXPECT_EQ(error.what(), std::string("sphere: radius: expected 0 < radius < inf, got ") + text);
    }
  }
  EXPECT_THROW(checked(Sphere{std::numeric_limits<double>::quiet_NaN()}), ParameterError);
  EXPECT_THROW(checked(Torus{-1.0, 1.0}), ParameterError);
  EXPECT_EQ(checked(Torus{0.0, 1.0}).minor_radius, 1);
}

TEST(Prepare, HandsEachKindItsForm) {
  EXPECT_EQ(prepare<Coordinate::linear>(0.3), 0.3);
  EXPECT_EQ(prepare<Coordinate::turn>(0.3).sin, sincos_turns(0.3).sin);
  EXPECT_EQ(prepare<Coordinate::half_turn>(0.3).cos, sincos_half_turns(0.3).cos);
  EXPECT_EQ(prepare<Coordinate::twisted_turn>(0.3).cos, sincos_half_turns(0.3).cos);
}

}  // namespace
}  // namespace darboux::test::surface_test
