// Local fits of unknown surfaces: exactness, invariances, what determines nothing, clouds, refusals.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/curvature.h>
#include <darboux/frame.h>
#include <darboux/local_jets.h>

#include "base/neighbours.h"
#include "jet_patches.h"
#include "random.h"
#include "random_pose.h"
#include "refusal_of.h"

namespace darboux::test::local_jets_test {
namespace {

double largest(const Vec3<double>& a) {
  return detail::largest_component(a);
}

// A polynomial of two variables: coefficients of x^i y^j.
struct Polynomial {
  double c[5][5] = {};
  static Polynomial random(Random& random, int degree) {
    Polynomial p;
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j) p.c[i][j] = random.uniform(-1, 1);
    return p;
  }
  double operator()(double x, double y) const {
    double sum = 0;
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) sum += c[i][j] * std::pow(x, i) * std::pow(y, j);
    return sum;
  }
};

TEST(LocalJets, ExactOnGraphsOfPolynomials) {
  Random random(7);
  for (int degree = 2; degree <= 4; ++degree)
    for (int repeat = 0; repeat < 100; ++repeat) {
      Polynomial z = Polynomial::random(random, degree);
      // Without its plane of regression, so that the neighbours' plane is z = 0.
      Eigen::MatrixXd plane(30, 3);
      Eigen::VectorXd heights(30);
      std::vector<Vec2<double>> places(30);
      for (int i = 0; i < 30; ++i) {
        auto& [x, y] = places[static_cast<std::size_t>(i)];
        x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        z.c[0][0] = 0.25 * z.c[0][0];
        plane.row(i) << 1, x, y;
      }
      for (auto& row : z.c)
        for (double& c : row) c *= 0.2;
      for (int i = 0; i < 30; ++i)
        heights(i) = z(places[static_cast<std::size_t>(i)].x, places[static_cast<std::size_t>(i)].y);
      const Eigen::Vector3d regression = plane.colPivHouseholderQr().solve(heights);
      z.c[0][0] -= regression(0), z.c[1][0] -= regression(1), z.c[0][1] -= regression(2);

      const Eigen::Isometry3d pose = random_pose(random.engine, 3);
      const auto placed = [&](const Vec3<double>& p) { return from_eigen(pose * to_eigen(p)); };
      const auto turned = [&](const Vec3<double>& p) { return from_eigen(pose.linear() * to_eigen(p)); };
      Points points;
      for (const auto& [x, y] : places) points.push_back(placed({x, y, z(x, y)}));
      const Jet2<double> truth{{0, 0, z.c[0][0]},     {1, 0, z.c[1][0]}, {0, 1, z.c[0][1]},
                               {0, 0, 2 * z.c[2][0]}, {0, 0, z.c[1][1]}, {0, 0, 2 * z.c[0][2]}};
      const Frame<double> frame = frame_from_partials(truth.dpdu, truth.dpdv);
      const auto k = curvature(truth, frame);
      const LocalJet jet =
          local_jet(points, placed({0, 0, 0.1}), {.degree = degree, .side = turned({0, 0, 1})});
      // Coordinates of size 5 and rounding errors amplified by the condition number.
      const double tolerance = 40 * 0x1p-53 * jet.condition;
      EXPECT_LT(largest(jet.position - placed(truth.position)), tolerance) << degree;
      EXPECT_LT(angle_between(jet.n, turned(frame.n)), tolerance) << degree;
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(jet.curvature.principal[i], k.principal[i], tolerance) << degree;
      EXPECT_LT(line_angle(jet.curvature.directions[0], turned(k.directions[0])),
                tolerance / (k.principal[0] - k.principal[1]))
          << degree;
      EXPECT_LT(jet.residual_rms, tolerance);
      EXPECT_LT(jet.normal_error, tolerance);
    }
}

TEST(UvJets, ExactOnPolynomials) {
  Random random(8);
  for (int degree = 2; degree <= 4; ++degree)
    for (int repeat = 0; repeat < 100; ++repeat) {
      const std::array<Polynomial, 3> p{Polynomial::random(random, degree),
                                        Polynomial::random(random, degree),
                                        Polynomial::random(random, degree)};
      // A sheared chart of unequal sizes about a place of its own: u = 3 + 1e-3 x, v = -2 + 50 (x + y).
      const auto uv_of = [](double x, double y) { return Vec2<double>{3 + 1e-3 * x, -2 + 50 * (x + y)}; };
      std::vector<Vec2<double>> uvs;
      Points points;
      for (int i = 0; i < 40; ++i) {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        uvs.push_back(uv_of(x, y));
        points.push_back({p[0](x, y), p[1](x, y), p[2](x, y)});
      }
      const UvJet jet = uv_jet(uvs, points, uv_of(0, 0), {.degree = degree});
      const auto coefficient = [&](int i, int j) {
        return Vec3<double>{p[0].c[i][j], p[1].c[i][j], p[2].c[i][j]};
      };
      // x = (u - 3)/1e-3, y = (v + 2)/50 - x.
      const Vec3<double> x = coefficient(1, 0), y = coefficient(0, 1), xx = 2.0 * coefficient(2, 0),
                         xy = coefficient(1, 1), yy = 2.0 * coefficient(0, 2);
      // The uvs round by u |3|/1e-3.
      const double tolerance = 3e3 * 8 * 0x1p-53 * jet.condition;
      EXPECT_LT(largest(jet.jet.position - coefficient(0, 0)), tolerance);
      EXPECT_LT(largest(1e-3 * jet.jet.dpdu - (x - y)), tolerance);
      EXPECT_LT(largest(50.0 * jet.jet.dpdv - y), tolerance);
      EXPECT_LT(largest(1e-6 * jet.jet.d2pdu2 - (xx - 2.0 * xy + yy)), tolerance);
      EXPECT_LT(largest(0.05 * jet.jet.d2pduv - (xy - yy)), tolerance);
      EXPECT_LT(largest(2500.0 * jet.jet.d2pdv2 - yy), tolerance);
    }
}

TEST(LocalJets, MoveAndScaleWithThePoints) {
  Random random(9);
  const AnySurface surface = make_surface(specifications[1]);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const int degree = 2 + repeat % 3;
    Patch patch = random_patch(surface, random, 40, 0.2);
    add_noise(patch, random, 1e-3);
    const Vec3<double> side = surface.frame(patch.uv.x, patch.uv.y).n;
    const LocalJet jet = local_jet(patch.points, patch.points[0], {.degree = degree, .side = side});
    const UvJet uv = uv_jet(patch.uvs, patch.points, patch.uv, {.degree = degree});

    const Eigen::Isometry3d pose = random_pose(random.engine, 1);
    const double size = std::pow(10, random.uniform(-100, 100));
    const auto turned = [&](const Vec3<double>& p) { return from_eigen(pose.linear() * to_eigen(p)); };
    Patch moved = patch;
    for (auto& p : moved.points) p = size * from_eigen(pose * to_eigen(p));
    const Vec3<double> at = moved.points[0];
    std::vector<std::size_t> order(40);
    for (std::size_t i = 0; i < 40; ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random.engine);
    Patch shuffled;
    for (const std::size_t i : order)
      shuffled.points.push_back(moved.points[i]), shuffled.uvs.push_back(moved.uvs[i]);
    const LocalJet other = local_jet(shuffled.points, at, {.degree = degree, .side = turned(side)});
    const UvJet other_uv = uv_jet(shuffled.uvs, shuffled.points, patch.uv, {.degree = degree});

    // Coordinates round by 4u of their size 1, divided by the patch's 0.2 once for slopes and twice for
    // curvatures.
    const double tolerance = 100 * 0x1p-53 * jet.condition;
    EXPECT_LT(angle_between(other.n, turned(jet.n)), tolerance);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(other.curvature.principal[i] * size, jet.curvature.principal[i], tolerance);
      EXPECT_NEAR(other.principal_error[i] * size, jet.principal_error[i], tolerance);
    }
    EXPECT_NEAR(other.condition / jet.condition, 1, tolerance);
    EXPECT_NEAR(other.residual_rms / size, jet.residual_rms, tolerance);
    EXPECT_NEAR(other.normal_error, jet.normal_error, tolerance);
    EXPECT_LT(largest(other_uv.jet.dpdu / size - turned(uv.jet.dpdu)), 10 * tolerance);
    EXPECT_LT(largest(other_uv.jet.d2pduv / size - turned(uv.jet.d2pduv)), 1000 * tolerance);
    EXPECT_NEAR(other_uv.dpdu_error / size, uv.dpdu_error, 10 * tolerance);
    EXPECT_NEAR(other_uv.tangent_error, uv.tangent_error, tolerance);
    EXPECT_NEAR(other_uv.normal_error, uv.normal_error, tolerance);
  }
}

TEST(LocalJets, AWeightOfTwoIsThePointTwice) {
  Random random(60);
  const AnySurface surface = make_surface(specifications[1]);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const int degree = 2 + repeat % 3;
    Patch once = random_patch(surface, random, 30, 0.2);
    add_noise(once, random, 1e-2);
    Patch twice = once;
    std::vector<double> weights(30, 0.7);
    for (std::size_t i = 0; i < 30; i += 3) {
      weights[i] = 1.4;
      twice.points.push_back(once.points[i]);
      twice.uvs.push_back(once.uvs[i]);
    }
    const Vec3<double> at = once.points[0];
    const LocalJet a = local_jet(once.points, at, {.degree = degree, .weights = weights}),
                   b = local_jet(twice.points, at, {.degree = degree}),
                   plain = local_jet(once.points, at, {.degree = degree});
    const UvJet c = uv_jet(once.uvs, once.points, once.uv, {.degree = degree, .weights = weights}),
                d = uv_jet(twice.uvs, twice.points, once.uv, {.degree = degree});
    // Sizes of 0.2 and rounding errors amplified by the condition number.
    const double tolerance = 100 * 0x1p-53 * a.condition;
    EXPECT_LT(angle_between(a.n, b.n), tolerance);
    EXPECT_GT(angle_between(a.n, plain.n), 1e-4);
    EXPECT_NEAR(a.curvature.principal[0], b.curvature.principal[0], tolerance);
    EXPECT_NEAR(a.condition / b.condition, 1, tolerance);
    EXPECT_NEAR(a.residual_rms, b.residual_rms, tolerance);
    EXPECT_LT(largest(c.jet.dpdu - d.jet.dpdu), 10 * tolerance);
    EXPECT_NEAR(c.residual_rms, d.residual_rms, tolerance);
  }
}

TEST(LocalJets, TheSideOfTheNormal) {
  Random random(61);
  const AnySurface surface = make_surface(specifications[0]);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const Patch patch = random_patch(surface, random, 30, 0.1);
    const Vec3<double> n = surface.frame(patch.uv.x, patch.uv.y).n, at = patch.points[0];
    const LocalJet out = local_jet(patch.points, at, {.side = 1e200 * n}),
                   in = local_jet(patch.points, at, {.side = -n}), by_rule = local_jet(patch.points, at);
    EXPECT_GT(dot(out.n, n), 0.9);
    EXPECT_EQ(in.n, -out.n);
    // With the other n: κ1' = -κ2, κ2' = -κ1, and the directions change places.
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(in.curvature.principal[i], -out.curvature.principal[1 - i], 1e-9);
      EXPECT_NEAR(in.principal_error[i], out.principal_error[1 - i], 1e-9);
      EXPECT_LT(line_angle(in.curvature.directions[i], out.curvature.directions[1 - i]), 1e-9);
      EXPECT_LT(norm(in.curvature.directions[1] - cross(in.n, in.curvature.directions[0])), 1e-15);
    }
    const double most = std::max({by_rule.n.x, by_rule.n.y, by_rule.n.z});
    EXPECT_GT(most, -std::min({by_rule.n.x, by_rule.n.y, by_rule.n.z}));
  }
  // On a sphere with n outward both curvatures are negative.
  const AnySurface sphere = make_surface("sphere:radius=2");
  const Patch patch = random_patch(sphere, random, 30, 0.1);
  const LocalJet jet = local_jet(patch.points, patch.points[0], {.degree = 4, .side = patch.points[0]});
  EXPECT_NEAR(jet.curvature.principal[0], -0.5, 1e-4);
  EXPECT_NEAR(jet.curvature.principal[1], -0.5, 1e-4);
}

void expect_nothing(const LocalJet& jet, Status status) {
  EXPECT_EQ(jet.status, status);
  EXPECT_EQ(jet.curvature.status, status);
  for (const double x : {jet.n.x, jet.position.z, jet.curvature.principal[0], jet.curvature.mean,
                         jet.normal_error, jet.principal_error[1], jet.direction_error, jet.residual_rms})
    EXPECT_TRUE(std::isnan(x));
  EXPECT_GT(jet.condition, 1e12);
}
void expect_nothing(const UvJet& jet, Status status) {
  EXPECT_EQ(jet.frame.status, status);
  for (const double x : {jet.frame.n.x, jet.jet.position.x, jet.jet.dpdu.y, jet.jet.d2pdv2.z, jet.dpdu_error,
                         jet.tangent_error, jet.normal_error, jet.residual_rms})
    EXPECT_TRUE(std::isnan(x));
  EXPECT_GT(jet.condition, 1e12);
}

TEST(LocalJets, WhatDeterminesNothingIsFlagged) {
  Random random(62);
  constexpr Status none = Status::no_frame, bad = Status::no_frame | Status::non_finite_input;
  const AnySurface surface = make_surface(specifications[0]);
  const Patch good = random_patch(surface, random, 30, 0.1);
  const auto jets = [](const Patch& patch, Status status, int degree) {
    expect_nothing(
        local_jet(patch.points, patch.points.empty() ? Vec3<double>{} : patch.points[0], {.degree = degree}),
        status);
    expect_nothing(uv_jet(patch.uvs, patch.points, patch.uv, {.degree = degree}), status);
  };
  for (int degree = 2; degree <= 4; ++degree) {
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}, jet_coefficients(degree) - 1}) {
      Patch few = good;
      few.points.resize(n), few.uvs.resize(n);
      jets(few, none, degree);
    }
    Patch patch = good;
    for (std::size_t i = 0; i < 30; ++i) patch.points[i] = good.points[0], patch.uvs[i] = good.uvs[0];
    jets(patch, none, degree);  // coincident
    for (std::size_t i = 0; i < 30; ++i) {
      const double x = random.uniform(-1, 1);
      patch.points[i] = {1 + x, 2 - 3 * x, 0.1 * x}, patch.uvs[i] = {0.3 + x / 7, 0.4 - x / 3};
    }
    patch.uv = {0.3, 0.4};
    jets(patch, none, degree);  // collinear
    for (std::size_t i = 0; i < 30; ++i) {
      const double a = random.uniform(0, 7);
      patch.points[i] = {3 + std::cos(a), 0.5 * std::sin(a), 2},
      patch.uvs[i] = {std::cos(a), 2 + 5 * std::sin(a)};
    }
    patch.uv = {0, 2};
    jets(patch, none, degree);  // on a conic
    for (const double x : {std::nan(""), infinite, -infinite}) {
      patch = good;
      patch.points[7].y = x;
      jets(patch, bad, degree);
      expect_nothing(local_jet(good.points, {0, x, 0}, {.degree = degree}), bad);
      patch = good;
      patch.uvs[7].x = x;
      expect_nothing(uv_jet(patch.uvs, patch.points, patch.uv, {.degree = degree}), bad);
      expect_nothing(uv_jet(good.uvs, good.points, {0, x}, {.degree = degree}), bad);
    }
  }
}

// Points along a line have partials and no normal, however few they are.
TEST(UvJets, OfALineHaveNoFrameAndNoErrorOfIt) {
  Random random(70);
  for (std::size_t n = jet_coefficients(3); n < 25; ++n) {
    Patch patch;
    for (std::size_t i = 0; i < n; ++i) {
      const auto& [u, v] = patch.uvs.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1));
      patch.points.push_back({0, 0, 1 + u + 0.5 * v});
    }
    const UvJet jet = uv_jet(patch.uvs, patch.points, {0, 0});
    EXPECT_TRUE(has(jet.frame.status, Status::no_frame)) << n;
    EXPECT_NEAR(jet.jet.dpdu.z, 1, 1e-13 * jet.condition);
    EXPECT_TRUE(std::isnan(jet.tangent_error) && std::isnan(jet.normal_error)) << n;
  }
}

// By powers of two all is exact.
TEST(UvJets, ErrorsOfDirectionsHaveNoUnit) {
  Random random(71);
  Patch patch = random_patch(make_surface(specifications[0]), random, 30, 0.1);
  add_noise(patch, random, 1e-3);
  for (auto& uv : patch.uvs) uv = uv - patch.uv;
  const UvJet jet = uv_jet(patch.uvs, patch.points, {0, 0});
  ASSERT_GT(jet.normal_error, 1e-4);
  for (const auto& [of_points, of_uvs] : std::vector<std::pair<int, int>>{{990, 0},
                                                                          {660, 0},
                                                                          {-660, 0},
                                                                          {-990, 0},
                                                                          {0, 660},
                                                                          {0, -660},
                                                                          {660, 660},
                                                                          {-660, -660},
                                                                          {-300, 600}}) {
    Patch scaled = patch;
    for (auto& p : scaled.points) p = std::ldexp(1.0, of_points) * p;
    for (auto& uv : scaled.uvs) uv = std::ldexp(1.0, of_uvs) * uv;
    const UvJet other = uv_jet(scaled.uvs, scaled.points, {0, 0});
    EXPECT_EQ(other.frame.t, jet.frame.t) << of_points << ' ' << of_uvs;
    EXPECT_EQ(other.normal_error, jet.normal_error) << of_points << ' ' << of_uvs;
    EXPECT_EQ(other.tangent_error, jet.tangent_error) << of_points << ' ' << of_uvs;
    EXPECT_EQ(other.dpdu_error, std::ldexp(jet.dpdu_error, of_points - of_uvs)) << of_points << ' ' << of_uvs;
    EXPECT_EQ(other.condition, jet.condition);
  }
  // An extent that is no normal number is none.
  for (const bool of_points : {true, false}) {
    Patch scaled = patch;
    for (auto& p : scaled.points) p = (of_points ? 1e-310 : 1) * p;
    for (auto& uv : scaled.uvs) uv = (of_points ? 1 : 1e-310) * uv;
    expect_nothing(uv_jet(scaled.uvs, scaled.points, {0, 0}), Status::no_frame);
  }
}

TEST(LocalJets, WhatDoesNotTellTheErrorHasAnInfiniteOne) {
  Random random(63);
  const AnySurface surface = make_surface(specifications[0]);
  for (int degree = 2; degree <= 4; ++degree) {
    const Patch patch = random_patch(surface, random, 40, 0.1);
    for (std::size_t n = jet_coefficients(degree); n < 40; ++n) {
      const std::span points(patch.points.data(), n);
      const std::span uvs(patch.uvs.data(), n);
      const LocalJet jet = local_jet(points, points[0], {.degree = degree});
      const UvJet uv = uv_jet(uvs, points, patch.uv, {.degree = degree});
      const bool told = n >= jet_coefficients(degree + 1) + 3;
      EXPECT_TRUE(std::isfinite(jet.n.x) && std::isfinite(uv.jet.dpdu.x)) << n;
      for (const double error : {jet.normal_error, jet.principal_error[0], jet.direction_error, uv.dpdu_error,
                                 uv.dpdv_error, uv.tangent_error, uv.normal_error})
        EXPECT_EQ(std::isfinite(error), told) << n << ' ' << error;
    }
  }
  // On a grid of five by five a polynomial of degree five is not determined: x⁵ is one of degree four.
  Points grid;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j) grid.push_back({0.1 * i, 0.1 * j, 0.01 * i * i * i * i});
  const LocalJet jet = local_jet(grid, {0, 0, 0}, {.degree = 4});
  EXPECT_LT(std::fabs(angle_between(jet.n, {0, 0, 1})), 1e-12);
  EXPECT_EQ(jet.normal_error, infinite);
}

TEST(LocalJets, OfAPlane) {
  Random random(64);
  Points points;
  for (int i = 0; i < 30; ++i) points.push_back({random.uniform(-1, 1), 5, random.uniform(-1, 1)});
  const LocalJet jet = local_jet(points, {0, 7, 0});
  EXPECT_EQ(jet.status, Status::regular);
  EXPECT_LT(norm(jet.n - Vec3<double>{0, 1, 0}), 1e-14);
  EXPECT_LT(norm(jet.position - Vec3<double>{0, 5, 0}), 1e-14);
  EXPECT_LT(std::fabs(jet.curvature.principal[0]), 1e-13);
  EXPECT_LT(jet.normal_error, 1e-13);
}

TEST(UvJets, AcrossASeam) {
  Random random(65);
  const AnySurface surface = make_surface(specifications[0]);
  Patch patch = random_patch(surface, random, 30, 0.1);
  const Vec2<double> shift{-patch.uv.x, 1 - patch.uv.y};  // to (0, 1)
  patch.uv = {0, 0};
  Patch cut = patch;
  for (std::size_t i = 0; i < 30; ++i) {
    patch.uvs[i] = patch.uvs[i] + shift;
    const auto& [u, v] = patch.uvs[i];
    cut.uvs[i] = {u - std::floor(u), v - std::floor(v)};
    patch.uvs[i].y = v - 1;
  }
  const UvJet whole = uv_jet(patch.uvs, patch.points, patch.uv),
              joined = uv_jet(cut.uvs, cut.points, cut.uv, {.u_periodic = true, .v_periodic = true}),
              half = uv_jet(cut.uvs, cut.points, cut.uv, {.u_periodic = true});
  // uvs of size 1 round by u, over a patch of a hundredth.
  EXPECT_LT(norm(joined.jet.dpdu - whole.jet.dpdu), 1e-9);
  EXPECT_LT(norm(joined.jet.dpdv - whole.jet.dpdv), 1e-9);
  EXPECT_GT(half.normal_error, 10 * whole.normal_error);
}

// By looking at all.
std::vector<std::uint32_t> nearest(const Points& points, const Vec3<double>& query, std::size_t k) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (detail::finite(points[i])) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) {
    return dot(points[a] - query, points[a] - query) < dot(points[b] - query, points[b] - query);
  });
  order.resize(std::min(order.size(), k));
  return order;
}

TEST(Neighbours, AreTheNearest) {
  Random random(66);
  Points points;
  for (int i = 0; i < 500; ++i) points.push_back({random.normal(), random.normal(), 0.1 * random.normal()});
  points[17].x = std::nan("");
  points[23].z = infinite;
  const Neighbours tree(points);
  EXPECT_EQ(tree.size(), 498U);
  Points half(points);
  std::vector<std::uint32_t> subset;
  for (std::uint32_t i = 0; i < 500; ++i)
    if (i % 2 == 1)
      subset.push_back(i);
    else
      half[i].x = infinite;
  const Neighbours of_subset(points, subset);
  for (int i = 0; i < 100; ++i) {
    const Vec3<double> query{random.normal(), random.normal(), random.normal()};
    for (const std::size_t k : {1, 10, 600}) {
      std::vector<std::uint32_t> found(k);
      std::vector<double> squared(k);
      found.resize(tree.nearest(query, found, squared));
      EXPECT_EQ(found, nearest(points, query, k));
      for (std::size_t j = 0; j < found.size(); ++j) {
        const Vec3<double> d = points[found[j]] - query;
        EXPECT_NEAR(squared[j], dot(d, d), 4 * 0x1p-53 * squared[j]);
      }
      found.resize(k);
      found.resize(of_subset.nearest(query, found, squared));
      EXPECT_EQ(found, nearest(half, query, k));
    }
  }
  std::vector<std::uint32_t> one(1);
  std::vector<double> squared(1);
  EXPECT_EQ(Neighbours(Points{}).nearest({}, one, squared), 0U);
}

TEST(LocalJets, OfACloudAreThoseOfItsPoints) {
  Random random(67);
  const AnySurface surface = make_surface(specifications[0]);
  PointCloud cloud;
  for (int i = 0; i < 2000; ++i) {
    const double u = random.uniform(0, 1), v = random.uniform(0, 1);
    cloud.uvs.push_back({u, v});
    cloud.positions.push_back(surface.jet(u, v).position);
    cloud.normals.push_back((i % 2 == 0 ? 3.0 : -1.0) * surface.frame(u, v).n);
  }
  cloud.positions[5].x = std::nan("");
  cloud.normals[8] = {};
  for (const std::size_t k : {std::size_t{0}, std::size_t{25}}) {
    const CloudJetOptions options{
        .degree = 3, .neighbours = k, .u_periodic = true, .v_periodic = true, .threads = 1};
    CloudJetOptions threads = options;
    threads.threads = 3;
    const auto jets = local_jets(cloud, options), jets3 = local_jets(cloud, threads);
    const auto uv = uv_jets(cloud, options), uv3 = uv_jets(cloud, threads);
    ASSERT_EQ(jets.size(), 2000U);
    expect_nothing(jets[5], Status::no_frame | Status::non_finite_input);
    expect_nothing(uv[5], Status::no_frame | Status::non_finite_input);
    for (std::size_t i = 0; i < 2000; ++i) {
      if (i == 5) continue;
      EXPECT_TRUE(jets[i].n == jets3[i].n && jets[i].normal_error == jets3[i].normal_error);
      EXPECT_TRUE(uv[i].jet.dpdu == uv3[i].jet.dpdu && uv[i].dpdu_error == uv3[i].dpdu_error);
      if (i % 20 != 8) continue;
      std::vector<Vec2<double>> uvs;
      Points points;
      for (const auto j : nearest(cloud.positions, cloud.positions[i], k == 0 ? 30 : k))
        points.push_back(cloud.positions[j]), uvs.push_back(cloud.uvs[j]);
      const LocalJet one = local_jet(points, cloud.positions[i], {.side = cloud.normals[i]});
      EXPECT_EQ(one.n, jets[i].n);
      EXPECT_EQ(one.curvature.principal[0], jets[i].curvature.principal[0]);
      EXPECT_EQ(one.condition, jets[i].condition);
      const UvJet one_uv = uv_jet(uvs, points, cloud.uvs[i], {.u_periodic = true, .v_periodic = true});
      EXPECT_EQ(one_uv.jet.d2pduv, uv[i].jet.d2pduv);
    }
  }
  cloud.positions.resize(9), cloud.normals.clear(), cloud.uvs.resize(9);
  for (const auto& jet : local_jets(cloud)) EXPECT_TRUE(has(jet.status, Status::no_frame));
  for (const auto& jet : uv_jets(cloud)) EXPECT_TRUE(has(jet.frame.status, Status::no_frame));
  EXPECT_TRUE(local_jets({}).empty() && uv_jets({}).empty());
}

TEST(LocalJets, Refusals) {
  Random random(68);
  const Patch patch = random_patch(make_surface(specifications[0]), random, 30, 0.1);
  const Points& p = patch.points;
  for (const int degree : {-1, 0, 1, 5}) {
    const std::string words = "degree: expected 2 to 4, got " + std::to_string(degree);
    EXPECT_REFUSED(local_jet(p, p[0], {.degree = degree}), words);
    EXPECT_REFUSED(uv_jet(patch.uvs, p, patch.uv, {.degree = degree}), words);
    EXPECT_REFUSED(local_jets({p, {}, {}}, {.degree = degree}), words);
    EXPECT_REFUSED(uv_jets({p, {}, patch.uvs}, {.degree = degree}), words);
  }
  std::vector<double> weights(29, 1);
  EXPECT_REFUSED(local_jet(p, p[0], {.weights = weights}),
                 "weights: expected none or one for each of 30 neighbours, got 29");
  weights.assign(30, 1);
  for (const double w : {0.0, -1.0, infinite, std::nan("")}) {
    weights[3] = w;
    EXPECT_REFUSED(local_jet(p, p[0], {.weights = weights}),
                   "weights: weight: expected 0 < weight < inf, got ");
    EXPECT_REFUSED(uv_jet(patch.uvs, p, patch.uv, {.weights = weights}),
                   "weights: weight: expected 0 < weight < inf, got ");
  }
  EXPECT_REFUSED(uv_jet(std::span(patch.uvs).first(3), p, patch.uv),
                 "uvs: expected one per position, 30, got 3");
  EXPECT_REFUSED(local_jets({p, {}, {}}, {.neighbours = 9}),
                 "neighbours: expected 10 or more for degree 3, got 9");
  EXPECT_REFUSED(local_jets({p, {}, {}}, {.threads = -1}), "threads: expected 0 (all) or more, got -1");
  const auto of_mesh = [](auto&& f) { return refusal_of<MeshError>(f); };
  EXPECT_EQ(of_mesh([&] {
              local_jets({p, {{0, 0, 1}}, {}});
            }),
            "points: expected no normals or one per position, 30, got 1");
  EXPECT_EQ(of_mesh([&] {
              uv_jets({p, {}, {{0, 0}}});
            }),
            "points: expected no uvs or one per position, 30, got 1");
  EXPECT_EQ(of_mesh([&] { uv_jets({p, {}, {}}); }), "points: expected one uv per position, got none");
}

}  // namespace
}  // namespace darboux::test::local_jets_test
