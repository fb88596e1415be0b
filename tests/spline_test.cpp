// Curves and the surfaces made of them: splines at their knots and edges against another formula, tubes about every kind
// of curve, user functions, and every refusal.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/bilinear_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/curve.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/extrusion.h>
#include <darboux/graph.h>
#include <darboux/many_digits.h>
#include <darboux/ruled_surface.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/torus.h>
#include <darboux/tube.h>

#include "compare_frames.h"
#include "every_surface.h"

namespace darboux::test {
namespace {

using Vec = Vec3<double>;

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

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

// ---- knot search ------------------------------------------------------------------------------------------------

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

// ---- against the Bézier extraction --------------------------------------------------------------------------------

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
          expect_near(a.position, curve.position_again(t), 1e-13, "position_again");
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
          expect_near(a.position, patch.position_again(u, v), 1e-13, "position_again");
          expect_near(b.position, piece.position_again((u - begin) / length, v), 1e-13,
                      "position_again of Bézier");
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

// ---- both sides of a knot ---------------------------------------------------------------------------------------

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

// ---- conics -----------------------------------------------------------------------------------------------------

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

// ---- collapsed edges ---------------------------------------------------------------------------------------------

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

// ---- tubes ------------------------------------------------------------------------------------------------------

template <class Curve>
void expect_tube(const Curve& curve, double radius, double turning_error = 0) {
  const Tube<Curve> tube{curve, radius};
  checked(tube);
  const double scale = 1 + radius;
  for (int i = 0; i <= 12; ++i)
    for (int k = 0; k <= 12; ++k) {
      const double u = i / 12.0, v = k / 12.0;
      const auto t = prepare<Curve::kind>(u);
      const CurveJet<double> centre = curve.jet(t);
      const Jet2<double> j = jet(tube, u, v);
      const Frame<double> f = frame(tube, u, v);
      const Vec out = j.position - centre.position;
      EXPECT_NEAR(norm(out), radius, 16 * roundoff * (scale + norm(centre.position)));
      EXPECT_LE(norm(f.n - out / radius), 32 * roundoff * (scale + norm(centre.position)) / radius)
          << u << " " << v;
      EXPECT_NEAR(dot(f.n, unit(centre.first)), 0, 16 * roundoff);
      EXPECT_EQ(f.status, Status::regular) << u << " " << v;
      EXPECT_EQ(f.handedness, 1);
      EXPECT_LE(norm(f.t - unit(j.dpdu)), 1e-13) << u << " " << v;
      EXPECT_LE(norm(f.n - unit(cross(j.dpdu, j.dpdv))), 1e-13) << u << " " << v;
      // The partials against differences of the position.
      const double h = 1e-5;
      if (i == 0 || i == 12) continue;
      const Vec du = (jet(tube, u + h, v).position - jet(tube, u - h, v).position) / (2 * h);
      const Vec dv = (jet(tube, u, v + h).position - jet(tube, u, v - h).position) / (2 * h);
      EXPECT_LE(norm(du - j.dpdu), 1e-6 * (1 + norm(j.dpdu)) + radius * turning_error / h) << u << " " << v;
      EXPECT_LE(norm(dv - j.dpdv), 1e-6 * (1 + norm(j.dpdv))) << u << " " << v;
    }
}

BSplineCurve<double> space_curve() {
  return {3, clamped_knots(3, 4), {{0, 0, 0}, {1, 1, 0.3}, {2, -1, 0.6}, {3, 0, 1}}, {1, 2, 0.7, 1}};
}

TEST(Tubes, KeepTheirDistanceFromEveryKindOfCurve) {
  expect_tube(LineSegment<double>{{1, 2, 3}, {-1, 0.5, 4}}, 0.3);
  expect_tube(CircleCurve{2.0}, 0.5);
  expect_tube(HelixCurve{1.0, 0.25, 2.0}, 0.1);
  expect_tube(HelixCurve{1.0, -0.25, 1.0}, 0.1);
  expect_tube(PlanarCurve<>{}, 0.02);
  expect_tube(
      PlanarCurve{BSplineCurve<double>(2, {0, 0, 0, 1, 1, 1}, {{1, 0, 2}, {1, 1, 2}, {0, 1, 2}}, {1, 1, 2})},
      0.4);
  expect_tube(UprightCurve{HelixCurve{1.0, 0.25, 1.0}}, 0.1);
  expect_tube(UprightCurve{space_curve()}, 0.05);
  const RotationMinimisingCurve helix{HelixCurve{1.0, 0.25, 1.0}};
  const RotationMinimisingCurve spline{space_curve()};
  EXPECT_LT(helix.turning_error(), 1e-12);
  EXPECT_LT(spline.turning_error(), 1e-7);
  expect_tube(helix, 0.1, helix.turning_error());
  expect_tube(spline, 0.05, spline.turning_error());
}

TEST(Tubes, OfACircleIsATorus) {
  const Torus torus{2.0, 0.5};
  const Tube tube{CircleCurve{2.0}, 0.5};
  for (int i = 0; i <= 16; ++i)
    for (int k = 0; k <= 16; ++k) {
      const double u = i / 16.0, v = k / 16.0;
      EXPECT_NEAR(torus.implicit(jet(tube, u, v).position), 0, 8 * roundoff);
      // N is inward: the tube's v begins at the inner equator, and runs downwards there.
      EXPECT_LE(norm(frame(tube, u, v).n - frame(torus, u, v + 0.5).n), 8 * roundoff) << u << " " << v;
      EXPECT_LE(norm(frame(tube, u, v).t - frame(torus, u, v + 0.5).t), 8 * roundoff) << u << " " << v;
    }
}

// The frame of a rotation-minimising curve turns about T not at all: N' has no part along B.
TEST(Tubes, RotationMinimisingFrameDoesNotTwist) {
  const RotationMinimisingCurve curve{HelixCurve{1.0, 0.4, 1.0}};
  const UprightCurve twisting{HelixCurve{1.0, 0.4, 1.0}};
  const double h = 1e-4;
  for (int i = 1; i < 16; ++i) {
    const double t = i / 16.0;
    const auto rate = [&](const auto& c) {
      const CurveFrame<double> f = c.moving_frame(t);
      return dot((c.moving_frame(t + h).N - c.moving_frame(t - h).N) / (2 * h), f.B);
    };
    EXPECT_NEAR(rate(curve), 0, 1e-6) << t;
    EXPECT_NEAR(rate(twisting), twisting.moving_frame(t).twist, 1e-6) << t;
    EXPECT_GT(std::fabs(rate(twisting)), 0.1) << t;
  }
  EXPECT_LE(norm(curve.moving_frame(0.0).N - twisting.moving_frame(0.0).N), 4 * roundoff);
  // Bishop's angle on a helix: φ' = -torsion against Frenet's frame, torsion times length 2π p/sqrt(R² + p²).
  const CurveFrame<double> end = curve.moving_frame(1.0),
                           frenet = HelixCurve{1.0, 0.4, 1.0}.moving_frame(1.0);
  const CurveFrame<double> begin = curve.moving_frame(0.0),
                           first = HelixCurve{1.0, 0.4, 1.0}.moving_frame(0.0);
  const double before = std::atan2(dot(begin.N, first.B), dot(begin.N, first.N));
  const double after = std::atan2(dot(end.N, frenet.B), dot(end.N, frenet.N));
  const double torsion_angle = 2 * std::numbers::pi * 0.4 / std::sqrt(1 + 0.4 * 0.4);
  EXPECT_NEAR(std::remainder(after - before + torsion_angle, 2 * std::numbers::pi), 0, 1e-12);
}

TEST(Tubes, SayWhereTheRadiusReachesTheCurvatureRadius) {
  const Tube touching{CircleCurve{1.0}, 1.0};
  EXPECT_EQ(frame(touching, 0.3, 0.0).status, Status::dpdu_zero | Status::limit_frame);
  EXPECT_EQ(frame(touching, 0.3, 0.25).status, Status::regular);
  const Tube through{CircleCurve{1.0}, 1.5};
  EXPECT_EQ(frame(through, 0.3, 0.0).status, Status::self_intersecting);
  EXPECT_EQ(frame(through, 0.3, 0.0).handedness, -1);
  EXPECT_EQ(frame(through, 0.3, 0.5).status, Status::regular);
  EXPECT_EQ(frame(through, 0.3, 0.5).handedness, 1);
  const Vec out = jet(through, 0.3, 0.0).position - CircleCurve{1.0}.jet(sincos_turns(0.3)).position;
  EXPECT_LE(norm(frame(through, 0.3, 0.0).n - out / 1.5), 8 * roundoff);
  // Curvature radius (R² + p²)/R = 2
  EXPECT_EQ(frame(Tube{HelixCurve{1.0, 1.0, 1.0}, 2.0}, 0.3, 0.0).status,
            Status::parallel | Status::limit_frame);
  EXPECT_EQ(frame(Tube{HelixCurve{1.0, 1.0, 1.0}, 1.99}, 0.3, 0.0).status, Status::regular);
  EXPECT_EQ(frame(Tube{HelixCurve{1.0, 1.0, 1.0}, 2.01}, 0.3, 0.0).status, Status::self_intersecting);
}

TEST(Tubes, HaveNoFrameWhereTheCurveStops) {
  const auto stopping = []<class S>(const S& t) {  // at t = 1/2
    const S x = t - lift<S>(0.5);
    return Vec3<S>{x * x, x * x * x, lift<S>(0.0)};
  };
  const Tube tube{PlanarCurve{PositionCurve{stopping}}, 0.1};
  const Frame<double> f = frame(tube, 0.5, 0.2);
  EXPECT_EQ(f.status, Status::dpdu_zero | Status::no_frame);
  EXPECT_TRUE(all_nan(f));
  EXPECT_TRUE(finite(frame(tube, 0.25, 0.2).n));
}

TEST(Tubes, HaveNoFrameWhereTheCurveRunsAlongUp) {
  const auto arc = []<class S>(const S& t) {  // begins along z
    return Vec3<S>{t * t, lift<S>(0.0), t};
  };
  const Tube tube{UprightCurve{PositionCurve{arc}}, 0.1};
  const Frame<double> f = frame(tube, 0.0, 0.2);
  EXPECT_TRUE(has(f.status, Status::no_frame));
  EXPECT_TRUE(all_nan(f));
  EXPECT_EQ(frame(tube, 0.25, 0.2).status, Status::regular);
}

// ---- user functions -----------------------------------------------------------------------------------------------

constexpr auto helix_position = []<class S>(const S& t) {
  const Turn<S> a = sincos_turns(S(lift<S>(2.0) * t));
  return Vec3<S>{lift<S>(1.5) * a.cos, lift<S>(1.5) * a.sin,
                 lift<S>(0.25) * (two_pi<S>() * (lift<S>(2.0) * t))};
};
constexpr auto circle_position = []<class S>(const Turn<S>& t) {
  return Vec3<S>{lift<S>(3.0) * t.cos, lift<S>(3.0) * t.sin, lift<S>(0.0)};
};

void expect_jet(const CurveJet<double>& a, const CurveJet<double>& b) {
  for (const auto& [x, y] :
       {std::pair{a.position, b.position}, {a.first, b.first}, {a.second, b.second}, {a.third, b.third}})
    EXPECT_LE(norm(x - y), 32 * roundoff * (1 + norm(y)));
}

TEST(PositionOnly, CurvesHaveTheDerivativesOfTheirClosedForm) {
  const PositionCurve helix{helix_position};
  const PositionCurve<decltype(circle_position), Coordinate::turn> circle;
  for (int i = 0; i <= 64; ++i) {
    const double t = i / 64.0;
    expect_jet(helix.jet(t), HelixCurve{1.5, 0.25, 2.0}.jet(t));
    expect_jet(circle.jet(sincos_turns(t)), CircleCurve{3.0}.jet(sincos_turns(t)));
  }
  const Tube by_hand{UprightCurve{HelixCurve{1.5, 0.25, 2.0}}, 0.1};
  const Tube by_position{UprightCurve{helix}, 0.1};
  for (int i = 0; i <= 16; ++i)
    EXPECT_LE(distance(frame(by_hand, i / 16.0, 0.3), frame(by_position, i / 16.0, 0.3)), 1e-14);
}

// Of curves without another formula the second formula of the surface takes the first; and lines that cross each other half
// way make dpdu vanish there.
TEST(PositionOnly, RuledSurfaceOfSuchCurves) {
  const auto parabola = []<class S>(const S& t) { return Vec3<S>{t, t * t, lift<S>(0.5)}; };
  const auto arc = []<class S>(const S& t) { return Vec3<S>{lift<S>(2.0) + t * t, lift<S>(1.0) - t, t}; };
  const RuledSurface surface{PositionCurve{parabola}, PositionCurve{arc}};
  for (int i = 0; i <= 8; ++i)
    for (int k = 0; k <= 8; ++k) {
      const double u = i / 8.0, v = k / 8.0;
      EXPECT_LE(norm(surface.position_again(u, v) - jet(surface, u, v).position), 16 * roundoff);
    }
  const RuledSurface crossing{LineSegment{Vec{0, 0, 0}, Vec{1, 0, 0}},
                              LineSegment{Vec{1, 1, 0}, Vec{0, 1, 0}}};
  EXPECT_EQ(status(crossing, 0.25, 0.5), Status::dpdu_zero);
  EXPECT_EQ(status(crossing, 0.25, 0.25), Status::regular);
}

TEST(PositionOnly, GraphHasTheDerivativesOfItsClosedForm) {
  const RoundHill<double> hill{0.75, 0.4};
  const Graph closed{hill, -1.0, 2.0, -1.5, 1.0};
  const Graph only{[hill](const auto& x, const auto& y) { return hill(x, y); }, -1.0, 2.0, -1.5, 1.0};
  for (int i = 0; i <= 16; ++i)
    for (int k = 0; k <= 16; ++k) {
      const double u = i / 16.0, v = k / 16.0;
      const Jet2<double> a = jet(closed, u, v), b = jet(only, u, v);
      for (const auto& [x, y] : {std::pair{a.position, b.position},
                                 {a.dpdu, b.dpdu},
                                 {a.dpdv, b.dpdv},
                                 {a.d2pdu2, b.d2pdu2},
                                 {a.d2pduv, b.d2pduv},
                                 {a.d2pdv2, b.d2pdv2}})
        EXPECT_LE(norm(x - y), 64 * roundoff * (1 + norm(y))) << u << " " << v;
      EXPECT_LE(distance(frame(closed, u, v), frame(only, u, v)), 64 * roundoff) << u << " " << v;
      EXPECT_EQ(frame(only, u, v).status, Status::regular);
      EXPECT_NEAR(only.implicit(b.position), 0, 8 * roundoff);
      EXPECT_NEAR(closed.gaussian_curvature(u, v), only.gaussian_curvature(u, v), 1e-12);
      EXPECT_NEAR(closed.mean_curvature(u, v), only.mean_curvature(u, v), 1e-12);
    }
  const Graph saddle{[](const auto& x, const auto& y) { return x * x - y * y; }, -1.0, 1.0, -1.0, 1.0};
  EXPECT_EQ(jet(saddle, 0.75, 0.5).dpdu, (Vec{2, 0, 2}));
  EXPECT_EQ(saddle.gaussian_curvature(0.5, 0.5), -4);
}

// Not a number beyond t = 1/2, its slope infinite there.
constexpr auto root = []<class S>(const S& t) {
  using std::sqrt;
  return S(sqrt(S(lift<S>(0.5) - t)));
};
constexpr auto ending = []<class S>(const S& t) { return Vec3<S>{t, root(t), lift<S>(0.0)}; };
constexpr auto ending_profile = []<class S>(const S& t) {
  return Vec3<S>{lift<S>(1.0) + t, lift<S>(0.0), root(t)};
};

struct EndingSurface {
  static constexpr SurfaceInfo info{"ending", "not a number beyond u = 1/2", Coordinate::linear,
                                    Coordinate::linear};
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), f = root(u);
    return {{u, v, f}, {one, zero, -(lift<S>(0.5) / f)}, {zero, one, zero}, {}, {}, {}};
  }
};

template <class X>
void expect_flagged(const X& surface, double u, double v) {
  SCOPED_TRACE(::testing::Message() << X::info.name << " at " << u << ", " << v);
  const Frame<double> f = frame(surface, u, v);
  EXPECT_EQ(f.status, Status::no_frame | Status::overflow);
  EXPECT_TRUE(all_nan(f));
  const Sample<double> s = sample(surface, u, v);
  EXPECT_EQ(s.frame.status, f.status);
  EXPECT_TRUE(all_nan(s.frame));
  const ParametricFrame<double> p = parametric_frame(surface, u, v);
  EXPECT_EQ(p.status, f.status);
  EXPECT_TRUE(all_nan(p.t) && all_nan(p.b) && all_nan(p.n));
}

TEST(UserFunctions, ThatReturnNaNAreFlagged) {
  const PositionCurve curve{ending};
  const Graph graph{[](const auto& x, const auto&) { return root(x); }, 0.0, 1.0, 0.0, 1.0};
  for (const double t : {0.5, 0.75, 1.0}) {
    expect_flagged(EndingSurface{}, t, 0.3);
    expect_flagged(graph, t, 0.3);
    expect_flagged(RuledSurface{curve, LineSegment{Vec{0, 0, 1}, Vec{1, 0, 1}}}, t, 0.3);
    expect_flagged(Extrusion{curve, Vec{0, 0, 1}}, t, 0.3);
    expect_flagged(SurfaceOfRevolution{PositionCurve{ending_profile}}, 0.3, t);
    expect_flagged(Tube{PlanarCurve{curve}, 0.1}, t, 0.3);
    expect_flagged(Tube{UprightCurve{curve}, 0.1}, t, 0.3);
  }
  EXPECT_EQ(frame(Extrusion{curve, Vec{0, 0, 1}}, 0.25, 0.3).status, Status::regular);
  EXPECT_EQ(frame(graph, 0.25, 0.3).status, Status::regular);
  EXPECT_EQ(frame(EndingSurface{}, 0.25, 0.3).status, Status::regular);
}

struct Refused {
  int code;
};
constexpr auto refusing = []<class S>(const S& t) {
  if (!(t < lift<S>(0.5))) throw Refused{42};
  return Vec3<S>{t, t * t, lift<S>(0.0)};
};
template <class F>
void expect_refused(F&& f) {
  try {
    f();
    ADD_FAILURE() << "nothing thrown";
  } catch (const Refused& refused) {
    EXPECT_EQ(refused.code, 42);
  }
}
TEST(UserFunctions, ThatThrowAreNotCaught) {
  const auto everywhere = [](const auto& surface) {
    expect_refused([&] { frame(surface, 0.75, 0.3); });
    expect_refused([&] { sample(surface, 0.75, 0.3); });
    expect_refused([&] { jet(surface, 0.75, 0.3); });
    expect_refused([&] { parametric_frame(surface, 0.75, 0.3); });
    EXPECT_NO_THROW(sample(surface, 0.25, 0.3));
  };
  const PositionCurve curve{refusing};
  everywhere(Extrusion{curve, Vec{0, 0, 1}});
  everywhere(RuledSurface{curve, LineSegment{Vec{0, 0, 1}, Vec{1, 0, 1}}});
  everywhere(Tube{PlanarCurve{curve}, 0.1});
  everywhere(Graph{[]<class S>(const S& x, const S&) { return S(refusing(x).y); }, 0.0, 1.0, 0.0, 1.0});
}

// ---- refusals -----------------------------------------------------------------------------------------------------

template <class F>
std::string refusal_of(F&& make) {
  try {
    make();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Refusals, OfDegreesKnotsPointsAndWeights) {
  struct Wrong {
    int degree;
    std::vector<double> knots;
    int points;
    std::vector<double> weights;
    std::string why;
  };
  const std::vector<double> good{0, 0, 0, 0.5, 1, 1, 1};
  const std::vector<Wrong> all{
      {2, good, 4, {}, ""},
      {2, good, 4, {1, 2, 3, 4}, ""},
      {0, good, 4, {}, "degree = 0 must be from 1 to 15"},
      {-1, good, 4, {}, "degree = -1 must be from 1 to 15"},
      {16, good, 4, {}, "degree = 16 must be from 1 to 15"},
      {2, {}, 0, {}, "0 knots: too few control points, degree 2 needs 3 and 6 knots"},
      {2, {0, 0, 0, 1, 1}, 2, {}, "5 knots: too few control points, degree 2 needs 3 and 6 knots"},
      {2, {0, 0, 0, nan_value, 1, 1, 1}, 4, {}, "knot 3 is not finite"},
      {2, {0, 0, 0, 0.5, 1, 1, infinity}, 4, {}, "knot 6 is not finite"},
      {2, {-infinity, 0, 0, 0.5, 1, 1, 1}, 4, {}, "knot 0 is not finite"},
      {2,
       {0, 0, 0, 0.75, 0.5, 1, 1, 1},
       5,
       {},
       "knot 4 = 0.5 is less than knot 3 = 0.75, knots must not decrease"},
      {2, {0, 0, 0, 0.5, 0.5, 0.5, 0.5, 1, 1, 1}, 7, {}, "knot 0.5 has a multiplicity above degree + 1 = 3"},
      {2, {0, 0, 0, 0, 1, 1, 1}, 4, {}, "knot 0 has a multiplicity above degree + 1 = 3"},
      {2, {0, 0.5, 1, 1, 1.5, 2}, 3, {}, "the knots enclose no interval"},
      {2, good, 3, {}, "3 control points, there must be 4"},
      {2, good, 5, {}, "5 control points, there must be 4"},
      {2, good, 0, {}, "0 control points, there must be 4"},
      {2, good, 4, {1, 1, 1}, "3 weights, there must be 4 or none"},
      {2,
       good,
       4,
       {1, 1, 0, 1},
       "weight 2 = 0 must be positive and finite, and not vanish beside the largest"},
      {2, good, 4, {-1, 1, 1, 1}, "weight 0 = -1 must be positive and finite"},
      {2, good, 4, {1, nan_value, 1, 1}, "weight 1 = nan must be positive and finite"},
      {2, good, 4, {1, 1, 1, infinity}, "weight 3 = inf must be positive and finite"}};
  const std::vector<double> line{0, 0, 1, 1};
  for (const Wrong& w : all) {
    const std::vector<Vec> points(w.points, Vec{1, 2, 3}), twice(2 * w.points, Vec{1, 2, 3});
    const std::string accepted = "accepted";
    EXPECT_EQ(refusal_of([&] { BSplineCurve<double>(w.degree, w.knots, points, w.weights); }),
              w.why.empty() ? accepted : "b-spline curve: " + w.why);
    // In a patch beside a line, with every point twice.
    const bool of_knots =
        w.why.starts_with("knot") || w.why.starts_with("degree") || w.why.find("knots") != std::string::npos;
    if (of_knots || w.why.empty()) {
      EXPECT_EQ(refusal_of([&] { BSplinePatch<double>(w.degree, 1, w.knots, line, twice); }),
                w.why.empty() ? accepted : "bspline-patch: along u: " + w.why);
      EXPECT_EQ(refusal_of([&] { BSplinePatch<double>(1, w.degree, line, w.knots, twice); }),
                w.why.empty() ? accepted : "bspline-patch: along v: " + w.why);
    } else {
      const std::vector<double> half{0, 0, 1, 1};
      EXPECT_EQ(refusal_of([&] { BSplinePatch<double>(1, 1, half, half, points, w.weights); }),
                "bspline-patch: " + w.why);
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(1, 1, points, w.weights); }), "bezier-patch: " + w.why);
    }
    if (w.why.starts_with("degree")) {
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(w.degree, 1, points); }), "bezier-patch: " + w.why);
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(1, w.degree, points); }), "bezier-patch: " + w.why);
    }
  }
}

TEST(Refusals, OfPointsThatAreNotFinite) {
  for (const double bad : {nan_value, infinity, -infinity})
    for (const Vec& point : {Vec{bad, 0, 0}, Vec{0, bad, 0}, Vec{0, 0, bad}}) {
      const std::vector<Vec> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, point};
      const std::string why = "control point 3 is not finite";
      EXPECT_EQ(refusal_of([&] { BSplineCurve<double>(3, clamped_knots(3, 4), points); }),
                "b-spline curve: " + why);
      EXPECT_EQ(refusal_of([&] { BezierPatch<double>(1, 1, points); }), "bezier-patch: " + why);
      EXPECT_EQ(refusal_of([&] {
                  BSplinePatch<double>(1, 1, {0, 0, 1, 1}, {0, 0, 1, 1}, points);
                }),
                "bspline-patch: " + why);
    }
}

TEST(Refusals, OfCurvesAndWhatIsMadeOfThem) {
  const Vec o{0, 0, 0}, x{1, 0, 0};
  const BSplineCurve<double> spatial(1, {0, 0, 1, 1}, {{0, 0, 0}, {1, 1, 1}});
  const auto check = [](const auto& surface) { return refusal_of([&] { checked(surface); }); };
  EXPECT_EQ(check(Extrusion<>{}), "accepted");
  EXPECT_EQ(check(Extrusion{LineSegment{o, x}, o}), "extrusion: the direction must not be zero");
  EXPECT_EQ(check(Extrusion{LineSegment{o, Vec{nan_value, 0, 0}}, x}),
            "extrusion: an end of the line segment is not finite");
  EXPECT_EQ(check(Tube{CircleCurve{0.0}, 0.1}),
            "tube: circle_radius = 0 is out of range, permitted is 0 < circle_radius < inf");
  EXPECT_EQ(check(Extrusion{CircleCurve{-1.0}, x}),
            "extrusion: the circle's radius must be positive and finite");
  EXPECT_EQ(check(Extrusion{HelixCurve{0.0, 1.0, 1.0}, x}),
            "extrusion: the helix's radius must be positive and finite");
  EXPECT_EQ(check(Extrusion{HelixCurve{1.0, infinity, 1.0}, x}),
            "extrusion: the helix's pitch must be finite");
  EXPECT_EQ(check(Extrusion{HelixCurve{1.0, 1.0, 0.0}, x}),
            "extrusion: the helix's number of turns must be positive and finite");
  EXPECT_EQ(check(Tube{LineSegment{o, x}, -1.0}),
            "tube: radius = -1 is out of range, permitted is 0 < radius < inf");
  EXPECT_EQ(check(Tube{PlanarCurve{spatial}, 0.1}), "tube: the curve does not lie in a plane z = constant");
  EXPECT_EQ(check(Tube{UprightCurve{spatial, o}, 0.1}), "tube: the direction `up` must not be zero");
  EXPECT_EQ(check(Tube{RotationMinimisingCurve<BSplineCurve<double>>{spatial, x, 0}, 0.1}),
            "tube: panels = 0 must be positive");
  EXPECT_EQ(check(Tube{RotationMinimisingCurve{spatial, o}, 0.1}),
            "tube: the direction `up` must not be zero");
  EXPECT_EQ(check(SurfaceOfRevolution{spatial}),
            "surface-of-revolution: the profile does not lie in the plane y = 0");
  EXPECT_EQ(check(RuledSurface{CircleCurve{0.0}, CircleCurve{1.0}}),
            "ruled-surface: the first curve: the circle's radius must be positive and finite");
  EXPECT_EQ(check(RuledSurface{CircleCurve{1.0}, CircleCurve{nan_value}}),
            "ruled-surface: the second curve: the circle's radius must be positive and finite");
  EXPECT_EQ(check(Graph{RoundHill<double>{}, 1.0, 0.5, 0.0, 1.0}), "graph: x0 = 1 must be below x1 = 0.5");
  EXPECT_EQ(check(Graph{RoundHill<double>{}, 0.0, 1.0, 2.0, 2.0}), "graph: y0 = 2 must be below y1 = 2");
}

// ---- other scalars --------------------------------------------------------------------------------------------------

template <class X>
void expect_rebound(const X& surface) {
  const auto single = rebind<float>(surface);
  const auto many = rebind<ManyDigits>(surface);
  for (const double u : {0.0, 0.125, 0.5, 0.625, 1.0})
    for (const double v : {0.0, 0.25, 0.5, 0.875, 1.0}) {
      SCOPED_TRACE(::testing::Message() << X::info.name << " at " << u << ", " << v);
      const Jet2<double> j = jet(surface, u, v);
      const Jet2<float> f = jet(single, static_cast<float>(u), static_cast<float>(v));
      const Jet2<ManyDigits> m = jet(many, ManyDigits(u), ManyDigits(v));
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
      if constexpr (StatesPositionAgain<X>) {  // to more digits than double has
        const auto again =
            many.position_again(prepare<X::info.u>(ManyDigits(u)), prepare<X::info.v>(ManyDigits(v)));
        for (const ManyDigits& d : {again.x - m.position.x, again.y - m.position.y, again.z - m.position.z})
          EXPECT_LE(std::fabs(static_cast<double>(d)), 1e-34);
      }
    }
}

TEST(Rebind, ToFloatAndToManyDigits) {
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

}  // namespace
}  // namespace darboux::test
