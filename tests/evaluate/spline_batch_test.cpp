// Batches of splines give the bits of single points: lanes of one span and of several, every degree, rational
// or not, at knots and edges, on every instruction set.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bezier_patch.h>
#include <darboux/bspline_patch.h>
#include <darboux/evaluate.h>
#include <darboux/extrusion.h>
#include <darboux/instruction_set.h>
#include <darboux/surface_of_revolution.h>

#include "thinning.h"

namespace darboux::spline_batch_test {
namespace {

using Numbers = std::vector<double>;

// A net over the unit square whose heights are random, so that it is regular everywhere.
std::vector<Vec3<double>> random_net(std::mt19937& random, int rows, int columns) {
  std::uniform_real_distribution<double> height(0, 0.3);
  std::vector<Vec3<double>> net;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      net.push_back({double(i) / (rows - 1), double(j) / (columns - 1), height(random)});
  return net;
}
Numbers random_weights(std::mt19937& random, std::size_t n, double spread) {
  Numbers weights(n);
  for (double& w : weights) w = std::pow(spread, std::uniform_real_distribution<double>(-0.5, 0.5)(random));
  return weights;
}
// Knots of `count` control points, some of them repeated up to the degree, the ends less often than that.
Numbers random_knots(std::mt19937& random, int degree, int count) {
  Numbers knots;
  std::uniform_real_distribution<double> step(0.1, 1);
  do {
    knots.clear();
    for (double at = 0; static_cast<int>(knots.size()) < degree + count + 1; at += step(random))
      for (unsigned k = 0; k <= random() % static_cast<unsigned>(degree); ++k) knots.push_back(at);
    knots.resize(static_cast<std::size_t>(degree + count + 1));
  } while (!KnotVector<double>::refusal(degree, knots).empty());
  return knots;
}

template <class T>
struct Places {
  std::vector<T> u, v;
};
// Points at random, along rows, at the knots, and outside the chart.
template <class T>
Places<T> places(std::mt19937& random, const Numbers& breaks_u, const Numbers& breaks_v) {
  std::uniform_real_distribution<double> at(0, 1);
  Places<T> result;
  const auto add = [&](double u, double v) {
    result.u.push_back(static_cast<T>(u)), result.v.push_back(static_cast<T>(v));
  };
  for (int i = 0; i < 300; ++i) add(at(random), at(random));
  for (const double v : {0.31, 0.0, 1.0})
    for (int i = 0; i <= 64; ++i) add(i / 64.0, v);
  for (const double x : breaks_u) add(x, at(random));
  for (const double x : breaks_v) add(at(random), x);
  for (const double x : {-0.25, -1e-9, 1 + 1e-6, 7.0, std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::quiet_NaN()}) {
    add(x, 0.3), add(0.3, x), add(x, x);
    for (int i = 0; i < 8; ++i) add(at(random), at(random));  // so that it is in a group with others
  }
  return result;
}

constexpr std::array attributes{Attribute::position, Attribute::dpdu,          Attribute::dpdv,
                                Attribute::tangent,  Attribute::bitangent,     Attribute::normal,
                                Attribute::tangent4, Attribute::d2pdu2,        Attribute::d2pduv,
                                Attribute::d2pdv2,   Attribute::mean_curvature};

template <class T>
auto bits(T x) {
  return std::bit_cast<std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>>(x);
}

// How many points went by themselves.
template <class X, class T>
std::size_t expect_same_bits(const X& surface, const Points<T>& points, std::span<const Attribute> asked) {
  const std::size_t n = points.size();
  std::size_t singly = 0;
  std::vector<std::vector<T>> expected;
  std::vector<Status> status(n);
  const auto run = [&](InstructionSet set, std::vector<std::vector<T>>& values) {
    Outputs<T> outputs;
    values.clear();
    for (const Attribute a : asked) values.emplace_back(n * info_of(a).components);
    for (std::size_t k = 0; k < asked.size(); ++k) outputs.packed(asked[k], values[k]);
    std::fill(status.begin(), status.end(), static_cast<Status>(~0u));  // none that a point has
    outputs.status(status);
    return evaluate(surface, points, outputs, {.instruction_set = set});
  };
  run(InstructionSet::points, expected);
  const std::vector<Status> expected_status = status;
  for (const InstructionSet set : instruction_sets()) {
    if (set == InstructionSet::points) continue;
    std::vector<std::vector<T>> got;
    singly += run(set, got).point_by_point;
    EXPECT_EQ(status, expected_status) << static_cast<int>(set);
    for (std::size_t k = 0; k < asked.size(); ++k)
      for (std::size_t i = 0; i < got[k].size(); ++i)
        if (bits(got[k][i]) != bits(expected[k][i])) {
          ADD_FAILURE() << info_of(asked[k]).name << " of point " << i / info_of(asked[k]).components << ": "
                        << got[k][i] << ", by itself " << expected[k][i] << ", set " << static_cast<int>(set);
          return singly;
        }
  }
  return singly;
}

// The few requests that take other ways through the kernels, over arrays and over a grid.
template <class T, class X>
void expect_same_bits(const X& patch, std::mt19937& random, const Numbers& breaks_u,
                      const Numbers& breaks_v) {
  const auto surface = rebind<T>(patch);
  const Places<T> at = places<T>(random, breaks_u, breaks_v);
  for (const auto& points : {Points<T>::arrays(at.u, at.v), Points<T>::grid(37, 11)}) {
    expect_same_bits(surface, points, std::span(attributes));
    expect_same_bits(surface, points, std::span(attributes).first(6));
    expect_same_bits(surface, points, std::span(attributes).subspan(6, 1));
    expect_same_bits(surface, points, std::span(attributes).first(1));
  }
}

TEST(SplineBatches, EveryDegreeGivesTheBitsOfSinglePoints) {
  int number = -1;
  for (int p = 1; p <= 5; ++p)
    for (int q = 1; q <= 5; ++q)
      for (const double spread : {1.0, 4.0, 1e6}) {
        ++number;
        if (!test::is_taken(p + q + number % 3)) continue;
        std::mt19937 random(29 + static_cast<unsigned>(number));
        SCOPED_TRACE(std::to_string(p) + " x " + std::to_string(q) + ", weights by " +
                     std::to_string(spread));
        const int rows = p + 1 + static_cast<int>(random() % 6),
                  columns = q + 1 + static_cast<int>(random() % 6);
        const auto weights_of = [&](int n) {
          return spread == 1 ? Numbers{} : random_weights(random, static_cast<std::size_t>(n), spread);
        };
        const BSplinePatch<double> spline(p, q, random_knots(random, p, rows), clamped_knots(q, columns),
                                          random_net(random, rows, columns), weights_of(rows * columns));
        expect_same_bits<double>(spline, random, spline.breaks(0), spline.breaks(1));
        expect_same_bits<float>(spline, random, spline.breaks(0), spline.breaks(1));
        const BezierPatch<double> bezier(p, q, random_net(random, p + 1, q + 1),
                                         weights_of((p + 1) * (q + 1)));
        expect_same_bits<double>(bezier, random, {}, {});
        expect_same_bits<float>(bezier, random, {}, {});
      }
}

TEST(SplineBatches, HighDegreesAndManySpans) {
  std::mt19937 random(30);
  for (const auto& [degree, count] : {std::pair{15, 20}, {3, 200}, {2, 70}, {1, 100}}) {
    SCOPED_TRACE(degree);
    const BSplinePatch<double> spline(degree, degree, clamped_knots(degree, count),
                                      clamped_knots(degree, count), random_net(random, count, count));
    expect_same_bits<double>(spline, random, spline.breaks(0), spline.breaks(1));
    expect_same_bits<float>(spline, random, spline.breaks(0), spline.breaks(1));
    // Rows that pass over more columns of the net than are kept at a time, a lane's spans near and far.
    const BSplinePatch<double> rational(degree, 2, clamped_knots(degree, count), clamped_knots(2, 3),
                                        random_net(random, count, 3),
                                        random_weights(random, static_cast<std::size_t>(3 * count), 4));
    for (const std::size_t columns : {1500, 400, 100, 50}) {
      expect_same_bits(spline, Points<double>::grid(columns, 1), std::span(attributes));
      expect_same_bits(rational, Points<double>::grid(columns, 1), std::span(attributes));
      expect_same_bits(rebind<float>(spline), Points<float>::grid(columns, 1), std::span(attributes));
      expect_same_bits(rebind<float>(rational), Points<float>::grid(columns, 1), std::span(attributes));
    }
  }
}

// Edges that are one point, as poles of patches are.
TEST(SplineBatches, CollapsedEdges) {
  std::mt19937 random(33);
  for (const double spread : {1.0, 4.0}) {
    std::vector<Vec3<double>> net = random_net(random, 7, 6);
    for (std::size_t j = 0; j < 6; ++j) net[j] = net[0];
    for (std::size_t i = 0; i < 7; ++i) net[6 * i + 5] = net[5];
    const auto weights_of = [&](std::size_t n) {
      return spread == 1 ? Numbers{} : random_weights(random, n, spread);
    };
    const BSplinePatch<double> spline(3, 2, clamped_knots(3, 7), clamped_knots(2, 6), net, weights_of(42));
    const BezierPatch<double> bezier(6, 5, net, weights_of(42));
    EXPECT_TRUE(has(spline.singular(0.0, 0.31), Status::dpdv_zero));
    EXPECT_TRUE(has(bezier.singular(0.31, 1.0), Status::dpdu_zero));
    expect_same_bits<double>(spline, random, spline.breaks(0), spline.breaks(1));
    expect_same_bits<float>(spline, random, spline.breaks(0), spline.breaks(1));
    expect_same_bits<double>(bezier, random, {}, {});
    expect_same_bits<float>(bezier, random, {}, {});
  }
}

// Control points of a curve about the plane y = 0, or in it.
std::vector<Vec3<double>> random_points(std::mt19937& random, int count, double least_x, double most_y) {
  std::uniform_real_distribution<double> x(least_x, 1), y(0, most_y);
  std::vector<Vec3<double>> points;
  for (int i = 0; i < count; ++i)
    points.push_back({x(random), most_y > 0 ? y(random) : 0, double(i) / count});
  return points;
}

TEST(SplineBatches, CurvesOfEveryDegreeGiveTheBitsOfSinglePoints) {
  std::mt19937 random(34);
  for (const int degree : {1, 2, 3, 4, 5, 6, 15})
    for (const double spread : {1.0, 4.0, 1e6}) {
      SCOPED_TRACE(std::to_string(degree) + ", weights by " + std::to_string(spread));
      const int count = degree + 1 + static_cast<int>(random() % 6);
      const Numbers knots = random_knots(random, degree, count);
      const Numbers weights =
          spread == 1 ? Numbers{} : random_weights(random, static_cast<std::size_t>(count), spread);
      // Profiles on one side of the axis, and such that cross it.
      for (const double least_x : {0.1, -1.0}) {
        const SurfaceOfRevolution of_revolution{
            BSplineCurve<double>(degree, knots, random_points(random, count, least_x, 0), weights)};
        expect_same_bits<double>(of_revolution, random, {}, of_revolution.breaks(1));
        expect_same_bits<float>(of_revolution, random, {}, of_revolution.breaks(1));
      }
      const Extrusion extrusion{
          BSplineCurve<double>(degree, knots, random_points(random, count, -1, 1), weights),
          Vec3<double>{0.1, 0.2, 1}};
      expect_same_bits<double>(extrusion, random, extrusion.breaks(0), {});
      expect_same_bits<float>(extrusion, random, extrusion.breaks(0), {});
    }
}

// Profiles that begin and end on the axis, stop, and run straight; curves of which pieces run along the
// direction.
TEST(SplineBatches, CurvesWithSingularPlaces) {
  std::mt19937 random(35);
  const auto expect_same = [&](const auto& surface) {
    expect_same_bits<double>(surface, random, surface.breaks(0), surface.breaks(1));
    expect_same_bits<float>(surface, random, surface.breaks(0), surface.breaks(1));
    // Rows 2, 4, ... of this grid are the corners of the polygons of degree 1.
    expect_same_bits(surface, Points<double>::grid(30, 10), std::span(attributes));
  };
  const std::vector<Vec3<double>> lathe{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0.5, 0, 1}, {0, 0, 2}, {-1, 0, 2}};
  const std::vector<Vec3<double>> stops{{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 1}, {1, 0, 1}, {2, 0, 1}};
  for (const int degree : {1, 2, 3})
    for (const auto& points : {lathe, stops}) {
      const BSplineCurve<double> curve(degree, clamped_knots(degree, 6), points);
      expect_same(SurfaceOfRevolution{curve});
      expect_same(Extrusion{curve, Vec3<double>{0, 0, 1}});
      expect_same(Extrusion{curve, Vec3<double>{0, 1e-200, 0}});
      expect_same(SurfaceOfRevolution{
          BSplineCurve<double>(degree, clamped_knots(degree, 6), points, {1, 2, 1, 0.5, 1, 3})});
    }
}

// No point goes by itself, whatever its span.
TEST(SplineBatches, RunInLanes) {
  if (instruction_sets().back() == InstructionSet::points) GTEST_SKIP() << "only `points` here";
  std::mt19937 random(31);
  const BSplinePatch<double> spline(3, 3, clamped_knots(3, 8), clamped_knots(3, 8), random_net(random, 8, 8));
  const Places<double> at = places<double>(random, {}, {});
  const std::size_t n = 296;  // those at random, whole registers of them
  EXPECT_EQ(
      expect_same_bits(spline, Points<double>::arrays(std::span(at.u).first(n), std::span(at.v).first(n)),
                       std::span(attributes).first(6)),
      0U);
  const std::span<const double> u = std::span(at.u).first(n), v = std::span(at.v).first(n);
  const BSplineCurve<double> profile(3, clamped_knots(3, 8), random_points(random, 8, 0.1, 0));
  const auto without_curvature = std::span(attributes).first(10);
  for (const auto& points : {Points<double>::arrays(u, v), Points<double>::grid(40, 20)}) {
    EXPECT_EQ(expect_same_bits(SurfaceOfRevolution{profile}, points, std::span(attributes)), 0U);
    EXPECT_EQ(expect_same_bits(Extrusion{profile, Vec3<double>{0.1, 1, 0}}, points, without_curvature), 0U);
  }
  // Nor at simple knots, and on edges that are no point: the columns and rows 3, 6, ... of this grid are
  // knots.
  EXPECT_EQ(expect_same_bits(spline, Points<double>::grid(15, 15), std::span(attributes).first(6)), 0U);
}

// What is not asked for changes no bit of what is.
TEST(SplineBatches, OrdersAgree) {
  std::mt19937 random(32);
  for (const double spread : {1.0, 4.0})
    for (int p = 1; p <= 4; ++p) {
      const BSplinePatch<double> spline(p, 3, clamped_knots(p, 7), clamped_knots(3, 6),
                                        random_net(random, 7, 6),
                                        spread == 1 ? Numbers{} : random_weights(random, 42, spread));
      const Places<double> at = places<double>(random, spline.breaks(0), spline.breaks(1));
      for (std::size_t i = 0; i < at.u.size(); ++i) {
        const Jet2<double> all = spline.jet(at.u[i], at.v[i]), first = spline.jet_to<1>(at.u[i], at.v[i]),
                           position = spline.jet_to<0>(at.u[i], at.v[i]);
        const auto bits_of = [](const Vec3<double>& p) {
          return std::array{bits(p.x), bits(p.y), bits(p.z)};
        };
        EXPECT_EQ(bits_of(first.position), bits_of(all.position));
        EXPECT_EQ(bits_of(first.dpdu), bits_of(all.dpdu));
        EXPECT_EQ(bits_of(first.dpdv), bits_of(all.dpdv));
        EXPECT_EQ(first.d2pduv, Vec3<double>{});
        EXPECT_EQ(bits_of(position.position), bits_of(all.position));
        EXPECT_EQ(position.dpdu, Vec3<double>{});
      }
    }
}

}  // namespace
}  // namespace darboux::spline_batch_test
