// Adapted surfaces where the chart of their base collapses: the limits are those of the base.
#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/curvature.h>
#include <darboux/offset.h>
#include <darboux/placed.h>
#include <darboux/reparametrised.h>

#include "adapted.h"

namespace darboux::test::adaptors_singular_test {
namespace {

// A point where the base's chart collapses, in the adaptor's coordinates: the status bits it has there, the
// direction into the domain along which the frame is continuous, and the base's bits and point.
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
  // Of one formula and one spline; the others would each take a second more to compile.
  if constexpr (std::is_same_v<X, Ellipsoid<>> || std::is_same_v<X, decltype(cap())>) {
    all.push_back({at + "_offset_swapped", Offset{swapped(base), 0.03125}, edge, u, dv, {in, 0}});
    all.push_back({at + "_swapped_offset", swapped(Offset{base, 0.03125}), edge, u, dv, {in, 0}});
  }
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

TEST(CollapsedPoints, HoldNestedAdaptors) {
  const std::vector<Collapsed> all = collapsed_points();
  EXPECT_EQ(std::count_if(all.begin(), all.end(),
                          [](const Collapsed& x) { return x.name.ends_with("_offset_swapped"); }),
            4);
}

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

  // The frame approaches the limit linearly in the distance, with the rate at which it turns; a partial of
  // size distance · |d2pduv| has lost as many digits. The offset's partials carry the rounding of twice
  // differentiated ones.
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

// The apex of a cone has a frame for every u but no curvature; all other points here have the limit of the
// curvature.
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
  // Extrapolated linearly: what is left is of second order, 1e-8 times the second derivative of the curvature
  // by u or v (some (2π)² for these), and rounding of 2^14 · 64u.
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

}  // namespace
}  // namespace darboux::test::adaptors_singular_test
