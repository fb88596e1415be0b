// Local fits of unknown surfaces: orders, exactness, invariances, the coverage of their errors, refusals.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iomanip>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/forms.h>
#include <darboux/frame.h>
#include <darboux/local_jets.h>
#include <darboux/statistics.h>

#include "../src/neighbours.h"
#include "random_pose.h"
#include "refusal_of.h"

namespace darboux::test {
namespace {

using Points = std::vector<Vec3<double>>;
constexpr double infinite = std::numeric_limits<double>::infinity();

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine(seed) { std::cout << "seed " << seed << '\n'; }
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); }
  double normal() { return gauss_(engine); }
  std::mt19937_64 engine;

 private:
  std::normal_distribution<double> gauss_;
};

// A point of a surface and neighbours of it; the point itself is the first.
struct Patch {
  Vec2<double> uv;
  std::vector<Vec2<double>> uvs;
  Points points;
};

// n points of the tangent plane's disk of radius h, taken to the surface along the chart.
Patch random_patch(const AnySurface& surface, Random& random, std::size_t n, double h) {
  Patch patch{{random.uniform(0, 1), random.uniform(0.2, 0.8)}, {}, {}};
  const Jet2<double> j = surface.jet(patch.uv.x, patch.uv.y);
  const Frame<double> f = surface.frame(patch.uv.x, patch.uv.y);
  const ShapeOperator<double> s = shape_operator(j, f);
  patch.uvs.push_back(patch.uv);
  while (patch.uvs.size() < n) {
    const double x = random.uniform(-h, h), y = random.uniform(-h, h);
    if (std::hypot(x, y) > h) continue;
    const double dv = y / s.g;
    patch.uvs.push_back(patch.uv + Vec2<double>{(x - s.f * dv) / s.e, dv});
  }
  for (const auto& uv : patch.uvs) patch.points.push_back(surface.jet(uv.x, uv.y).position);
  return patch;
}

void add_noise(Patch& patch, Random& random, double sigma) {
  for (auto& p : patch.points) p += sigma * Vec3<double>{random.normal(), random.normal(), random.normal()};
}

const std::array<const char*, 3> specifications{"torus:major_radius=1,minor_radius=0.4",
                                                "ellipsoid:semi_axis_x=1,semi_axis_y=1.3,semi_axis_z=0.8",
                                                "sphere:radius=1"};

// The angle between two directions without sign.
double line_angle(const Vec3<double>& a, const Vec3<double>& b) {
  const double angle = angle_between(a, b);
  return std::min(angle, std::numbers::pi - angle);
}

double slope(const std::vector<double>& h, const std::vector<double>& errors) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < h.size(); ++i) x.push_back(std::log(h[i])), y.push_back(std::log(errors[i]));
  return fit_line(x, y).slope;
}

double rms(const std::vector<double>& x) {
  double sum = 0;
  for (const double v : x) sum += v * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

double largest(const Vec3<double>& a) {
  return detail::largest_component(a);
}

// The foot of the fit lies off the query by O(h^(d + 1)): truth is that at the query.
TEST(LocalJets, NormalsOfOrderDAndCurvaturesOfOrderDMinus1) {
  for (const char* specification : specifications)
    for (int degree = 2; degree <= 4; ++degree) {
      const AnySurface surface = make_surface(specification);
      Random random(20 + static_cast<std::uint64_t>(degree));
      std::vector<double> sizes, normals, curvatures, directions;
      for (double h = 0.1; h > 0.02; h /= 1.5) {
        std::vector<double> n, k, d;
        for (int i = 0; i < 400; ++i) {
          const Patch patch = random_patch(surface, random, 30, h);
          const Frame<double> frame = surface.frame(patch.uv.x, patch.uv.y);
          const auto truth = curvature(surface, patch.uv.x, patch.uv.y);
          const LocalJet jet = local_jet(patch.points, patch.points[0], {.degree = degree, .side = frame.n});
          ASSERT_EQ(jet.status, Status::regular);
          n.push_back(angle_between(jet.n, frame.n));
          for (int c = 0; c < 2; ++c) k.push_back(jet.curvature.principal[c] - truth.principal[c]);
          // Where the curvatures are close, the directions mean little.
          if (truth.principal[0] - truth.principal[1] > 0.5)
            d.push_back(line_angle(jet.curvature.directions[0], truth.directions[0]));
        }
        sizes.push_back(h);
        normals.push_back(rms(n));
        curvatures.push_back(rms(k));
        directions.push_back(d.empty() ? 1 : rms(d));
      }
      const double n = slope(sizes, normals), k = slope(sizes, curvatures), d = slope(sizes, directions);
      std::cout << specification << " degree " << degree << ": orders normal " << n << ", curvature " << k
                << ", direction " << d << "; at h = 0.1 " << normals[0] << ", " << curvatures[0] << ", "
                << directions[0] << '\n';
      // A sphere has no odd terms over its tangent plane, and gains an order where those would lead.
      const double above = std::string(specification).starts_with("sphere") ? 1.2 : 0.2;
      EXPECT_GT(n, degree - 0.2) << specification << degree;
      EXPECT_LT(n, degree + above) << specification << degree;
      EXPECT_GT(k, degree - 1.2) << specification << degree;
      EXPECT_LT(k, degree - 1 + above) << specification << degree;
      if (above < 1) {
        EXPECT_NEAR(d, degree - 1, 0.2) << specification << degree;
      }
    }
}

TEST(UvJets, PartialsOfOrderD) {
  for (const char* specification : specifications)
    for (int degree = 2; degree <= 4; ++degree) {
      const AnySurface surface = make_surface(specification);
      Random random(30 + static_cast<std::uint64_t>(degree));
      std::vector<double> sizes, firsts, seconds, tangents;
      for (double h = 0.1; h > 0.02; h /= 1.5) {
        std::vector<double> first, second, tangent;
        for (int i = 0; i < 400; ++i) {
          const Patch patch = random_patch(surface, random, 30, h);
          const Jet2<double> truth = surface.jet(patch.uv.x, patch.uv.y);
          const UvJet jet = uv_jet(patch.uvs, patch.points, patch.uv, {.degree = degree});
          ASSERT_EQ(jet.frame.status, Status::regular);
          first.push_back(norm(jet.jet.dpdu - truth.dpdu) / norm(truth.dpdu));
          first.push_back(norm(jet.jet.dpdv - truth.dpdv) / norm(truth.dpdv));
          second.push_back(norm(jet.jet.d2pdu2 - truth.d2pdu2));
          second.push_back(norm(jet.jet.d2pduv - truth.d2pduv));
          second.push_back(norm(jet.jet.d2pdv2 - truth.d2pdv2));
          tangent.push_back(angle_between(jet.frame.t, unit(truth.dpdu)));
        }
        sizes.push_back(h);
        firsts.push_back(rms(first));
        seconds.push_back(rms(second));
        tangents.push_back(rms(tangent));
      }
      const double f = slope(sizes, firsts), s = slope(sizes, seconds), t = slope(sizes, tangents);
      std::cout << specification << " degree " << degree << ": orders first " << f << ", second " << s
                << ", tangent " << t << "; at h = 0.1 " << firsts[0] << ", " << seconds[0] << '\n';
      EXPECT_NEAR(f, degree, 0.2) << specification;
      EXPECT_NEAR(s, degree - 1, 0.2) << specification;
      EXPECT_NEAR(t, degree, 0.2) << specification;
    }
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

    // Coordinates round by 4u of their size 1, divided by the patch's 0.2 once for slopes and twice for curvatures.
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

// Of many |error| / standard error: how many are at most 2, and the root mean square.
class Coverage {
 public:
  void add(double error, double standard_error) {
    ++count_;
    if (std::fabs(error) <= 2 * standard_error) ++within_;
    ratios_.push_back(std::fabs(error) / standard_error);
  }
  double within() const { return within_ / count_; }
  double median() {
    std::nth_element(ratios_.begin(), ratios_.begin() + static_cast<std::ptrdiff_t>(ratios_.size() / 2),
                     ratios_.end());
    return ratios_[ratios_.size() / 2];
  }
  double count() const { return count_; }

 private:
  double within_ = 0, count_ = 0;
  std::vector<double> ratios_;
};

// 95 % of the errors lie within two standard errors, less what chance takes from a share of so many; and the standard
// errors are no wild guess: half of the errors are above a tenth of them.
void expect_honest(const std::string& what, Coverage& coverage) {
  const double chance = 3 * std::sqrt(0.95 * 0.05 / coverage.count());
  std::cout << what << ": within two " << coverage.within() << ", median error / standard error "
            << coverage.median() << '\n';
  EXPECT_GT(coverage.within(), 0.95 - chance) << what;
  EXPECT_GT(coverage.median(), 0.1) << what;
}

TEST(LocalJets, ErrorsCoverNoiseAndTruncation) {
  for (const char* specification : {specifications[0], specifications[1]})
    for (int degree = 2; degree <= 4; ++degree)
      for (const double sigma : {0.0, 1e-5, 1e-3}) {
        const AnySurface surface = make_surface(specification);
        Random random(40 + static_cast<std::uint64_t>(degree));
        Coverage normals, k1, k2, directions;
        for (int i = 0; i < 1000; ++i) {
          Patch patch = random_patch(surface, random, 2 * jet_coefficients(degree + 1), 0.15);
          const Vec3<double> at = patch.points[0];
          add_noise(patch, random, sigma);
          const Frame<double> frame = surface.frame(patch.uv.x, patch.uv.y);
          const auto truth = curvature(surface, patch.uv.x, patch.uv.y);
          const LocalJet jet = local_jet(patch.points, at, {.degree = degree, .side = frame.n});
          normals.add(angle_between(jet.n, frame.n), jet.normal_error);
          k1.add(jet.curvature.principal[0] - truth.principal[0], jet.principal_error[0]);
          k2.add(jet.curvature.principal[1] - truth.principal[1], jet.principal_error[1]);
          if (jet.direction_error < 0.2)  // radians: it is of first order
            directions.add(line_angle(jet.curvature.directions[0], truth.directions[0]), jet.direction_error);
        }
        const std::string what = std::string(specification).substr(0, 9) + " degree " +
                                 std::to_string(degree) + " noise " + std::to_string(sigma);
        expect_honest(what + " normal", normals);
        expect_honest(what + " k1", k1);
        expect_honest(what + " k2", k2);
        if (directions.count() > 100) expect_honest(what + " directions", directions);
      }
}

// The 19 vertices up to two edges away on a regular triangulation, in uv.
Patch two_ring(const AnySurface& surface, Random& random, double h, double jitter) {
  Patch patch{{random.uniform(0, 1), random.uniform(0.2, 0.8)}, {}, {}};
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      if (std::abs(i + j) <= 2)
        patch.uvs.push_back(patch.uv + Vec2<double>{h * (i + random.uniform(-jitter, jitter)),
                                                    h * (j + random.uniform(-jitter, jitter))});
  for (const auto& uv : patch.uvs) patch.points.push_back(surface.jet(uv.x, uv.y).position);
  return patch;
}

TEST(UvJets, ErrorsCoverNoiseAndTruncation) {
  for (const char* specification : {specifications[0], specifications[1]})
    for (int degree = 2; degree <= 3; ++degree)
      for (const double jitter : {0.0, 0.2, -1.0})  // the last stands for random neighbours
        for (const double sigma : {0.0, 1e-6, 1e-3}) {
          const AnySurface surface = make_surface(specification);
          Random random(50 + static_cast<std::uint64_t>(degree));
          Coverage us, vs, tangents, normals;
          for (int i = 0; i < 1000; ++i) {
            Patch patch = jitter < 0 ? random_patch(surface, random, 2 * jet_coefficients(degree + 1), 0.15)
                                     : two_ring(surface, random, 0.01, jitter);
            add_noise(patch, random, sigma);
            const Jet2<double> truth = surface.jet(patch.uv.x, patch.uv.y);
            const UvJet jet = uv_jet(patch.uvs, patch.points, patch.uv, {.degree = degree});
            us.add(norm(jet.jet.dpdu - truth.dpdu), jet.dpdu_error);
            vs.add(norm(jet.jet.dpdv - truth.dpdv), jet.dpdv_error);
            tangents.add(angle_between(jet.jet.dpdu, truth.dpdu), jet.tangent_error);
            normals.add(angle_between(jet.frame.n, frame_from_partials(truth.dpdu, truth.dpdv).n),
                        jet.normal_error);
          }
          const std::string what = std::string(specification).substr(0, 9) + " degree " +
                                   std::to_string(degree) + " jitter " + std::to_string(jitter) + " noise " +
                                   std::to_string(sigma);
          expect_honest(what + " dpdu", us);
          expect_honest(what + " dpdv", vs);
          expect_honest(what + " t", tangents);
          expect_honest(what + " n", normals);
        }
}

}  // namespace
}  // namespace darboux::test
