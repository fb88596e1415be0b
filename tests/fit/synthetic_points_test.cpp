// The generator of points and the judge of their fits, judged themselves: without any fit of the library.
#include "synthetic_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

#include <gtest/gtest.h>

#include "thinning.h"

namespace darboux::synthetic_points_test {
namespace {

constexpr std::array<std::string_view, 6> kinds{"plane", "sphere", "cylinder", "cone", "torus", "ellipsoid"};
constexpr std::uint64_t seed = 71;

// Least squares of the distances, by Gauss-Newton from the truth, of the true inliers in the truth's own
// frame and before scaling.
Eigen::VectorXd least_squares(const SyntheticPoints& points) {
  const TrueShape shape(points);
  const int n = shape.parameters();
  const Eigen::Isometry3d& place = points.truth.placement;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (std::size_t k = 0; k < points.is_inlier.size(); ++k) {
      if (!points.is_inlier[k]) continue;
      const Eigen::Vector3d p = place.linear().transpose() *
                                (to_eigen(points.cloud.positions[k]) - place.translation()) / points.scale;
      const auto [d, slope] = distance_and_slope(shape, q, p);
      normal += slope * slope.transpose();
      right += slope * d;
    }
    q -= normal.ldlt().solve(right);
  }
  return q;
}

// The minimal parameters as a placed surface again, with one of the other names it has where it is symmetric.
PlacedSurface surface_at(const SyntheticPoints& points, const Eigen::VectorXd& q, PortableRandom& random) {
  const TrueShape shape(points);
  std::vector<double> values = shape.values;
  Eigen::Isometry3d local = Eigen::Isometry3d::Identity();
  const auto tilt = [&](double a, double b, double z) {
    const Eigen::Vector3d axis = Eigen::Vector3d(a, b, z).normalized() * z;
    // Eigen's FromTwoVectors compiles a singular value decomposition.
    const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(axis);
    local.linear() = Eigen::AngleAxisd(std::atan2(across.norm(), axis.z()), across.normalized()).matrix() *
                     Eigen::AngleAxisd(random.uniform(0, 6), Eigen::Vector3d::UnitZ());
    if (shape.kind != "cone" && random.uniform() < 0.5)
      local.linear() = local.linear() * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  };
  if (shape.kind == "plane") {
    tilt(q[0], q[1], 1);
    local.translation() =
        q[2] * Eigen::Vector3d(q[0], q[1], 1).normalized() + random.normal() * local.linear().col(0);
  } else if (shape.kind == "sphere") {
    local.linear() = random.rotation();
    local.translation() = q.head(3);
    values[0] += q[3];
  } else if (shape.kind == "cylinder") {
    tilt(q[2], q[3], 1);
    local.translation() = Eigen::Vector3d(q[0], q[1], 0) + random.normal() * local.linear().col(2);
    values[0] += q[4];
    values[1] *= random.uniform(0.5, 2);
  } else if (shape.kind == "cone") {
    tilt(q[3], q[4], -1);
    const double angle = std::atan2(values[0], values[1]) + q[5], height = values[1];
    values[1] *= random.uniform(0.5, 2);
    values[0] = values[1] * std::tan(angle);
    local.translation() = Eigen::Vector3d(q[0], q[1], height + q[2]) - values[1] * local.linear().col(2);
  } else if (shape.kind == "torus") {
    tilt(q[3], q[4], 1);
    local.translation() = q.head(3);
    values[0] += q[5];
    values[1] += q[6];
  } else {
    const auto turns = cube_turns();
    const Eigen::Matrix3d cube = turns[random.below(turns.size())];
    const Eigen::Vector3d omega = q.segment(3, 3);
    local.linear() = Eigen::AngleAxisd(omega.norm(), omega.normalized()).matrix() * cube;
    local.translation() = q.head(3);
    Eigen::Vector3d axes(values[0], values[1], values[2]);
    axes = (cube.transpose() * axes.cwiseProduct(q.tail(3).array().exp().matrix())).cwiseAbs();
    values.assign({axes[0], axes[1], axes[2]});
  }
  for (double& v : values) v *= points.scale;
  local.translation() *= points.scale;
  PlacedSurface placed{points.truth.surface.with(values)};
  placed.placement = points.truth.placement * local;
  return placed;
}

// The judge's expectation. Over M sets of n parameters the mean of e^T I e / n scatters by sqrt(2 / (n M)); a
// wrong formula for a distance, a wrong information or a wrong symmetry moves it by far more.
TEST(SyntheticPoints, TheOracleReachesTheBound) {
  const int sets = 120 / test::thinning(3);
  for (const std::string_view kind : kinds)
    for (const double coverage : {1.0, 0.25}) {
      PortableRandom random(seed);
      double sum = 0;
      int n = 0;
      for (int k = 0; k < sets; ++k) {
        // Noise so small that neither curvature nor the distance's second order counts: sigma / size beside 1
        // / sqrt(count).
        const SyntheticPoints points = make_points(kind, {.count = 1000,
                                                          .sigma = 1e-5,
                                                          .outlier_share = 0.2,
                                                          .coverage = coverage,
                                                          .random_shape = k % 2 == 1,
                                                          .scale = k % 3 == 0 ? 1e-3 : 1e3,
                                                          .seed = seed + static_cast<std::uint64_t>(k)});
        const Eigen::VectorXd q = least_squares(points);
        n = static_cast<int>(q.size());
        sum += mahalanobis_per_parameter(points, surface_at(points, q, random));
      }
      const double four_sigma = 4 * std::sqrt(2.0 / (n * sets));
      EXPECT_NEAR(sum / sets, 1, four_sigma) << kind << ", coverage " << coverage << ", seeds from " << seed;
    }
}

// Parameters to a surface and back, under all the names of one surface. The tilts are exact; the rotation
// too.
TEST(SyntheticPoints, TheErrorIsReadBack) {
  PortableRandom random(seed);
  for (const std::string_view kind : kinds)
    for (std::uint64_t k = 0; k < 50; ++k) {
      const SyntheticPoints points = make_points(
          kind, {.count = 10, .sigma = 0.01, .random_shape = true, .scale = 1e100, .seed = seed + k});
      Eigen::VectorXd q(TrueShape(points).parameters());
      for (double& x : q) x = random.uniform(-0.1, 0.1);
      // Offset 10 and products of rotations: some ten roundings of 10.
      EXPECT_LE((parameter_error(points, surface_at(points, q, random)) - q).norm(), 100 * 10 * 0x1p-53)
          << kind << ", seed " << seed + k;
    }
}

// The information again, by another route: moving a surface along (omega, tau) and its parameters shifts it
// at P(u, v) by n . (omega x P + tau + dP/dp) along n. Parameters that the minimal ones do not have are its
// null space: the rank tells.
TEST(SyntheticPoints, TheInformationIsThatOfMovedSurfaces) {
  for (const std::string_view kind : kinds) {
    const SyntheticPoints points = make_points(kind, {.count = 400, .random_shape = true, .seed = seed});
    const TrueShape shape(points);
    const AnySurface& surface = points.truth.surface;  // scale 1
    std::vector<double> values = shape.values;
    const int n = shape.parameters(), m = static_cast<int>(values.size());
    Eigen::MatrixXd moved(points.feet.size(), 6 + m), minimal(points.feet.size(), n);
    for (std::size_t k = 0; k < points.feet.size(); ++k) {
      const Vec3<double> p = from_eigen(points.feet[k]);
      Eigen::Vector3d normal = to_eigen(*surface.implicit_gradient(p)).normalized();
      if (kind == "plane") normal = Eigen::Vector3d::UnitZ();
      moved.row(static_cast<int>(k)).head(3) = points.feet[k].cross(normal);
      moved.row(static_cast<int>(k)).segment(3, 3) = normal;
      for (int j = 0; j < m; ++j) {
        // The change of the implicit distance, by central differences: h^2 and rounding / h, both under 1e-9.
        std::vector<double> more = values, less = values;
        constexpr double h = 1e-5;
        more[static_cast<std::size_t>(j)] += h;
        less[static_cast<std::size_t>(j)] -= h;
        moved(static_cast<int>(k), 6 + j) =
            kind == "plane" ? 0
                            : -(*surface.with(more).implicit(p) - *surface.with(less).implicit(p)) / (2 * h);
      }
      minimal.row(static_cast<int>(k)) =
          distance_and_slope(shape, Eigen::VectorXd::Zero(n), points.feet[k]).second;
    }
    // The same space of shifts: each minimal parameter's is a combination of the moves' and the other way
    // round.
    const auto outside = [](const Eigen::MatrixXd& of, const Eigen::MatrixXd& space) {
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
      qr.setThreshold(1e-7);
      qr.compute(space);
      return (of - space * qr.solve(of)).cwiseAbs().maxCoeff();
    };
    EXPECT_LE(outside(minimal, moved), 1e-7) << kind;
    EXPECT_LE(outside(moved, minimal), 1e-7) << kind;
    EXPECT_EQ((minimal.transpose() * minimal).fullPivLu().rank(), n) << kind;
    EXPECT_NEAR((minimal.transpose() * minimal - unit_information(points)).norm(), 0, 1e-9) << kind;
  }
}

// As many points in each of 16 parts of the covered chart as its share of the area, by an integral over a
// fine grid: chi squared with at most 15 degrees of freedom, beyond 50 once in 10^5.
TEST(SyntheticPoints, FeetAreUniformByArea) {
  for (const std::string_view kind : kinds)
    for (const double coverage : {1.0, 0.25}) {
      const SyntheticPoints points = make_points(
          kind, {.count = 20000, .coverage = coverage, .random_shape = true, .with_uv = true, .seed = seed});
      double u0 = INFINITY, u1 = -INFINITY, v0 = INFINITY, v1 = -INFINITY;
      for (const auto& uv : points.cloud.uvs) {
        u0 = std::min(u0, uv.x), u1 = std::max(u1, uv.x), v0 = std::min(v0, uv.y), v1 = std::max(v1, uv.y);
      }
      EXPECT_NEAR((u1 - u0) * (v1 - v0), coverage * (kind == "cone" ? 0.8 : 1), 0.03) << kind;
      std::array<double, 16> area{}, count{};
      constexpr int cells = 200;
      double whole = 0;
      for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) {
          const Jet2<double> jet = points.truth.surface.jet(u0 + (u1 - u0) * (i + 0.5) / cells,
                                                            v0 + (v1 - v0) * (j + 0.5) / cells);
          const double a = norm(cross(jet.dpdu, jet.dpdv));
          area[static_cast<std::size_t>(4 * (4 * i / cells) + 4 * j / cells)] += a;
          whole += a;
        }
      for (const auto& uv : points.cloud.uvs) {
        const int i = std::min(3, static_cast<int>(4 * (uv.x - u0) / (u1 - u0)));
        const int j = std::min(3, static_cast<int>(4 * (uv.y - v0) / (v1 - v0)));
        count[static_cast<std::size_t>(4 * i + j)] += 1;
      }
      double chi2 = 0;
      for (std::size_t k = 0; k < 16; ++k) {
        const double expected = area[k] / whole * static_cast<double>(points.cloud.uvs.size());
        chi2 += (count[k] - expected) * (count[k] - expected) / expected;
      }
      EXPECT_LE(chi2, 50) << kind << ", coverage " << coverage;
    }
}

// The other half of the points, about the other sphere: its noise (known to 1 / sqrt(2 n), taken four times),
// its feet, and errors in the judge's units.
TEST(SyntheticPoints, TheSecondSurfaceIsATruthToo) {
  for (const std::string_view kind : {"sphere", "ellipsoid"}) {
    const SyntheticPoints points = make_points(kind, {.count = 2000,
                                                      .sigma = 1e-3,
                                                      .outlier_share = 0.5,
                                                      .outlier_pattern = OutlierPattern::second_surface,
                                                      .scale = 3,
                                                      .seed = seed});
    const SyntheticPoints second = with_second_as_truth(points, kind);
    ASSERT_EQ(second.feet.size(), 1000U);
    double sum = 0;
    for (std::size_t k = 0; k < 2000; ++k) {
      ASSERT_NE(second.is_inlier[k], points.is_inlier[k]);
      if (!second.is_inlier[k]) continue;
      const Eigen::Vector3d p = second.truth.placement.inverse() * to_eigen(points.cloud.positions[k]);
      sum += std::pow(p.norm() - 3 * second_radius, 2);
    }
    EXPECT_NEAR(std::sqrt(sum / 1000) / points.sigma, 1, 4 / std::sqrt(2000.0)) << kind;
    for (const Eigen::Vector3d& foot : second.feet) EXPECT_NEAR(foot.norm(), second_radius, 1e-15);
    EXPECT_LT(mahalanobis_per_parameter(second, second.truth), 1e-20) << kind;
    EXPECT_GT(mahalanobis_per_parameter(second, points.truth), 1e3) << kind;
    EXPECT_GT(mahalanobis_per_parameter(points, second.truth), 1e3) << kind;
  }
}

// Counts, flags, the noise (its standard deviation is known to 1 / sqrt(2 n) = 0.4 %, taken four times), the
// box.
TEST(SyntheticPoints, NoiseAndOutliersAreAsAsked) {
  for (const std::string_view kind : kinds) {
    const SyntheticPoints points = make_points(kind, {.count = 40000,
                                                      .sigma = 1e-3,
                                                      .outlier_share = 0.25,
                                                      .with_uv = true,
                                                      .uv_convention = 3,
                                                      .seed = seed});
    ASSERT_EQ(points.cloud.positions.size(), 40000U);
    ASSERT_EQ(points.feet.size(), 30000U);
    double sum = 0, first_half = 0;
    std::size_t inliers = 0;
    Eigen::AlignedBox3d feet, all;
    Eigen::Vector3d outliers = Eigen::Vector3d::Zero();
    for (const auto& foot : points.feet) feet.extend(points.truth.placement * foot);
    for (std::size_t k = 0; k < points.is_inlier.size(); ++k) {
      const Eigen::Vector3d p = to_eigen(points.cloud.positions[k]);
      if (points.is_inlier[k]) {
        sum += (p - to_eigen(points.truth.position(points.cloud.uvs[k]))).squaredNorm() / 3;
        ++inliers;
        if (k < 20000) ++first_half;
      } else {
        all.extend(p);
        outliers += p;
      }
    }
    EXPECT_EQ(inliers, 30000U);
    EXPECT_NEAR(first_half, 15000, 4 * std::sqrt(40000 * 0.25 * 0.75) / 2) << "not shuffled";
    EXPECT_NEAR(std::sqrt(sum / 30000) / points.sigma, 1, 4 / std::sqrt(6.0 * 30000)) << kind;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(all.sizes()[k] / std::max(feet.sizes()[k], feet.sizes().maxCoeff() / 3), 1.25, 0.01)
          << kind;
      EXPECT_NEAR(outliers[k] / 10000, feet.center()[k], 4 * all.sizes()[k] / std::sqrt(12 * 10000.0))
          << kind;
    }
  }
}

// The true frame under every name of a surface, against the catalogue's frame of the surface so named.
TEST(SyntheticPoints, TheTrueFrameIsTheCatalogues) {
  PortableRandom random(seed);
  for (const std::string_view kind : kinds)
    for (std::uint64_t k = 0; k < 40; ++k) {
      const SyntheticPoints points =
          make_points(kind, {.count = 1, .random_shape = true, .scale = 1e3, .seed = seed + k});
      const PlacedSurface named =
          surface_at(points, Eigen::VectorXd::Zero(TrueShape(points).parameters()), random);
      const Eigen::Vector3d at =
          named.placement.inverse() * (points.truth.placement * (points.scale * points.feet[0]));
      const auto over = [&](std::string_view a, double x) { return x / parameter_of(named.surface, a); };
      constexpr double pi = std::numbers::pi;
      double u = std::atan2(at.y(), at.x()) / (2 * pi), v = 0.5;
      if (kind == "ellipsoid") {
        u = std::atan2(over("semi_axis_y", at.y()), over("semi_axis_x", at.x())) / (2 * pi);
        v = std::acos(-over("semi_axis_z", at.z())) / pi;
      } else if (kind == "sphere") {
        v = std::acos(-over("radius", at.z())) / pi;
      } else if (kind == "torus") {
        v = std::atan2(at.z(), std::hypot(at.x(), at.y()) - parameter_of(named.surface, "major_radius")) /
            (2 * pi);
      }
      const Frame<double> frame = named.surface.frame(u, v);
      Eigen::Matrix3d expected, found = true_frame(points, named, points.feet[0]);
      expected << to_eigen(frame.t), to_eigen(frame.b), to_eigen(frame.n);
      expected = named.placement.linear() * expected;
      if (kind == "plane" || kind == "sphere")
        expected.leftCols<2>().setZero(), found.leftCols<2>().setZero();
      // Offset 10 over a size of 0.2: some 50 roundings, ten of them.
      EXPECT_LE((found - expected).norm(), 500 * 0x1p-53) << kind << ", seed " << seed + k;
    }
}

// What the seed promises: the same points from the same seed.
TEST(SyntheticPoints, TheSeedDecides) {
  const auto make = [](std::uint64_t s) {
    return make_points("torus", {.count = 10, .sigma = 0.1, .seed = s}).cloud;
  };
  EXPECT_EQ(make(1).positions, make(1).positions);
  EXPECT_NE(make(1).positions, make(2).positions);
  // Of the generator, by the C++ standard: the 10 000th number of a default std::mt19937_64.
  std::mt19937_64 bits;
  bits.discard(9999);
  EXPECT_EQ(bits(), 9981545732273789042ULL);
}

}  // namespace
}  // namespace darboux::synthetic_points_test
