// stability.h: Darboux keeps its bounds where evaluation is hard, and what does not is found and named.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include <darboux/bspline_patch.h>
#include <darboux/curvature.h>
#include <darboux/error.h>
#include <darboux/forms.h>
#include <darboux/moebius_strip.h>
#include <darboux/reparametrised.h>
#include <darboux/shape_operator.h>
#include <darboux/stability.h>

#include "every_surface.h"
#include "random.h"
#include "thinning.h"

namespace darboux::test::stability_test {
namespace {

using Curves = std::vector<StabilityCurve>;

StabilityOptions everything(std::vector<AnySurface> surfaces) {
  StabilityOptions options;
  options.surfaces = std::move(surfaces);
  for (const StabilitySweep& sweep : stability_sweeps()) options.sweeps.push_back(&sweep);
  for (const StabilityRoute& route : stability_routes()) options.routes.push_back(&route);
  if (slow_build) options.points = 8;
  options.samples = std::max(options.samples / thinning(), 1);
  return options;
}

Curves with(const Curves& curves, auto which) {
  Curves result;
  std::copy_if(curves.begin(), curves.end(), std::back_inserter(result), which);
  return result;
}

std::string text_of(const StabilityCurve& c) {
  return c.surface + " " + std::string(c.sweep) + " " + std::string(c.route) + " " + c.worst.member + ": " +
         std::to_string(c.worst.error_u) + " of " + std::to_string(c.worst.bound_u) +
         " at x = " + std::to_string(c.worst.x);
}

// ---- the law ----------------------------------------------------------------------------------------------

class EverySurface : public ::testing::TestWithParam<AnySurface> {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EverySurface, ::testing::ValuesIn(all_surfaces()), [](const auto& info) {
  std::string name(info.param.info().name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EverySurface, KeepsItsBoundsInEverySweep) {
  const Curves curves = stability(everything({GetParam()}));
  std::set<std::string_view> swept, quantities;
  std::size_t stated = 0;
  for (const StabilityCurve& c : curves) {
    EXPECT_TRUE(c.holds()) << text_of(c);
    EXPECT_EQ(c.x.size(), c.error_u.size());
    EXPECT_EQ(c.x.size(), c.bound_u.size());
    EXPECT_EQ(c.x.size(), c.condition.size());
    if (c.route != "double") continue;
    swept.insert(c.sweep);
    quantities.insert(c.quantity);
    stated += static_cast<std::size_t>(
        std::count_if(c.bound_u.begin(), c.bound_u.end(), [](double b) { return b > 0; }));
  }
  for (const char* sweep : {"scale", "offset", "uv_scale", "uv_shift", "condition"})
    EXPECT_TRUE(swept.contains(sweep)) << sweep;
  for (const char* quantity : {"position", "partials", "second_partials", "frame"})
    EXPECT_TRUE(quantities.contains(quantity)) << quantity;
  EXPECT_GT(stated, 100u);
}

// What the naive formulas are known to lose; else the sweeps would not be hard.
TEST(Stability, NaiveFormulasFailWhereTheyAreKnownTo) {
  const Curves curves =
      stability(everything({make_surface("torus"), make_surface("sphere"), make_surface("ellipsoid")}));
  for (const auto& [sweep, quantity] : {std::pair{"pole_distance", "frame"},
                                        {"scale", "frame"},
                                        {"turns", "position"},
                                        {"uv_scale", "frame"},
                                        {"scale", "curvatures"}}) {
    const Curves naive = with(curves, [&, s = sweep, q = quantity](const StabilityCurve& c) {
      return c.route == "naive" && c.sweep == s && c.quantity == q;
    });
    ASSERT_FALSE(naive.empty()) << sweep;
    for (const StabilityCurve& c : naive) {
      EXPECT_FALSE(c.own);
      EXPECT_TRUE(c.holds());  // it promises nothing
    }
    EXPECT_TRUE(
        std::any_of(naive.begin(), naive.end(),
                    [](const StabilityCurve& c) { return !c.within_bound && !(c.worst.factor < 1e6); }))
        << sweep << ' ' << quantity;
  }
}

// ---- planted faults ---------------------------------------------------------------------------------------

StabilityAnswer in_double(const StabilityPoint& p) {
  return find_stability_route("double").answer(p);
}

// The curves of the torus and the sphere by a route that claims what Darboux states, all sweeps.
Curves by(StabilityAnswer (*answer)(const StabilityPoint&)) {
  static StabilityRoute planted;
  planted = find_stability_route("double");
  planted.answer = answer;
  StabilityOptions options = everything({make_surface("sphere"), make_surface("torus")});
  options.points = StabilityOptions{}.points;  // some faults show at one point of many
  options.samples = StabilityOptions{}.samples;
  options.routes = {&planted};
  return stability(options);
}

struct Fault {
  const char* name;
  StabilityAnswer (*answer)(const StabilityPoint&);
  std::set<std::string_view> sweeps;   // where it must be found
  std::set<std::string_view> members;  // what it may be called there; empty: anything
};
const Fault faults[] = {
    {"naive pole",  // t along dpdu + 1e-9, as a shader does that fears to divide by zero
     [](const StabilityPoint& p) {
       StabilityAnswer a = in_double(p);
       const Vec3<double> along = *a.partials[1] + Vec3<double>{1e-9, 0, 0};
       const double length = std::sqrt(dot(along, along));
       a.frame->t = along / length;
       a.frame->b = cross(a.frame->n, a.frame->t);
       return a;
     },
     {"pole_distance"},
     {"tangent", "bitangent"}},
    {"lost range reduction",  // u a unit in the last place off, as the rounded angle 2 pi u is
     [](const StabilityPoint& p) {
       return in_double({p.surface, std::nextafter(p.u, 1e308), p.v, p.length});
     },
     {"turns"},
     {}},
    {"cancelling curvature",  // K and H by the textbook, κ = H ± sqrt(H² - K)
     [](const StabilityPoint& p) {
       StabilityAnswer a = in_double(p);
       if (a.forms[2].empty()) return a;
       const double K = a.forms[0][0], H = a.forms[1][0], root = std::sqrt(std::fmax(0, H * H - K));
       a.forms[2] = {H + root, H - root};
       return a;
     },
     {"scale"},
     {"principal_curvatures"}},
};

TEST(Stability, EachPlantedFaultIsFoundAndNamed) {
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.name);
    const Curves curves = by(fault.answer);
    for (const std::string_view sweep : fault.sweeps) {
      const Curves found =
          with(curves, [&](const StabilityCurve& c) { return c.sweep == sweep && !c.holds(); });
      ASSERT_FALSE(found.empty()) << sweep;
      for (const StabilityCurve& c : found) {
        EXPECT_TRUE(fault.members.empty() || fault.members.contains(c.worst.member)) << text_of(c);
        EXPECT_GT(c.worst.factor, 1);
        EXPECT_GT(c.worst.error_u, c.worst.bound_u);
        EXPECT_FALSE(c.worst.surface.empty());
        // The point is one at which the fault shows, alone.
        const AnySurface at = make_surface(c.worst.surface);
        StabilityAnswer wrong = fault.answer({at, c.worst.u, c.worst.v, {1, 1}}),
                        right = in_double({at, c.worst.u, c.worst.v, {1, 1}});
        EXPECT_TRUE(wrong.partials != right.partials || norm(wrong.frame->t - right.frame->t) > 0 ||
                    wrong.forms != right.forms)
            << text_of(c);
      }
    }
  }
  for (const StabilityCurve& c : by(in_double)) EXPECT_TRUE(c.holds()) << text_of(c);
}

// Every method is asked in every sweep of meshes; a bound a sixteenth as large would be broken, so that it is
// not idle; and the fit keeps what it states.
TEST(Stability, MeshesAndFitsAreJudgedToo) {
  StabilityOptions options = everything({make_surface("torus")});
  std::set<std::pair<std::string_view, std::string_view>> asked;
  double nearest = 0;
  for (const StabilityCurve& c : stability(options)) {
    asked.insert({c.sweep, c.route});
    if (c.quantity == "mesh_tangents") nearest = std::fmax(nearest, c.worst.factor);
    EXPECT_TRUE(c.route != "fit" || c.worst.factor < 1) << text_of(c);
  }
  for (const StabilitySweep& sweep : stability_sweeps())
    for (const StabilityRoute& route : stability_routes()) {
      const bool expected = sweep.domain == route.domain && sweep.domain != StabilityDomain::evaluation &&
                            sweep.name != "normal_quantisation";  // some methods take no normals
      EXPECT_TRUE(!expected || asked.contains({sweep.name, route.name})) << sweep.name << ' ' << route.name;
    }
  EXPECT_GT(nearest, 1.0 / 16);
}

// ---- what it found ----------------------------------------------------------------------------------------

// On a sheared chart the terms of K cancel, and it is taken again in 40 digits: all of them.
TEST(Stability, CurvatureOfAShearedChartIsThatOfTheSurface) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double K = random.uniform(1, 100), u = random.uniform(-1, 1), v = random.uniform(0.2, 0.8);
    const auto chart = sheared(MoebiusStrip<>{1, 0.5}, K);
    const Jet2<Multiprecision> j = AnySurface(chart).jet(Multiprecision(u), Multiprecision(v));
    const Vec3<Multiprecision> n = unit(cross(j.dpdu, j.dpdv));
    const double exact = static_cast<double>(gaussian_curvature(first_form(j), second_form(j, n)));
    const detail::WideForms wide(chart, u, v, frame(chart, u, v));
    EXPECT_NEAR(detail::curvature_of<double>(wide).gaussian / exact, 1, 1e-14) << K << ' ' << u << ' ' << v;
  }
}

// A patch on the inner side of a torus is nearly that of another torus, tube and axis exchanged.
TEST(Stability, TheFitOfASmallPatchIsNotTheTwinTorus) {
  StabilityOptions options = everything({make_surface("torus")});
  options.sweeps = {&find_stability_sweep("coverage")};
  options.routes = {&find_stability_route("fit")};
  options.points = 60;
  const Curves curves = stability(options);
  EXPECT_EQ(curves.size(), 2u);  // parameters and frames
  for (const StabilityCurve& c : curves) {
    EXPECT_GE(c.x.size(), 18u);
    EXPECT_TRUE(c.holds()) << text_of(c);
  }
}

// Bounds are of the surface at hand, not of the catalogue's defaults: knots under another uv map, partials
// that underflow, stretched uvs, semi-axes in another order, outliers about what is flat.
TEST(Stability, BoundsHoldAtOtherParameters) {
  const auto made = [](const char* name, std::vector<double> values) {
    return make_surface(name).with(values);
  };
  const AnySurface patch = BSplinePatch<>(
      2, 1, clamped_knots(2, 4), clamped_knots(1, 2),
      {{0, 0, 0}, {0, 1, 0.5}, {1, 0, 1}, {1, 1, 0.5}, {2, 0, 0}, {2, 1, 1}, {3, 0, 1}, {3, 1, 0}});
  const std::vector<std::pair<AnySurface, std::vector<const char*>>> cases{
      {patch, {"uv_scale", "uv_shift", "condition"}},
      {made("superellipsoid", {1, 1, 1, 1.3, 1.5}), {"pole_distance"}},
      {made("superellipsoid", {1, 1, 1, 1.2, 1.7}), {"pole_distance"}},
      {made("superellipsoid", {1, 1, 1, 0.3, 0.3}), {"pole_distance", "seam_distance"}},
      {made("superellipsoid", {0.1443, 0.343, 3.445, 0.3501, 0.1283}), {"uv_quantisation"}},
      {made("plane", {3.323, 0.1847}), {"uv_quantisation"}},
      {made("torus", {1, 0.01}), {"uv_quantisation"}},
      {made("ellipsoid", {1, 10, 0.1}), {"coverage"}},
      {made("one-sheet-hyperboloid", {1, 20, 0.05}), {"seam_distance", "uv_scale"}},
      {made("cone", {5.792, 0.141}), {"outliers"}}};
  int i = 0;
  for (const auto& [surface, sweeps] : cases) {
    if (!is_taken(i++)) continue;
    StabilityOptions options = everything({surface});
    options.points = 24;
    options.samples = 3;
    options.sweeps.clear();
    for (const char* sweep : sweeps) options.sweeps.push_back(&find_stability_sweep(sweep));
    const Curves curves = stability(options);
    EXPECT_GE(curves.size(), sweeps.size()) << surface.specification();
    for (const StabilityCurve& c : curves) EXPECT_TRUE(c.holds()) << text_of(c);
  }
}

// What is fitted to is as noisy as the surface is large: the same fits of a scaled surface, whatever its
// size.
TEST(Stability, FitsAreJudgedAtEverySize) {
  const auto fits = [](double radius) {
    StabilityOptions options = everything({make_surface("sphere").with(std::vector{radius})});
    options.routes = {&find_stability_route("fit")};
    options.points = 12;
    return stability(options);
  };
  const Curves of_one = fits(1);
  EXPECT_EQ(of_one.size(), 8u);  // points, outliers, coverage, noise: parameters and frames
  for (const double radius : {0x1p-30, 0x1p-10, 0x1p20}) {
    const Curves curves = fits(radius);
    ASSERT_EQ(curves.size(), of_one.size()) << radius;
    for (std::size_t i = 0; i < curves.size(); ++i) {
      EXPECT_TRUE(curves[i].holds()) << text_of(curves[i]);
      EXPECT_EQ(curves[i].x, of_one[i].x) << text_of(curves[i]);
    }
  }
}

// ---- options ----------------------------------------------------------------------------------------------

TEST(Stability, DependsOnItsOptionsAlone) {
  StabilityOptions options = everything({make_surface("cone")});
  options.points = 5;
  const auto numbers = [](const Curves& curves) {
    std::vector<double> result;
    for (const StabilityCurve& c : curves) result.insert(result.end(), c.error_u.begin(), c.error_u.end());
    return result;
  };
  const Curves all = stability(options);
  const auto first = numbers(all);
  EXPECT_EQ(numbers(stability(options)), first);
  options.seed = 2;
  EXPECT_NE(numbers(stability(options)), first);
  // A route's curves do not depend on the routes beside it.
  options.seed = 1;
  options.routes = {&find_stability_route("naive")};
  Curves of_all, alone = stability(options);
  for (const StabilityCurve& c : all)
    if (c.route == "naive") of_all.push_back(c);
  EXPECT_FALSE(alone.empty());
  EXPECT_EQ(numbers(alone), numbers(of_all));
}

TEST(Stability, RefusesWhatIsNotThere) {
  EXPECT_THROW(find_stability_sweep("poles"), ParameterError);
  EXPECT_THROW(find_stability_route("single"), ParameterError);
  StabilityOptions options = everything({make_surface("plane")});
  for (const StabilityJob& job : stability_jobs(options)) {
    const std::string_view sweep = options.sweeps[job.sweep]->name;
    EXPECT_TRUE(sweep != "pole_distance" && sweep != "turns" && sweep != "weights") << sweep;
  }
  for (const StabilityJob& job : stability_jobs(everything({make_surface("helicoid")}))) {
    const std::string_view sweep = options.sweeps[job.sweep]->name;
    EXPECT_TRUE(sweep != "coverage" && sweep != "noise") << sweep;  // no kind that is found
  }
  options.points = 1;
  EXPECT_THROW(stability_jobs(options), ParameterError);
  options.points = 2;
  options.samples = 0;
  EXPECT_THROW(stability_jobs(options), ParameterError);
}

}  // namespace
}  // namespace darboux::test::stability_test
