// The stress list for evaluation: extreme inputs, and the right answer or the right refusal.
// docs/reports/stress-list.md says for each group of inputs what is done about it, and where the rest of them
// are tested.
#include <cmath>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/error.h>
#include <darboux/placed.h>
#include <darboux/torus.h>

namespace darboux::test::stress_list_test {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity(),
                 nan = std::numeric_limits<double>::quiet_NaN();
constexpr double tiny = 5e-324;
const double below_one = std::nextafter(1.0, 0.0), above_half = std::nextafter(0.5, 1.0);

// One input and what is right.
struct Stress {
  int group;            // of the list
  std::string surface;  // as on the command line
  double u = 0, v = 0;
  // The status has these bits and none of those; frames are numbers, or NaN where there is none.
  Status has_bits = Status::regular, has_not = Status::no_frame | Status::non_finite_input;
  // The same bits of t, b and n as there.
  struct Same {
    std::string surface;
    double u, v;
  };
  std::optional<Same> same{};
  // The parameters are refused, with these words.
  std::string refused{};
};
void PrintTo(const Stress& s, std::ostream* out) {
  *out << "group " << s.group << ": " << s.surface << " at " << s.u << ", " << s.v;
}

const std::string torus = "torus:major_radius=1,minor_radius=0.4";
std::vector<Stress> stress_list() {
  constexpr Status limit = Status::dpdu_zero | Status::limit_frame, none = Status::regular;
  constexpr Status not_a_number = Status::no_frame | Status::non_finite_input;
  std::vector<Stress> list;
  // 1, 2: any finite u is its remainder; NaN and infinity are said.
  for (const double u : {1.0, -0.0, 5.0, -3.0, 1e15, 1e308, -1e308})
    list.push_back({1, torus, u, 0.3, none, not_a_number, Stress::Same{torus, 0, 0.3}});
  list.push_back({1, torus, 0x1p51 + 0.5, 0.3, none, not_a_number, Stress::Same{torus, 0.5, 0.3}});
  for (const double u : {nan, inf, -inf}) list.push_back({2, torus, u, 0.3, Status::non_finite_input, none});
  // 3: towards a pole t is that of the given u, to the bit; at it the limit is said.
  for (const double v : {tiny, 1e-300, 1e-17, 0.3, below_one}) list.push_back({3, "sphere", 0.3, v});
  for (const double v : {0.0, 1.0}) list.push_back({3, "sphere", 0.3, v, limit});
  // 4: outside the domain the extension, said.
  for (const double v : {-1e-9, 1 + 1e-9}) list.push_back({4, "sphere", 0.3, v, Status::outside_domain});
  // 5: the frame does not know the size.
  for (const char* r : {"5e-324", "1e-300", "1e-160", "1e160", "1e300"})
    list.push_back({5, std::string("sphere:radius=") + r, 0.3, 0.7, none, not_a_number,
                    Stress::Same{"sphere", 0.3, 0.7}});
  // 6: no size.
  for (const char* r : {"0", "-1", "nan", "inf", "-inf"})
    list.push_back({6, std::string("sphere:radius=") + r, 0, 0, none, none, {}, "radius"});
  // 7: the horn, its neighbours, the spindle, the thinnest ring.
  list.push_back({7, "torus:major_radius=1,minor_radius=1", 0.3, 0.5, limit});
  list.push_back({7, "torus:major_radius=1,minor_radius=1", 0.3, above_half});
  list.push_back(
      {7, "torus:major_radius=1,minor_radius=1.000000000000001", 0.3, 0.5, Status::self_intersecting});
  list.push_back({7, "torus:major_radius=1e16,minor_radius=1", 0.3, 0.2});
  // 8: an apex has a frame for each u.
  list.push_back({8, "cone", 0.3, 1, limit});
  list.push_back({8, "cone", 0.3, below_one, none, limit | not_a_number});
  list.push_back({8, "cone:radius=0", 0, 0, none, none, {}, "radius"});
  // 9: axes 1e300 apart.
  list.push_back({9, "ellipsoid:semi_axis_x=1e150,semi_axis_y=1,semi_axis_z=1e-150", 0.3, 0.7});
  // 11: the position overflows, the frame does not.
  list.push_back({11, "catenoid:extent=800", 0.3, 1, Status::overflow});
  return list;
}

class StressList : public ::testing::TestWithParam<Stress> {};
INSTANTIATE_TEST_SUITE_P(Evaluation, StressList, ::testing::ValuesIn(stress_list()), [](const auto& info) {
  return "group" + std::to_string(info.param.group) + "_" + std::to_string(info.index);
});

TEST_P(StressList, GivesTheRightAnswerOrTheRightRefusal) {
  const Stress& s = GetParam();
  if (!s.refused.empty()) {
    try {
      make_surface(s.surface);
      ADD_FAILURE() << "not refused";
    } catch (const ParameterError& e) {
      EXPECT_NE(std::string(e.what()).find(s.refused), std::string::npos) << e.what();
    }
    return;
  }
  const Sample<double> sample = make_surface(s.surface).sample(s.u, s.v);
  const Frame<double>& f = sample.frame;
  EXPECT_EQ(f.status & s.has_bits, s.has_bits);
  EXPECT_FALSE(has(f.status, s.has_not));
  const bool is_number = std::isfinite(f.t.x + f.b.y + f.n.z);
  EXPECT_EQ(is_number, !has(f.status, Status::no_frame | Status::non_finite_input));
  if (is_number) {
    // Orthonormal and right-handed, whatever the input.
    EXPECT_NEAR(norm(f.t), 1, 0x1p-50);
    EXPECT_NEAR(norm(f.n), 1, 0x1p-50);
    EXPECT_NEAR(dot(f.t, f.n), 0, 0x1p-50);
    EXPECT_NEAR(norm(cross(f.n, f.t) - f.b), 0, 0x1p-50);
  }
  if (s.same) {
    const Frame<double> g = make_surface(s.same->surface).frame(s.same->u, s.same->v);
    EXPECT_EQ(f.t, g.t);
    EXPECT_EQ(f.b, g.b);
    EXPECT_EQ(f.n, g.n);
    EXPECT_EQ(f.status, g.status);
  }
}

// 3: t does not change along a meridian.
TEST(StressList, TheTangentIsTheSameDownToThePole) {
  const AnySurface sphere = make_surface("sphere");
  for (const double v : {0.0, tiny, 1e-300, 1e-17, below_one, 1.0})
    EXPECT_EQ(sphere.frame(0.3, v).t, sphere.frame(0.3, 0.5).t) << v;
}

// 9: an ellipsoid of equal axes is the sphere, to within 8 roundings.
TEST(StressList, AnEllipsoidOfEqualAxesIsTheSphere) {
  const AnySurface sphere = make_surface("sphere"),
                   ellipsoid = make_surface("ellipsoid:semi_axis_x=1,semi_axis_y=1,semi_axis_z=1");
  for (int i = 0; i < 100; ++i) {
    const double u = 0.01 * i + 0.003, v = 0.0099 * i + 0.005;
    const Frame<double> a = sphere.frame(u, v), b = ellipsoid.frame(u, v);
    EXPECT_LE(norm(a.t - b.t) + norm(a.b - b.b) + norm(a.n - b.n), 8 * 0x1p-53) << u << ' ' << v;
  }
}

// 12: once round a Moebius strip v is 1 - v and n turns over.
TEST(StressList, AMoebiusStripTurnsItsNormalOver) {
  const AnySurface strip = make_surface("moebius-strip");
  for (const double v : {0.0, 0.2, 0.5, 1.0}) {
    const Frame<double> a = strip.frame(0, v), b = strip.frame(1, 1 - v);
    EXPECT_LE(norm(a.n + b.n), 4 * 0x1p-53) << v;
    EXPECT_LE(norm(a.t - b.t), 8 * 0x1p-53) << v;
  }
}

// 15, 16: a translation of any length leaves the frame's bits; a mirror turns the handedness; a map without
// inverse is refused.
TEST(StressList, PlacementsMoveTurnMirrorOrAreRefused) {
  const Torus base{1.0, 0.4};
  const auto placed = [&](std::array<double, 9> A, double x) {
    return AnySurface(Placed{base, A, Vec3<double>{x, -x, x}});
  };
  const std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1}, mirror{-1, 0, 0, 0, 1, 0, 0, 0, 1};
  const Frame<double> at_home = placed(identity, 0).frame(0.3, 0.7);
  for (const double x : {1e12, 1e300}) {
    const Frame<double> f = placed(identity, x).frame(0.3, 0.7);
    EXPECT_TRUE(f.t == at_home.t && f.b == at_home.b && f.n == at_home.n) << x;
  }
  EXPECT_EQ(placed(mirror, 0).frame(0.3, 0.7).handedness, -at_home.handedness);
  for (const std::array<double, 9>& A : {std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 0},
                                         {1, 0, 0, 0, 1, 0, 0, 0, 1e-200},
                                         {1, 2, 3, 2, 4, 6, 0, 0, 1}})
    EXPECT_THROW(placed(A, 0), ParameterError);
}

}  // namespace
}  // namespace darboux::test::stress_list_test
