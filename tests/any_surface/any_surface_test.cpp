#include <algorithm>
#include <functional>
#include <locale>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/testing.h>

#include "every_surface.h"
#include "random.h"
#include "refusal_of.h"

namespace darboux::test::any_surface_test {
namespace {

std::string message_of(const std::string& text) {
  try {
    make_surface(text);
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

// Values for all parameters that are permitted and go together, none the default.
std::vector<double> other_values(const AnySurface& surface, Random& random) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    std::vector<double> values;
    for (const ParameterValue& p : surface.parameters())
      values.push_back(p.value == 0 ? random.uniform(0.01, 0.02) : p.value * random.uniform(0.9, 1.1));
    try {
      surface.with(values);
      return values;
    } catch (const ParameterError&) {
      // not together
    }
  }
  throw std::runtime_error("no values found for " + surface.specification());
}

// ---- making one by name -----------------------------------------------------------------------------------

TEST(MakeSurface, TakesDefaultsAndParameters) {
  EXPECT_EQ(make_surface("torus").specification(), "torus:major_radius=1,minor_radius=0.25");
  EXPECT_EQ(make_surface("torus:minor_radius=0.4").specification(), "torus:major_radius=1,minor_radius=0.4");
  const AnySurface torus = make_surface("torus:minor_radius=4e-1,major_radius=2");
  ASSERT_NE(torus.get<Torus<double>>(), nullptr);
  EXPECT_EQ(torus.get<Torus<double>>()->major_radius, 2);
  EXPECT_EQ(torus.get<Torus<double>>()->minor_radius, 0.4);
  EXPECT_EQ(torus.get<Sphere<double>>(), nullptr);
  EXPECT_EQ(make_surface(SurfaceSpecification{"sphere", {{"radius", 7}}}).specification(), "sphere:radius=7");
}

TEST(MakeSurface, WritesWhatItReads) {
  Random random(1);
  for (const AnySurface& surface : all_surfaces()) {
    SurfaceSpecification specification{std::string(surface.info().name), {}};
    const std::vector<double> values = other_values(surface, random);
    for (std::size_t i = 0; i < values.size(); ++i)
      specification.parameters.emplace_back(surface.parameters()[i].name, values[i]);
    const AnySurface made = make_surface(specification);
    const auto parameters = made.parameters();
    for (std::size_t i = 0; i < parameters.size(); ++i)
      EXPECT_EQ(parameters[i].value, specification.parameters[i].second);
    EXPECT_EQ(make_surface(made.specification()).specification(), made.specification());
  }
}

TEST(MakeSurface, AcceptsTheEndsOfRanges) {
  EXPECT_EQ(message_of("torus:major_radius=0,minor_radius=5e-324"), "accepted");
  EXPECT_EQ(message_of("sphere:radius=1.7976931348623157e308"), "accepted");
}

TEST(MakeSurface, ListsTheKnownSurfacesForAnUnknownOne) {
  std::string known;
  for (const AnySurface& surface : all_surfaces())
    known += (known.empty() ? "" : ", ") + std::string(surface.info().name);
  EXPECT_EQ(message_of("klein"), "klein: unknown surface (did you mean klein-bottle?), known are " + known);
  EXPECT_EQ(message_of("nothing"), "nothing: unknown surface, known are " + known);
  EXPECT_EQ(message_of(""), "surface: unknown surface, known are " + known);
  EXPECT_EQ(message_of(":radius=1"), "surface: unknown surface, known are " + known);
  EXPECT_EQ(message_of("formula:file=x"),
            "formula: unknown surface, known are " + known +
                "; in C++ io.h has read_formula_surface(), on the command line it is "
                "formula:file=FILE");
  EXPECT_EQ(message_of("kink.surface"), "kink.surface: unknown surface, known are " + known +
                                            "; a file with a formula is formula:file=kink.surface");
  EXPECT_EQ(message_of("bezier-patch:file=x"),
            "bezier-patch: unknown parameter 'file', known are none; io.h has read_surface_file()");
  for (const char* text : {"Torus", "torus ", " torus", "torus,major_radius=1"})
    EXPECT_EQ(message_of(text),
              std::string(text) + ": unknown surface" +
                  (std::string(text) == "torus,major_radius=1" ? "" : " (did you mean torus?)") +
                  ", known are " + known);
  EXPECT_EQ(message_of("torus\n"), "torus\\x0A: unknown surface (did you mean torus?), known are " + known);
}

TEST(MakeSurface, ListsTheKnownParametersForAnUnknownOne) {
  const auto unknown = [](const std::string& name, const std::string& meant = "") {
    return "torus: unknown parameter '" + name + "'" + meant + ", known are major_radius, minor_radius";
  };
  EXPECT_EQ(message_of("torus:radius=1"), unknown("radius", " (did you mean major_radius or minor_radius?)"));
  EXPECT_EQ(message_of("torus:height=1"), unknown("height"));
  EXPECT_EQ(message_of("torus:"), unknown(""));
  EXPECT_EQ(message_of("torus:=1"), unknown(""));
  EXPECT_EQ(message_of("torus:major_radius=1,"), unknown(""));
  EXPECT_EQ(message_of("torus:,major_radius=1"), unknown(""));
  EXPECT_EQ(message_of("torus: major_radius=1"), unknown(" major_radius", " (did you mean major_radius?)"));
  EXPECT_THROW(make_surface(SurfaceSpecification{"torus", {{"radius", 1}}}), ParameterError);
}

TEST(MakeSurface, NamesAParameterThatIsNoNumber) {
  for (const char* text : {"", "abc", "1x", " 1", "1 ", "0x10", "+1", "1e400", "-1e400", "--1"}) {
    EXPECT_EQ(message_of(std::string("torus:minor_radius=") + text),
              "torus: minor_radius: expected a decimal number such as 0.25, got '" + std::string(text) + "'");
  }
  EXPECT_EQ(message_of("torus:minor_radius=1,5"),
            "torus: expected major_radius=NUMBER, minor_radius=NUMBER, got '5' without a name");
  EXPECT_EQ(message_of("torus:1,0.4"),
            "torus: expected major_radius=NUMBER, minor_radius=NUMBER, got '1' without a name");
  EXPECT_EQ(message_of("torus:major_radius"),
            "torus: parameter 'major_radius': expected major_radius=number, got no value");
  EXPECT_EQ(message_of("torus:major_radius=1,major_radius=1"),
            "torus: parameter 'major_radius': expected one value, got a second one");
}

TEST(MakeSurface, NamesAParameterOutOfRange) {
  for (const char* value : {"0", "-0", "-1", "inf", "-inf", "nan"})
    EXPECT_EQ(message_of(std::string("sphere:radius=") + value),
              std::string("sphere: radius: expected 0 < radius < inf, got ") + value);
  EXPECT_EQ(message_of("torus:major_radius=-1"),
            "torus: major_radius: expected 0 <= major_radius < inf, got -1");
  EXPECT_EQ(message_of("cylinder:height=0"), "cylinder: height: expected 0 < height < inf, got 0");
}

TEST(ParseSpecification, KeepsNamesAndValuesUnchecked) {
  const SurfaceSpecification s = parse_specification("torus:minor_radius=-2,major_radius=1e-3");
  EXPECT_EQ(s.name, "torus");
  ASSERT_EQ(s.parameters.size(), 2U);
  EXPECT_EQ(s.parameters[0], (std::pair<std::string, double>{"minor_radius", -2}));
  EXPECT_EQ(s.parameters[1], (std::pair<std::string, double>{"major_radius", 1e-3}));
}

// ---- what it holds ----------------------------------------------------------------------------------------

bool same(const Vec3<double>& a, const Vec3<double>& b) {
  return a == b;
}

TEST(HeldSurface, AnswersAsTheTypeItself) {
  Random random(2);
  Catalogue::for_each([&](const auto& surface) {
    const AnySurface any(surface);
    EXPECT_EQ(any.info().name, surface.info.name);
    for (int i = 0; i < 100; ++i) {
      const double u = random.uniform(), v = random.uniform();
      EXPECT_TRUE(same(any.jet(u, v).d2pduv, jet(surface, u, v).d2pduv));
      EXPECT_TRUE(same(any.frame(u, v).b, frame(surface, u, v).b));
      EXPECT_EQ(any.status(u, v), frame(surface, u, v).status);
      EXPECT_TRUE(same(any.parametric_frame(u, v).b, parametric_frame(surface, u, v).b));
      EXPECT_EQ(any.sample(u, v).frame.status, sample(surface, u, v).frame.status);
      const Vec3<Multiprecision> exact = any.jet(Multiprecision(u), Multiprecision(v)).position;
      EXPECT_NEAR(static_cast<double>(exact.z), any.jet(u, v).position.z, 1e-13);
    }
  });
}

TEST(HeldSurface, DescribesItsParameters) {
  Random random(3);
  for (const AnySurface& surface : all_surfaces()) {
    const std::vector<double> values = other_values(surface, random);
    const auto standard = surface.parameters(), changed = surface.with(values).parameters();
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_EQ(changed[i].value, values[i]) << changed[i].name;
      EXPECT_EQ(changed[i].default_value, standard[i].value) << changed[i].name;
      EXPECT_TRUE(changed[i].permitted.contains(changed[i].default_value)) << changed[i].name;
      EXPECT_FALSE(changed[i].meaning.empty()) << changed[i].name;
      EXPECT_LT(changed[i].proven.smallest, changed[i].proven.largest) << changed[i].name;
    }
  }
}

// A user's own type: a parabolic sheet with a parameter that is 1 by default, not in the catalogue.
struct Sheet {
  double depth = 1;
  static constexpr SurfaceInfo info{"sheet", "z = depth u²", Coordinate::linear, Coordinate::linear};
  static constexpr auto parameters() {
    return std::array{parameter<&Sheet::depth>("depth", Range{.minimum = -2, .maximum = 2}, "of the sheet")};
  }
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), two = lift<S>(2.0), d = lift<S>(depth);
    return {.position = {u, v, d * u * u},
            .dpdu = {one, zero, two * d * u},
            .dpdv = {zero, one, zero},
            .d2pdu2 = {zero, zero, two * d},
            .d2pduv = {zero, zero, zero},
            .d2pdv2 = {zero, zero, zero}};
  }
  template <class S>
  S gaussian_curvature(const S&, const S&) const {
    return lift<S>(0.0);
  }
};

TEST(AnySurface, HoldsAUsersOwnType) {
  const AnySurface any = Sheet{-1.5};
  EXPECT_EQ(any.specification(), "sheet:depth=-1.5");
  EXPECT_EQ(any.jet(2, 0).position, (Vec3<double>{2, 0, -6}));
  EXPECT_EQ(any.get<Sheet>()->depth, -1.5);
  EXPECT_EQ(any.facts(), std::vector<std::string_view>{"gaussian_curvature"});
  for (const Check& c : check_surface(any, {.points = 200, .seed = 1}))
    EXPECT_TRUE(c.passed) << c.route << c.quantity;
  EXPECT_THROW(AnySurface(Sheet{2}), ParameterError);
  EXPECT_THROW(make_surface("sheet"), ParameterError);
}

TEST(AnySurface, TakesOneValuePerParameter) {
  const AnySurface torus = make_surface("torus");
  for (const std::vector<double>& values : {std::vector<double>{}, {7}, {7, 2, 1}}) {
    const std::string got = std::to_string(values.size());
    EXPECT_EQ(refusal_of<ParameterError>([&] { torus.with(values); }),
              "torus: expected one value per parameter, 2, got " + got);
    if (values.empty()) continue;
    const std::vector<Multiprecision> wide(values.begin(), values.end());
    EXPECT_THROW(torus.jet(Multiprecision(0.1), Multiprecision(0.2), wide), ParameterError);
  }
}

TEST(AnySurface, IsAValue) {
  std::optional<AnySurface> first = AnySurface(Sheet{0.5});
  const AnySurface copy = *first;
  first.reset();
  EXPECT_EQ(copy.specification(), "sheet:depth=0.5");
}

TEST(AllSurfaces, HaveDistinctNames) {
  std::vector<std::string_view> names;
  for (const AnySurface& surface : all_surfaces()) names.push_back(surface.info().name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_EQ(names.size(), 27U);
}

// A program whose streams write decimal commas and group digits reads and prints surfaces all the same.
TEST(MakeSurface, DoesNotDependOnTheGlobalLocale) {
  struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Commas));
  const std::string text = "torus:major_radius=12345.5,minor_radius=0.25";
  const std::string printed = make_surface(text).specification();
  std::string message;
  try {
    make_surface("sphere:radius=-12345.5");
  } catch (const ParameterError& e) {
    message = e.what();
  }
  std::locale::global(before);
  EXPECT_EQ(printed, text);
  EXPECT_NE(message.find("-12345.5"), std::string::npos) << message;
}

}  // namespace
}  // namespace darboux::test::any_surface_test
