// Bounds of tiles: nothing that is seen is ever beyond them, and they are no larger than what dense sampling
// finds.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/offset.h>
#include <darboux/tile_bounds.h>

#include "every_surface.h"
#include "random.h"

namespace darboux::test::tile_bounds_test {
namespace {

constexpr int tiles_per_kind = 20000, samples = 12;
constexpr double tau = 2 * std::numbers::pi;

struct Kind {
  const char* name;
  std::function<AnySurface(Random&)> make;
  bool periodic_v;
};
void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}
const Kind kinds[] = {{"sphere", [](Random& r) { return AnySurface(Sphere{r.log_uniform(0.1, 10)}); }, false},
                      {"torus",
                       [](Random& r) {
                         const double tube = r.log_uniform(0.1, 10);
                         return AnySurface(Torus{tube * r.uniform(1, 4), tube});
                       },
                       true},
                      {"cylinder",
                       [](Random& r) {
                         return AnySurface(Cylinder{r.log_uniform(0.1, 10), r.log_uniform(0.1, 10)});
                       },
                       false},
                      {"cone",
                       [](Random& r) {
                         return AnySurface(Cone{r.log_uniform(0.1, 10), r.log_uniform(0.1, 10)});
                       },
                       false},
                      {"disk",
                       [](Random& r) {
                         const double outer = r.log_uniform(0.1, 10);
                         return AnySurface(Disk{outer, outer * r.uniform(0, 0.9)});
                       },
                       false},
                      {"plane",
                       [](Random& r) {
                         return AnySurface(Plane{r.log_uniform(0.1, 10), r.log_uniform(0.1, 10)});
                       },
                       false}};

class Tiles : public ::testing::TestWithParam<Kind> {
 protected:
  Random random{19};

  // From a hundredth of the chart to all of it; one in ten touches an edge of the domain or a quarter turn.
  Tile random_tile(bool periodic_u) {
    const auto along = [&](bool periodic, double& from, double& to) {
      const double width = random.log_uniform(0.01, 1);
      from = periodic ? random.uniform(-2, 2) : random.uniform(0, 1 - width);
      if (random.uniform() < 0.1) from = periodic ? std::round(4 * from) / 4 : 0;
      to = periodic ? from + width : std::fmin(from + width, 1);
      if (random.uniform() < 0.05) periodic ? to = from + 1 : to = 1;
    };
    Tile t;
    along(periodic_u, t.u0, t.u1);
    along(GetParam().periodic_v, t.v0, t.v1);
    return t;
  }
  Vec3<double> random_direction() {
    for (;;) {
      const Vec3<double> d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      if (norm(d) > 0.1 && norm(d) <= 1) return d;
    }
  }
  // f(position, frame) at the samples of a tile, corners and edges among them.
  template <class F>
  static void for_samples(const AnySurface& surface, const Tile& t, F f) {
    for (int i = 0; i <= samples; ++i)
      for (int k = 0; k <= samples; ++k) {
        const double u = i == samples ? t.u1 : t.u0 + (t.u1 - t.u0) * i / samples,
                     v = k == samples ? t.v1 : t.v0 + (t.v1 - t.v0) * k / samples;
        f(surface.jet(u, v).position, surface.frame(u, v));
      }
  }
};
INSTANTIATE_TEST_SUITE_P(ClosedForms, Tiles, ::testing::ValuesIn(kinds),
                         [](const auto& info) { return std::string(info.param.name); });

// A triangle within a cell, one in two times with the cell's own corners, and a point of it.
struct Triangle {
  double u[3], v[3], weight[3];

  static Triangle random_in(double u, double v, double du, double dv, Random& random) {
    Triangle t{};
    const bool corners = random.uniform() < 0.5, diagonal = random.uniform() < 0.5;
    for (int k = 0; k < 3; ++k) {
      // (0, 0), (1, 1), (1, 0), or mirrored
      const double x = corners ? (k > 0) != diagonal : random.uniform(),
                   y = corners ? k == 1 : random.uniform();
      t.u[k] = u + x * du, t.v[k] = v + y * dv;
    }
    const double a = random.uniform(), b = random.uniform();
    if (random.uniform() < 0.5)
      t.weight[0] = t.weight[1] = 0.5;  // the middle of an edge, of the diagonal among them
    else
      t.weight[0] = std::fmin(a, b), t.weight[1] = std::fabs(a - b), t.weight[2] = 1 - std::fmax(a, b);
    return t;
  }
  template <class F>
  auto mean(F f) const {
    return weight[0] * f(0) + weight[1] * f(1) + weight[2] * f(2);
  }
};

// How far interpolation in a triangle is off: in length, and the angles of n and of the worst of t, b and n.
// Where a vertex or the point has no frame the angles are 0.
struct InterpolationError {
  double chord = 0, normal = 0, frame = 0;
};
InterpolationError interpolation_error(const AnySurface& surface, const Triangle& t) {
  const double u = t.mean([&](int k) { return t.u[k]; }), v = t.mean([&](int k) { return t.v[k]; });
  Vec3<double> p[3];
  Frame<double> f[3];
  for (int k = 0; k < 3; ++k)
    p[k] = surface.jet(t.u[k], t.v[k]).position, f[k] = surface.frame(t.u[k], t.v[k]);
  const Frame<double> at = surface.frame(u, v);
  InterpolationError e;
  e.chord = norm(surface.jet(u, v).position - t.mean([&](int k) { return p[k]; }));
  if (has(at.status | f[0].status | f[1].status | f[2].status, Status::no_frame)) return e;
  const auto off = [&](auto vector) {
    return angle_between(t.mean([&](int k) { return vector(f[k]); }), vector(at));
  };
  e.normal = off([](const Frame<double>& x) { return x.n; });
  e.frame = std::fmax(e.normal, std::fmax(off([](const Frame<double>& x) { return x.t; }),
                                          off([](const Frame<double>& x) { return x.b; })));
  return e;
}

// The size of a surface about the origin.
double size_of(const AnySurface& surface) {
  double sum = 0;
  for (const ParameterValue& p : surface.parameters()) sum += p.value;
  return sum;
}

TEST_P(Tiles, SupportIsTheFarthestSample) {
  for (int i = 0; i < tiles_per_kind; ++i) {
    const AnySurface surface = GetParam().make(random);
    const Tile t = random_tile(surface.info().u == Coordinate::turn);
    const TileBounds bounds(surface, t);
    ASSERT_TRUE(bounds.known());
    const Vec3<double> d = random_direction();
    const double support = bounds.support(d);
    double farthest = -1e300;
    for_samples(surface, t, [&](const Vec3<double>& p, const Frame<double>&) {
      farthest = std::fmax(farthest, dot(d, p));
    });
    ASSERT_GE(support, farthest) << surface.specification() << ' ' << t.u0 << ' ' << t.u1 << ' ' << t.v0
                                 << ' ' << t.v1;
    // A maximum between samples is above the next of them by at most the chord bound of half a cell each way:
    // second derivatives times (h/2)²/2, which is chord() of a cell.
    const double cell_u = (t.u1 - t.u0) / samples, cell_v = (t.v1 - t.v0) / samples;
    ASSERT_LE(support, farthest + norm(d) * bounds.chord(cell_u, cell_v) + 1e-13 * size_of(surface))
        << surface.specification();
  }
}

TEST_P(Tiles, FacingIsTheLargestSample) {
  int culled = 0, back_facing = 0;
  for (int i = 0; i < tiles_per_kind; ++i) {
    const AnySurface surface = GetParam().make(random);
    const Tile t = random_tile(surface.info().u == Coordinate::turn);
    const TileBounds bounds(surface, t);
    const double size = size_of(surface);
    const Vec3<double> eye = size * random.log_uniform(0.3, 30) * random_direction(),
                       along = random_direction();
    const double facing = bounds.facing(eye), facing_along = bounds.facing_along(along);
    double most = -1e300, most_along = -1e300;
    for_samples(surface, t, [&](const Vec3<double>& p, const Frame<double>& f) {
      most = std::fmax(most, dot(f.n, eye - p));
      most_along = std::fmax(most_along, dot(f.n, along));
    });
    ASSERT_GE(facing, most) << surface.specification();
    ASSERT_GE(facing_along, most_along) << surface.specification();
    // n and P turn by at most 2π a unit of u and of v: second derivatives of n·(eye - P) up to (2π)² of
    // |eye| + size, mixed ones twice, over (h/2)²/2.
    const double turn = tau * ((t.u1 - t.u0) + (t.v1 - t.v0)) / samples, reach = norm(eye) + size;
    ASSERT_LE(facing, most + turn * turn / 8 * reach + 1e-13 * reach) << surface.specification();
    ASSERT_LE(facing_along, most_along + turn * turn / 8 * norm(along) + 1e-13) << surface.specification();
    culled += facing < 0;
    back_facing += most < 0;
  }
  // All that samples show to face away is culled, but for what hides between samples.
  EXPECT_LE(culled, back_facing);
  EXPECT_GE(culled, 0.98 * back_facing);
  EXPECT_GT(back_facing, tiles_per_kind / 20);
}

// Triangles of cells through the surface's points: the distance of the surface, at the same barycentric
// coordinates.
TEST_P(Tiles, ChordBoundsTheTriangles) {
  double closest = 0;
  for (int i = 0; i < tiles_per_kind / 4; ++i) {
    const AnySurface surface = GetParam().make(random);
    const Tile t = random_tile(surface.info().u == Coordinate::turn);
    const TileBounds bounds(surface, t);
    const double du = (t.u1 - t.u0) * random.log_uniform(0.02, 1),
                 dv = (t.v1 - t.v0) * random.log_uniform(0.02, 1);
    const double u = random.uniform(t.u0, t.u1 - du), v = random.uniform(t.v0, t.v1 - dv);
    const double chord = bounds.chord(du, dv);
    const bool upper = random.uniform() < 0.5;
    const double cu = upper ? u + du : u, cv = upper ? v + dv : v, su = upper ? -du : du,
                 sv = upper ? -dv : dv;
    const auto at = [&](double x, double y) { return surface.jet(cu + x * su, cv + y * sv).position; };
    const Vec3<double> a = at(0, 0), b = at(1, 0), c = at(0, 1);
    double worst = 0;
    for (int j = 0; j <= 8; ++j)
      for (int k = 0; j + k <= 8; ++k) {
        const double x = j / 8.0, y = k / 8.0;
        worst = std::fmax(worst, norm(at(x, y) - ((1 - x - y) * a + x * b + y * c)));
      }
    ASSERT_LE(worst, chord + 1e-13 * size_of(surface)) << surface.specification() << ' ' << du << ' ' << dv;
    if (chord > 1e-9 * size_of(surface)) closest = std::fmax(closest, worst / chord);
  }
  EXPECT_GT(closest, std::string(GetParam().name) == "plane" ? -1 : 0.95) << "a bound that is met";
}

TEST_P(Tiles, AnglesBoundTheFrames) {
  double closest_normal = 0, closest_frame = 0;
  for (int i = 0; i < tiles_per_kind / 4; ++i) {
    const AnySurface surface = GetParam().make(random);
    Tile t = random_tile(surface.info().u == Coordinate::turn);
    t.v0 = std::fmin(t.v0, 0.9), t.v1 = std::fmax(t.v1, t.v0 + 0.02);
    const double du = (t.u1 - t.u0) * random.log_uniform(0.02, 0.4),
                 dv = (t.v1 - t.v0) * random.log_uniform(0.02, 0.4);
    const TileBounds bounds(surface, t);
    if (!bounds.known()) continue;
    const double u = random.uniform(t.u0, t.u1 - du), v = random.uniform(t.v0, t.v1 - dv);
    const Frame<double> centre = surface.frame(u + du / 2, v + dv / 2);
    const double normal = bounds.normal_angle(du, dv), frame = bounds.frame_angle(du, dv);
    for (int k = 0; k < 20; ++k) {
      const double x = k < 4 ? k % 2 : random.uniform(), y = k < 4 ? k / 2 : random.uniform();
      const Frame<double> f = surface.frame(u + x * du, v + y * dv);
      // From the quaternion's vector part, which does not cancel for small angles.
      const double off = norm(cross(f.t, centre.t) + cross(f.b, centre.b) + cross(f.n, centre.n)),
                   trace = dot(f.t, centre.t) + dot(f.b, centre.b) + dot(f.n, centre.n);
      const double rotation = std::atan2(off, trace - 1);
      ASSERT_LE(angle_between(f.n, centre.n), normal + 1e-14);
      ASSERT_LE(rotation, frame + 1e-14);
      if (normal > 1e-6 && normal < 1)
        closest_normal = std::fmax(closest_normal, angle_between(f.n, centre.n) / normal);
      if (frame > 1e-6 && frame < 1) closest_frame = std::fmax(closest_frame, rotation / frame);
    }
  }
  const std::string name = GetParam().name;
  EXPECT_GT(closest_normal, name == "plane" || name == "disk" ? -1 : 0.95);
  EXPECT_GT(closest_frame, name == "plane" ? -1 : 0.95);
}

// t, b and n interpolated in triangles of cells, and normalised.
TEST_P(Tiles, InterpolationAnglesBoundTheTriangles) {
  for (int i = 0; i < tiles_per_kind; ++i) {
    const AnySurface surface = GetParam().make(random);
    const Tile t = random_tile(surface.info().u == Coordinate::turn);
    const TileRates rates = TileBounds(surface, t).rates();
    const double du = (t.u1 - t.u0) * random.log_uniform(0.02, 1),
                 dv = (t.v1 - t.v0) * random.log_uniform(0.02, 1);
    const double u = random.uniform(t.u0, t.u1 - du), v = random.uniform(t.v0, t.v1 - dv);
    const double normal = rates.normal_interpolation_angle(du, dv),
                 frame = rates.frame_interpolation_angle(du, dv);
    for (int k = 0; k < 10; ++k) {
      const InterpolationError e = interpolation_error(surface, Triangle::random_in(u, v, du, dv, random));
      // A few roundings of unit vectors.
      ASSERT_LE(e.normal, normal + 1e-14) << surface.specification() << ' ' << du << ' ' << dv;
      ASSERT_LE(e.frame, frame + 1e-14) << surface.specification() << ' ' << du << ' ' << dv;
      ASSERT_LE(e.chord, rates.chord(du, dv) + 1e-13 * size_of(surface));
    }
  }
}

// Of points of the diagonals and edges of a cell, the largest.
InterpolationError largest_error(const AnySurface& surface, double u, double v, double du, double dv) {
  InterpolationError worst;
  const double corners[4][2] = {{u, v}, {u + du, v + dv}, {u + du, v}, {u, v + dv}};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < i; ++k)
      for (const double w : {0.21, 0.35, 0.5, 0.65, 0.79}) {
        const InterpolationError e = interpolation_error(
            surface, {{corners[i][0], corners[k][0], 0}, {corners[i][1], corners[k][1], 0}, {w, 1 - w, 0}});
        worst.normal = std::fmax(worst.normal, e.normal), worst.frame = std::fmax(worst.frame, e.frame);
      }
  return worst;
}

// Of a small tile that is one cell the bound of frames is at most twice the largest error in its triangles.
// That of normals alone too, but for three times the bound's third power: at the equator of a sphere, where
// second derivatives change sign within the tile, all that is left is of third order, and two axes of turning
// are taken to be parallel.
TEST_P(Tiles, InterpolationAnglesAreNearThoseOfTriangles) {
  const bool flat_normal = GetParam().name == std::string("plane") || GetParam().name == std::string("disk"),
             flat = GetParam().name == std::string("plane");
  for (int i = 0; i < 1000; ++i) {
    const AnySurface surface = GetParam().make(random);
    const double du = random.log_uniform(0.002, 0.02), dv = random.log_uniform(0.002, 0.02),
                 u = random.uniform(0, 1 - du), v = random.uniform(0, 1 - dv);
    const TileRates rates = TileBounds(surface, {u, u + du, v, v + dv}).rates();
    const InterpolationError worst = largest_error(surface, u, v, du, dv);
    const double normal = rates.normal_interpolation_angle(du, dv),
                 frame = rates.frame_interpolation_angle(du, dv),
                 third_power = std::pow(rates.normal_u * du + rates.normal_v * dv, 3) / 48;
    if (flat_normal)
      ASSERT_EQ(normal, 0);
    else
      ASSERT_LE(normal, 2 * worst.normal + 3 * third_power)
          << surface.specification() << ' ' << du << ' ' << dv;
    if (flat)
      ASSERT_EQ(frame, 0);
    else
      ASSERT_LE(frame, 2 * worst.frame) << surface.specification() << ' ' << du << ' ' << dv;
  }
}

// ---- formulas on intervals --------------------------------------------------------------------------------

class EnclosedTiles : public ::testing::TestWithParam<AnySurface> {
 protected:
  Random random{23};

  // Other parameters: each times a factor from 1/2 to 2, where the surface takes that.
  AnySurface varied() {
    const AnySurface& surface = GetParam();
    std::vector<double> values;
    for (const ParameterValue& p : surface.parameters())
      values.push_back(p.value * random.log_uniform(0.5, 2));
    try {
      return surface.with(values);
    } catch (const ParameterError&) {
      return surface;
    }
  }
  Tile random_tile(double widest) {
    const auto along = [&](double& from, double& to) {
      const double width = random.log_uniform(0.01 * widest, widest);
      from = random.uniform() < 0.1 ? 0 : random.uniform(0, 1 - width);
      to = random.uniform() < 0.05 ? 1 : std::fmin(from + width, 1);
    };
    Tile t;
    along(t.u0, t.u1);
    along(t.v0, t.v1);
    return t;
  }
};
// Splines of several spans, some rational, some with creases; and what is made of them.
BSplineCurve<double> wave(int degree, std::vector<double> knots, bool rational, bool planar = false) {
  Random random(31);
  std::vector<Vec3<double>> points;
  std::vector<double> weights;
  for (std::size_t i = 0; i + degree + 1 < knots.size(); ++i) {
    points.push_back({1 + random.uniform(-0.2, 0.2), planar ? 0 : random.uniform(-0.2, 0.2), 0.5 * i});
    if (rational) weights.push_back(random.uniform(0.5, 2));
  }
  return {degree, std::move(knots), std::move(points), std::move(weights)};
}
BSplinePatch<double> sheet(int degree, std::vector<double> knots, bool rational) {
  Random random(37);
  const auto count = knots.size() - degree - 1;
  std::vector<Vec3<double>> points;
  std::vector<double> weights;
  for (std::size_t i = 0; i < count; ++i)
    for (int j = 0; j < 3; ++j) {
      points.push_back({0.5 * i, 0.7 * j, random.uniform(-0.4, 0.4)});
      if (rational) weights.push_back(random.uniform(0.5, 2));
    }
  return {degree, 2, std::move(knots), clamped_knots(2, 3), std::move(points), std::move(weights)};
}
const std::vector<std::pair<const char*, AnySurface>>& made_surfaces() {
  const std::vector<double> crease{0, 0, 0, 0, 0.3, 0.55, 0.55, 0.55, 1, 1, 1, 1};
  static const std::vector<std::pair<const char*, AnySurface>> list{
      {"spindle_torus", Torus{0.6, 1.0}},
      {"star", Superellipsoid{1.0, 0.8, 0.6, 1.3, 2.2}},
      {"cubic_patch", sheet(3, clamped_knots(3, 6), true)},
      {"quadratic_patch", sheet(2, clamped_knots(2, 6), false)},
      {"creased_patch", sheet(3, crease, true)},
      {"vase", SurfaceOfRevolution{wave(3, clamped_knots(3, 7), true, true)}},
      {"creased_vase", SurfaceOfRevolution{wave(3, crease, false, true)}},
      {"wall", Extrusion{wave(3, clamped_knots(3, 6), false), Vec3<double>{1, 0.5, 0}}},
      {"column", Extrusion{CircleCurve{1.0}, Vec3<double>{0.2, 0, 1}}},
      {"pipe", Tube{UprightCurve{wave(5, clamped_knots(5, 9), true), Vec3<double>{1, 0, 0}}, 0.05}},
      {"ring", Tube{CircleCurve{1.0}, 0.3}},
      {"ruled",
       RuledSurface{LineSegment<double>{{-1, 0, 0}, {-1, 1, 2}}, wave(3, clamped_knots(3, 6), true)}},
      {"two_curves", RuledSurface{wave(2, clamped_knots(2, 5), false), wave(4, clamped_knots(4, 7), true)}}};
  return list;
}

std::vector<AnySurface> enclosed_surfaces() {
  std::vector<AnySurface> list;
  for (const auto& [name, surface] : made_surfaces()) list.push_back(surface);
  for (const AnySurface& surface : all_surfaces()) {
    bool closed_form = false;
    for (const Kind& kind : kinds) closed_form = closed_form || kind.name == surface.info().name;
    if (!closed_form && TileBounds(surface, {0.1, 0.2, 0.1, 0.2}).known()) list.push_back(surface);
  }
  return list;
}
INSTANTIATE_TEST_SUITE_P(Catalogue, EnclosedTiles, ::testing::ValuesIn(enclosed_surfaces()),
                         [](const auto& info) {
                           if (info.index < made_surfaces().size())
                             return std::string(made_surfaces()[info.index].first);
                           std::string name(info.param.info().name);
                           std::erase(name, '-');
                           return name;
                         });

TEST(EnclosedTiles, AreAllOfTheCatalogue) {
  EXPECT_EQ(enclosed_surfaces().size(), made_surfaces().size() + all_surfaces().size() - std::size(kinds));
}

// No sample is beyond a bound.
TEST_P(EnclosedTiles, HoldEverySample) {
  constexpr int tiles = 1500;
  std::size_t known = 0, finite_angles = 0;
  for (int i = 0; i < tiles; ++i) {
    const AnySurface surface = varied();
    const Tile t = random_tile(1);
    const TileBounds bounds(surface, t);
    if (!bounds.known()) continue;
    ++known;
    const Vec3<double> d = random.direction(), eye = random.log_uniform(0.3, 30) * random.direction();
    const double support = bounds.support(d), facing = bounds.facing(eye), along = bounds.facing_along(d),
                 du = (t.u1 - t.u0) / 2, dv = (t.v1 - t.v0) / 2, chord = bounds.chord(du, dv),
                 normal = bounds.normal_angle(2 * du, 2 * dv), frame = bounds.frame_angle(2 * du, 2 * dv);
    finite_angles += std::isfinite(frame);
    const double u = t.u0 + du, v = t.v0 + dv;
    const Frame<double> centre = surface.frame(u, v);
    // What position and frame, a few roundings of their terms, may exceed a bound by that is met.
    const double slack = 1e-13;
    for (int k = 0; k < 30; ++k) {
      const double x = k < 4 ? k % 2 : random.uniform(), y = k < 4 ? k / 2 : random.uniform();
      const double us = x == 1 ? t.u1 : t.u0 + x * (t.u1 - t.u0),
                   vs = y == 1 ? t.v1 : t.v0 + y * (t.v1 - t.v0);
      const Vec3<double> p = surface.jet(us, vs).position;
      const Frame<double> f = surface.frame(us, vs);
      ASSERT_GE(support, dot(d, p) - slack * norm(p)) << surface.specification();
      if (has(f.status, Status::no_frame) || has(centre.status, Status::no_frame)) continue;
      ASSERT_GE(facing, dot(f.n, eye - p) - slack * (norm(p) + norm(eye))) << surface.specification();
      ASSERT_GE(along, dot(f.n, d) - slack) << surface.specification();
      ASSERT_LE(angle_between(f.n, centre.n), normal + 1e-7) << surface.specification();
      const double off = norm(cross(f.t, centre.t) + cross(f.b, centre.b) + cross(f.n, centre.n)),
                   trace = dot(f.t, centre.t) + dot(f.b, centre.b) + dot(f.n, centre.n);
      ASSERT_LE(std::atan2(off, trace - 1), frame + 1e-7) << surface.specification();
    }
    const auto at = [&](double a, double b) { return surface.jet(t.u0 + a * du, t.v0 + b * dv).position; };
    const Vec3<double> a = at(0, 0), b = at(1, 0), c = at(0, 1);
    for (int j = 0; j <= 4; ++j)
      for (int k = 0; j + k <= 4; ++k) {
        const double x = j / 4.0, y = k / 4.0;
        const Vec3<double> p = at(x, y);
        ASSERT_LE(norm(p - ((1 - x - y) * a + x * b + y * c)), chord + slack * norm(p))
            << surface.specification();
      }
  }
  EXPECT_GT(known, 0.9 * tiles);
  EXPECT_GT(finite_angles, 0.2 * tiles);
}

// Second partials, and interpolation in triangles of cells.
TEST_P(EnclosedTiles, RatesBoundPartialsAndTriangles) {
  std::size_t finite = 0;
  constexpr int tiles = 800;
  for (int i = 0; i < tiles; ++i) {
    const AnySurface surface = varied();
    const Tile t = random_tile(0.2);
    const TileBounds bounds(surface, t, TileOrder::second);
    if (!bounds.known()) continue;
    const TileRates rates = bounds.rates();
    const double du = (t.u1 - t.u0) * random.log_uniform(0.1, 1),
                 dv = (t.v1 - t.v0) * random.log_uniform(0.1, 1);
    const double u = random.uniform(t.u0, t.u1 - du), v = random.uniform(t.v0, t.v1 - dv);
    const double normal = rates.normal_interpolation_angle(du, dv),
                 frame = rates.frame_interpolation_angle(du, dv), chord = rates.chord(du, dv);
    finite += std::isfinite(frame);
    const Jet2<double> j = surface.jet(random.uniform(t.u0, t.u1), random.uniform(t.v0, t.v1));
    // Roundings of their terms.
    const double slack = 1e-13 * (norm(j.position) + norm(j.d2pdu2) + norm(j.d2pduv) + norm(j.d2pdv2));
    ASSERT_LE(norm(j.d2pdu2), rates.position_uu + slack) << surface.specification();
    ASSERT_LE(norm(j.d2pduv), rates.position_uv + slack) << surface.specification();
    ASSERT_LE(norm(j.d2pdv2), rates.position_vv + slack) << surface.specification();
    for (int k = 0; k < 10; ++k) {
      const InterpolationError e = interpolation_error(surface, Triangle::random_in(u, v, du, dv, random));
      ASSERT_LE(e.chord, chord + slack) << surface.specification();
      // Frames by partials that nearly vanish, as tiles with bounds may have, are off by more roundings.
      ASSERT_LE(e.normal, normal + 1e-12) << surface.specification();
      ASSERT_LE(e.frame, frame + 1e-12) << surface.specification();
    }
  }
  EXPECT_GT(finite, 0.4 * tiles);
}

// Of small tiles that are one cell and away from singular points, half have a bound of at most four times
// what the diagonals and edges show.
TEST_P(EnclosedTiles, InterpolationAnglesOfSmallTilesAreNearThoseOfTriangles) {
  std::vector<double> ratios;
  for (int i = 0; i < 200; ++i) {
    const AnySurface surface = varied();
    const double du = random.log_uniform(0.0005, 0.01), dv = random.log_uniform(0.0005, 0.01),
                 u = random.uniform(0.1, 0.88), v = random.uniform(0.1, 0.88);
    const TileBounds bounds(surface, {u, u + du, v, v + dv}, TileOrder::second);
    if (!bounds.known()) continue;
    const double worst = largest_error(surface, u, v, du, dv).frame;
    if (worst > 1e-9) ratios.push_back(bounds.rates().frame_interpolation_angle(du, dv) / worst);
  }
  ASSERT_GT(ratios.size(), 100u);
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 2.5);
}

// Of tiles of a twentieth of the chart and less, nine in ten that samples show to face away are culled; not
// of those that touch a pole, where dpdu × dpdv vanishes and its sign tells nothing.
TEST_P(EnclosedTiles, CullNearlyAllThatFacesAway) {
  int culled = 0, back_facing = 0;
  for (int i = 0; i < 1500; ++i) {
    const AnySurface surface = varied();
    const Tile t = random_tile(0.05);
    const Vec3<double> eye = random.log_uniform(3, 30) * random.direction();
    bool away = true;
    for (int j = 0; j <= 8 && away; ++j)
      for (int k = 0; k <= 8 && away; ++k) {
        const double u = t.u0 + (t.u1 - t.u0) * j / 8, v = t.v0 + (t.v1 - t.v0) * k / 8;
        const Frame<double> f = surface.frame(u, v);
        away = !has(f.status, Status::no_frame | Status::limit_frame) &&
               dot(f.n, eye - surface.jet(u, v).position) < 0;
      }
    if (!away) continue;
    ++back_facing;
    culled += TileBounds(surface, t).facing(eye) < 0;
  }
  // Tiles that hold a knot have bounds of first order.
  EXPECT_GE(culled, (GetParam().breaks(0).empty() ? 0.9 : 0.85) * back_facing);
  EXPECT_GT(back_facing, 400);
}

// Support is attained, and facing has the sign of the farthest sample's, whatever the axes.
TEST(Tiles, OfEllipsoidsHaveClosedForms) {
  Random random(23);
  int culled = 0, back_facing = 0;
  for (int i = 0; i < 5000; ++i) {
    const AnySurface surface =
        Ellipsoid{random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(0.1, 10)};
    const double width = random.log_uniform(0.01, 1), height = random.log_uniform(0.01, 1);
    Tile t{random.uniform(-1, 1), 0, random.uniform(0, 1 - height), 0};
    t.u1 = t.u0 + width, t.v1 = t.v0 + height;
    const TileBounds bounds(surface, t, TileOrder::position);
    ASSERT_TRUE(bounds.attained());
    const Vec3<double> d = random.direction(), eye = random.log_uniform(0.3, 100) * random.direction();
    double farthest = -1e300, most = -1e300, most_along = -1e300;
    constexpr int n = 24;
    for (int k = 0; k <= n; ++k)
      for (int l = 0; l <= n; ++l) {
        const Sample<double> s = surface.sample(t.u0 + width * k / n, t.v0 + height * l / n);
        farthest = std::fmax(farthest, dot(d, s.jet.position));
        most = std::fmax(most, dot(s.frame.n, eye - s.jet.position));
        most_along = std::fmax(most_along, dot(s.frame.n, d));
      }
    ASSERT_GE(bounds.support(d), farthest - 1e-14) << surface.specification();
    // As of the other closed forms: the next sample is below the maximum by at most the chord of a cell.
    ASSERT_LE(bounds.support(d), farthest + bounds.chord(width / n, height / n) + 1e-12);
    ASSERT_GE(bounds.facing(eye), most - 1e-13) << surface.specification();
    ASSERT_GE(bounds.facing_along(d), most_along - 1e-13) << surface.specification();
    // What it changes by when the eye moves.
    const double way = random.log_uniform(1e-3, 1);
    ASSERT_LE(std::fabs(bounds.facing(eye + way * d) - bounds.facing(eye)),
              way * bounds.facing_rate() * (1 + 1e-12) + 1e-12);
    culled += bounds.facing(eye) < 0;
    back_facing += most < 0;
  }
  EXPECT_LE(culled, back_facing);
  EXPECT_GE(culled, 0.98 * back_facing);
  EXPECT_GT(back_facing, 250);
}

// At a crease the frame is that from above, also where a tile ends there; across it nothing is smooth.
TEST(EnclosedTiles, EndAtACreaseWithTheFrameFromAbove) {
  Random random(43);
  const AnySurface patch = sheet(3, {0, 0, 0, 0, 0.3, 0.55, 0.55, 0.55, 1, 1, 1, 1}, true);
  const Tile below{0.5, 0.55, 0.2, 0.4}, above{0.55, 0.6, 0.2, 0.4}, across{0.5, 0.6, 0.2, 0.4};
  const Frame<double> from_above = patch.frame(0.55, 0.3),
                      from_below = patch.frame(std::nextafter(0.55, 0), 0.3);
  ASSERT_GT(angle_between(from_above.n, from_below.n), 0.05) << "a crease";
  for (int i = 0; i < 1000; ++i) {
    const Vec3<double> d = random.direction();
    for (const Tile& tile : {below, above, across}) {
      const double facing = TileBounds(patch, tile).facing_along(d);
      EXPECT_GE(facing, dot(from_above.n, d) - 1e-13);
      EXPECT_GE(facing, tile.u0 < 0.55 ? dot(from_below.n, d) - 1e-13 : facing);
    }
  }
  const auto angle = [&](const Tile& tile) {
    return TileBounds(patch, tile, TileOrder::second).rates().frame_interpolation_angle(1e-3, 1e-3);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(angle(below), infinity);
  EXPECT_EQ(angle(across), infinity);
  EXPECT_LT(angle(above), infinity);
  // At a knot of multiplicity 1 a cubic has two continuous derivatives, a quadratic one: n of that has a
  // bound of its turning, but none of second order.
  const Tile with_knot{0.24, 0.26, 0.2, 0.4};
  const AnySurface cubic = sheet(3, {0, 0, 0, 0, 0.25, 1, 1, 1, 1}, false),
                   quadratic = sheet(2, {0, 0, 0, 0.25, 1, 1, 1}, false);
  const auto rates = [&](const AnySurface& s) { return TileBounds(s, with_knot, TileOrder::second).rates(); };
  EXPECT_LT(rates(cubic).frame_uu, infinity);
  EXPECT_LT(rates(quadratic).frame_u, infinity);
  EXPECT_EQ(rates(quadratic).frame_uu, infinity);
  EXPECT_LT(rates(quadratic).position_uu, infinity);
  // A tube's position takes the curve's first derivative.
  const AnySurface tube =
      Tube{UprightCurve{wave(3, {0, 0, 0, 0, 0.25, 1, 1, 1, 1}, false), Vec3<double>{1, 0, 0}}, 0.05};
  EXPECT_LT(rates(tube).frame_u, infinity);
  EXPECT_EQ(rates(tube).frame_uu, infinity);
}

// Of what is not known nothing is culled.
TEST(Tiles, OtherSurfacesHaveNoBounds) {
  const auto expect_unknown = [](const AnySurface& surface, const Tile& t) {
    const TileBounds bounds(surface, t);
    EXPECT_FALSE(bounds.known()) << surface.specification();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(bounds.support({1, 0, 0}), infinity);
    EXPECT_EQ(bounds.facing({1, 0, 0}), infinity);
    EXPECT_EQ(bounds.facing_along({1, 0, 0}), infinity);
    EXPECT_EQ(bounds.chord(0.1, 0.1), infinity);
    EXPECT_EQ(bounds.normal_angle(0.1, 0.1), infinity);
    EXPECT_EQ(bounds.frame_angle(0.1, 0.1), infinity);
    EXPECT_EQ(bounds.rates().normal_interpolation_angle(0.1, 0.1), infinity);
    EXPECT_EQ(bounds.rates().frame_interpolation_angle(0.1, 0.1), infinity);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  expect_unknown(Offset{Sphere{1.0}, 0.1}, {});
  expect_unknown(Sphere{1.0}, {0, 1, -0.1, 1});
  expect_unknown(Sphere{1.0}, {0, 1, 0.5, 1.1});
  expect_unknown(Sphere{1.0}, {0, 1.2, 0, 1});
  expect_unknown(Sphere{1.0}, {0.5, 0.4, 0, 1});
  expect_unknown(Sphere{1.0}, {nan, 1, 0, 1});
  expect_unknown(Sphere{1e300}, {});
  expect_unknown(Plane{1.0, 1.0}, {-0.5, 0.5, 0, 1});
  const TileBounds sphere(Sphere{1.0}, {});
  // A cell has no direction.
  for (const auto& [du, dv] : {std::pair{-0.1, 0.2}, {0.1, -0.2}, {-0.1, -0.2}}) {
    EXPECT_EQ(sphere.chord(du, dv), sphere.chord(0.1, 0.2));
    EXPECT_EQ(sphere.normal_angle(du, dv), sphere.normal_angle(0.1, 0.2));
    EXPECT_EQ(sphere.frame_angle(du, dv), sphere.frame_angle(0.1, 0.2));
  }
  EXPECT_EQ(sphere.facing({nan, 0, 0}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(sphere.support({nan, 0, 0}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace darboux::test::tile_bounds_test
