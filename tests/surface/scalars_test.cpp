// Every formula runs on every scalar: float, long double, dual numbers, ceres::Jet, nested Jet, boost's and
// our own many digits, and an archetype with nothing but the arithmetic a formula may use.
#include <string>
#include <type_traits>

#include <gtest/gtest.h>
#if __has_include(<ceres/jet.h>)
#include <ceres/jet.h>
#endif

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>
#include <darboux/ceres_jet.h>

#include "archetype.h"
#include "multiprecision.h"

namespace darboux::test::scalars_test {
namespace {

constexpr double u0 = 0.3, v0 = 0.2;

// The plain number inside any scalar.
template <class S>
double plain(const S& x) {
  if constexpr (requires { Scalar<S>::value(x); })
    return plain(Scalar<S>::value(x));
  else if constexpr (requires { x.value(); })
    return x.value();
  else
    return static_cast<double>(x);
}
template <class S>
Vec3<double> plain(const Vec3<S>& a) {
  return {plain(a.x), plain(a.y), plain(a.z)};
}

// Partials and closed frame at one point over S agree with those over double.
template <class S>
void expect_same_over(double roundoff) {
  Catalogue::for_each([&](const auto& surface) {
    using X = std::remove_cvref_t<decltype(surface)>;
    const auto pu = prepare<X::info.u>(lift<S>(u0));
    const auto pv = prepare<X::info.v>(lift<S>(v0));
    const Jet2<S> j = surface.jet(pu, pv);
    const Jet2<double> expected = jet(surface, u0, v0);
    const auto near = [&](const Vec3<S>& a, const Vec3<double>& b, double scale) {
      // A few dozen operations, some on numbers ten times the result.
      EXPECT_LE(norm(plain(a) - b), 200 * roundoff * (scale + norm(b))) << X::info.name;
    };
    const double size = norm(expected.position);
    near(j.position, expected.position, size);
    near(j.dpdu, expected.dpdu, 6.3 * size);
    near(j.dpdv, expected.dpdv, 6.3 * size);
    near(j.d2pdu2, expected.d2pdu2, 40 * size);
    near(j.d2pduv, expected.d2pduv, 40 * size);
    near(j.d2pdv2, expected.d2pdv2, 40 * size);
    if constexpr (HasClosedFrame<X>) {
      const auto f = surface.frame(pu, pv);
      const Frame<double> g = frame(surface, u0, v0);
      near(f.t, g.t, 1);
      near(f.b, g.b, 1);
      near(f.n, g.n, 1);
    }
  });
}

TEST(Scalars, Float) {
  expect_same_over<float>(0x1p-24);
}
TEST(Scalars, LongDouble) {
  expect_same_over<long double>(0x1p-53);
}
TEST(Scalars, BoostMultiprecision) {
  expect_same_over<Boost40>(0x1p-53);
}
TEST(Scalars, Multiprecision) {
  expect_same_over<Multiprecision>(0x1p-53);
}
#if __has_include(<ceres/jet.h>)
TEST(Scalars, Jet) {
  expect_same_over<ceres::Jet<double, 2>>(0x1p-53);
}
TEST(Scalars, NestedJet) {
  expect_same_over<ceres::Jet<ceres::Jet<double, 2>, 2>>(0x1p-53);
}
#else
TEST(Scalars, Jet) {
  GTEST_SKIP() << "ceres/jet.h is not there";
}
#endif

// A coordinate as the formula gets it, filled with the archetype.
template <Coordinate kind, class A>
auto archetype_coordinate(double x) {
  const auto prepared = prepare<kind>(x);
  if constexpr (kind == Coordinate::linear)
    return A(prepared);
  else
    return Turn<A>{A(prepared.sin), A(prepared.cos)};
}

// Whose partials ask for an order: the torus near its axis, splines for the knot span, the helix's tube for
// the sign of its radius, powers for the sign of their base. All others have partials without a comparison.
template <class X>
constexpr bool compares = requires(const X& x) {
  x.exponent_u;
}
|| X::info.name == "torus" || X::info.name == "tube" || X::info.name == "bezier-patch" ||
    X::info.name == "bspline-patch" || X::info.name == "surface-of-revolution" ||
    X::info.name == "extrusion" || X::info.name == "ruled-surface";

TEST(Scalars, NeedNothingBeyondTheArchetype) {
  Catalogue::for_each([&](const auto& surface) {
    using X = std::remove_cvref_t<decltype(surface)>;
    using A = Archetype<compares<X>>;
    const Jet2<A> j =
        surface.jet(archetype_coordinate<X::info.u, A>(u0), archetype_coordinate<X::info.v, A>(v0));
    const Jet2<double> expected = jet(surface, u0, v0);
    // The same operations: the same bits.
    EXPECT_EQ(plain(j.position), expected.position) << X::info.name;
    EXPECT_EQ(plain(j.dpdu), expected.dpdu) << X::info.name;
    EXPECT_EQ(plain(j.dpdv), expected.dpdv) << X::info.name;
    EXPECT_EQ(plain(j.d2pdu2), expected.d2pdu2) << X::info.name;
    EXPECT_EQ(plain(j.d2pduv), expected.d2pduv) << X::info.name;
    EXPECT_EQ(plain(j.d2pdv2), expected.d2pdv2) << X::info.name;
    if constexpr (HasClosedFrame<X>) {
      using Ordered = Archetype<true>;
      const auto f = surface.frame(archetype_coordinate<X::info.u, Ordered>(u0),
                                   archetype_coordinate<X::info.v, Ordered>(v0));
      EXPECT_LE(norm(plain(f.b) - frame(surface, u0, v0).b), 4 * 0x1p-53) << X::info.name;
    }
  });
}

}  // namespace
}  // namespace darboux::test::scalars_test
