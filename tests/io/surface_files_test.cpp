// Surfaces that a user wrote down: formulas, and control points, weights and knots in JSON.
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/error.h>
#include <darboux/io.h>
#include <darboux/sphere.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/testing.h>

#include "io_files.h"

namespace darboux::test::surface_files_test {
namespace {

class SurfaceFiles : public ::testing::Test {
 protected:
  AnySurface formula(const std::string& text,
                     const std::vector<std::pair<std::string, double>>& parameters = {}) {
    return read_formula_surface(write_bytes(folder_ / "my.surface", text), parameters);
  }
  AnySurface json(std::string_view kind, const std::string& text) {
    return read_surface_file(kind, write_bytes(folder_ / "net.json", text));
  }

  // What reading throws, without the folder.
  template <class Expected, class F>
  std::string message(F read) {
    try {
      read();
    } catch (const Expected& error) {
      std::string text = error.what();
      if (const std::size_t at = text.find(folder_ / ""); at != std::string::npos)
        text.erase(at, (folder_ / "").size());
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      return text;
    }
    ADD_FAILURE() << "was read";
    return {};
  }
  void refused(const std::string& text, const std::vector<std::string>& parts) {
    SCOPED_TRACE(text.substr(0, 200));
    const std::string what = message<FileError>([&] { formula(text); });
    EXPECT_TRUE(what.starts_with("my.surface")) << what;
    for (const std::string& part : parts)
      EXPECT_NE(what.find(part), std::string::npos) << part << " in " << what;
  }
  void refused(std::string_view kind, const std::string& text, const std::vector<std::string>& parts) {
    SCOPED_TRACE(text.substr(0, 200));
    const std::string what = message<FileError>([&] { json(kind, text); });
    EXPECT_TRUE(what.starts_with("net.json: ")) << what;
    for (const std::string& part : parts)
      EXPECT_NE(what.find(part), std::string::npos) << part << " in " << what;
  }

  TempFolder folder_;
};

double difference(const Vec3<double>& a, const Vec3<double>& b) {
  return norm(a - b) / (1 + norm(b));
}
double difference(const Jet2<double>& a, const Jet2<double>& b) {
  double worst = 0;
  for (Vec3<double> Jet2<double>::*const m :
       {&Jet2<double>::position, &Jet2<double>::dpdu, &Jet2<double>::dpdv, &Jet2<double>::d2pdu2,
        &Jet2<double>::d2pduv, &Jet2<double>::d2pdv2})
    worst = std::fmax(worst, difference(a.*m, b.*m));
  return worst;
}

constexpr std::pair<double, double> points[] = {{0.3, 0.7}, {0.01, 0.99}, {0.5, 0.25}, {0.875, 0.125}};

// ---- formulas ---------------------------------------------------------------------------------------------

const std::string sphere =
    "r = 2   # radius; length\n"
    "x = r*sin_turns(v/2)*cos_turns(u)\n"
    "y = r*sin_turns(v/2)*sin_turns(u)\n"
    "z = -r*cos_turns(v/2)\n";

TEST_F(SurfaceFiles, AFormulaIsTheCataloguesSurface) {
  const AnySurface truth = Sphere<>{2}, read = formula(sphere);
  for (const auto& [u, v] : points) {
    // Only the roundings of the two ways to write it differ.
    EXPECT_LT(difference(read.jet(u, v), truth.jet(u, v)), 1e-14);
    EXPECT_LT(difference(read.frame(u, v).n, truth.frame(u, v).n), 1e-14);
  }
  // At the poles, where a partial vanishes exactly, the limit.
  for (const double v : {0.0, 1.0}) {
    EXPECT_TRUE(has(read.frame(0.3, v).status, Status::dpdu_zero | Status::limit_frame));
    EXPECT_LT(difference(read.frame(0.3, v).t, truth.frame(0.3, v).t), 1e-15);
  }
}

TEST_F(SurfaceFiles, EveryLawHoldsForAFormula) {
  EXPECT_EQ(broken_laws(formula(sphere), {.points = 300}), "");
  EXPECT_EQ(
      broken_laws(
          formula("a = 2\nt = 2*v - 1\nx = a*cosh(t)*cos(2*pi*u)\ny = a*cosh(t)*sin(2*pi*u)\nz = a*t\n"),
          {.points = 300}),
      "");
  // sin(pi*v) is 1e-16 at v = 1, where 40 digits say zero: no law may mistake that.
  EXPECT_EQ(broken_laws(formula("x = sin(pi*v)*cos(2*pi*u)\ny = sin(pi*v)*sin(2*pi*u)\nz = -cos(pi*v)\n"),
                        {.points = 300}),
            "");
}

// Each operator and function against C++'s own, in value and, by the laws, in all derivatives and in 40
// digits.
TEST_F(SurfaceFiles, OperatorsAndFunctionsMeanWhatTheySay) {
  struct Case {
    std::string text;
    double (*value)(double u, double v);
  };
  using namespace std;
  const std::vector<Case> cases{
      {"u+v*2-3/(1+u)", [](double u, double v) { return u + v * 2 - 3 / (1 + u); }},
      {"-u^2", [](double u, double) { return -(u * u); }},
      {"2^3^0.5*v", [](double, double v) { return std::pow(2, std::pow(3, 0.5)) * v; }},
      {"8/2/2*u", [](double u, double) { return 2 * u; }},
      {"u - -v", [](double u, double v) { return u + v; }},
      {"+u", [](double u, double) { return u; }},
      {"(u-2)^3", [](double u, double) { return (u - 2) * (u - 2) * (u - 2); }},
      {"(u-2)^-3", [](double u, double) { return 1 / ((u - 2) * (u - 2) * (u - 2)); }},
      {"(u-2)^0", [](double, double) { return 1.0; }},
      {"(u-2)^n", [](double u, double) { return (u - 2) * (u - 2) * (u - 2); }},
      {"(1+u)^2.5", [](double u, double) { return std::pow(1 + u, 2.5); }},
      {"(1+u)^(1+v)", [](double u, double v) { return std::pow(1 + u, 1 + v); }},
      {"(1+u)^(v < 2 ? 1+v : 2)", [](double u, double v) { return std::pow(1 + u, 1 + v); }},
      {"pow(1+u, -1.5)", [](double u, double) { return std::pow(1 + u, -1.5); }},
      {"sin(u)+cos(v)+tan(u)", [](double u, double v) { return sin(u) + cos(v) + tan(u); }},
      {"asin(u*0.9)", [](double u, double) { return asin(u * 0.9); }},
      {"acos(u*0.9)", [](double u, double) { return acos(u * 0.9); }},
      {"atan(3*u-1)", [](double u, double) { return atan(3 * u - 1); }},
      {"atan2(u+0.1, v-2)", [](double u, double v) { return atan2(u + 0.1, v - 2); }},
      {"sinh(u)+cosh(v)+tanh(u)", [](double u, double v) { return sinh(u) + cosh(v) + tanh(u); }},
      {"asinh(u-0.5)", [](double u, double) { return asinh(u - 0.5); }},
      {"acosh(1.5+u)", [](double u, double) { return acosh(1.5 + u); }},
      {"atanh(u*0.9)", [](double u, double) { return atanh(u * 0.9); }},
      {"sqrt(1+u)*exp(v)", [](double u, double v) { return sqrt(1 + u) * exp(v); }},
      {"log(1+u)+ln(2+v)", [](double u, double v) { return std::log(1 + u) + std::log(2 + v); }},
      {"abs(u-2)+sign(u-2)*v", [](double u, double v) { return 2 - u - v; }},
      {"min(u, 2)+max(v, -1)+min(7, u)+max(-2, v)", [](double u, double v) { return 2 * u + 2 * v; }},
      {"sin_turns(u)+cos_turns(v)", [](double u, double v) { return sin(2 * M_PI * u) + cos(2 * M_PI * v); }},
      {"1.5e-2*u + .5*v + 2.e1", [](double u, double v) { return 0.015 * u + 0.5 * v + 20; }},
      {"u < 2 ? u : 9", [](double u, double) { return u; }},
      {"u > 2 ? 9 : (v >= 0 ? v : 8)", [](double, double v) { return v; }},
      {"u > 2 ? 9 : v > 2 ? 8 : u*v", [](double u, double v) { return u * v; }},
      {"(u <= 1 && v <= 1)*u + (u == u)*v + (u != u) + (u < -1 || v > -1)",
       [](double u, double v) { return u + v + 1; }},
      {"k*u", [](double u, double) { return M_PI / 4 * u; }},
      {"later*v", [](double u, double v) { return 2 * u * v; }}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.text);
    const AnySurface read = formula("n = 3\nk = pi/4\nx = u\ny = v\nz = " + c.text +
                                    " # comment = not read\n\nlater = twice\ntwice = 2*u");
    for (const auto& [u, v] : points) {
      const double expected = c.value(u, v);
      EXPECT_NEAR(read.jet(u, v).position.z, expected, 4e-15 * (1 + std::fabs(expected)));
      EXPECT_NEAR(static_cast<double>(read.jet(Multiprecision(u), Multiprecision(v)).position.z), expected,
                  4e-15 * (1 + std::fabs(expected)));
    }
    EXPECT_EQ(broken_laws(read, {.points = 60, .routes = {"central6", "gauss", "codazzi", "high_precision"}}),
              "");
  }
}

// The derivative of each function against that of another formula for it, second derivatives too.
TEST_F(SurfaceFiles, DerivativesAgreeWithOtherFormulas) {
  const std::vector<std::pair<std::string, std::string>> same{
      {"tan(u)", "sin(u)/cos(u)"},           {"atan(w)", "asin(w/sqrt(1+w^2))"},
      {"acos(u*0.9)", "pi/2 - asin(u*0.9)"}, {"atan2(v+1, u+1)", "atan((v+1)/(u+1))"},
      {"asinh(w)", "log(w+sqrt(w*w+1))"},    {"acosh(2+u)", "log(2+u+sqrt((2+u)^2-1))"},
      {"atanh(w)", "0.5*log((1+w)/(1-w))"},  {"(1+u)^(1+v)", "exp((1+v)*log(1+u))"},
      {"(1+u)^3.5", "(1+u)^3*sqrt(1+u)"},    {"sin_turns(u)", "sin(2*pi*u)"}};
  for (const auto& [one, other] : same) {
    SCOPED_TRACE(one);
    const AnySurface a = formula("w = 0.3*u + 0.1*v*v\nx = u\ny = v\nz = " + one),
                     b = formula("w = 0.3*u + 0.1*v*v\nx = u\ny = v\nz = " + other);
    for (const auto& [u, v] : points) EXPECT_LT(difference(a.jet(u, v), b.jet(u, v)), 2e-14);
  }
}

// What is zero in mathematics is zero in 40 digits: no constant and no function there is only a double's.
TEST_F(SurfaceFiles, FortyDigitsAreForty) {
  EXPECT_EQ(formula("x = u\ny = v\nz = pi").jet(Multiprecision(0.3), Multiprecision(0.7)).position.z,
            Multiprecision::pi());
  for (const std::string zero :
       {"tan(atan(3*u)) - 3*u", "sin(asin(u)) - u", "cos(acos(u)) - u", "atan2(v, -u) + atan(v/u) - pi",
        "atan2(-v, -u) + pi - atan(v/u)", "sinh(asinh(u)) - u", "cosh(acosh(1+u)) - 1 - u",
        "tanh(atanh(u)) - u", "exp(log(u)) - u", "sqrt(u)^2 - u", "u^2.5 - u^2*sqrt(u)",
        "u^v - exp(v*log(u))", "sin_turns(u) - sin(2*pi*u)", "cos_turns(u) - cos(2*pi*u)"}) {
    const AnySurface read = formula("x = u\ny = v\nz = " + zero);
    const double z = static_cast<double>(read.jet(Multiprecision(0.3), Multiprecision(0.7)).position.z);
    EXPECT_LT(std::fabs(z), 1e-37) << zero;
  }
}

TEST_F(SurfaceFiles, ParametersAreNamedOverriddenAndWrittenDown) {
  const std::string text = "a = 2  # radius of the neck; length\nk = -pi\nb = a/2\nx = a*u\ny = b*v\nz = k\n";
  const AnySurface read = formula(text);
  ASSERT_EQ(read.parameters().size(), 2u);  // b is an abbreviation, z a position
  EXPECT_EQ(read.parameters()[0].name, "a");
  EXPECT_EQ(read.parameters()[0].value, 2);
  EXPECT_EQ(read.parameters()[0].meaning, "radius of the neck; length");
  EXPECT_EQ(read.parameters()[1].value, -std::numbers::pi);
  EXPECT_EQ(read.specification(), "formula:file=" + (folder_ / "my.surface") + ",a=2,k=-3.141592653589793");
  EXPECT_EQ(read.file(), folder_ / "my.surface");

  const AnySurface other = formula(text, {{"a", 3}});
  EXPECT_EQ(other.jet(1, 1).position, (Vec3<double>{3, 1.5, -std::numbers::pi}));
  EXPECT_EQ(other.parameters()[0].default_value, 2);
  const std::vector<double> values{5, 1};
  const AnySurface with = other.with(values);
  EXPECT_EQ(with.jet(1, 1).position, (Vec3<double>{5, 2.5, 1}));
  EXPECT_EQ(with.file(), other.file());
  const std::vector<Multiprecision> many{Multiprecision(7.0), Multiprecision(1.0)};
  EXPECT_EQ(static_cast<double>(other.jet(Multiprecision(1.0), Multiprecision(1.0), many).position.x), 7);

  EXPECT_NE(message<ParameterError>([&] {
              formula(text, {{"b", 1}});
            }).find("unknown parameter 'b', known are a, k"),
            std::string::npos);
  EXPECT_NE(message<ParameterError>([&] {
              formula(text, {{"a", INFINITY}});
            }).find("a: expected a finite number, got inf"),
            std::string::npos);
  EXPECT_NE(message<ParameterError>([&] {
              formula("x=u\ny=v\nz=0", {{"a", 1}});
            }).find("known are none"),
            std::string::npos);
}

// No exception, no plausible number: NaN, flagged, and the laws go red.
TEST_F(SurfaceFiles, WhereAFormulaHasNoValueItSaysSo) {
  for (const std::string z :
       {"log(u-2)", "sqrt(-1-u)", "0*u/0", "(u-2)^0.5", "acos(2+u)", "acosh(u)", "atanh(2+u)",
        "min(log(u-2), 5)", "min(5, log(u-2))", "max(5, log(u-2))", "sign(log(u-2))"}) {
    SCOPED_TRACE(z);
    const AnySurface read = formula("x = u\ny = v\nz = " + z);
    const Sample<double> s = read.sample(0.3, 0.7);
    EXPECT_TRUE(std::isnan(s.jet.position.z));
    EXPECT_TRUE(std::isnan(s.jet.dpdu.z));
    EXPECT_TRUE(std::isnan(s.frame.n.x));
    EXPECT_TRUE(has(s.frame.status, Status::no_frame));
    EXPECT_TRUE(has(s.frame.status, Status::overflow));
    EXPECT_NE(broken_laws(read, {.points = 20}), "");
  }
  const AnySurface zero = formula("x = u\ny = v\nz = 1/(u-u)");
  EXPECT_TRUE(std::isinf(zero.jet(0.3, 0.7).position.z));
  EXPECT_TRUE(has(zero.frame(0.3, 0.7).status, Status::no_frame));
  EXPECT_NE(broken_laws(zero, {.points = 20}), "");
  // On a part of the domain only.
  EXPECT_NE(broken_laws(formula("x = u\ny = v\nz = log(u-0.5)"), {.points = 20}), "");
}

TEST_F(SurfaceFiles, LinesAreReadWhateverTheirEnds) {
  const AnySurface plain = formula("x = u\ny = v\nz = u*v\n");
  for (const std::string text : {"x=u\r\ny=v\r\nz=u*v\r\n", "\xEF\xBB\xBFx = u\ny = v\nz = u*v",
                                 "# first\n\n\tx\t=\tu\n  y=v#\n z = u * v # x = 3", "z=x*y\nx=u\ny=v"})
    EXPECT_EQ(formula(text).jet(0.3, 0.7).dpdu, plain.jet(0.3, 0.7).dpdu) << text;
}

TEST_F(SurfaceFiles, RefusesBadFormulasInOneLine) {
  const std::string known = "known are u, v, pi";
  refused("", {"got none of x", "definitions of x, y and z"});
  refused("# nothing\n", {"got none of x"});
  refused("x = u\ny = v\n", {"got none of z"});
  refused("x = u\ny = v\nhello\nz = u\n", {":3:", "got \"hello\"", "x = a*cos(2*pi*u)"});
  refused("x = u\ny = v\n2a = 1\nz = u\n", {":3:", "expected lines like x = a*cos(2*pi*u), got"});
  refused("x = u\ny =\nz = u\n", {":2:", "expected lines like y = 2, got y without a value"});
  refused("x = u\ny = v\nz = u\n\nx = v\n",
          {":5:", "x: expected one definition, got a second one", "line 1"});
  for (const std::string name : {"u", "v", "pi", "sin", "cos_turns"})
    refused(name + " = 1\n",
            {":1:", "expected a name other than u, v, pi and those of functions, got " + name});
  const std::string longest(64, 'a');
  EXPECT_EQ(formula(longest + " = 2\nx = u\ny = v\nz = " + longest + "*u\n").jet(0.5, 0).position.z, 1);
  for (const std::size_t length : {65U, 101U, 100000U})  // 101 ended the process
    refused(std::string(length, 'a') + " = 2\nx = u\ny = v\nz = u\n",
            {":1:", "expected a name of at most 64 characters, got " + std::to_string(length)});
  refused("a = 2\nx = u\ny = v\nz = a*radius\n",
          {":4:", "unknown name 'radius' at column 7", known + ", a, x, y, z", "sqrt"});
  refused("x = u\ny = v\nz = foo(u)\n", {":3:", "unknown name 'foo' at column 5", known});
  refused("x = u\ny = v\nz = 2*(u+v\n",
          {":3:", "\"2*(u+v\" cannot be read at column 11 (Missing parenthesis)", known});
  refused("x = u\ny = v\n  z = u+*2\n", {":3:", "at column 9 (Unexpected operator \"*\")", known});
  refused("x = u\ny = v\nz = 2u\n", {":3:", "at column 6 (Unexpected variable \"u\")"});
  refused("x = u\ny = v\nz = u v\n", {":3:", "cannot be read at column 7"});
  refused("x = u\ny = v\nz = sin(u, v)\n", {":3:", "Too many parameters for function \"sin\""});
  refused("x = u\ny = v\nz = atan2(u)\n", {":3:", "Too few parameters for function \"atan2\""});
  refused("x = u\ny = v\nz = -\n", {":3:", "Unexpected end of expression"});
  refused("x = u\ny = v\nz = u ? 1\n", {":3:", "missing an else clause"});
  refused("x = u\ny = v\nz = 1, 2\n", {":3:", "2 expressions", "expected one expression"});
  refused("x = u\ny = v\nz = u = 3\n", {":3:", "assignment"});
  refused("x = u\ny = v\nz = 1e999*u\n", {":3:", "cannot be read"});
  refused("x = u\ny = v\nz = \xCF\x80*u\n", {":3:", "cannot be read at column 5"});
  refused(std::string("x = u\ny = v\nz = u\0+nothing\n", 26), {":3:", "control character"});
  refused("x = u\ny = v\nz = " + std::string(100000, '(') + "u" + std::string(100000, ')'),
          {":3:", "cannot be read"});
  refused("a = b\nb = c\nc = a + 1\nx = a\ny = v\nz = u\n", {":1:", "a -> b -> c -> a"});
  refused("x = x\ny = v\nz = u\n", {":1:", "x -> x"});
  refused("x = u\ny = v\nz = 0\nunused = unused2\nunused2 = unused\n", {"unused -> unused2 -> unused"});
  refused("x = u\ny = v\nz = 0\nunused = 2*(u\n", {":4:", "Missing parenthesis"});
  refused("a = 1/0\nx = u\ny = v\nz = a\n",
          {":1:", "parameter a: expected a finite number, got inf", "finite"});
  refused(std::string(2000000, 'x'), {"at most 1048576 bytes", "got 2000000"});
  EXPECT_NE(message<FileError>([&] {
              read_formula_surface(folder_ / "none");
            }).find("none: expected a readable file"),
            std::string::npos);
  EXPECT_NE(message<FileError>([&] { read_formula_surface(folder_ / ""); }).find("got a folder"),
            std::string::npos);
  // A long chain of definitions is no recursion.
  std::string chain = "x = u\ny = v\nz = a0\n";
  for (int i = 0; i < 20000; ++i) chain += "a" + std::to_string(i) + " = a" + std::to_string(i + 1) + "\n";
  EXPECT_EQ(formula(chain + "a20000 = 2*u").jet(0.5, 0.5).position.z, 1);
}

// ---- control points ---------------------------------------------------------------------------------------

const std::string bezier_net = "\"points\": [[[0,0,0],[0,1,0.5],[0,2,0]], [[1,0,0],[1,1,0.5],[1,2,0.25]]]";
const std::string bspline_net =
    "\"points\": [[[0,0,0],[0,1,0.5],[0,2,0]], [[1,0,0],[1,1,0.5],[1,2,0]], [[2,0,0],[2,1,-0.5],[2,2,0]],"
    " [[3,0,0],[3,1,0.5],[3,2,1]]]";
const std::string profile_points = "\"points\": [[0.5,0],[1,0.5],[0.75,1],[0.5,1.5],[1,2]]";

TEST_F(SurfaceFiles, JsonGivesWhatTheConstructorsGive) {
  const std::vector<Vec3<double>> net{{0, 0, 0}, {0, 1, 0.5}, {0, 2, 0},
                                      {1, 0, 0}, {1, 1, 0.5}, {1, 2, 0.25}};
  const std::vector<double> weights{1, 2, 1, 1, 0.5, 3};
  std::vector<std::pair<AnySurface, AnySurface>> pairs;
  pairs.emplace_back(json("bezier-patch", "{" + bezier_net + "}"), BezierPatch<>(1, 2, net));
  pairs.emplace_back(json("bezier-patch", "{" + bezier_net +
                                              ", \"degree_u\": 1, \"degree_v\": 2, "
                                              "\"weights\": [[1, 2, 1], [1, 0.5, 3]]}"),
                     BezierPatch<>(1, 2, net, weights));
  std::vector<Vec3<double>> wide;
  const double height[4][3] = {{0, 0.5, 0}, {0, 0.5, 0}, {0, -0.5, 0}, {0, 0.5, 1}};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) wide.push_back({double(i), double(k), height[i][k]});
  pairs.emplace_back(json("bspline-patch", "{" + bspline_net + ", \"degree_u\": 2, \"degree_v\": 1}"),
                     BSplinePatch<>(2, 1, clamped_knots(2, 4), clamped_knots(1, 3), wide));
  pairs.emplace_back(json("bspline-patch", "{" + bspline_net +
                                               ", \"degree_u\": 2, \"degree_v\": 2, "
                                               "\"knots_u\": [-1, 0, 1, 2, 4, 5, 6]}"),
                     BSplinePatch<>(2, 2, {-1, 0, 1, 2, 4, 5, 6}, clamped_knots(2, 3), wide));
  const std::vector<Vec3<double>> profile{{0.5, 0, 0}, {1, 0, 0.5}, {0.75, 0, 1}, {0.5, 0, 1.5}, {1, 0, 2}};
  pairs.emplace_back(json("surface-of-revolution", "{" + profile_points + "}"),
                     SurfaceOfRevolution<>{BSplineCurve<>(1, clamped_knots(1, 5), profile)});
  pairs.emplace_back(
      json("surface-of-revolution", "{" + profile_points +
                                        ", \"degree\": 3, \"weights\": [1, 2, 1, 1, 1], "
                                        "\"knots\": [0, 0, 0, 0, 0.3, 1, 1, 1, 1]}"),
      SurfaceOfRevolution<>{BSplineCurve<>(3, {0, 0, 0, 0, 0.3, 1, 1, 1, 1}, profile, {1, 2, 1, 1, 1})});
  for (const auto& [read, truth] : pairs) {
    EXPECT_EQ(read.info().name, truth.info().name);
    EXPECT_EQ(read.specification(), std::string(truth.info().name) + ":file=" + (folder_ / "net.json"));
    for (const auto& [u, v] : points) {
      EXPECT_EQ(read.jet(u, v).position, truth.jet(u, v).position);
      EXPECT_EQ(read.jet(u, v).d2pduv, truth.jet(u, v).d2pduv);
    }
  }
}

// Splines with interior knots and polylines with corners are smooth in pieces only; the laws know where.
TEST_F(SurfaceFiles, EveryLawHoldsForFiles) {
  for (const AnySurface& surface :
       {json("bezier-patch", "{" + bezier_net + ", \"weights\": [[1, 2, 1], [1, 0.5, 3]]}"),
        json("bspline-patch", "{" + bspline_net + ", \"degree_u\": 3, \"degree_v\": 2}"),
        json("bspline-patch", "{" + bspline_net + ", \"degree_u\": 2, \"degree_v\": 1}"),
        json("surface-of-revolution", "{" + profile_points + "}"),
        json("surface-of-revolution", "{" + profile_points + ", \"degree\": 2}"),
        json("surface-of-revolution", "{" + profile_points + ", \"degree\": 3}")})
    EXPECT_EQ(broken_laws(surface, {.points = 300}), "") << surface.info().name << surface.breaks(1).size();
}

TEST_F(SurfaceFiles, KnotsInsideAreBreaks) {
  const AnySurface patch = json("bspline-patch", "{" + bspline_net + ", \"degree_u\": 1, \"degree_v\": 2}");
  EXPECT_EQ(patch.breaks(0), (std::vector<double>{1.0 / 3, 2.0 / 3}));
  EXPECT_EQ(patch.breaks(1), std::vector<double>{});
  const AnySurface turned = json("surface-of-revolution", "{" + profile_points +
                                                              ", \"degree\": 3, "
                                                              "\"knots\": [0, 0, 0, 0, 1, 4, 4, 4, 4]}");
  EXPECT_EQ(turned.breaks(0), std::vector<double>{});
  EXPECT_EQ(turned.breaks(1), std::vector<double>{0.25});
  EXPECT_EQ(AnySurface(Sphere<>{}).breaks(0), std::vector<double>{});
}

TEST_F(SurfaceFiles, RefusesBadJsonInOneLine) {
  const char *bezier = "bezier-patch", *bspline = "bspline-patch", *turned = "surface-of-revolution";
  for (const char* kind : {bezier, bspline, turned}) {
    refused(kind, "", {"got an empty file", "expected a JSON object"});
    refused(kind, " \n", {"got an empty file"});
    refused(kind, "{\"points\": [[0, 1],", {"expected JSON in UTF-8", "something else at byte"});
    refused(kind, "[1, 2]", {"got a JSON array", "expected a JSON object"});
    refused(kind, "{\"point\": []}", {"got \"point\"", "expected keys among points, weights"});
    refused(kind, "{\"points\": [[1e999, 0, 0]]}", {"range of double"});
    refused(kind, "\xff\xfe", {"expected JSON in UTF-8"});
  }
  refused(bezier, "{}", {"expected an object with points"});
  refused(bezier, "{\"points\": 7}", {"points: expected an array, got 7"});
  refused(bezier, "{\"points\": []}", {"points: expected at least 2 rows, got 0"});
  refused(bezier, "{\"points\": [[[0,0,0]], [[1,0,0]]]}", {"points[0]: expected at least 2 points, got 1"});
  refused(bezier, "{\"points\": [[[0,0,0],[1,0,0]], [[0,1,0]]]}",
          {"points[1]: expected 2 points, as many as in the first row, got 1"});
  refused(bezier, "{\"points\": [[[0,0,0],[1,0]], [[0,1,0],[1,1,0]]]}",
          {"points[0][1]: expected 3 coordinates, [x, y, z], got 2"});
  refused(bezier, "{\"points\": [[[0,0,0],[1,0,\"a\"]], [[0,1,0],[1,1,0]]]}",
          {"points[0][1][2]: expected a number, got \"a\""});
  refused(bezier, "{\"points\": [[[0,0,0],[1,0,null]], [[0,1,0],[1,1,0]]]}",
          {"points[0][1][2]: expected a number, got null"});
  refused(bezier, "{\"points\": [[[0,0,0],5], [[0,1,0],[1,1,0]]]}",
          {"points[0][1]: expected a point [x, y, z], got 5", "[x, y, z]"});
  refused(bezier, "{" + bezier_net + ", \"degree_u\": 3}",
          {"degree_u: expected 1, one less than there are", "rows of points"});
  refused(bezier, "{" + bezier_net + ", \"degree_v\": 0}",
          {"degree_v: expected an integer from 1 to 15, got 0"});
  refused(bezier, "{" + bezier_net + ", \"degree_v\": 2.5}",
          {"degree_v: expected an integer from 1 to 15, got 2.5"});
  refused(bezier, "{" + bezier_net + ", \"weights\": [[1,1,1]]}", {"weights: expected 2 rows, got 1"});
  refused(bezier, "{" + bezier_net + ", \"weights\": [[1,1,1],[1,1]]}",
          {"weights[1]: expected 3 weights, got 2"});
  refused(bezier, "{" + bezier_net + ", \"weights\": [[1,1,1],[1,0,1]]}",
          {"weights[1][1]: expected a positive number, got 0"});
  refused(bezier, "{" + bezier_net + ", \"weights\": [[1,1,1],[1,-2.5,1]]}",
          {"weights[1][1]: expected a positive number, got -2.5"});
  std::string rows;
  for (int i = 0; i < 17; ++i) rows += (i == 0 ? "" : ",") + std::string("[[0,0,0],[0,1,0]]");
  refused(bezier, "{\"points\": [" + rows + "]}", {"points: expected at most 16 rows, got 17"});

  const std::string degrees = ", \"degree_u\": 2, \"degree_v\": 1";
  refused(bspline, "{" + bspline_net + "}", {"expected an object with degree_u, got one without"});
  refused(bspline, "{" + bspline_net + ", \"degree_u\": 16, \"degree_v\": 1}",
          {"degree_u: expected an integer from 1 to 15, got 16", "from 1 to 15"});
  refused(bspline, "{" + bspline_net + ", \"degree_u\": 4, \"degree_v\": 1}",
          {"points: expected at least 5 rows, got 4", "at least 5"});
  refused(bspline, "{" + bspline_net + ", \"degree_u\": 2, \"degree_v\": 3}",
          {"points[0]: expected at least 4 points, got 3", "at least 4"});
  refused(bspline, "{" + bspline_net + degrees + ", \"knots_u\": [0, 0, 1, 1]}",
          {"knots_u: expected 7 knots, for 4 points and degree 2, got 4"});
  refused(bspline, "{" + bspline_net + degrees + ", \"knots_u\": [0, 0, 0, 0.5, 0.25, 1, 1]}",
          {"knots_u[4]: expected knots that do not decrease, got 0.25 after 0.5", "do not decrease"});
  refused(bspline, "{" + bspline_net + degrees + ", \"knots_u\": [0, 0, 0, 0, 1, 1, 1]}",
          {"knots_u", "expected a multiplicity of at most degree + 1 = 3, got more"});
  refused(bspline, "{" + bspline_net + degrees + ", \"knots_v\": [0, 0, \"x\", 1, 1]}",
          {"knots_v[2]: expected a number, got \"x\""});
  refused(bspline, "{" + bspline_net + degrees + ", \"knots_v\": {}}",
          {"knots_v: expected an array, got object"});

  refused(turned, "{}", {"expected an object with points"});
  refused(turned, "{\"points\": [[1, 0]]}", {"points: expected at least 2 points, got 1"});
  refused(turned, "{\"points\": [[1, 0], [1, 0, 1]]}",
          {"points[1]: expected 2 coordinates, [rho, z], got 3"});
  refused(turned, "{" + profile_points + ", \"degree\": 5}", {"points: expected at least 6 points, got 5"});
  refused(turned, "{" + profile_points + ", \"degree\": 0}",
          {"degree: expected an integer from 1 to 15, got 0"});
  refused(turned, "{" + profile_points + ", \"weights\": [1, 2]}", {"weights: expected 5 weights, got 2"});
  refused(turned, "{" + profile_points + ", \"weights\": [1, 2, -1, 1, 1]}",
          {"weights[2]: expected a positive number, got -1"});
  refused(turned, "{" + profile_points + ", \"degree\": 2, \"knots\": [0,0,0,1,1,1]}",
          {"knots: expected 8 knots, for 5 points and degree 2, got 6"});

  EXPECT_NE(message<FileError>([&] {
              read_surface_file(bezier, folder_ / "none");
            }).find("none: expected a readable file"),
            std::string::npos);
  EXPECT_NE(message<FileError>([&] { read_surface_file(bezier, folder_ / ""); }).find("got a folder"),
            std::string::npos);
  EXPECT_NE(message<ParameterError>([&] {
              read_surface_file("torus", folder_ / "none");
            }).find("torus: expected a kind that is read from files: one of bezier-patch, bspline-patch"),
            std::string::npos);
}

}  // namespace
}  // namespace darboux::test::surface_files_test
