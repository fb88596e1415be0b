// What the fit does not know: beside the error, and never taken for one. Local jets as a second reference.
#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/error.h>
#include <darboux/local_truth.h>
#include <darboux/sample_mesh.h>

#include "random_pose.h"
#include "refusal_of.h"

namespace darboux::uncertainty_test {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

double angle_deg(const Vec3<double>& a, const Vec3<double>& b) {
  return degrees * std::atan2(norm(cross(a, b)), dot(a, b));
}

void add_noise(Mesh& mesh, double sigma, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, sigma);
  for (auto& p : mesh.positions) p = p + Vec3<double>{normal(random), normal(random), normal(random)};
}

// Tangents turned about the normals by one angle.
void turn_tangents(Mesh& mesh, double angle) {
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    const Eigen::AngleAxisd turn(angle / degrees, to_eigen(mesh.normals[v]));
    const auto t = from_eigen(turn * to_eigen(mesh.tangents[v].xyz()));
    mesh.tangents[v] = {t.x, t.y, t.z, mesh.tangents[v].w};
  }
}

std::size_t count_of(const MeshReport& report, std::string_view code) {
  for (const Finding& f : report.findings)
    if (f.code == code) return f.count;
  return 0;
}

const ClassReport& interior_of(const std::vector<ClassReport>& classes) {
  for (const ClassReport& c : classes)
    if (c.vertex_class == VertexClass::interior) return c;
  throw std::runtime_error("no interior in the report");
}

// Of noisy meshes: real errors of the fitted normals and tangents in units of the stated ones, squared, over
// seeds.
struct Ratio {
  double normal = 0, tangent = 0;
};
Ratio measured_ratio(const std::string& surface, const std::array<double, 6>& of_stored, double sigma,
                     int fits, std::mt19937_64& random) {
  Ratio sum;
  const UvConvention convention{"", of_stored};
  Eigen::Matrix2d m;
  m << of_stored[0], of_stored[1], of_stored[2], of_stored[3];
  for (int run = 0; run < fits; ++run) {
    const PlacedSurface real{make_surface(surface), random_pose(random, 1), convention};
    Mesh mesh = sample_mesh(real.surface, {.columns = 20, .rows = 12});
    for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
      const Eigen::Vector2d stored =
          m.inverse() * Eigen::Vector2d(mesh.uvs[v].x - of_stored[4], mesh.uvs[v].y - of_stored[5]);
      mesh.uvs[v] = {stored.x(), stored.y()};
      mesh.positions[v] = real.position(mesh.uvs[v]);
    }
    add_noise(mesh, sigma, random);
    const MeshFit fit = fit_surface(mesh, {std::string(real.surface.info().name), {}});
    EXPECT_TRUE(fit.fits) << surface;
    if (!fit.fits) return {};
    Ratio here;
    double count = 0;
    for (const auto& uv : mesh.uvs) {
      const Truth found = truth_at(fit, uv), exact = real.truth(uv);
      if (exact.pole || !std::isfinite(found.tangent_deg)) continue;
      here.normal += std::pow(angle_deg(found.normal, exact.normal) / found.normal_deg, 2);
      here.tangent += std::pow(angle_deg(found.tangent, exact.tangent) / found.tangent_deg, 2);
      ++count;
    }
    sum.normal += here.normal / count / fits;
    sum.tangent += here.tangent / count / fits;
  }
  return sum;
}

// An error in units of its stated deviation has mean square 1. Within a fit all vertices share six unknowns
// or more, of which a frame takes at least two independent ones, so that the mean square over n fits strays
// by sqrt(2 / 2n): three of that are permitted.
TEST(ValidateUncertainty, IsTheErrorOfTheFrames) {
  constexpr std::uint64_t seed = 51;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  struct Case {
    std::string surface;
    std::array<double, 6> of_stored;
    double sigma;
    int fits = 60;
  };
  const std::array<double, 6> plain{1, 0, 0, 1, 0, 0}, swapped{0, -1, 1, 0, 1, 0},
      sheared{1, 0.4, 0, 1.3, 0, 0.1}, slanted{1, 0, -0.4, 1.4, 0, -0.15};
  for (const Case& c :
       {Case{"torus", plain, 1e-4}, Case{"torus", swapped, 1e-4}, Case{"sphere", plain, 1e-4},
        Case{"ellipsoid:semi_axis_y=0.7,semi_axis_z=1.5", plain, 1e-4}, Case{"cone", plain, 1e-4},
        Case{"torus", slanted, 1e-6, 20}, Case{"cylinder", sheared, 1e-6, 20}}) {
    const Ratio ratio = measured_ratio(c.surface, c.of_stored, c.sigma, c.fits, random);
    std::cout << c.surface << ": normal " << ratio.normal << ", tangent " << ratio.tangent << '\n';
    const double permitted = 3 * std::sqrt(1.0 / c.fits);
    EXPECT_NEAR(ratio.normal, 1, permitted) << c.surface;
    EXPECT_NEAR(ratio.tangent, 1, permitted) << c.surface;
  }
}

// What is held does not vary: with all held nothing is uncertain.
TEST(ValidateUncertainty, WhatIsHeldIsCertain) {
  std::mt19937_64 random(52);
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 20, .rows = 12});
  add_noise(mesh, 1e-4, random);
  const MeshFit free = fit_surface(mesh, parse_specification("torus"));
  const MeshFit placed = fit_surface(mesh, parse_specification("torus"), Eigen::Isometry3d::Identity());
  const MeshFit held = fit_surface(mesh, parse_specification("torus:major_radius=1,minor_radius=0.25"),
                                   Eigen::Isometry3d::Identity());
  ASSERT_TRUE(free.fits);
  ASSERT_TRUE(placed.fits);
  ASSERT_TRUE(held.fits);
  // 21 * 13 vertices with three coordinates: sigma to sqrt(1 / 2 / 819) = 2.5 %.
  EXPECT_NEAR(free.sigma, 1e-4, 1e-5);
  EXPECT_GT(truth_at(free, {0.3, 0.2}).normal_deg, 0);
  EXPECT_TRUE(placed.covariance.topRows(6).isZero(0));
  EXPECT_GT(placed.covariance(6, 6), 0);
  // The parameters do not turn a torus's frames.
  EXPECT_LT(truth_at(placed, {0.3, 0.2}).normal_deg, 1e-12);
  EXPECT_TRUE(held.covariance.isZero(0));
  EXPECT_EQ(held.covariance.rows(), 8);
}

// A covariance of no numbers, as where squares overflow, tells nothing; it does not tell that all is certain.
TEST(ValidateUncertainty, WhatIsNoNumberIsUnknown) {
  MeshFit fit{{}, {make_surface("torus")}};
  for (const double x : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    fit.covariance = Eigen::MatrixXd::Constant(8, 8, x);
    for (const Truth& truth :
         {truth_at(fit, {0.3, 0.2}), truths_at(fit, std::vector<Vec2<double>>{{0.3, 0.2}})[0]}) {
      EXPECT_EQ(truth.normal_deg, std::numeric_limits<double>::infinity()) << x;
      EXPECT_EQ(truth.tangent_deg, std::numeric_limits<double>::infinity()) << x;
    }
    for (const bool near : {false, true}) {
      PointFit of_points;
      of_points.surface = fit.surface;
      of_points.covariance = fit.covariance;
      const UncertainFrame frame =
          near ? frame_near(of_points, {1.3, 0.2, 0.1}) : frame_at(of_points, {0.3, 0.2});
      EXPECT_EQ(frame.normal_deg, std::numeric_limits<double>::infinity()) << x;
      EXPECT_EQ(frame.tangent_deg, std::numeric_limits<double>::infinity()) << x;
    }
  }
}

// Values come of the surface itself, to the bit; those of many are those of one, whose sizes the compiler
// does not know.
TEST(ValidateUncertainty, OfManyIsThatOfOne) {
  std::mt19937_64 random(53);
  std::cout << "seed 53\n";
  std::normal_distribution<double> normal(0, 1);
  std::vector<Vec2<double>> uvs{{0.3, 0.2},  {0.3, 0},    {0.1, 1},   {0, 0.5},
                                {0.3, 1e-9}, {0.7, 0.25}, {-0.2, 1.1}};
  uvs.push_back({std::nan(""), 0.5});
  const auto root = [&](Eigen::Index n) {
    return Eigen::MatrixXd(1e-3 * Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); }));
  };
  for (const std::string_view kind : fitted_kinds())
    for (const UvConvention& convention : uv_conventions())
      for (const bool map_is_known : {true, false}) {
        MeshFit fit{{}, {make_surface(std::string(kind)), random_pose(random, 2), convention}};
        const auto n = static_cast<Eigen::Index>(fit.surface.surface.parameters().size());
        const Eigen::MatrixXd factor = root(6 + n + (map_is_known ? 0 : 6));
        fit.covariance = factor * factor.transpose();
        const std::vector<Truth> many = truths_at(fit, uvs);
        for (std::size_t i = 0; i < uvs.size(); ++i) {
          SCOPED_TRACE(std::string(kind) + ", " + std::string(convention.name) + ", uv " + std::to_string(i));
          const Truth one = truth_at(fit, uvs[i]), exact = fit.surface.truth(uvs[i]);
          for (const Truth* other : {&many[i], &exact}) {
            const auto same = [](const Vec3<double>& a, const Vec3<double>& b) {
              return a == b || (!detail::finite(a) && !detail::finite(b));
            };
            EXPECT_TRUE(same(one.position, other->position) && same(one.normal, other->normal) &&
                        same(one.tangent, other->tangent) && same(one.bitangent, other->bitangent));
            EXPECT_EQ(one.status, other->status);
            EXPECT_EQ(one.pole, other->pole);
          }
          // Sums of the same products, perhaps in another order.
          const auto equal = [](double a, double b) { return a == b || std::fabs(a - b) <= 1e-12 * b; };
          EXPECT_TRUE(equal(one.normal_deg, many[i].normal_deg))
              << one.normal_deg << ' ' << many[i].normal_deg;
          EXPECT_TRUE(equal(one.tangent_deg, many[i].tangent_deg))
              << one.tangent_deg << ' ' << many[i].tangent_deg;
        }
      }
}

// A covariance of another surface is refused, also where nobody asks for a point.
TEST(ValidateUncertainty, CovariancesOfAnotherSizeAreRefused) {
  MeshFit fit{{}, {make_surface("torus")}};
  for (const Eigen::Index n : {0, 7, 13, 20}) {
    fit.covariance = Eigen::MatrixXd::Zero(n, n);
    EXPECT_REFUSED(truths_at(fit, {}),
                   "fit: expected a covariance of 8 rows, or 6 more, for a torus, got " + std::to_string(n));
    EXPECT_REFUSED(truth_at(fit, {0.3, 0.2}),
                   "fit: expected a covariance of 8 rows, or 6 more, for a torus, got " + std::to_string(n));
  }
}

// On both sides of each border, by a hundredth of the deviation.
TEST(ValidateUncertainty, DecidesWhatItCan) {
  const AnySurface torus = make_surface("torus");
  constexpr double limit = 1, s = 0.1;
  struct Case {
    double angle;
    const char* finding;
    Verdict verdict;
  };
  for (const Case& c : {Case{limit + 3.01 * s, "TANGENT_ANGLE", Verdict::fail},
                        Case{limit + 2.99 * s, "REFERENCE_UNCERTAIN", Verdict::pass},
                        Case{limit - 2.99 * s, "REFERENCE_UNCERTAIN", Verdict::pass},
                        Case{limit - 3.01 * s, "", Verdict::pass}}) {
    Mesh mesh = sample_mesh(torus, {.columns = 16, .rows = 8});
    std::vector<Truth> truth;
    for (const auto& uv : mesh.uvs) {
      truth.push_back(PlacedSurface{torus}.truth(uv));
      truth.back().tangent_deg = s;
    }
    turn_tangents(mesh, c.angle);
    const MeshReport report = validate(mesh, truth, {.max_angle_deg = limit});
    EXPECT_EQ(report.verdict, c.verdict) << c.angle;
    const ClassReport& interior = interior_of(report.classes);
    for (const char* code : {"TANGENT_ANGLE", "REFERENCE_UNCERTAIN"})
      EXPECT_EQ(count_of(report, code), std::string(c.finding) == code ? interior.corners : 0) << c.angle;
    EXPECT_EQ(interior.tangent_uncertainty_deg.max(), s);
    EXPECT_EQ(interior.normal_uncertainty_deg.max(), 0);
    EXPECT_NEAR(report.tangent_uncertainty_deg.rms(), s, 1e-14);
  }
  EXPECT_THROW(validate(sample_mesh(torus, {}), std::vector<Truth>(3)), MeshError);
}

// A noisy torus, tangents off by more than permitted, but by less than the fit knows.
TEST(ValidateUncertainty, AnErrorBelowTheUncertaintyIsNoFinding) {
  constexpr std::uint64_t seed = 53;
  std::mt19937_64 random(seed);
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 8, .rows = 6});
  place(mesh, random_pose(random, 1));
  add_noise(mesh, 1e-4, random);
  AssessOptions options;
  options.surface = parse_specification("torus");  // six rows are too few to be recognised
  const MeshReport exact = assess(mesh, options).report;
  EXPECT_EQ(exact.verdict, Verdict::pass);
  const double s = exact.tangent_uncertainty_deg.rms();
  EXPECT_GT(s, 1e-4);
  options.max_angle_deg = s;
  options.references.triangles = false;  // they know floats to far less
  Mesh below = mesh, above = mesh;
  turn_tangents(below, 2 * s);
  turn_tangents(above,
                10 * s);  // limit 1, rule 3, its variation over the torus, and up to 5 of the fit's own error
  const MeshReport quiet = assess(below, options).report, loud = assess(above, options).report;
  const ClassReport& interior = interior_of(quiet.classes);
  EXPECT_GT(interior.tangent_deg->rms, options.max_angle_deg) << "seed " << seed << ": nothing to tell";
  EXPECT_EQ(count_of(quiet, "TANGENT_ANGLE"), 0u) << "seed " << seed;
  EXPECT_GT(2 * count_of(quiet, "REFERENCE_UNCERTAIN"), interior.corners);
  EXPECT_NE(quiet.verdict, Verdict::fail);
  EXPECT_GT(count_of(loud, "TANGENT_ANGLE"), 0u);
  EXPECT_EQ(loud.verdict, Verdict::fail);
}

// Files hold floats: the truth is then known to about 1e-6 degrees, and no verdict changes.
TEST(ValidateUncertainty, ExactMeshesAreKnownToRounding) {
  std::mt19937_64 random(54);
  for (const std::string_view kind : fitted_kinds()) {
    Mesh mesh = sample_mesh(make_surface(kind), {.columns = 24, .rows = 13});
    place(mesh, random_pose(random, 1));
    for (auto& p : mesh.positions) p = {float(p.x), float(p.y), float(p.z)};
    const MeshReport report = assess(mesh).report;
    EXPECT_EQ(report.verdict, Verdict::pass) << kind;
    const ClassReport& interior = interior_of(report.classes);
    EXPECT_LT(interior.normal_uncertainty_deg.max(), 1e-4) << kind;
    EXPECT_LT(interior.tangent_uncertainty_deg.max(), 1e-4) << kind;
    EXPECT_GT(interior.normal_uncertainty_deg.max() + interior.tangent_uncertainty_deg.max(), 0) << kind;
    // Nobody can tell whether a disk has a hole of 1e-8 or a pole: its middle counts as a pole.
    EXPECT_EQ(count_of(report, "REFERENCE_UNCERTAIN"), 0u) << kind;
  }
}

// Twice the error bars of local jets hold 95 % of their errors, or 88 % where the mesh is coarse; three times
// as much more.
TEST(ValidateUncertainty, LocalJetsAgreeWithTheSurface) {
  std::mt19937_64 random(55);
  for (const std::string kind : {"sphere", "torus", "ellipsoid:semi_axis_y=0.7,semi_axis_z=1.5"})
    for (const int columns : {32, 64})
      for (const double jitter : {0.0, 0.2})
        for (const double noise : {0.0, 1e-4}) {
          Mesh mesh =
              sample_mesh(make_surface(kind), {.columns = columns, .rows = columns / 2, .jitter = jitter});
          place(mesh, random_pose(random, 1));
          add_noise(mesh, noise, random);
          AssessOptions options;
          const MeshReport report = assess(mesh, options).report;
          ASSERT_TRUE(report.local.has_value());
          std::cout << kind << " " << columns << " jitter " << jitter << " noise " << noise << ": "
                    << report.local->agreement << " of " << report.local->compared << ", uncertain "
                    << interior_of(report.local->classes).normal_uncertainty_deg.rms() << " "
                    << interior_of(report.local->classes).tangent_uncertainty_deg.rms() << ", error "
                    << interior_of(report.local->classes).normal_deg->rms << " "
                    << interior_of(report.local->classes).tangent_deg->rms << '\n';
          EXPECT_GE(report.local->agreement, 0.93);
          EXPECT_EQ(count_of(report, "REFERENCES_DISAGREE"), 0u);
          EXPECT_GE(report.local->compared, interior_of(report.classes).corners * 9 / 10);
        }
}

// A surface declared with uvs that mean something else; and one that is a torus but for ripples too low to
// see.
TEST(ValidateUncertainty, LocalJetsContradictAWrongSurface) {
  const AnySurface torus = make_surface("torus");
  Mesh mesh = sample_mesh(torus, {.columns = 48, .rows = 24});
  ValidateOptions options;
  EXPECT_EQ(count_of(validate(mesh, PlacedSurface{torus}, options), "REFERENCES_DISAGREE"), 0u);
  const PlacedSurface sheared{torus, Eigen::Isometry3d::Identity(), {"affine", {1, 0, 0.2, 1, 0, 0}}};
  const MeshReport wrong = validate(mesh, sheared, options);
  EXPECT_LT(wrong.local->agreement, 0.05);
  EXPECT_EQ(count_of(wrong, "REFERENCES_DISAGREE"), interior_of(wrong.classes).corners);

  Mesh rippled = sample_mesh(torus, {.columns = 60, .rows = 300});
  for (std::size_t v = 0; v < rippled.positions.size(); ++v) {
    const double height = 4e-4 * std::sin(2 * std::numbers::pi * 20 * rippled.uvs[v].y);  // slope 0.032
    rippled.positions[v] = rippled.positions[v] + height * rippled.normals[v];
  }
  AssessOptions ask;
  const Assessment assessment = assess(rippled, ask);
  ASSERT_TRUE(assessment.fit && assessment.fit->fits);
  EXPECT_EQ(assessment.report.verdict, Verdict::pass);
  EXPECT_GT(count_of(assessment.report, "REFERENCES_DISAGREE"), 0u) << assessment.report.local->agreement;
  // The rms of 0.032 cos.
  EXPECT_NEAR(interior_of(assessment.report.local->classes).normal_deg->rms, degrees * 0.032 / std::sqrt(2),
              0.1);
}

// Two planes at a right angle, u running on from one to the other; the crease has a vertex of each.
TEST(ValidateUncertainty, LocalTruthOfEachSideOfACrease) {
  Mesh mesh = sample_mesh(make_surface("plane"), {.columns = 8, .rows = 8});
  const std::size_t half = mesh.positions.size();
  for (std::size_t v = 0; v < half; ++v) {
    const Vec3<double> p = mesh.positions[v];
    mesh.positions.push_back({0.5, p.y, -(p.x + 0.5)});
    mesh.normals.push_back({1, 0, 0});
    mesh.tangents.push_back({0, 0, -1, mesh.tangents[v].w});
    mesh.uvs.push_back({0.5 + 0.5 * mesh.uvs[v].x, mesh.uvs[v].y});
    mesh.uvs[v].x *= 0.5;
  }
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    const auto shift = static_cast<std::uint32_t>(half);
    const auto [a, b, c] = mesh.triangles[t];
    mesh.triangles.push_back({a + shift, b + shift, c + shift});
  }
  std::vector<Truth> local = local_truth(mesh);
  for (std::size_t v = 0; v < local.size(); ++v) {
    EXPECT_LT(angle_deg(local[v].normal, mesh.normals[v]), 1e-9) << v;
    EXPECT_LT(angle_deg(local[v].tangent, mesh.tangents[v].xyz()), 1e-9) << v;
  }
  // With one normal the vertices of the crease are joined: nothing is known there, and beside it each side is
  // as it was.
  mesh.normals.clear();
  local = local_truth(mesh);
  for (std::size_t v = 0; v < local.size(); ++v) {
    if (mesh.uvs[v].x == 0.5)
      EXPECT_TRUE(std::isnan(local[v].normal.x)) << v;
    else
      EXPECT_LT(angle_deg(local[v].normal, v < half ? Vec3<double>{0, 0, 1} : Vec3<double>{1, 0, 0}), 1e-9)
          << v;
  }
}

// Each side of a fold and of a seam by itself; nothing where nothing is known.
TEST(ValidateUncertainty, LocalTruthOfParts) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 64, .rows = 32, .mirror = true});
  const std::vector<Truth> local = local_truth(mesh);
  for (std::size_t v = 0; v < local.size(); ++v) {
    ASSERT_TRUE(std::isfinite(local[v].normal_deg)) << v;
    EXPECT_LE(angle_deg(local[v].normal, mesh.normals[v]), 4 * local[v].normal_deg + 1e-9) << v;
    EXPECT_LE(angle_deg(local[v].tangent, mesh.tangents[v].xyz()), 4 * local[v].tangent_deg + 1e-9) << v;
  }
  mesh = sample_mesh(make_surface("torus"), {.columns = 64, .rows = 32});
  mesh.positions[700].x = NAN;
  mesh.uvs[900].y = INFINITY;
  EXPECT_FALSE(std::isfinite(local_truth(mesh)[700].normal.x));
  EXPECT_TRUE(std::isfinite(local_truth(mesh)[701].normal.x));
  const Mesh few = sample_mesh(make_surface("plane"), {.columns = 2, .rows = 2});
  for (const Truth& t : local_truth(few)) EXPECT_TRUE(std::isnan(t.normal.x));
  ValidateOptions options;
  // What the other reference found is not taken for it.
  const MeshReport blind = validate(few, PlacedSurface{make_surface("plane")}, options);
  EXPECT_TRUE(interior_of(blind.classes).normal_deg.has_value());
  ASSERT_TRUE(blind.local.has_value());
  for (const ClassReport& c : blind.local->classes)
    EXPECT_FALSE(c.normal_deg || c.tangent_deg || c.bitangent_deg || c.worst);
  EXPECT_EQ(blind.local->compared, 0u);
  mesh.uvs.clear();
  EXPECT_TRUE(std::isfinite(local_truth(mesh)[701].normal.x));
  EXPECT_TRUE(validate(mesh, std::nullopt, options).local.has_value());
  mesh.normals.clear();
  EXPECT_FALSE(validate(mesh, std::nullopt, options).local.has_value());
}

}  // namespace
}  // namespace darboux::uncertainty_test
