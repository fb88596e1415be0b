// Points of surfaces that are fitted by their templates alone, from default proportions.
#include "fit/catalogue/fit_catalogue.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/project.h>

#include "base/linear_algebra.h"
#include "random_pose.h"
#include "thinning.h"

namespace darboux::test::fit_catalogue_test {
namespace {

constexpr double noise = 1e-3;

struct Sampled {
  PlacedSurface truth;
  PointCloud points;
  std::vector<Vec3<double>> normals;
};

// Parameters within a fifth of the defaults, a random pose; a part of the domain, `share` of each side.
Sampled sampled(const std::string& kind, double share, std::uint64_t seed, std::size_t count = 800) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, noise);
  AnySurface surface = make_surface(kind);
  std::vector<double> values;
  for (const ParameterValue& p : surface.parameters())
    values.push_back(p.value * (0.8 + 0.4 * uniform(random)));
  surface = surface.with(values);
  Sampled result{{surface, random_pose(random, 5)}, {}, {}};
  const double u = (1 - share) * uniform(random), v = (1 - share) * uniform(random);
  for (std::size_t i = 0; i < count; ++i) {
    const Sample<double> s = surface.sample(u + share * uniform(random), v + share * uniform(random));
    Eigen::Vector3d x = result.truth.placement * to_eigen(s.jet.position);
    for (int k = 0; k < 3; ++k) x[k] += normal(random);
    result.points.positions.push_back(from_eigen(x));
    result.normals.push_back(from_eigen(result.truth.placement.linear() * to_eigen(s.frame.n)));
  }
  return result;
}

double parameter(const AnySurface& surface, std::string_view name) {
  for (const ParameterValue& p : surface.parameters())
    if (p.name == name) return p.value;
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

PointFitOptions with_guess(const PlacedSurface& guess) {
  PointFitOptions options;
  options.guess = guess;
  return options;
}

PointFitOptions with_noise(double value) {
  PointFitOptions options;
  options.noise = value;
  return options;
}

class AnyKind : public ::testing::TestWithParam<const char*> {};

// Noise-sized distances from the true surface, not only from the points: that is what a wrong surface through
// them fails.
TEST_P(AnyKind, IsFoundWithoutAGuess) {
  std::uint64_t seed = 100;
  for (const double share : {1.0, 0.5}) {
    std::cout << "seed " << seed << '\n';
    const Sampled data = sampled(GetParam(), share, seed++);
    const PointFit fit = fit_catalogue(data.points, GetParam(), {});
    ASSERT_TRUE(fit.usable) << fit.reason;
    // 800 distances: sigma is told to 1/40, four of these; few points are taken for outliers.
    EXPECT_NEAR(fit.sigma, noise, 0.1 * noise) << fit.reason;
    EXPECT_GT(fit.inliers, 780U);
    EXPECT_EQ(fit.inliers + fit.outliers, data.points.positions.size());
    double error = 0, turned = 0, stated = 0;
    for (std::size_t i = 0; i < 50; ++i) {
      const UncertainFrame frame = frame_near(fit, data.points.positions[i]);
      // From a start beside it: where the surface meets itself another sheet may be nearer.
      const Eigen::Isometry3d inverse = data.truth.placement.inverse();
      const Projection there = Projector(data.truth.surface)(from_eigen(inverse * to_eigen(frame.position)));
      error = std::fmax(error, std::fabs(there.distance));
      const double angle = norm(cross(frame.n, data.normals[i]));
      turned += angle * angle;
      const double deviation = frame.normal_deg * std::numbers::pi / 180;
      stated += deviation * deviation;
    }
    // Some eight unknowns share the noise of 800 points: noise (8 / 800)^(1/2) on average, several times that
    // at borders.
    EXPECT_LE(error, noise) << fit.reason;
    // The true normal is that of the point before noise, which moves the foot by noise times a curvature of
    // up to 8, and the stated uncertainty, of strongly correlated errors.
    EXPECT_LE(std::sqrt(turned / 50), 8 * noise * std::numbers::sqrt2 + 4 * std::sqrt(stated / 50))
        << fit.reason;
  }
}
INSTANTIATE_TEST_SUITE_P(Catalogue, AnyKind,
                         ::testing::Values("elliptic-paraboloid", "hyperbolic-paraboloid",
                                           "one-sheet-hyperboloid", "catenoid", "helicoid", "monkey-saddle",
                                           "enneper"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// The mean of z² over 12 fits of two parameters is 1 ± (2 / 24)^(1/2): three of these.
TEST(AnyKindFit, StandardErrorsAreThoseOfRepeatedFits) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Sampled data = sampled("one-sheet-hyperboloid", 0.7, seed, 400);
    // From a guess, which costs less; what comes out of it does not depend on that.
    const PointFit fit = fit_catalogue(data.points, "one-sheet-hyperboloid", with_guess(data.truth));
    ASSERT_TRUE(fit.usable) << fit.reason;
    for (const StandardError& error : fit.standard_errors)
      if (error.name == "waist_radius" || error.name == "semi_axis_z") {
        const double z =
            (parameter(fit.surface->surface, error.name) - parameter(data.truth.surface, error.name)) /
            error.value;
        sum += z * z;
        ++count;
      }
  }
  EXPECT_EQ(count, 24);
  EXPECT_NEAR(sum / count, 1, 3 * std::sqrt(2.0 / count));
}

TEST(AnyKindFit, SaysWhatThePointsDoNotTell) {
  const Sampled data = sampled("one-sheet-hyperboloid", 1, 3);
  const PointFit fit = fit_catalogue(data.points, "one-sheet-hyperboloid", {});
  ASSERT_TRUE(fit.usable) << fit.reason;
  EXPECT_NE(fit.reason.find("height not determined by the points, held fixed"), std::string::npos)
      << fit.reason;
  // Nothing of the height, the last parameter; and one motion less, the turn about the axis.
  EXPECT_EQ(fit.covariance.row(8).norm(), 0);
  EXPECT_EQ(fit.covariance.col(8).norm(), 0);
  const Eigen::VectorXd values = symmetric_eigenvalues(fit.covariance);
  EXPECT_EQ((values.array() > 1e-9 * values[8]).count(), 7) << values.transpose();
}

TEST(AnyKindFit, PassesOutliersAndBadPointsBy) {
  Sampled data = sampled("catenoid", 1, 4);
  std::mt19937_64 random(5);
  Eigen::AlignedBox3d box;
  for (const Vec3<double>& p : data.points.positions) box.extend(to_eigen(p));
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t i = 0; i < 80; ++i)
    data.points.positions[10 * i] =
        from_eigen(box.min() + box.sizes().cwiseProduct(
                                   Eigen::Vector3d(uniform(random), uniform(random), uniform(random))));
  data.points.positions.push_back({std::nan(""), 0, 0});
  const PointFit fit = fit_catalogue(data.points, "catenoid", {});
  ASSERT_TRUE(fit.usable) << fit.reason;
  EXPECT_EQ(fit.ignored, 1U);
  EXPECT_EQ(fit.is_inlier.size(), data.points.positions.size());
  EXPECT_FALSE(fit.is_inlier.back());
  EXPECT_NEAR(parameter(fit.surface->surface, "waist_radius"), parameter(data.truth.surface, "waist_radius"),
              noise);
  EXPECT_NEAR(static_cast<double>(fit.outliers), 80, 10);
}

TEST(AnyKindFit, IsNotUsableOnOtherPoints) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PointCloud cube;
  for (int i = 0; i < 400; ++i) cube.positions.push_back({uniform(random), uniform(random), uniform(random)});
  const PointFit fit = fit_catalogue(cube, "catenoid", {});
  EXPECT_FALSE(fit.usable);
  EXPECT_FALSE(fit.surface);
  EXPECT_FALSE(fit.reason.empty());
  PointCloud few;
  few.positions.assign(5, {1, 2, 3});
  EXPECT_FALSE(fit_catalogue(few, "catenoid", {}).usable);
  few.positions.assign(50, {1, 2, 3});
  EXPECT_EQ(fit_catalogue(few, "catenoid", {}).reason, "all points are at one place");
  EXPECT_FALSE(fit_catalogue({}, "catenoid", {}).usable);
}

TEST(AnyKindFit, RefusesBadRequests) {
  const PointCloud points = sampled("catenoid", 1, 7, 50).points;
  EXPECT_THROW(fit_catalogue(points, "bezier-patch", {}), ParameterError);
  EXPECT_THROW(fit_catalogue(points, "superellipsoid", {}), ParameterError);
  EXPECT_THROW(fit_catalogue(points, "teapot", {}), ParameterError);
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(fit_catalogue(points, "catenoid", with_noise(bad)), ParameterError);
  EXPECT_THROW(fit_catalogue(points, "catenoid", with_guess({make_surface("sphere")})), ParameterError);
  PointCloud ragged = points;
  ragged.normals.resize(3);
  EXPECT_THROW(fit_catalogue(ragged, "catenoid", {}), MeshError);
}

// Centre and size are medians: one point, however far, says nothing of the others.
TEST(AnyKindFit, OneFarPointIsAnOutlier) {
  for (const double far : {1e4, 1e12, 1e150}) {
    Sampled data = sampled("elliptic-paraboloid", 1, 9, 1500);
    data.points.positions[3] = {far, far, -far};
    const PointFit fit = fit_catalogue(data.points, "elliptic-paraboloid", {});
    ASSERT_TRUE(fit.usable) << far << ": " << fit.reason;
    EXPECT_NEAR(fit.sigma, noise, 0.1 * noise) << far;  // 1500 distances tell it to 2 %
    EXPECT_FALSE(fit.is_inlier[3]);
    EXPECT_LE(fit.outliers, 15U);
  }
}

// Points on a line or in a plane lie on many surfaces of any kind, whether exactly or but for noise.
TEST(AnyKindFit, LinesAndPlanesAreNoSurfaces) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  int number = -1;  // 6 kinds
  for (const double sigma : {0.0, noise})
    for (const bool plane : {false, true})
      for (const char* kind : {"elliptic-paraboloid", "hyperbolic-paraboloid", "one-sheet-hyperboloid",
                               "catenoid", "helicoid", "monkey-saddle"}) {
        ++number;
        const Eigen::Isometry3d pose = random_pose(random, 3);
        PointCloud points;
        for (int i = 0; i < (plane ? 300 : 100); ++i) {
          const Eigen::Vector3d x(uniform(random), plane ? uniform(random) : 0, 0),
              off(normal(random), normal(random), normal(random));
          points.positions.push_back(from_eigen(pose * (x + sigma * off)));
        }
        if (!is_taken(number / 12 + number / 6 % 2 + number % 6)) continue;
        const PointFit fit = fit_catalogue(points, kind, {});
        EXPECT_FALSE(fit.usable) << kind << ", sigma " << sigma << (plane ? ", plane: " : ", line: ")
                                 << fit.reason << ' '
                                 << (fit.surface ? fit.surface->surface.specification() : "");
        EXPECT_FALSE(fit.surface);
      }
}

// The noise that is estimated and the covariance are of one footing: with that noise given, the covariance is
// the same. 30 points' weights depend on the noise by some percent; the correction is 30 / 23.
TEST(AnyKindFit, CovarianceIsThatOfTheStatedNoise) {
  const Sampled data = sampled("one-sheet-hyperboloid", 0.7, 11, 30);
  const PointFit free = fit_catalogue(data.points, "one-sheet-hyperboloid", with_guess(data.truth));
  ASSERT_TRUE(free.usable) << free.reason;
  PointFitOptions options = with_guess(data.truth);
  options.noise = free.sigma;
  const PointFit held = fit_catalogue(data.points, "one-sheet-hyperboloid", options);
  ASSERT_TRUE(held.usable) << held.reason;
  EXPECT_EQ(free.inliers, 30U);
  for (const std::size_t k : {0U, 1U}) {
    const double ratio = free.standard_errors[k].value / held.standard_errors[k].value;
    EXPECT_NEAR(ratio * ratio, 1, 0.05);
    // Student's t of 30 - 7 degrees of freedom, against the normal: 2.0687 and 1.9600.
    const auto half = [&](const PointFit& fit) { return fit.intervals[k].high - fit.intervals[k].low; };
    EXPECT_NEAR(half(free) / half(held) / ratio, 2.0687 / 1.96, 1e-4);
  }
  EXPECT_EQ(free.interval_method, "t");
  EXPECT_EQ(held.interval_method, "linear");
}

// An end is an end: from starts on either side the estimates agree to a small part of their standard errors.
TEST(AnyKindFit, ConvergesWithinTheStandardErrors) {
  Sampled data = sampled("catenoid", 1, 12, 6000);
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> uniform(-3, 3);
  for (std::size_t i = 0; i < 1200; ++i)
    data.points.positions[5 * i] =
        data.points.positions[5 * i] + 0.01 * Vec3<double>{uniform(random), uniform(random), uniform(random)};
  std::vector<PointFit> fits;
  for (const double factor : {0.97, 1.04}) {
    PlacedSurface guess = data.truth;
    guess.surface = guess.surface.with(
        std::vector{factor * parameter(guess.surface, "waist_radius"), parameter(guess.surface, "extent")});
    fits.push_back(fit_catalogue(data.points, "catenoid", with_guess(guess)));
    ASSERT_TRUE(fits.back().usable) << fits.back().reason;
  }
  EXPECT_NEAR(parameter(fits[0].surface->surface, "waist_radius"),
              parameter(fits[1].surface->surface, "waist_radius"), 0.02 * fits[0].standard_errors[0].value);
}

// What only bounds the patch, or may grow with the others, encloses the inliers and no more: the feet's
// coordinates that end reach from side to side.
TEST(AnyKindFit, ThePatchEnclosesTheInliers) {
  for (const char* kind :
       {"one-sheet-hyperboloid", "catenoid", "elliptic-paraboloid", "hyperbolic-paraboloid"}) {
    const Sampled data = sampled(kind, 0.6, 14);
    const PointFit fit = fit_catalogue(data.points, kind, {});
    ASSERT_TRUE(fit.usable) << fit.reason;
    const Projector projector(fit.surface->surface);
    const Eigen::Isometry3d inverse = fit.surface->placement.inverse();
    const SurfaceInfo& info = fit.surface->surface.info();
    double beyond = -1;
    for (std::size_t i = 0; i < data.points.positions.size(); ++i) {
      if (!fit.is_inlier[i]) continue;
      const Vec2<double> uv = projector(from_eigen(inverse * to_eigen(data.points.positions[i]))).uv;
      if (info.u == Coordinate::linear) beyond = std::fmax(beyond, std::fmax(-uv.x, uv.x - 1));
      if (info.v == Coordinate::linear) beyond = std::fmax(beyond, std::fmax(-uv.y, uv.y - 1));
    }
    EXPECT_NEAR(beyond, 0, 1e-6) << fit.surface->surface.specification() << fit.reason;
  }
}

TEST(AnyKindFit, TellsItsProgress) {
  PointFitOptions options;
  std::vector<double> shares;
  options.progress = [&](double share) { shares.push_back(share); };
  const Sampled data = sampled("catenoid", 1, 15, 3000);
  ASSERT_TRUE(fit_catalogue(data.points, "catenoid", options).usable);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
  EXPECT_GT(shares.size(), 40U + 3);  // at most 40 starts; the others from within the fits that follow
}

TEST(AnyKindFit, GivesTheSameBitsAgain) {
  const PointCloud points = sampled("hyperbolic-paraboloid", 1, 8, 200).points;
  const PointFit a = fit_catalogue(points, "hyperbolic-paraboloid", {}),
                 b = fit_catalogue(points, "hyperbolic-paraboloid", {});
  ASSERT_TRUE(a.usable && b.usable) << a.reason;
  EXPECT_EQ(a.surface->surface.specification(), b.surface->surface.specification());
  EXPECT_EQ(a.surface->placement.matrix(), b.surface->placement.matrix());
}

}  // namespace
}  // namespace darboux::test::fit_catalogue_test
