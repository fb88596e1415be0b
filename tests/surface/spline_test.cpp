// Splines against another formula: at their knots and edges, as conics, with weights, over other scalars.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/bilinear_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/extrusion.h>
#include <darboux/framed_curve.h>
#include <darboux/graph.h>
#include <darboux/multiprecision.h>
#include <darboux/ruled_surface.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/tube.h>

#include "compare_frames.h"
#include "every_surface.h"
#include "random.h"

namespace darboux::test::spline_test {
namespace {

using Vec = Vec3<double>;

Vec random_vector(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}
std::vector<Vec> random_points(Random& random, int count) {
  std::vector<Vec> points;
  for (int i = 0; i < count; ++i) points.push_back(random_vector(random));
  return points;
}
std::vector<double> random_weights(Random& random, int count) {
  std::vector<double> weights;
  for (int i = 0; i < count; ++i) weights.push_back(random.uniform(0.5, 2));
  return weights;
}

// Clamped knots over [0, 1] with single ones at 0.2 and 0.7 and one of the given multiplicity at 0.5.
constexpr double middle = 0.5;
std::vector<double> knots_with(int degree, int multiplicity) {
  std::vector<double> knots(degree + 1, 0.0);
  knots.push_back(0.2);
  knots.insert(knots.end(), multiplicity, middle);
  knots.push_back(0.7);
  knots.insert(knots.end(), degree + 1, 1.0);
  return knots;
}
int count_of(int degree, const std::vector<double>& knots) {
  return static_cast<int>(knots.size()) - degree - 1;
}

// ---- knot search ------------------------------------------------------------------------------------------

TEST(KnotSearch, FindsTheSpanAtEveryMultiplicity) {
  Random random(1);
  for (const int p : {1, 2, 3, 4, 5, 15})
    for (int m = 1; m <= p + 1; ++m) {
      const std::vector<double> k = knots_with(p, m);
      const KnotVector<double> knots(p, k);
      const int n = count_of(p, k);
      EXPECT_EQ(knots.count(), n);
      std::vector<double> places{-0.5, 0, 1e-300, 1 - roundoff, 1, 1.5};
      for (const double x : {0.2, middle, 0.7})
        for (const double t : {std::nextafter(x, 0.0), x, std::nextafter(x, 1.0)}) places.push_back(t);
      for (int i = 0; i < 100; ++i) places.push_back(random.uniform());
      for (const double t : places) {
        int expected = p;  // one by one
        for (int i = p; i < n; ++i)
          if (k[i] < k[i + 1] && k[i] <= t) expected = i;
        EXPECT_EQ(knots.find(t), expected) << "degree " << p << ", multiplicity " << m << ", t = " << t;
      }
      EXPECT_EQ(knots.breaks(), (std::vector<double>{0.2, middle, 0.7}));
    }
}

TEST(KnotSearch, MapsAnyIntervalToTheDomain) {
  const KnotVector<double> shifted(2, {-4, -3, -2, 0, 2, 3, 4});
  EXPECT_EQ(shifted.knots(), (std::vector<double>{-0.5, -0.25, 0, 0.5, 1, 1.25, 1.5}));
  const KnotVector<double> huge(1, {-1.5e308, -1.5e308, 0, 1.5e308, 1.5e308});
  EXPECT_EQ(huge.knots(), (std::vector<double>{0, 0, 0.5, 1, 1}));
  const KnotVector<double> tiny(1, {0, 0, 5e-320, 1e-319, 1e-319});
  EXPECT_NEAR(tiny.knots()[2], 0.5, 1e-3);
}

TEST(KnotSearch, UnclampedSplineKeepsToItsPolynomial) {
  // Uniform quadratic over one span: the closed form with weights (1 - t)²/2, 1/2 + t (1 - t), t²/2.
  const BSplineCurve<double> curve(2, {-2, -1, 0, 1, 2, 3}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  for (const double t : {0.0, 0.25, 0.7, 1.0, -0.5, 1.5}) {
    const Vec p = curve.jet(t).position;
    EXPECT_NEAR(p.x, (1 - t) * (1 - t) / 2, 4 * roundoff);
    EXPECT_NEAR(p.y, 0.5 + t * (1 - t), 4 * roundoff);
    EXPECT_NEAR(p.z, t * t / 2, 4 * roundoff);
  }
}

// ---- against the Bézier extraction -----------------------------------------------------------------------

struct Homogeneous {
  Vec a;
  double w;
};
Homogeneous blend(double k, const Homogeneous& x, const Homogeneous& y) {
  return {(1 - k) * x.a + k * y.a, (1 - k) * x.w + k * y.w};
}

// One more knot at t, by Boehm's rule. [PieglTiller1997, sec. 5.2]
void insert_knot(int p, std::vector<double>& k, std::vector<Homogeneous>& c, double t) {
  int m = 0;
  while (m + 1 < static_cast<int>(k.size()) && k[m + 1] <= t) ++m;
  std::vector<Homogeneous> result;
  for (int i = 0; i <= static_cast<int>(c.size()); ++i) {
    if (i <= m - p)
      result.push_back(c[i]);
    else if (i > m)
      result.push_back(c[i - 1]);
    else
      result.push_back(blend((t - k[i]) / (k[i + p] - k[i]), c[i - 1], c[i]));
  }
  k.insert(k.begin() + m + 1, t);
  c = result;
}
// Every interior knot brought to the multiplicity p.
void extract(int p, std::vector<double>& k, std::vector<Homogeneous>& c) {
  for (const double t : {0.2, middle, 0.7})
    while (std::count(k.begin(), k.end(), t) < p) insert_knot(p, k, c, t);
}
std::vector<Homogeneous> with_weights(const std::vector<Vec>& points, const std::vector<double>& weights) {
  std::vector<Homogeneous> result;
  for (std::size_t i = 0; i < points.size(); ++i) result.push_back({weights[i] * points[i], weights[i]});
  return result;
}

void expect_near(const Vec& a, const Vec& b, double tolerance, const char* what) {
  EXPECT_LE(norm(a - b), tolerance) << what;
}

TEST(BSpline, CurveEqualsItsBezierPieces) {
  Random random(2);
  for (int p = 1; p <= 5; ++p)
    for (int m = 1; m <= p + 1; ++m) {
      SCOPED_TRACE(::testing::Message() << "degree " << p << ", multiplicity " << m);
      std::vector<double> k = knots_with(p, m);
      const int n = count_of(p, k);
      const auto points = random_points(random, n);
      const auto weights = random_weights(random, n);
      const BSplineCurve<double> curve(p, k, points, weights);
      auto c = with_weights(points, weights);
      extract(p, k, c);
      for (int i = p; i < static_cast<int>(c.size()); ++i) {
        const double begin = k[i], length = k[i + 1] - begin;
        if (!(length > 0)) continue;
        std::vector<Vec> piece_points;
        std::vector<double> piece_weights;
        for (int j = i - p; j <= i; ++j) {
          piece_points.push_back(c[j].a / c[j].w);
          piece_weights.push_back(c[j].w);
        }
        const BSplineCurve<double> piece(p, clamped_knots(p, p + 1), piece_points, piece_weights);
        for (int r = 0; r <= 20; ++r) {
          const double t = begin + length * (r < 20 ? r / 20.0 : 0.999999);
          const CurveJet<double> a = curve.jet(t), b = piece.jet((t - begin) / length);
          expect_near(a.position, b.position, 1e-13, "position");
          expect_near(length * a.first, b.first, 1e-12, "first");
          expect_near(length * length * a.second, b.second, 1e-11, "second");
          expect_near(length * length * length * a.third, b.third, 1e-10, "third");
          expect_near(a.position, curve.second_formula(t), 1e-13, "second_formula");
        }
      }
    }
}

// Degree p with multiplicity m along u, degree 2 with one knot along v; and the same with u and v exchanged.
TEST(BSpline, PatchEqualsItsBezierPieces) {
  Random random(3);
  for (int p = 1; p <= 4; ++p)
    for (int m = 1; m <= p + 1; ++m) {
      SCOPED_TRACE(::testing::Message() << "degree " << p << ", multiplicity " << m);
      const int q = 2, columns = q + 1;
      const std::vector<double> k = knots_with(p, m), flat{0, 0, 0, 1, 1, 1};
      const int n = count_of(p, k);
      const auto points = random_points(random, n * columns);
      const auto weights = random_weights(random, n * columns);
      const BSplinePatch<double> patch(p, q, k, flat, points, weights);
      std::vector<Vec> turned_points;
      std::vector<double> turned_weights;
      std::vector<std::vector<Homogeneous>> column(columns);
      std::vector<double> fine;
      for (int j = 0; j < columns; ++j) {
        for (int i = 0; i < n; ++i) {
          turned_points.push_back(points[i * columns + j]);
          turned_weights.push_back(weights[i * columns + j]);
          column[j].push_back({weights[i * columns + j] * points[i * columns + j], weights[i * columns + j]});
        }
        fine = k;
        extract(p, fine, column[j]);
      }
      const BSplinePatch<double> turned(q, p, flat, k, turned_points, turned_weights);
      for (int s = p; s < static_cast<int>(column[0].size()); ++s) {
        const double begin = fine[s], length = fine[s + 1] - begin;
        if (!(length > 0)) continue;
        std::vector<Vec> piece_points;
        std::vector<double> piece_weights;
        for (int i = s - p; i <= s; ++i)
          for (int j = 0; j < columns; ++j) {
            piece_points.push_back(column[j][i].a / column[j][i].w);
            piece_weights.push_back(column[j][i].w);
          }
        const BezierPatch<double> piece(p, q, piece_points, piece_weights);
        for (int r = 0; r <= 10; ++r) {
          const double u = begin + length * (r < 10 ? r / 10.0 : 0.999999), v = r == 0 ? 0 : random.uniform();
          const Jet2<double> a = jet(patch, u, v), b = jet(piece, (u - begin) / length, v);
          expect_near(a.position, b.position, 1e-13, "position");
          expect_near(length * a.dpdu, b.dpdu, 1e-12, "dpdu");
          expect_near(a.dpdv, b.dpdv, 1e-12, "dpdv");
          expect_near(length * length * a.d2pdu2, b.d2pdu2, 1e-11, "d2pdu2");
          expect_near(length * a.d2pduv, b.d2pduv, 1e-11, "d2pduv");
          expect_near(a.d2pdv2, b.d2pdv2, 1e-11, "d2pdv2");
          expect_near(a.position, patch.second_formula(u, v), 1e-13, "second_formula");
          expect_near(b.position, piece.second_formula((u - begin) / length, v), 1e-13,
                      "second_formula of Bézier");
          const Jet2<double> c = jet(turned, v, u);
          expect_near(c.position, a.position, 1e-14, "turned position");
          expect_near(length * c.dpdv, length * a.dpdu, 1e-13, "turned dpdv");
          expect_near(c.dpdu, a.dpdv, 1e-13, "turned dpdu");
          expect_near(length * c.d2pduv, length * a.d2pduv, 1e-12, "turned d2pduv");
          expect_near(length * length * c.d2pdv2, length * length * a.d2pdu2, 1e-12, "turned d2pdv2");
        }
      }
    }
}

// ---- both sides of a knot ---------------------------------------------------------------------------------

// The derivatives to order p - m agree from both sides of a knot of multiplicity m, the next one jumps.
TEST(BSpline, IsAsSmoothAtAKnotAsItsMultiplicitySays) {
  Random random(4);
  for (int p = 1; p <= 5; ++p)
    for (int m = 1; m <= p + 1; ++m) {
      SCOPED_TRACE(::testing::Message() << "degree " << p << ", multiplicity " << m);
      const std::vector<double> k = knots_with(p, m);
      const int n = count_of(p, k);
      const BSplineCurve<double> curve(p, k, random_points(random, n), random_weights(random, n));
      const CurveJet<double> below = curve.jet(std::nextafter(middle, 0.0)), at = curve.jet(middle),
                             above = curve.jet(std::nextafter(middle, 1.0));
      const auto order = [](const CurveJet<double>& j) {
        return std::array{j.position, j.first, j.second, j.third};
      };
      for (int d = 0; d <= 3; ++d) {
        const Vec a = order(below)[d], b = order(at)[d], c = order(above)[d];
        const double scale = std::max(1.0, norm(b));
        EXPECT_LE(norm(b - c), 1e-10 * scale) << "derivative " << d;
        if (d <= p - m) {
          EXPECT_LE(norm(a - b), 1e-10 * scale) << "derivative " << d;
        } else if (d == p - m + 1) {
          EXPECT_GT(norm(a - b), 1e-3) << "derivative " << d;
        }
      }
      // The frame may jump for m >= p.
      for (const double t :
           {0.0, 0.2, 0.3, std::nextafter(middle, 0.0), middle, std::nextafter(middle, 1.0), 0.7, 1.0}) {
        const bool sharp = (t == middle && m >= p) || (p == 1 && (t == 0.2 || t == 0.7));
        EXPECT_EQ(curve.singular(t), sharp ? Status::crease : Status::regular) << t;
      }
    }
}

TEST(BSpline, CreaseHasTheFrameFromAbove) {
  Random random(5);
  for (int p = 1; p <= 4; ++p)
    for (int m = 1; m <= p + 1; ++m)
      for (int along = 0; along < 2; ++along) {
        SCOPED_TRACE(::testing::Message() << "degree " << p << ", multiplicity " << m << ", along " << along);
        const std::vector<double> k = knots_with(p, m), flat{0, 0, 0, 1, 1, 1};
        const int n = count_of(p, k);
        const auto points = random_points(random, 3 * n);
        const auto weights = random_weights(random, 3 * n);
        const BSplinePatch<double> patch = along == 0 ? BSplinePatch<double>(p, 2, k, flat, points, weights)
                                                      : BSplinePatch<double>(2, p, flat, k, points, weights);
        const auto at = [&](double t) { return along == 0 ? std::pair{t, 0.3} : std::pair{0.3, t}; };
        const auto frame_at = [&](double t) { return frame(patch, at(t).first, at(t).second); };
        const Frame<double> f = frame_at(middle), above = frame_at(std::nextafter(middle, 1.0)),
                            below = frame_at(std::nextafter(middle, 0.0));
        const Status expected = m >= p ? Status::crease : Status::regular;
        EXPECT_EQ(f.status, expected);
        EXPECT_EQ(status(patch, at(middle).first, at(middle).second), expected);
        EXPECT_EQ(sample(patch, at(middle).first, at(middle).second).frame.status, expected);
        EXPECT_EQ(parametric_frame(patch, at(middle).first, at(middle).second).status, expected);
        EXPECT_EQ(above.status, Status::regular);
        EXPECT_EQ(below.status, Status::regular);
        EXPECT_EQ(patch.breaks(along), (std::vector<double>{0.2, middle, 0.7}));
        EXPECT_TRUE(patch.breaks(1 - along).empty());
        EXPECT_LE(distance(f, above), 1e-10);
        if (m >= p)
          EXPECT_GT(distance(f, below), 1e-3);
        else
          EXPECT_LE(distance(f, below), 1e-10);
      }
}

TEST(BSpline, GoesThroughTheControlPointAtAKnotOfFullMultiplicity) {
  Random random(6);
  for (int p = 1; p <= 5; ++p) {
    const std::vector<double> k = knots_with(p, p);
    const int n = count_of(p, k);
    const auto points = random_points(random, n);
    const BSplineCurve<double> curve(p, k, points, random_weights(random, n));
    EXPECT_EQ(curve.jet(0.0).position, points.front());
    EXPECT_EQ(curve.jet(1.0).position, points.back());
    EXPECT_LE(norm(curve.jet(middle).position - points[p + 1]), 2 * roundoff);
  }
}

// ---- conics -----------------------------------------------------------------------------------------------

// x² + y² - r² over r², in more digits than double's.
double off_circle(const Vec& p, double r) {
  const long double x = p.x, y = p.y, s = r;
  return static_cast<double>((x * x + y * y - s * s) / (s * s));
}

BSplineCurve<double> whole_circle(double r) {
  const double h = std::sqrt(0.5);
  return {2,
          {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4},
          {{r, 0, 0},
           {r, r, 0},
           {0, r, 0},
           {-r, r, 0},
           {-r, 0, 0},
           {-r, -r, 0},
           {0, -r, 0},
           {r, -r, 0},
           {r, 0, 0}},
          {1, h, 1, h, 1, h, 1, h, 1}};
}

TEST(RationalCircle, IsOneToTheLastBits) {
  const BSplineCurve<double> quarter(2, {0, 0, 0, 1, 1, 1}, {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {1, 1, 2});
  for (int i = 0; i <= 1000; ++i) {
    const double t = i / 1000.0;
    const CurveJet<double> j = quarter.jet(t);
    EXPECT_LE(std::fabs(off_circle(j.position, 1)), 8 * roundoff) << t;
    EXPECT_LE(std::fabs(dot(unit(j.first), j.position)), 8 * roundoff) << t;
    // ((1 - t²)/(1 + t²), 2t/(1 + t²))
    EXPECT_LE(norm(j.position - Vec{(1 - t * t) / (1 + t * t), 2 * t / (1 + t * t), 0}), 4 * roundoff) << t;
  }
  for (const double r : {1.0, 3.7, 1e-100, 1e100}) {
    const BSplineCurve<double> circle = whole_circle(r);
    for (int i = 0; i <= 1000; ++i) {
      const double t = i / 1000.0;
      const CurveJet<double> j = circle.jet(t);
      EXPECT_LE(std::fabs(off_circle(j.position / r, 1)), 16 * roundoff) << t;
      // Curvature 1/r, turning left.
      const Vec turn = cross(j.first / norm(j.first), j.second / norm(j.first) / norm(j.first));
      EXPECT_NEAR(turn.z * r, 1, 1e-13) << t;
    }
  }
}

TEST(RationalCircle, RevolvedMakesASphere) {
  const double h = std::sqrt(0.5), r = 2;
  const SurfaceOfRevolution ball{
      BSplineCurve<double>(2, {0, 0, 0, 1, 1, 2, 2, 2},
                           {{0, 0, -r}, {r, 0, -r}, {r, 0, 0}, {r, 0, r}, {0, 0, r}}, {1, h, 1, h, 1})};
  for (int i = 0; i <= 16; ++i)
    for (int k = 0; k <= 64; ++k) {
      const double u = i / 16.0, v = k / 64.0;
      const Vec p = jet(ball, u, v).position;
      const Frame<double> f = frame(ball, u, v);
      EXPECT_NEAR(norm(p), r, 16 * roundoff);
      EXPECT_LE(norm(f.n - p / r), 32 * roundoff) << u << " " << v;
      if (k == 0 || k == 64) {
        EXPECT_EQ(f.status, Status::dpdu_zero | Status::limit_frame);
        continue;
      }
      const auto pu = prepare<Coordinate::turn>(u);
      EXPECT_NEAR(ball.gaussian_curvature(pu, v), 1 / (r * r), 1e-13);
      EXPECT_NEAR(ball.mean_curvature(pu, v), -1 / r, 1e-13);
    }
}

// ---- collapsed edges --------------------------------------------------------------------------------------

// A random net whose edge v = 0 is one point and whose rows fan out of it.
struct Net {
  int p, q;
  std::vector<Vec> points;
  std::vector<double> weights;
};
Net random_fan(Random& random, int p, int q) {
  Net net{p, q, {}, {}};
  const Vec apex = 10.0 * random_vector(random);
  for (int i = 0; i <= p; ++i)
    for (int j = 0; j <= q; ++j) {
      const double angle = 2.0 * i / p + random.uniform(-0.1, 0.1),
                   r = j == 0 ? 0 : j + random.uniform(-0.2, 0.2);
      net.points.push_back(apex +
                           Vec{r * std::cos(angle), r * std::sin(angle), r * random.uniform(-0.3, 0.3)});
      net.weights.push_back(random.uniform(0.5, 2));
    }
  return net;
}
// Backwards along v.
Net reversed(const Net& net) {
  Net result = net;
  for (int i = 0; i <= net.p; ++i)
    for (int j = 0; j <= net.q; ++j) {
      result.points[i * (net.q + 1) + j] = net.points[i * (net.q + 1) + net.q - j];
      result.weights[i * (net.q + 1) + j] = net.weights[i * (net.q + 1) + net.q - j];
    }
  return result;
}
// u and v exchanged.
Net turned(const Net& net) {
  Net result{net.q, net.p, net.points, net.weights};
  for (int i = 0; i <= net.p; ++i)
    for (int j = 0; j <= net.q; ++j) {
      result.points[j * (net.p + 1) + i] = net.points[i * (net.q + 1) + j];
      result.weights[j * (net.p + 1) + i] = net.weights[i * (net.q + 1) + j];
    }
  return result;
}
template <class X>
void expect_collapsed(const X& patch, bool along_v, double edge, double inward) {
  for (const double s : {0.0, 0.1, 0.37, 0.5, 0.9, 1.0}) {
    SCOPED_TRACE(::testing::Message()
                 << X::info.name << (along_v ? ", v = " : ", u = ") << edge << " at " << s);
    const auto at = [&](double x) { return along_v ? std::pair{s, x} : std::pair{x, s}; };
    const auto [u, v] = at(edge);
    const auto [u1, v1] = at(edge + inward * 1e-9);
    const Status expected = (along_v ? Status::dpdu_zero : Status::dpdv_zero) | Status::limit_frame;
    const Jet2<double> j = jet(patch, u, v);
    EXPECT_EQ(along_v ? j.dpdu : j.dpdv, (Vec{}));
    const Frame<double> f = frame(patch, u, v), near = frame(patch, u1, v1);
    EXPECT_EQ(f.status, expected);
    EXPECT_EQ(status(patch, u, v), along_v ? Status::dpdu_zero : Status::dpdv_zero);
    EXPECT_EQ(sample(patch, u, v).frame.status, expected);
    EXPECT_EQ(parametric_frame(patch, u, v).status, expected);
    EXPECT_EQ(near.status, Status::regular);
    EXPECT_LE(distance(f, near), 1e-7);
    EXPECT_EQ(f.handedness, 1);
    const ParametricFrame<double> a = parametric_frame(patch, u, v), b = parametric_frame(patch, u1, v1);
    EXPECT_LE(norm(a.t - b.t), 1e-7);
    EXPECT_LE(norm(a.b - b.b), 1e-7);
  }
}

TEST(CollapsedEdge, HasTheLimitFrameOnAllFourSides) {
  Random random(7);
  for (int i = 0; i < 50; ++i)
    for (const auto& [p, q] : {std::pair{1, 1}, {2, 1}, {1, 2}, {2, 2}, {3, 2}, {3, 3}, {5, 4}}) {
      const Net south = random_fan(random, p, q), north = reversed(south), west = turned(south),
                east = turned(north);
      const auto bezier = [](const Net& n) { return BezierPatch<double>(n.p, n.q, n.points, n.weights); };
      expect_collapsed(bezier(south), true, 0, +1);
      expect_collapsed(bezier(north), true, 1, -1);
      expect_collapsed(bezier(west), false, 0, +1);
      expect_collapsed(bezier(east), false, 1, -1);
      const auto linear = [](const Net& n) {
        return BSplinePatch<double>(1, 1, clamped_knots(1, n.p + 1), clamped_knots(1, n.q + 1), n.points,
                                    n.weights);
      };
      if (p == 1 && q == 1) expect_collapsed(linear(south), true, 0, +1);
      if (p < 2 || q < 2) continue;
      const auto spline = [](const Net& n) {
        return BSplinePatch<double>(2, 2, clamped_knots(2, n.p + 1), clamped_knots(2, n.q + 1), n.points,
                                    n.weights);
      };
      expect_collapsed(spline(south), true, 0, +1);
      expect_collapsed(spline(north), true, 1, -1);
      expect_collapsed(spline(west), false, 0, +1);
      expect_collapsed(spline(east), false, 1, -1);
    }
}

TEST(CollapsedEdge, OfABilinearPatch) {
  const Vec a{0, 0, 0}, b{1, 0, 0.5}, c{0, 1, 0};
  expect_collapsed(BilinearPatch{a, a, c, b}, true, 0, +1);
  expect_collapsed(BilinearPatch{a, b, c, c}, true, 1, -1);
  expect_collapsed(BilinearPatch{a, b, a, c}, false, 0, +1);
  expect_collapsed(BilinearPatch{a, c, b, c}, false, 1, -1);
}

// Two neighbouring edges of one point: beside their corner limits, at it none.
TEST(CollapsedEdge, TriangularCornerHasNoFrame) {
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    Net net = random_fan(random, 2, 2);
    net.points[1] = net.points[2] = net.points[0];
    const BezierPatch<double> patch(2, 2, net.points, net.weights);
    const Frame<double> f = frame(patch, 0.0, 0.0);
    EXPECT_EQ(f.status, Status::dpdu_zero | Status::dpdv_zero | Status::no_frame);
    EXPECT_TRUE(all_nan(f));
    EXPECT_EQ(sample(patch, 0.0, 0.0).frame.status, f.status);
    EXPECT_EQ(status(patch, 0.0, 0.0), Status::dpdu_zero | Status::dpdv_zero);
    EXPECT_EQ(frame(patch, 0.5, 0.0).status, Status::dpdu_zero | Status::limit_frame);
    EXPECT_EQ(frame(patch, 0.0, 0.5).status, Status::dpdv_zero | Status::limit_frame);
    EXPECT_TRUE(finite(frame(patch, 1e-9, 1e-9).n));
  }
}

// ---- other scalars ----------------------------------------------------------------------------------------

template <class X>
void expect_rebound(const X& surface) {
  const auto single = rebind<float>(surface);
  const auto many = rebind<Multiprecision>(surface);
  for (const double u : {0.0, 0.125, 0.5, 0.625, 1.0})
    for (const double v : {0.0, 0.25, 0.5, 0.875, 1.0}) {
      SCOPED_TRACE(::testing::Message() << X::info.name << " at " << u << ", " << v);
      const Jet2<double> j = jet(surface, u, v);
      const Jet2<float> f = jet(single, static_cast<float>(u), static_cast<float>(v));
      const Jet2<Multiprecision> m = jet(many, Multiprecision(u), Multiprecision(v));
      const auto near = [](const Vec& a, const auto& b, double tolerance) {
        const Vec c{static_cast<double>(b.x), static_cast<double>(b.y), static_cast<double>(b.z)};
        EXPECT_LE(norm(a - c), tolerance * (1 + norm(a)));
      };
      near(j.position, f.position, 1e-5);
      near(j.dpdu, f.dpdu, 1e-4);
      near(j.dpdv, f.dpdv, 1e-4);
      near(j.position, m.position, 1e-14);
      near(j.dpdu, m.dpdu, 1e-13);
      near(j.dpdv, m.dpdv, 1e-13);
      near(j.d2pdu2, m.d2pdu2, 1e-12);
      near(j.d2pduv, m.d2pduv, 1e-12);
      near(j.d2pdv2, m.d2pdv2, 1e-12);
      if constexpr (StatesSecondFormula<X>) {  // to more digits than double has
        const auto again =
            many.second_formula(prepare<X::info.u>(Multiprecision(u)), prepare<X::info.v>(Multiprecision(v)));
        for (const Multiprecision& d :
             {again.x - m.position.x, again.y - m.position.y, again.z - m.position.z})
          EXPECT_LE(std::fabs(static_cast<double>(d)), 1e-34);
      }
    }
}

TEST(Rebind, ToFloatAndToMultiprecision) {
  Random random(9);
  const std::vector<double> k = knots_with(3, 3), flat{0, 0, 0, 1, 1, 1};
  const int n = count_of(3, k);
  expect_rebound(
      BSplinePatch<double>(3, 2, k, flat, random_points(random, 3 * n), random_weights(random, 3 * n)));
  expect_rebound(BezierPatch<double>(3, 2, random_points(random, 12), random_weights(random, 12)));
  expect_rebound(BezierPatch<double>(3, 2, random_points(random, 12)));
  expect_rebound(SurfaceOfRevolution<>{});
  expect_rebound(Extrusion{whole_circle(1.5), Vec{0.25, 0, 1}});
  expect_rebound(Tube{PlanarCurve<>{}, 0.1});
  expect_rebound(Tube{CircleCurve{2.0}, 0.1});
  expect_rebound(Tube{UprightCurve{HelixCurve{1.0, 0.25, 1.0}}, 0.1});
  expect_rebound(RuledSurface<>{});
  expect_rebound(BilinearPatch<double>{});
  expect_rebound(Graph<>{});
}

TEST(Rebind, KeepsKnotsPointsAndWeights) {
  const BSplineCurve<double> curve = whole_circle(2);
  const BSplineCurve<float> single = curve.rebind<float>();
  EXPECT_EQ(single.knots().degree(), 2);
  EXPECT_EQ(single.knots().knots().size(), 12u);
  EXPECT_EQ(single.knots().knots()[3], 0.25f);
  EXPECT_EQ(single.control_points()[1].x, 2.0f);
  EXPECT_EQ(single.weights().size(), 9u);
  EXPECT_TRUE(single.refusal().empty());
  EXPECT_EQ(single.singular(0.25f), Status::crease);
}

// Weights count up to a common factor, and none are the same as equal ones.
TEST(Weights, CountUpToACommonFactor) {
  Random random(10);
  const auto points = random_points(random, 12);
  const auto weights = random_weights(random, 12);
  const BezierPatch<double> patch(3, 2, points, weights), plain(3, 2, points);
  for (const double factor : {0x1p-900, 0.25, 0x1p800}) {
    std::vector<double> scaled;
    for (const double w : weights) scaled.push_back(factor * w);
    const BezierPatch<double> other(3, 2, points, scaled);
    EXPECT_EQ(jet(other, 0.3, 0.7).position, jet(patch, 0.3, 0.7).position) << factor;
    EXPECT_EQ(jet(other, 0.3, 0.7).d2pduv, jet(patch, 0.3, 0.7).d2pduv) << factor;
  }
  const BezierPatch<double> equal(3, 2, points, std::vector<double>(12, 3.0));
  EXPECT_TRUE(equal.weights().empty());
  EXPECT_EQ(jet(equal, 0.3, 0.7).dpdu, jet(plain, 0.3, 0.7).dpdu);
  EXPECT_GT(norm(jet(patch, 0.3, 0.7).position - jet(plain, 0.3, 0.7).position), 1e-3);
}

// Half the length of this domain is 0, by which its knots were divided: they were NaN, and a search for one
// ran out of them.
TEST(KnotVector, AnIntervalBelowTheNumbersIsRefused) {
  constexpr double least = std::numeric_limits<double>::denorm_min();
  EXPECT_NE(KnotVector<double>::refusal(1, {0, 0, least, least}), "");
  EXPECT_EQ(KnotVector<double>::refusal(1, {0, 0, 4 * least, 4 * least}), "");
  EXPECT_THROW(clamped_knots(3, 3), ParameterError);
  EXPECT_THROW(clamped_knots(-1, 3), ParameterError);
}

}  // namespace
}  // namespace darboux::test::spline_test
