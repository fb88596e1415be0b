// adaptor.h: every law holds for adapted surfaces, n is the base's.
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/offset.h>
#include <darboux/placed.h>
#include <darboux/reparametrised.h>
#include <darboux/testing.h>

#include "adapted.h"
#include "random.h"

namespace darboux::test::adaptors_test {
namespace {

class EveryAdaptor : public ::testing::TestWithParam<Adapted> {};
INSTANTIATE_TEST_SUITE_P(Adaptors, EveryAdaptor, ::testing::ValuesIn(every_adapted()),
                         [](const auto& info) { return info.param.name; });

TEST_P(EveryAdaptor, ObeysAllLaws) {
  EXPECT_EQ(broken_laws(GetParam().surface, {.points = law_points, .seed = 3}), "");
}

// The position is the base's, mapped; n is the base's n, by the inverse transpose where it is placed; the
// handedness is the base's times -1 for each flip, swap and mirror.
TEST_P(EveryAdaptor, KeepsTheBasesNormal) {
  const Adapted& x = GetParam();
  const FrameTransform<double> transform(x.linear());
  const bool placed = x.A != Linear{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Random random(11);
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform(), v = random.uniform();
    const Vec2<double> at = x.at(u, v);
    const Frame<double> f = x.surface.frame(u, v), base = x.base.frame(at.x, at.y);
    if (has(base.status, Status::no_frame)) continue;
    ++compared;
    const Frame<double> expected = transform(base);
    // The map of (u, v) is exact but for its last addition, so at and the coordinates within are the same
    // numbers.
    EXPECT_LE(norm(f.n - (placed ? expected.n : base.n)), (placed ? 64 : 0) * roundoff) << u << ' ' << v;
    EXPECT_EQ(f.handedness, x.handedness * base.handedness) << u << ' ' << v;
    EXPECT_EQ(det_sign(x.surface.jet(u, v), f.n), f.handedness) << u << ' ' << v;
  }
  EXPECT_GT(compared, 900);
}

// ---- domain -----------------------------------------------------------------------------------------------

TEST(Reparametrised, IsOutsideWhereTheBaseIs) {
  const auto outside = [](const AnySurface& s, double u, double v) {
    return has(s.frame(u, v).status, Status::outside_domain);
  };
  const AnySurface half = sub_rectangle(Sphere{1.0}, 0, 1, 0.5, 1.5);  // beyond the pole for v > 1/2
  EXPECT_FALSE(outside(half, 0.3, 0.25));
  EXPECT_FALSE(outside(half, 0.3, 0.5));
  EXPECT_TRUE(outside(half, 0.3, 0.5 + 0x1p-51));
  EXPECT_TRUE(outside(half, 0.3, 0.75));
  // sin πv is positive again at v = 5/2 of the base: that is as far outside.
  EXPECT_TRUE(outside(Reparametrised<Sphere<double>>{{1.0}, {1, 0, 0, 4}, {0, 0}}, 0.3, 0.625));
  EXPECT_TRUE(outside(sub_rectangle(Cylinder{1.0, 1.0}, 0, 1, -1, 2), 0.3, 0.1));
  EXPECT_FALSE(outside(sub_rectangle(Cylinder{1.0, 1.0}, 0, 1, -1, 2), 0.3, 0.5));
  // A periodic base is never left, but the new coordinates are linear: they end at 0 and 1.
  const AnySurface turns = sub_rectangle(Torus{1.0, 0.25}, -3, 3, 0.5, 1.5);
  EXPECT_FALSE(outside(turns, 0.9, 0.9));
  EXPECT_TRUE(outside(turns, 1.1, 0.9));
  // Through other adaptors.
  EXPECT_TRUE(outside(Placed{sub_rectangle(Sphere{1.0}, 0, 1, 0.5, 1.5), rotation, {1, 2, 3}}, 0.3, 0.75));
  EXPECT_TRUE(outside(Offset{sub_rectangle(Sphere{1.0}, 0, 1, 0.5, 1.5), 0.5}, 0.3, 0.75));
  EXPECT_TRUE(outside(swapped(sub_rectangle(Sphere{1.0}, 0, 1, 0.5, 1.5)), 0.75, 0.3));
  EXPECT_TRUE(has(sub_rectangle(Sphere{1.0}, 0, 1, 0.5, 1.5).singular(0.3, 0.5), Status::dpdu_zero));
}

TEST(NotFinite, InputGivesNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const AnySurface& s :
       {AnySurface(swapped(Sphere{1.0})), AnySurface(Placed{Sphere{1.0}, rotation, {0, 0, 0}}),
        AnySurface(Offset{Sphere{1.0}, 0.5})})
    for (const double bad : {nan, infinity}) {
      const Frame<double> f = s.frame(bad, 0.5);
      EXPECT_TRUE(has(f.status, Status::non_finite_input));
      EXPECT_TRUE(std::isnan(f.t.x) && std::isnan(f.n.x));
    }
}

// ---- refusals ---------------------------------------------------------------------------------------------

template <class X>
std::string refused(const X& surface) {
  try {
    const AnySurface any(surface);
    return "";
  } catch (const ParameterError& e) {
    return e.what();
  }
}

TEST(Refused, SingularAndNotFiniteMapsAre) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Sphere sphere{1.0};
  using Chart = Reparametrised<Sphere<double>>;
  const auto has_text = [](const std::string& what, const char* text) {
    return what.find(text) != std::string::npos;
  };
  for (const Chart& chart :
       {Chart{sphere, {1, 2, 2, 4}, {0, 0}}, Chart{sphere, {0, 0, 0, 0}, {0, 0}},
        Chart{sphere, {infinity, 0, 0, 1}, {0, 0}}, sub_rectangle(sphere, 0.5, 0.5, 0, 1)})
    EXPECT_TRUE(
        has_text(refused(chart), "reparametrised sphere: the map of (u, v): expected an invertible one"))
        << refused(chart);
  EXPECT_TRUE(has_text(refused(Chart{sphere, {1, 0, 0, 1}, {infinity, 0}}), "offset of (u, v)"));
  EXPECT_EQ(refused(Chart{sphere, {1e-200, 0, 0, 1e-200}, {0, 0}}), "");  // its determinant underflows

  for (const Linear& A : {Linear{1, 0, 0, 0, 1, 0, 0, 0, 0}, Linear{1, 2, 3, 2, 4, 6, 0, 0, 1},
                          Linear{1, 0, 0, 0, 1, 0, 0, 0, 1e-200}, Linear{infinity, 0, 0, 0, 1, 0, 0, 0, 1}})
    EXPECT_TRUE(has_text(refused(Placed{sphere, A, {0, 0, 0}}),
                         "placed sphere: the placement: expected an invertible map"));
  EXPECT_TRUE(has_text(refused(Placed{sphere, rotation, {0, infinity, 0}}), "translation"));
  EXPECT_EQ(refused(Placed{sphere, Linear{1e-150, 0, 0, 0, 1e-150, 0, 0, 0, 1e-150}, {0, 0, 0}}), "");
  EXPECT_TRUE(
      has_text(refused(Offset{sphere, infinity}), "offset sphere: the distance: expected a finite number"));

  // The base's own refusals pass through.
  EXPECT_NE(refused(Offset{Disk{1.0, 2.0}, 0.5}), "");
  EXPECT_NE(refused(Placed{Disk{1.0, 2.0}, rotation, {0, 0, 0}}), "");
  EXPECT_NE(refused(swapped(Disk{1.0, 2.0})), "");
}

// Evaluation throws nothing: a placement that double can invert and float cannot.
TEST(Placed, IsTotalInFloat) {
  const Linear flat{1, 0.5, 0, 0.5, 1, 0, 0, 0, 1e-9};
  const Sample<float> s = AnySurface(Placed{Sphere{1.0}, flat, {0, 0, 0}}).sample_in_float(0.3F, 0.7F);
  EXPECT_NEAR(norm(s.frame.n), 1, 1e-6);
}

// ---- placement --------------------------------------------------------------------------------------------

// Where a surface stands does not change a bit of its frame; its size does not either.
TEST(Placed, FarAwayAndAtAnySizeIsTheSameFrame) {
  const Ellipsoid ellipsoid{1.0, 0.7, 0.5};
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const double u = random.uniform(), v = random.uniform();
    const Frame<double> here = frame(Placed{ellipsoid, uneven, {0, 0, 0}}, u, v),
                        far = frame(Placed{ellipsoid, uneven, {1e12, 1e300, -1}}, u, v);
    EXPECT_EQ(here.t, far.t);
    EXPECT_EQ(here.b, far.b);
    EXPECT_EQ(here.n, far.n);
    for (const double size : {0x1p-400, 0x1p400}) {
      Linear A = uneven;
      for (double& x : A) x *= size;
      const Frame<double> scaled = frame(Placed{ellipsoid, A, {0, 0, 0}}, u, v);
      EXPECT_EQ(here.t, scaled.t);
      EXPECT_EQ(here.n, scaled.n);
    }
  }
}

// ---- what is wrong with the base --------------------------------------------------------------------------

TEST(Base, IsCheckedByItsAdaptors) {
  const double nan_value = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const auto& surface) {
    try {
      AnySurface{surface};
      ADD_FAILURE() << surface.info.name << " is not refused";
    } catch (const ParameterError& e) {
      EXPECT_NE(std::string(e.what()).find("minor_radius"), std::string::npos) << e.what();
    }
  };
  for (const double radius : {-0.5, 0.0, nan_value}) {
    const Torus bad{1.0, radius};
    refused(Offset{bad, 0.1});
    refused(swapped(bad));
    refused(Placed{bad, rotation, {0, 0, 0}});
    refused(Placed{Offset{bad, 0.1}, rotation, {0, 0, 0}});
  }
  const Torus torn{1.0, nan_value};
  EXPECT_EQ(frame(Offset{torn, 0.1}, 0.1, 0.2).status, Status::non_finite_input);
  EXPECT_EQ(frame(Placed{swapped(torn), rotation, {0, 0, 0}}, 0.1, 0.2).status, Status::non_finite_input);
}

// ---- numbers that checked() refuses -----------------------------------------------------------------------

template <class X>
void expect_no_frame(const X& surface, Status why) {
  Random random(31);
  for (int i = 0; i < 20; ++i) {
    const Frame<double> f = frame(surface, random.uniform(), random.uniform(0.1, 0.9));
    EXPECT_EQ(f.status & why, why) << surface.info.name;
    EXPECT_TRUE(std::isnan(f.t.x) && std::isnan(f.b.y) && std::isnan(f.n.z)) << surface.info.name;
  }
}

TEST(Adaptors, WithNumbersThatAreNotFiniteHaveNoFrame) {
  const Sphere sphere{1.0};
  const double nan_value = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  using Chart = Reparametrised<Sphere<double>>;
  for (const double x : {nan_value, infinity, -infinity}) {
    expect_no_frame(Offset{sphere, x}, Status::non_finite_input);
    expect_no_frame(swapped(Offset{sphere, x}), Status::non_finite_input);
    expect_no_frame(Placed{sphere, rotation, {0, x, 0}}, Status::non_finite_input);
    expect_no_frame(Placed{sphere, Linear{1, 0, 0, 0, x, 0, 0, 0, 1}, {0, 0, 0}}, Status::non_finite_input);
    expect_no_frame(Chart{sphere, {1, 0, 0, x}, {0, 0}}, Status::non_finite_input);
    expect_no_frame(Chart{sphere, {1, 0, 0, 1}, {x, 0}}, Status::non_finite_input);
  }
}

// Without NDEBUG these end the program, as parameters out of range do.
TEST(AdaptorsDeathTest, ThatAreSingularHaveNoFrame) {
  const Sphere sphere{1.0};
  using Chart = Reparametrised<Sphere<double>>;
  [[maybe_unused]] const Placed nothing{sphere, Linear{}, {0, 0, 0}},
      line{sphere, Linear{1, 2, 3, 2, 4, 6, -1, -2, -3}, {0, 0, 0}};
  [[maybe_unused]] const Chart point{sphere, {0, 0, 0, 0}, {0.1, 0.2}}, curve{sphere, {1, 2, 2, 4}, {0, 0}},
      meridian = sub_rectangle(sphere, 0.5, 0.5, 0, 1);
#ifndef NDEBUG
  EXPECT_DEATH(frame(nothing, 0.1, 0.2), "the placement");
  EXPECT_DEATH(frame(curve, 0.1, 0.2), "the map of");
  EXPECT_DEATH(frame(Offset{Torus{1.0, -0.5}, 0.1}, 0.1, 0.2), "minor_radius");
#else
  for (const Placed<Sphere<double>>& placed : {nothing, line}) expect_no_frame(placed, Status::no_frame);
  expect_no_frame(point, Status::no_frame);
  expect_no_frame(curve, Status::no_frame | Status::parallel);
  expect_no_frame(meridian, Status::no_frame | Status::dpdu_zero);
#endif
}

// ---- Gauss-Bonnet -----------------------------------------------------------------------------------------

// ∫ K dA = 2π χ to 1e-10 over closed surfaces and their parallel surfaces within the focal distance.
TEST(GaussBonnet, HoldsOnClosedSurfacesAndTheirOffsets) {
  const Ellipsoid round{1.0, 0.7, 0.5}, flat{10.0, 3.0, 1.0}, tall{1.0, 1.0, 10.0}, long_{10.0, 1.0, 1.0};
  const KleinBottle<double> bottle;
  const std::vector<AnySurface> closed{Sphere{3.0},
                                       round,
                                       flat,
                                       tall,
                                       long_,
                                       Torus{1.0, 0.25},
                                       Torus{1.0, 0.9},
                                       bottle,
                                       Offset{Sphere{3.0}, 0.5},
                                       Offset{Sphere{3.0}, -2.0},
                                       Offset{round, 0.5},
                                       Offset{round, -0.2},  // the least radius of curvature is 0.25
                                       Offset{tall, 1.0},
                                       Offset{Torus{1.0, 0.25}, 0.5},
                                       Offset{Torus{1.0, 0.25}, -0.2},
                                       Offset{bottle, 0.03125},
                                       Placed{round, rotation, {1, 2, 3}},
                                       Placed{Offset{round, 0.25}, mirror, {1, 2, 3}}};
  int i = 1;  // not the offset Klein bottle, which takes as long as all others
  for (const AnySurface& s : closed) {
    if (!is_taken(i++)) continue;
    const std::vector<Check> checks = check_surface(s, {.points = 20, .routes = {"gauss_bonnet"}});
    ASSERT_EQ(checks.size(), 1U);
    EXPECT_EQ(checks[0].points, 1) << s.info().name << ' ' << checks[0].skipped;
    EXPECT_TRUE(checks[0].passed) << s.info().name << " is off by " << checks[0].max_error;
    EXPECT_LE(checks[0].bound * 4 * std::numbers::pi, 1.0001e-10);
  }
}

}  // namespace
}  // namespace darboux::test::adaptors_test
