// testing.h: the laws hold for the whole catalogue, and catch what is wrong, by name.
#include <algorithm>
#include <iostream>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/cylinder.h>
#include <darboux/error.h>
#include <darboux/extrusion.h>
#include <darboux/framed_curve.h>
#include <darboux/ruled_surface.h>
#include <darboux/sphere.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/testing.h>
#include <darboux/tube.h>

#include "every_surface.h"
#include "random.h"
#include "thinning.h"

namespace darboux::test::laws_test {
namespace {

const int parameter_sets = slow_build ? 2 : thinning() > 1 ? 10 : 20, points = std::max(200 / thinning(), 50);

using Names = std::set<std::pair<std::string, std::string>>;  // route, quantity

template <class X>
Names failed_laws(const X& surface) {
  Names result;
  for (const Check& c : check_surface(surface)) {
    EXPECT_EQ(c.surface, X::info.name);
    if (!c.passed) result.emplace(c.route, c.quantity);
  }
  return result;
}

bool contains(const Names& names, const std::string& route, const std::string& quantity) {
  return names.count({route, quantity}) == 1;
}

std::string test_name(const AnySurface& surface) {
  std::string name(surface.info().name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

class Laws : public ::testing::TestWithParam<AnySurface> {};
INSTANTIATE_TEST_SUITE_P(Catalogue, Laws, ::testing::ValuesIn(all_surfaces()),
                         [](const auto& info) { return test_name(info.param); });

TEST_P(Laws, HoldWithDefaultParameters) {
  for (const std::uint64_t seed : {1, 2}) {
    for (const Check& c : check_surface(GetParam(), {.points = 5 * points, .seed = seed})) {
      EXPECT_TRUE(c.passed) << c.surface << ' ' << c.route << ' ' << c.quantity << ": " << c.max_error
                            << " > " << c.bound << " at " << c.worst_u << ", " << c.worst_v;
      EXPECT_EQ(c.points > 0, c.skipped.empty()) << c.route << ' ' << c.quantity << ' ' << c.skipped;
    }
  }
}

// Frames and partials in double and float against 40 digits, parameters log-uniform over the magnitudes that
// each is proven for, u and v at their ends, quarter turns and down to 1e-300 too.
TEST_P(Laws, HoldInMultiprecisionOverTheProvenMagnitudes) {
  std::cout << "seed 7\n";
  EXPECT_EQ(broken_laws(GetParam(), {.points = points / 4,
                                     .seed = 7,
                                     .routes = {"high_precision", "high_precision_float"},
                                     .parameter_sets = parameter_sets}),
            "");
}

// All other laws with parameters within a factor 2 of the defaults. (Facts may cancel, and stencils cross
// what is not smooth, at wilder ones.)
TEST_P(Laws, HoldWithParametersNearTheDefaults) {
  Random random(31);
  for (int i = 0; i < 5; ++i) {
    std::vector<double> values;
    for (const ParameterValue& p : GetParam().parameters())
      values.push_back(p.value * random.log_uniform(0.5, 2));
    try {
      const AnySurface surface = GetParam().with(values);
      EXPECT_EQ(broken_laws(surface, {.points = points / 2, .seed = random.bits()}), "")
          << surface.specification();
    } catch (const ParameterError&) {
      // These do not go together.
    }
  }
}

// Every route and quantity is there, under its name, so that a law cannot be lost unnoticed.
TEST_P(Laws, CoverEveryRouteAndPartial) {
  Names names;
  for (const Check& c : check_surface(GetParam(), {.points = 10, .seed = 1}))
    names.emplace(c.route, c.quantity);
  for (const char* route : {"dual", "central2", "central4", "central6", "central8", "one_sided8", "ridders",
                            "high_precision", "high_precision_float"})
    for (const char* partial : {"dpdu", "dpdv", "d2pdu2", "d2pduv", "d2pdv2"})
      EXPECT_TRUE(contains(names, route, partial)) << route << ' ' << partial;
  for (const char* route : {"dual", "high_precision", "high_precision_float"})
    for (const char* vector : {"tangent", "bitangent", "normal"})
      EXPECT_TRUE(contains(names, route, vector)) << route << ' ' << vector;
  EXPECT_TRUE(contains(names, "dual", "handedness"));
  EXPECT_TRUE(contains(names, "high_precision", "status"));
  EXPECT_TRUE(contains(names, "high_precision_float", "status"));
  EXPECT_TRUE(contains(names, "implicit", "normal"));
  EXPECT_TRUE(contains(names, "high_precision", "orthonormality"));
  EXPECT_TRUE(contains(names, "implicit", "position"));
  EXPECT_TRUE(contains(names, "second_formula", "position"));
  EXPECT_TRUE(contains(names, "curvature", "gaussian_curvature"));
  EXPECT_TRUE(contains(names, "curvature", "mean_curvature"));
  EXPECT_TRUE(contains(names, "gauss", "gaussian_curvature"));
  EXPECT_TRUE(contains(names, "codazzi", "dL/dv - dM/du"));
  EXPECT_TRUE(contains(names, "gauss_bonnet", "gaussian_curvature"));
  EXPECT_TRUE(contains(names, "periodicity", "position"));
  for (const char* quantity : {"position", "dpdu", "dpdv"})
    EXPECT_TRUE(contains(names, "continuity", quantity)) << quantity;
  std::set<std::string> routes;
  for (const auto& [route, quantity] : names) routes.insert(route);
  routes.insert("high_precision_forms");  // runs only where it is named
  EXPECT_EQ(routes, std::set<std::string>(check_routes().begin(), check_routes().end()));
}

// A consistently wrong formula is only found by a fact that does not come from it.
TEST_P(Laws, IncludeAnIndependentFact) {
  EXPECT_FALSE(GetParam().facts().empty());
}

// A torus with one thing wrong. Everything is the torus' own but what `Damage` does.
template <class Damage>
struct Mutant {
  Torus<double> torus;
  Damage damage;
  static constexpr SurfaceInfo info{"mutant", "a torus with a fault", Coordinate::turn, Coordinate::turn};

  template <class S>
  Jet2<S> jet(const Turn<S>& u, const Turn<S>& v) const {
    Jet2<S> j = torus.jet(u, v);
    if constexpr (requires { damage(j); }) damage(j);
    return j;
  }
  template <class S>
  Frame<S> frame(const Turn<S>& u, const Turn<S>& v) const {
    Frame<S> f = torus.frame(u, v);
    if constexpr (requires { damage(f); }) damage(f);
    return f;
  }
  template <class S>
  S implicit(const Vec3<S>& p) const {
    return torus.implicit(p);
  }
  template <class S>
  S gaussian_curvature(const Turn<S>& u, const Turn<S>& v) const {
    return torus.gaussian_curvature(u, v);
  }
};

template <class Damage>
Names failed_with(Damage damage) {
  const Mutant<Damage> mutant{{1, 0.4}, damage};
  return failed_laws(mutant);
}

template <int which, class S>
Vec3<S>& partial(Jet2<S>& j) {
  if constexpr (which == 1)
    return j.dpdu;
  else if constexpr (which == 2)
    return j.dpdv;
  else if constexpr (which == 3)
    return j.d2pdu2;
  else if constexpr (which == 4)
    return j.d2pduv;
  else
    return j.d2pdv2;
}

template <int which>
void expect_a_wrong_partial_is_named() {
  constexpr std::array names{"position", "dpdu", "dpdv", "d2pdu2", "d2pduv", "d2pdv2"};
  const std::string name = names[which];
  const auto expect_named = [&](const Names& failed, const std::string& what) {
    for (const char* route : {"dual", "central2", "central4", "central6", "central8", "ridders"})
      EXPECT_TRUE(contains(failed, route, name)) << what << " of " << name << " passes " << route;
  };
  expect_named(failed_with([]<class S>(Jet2<S>& j) { partial<which>(j).x = -partial<which>(j).x; }),
               "wrong sign of x");
  expect_named(failed_with([]<class S>(Jet2<S>& j) { partial<which>(j) = lift<S>(0.5) * partial<which>(j); }),
               "half the length");
  expect_named(failed_with([]<class S>(Jet2<S>& j) {
                 partial<which>(j).y = lift<S>(1 + 0x1p-18) * partial<which>(j).y;
               }),
               "four parts in a million of y");
}

TEST(Mutants, AWrongPartialIsNamedByEveryDerivativeRoute) {
  EXPECT_EQ(failed_with([] {}), Names{});  // the control: nothing wrong, nothing found
  expect_a_wrong_partial_is_named<1>();
  expect_a_wrong_partial_is_named<2>();
  expect_a_wrong_partial_is_named<3>();
  expect_a_wrong_partial_is_named<4>();
  expect_a_wrong_partial_is_named<5>();
}

// A wrong second partial leaves the first ones alone, and the frame.
TEST(Mutants, TheRightPartialsAreNotBlamed) {
  const Names failed = failed_with([]<class S>(Jet2<S>& j) { j.d2pdv2 = -j.d2pdv2; });
  EXPECT_EQ(failed, (Names{{"dual", "d2pdv2"},
                           {"central2", "d2pdv2"},
                           {"central4", "d2pdv2"},
                           {"central6", "d2pdv2"},
                           {"central8", "d2pdv2"},
                           {"ridders", "d2pdv2"},
                           {"curvature", "gaussian_curvature"},
                           {"gauss", "gaussian_curvature"},
                           {"codazzi", "dL/dv - dM/du"}}));
}

TEST(Mutants, AWrongFrameIsNamed) {
  EXPECT_EQ(failed_with([]<class S>(Frame<S>& f) { f.handedness = -f.handedness; }),
            (Names{{"dual", "handedness"},
                   {"dual", "normal"},
                   {"high_precision", "bitangent"},
                   {"high_precision", "normal"},
                   {"high_precision_float", "bitangent"},
                   {"high_precision_float", "normal"}}));
  EXPECT_TRUE(contains(failed_with([]<class S>(Frame<S>& f) { f.n = -f.n; }), "dual", "normal"));
  EXPECT_EQ(
      failed_with([]<class S>(Frame<S>& f) { f.b = -f.b; }),
      (Names{{"dual", "bitangent"}, {"high_precision", "bitangent"}, {"high_precision_float", "bitangent"}}));
  EXPECT_TRUE(contains(failed_with([]<class S>(Frame<S>& f) { f.t = -f.t; }), "dual", "tangent"));
}

// 2r in place of r everywhere is a perfect surface, only not this one.
struct Inflated {
  static constexpr SurfaceInfo info{"inflated", "a torus with 2r in place of r", Coordinate::turn,
                                    Coordinate::turn};
  Torus<double> stated{1, 0.3}, written{1, 0.6};
  template <class S>
  Jet2<S> jet(const Turn<S>& u, const Turn<S>& v) const {
    return written.jet(u, v);
  }
  template <class S>
  Frame<S> frame(const Turn<S>& u, const Turn<S>& v) const {
    return written.frame(u, v);
  }
  template <class S>
  S implicit(const Vec3<S>& p) const {
    return stated.implicit(p);
  }
  template <class S>
  S gaussian_curvature(const Turn<S>& u, const Turn<S>& v) const {
    return stated.gaussian_curvature(u, v);
  }
};

TEST(Mutants, AConsistentlyWrongSurfaceIsFoundByItsFactsOnly) {
  EXPECT_EQ(failed_laws(Inflated{}), (Names{{"implicit", "position"}, {"curvature", "gaussian_curvature"}}));
}

struct Saddle {
  static constexpr SurfaceInfo info{"saddle", "z = u v", Coordinate::linear, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    return {.position = {u, v, u * v},
            .dpdu = {one, zero, v},
            .dpdv = {zero, one, u},
            .d2pdu2 = {zero, zero, zero},
            .d2pduv = {zero, zero, one},
            .d2pdv2 = {zero, zero, zero}};
  }
};

// An equation of the right surface whose value is twice the distance.
struct Doubled : Sphere<double> {
  template <class S>
  S implicit(const Vec3<S>& p) const {
    return lift<S>(2.0) * Sphere<double>::implicit(p);
  }
  template <class To>
  Sphere<To> rebind() const {
    return {};
  }
};
TEST(Mutants, AnEquationThatIsNoDistanceIsFoundByItsGradient) {
  EXPECT_EQ(failed_laws(Doubled{}), (Names{{"implicit", "normal"}}));
}

// Zeros of the partials that are not told, or told where there are none.
struct Silent : Sphere<double> {
  template <class S>
  Status singular(const Turn<S>&, const Turn<S>&) const {
    return Status::regular;
  }
  template <class To>
  Silent rebind() const {
    return {};
  }
};
struct Alarmed : Sphere<double> {
  template <class S>
  Status singular(const Turn<S>&, const Turn<S>& v) const {
    return v.cos > lift<S>(0.5) ? Status::dpdu_zero : Status::regular;
  }
  template <class To>
  Alarmed rebind() const {
    return {};
  }
};
TEST(Mutants, AWrongStatusIsNamed) {
  EXPECT_TRUE(contains(failed_laws(Silent{}), "high_precision", "status"));
  EXPECT_TRUE(contains(failed_laws(Alarmed{}), "high_precision", "status"));
}

// A cylinder of which one half hides behind a flag: the laws that leave out limits and missing frames do not
// see it.
template <class Damage>
struct Excused {
  static constexpr SurfaceInfo info{"excused", "a cylinder with a fault", Coordinate::turn,
                                    Coordinate::linear};
  Damage damage;
  Cylinder<double> cylinder{};
  template <class S>
  Jet2<S> jet(const Turn<S>& u, const S& v) const {
    return cylinder.jet(u, v);
  }
  template <class S>
  Frame<S> frame(const Turn<S>& u, const S& v) const {
    Frame<S> f = cylinder.frame(u, v);
    if (u.sin > S(0)) damage(f);
    return f;
  }
};
template <class Damage>
void expect_not_excused(const std::string& what, Damage damage) {
  EXPECT_TRUE(contains(failed_laws(Excused<Damage>{damage}), "high_precision", "status")) << what;
}
TEST(Mutants, AFlagExcusesNoFrame) {
  expect_not_excused("a wrong limit", []<class S>(Frame<S>& f) {
    f = {.t = {1, 0, 0}, .b = {0, 1, 0}, .n = {0, 0, 1}, .status = Status::limit_frame};
  });
  expect_not_excused("no frame", []<class S>(Frame<S>& f) { f = detail::no_frame<S>(); });
  expect_not_excused("NaN", []<class S>(Frame<S>& f) { f.t.x = std::numeric_limits<S>::quiet_NaN(); });
  expect_not_excused("a limit that is none", []<class S>(Frame<S>& f) { f.status |= Status::limit_frame; });
}

// The formula ends where its domain does: the inputs beside the edge are looked at from inside.
struct Hemisphere {
  static constexpr SurfaceInfo info{
      "hemisphere", "z = sqrt(1 - v²) turned about z", Coordinate::turn, Coordinate::linear, {"v=0", "v=1"}};
  template <class S>
  Jet2<S> jet(const Turn<S>& u, const S& v) const {
    using std::sqrt;
    const S zero = lift<S>(0.0), one = lift<S>(1.0), z = sqrt((one - v) * (one + v)), tau = two_pi<S>();
    return {.position = {v * u.cos, v * u.sin, z},
            .dpdu = {-(tau * (v * u.sin)), tau * (v * u.cos), zero},
            .dpdv = {u.cos, u.sin, -(v / z)},
            .d2pdu2 = {-(tau * (tau * (v * u.cos))), -(tau * (tau * (v * u.sin))), zero},
            .d2pduv = {-(tau * u.sin), tau * u.cos, zero},
            .d2pdv2 = {zero, zero, -(one / (z * z * z))}};
  }
};
TEST(Laws, LookAtAnEdgeFromInside) {
  EXPECT_EQ(broken_laws(Hemisphere{}, {.points = 20, .routes = {"high_precision", "high_precision_float"}}),
            "");
}

// z = f(u), with something at u = 0.3: a corner, a cliff, a corner that the status tells or that a steep hill
// at u = 0.7 stands beside, the hill alone, no value nearby, and |u - 0.3|^1.5, whose second derivative is
// infinite.
enum class At03 { corner, cliff, known_corner, corner_and_hill, hill, nothing, power };
template <At03 what>
struct Profile {
  static constexpr SurfaceInfo info{"profile", "z = f(u)", Coordinate::linear, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    using std::sqrt;
    const S zero = lift<S>(0.0), one = lift<S>(1.0), x = u - lift<S>(0.3), size = x < zero ? -x : x,
            side = x < zero ? -one : one;
    S z = zero, dz = zero, d2z = zero;
    if (what == At03::hill || what == At03::corner_and_hill) {  // rises by 2 over some 1e-4
      const S k = lift<S>(1e4), t = k * (u - lift<S>(0.7)), w = one / (one + t * t);
      const S root = sqrt(w);
      z = t * root, dz = k * w * root, d2z = -(lift<S>(3.0) * k * k * t * w * w * root);
    }
    if (what == At03::corner || what == At03::known_corner) z = size, dz = side;
    if (what == At03::corner_and_hill) z = z + lift<S>(1e4) * size, dz = dz + lift<S>(1e4) * side;
    if (what == At03::cliff) z = zero < x ? one : zero;
    if (what == At03::nothing)
      z = sqrt(size - lift<S>(0.004)), dz = side / (z + z), d2z = -(one / (z * z * z));
    if (what == At03::power)
      z = size * sqrt(size), dz = lift<S>(1.5) * side * sqrt(size), d2z = lift<S>(0.75) / sqrt(size);
    return {.position = {u, v, z},
            .dpdu = {one, zero, dz},
            .dpdv = {zero, one, zero},
            .d2pdu2 = {zero, zero, d2z},
            .d2pduv = {zero, zero, zero},
            .d2pdv2 = {zero, zero, zero}};
  }
  template <class S>
  Status singular(const S& u, const S&) const {
    return what == At03::known_corner && !(u < lift<S>(0.3)) && !(lift<S>(0.3) < u) ? Status::crease
                                                                                    : Status::regular;
  }
};

// Points and differences miss it: the places are as narrow as doubles are.
TEST(Laws, FindCornersAndCliffsBetweenThePoints) {
  const auto broken = [](const AnySurface& surface) {
    const CheckOptions options{.points = 20, .routes = {"continuity"}};
    const std::vector<Check> checks = check_surface(surface, options);
    EXPECT_EQ(checks.size(), 3u);
    for (const Check& c : checks) EXPECT_GE(c.points, 40) << c.quantity;
    return broken_laws(surface, options);
  };
  for (const std::string& corner :
       {broken(Profile<At03::corner>{}), broken(Profile<At03::corner_and_hill>{})}) {
    EXPECT_EQ(corner.find("profile: continuity of dpdu: expected an error of at most"), 0u) << corner;
    EXPECT_NE(corner.find("at u = 0.3"), std::string::npos) << corner;
    EXPECT_EQ(corner.find("position"), std::string::npos) << corner;
  }
  for (const std::string& cliff : {broken(Profile<At03::cliff>{}), broken(Profile<At03::nothing>{})})
    EXPECT_EQ(cliff.find("profile: continuity of position: expected an error of at most"), 0u) << cliff;
  EXPECT_EQ(broken(Profile<At03::known_corner>{}), "");
  EXPECT_EQ(broken(Profile<At03::hill>{}), "");
  EXPECT_EQ(broken(Profile<At03::power>{}), "");
}

// Across an inner knot nothing is differentiated: the surfaces on a spline know its knots.
TEST(Breaks, AreTheKnotsOfTheCurves) {
  const BSplineCurve<double> curve(2, {0, 0, 0, 0.25, 0.5, 1, 1, 1},
                                   {{1, 0, 0}, {1, 0, 1}, {2, 0, 1}, {3, 0, 3}, {3, 0, 4}}),
      other(2, {0, 0, 0, 0.5, 0.75, 1, 1, 1}, {{1, 4, 0}, {1, 5, 1}, {2, 4, 1}, {3, 6, 3}, {3, 4, 4}});
  const std::vector<double> none, knots{0.25, 0.5};
  const auto expect = [&](const AnySurface& surface, const std::vector<double>& u,
                          const std::vector<double>& v) {
    EXPECT_EQ(surface.breaks(0), u) << surface.info().name;
    EXPECT_EQ(surface.breaks(1), v) << surface.info().name;
    EXPECT_EQ(broken_laws(surface, {.points = points}), "");
  };
  expect(Extrusion{curve, Vec3<double>{0, 1, 0.5}}, knots, none);
  expect(SurfaceOfRevolution{curve}, none, knots);
  expect(RuledSurface{curve, other}, {0.25, 0.5, 0.75}, none);
}

// A saddle with nothing but a formula: what it does not state is skipped by name, never silently true.
TEST(Skipped, AbsentFactsAreNamed) {
  Names skipped;
  for (const Check& c : check_surface(Saddle{})) {
    EXPECT_TRUE(c.passed) << c.route << ' ' << c.quantity;
    EXPECT_EQ(c.points == 0, !c.skipped.empty()) << c.route << ' ' << c.quantity;
    if (!c.skipped.empty()) skipped.emplace(c.route, c.quantity);
  }
  EXPECT_EQ(skipped, (Names{{"implicit", "position"},
                            {"implicit", "normal"},
                            {"second_formula", "position"},
                            {"curvature", "gaussian_curvature"},
                            {"curvature", "mean_curvature"},
                            {"gauss_bonnet", "gaussian_curvature"},
                            {"periodicity", "position"}}));
}

// All on one line: there is no frame anywhere.
struct Line3 {
  static constexpr SurfaceInfo info{"line", "(u + v) (1, 1, 1)", Coordinate::linear, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const S w = u + v, one(1.0), zero(0.0);
    return {{w, w, w},          {one, one, one},    {one, one, one},
            {zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
  }
};

TEST(Skipped, NothingToCompareIsAFailureThatSaysSo) {
  EXPECT_EQ(broken_laws(Line3{}, {.points = 20, .routes = {"dual"}}),
            "line: dual of tangent: no point could be compared\n"
            "line: dual of bitangent: no point could be compared\n"
            "line: dual of normal: no point could be compared\n");
}

// A surface that is NaN somewhere does not pass because NaN compares with nothing.
struct Torn {
  static constexpr SurfaceInfo info{"torn", "z = sqrt(u - 1/2)", Coordinate::linear, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    using std::sqrt;
    const S zero = lift<S>(0.0), one = lift<S>(1.0), z = sqrt(u - lift<S>(0.5)), two = lift<S>(2.0);
    return {.position = {u, v, z},
            .dpdu = {one, zero, one / (two * z)},
            .dpdv = {zero, one, zero},
            .d2pdu2 = {zero, zero, -(one / (two * two * z * z * z))},
            .d2pduv = {zero, zero, zero},
            .d2pdv2 = {zero, zero, zero}};
  }
};

TEST(Mutants, ASurfaceThatIsNanSomewhereFails) {
  EXPECT_NE(broken_laws(Torn{}), "");
}

TEST(CheckSurface, RunsTheRoutesAskedForAndRefusesUnknownOnes) {
  for (const Check& c : check_surface(Torus{}, {.points = 20, .routes = {"dual", "gauss"}}))
    EXPECT_TRUE(c.route == "dual" || c.route == "gauss") << c.route;
  EXPECT_THROW(check_surface(Torus{}, {.routes = {"duel"}}), ParameterError);
  EXPECT_THROW(check_surface(Torus{}, {.points = 0}), ParameterError);
  EXPECT_THROW(check_surface(Torus{}, {.parameter_sets = -1}), ParameterError);
}

TEST(CheckSurface, IsDeterministicAndRefusesBadParameters) {
  const auto first = check_surface(Torus{}, {.points = 50, .seed = 7}),
             second = check_surface(Torus{}, {.points = 50, .seed = 7});
  ASSERT_EQ(first.size(), second.size());
  EXPECT_TRUE(std::equal(first.begin(), first.end(), second.begin(), [](const Check& a, const Check& b) {
    return a.max_error == b.max_error && a.worst_u == b.worst_u && a.points == b.points;
  }));
  EXPECT_THROW(check_surface(Sphere{-1.0}), ParameterError);
}

// A tube's curve may have sizes of its own, and its radius be 1e115 of them: no direction across dpdv is then
// left in 40 digits, nor the side of the chart in 16.
TEST(Laws, HoldForATubeRoundACurveThatIsNoParameter) {
  std::cout << "seed 7\n";
  const Tube upright{UprightCurve<HelixCurve<>>{{1, 0.25, 1}, {0, 0, 1}}, 0.1};
  EXPECT_EQ(broken_laws(upright, {.points = 50,
                                  .seed = 7,
                                  .routes = {"high_precision", "high_precision_float"},
                                  .parameter_sets = 10}),
            "");
}

// At the edge of what is permitted: a horn torus, tori far thicker and thinner than their rings, sizes near
// the range of double. A route that cannot resolve them says so; none may fail.
TEST(Laws, HoldAtExtremeParameters) {
  for (const AnySurface& surface :
       {make_surface("torus:major_radius=1,minor_radius=1"),
        // At v = 1/3 the ring's radius changes its sign, which a float near that cannot know.
        make_surface("torus:major_radius=1,minor_radius=2"),
        make_surface("torus:major_radius=1e6,minor_radius=1"),
        make_surface("torus:major_radius=0,minor_radius=2"), make_surface("sphere:radius=1e150"),
        make_surface("sphere:radius=1e-150"), make_surface("sphere:radius=1e-60"),
        make_surface("torus:major_radius=1e-70,minor_radius=3e-71"), make_surface("sphere:radius=1e308"),
        make_surface("cylinder:radius=1e-9,height=1e9")})
    for (const Check& check : check_surface(surface))
      EXPECT_TRUE(check.passed) << surface.specification() << ' ' << check.route << ' ' << check.quantity
                                << ' ' << check.max_error << " > " << check.bound;
}

}  // namespace
}  // namespace darboux::test::laws_test
