// adaptors.h: every law holds for adapted surfaces, n is the base's, and singular points are the base's singular points.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/adaptors.h>
#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/testing.h>

#include "compare_frames.h"
#include "every_surface.h"

namespace darboux::test {
namespace {

// The sign of det(dpdu, dpdv, n).
double det_sign(const Jet2<double>& j, const Vec3<double>& n) {
  return dot(cross(unit(j.dpdu), unit(j.dpdv)), n) < 0 ? -1 : 1;
}

// ---- surfaces and what is made of them -------------------------------------------------------------------------

using Linear = std::array<double, 9>;
// A rotation by 36.87 degrees about z after one by 90 about x, to the last bit; a non-uniform map; a mirror.
constexpr Linear rotation{0.6, 0, 0.8, 0.8, 0, -0.6, 0, 1, 0};
constexpr Linear uneven{2, 0.5, 0, -0.25, 1, 0.75, 0, 0.5, 0.5};
constexpr Linear mirror{-1, 0, 0, 0, 1, 0, 0, 0, 1};

// An adapted surface, and how it comes from its base: base (u, v) = map (u, v), P = A P_base + d A^-T n_base.
struct Adapted {
  std::string name;
  AnySurface surface, base;
  std::array<double, 6> map{1, 0, 0, 1, 0, 0};  // row by row, then the offset
  Linear A{1, 0, 0, 0, 1, 0, 0, 0, 1};
  double handedness = 1;  // times the base's
  double distance = 0;

  Vec2<double> at(double u, double v) const {
    return {map[0] * u + map[1] * v + map[4], map[2] * u + map[3] * v + map[5]};
  }
  Eigen::Matrix3d linear() const {
    Eigen::Matrix3d m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = A[static_cast<std::size_t>(k)];
    return m;
  }
};

void PrintTo(const Adapted& x, std::ostream* out) {
  *out << x.name;
}

std::string identifier(std::string_view name) {
  std::string result(name);
  for (char& c : result)
    if (c == '-') c = '_';
  return result;
}

template <class X>
void add_charts(std::vector<Adapted>& all, const X& base) {
  const std::string name = identifier(X::info.name);
  const auto add = [&](const char* how, const Reparametrised<X>& surface, double sign) {
    const auto& [a, b, c, d] = surface.M;
    all.push_back({name + how,
                   surface,
                   base,
                   {a, b, c, d, surface.offset[0], surface.offset[1]},
                   {1, 0, 0, 0, 1, 0, 0, 0, 1},
                   sign});
  };
  add("_swapped", swapped(base), -1);
  add("_flipped_u", flipped_u(base), -1);
  add("_flipped_v", flipped_v(base), -1);
  add("_sub_rectangle", sub_rectangle(base, 0.125, 0.75, 0.25, 0.875), 1);
  add("_reversed_sub_rectangle", sub_rectangle(base, 0.75, 0.125, 0.25, 0.875), -1);
  add("_sheared", sheared(base, 0.75), 1);
}

template <class X>
void add_placed(std::vector<Adapted>& all, const X& base) {
  const std::string name = identifier(X::info.name);
  all.push_back(
      {name + "_rotated", Placed{base, rotation, {3, -2, 1}}, base, {1, 0, 0, 1, 0, 0}, rotation, 1});
  all.push_back({name + "_stretched", Placed{base, uneven, {1, 2, 3}}, base, {1, 0, 0, 1, 0, 0}, uneven, 1});
  all.push_back({name + "_mirrored", Placed{base, mirror, {0, 0, 0}}, base, {1, 0, 0, 1, 0, 0}, mirror, -1});
}

// \param d within the focal distances: the handedness is the base's
template <class X>
void add_offset(std::vector<Adapted>& all, const X& base, double d) {
  const std::string name = identifier(X::info.name);
  for (const double distance : {d, -d}) {
    all.push_back({name + (distance == d ? "_offset" : "_offset_back"), Offset{base, distance}, base});
    all.back().distance = distance;
  }
}

BezierPatch<double> cap() {  // both edges along u collapsed, with horizontal tangent planes there; rational
  const Vec3<double> south{0, 0, -1}, north{0, 0, 1};
  return BezierPatch<double>(2, 3,
                             {south,
                              {1, 0, -1},
                              {1, 0, 1},
                              north,
                              south,
                              {0.75, 0.75, -1},
                              {0.75, 0.75, 1},
                              north,
                              south,
                              {0, 1, -1},
                              {0, 1, 1},
                              north},
                             {1, 0.75, 1, 1, 0.75, 0.5, 0.75, 0.75, 1, 0.75, 1, 1});
}
BezierPatch<double> fan() {  // its edge u = 0 collapsed, obliquely: dpdv vanishes there
  const Vec3<double> tip{0, 0, 0};
  return BezierPatch<double>(
      2, 2, {tip, tip, tip, {1, -0.5, 0}, {1, 0.25, 0}, {1, 0.75, 0}, {2, -1, 0.5}, {2, 0, 0}, {2, 1, 0.25}});
}

// What is made of the sphere by position alone.
struct Bump {
  static constexpr SurfaceInfo info{"bump", "a wavy ellipsoid by its position alone", Coordinate::turn,
                                    Coordinate::half_turn};
  template <class S>
  Vec3<S> position(const Turn<S>& u, const Turn<S>& v) const {
    const S one = lift<S>(1.0), wave = one + lift<S>(0.125) * v.cos * v.cos * v.cos;
    return {wave * v.sin * u.cos, lift<S>(0.75) * wave * v.sin * u.sin, -(wave * v.cos)};
  }
};
struct Valley {
  static constexpr SurfaceInfo info{"valley", "z = u² v + v³ over the unit square", Coordinate::linear,
                                    Coordinate::linear};
  template <class S>
  Vec3<S> position(const S& u, const S& v) const {
    return {u, v, u * u * v + v * v * v};
  }
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const S two = lift<S>(2.0), three = lift<S>(3.0), one = lift<S>(1.0), xx = p.x * p.x, yy = p.y * p.y;
    return (p.z - xx * p.y - yy * p.y) / norm(Vec3<S>{two * (p.x * p.y), xx + three * yy, one});
  }
};
// The torus of the catalogue, by its position and parameters alone.
template <class T = double>
struct Ring {
  T major_radius{1}, minor_radius{0.25};
  static constexpr SurfaceInfo info{"ring", "a torus by its position alone", Coordinate::turn,
                                    Coordinate::turn};
  static constexpr auto parameters() {
    return std::array{parameter<&Ring::major_radius>("major_radius", Range::positive(), "length"),
                      parameter<&Ring::minor_radius>("minor_radius", Range::positive(), "length")};
  }
  template <class S>
  Vec3<S> position(const Turn<S>& u, const Turn<S>& v) const {
    const S rho = lift<S>(major_radius) + lift<S>(minor_radius) * v.cos;
    return {rho * u.cos, rho * u.sin, lift<S>(minor_radius) * v.sin};
  }
};

const std::vector<Adapted>& charts() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    add_charts(list, Sphere{2.0});
    add_charts(list, Torus{1.0, 0.25});
    add_charts(list, Cone{1.0, 2.0});
    add_charts(list, Ellipsoid{1.0, 0.7, 0.5});
    add_charts(list, MoebiusStrip{1.0, 0.5});
    add_charts(list, Enneper{1.0, 1.0});
    add_charts(list, BezierPatch<double>());
    return list;
  }();
  return all;
}
const std::vector<Adapted>& placements() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    add_placed(list, Sphere{2.0});
    add_placed(list, Torus{1.0, 0.25});
    add_placed(list, Cone{1.0, 2.0});
    add_placed(list, Ellipsoid{1.0, 0.7, 0.5});
    add_placed(list, Helicoid<double>());
    add_placed(list, KleinBottle<double>());
    add_placed(list, BezierPatch<double>());
    add_placed(list, BilinearPatch<double>());
    return list;
  }();
  return all;
}
const std::vector<Adapted>& offsets() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    add_offset(list, Sphere{2.0}, 0.5);
    add_offset(list, Torus{1.0, 0.25}, 0.125);
    add_offset(list, Ellipsoid{1.0, 0.7, 0.5}, 0.125);  // the least radius of curvature is 0.25
    add_offset(list, KleinBottle<double>(), 0.03125);
    add_offset(list, Cylinder{1.0, 2.0}, 0.5);
    add_offset(list, Catenoid<double>(), 0.25);
    add_offset(list, BezierPatch<double>(), 0.03125);
    return list;
  }();
  return all;
}
const std::vector<Adapted>& compositions() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    const Ellipsoid ellipsoid{1.0, 0.7, 0.5};
    const Torus torus{1.0, 0.25};
    list.push_back(
        {"offset_of_flipped", Offset{flipped_v(ellipsoid), 0.125}, ellipsoid, {1, 0, 0, -1, 0, 1}});
    list.back().handedness = -1;
    list.back().distance = 0.125;
    list.push_back({"offset_of_swapped_sheared",
                    Offset{swapped(sheared(torus, 0.5)), -0.125},
                    torus,
                    {0.5, 1, 1, 0, 0, 0}});
    list.back().handedness = -1;
    list.back().distance = -0.125;
    list.push_back({"placed_offset",
                    Placed{Offset{ellipsoid, 0.125}, mirror, {1, 2, 3}},
                    Offset{ellipsoid, 0.125},
                    {1, 0, 0, 1, 0, 0},
                    mirror,
                    -1});
    list.push_back({"placed_placed",
                    Placed{Placed{torus, uneven, {1, 0, 0}}, mirror, {0, 1, 0}},
                    Placed{torus, uneven, {1, 0, 0}},
                    {1, 0, 0, 1, 0, 0},
                    mirror,
                    -1});
    list.push_back(
        {"flipped_placed", flipped_u(Placed{torus, mirror, {0, 0, 0}}), torus, {-1, 0, 0, 1, 1, 0}, mirror});
    list.push_back({"offset_of_offset", Offset{Offset{torus, 0.0625}, 0.0625}, torus});
    list.back().distance = 0.125;
    return list;
  }();
  return all;
}
std::vector<Adapted> everything() {
  std::vector<Adapted> all;
  for (const auto* list : {&charts(), &placements(), &offsets(), &compositions()})
    all.insert(all.end(), list->begin(), list->end());
  return all;
}

class EveryAdaptor : public ::testing::TestWithParam<Adapted> {};
INSTANTIATE_TEST_SUITE_P(Adaptors, EveryAdaptor, ::testing::ValuesIn(everything()),
                         [](const auto& info) { return info.param.name; });

std::vector<Adapted> every_offset() {
  std::vector<Adapted> all = everything();
  std::erase_if(all, [](const Adapted& x) { return x.distance == 0; });
  return all;
}
class EveryOffset : public ::testing::TestWithParam<Adapted> {};
INSTANTIATE_TEST_SUITE_P(Adaptors, EveryOffset, ::testing::ValuesIn(every_offset()),
                         [](const auto& info) { return info.param.name; });

#ifdef DARBOUX_SHORT_TESTS
constexpr int law_points = 10;
#else
constexpr int law_points = 50;
#endif

TEST_P(EveryAdaptor, ObeysAllLaws) {
  EXPECT_EQ(broken_laws(GetParam().surface, {.points = law_points, .seed = 3}), "");
}

// The position is the base's, mapped; n is the base's n, by the inverse transpose where it is placed; the handedness is
// the base's times -1 for each flip, swap and mirror.
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
    // The map of (u, v) is exact but for its last addition, so at and the coordinates within are the same numbers.
    EXPECT_LE(norm(f.n - (placed ? expected.n : base.n)), (placed ? 64 : 0) * roundoff) << u << ' ' << v;
    EXPECT_EQ(f.handedness, x.handedness * base.handedness) << u << ' ' << v;
    EXPECT_EQ(det_sign(x.surface.jet(u, v), f.n), f.handedness) << u << ' ' << v;
  }
  EXPECT_GT(compared, 900);
}

// ---- singular points -------------------------------------------------------------------------------------------

// A point where the base's chart collapses, in the adaptor's coordinates: the status bits it has there, the direction
// into the domain along which the frame is continuous, and the base's bits and point.
struct Collapsed {
  std::string name;
  AnySurface surface;
  double u, v;
  Status bits;
  Vec2<double> inwards;
};
void PrintTo(const Collapsed& x, std::ostream* out) {
  *out << x.name;
}

// \param base a surface whose dpdu vanishes at v = edge (0 or 1)
template <class X>
void add_collapsed(std::vector<Collapsed>& all, const std::string& name, const X& base, double edge) {
  const double in = edge == 0 ? 1 : -1, u = 0.3;
  constexpr Status du = Status::dpdu_zero, dv = Status::dpdv_zero;
  const std::string at = name + (edge == 0 ? "_v0" : "_v1");
  all.push_back({at, base, u, edge, du, {0, in}});
  all.push_back({at + "_swapped", swapped(base), edge, u, dv, {in, 0}});
  all.push_back({at + "_flipped_u", flipped_u(base), u, edge, du, {0, in}});
  all.push_back({at + "_flipped_v", flipped_v(base), u, 1 - edge, du, {0, -in}});
  all.push_back({at + "_part", sub_rectangle(base, 0.25, 0.5, edge, 0.5), u, 0, du, {0, 1}});
  all.push_back({at + "_sheared", sheared(base, 0.5), u, edge, du, {0, in}});
  // v of the base = (u + v)/2: both partials lie along the base's dpdv.
  all.push_back({at + "_slanted",
                 Reparametrised<X>{base, {0.5, -0.5, 0.5, 0.5}, {0.25, 0}},
                 edge,
                 edge,
                 Status::parallel,
                 {0, in}});
  all.push_back({at + "_placed", Placed{base, uneven, {1, 2, 3}}, u, edge, du, {0, in}});
  all.push_back({at + "_mirrored", Placed{base, mirror, {0, 0, 0}}, u, edge, du, {0, in}});
  if (name == "cone") return;  // n depends on u at its apex: its offset is regular there
  all.push_back({at + "_offset", Offset{base, 0.03125}, u, edge, du, {0, in}});
  all.push_back({at + "_offset_swapped", Offset{swapped(base), 0.03125}, edge, u, dv, {in, 0}});
  all.push_back({at + "_swapped_offset", swapped(Offset{base, 0.03125}), edge, u, dv, {in, 0}});
}

std::vector<Collapsed> collapsed_points() {
  std::vector<Collapsed> all;
  for (const double edge : {0.0, 1.0}) {
    add_collapsed(all, "sphere", Sphere{2.0}, edge);
    add_collapsed(all, "ellipsoid", Ellipsoid{1.0, 0.7, 0.5}, edge);
    add_collapsed(all, "cap", cap(), edge);
  }
  add_collapsed(all, "cone", Cone{1.0, 2.0}, 1);
  add_collapsed(all, "disk", Disk{1.0, 0.0}, 1);
  add_collapsed(all, "paraboloid", EllipticParaboloid{1.0, 0.7, 1.0}, 0);
  add_collapsed(all, "hyperboloid", TwoSheetHyperboloid{1.0, 0.7, 1.0, 1.0}, 0);
  add_collapsed(all, "fan", swapped(fan()), 0);
  return all;
}

class CollapsedPoint : public ::testing::TestWithParam<Collapsed> {};
INSTANTIATE_TEST_SUITE_P(Adaptors, CollapsedPoint, ::testing::ValuesIn(collapsed_points()),
                         [](const auto& info) { return info.param.name; });

TEST_P(CollapsedPoint, GivesTheLimitAndSaysSo) {
  const Collapsed& x = GetParam();
  const Frame<double> f = x.surface.frame(x.u, x.v);
  EXPECT_EQ(f.status & (Status::dpdu_zero | Status::dpdv_zero | Status::parallel), x.bits);
  EXPECT_TRUE(has(f.status, Status::limit_frame));
  EXPECT_FALSE(has(f.status, Status::no_frame | Status::outside_domain | Status::overflow));
  const Sample<double> s = x.surface.sample(x.u, x.v);
  for (const Vec3<double>& a :
       {s.jet.position, s.jet.dpdu, s.jet.dpdv, s.jet.d2pdu2, s.jet.d2pduv, s.jet.d2pdv2})
    EXPECT_TRUE(std::isfinite(norm(a)));
  for (const Vec3<double>& a : {f.t, f.b, f.n}) EXPECT_NEAR(norm(a), 1, 8 * roundoff);
  EXPECT_LE(norm(cross(f.n, f.t) - f.b), 8 * roundoff);
  if (has(x.bits, Status::dpdu_zero)) {
    EXPECT_LE(norm(s.jet.dpdu), 64 * roundoff * norm(s.jet.dpdv));
  }
  if (has(x.bits, Status::dpdv_zero)) {
    EXPECT_LE(norm(s.jet.dpdv), 64 * roundoff * norm(s.jet.dpdu));
  }
  if (x.bits == Status::parallel) {
    EXPECT_LE(norm(cross(unit(s.jet.dpdu), unit(s.jet.dpdv))), 64 * roundoff);
  }

  // The frame approaches the limit linearly in the distance, with the rate at which it turns; a partial of size
  // distance · |d2pduv| has lost as many digits. The offset's partials carry the rounding of twice differentiated ones.
  for (const double distance : {1e-3, 1e-5, 1e-7}) {
    const double u = x.u + distance * x.inwards.x, v = x.v + distance * x.inwards.y;
    const Frame<double> near = x.surface.frame(u, v);
    EXPECT_FALSE(has(near.status, Status::limit_frame | Status::no_frame));
    const double bound = 20 * distance + 1024 * roundoff / distance;
    EXPECT_LE(norm(near.t - f.t), bound) << distance;
    EXPECT_LE(norm(near.b - f.b), bound) << distance;
    EXPECT_LE(norm(near.n - f.n), bound) << distance;
    EXPECT_EQ(near.handedness, f.handedness) << distance;
  }
}

// The apex of a cone has a frame for every u but no curvature; all other points here have the limit of the curvature.
TEST_P(CollapsedPoint, HasTheLimitOfTheCurvature) {
  const Collapsed& x = GetParam();
  const Curvature<double> c = curvature(x.surface, x.u, x.v);
  if (x.name.starts_with("cone")) {
    EXPECT_TRUE(std::isnan(c.gaussian) && std::isnan(c.mean) && std::isnan(c.principal[0]));
    return;
  }
  const auto at = [&](double distance) {
    return curvature(x.surface, x.u + distance * x.inwards.x, x.v + distance * x.inwards.y);
  };
  const Curvature<double> near = at(0x1p-13), nearer = at(0x1p-14);
  const double size = std::fabs(c.principal[0]) + std::fabs(c.principal[1]);
  // Extrapolated linearly: what is left is of second order, 1e-8 times the second derivative of the curvature by u or v
  // (some (2π)² for these), and rounding of 2^14 · 64u.
  const double bound = 1e-6 * (1 + size);
  EXPECT_NEAR(c.mean, 2 * nearer.mean - near.mean, bound);
  EXPECT_NEAR(c.gaussian, 2 * nearer.gaussian - near.gaussian, bound * (1 + size));
  EXPECT_FALSE(has(c.status, Status::no_frame));
  if (has(c.status, Status::umbilic)) return;
  const Vec3<double> direction = c.directions[0], other = nearer.directions[0];
  EXPECT_LE(norm(cross(direction, other)), 0.01);
  EXPECT_EQ(c.directions[0], c.directions[0]);
}

// Infinite partials pass through a swap: nothing is multiplied by zero.
TEST(Reparametrised, KeepsInfinitePartials) {
  const Superellipsoid<double> base;
  const Jet2<double> j = jet(base, 0.0, 0.3), s = jet(swapped(base), 0.3, 0.0);
  EXPECT_FALSE(std::isfinite(norm(j.dpdu)));
  EXPECT_EQ(s.dpdv, j.dpdu);
  EXPECT_EQ(s.dpdu, j.dpdv);
  EXPECT_EQ(s.d2pdu2, j.d2pdv2);
  const Status status = frame(swapped(base), 0.3, 0.0).status;
  EXPECT_TRUE(has(status, Status::overflow) && has(status, Status::limit_frame));
}

// Where the base's partials are infinite its frame is still a limit; so is that of the parallel surface.
TEST(Offset, KeepsTheLimitWherePartialsAreInfinite) {
  const Superellipsoid<double> base;
  const Frame<double> f = frame(base, 0.0, 0.3), offset = frame(Offset{base, 0.25}, 0.0, 0.3);
  EXPECT_TRUE(has(offset.status, Status::overflow) && has(offset.status, Status::limit_frame));
  EXPECT_EQ(offset.t, f.t);
  EXPECT_EQ(offset.n, f.n);
}

// ---- domain ----------------------------------------------------------------------------------------------------

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

// ---- refusals --------------------------------------------------------------------------------------------------

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
    EXPECT_TRUE(has_text(refused(chart), "reparametrised sphere: the map of (u, v) is singular"))
        << refused(chart);
  EXPECT_TRUE(has_text(refused(Chart{sphere, {1, 0, 0, 1}, {infinity, 0}}), "offset of (u, v)"));
  EXPECT_EQ(refused(Chart{sphere, {1e-200, 0, 0, 1e-200}, {0, 0}}), "");  // its determinant underflows

  for (const Linear& A : {Linear{1, 0, 0, 0, 1, 0, 0, 0, 0}, Linear{1, 2, 3, 2, 4, 6, 0, 0, 1},
                          Linear{1, 0, 0, 0, 1, 0, 0, 0, 1e-200}, Linear{infinity, 0, 0, 0, 1, 0, 0, 0, 1}})
    EXPECT_TRUE(has_text(refused(Placed{sphere, A, {0, 0, 0}}), "placed sphere: the placement is singular"));
  EXPECT_TRUE(has_text(refused(Placed{sphere, rotation, {0, infinity, 0}}), "translation"));
  EXPECT_EQ(refused(Placed{sphere, Linear{1e-150, 0, 0, 0, 1e-150, 0, 0, 0, 1e-150}, {0, 0, 0}}), "");
  EXPECT_TRUE(has_text(refused(Offset{sphere, infinity}), "offset sphere: the distance is not finite"));

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

// ---- placement -------------------------------------------------------------------------------------------------

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

// ---- offset ----------------------------------------------------------------------------------------------------

// Principal curvatures of the parallel surface are κ / (1 - d κ), the directions the base's.
TEST_P(EveryOffset, HasTheCurvaturesOfAParallelSurface) {
  const Adapted& x = GetParam();
  Random random(17);
  for (int i = 0; i < 200; ++i) {
    const double u = random.uniform(0.05, 0.95), v = random.uniform(0.05, 0.95);
    const Vec2<double> at = x.at(u, v);
    const Curvature<double> own = curvature(x.surface, u, v), base = curvature(x.base, at.x, at.y);
    const double k1 = base.principal[0] / (1 - x.distance * base.principal[0]),
                 k2 = base.principal[1] / (1 - x.distance * base.principal[1]);
    const double size = std::fmax(std::fabs(k1), std::fabs(k2));
    // Jets of nested dual numbers, some 100 roundings, over the focal distance (at least a fifth) and dpdu's share of
    // its scale (at least a seventh).
    const double bound = 100 * 5 * 7 * roundoff * (1 + size);
    EXPECT_NEAR(own.principal[0], k1, bound);
    EXPECT_NEAR(own.principal[1], k2, bound);
    EXPECT_NEAR(own.mean, (k1 + k2) / 2, bound);
  }
}

// The apex of a cone: its normal depends on u, so that the parallel surface has a rim there, and a chart without fault.
TEST(Offset, OfAConicalPointIsRegular) {
  const Cone cone{1.0, 2.0};
  for (const double d : {0.25, -0.25})
    for (const AnySurface& s : {AnySurface(Offset{cone, d}), AnySurface(swapped(Offset{swapped(cone), d}))}) {
      const Frame<double> f = s.frame(0.3, 1.0), near = s.frame(0.3, 1 - 0x1p-20);
      EXPECT_EQ(f.status, Status::regular);
      EXPECT_LE(norm(f.t - near.t) + norm(f.b - near.b) + norm(f.n - near.n), 8 * roundoff);
      EXPECT_EQ(f.n, frame(cone, 0.3, 1.0).n);
      EXPECT_EQ(det_sign(s.jet(0.3, 1.0), f.n), f.handedness);
      EXPECT_EQ(f.handedness, d > 0 ? 1 : -1);  // inwards the focal points of the apex lie at 0
      EXPECT_NEAR(curvature(s, 0.3, 1.0).mean, -1 / (2 * d), 64 * roundoff);  // a circle's, of the radius d
    }
}

// Past one focal point of each normal the chart turns over, past both it is as before; n never changes.
TEST(Offset, TurnsOverAtFocalPoints) {
  const Torus torus{1.0, 0.25};
  Random random(9);
  int turned = 0, twice = 0;
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform(), v = random.uniform(), d = random.uniform(-2, 2);
    const Curvature<double> c = curvature(torus, u, v);
    const double first = 1 - d * c.principal[0], second = 1 - d * c.principal[1];
    if (std::fabs(first) < 1e-6 || std::fabs(second) < 1e-6) continue;  // at the focal point itself
    const AnySurface offset = Offset{torus, d};
    const Frame<double> f = offset.frame(u, v);
    EXPECT_EQ(f.handedness, first * second < 0 ? -1 : 1) << d << ' ' << u << ' ' << v;
    EXPECT_EQ(f.n, frame(torus, u, v).n);
    EXPECT_EQ(det_sign(offset.jet(u, v), f.n), f.handedness);
    // t stays on its side until the circle of latitude it runs along is turned inside out.
    const double along = 1 - d * (-sincos_turns(v).cos / (1 + 0.25 * sincos_turns(v).cos));
    EXPECT_EQ(dot(f.t, frame(torus, u, v).t) < 0, along < 0);
    if (first * second < 0) ++turned;
    if (first < 0 && second < 0) ++twice;
  }
  EXPECT_GT(turned, 100);
  EXPECT_GT(twice, 10);
}

TEST(Offset, BeyondItsFocalPointsHasAllLaws) {
  EXPECT_EQ(broken_laws(Offset{Sphere{1.0}, -1.5}, {.points = 50}), "");       // past both
  EXPECT_EQ(broken_laws(Offset{Torus{1.0, 0.25}, -0.5}, {.points = 50}), "");  // past that of the tube
  EXPECT_EQ(broken_laws(Offset{Cylinder{1.0, 1.0}, -2.0}, {.points = 50}), "");
}

// At the pole of an ellipsoid: the same, from the limits of the partials.
TEST(Offset, TurnsOverAtFocalPointsOfAPole) {
  const Ellipsoid ellipsoid{1.0, 0.7, 0.5};  // radii of curvature 2 and 0.98 at the poles
  for (const double edge : {0.0, 1.0})
    for (const auto& [d, handedness] :
         std::vector<std::pair<double, double>>{{-0.9, 1}, {-1.5, -1}, {-2.5, 1}, {3, 1}}) {
      EXPECT_EQ(AnySurface(Offset{ellipsoid, d}).frame(0.3, edge).handedness, handedness) << d;
      EXPECT_EQ(AnySurface(Offset{swapped(ellipsoid), d}).frame(edge, 0.3).handedness, -handedness) << d;
      const Reparametrised<Ellipsoid<double>> slanted{ellipsoid, {0.5, -0.5, 0.5, 0.5}, {0.25, 0}};
      EXPECT_EQ(AnySurface(Offset{slanted, d}).frame(edge, edge).handedness, handedness) << d;
    }
}

// At the focal distance itself: a line or point has no tangents; where the tube shrinks to its centre circle, t and n
// are still known.
TEST(Offset, AtItsFocalPointsSaysSo) {
  const AnySurface line = Offset{Cylinder{1.0, 1.0}, -1.0}, point = Offset{Sphere{2.0}, -2.0},
                   circle = Offset{Torus{1.0, 0.25}, -0.25};
  Random random(21);
  for (int i = 0; i < 100; ++i) {
    const double u = random.uniform(), v = random.uniform(0.01, 0.99);
    for (const AnySurface* s : {&line, &point}) {
      const Frame<double> f = s->frame(u, v);
      EXPECT_TRUE(has(f.status, Status::no_frame) && has(f.status, Status::dpdu_zero));
      EXPECT_TRUE(std::isnan(f.t.x) && std::isnan(f.n.x));
    }
    const Frame<double> f = circle.frame(u, v);
    EXPECT_TRUE(has(f.status, Status::limit_frame) && has(f.status, Status::dpdv_zero));
    EXPECT_LE(norm(f.t - frame(Torus{1.0, 0.25}, u, v).t), 16 * roundoff);
  }
}

// ---- by position alone -----------------------------------------------------------------------------------------

TEST(FromPosition, ObeysAllLaws) {
  EXPECT_EQ(broken_laws(FromPosition<Bump>{}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(FromPosition<Valley>{}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(FromPosition<Ring<>>{{1.0, 0.4}}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(Placed{FromPosition<Valley>{}, mirror, {1, 2, 3}}, {.points = law_points}), "");
  EXPECT_EQ(broken_laws(Offset{FromPosition<Ring<>>{{1.0, 0.4}}, 0.125}, {.points = law_points}), "");
}

TEST(FromPosition, HasThePartialsOfTheClosedForm) {
  const Torus<double> closed{1.5, 0.25};
  const AnySurface ring = FromPosition<Ring<>>{{1.5, 0.25}};
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double u = random.uniform(), v = random.uniform();
    const Jet2<double> a = jet(closed, u, v), b = ring.jet(u, v);
    // Two roundings of the same sums of products, each within 8u of the scale (2π)² 1.75.
    const double bound = 16 * roundoff * 4 * std::numbers::pi * std::numbers::pi * 1.75;
    for (const auto& [x, y] : {std::pair{a.position, b.position},
                               {a.dpdu, b.dpdu},
                               {a.dpdv, b.dpdv},
                               {a.d2pdu2, b.d2pdu2},
                               {a.d2pduv, b.d2pduv},
                               {a.d2pdv2, b.d2pdv2}})
      EXPECT_LE(norm(x - y), bound);
  }
}

// Parameters are those of X: they can be set, and go to other scalars.
TEST(FromPosition, PassesParametersOn) {
  const AnySurface ring = FromPosition<Ring<>>{};
  EXPECT_EQ(ring.parameters().size(), 2U);
  EXPECT_EQ(ring.with(std::vector{3.0, 0.5}).jet(0.0, 0.0).position, (Vec3<double>{3.5, 0, 0}));
  const ManyDigits third = ManyDigits(1.0) / ManyDigits(3.0);
  const std::vector<ManyDigits> values{ManyDigits(1.0), third};
  EXPECT_EQ(ring.jet(ManyDigits(0.0), ManyDigits(0.0), values).position.x, ManyDigits(1.0) + third);
  EXPECT_THROW(AnySurface(FromPosition<Ring<>>{{-1.0, 0.25}}), ParameterError);
}

// At the poles of a surface by its position alone the frame is that of d2pduv.
TEST(FromPosition, HasLimitFramesAtPoles) {
  const AnySurface bump = FromPosition<Bump>{};
  for (const double pole : {0.0, 1.0}) {
    const Frame<double> f = bump.frame(0.3, pole), near = bump.frame(0.3, pole == 0 ? 1e-7 : 1 - 1e-7);
    EXPECT_TRUE(has(f.status, Status::dpdu_zero) && has(f.status, Status::limit_frame));
    EXPECT_LE(norm(f.t - near.t) + norm(f.n - near.n), 1e-5);
  }
}

// ---- what is wrong with the base -------------------------------------------------------------------------------

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

// ---- Gauss-Bonnet ----------------------------------------------------------------------------------------------

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
  for (const AnySurface& s : closed) {
    const std::vector<Check> checks = check_surface(s, {.points = 20, .routes = {"gauss_bonnet"}});
    ASSERT_EQ(checks.size(), 1U);
    EXPECT_EQ(checks[0].points, 1) << s.info().name << ' ' << checks[0].skipped;
    EXPECT_TRUE(checks[0].passed) << s.info().name << " is off by " << checks[0].max_error;
    EXPECT_LE(checks[0].bound * 4 * std::numbers::pi, 1.0001e-10);
  }
}

}  // namespace
}  // namespace darboux::test
