// Status::ill_conditioned: where the partials do not tell the frame to half the digits, and nowhere else.
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/catalogue.h>
#include <darboux/evaluate.h>
#include <darboux/point.h>

#include "every_surface.h"
#include "multiprecision.h"
#include "random.h"

namespace darboux::test::ill_conditioned_test {
namespace {

constexpr double half_the_digits = 0x1p-26;

// The angle, to first order, between a patch's normal and that of 60 digits.
template <class Patch>
double normal_error(const Patch& patch, double u, double v, const Frame<double>& f) {
  using B = BoostDigits<60>;
  const Jet2<B> j = jet(rebind<B>(patch), B(u), B(v));
  const Vec3<B> n = unit(cross(j.dpdu, j.dpdv)), own{f.n.x, f.n.y, f.n.z};
  const Vec3<B> d = n - own;
  return static_cast<double>(sqrt(dot(d, d)));
}

std::vector<Vec3<double>> random_points(Random& random, int count) {
  std::vector<Vec3<double>> points;
  for (int i = 0; i < count; ++i)
    points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  return points;
}
std::vector<double> random_weights(Random& random, int count, double least) {
  std::vector<double> weights;
  for (int i = 0; i < count; ++i) weights.push_back(random.log_uniform(least, 1));
  return weights;
}

struct Tally {
  int flagged = 0, of = 0;
};
// Points without the status keep half the digits of their normal.
template <class Patch>
void count(const Patch& patch, Random& random, Tally& tally) {
  for (int i = 0; i < 10; ++i) {
    const double u = random.uniform(), v = random.uniform();
    const Frame<double> f = frame(patch, u, v);
    if (has(f.status, Status::no_frame)) continue;
    ++tally.of;
    const bool flagged = has(f.status, Status::ill_conditioned);
    tally.flagged += flagged ? 1 : 0;
    if (flagged) continue;
    const double error = normal_error(patch, u, v, f);
    EXPECT_LE(error, half_the_digits) << "at u = " << u << ", v = " << v;
  }
}

TEST(IllConditioned, WeightsFarApartAreToldOrHarmless) {
  Random random(10);
  Tally tally;
  for (int i = 0; i < 300; ++i) {
    const int p = 1 + static_cast<int>(random.bits() % 4), q = 1 + static_cast<int>(random.bits() % 4);
    const int n = (p + 1) * (q + 1);
    count(BezierPatch<double>(p, q, random_points(random, n), random_weights(random, n, 1e-12)), random,
          tally);
    const int m = (p + 3) * (q + 3);
    count(BSplinePatch<double>(p, q, clamped_knots(p, p + 3), clamped_knots(q, q + 3),
                               random_points(random, m), random_weights(random, m, 1e-12)),
          random, tally);
  }
  EXPECT_GT(tally.flagged, 10);
}

TEST(IllConditioned, OrdinaryPointsAreNot) {
  Random random(11);
  for (int i = 0; i < 100; ++i) {
    const BezierPatch<double> patch(3, 3, random_points(random, 16), random_weights(random, 16, 1e-2));
    for (int k = 0; k < 100; ++k)
      EXPECT_FALSE(has(frame(patch, random.uniform(), random.uniform()).status, Status::ill_conditioned));
  }
  for (const AnySurface& surface : all_surfaces())
    for (int k = 0; k < 200; ++k)
      EXPECT_FALSE(has(surface.frame(random.uniform(), random.uniform()).status, Status::ill_conditioned))
          << surface.specification();
}

// Two partials at an angle of 1e-9: nine digits of the normal are left. Singly and in batches.
TEST(IllConditioned, PartialsNearlyParallelAre) {
  const BilinearPatch<double> oblique{{0, 0, 0}, {1, 0, 0}, {1, 1e-9, 0}, {2, 1e-9, 1e-9}},
      ordinary{{0, 0, 0}, {1, 0, 0}, {1, 1e-3, 0}, {2, 1e-3, 1e-9}};
  EXPECT_EQ(frame(oblique, 0.3, 0.4).status, Status::ill_conditioned);
  EXPECT_EQ(frame(ordinary, 0.3, 0.4).status, Status::regular);
  std::array<double, 64> uv{};
  Random random(12);
  for (double& x : uv) x = random.uniform(0.1, 0.9);
  std::array<Status, 32> status{};
  std::array<Vec3<double>, 32> normals{};
  Outputs<double> out;
  out.packed(Attribute::normal, std::span<double>(&normals[0].x, 96)).status(status);
  const StatusSummary summary = evaluate(oblique, Points<double>::interleaved(uv), out);
  for (std::size_t i = 0; i < status.size(); ++i) {
    EXPECT_EQ(status[i], Status::ill_conditioned);
    EXPECT_EQ(normals[i], frame(oblique, uv[2 * i], uv[2 * i + 1]).n);
  }
  EXPECT_EQ(summary.count[11], 32u);
  EXPECT_EQ(status_names[11], "ill_conditioned");
}

}  // namespace
}  // namespace darboux::test::ill_conditioned_test
