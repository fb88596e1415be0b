#include <limits>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/surface.h>

#include "archetype.h"
#include "every_surface.h"

namespace darboux::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Status, EveryBitHasItsName) {
  for (std::size_t bit = 0; bit < status_names.size(); ++bit) EXPECT_FALSE(status_names[bit].empty()) << bit;
  EXPECT_EQ(static_cast<std::uint32_t>(Status::overflow), 1U << (status_names.size() - 1));
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
      EXPECT_EQ(error.what(),
                std::string("sphere: radius = ") + text + " is out of range, permitted is 0 < radius < inf");
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

template <class X>
class EverySurface : public ::testing::Test {};
TYPED_TEST_SUITE(EverySurface, EveryCatalogueSurface, SurfaceNames);

TYPED_TEST(EverySurface, DescribesItselfForPeople) {
  EXPECT_TRUE(ParametricSurface<TypeParam>);
  EXPECT_FALSE(TypeParam::info.summary.empty());
  for_each_parameter<TypeParam>([](const auto& p) {
    EXPECT_FALSE(p.meaning.empty()) << p.name;
    EXPECT_TRUE(p.permitted.contains(p.of(TypeParam{}))) << p.name << ": the default is out of range";
  });
}

// A consistently wrong formula is only found by a fact that does not come from it.
TYPED_TEST(EverySurface, StatesAnIndependentFact) {
  EXPECT_TRUE(StatesImplicit<TypeParam> || StatesGaussianCurvature<TypeParam>);
}

// A coordinate as the formula gets it, filled with the archetype.
template <Coordinate kind, class A>
auto archetype_coordinate(double x) {
  const auto prepared = prepare<kind>(x);
  if constexpr (kind == Coordinate::linear)
    return A(prepared);
  else
    return Turn<A>{A(prepared.sin), A(prepared.cos)};
}

template <class A>
void expect_same(const Vec3<A>& a, const Vec3<double>& b) {
  EXPECT_EQ(a.x.value(), b.x);
  EXPECT_EQ(a.y.value(), b.y);
  EXPECT_EQ(a.z.value(), b.z);
}

// Partials need + - * / and sqrt only; frames too, but for the torus, whose frame compares once.
TYPED_TEST(EverySurface, NeedsNothingBeyondTheArchetype) {
  using X = TypeParam;
  constexpr bool compares = std::is_same_v<X, Torus<double>>;
  const X surface;
  const double u = 0.3, v = 0.2;
  const auto partials = surface.jet(archetype_coordinate<X::info.u, Archetype<compares>>(u),
                                    archetype_coordinate<X::info.v, Archetype<compares>>(v));
  const Jet2<double> expected = surface.jet(prepare<X::info.u>(u), prepare<X::info.v>(v));
  expect_same(partials.position, expected.position);
  expect_same(partials.d2pduv, expected.d2pduv);
  if constexpr (HasClosedFrame<X>) {
    const auto frame = surface.frame(archetype_coordinate<X::info.u, Archetype<compares>>(u),
                                     archetype_coordinate<X::info.v, Archetype<compares>>(v));
    expect_same(frame.b, surface.frame(prepare<X::info.u>(u), prepare<X::info.v>(v)).b);
  }
}

}  // namespace
}  // namespace darboux::test
