// Meshes of several surfaces, surfaces known from their positions alone, and files that other people made.
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/io.h>
#include <darboux/sample_mesh.h>
#include <darboux/vertex_normals.h>

#include "append_mesh.h"
#include "random_pose.h"

namespace darboux::parts_test {
namespace {

bool has(const MeshReport& report, std::string_view code) {
  return std::any_of(report.findings.begin(), report.findings.end(),
                     [&](const Finding& f) { return f.code == code; });
}

const ClassReport& interior_of(const MeshReport& report) {
  for (const ClassReport& c : report.classes)
    if (c.vertex_class == VertexClass::interior) return c;
  throw std::runtime_error("no interior in the report");
}

// A cap z = sqrt(R² - x² - y²) over a square of half side `half`, whose uvs are a turned and scaled
// (x, y); exact frames.
Mesh cap(double radius, double half, double turn) {
  constexpr int n = 16;
  const double c = std::cos(turn) * 3, s = std::sin(turn) * 3;
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = half * (2.0 * i / n - 1), y = half * (2.0 * j / n - 1),
                   z = std::sqrt(radius * radius - x * x - y * y);
      mesh.positions.push_back({x, y, z});
      mesh.normals.push_back({x / radius, y / radius, z / radius});
      mesh.uvs.push_back({c * x + s * y + 0.2, -s * x + c * y - 0.1});
      // (x, y) moves along (cos, sin) with u.
      const Vec3<double> t{std::cos(turn), std::sin(turn), -(x * std::cos(turn) + y * std::sin(turn)) / z};
      mesh.tangents.push_back({unit(t).x, unit(t).y, unit(t).z, -1});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, d = a + n + 1, e = d + 1;
      mesh.triangles.push_back({a, b, e});
      mesh.triangles.push_back({a, e, d});
    }
  return mesh;
}

// The sphere is found by the positions, its tangents by the projection.
TEST(ValidateParts, ACapIsAssessedThroughItsProjection) {
  std::mt19937_64 random(61);
  for (const double turn : {0.0, 0.7, 3.0}) {
    Mesh mesh = cap(0.1, 0.06, turn);
    place(mesh, random_pose(random, 1));
    const Assessment assessment = assess(mesh);
    ASSERT_TRUE(assessment.fit && assessment.fit->fits);
    EXPECT_EQ(assessment.fit->surface.surface.info().name, "sphere");
    EXPECT_NEAR(assessment.fit->surface.surface.parameters()[0].value, 0.1, 1e-12);
    EXPECT_EQ(assessment.fit->chart, UvChart::projected);
    EXPECT_EQ(assessment.report.verdict, Verdict::pass);
    // Positions at distance 1 are rounded by 1e-16, a thousandth of the cap's 0.1 in a thousandth of a
    // radian.
    EXPECT_LT(interior_of(assessment.report).normal_deg->max, 1e-9);
    EXPECT_LT(interior_of(assessment.report).tangent_deg->max, 1e-9);
    EXPECT_LT(assessment.report.tangent_uncertainty_deg.max(), 1e-9);
    // A tangent turned by 6 degrees is found.
    const auto wrong =
        unit(mesh.tangents[140].xyz() + 0.105 * cross(mesh.normals[140], mesh.tangents[140].xyz()));
    mesh.tangents[140] = {wrong.x, wrong.y, wrong.z, mesh.tangents[140].w};
    const MeshReport report = assess(mesh).report;
    EXPECT_TRUE(has(report, "TANGENT_ANGLE"));
    EXPECT_NEAR(interior_of(report).tangent_deg->max, std::atan(0.105) * 180 / std::numbers::pi, 1e-6);
  }
}

// Two halves of a sphere under one projection along its axis: at their rim, seen from the side, the tangent's
// limit is one for the upper half and the opposite for the lower.
TEST(ValidateParts, ARimSeenFromTheSideHasNoTangent) {
  std::mt19937_64 random(62);
  constexpr std::uint32_t rings = 8, columns = 32;
  for (int k = 0; k < 4; ++k) {
    Mesh mesh;
    for (const double side : {1.0, -1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (std::uint32_t j = 0; j <= rings; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
          const double a = 2 * std::numbers::pi * i / columns, b = std::numbers::pi / 2 * j / rings,
                       x = std::sin(b) * std::cos(a), y = std::sin(b) * std::sin(a),
                       z = j == rings ? 0 : side * std::cos(b);
          mesh.positions.push_back({x, y, z});
          mesh.normals.push_back({x, y, z});
          mesh.uvs.push_back({x, y});
          const Vec3<double> t =
              j < rings ? unit(Vec3<double>{1, 0, -x / z}) : Vec3<double>{0, 0, x > 0 ? -side : side};
          mesh.tangents.push_back({t.x, t.y, t.z, side});
        }
      for (std::uint32_t j = 0; j < rings; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
          const std::uint32_t next = (i + 1) % columns, p = first + j * columns + i,
                              q = first + j * columns + next;
          for (Triangle t : {Triangle{p, p + columns, q + columns}, Triangle{p, q + columns, q}}) {
            if (side < 0) std::swap(t[1], t[2]);
            mesh.triangles.push_back(t);
          }
        }
    }
    place(mesh, random_pose(random, 1));
    // Roundings of a unit sphere's positions: none, those of floats, and of floats far away.
    const double far = k == 3 ? 1e4 : 0;
    if (k > 0)
      for (Vec3<double>& p : mesh.positions) p = {float(p.x + far), float(p.y), float(p.z)};
    const Assessment assessment = assess(mesh);
    ASSERT_TRUE(assessment.fit && assessment.fit->fits);
    EXPECT_EQ(assessment.fit->chart, UvChart::projected);
    EXPECT_FALSE(has(assessment.report, "TANGENT_ANGLE"));
    EXPECT_LT(interior_of(assessment.report).tangent_deg->max, k == 3 ? 1 : 1e-3);
    // One a ring inside is known.
    const std::size_t inside = (rings - 1) * columns + 3;
    const Vec3<double> t = cross(mesh.normals[inside], mesh.tangents[inside].xyz());
    mesh.tangents[inside] = {t.x, t.y, t.z, mesh.tangents[inside].w};
    EXPECT_TRUE(has(assess(mesh).report, "TANGENT_ANGLE"));
  }
}

// Other uvs on a known surface: normals are the surface's, of tangents it knows nothing.
TEST(ValidateParts, UnknownUvsOnAKnownSurface) {
  Mesh mesh = sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.4"), {.columns = 64, .rows = 32});
  for (Vec2<double>& uv : mesh.uvs) uv = {uv.x + 0.05 * std::sin(6 * uv.y), uv.y + 0.04 * uv.x * uv.x};
  mesh.tangents.clear();
  const Assessment assessment = assess(mesh);
  ASSERT_TRUE(assessment.fit && assessment.fit->fits);
  EXPECT_EQ(assessment.fit->chart, UvChart::unknown);
  EXPECT_EQ(assessment.report.reference, ReferenceKind::analytic);
  EXPECT_LT(interior_of(assessment.report).normal_deg->max, 1e-9);
  EXPECT_EQ(assessment.report.verdict, Verdict::pass);
  EXPECT_EQ(assessment.report.tangent_uncertainty_deg.finite(), 0u);
}

// Of a file with many meshes: shapes that repeat are searched once, and after a dozen the others briefly.
TEST(ValidateParts, MeshesShareWhatWasSearchedInVain) {
  SearchHistory history;
  AssessOptions options;
  options.history = &history;
  const auto bent = [](double by) {
    Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 16, .rows = 8});
    for (Vec3<double>& p : mesh.positions)
      p = p + Vec3<double>{by * p.y * p.y, 0.12 * p.z * p.x, 0.15 * p.x * p.y};
    mesh.normals = vertex_normals(mesh, NormalWeight::angle);
    mesh.tangents.clear();
    return mesh;
  };
  const auto is_brief = [](const std::vector<Assessment>& assessments) {
    return has(assessments.front().report, "PARTS_IN_BRIEF");
  };
  for (int k = 0; k < 12; ++k) {
    const std::size_t before = history.failed.size();
    if (before >= 12) break;
    EXPECT_FALSE(is_brief(assess_parts(bent(0.1 + 0.02 * k), options))) << k;
    EXPECT_GT(history.failed.size(), before) << k;
    const std::size_t after = history.failed.size();
    assess_parts(bent(0.1 + 0.02 * k), options);
    EXPECT_EQ(history.failed.size(), after) << k;
  }
  EXPECT_TRUE(is_brief(assess_parts(bent(0.5), options)));
  EXPECT_FALSE(is_brief(assess_parts(bent(0.5))));
  // What is found in brief is found.
  const std::vector<Assessment> torus = assess_parts(sample_mesh(make_surface("torus"), {}), options);
  EXPECT_TRUE(torus.front().fit && torus.front().fit->fits);
}

// A placement that is given with a surface is that surface's; other parts lie where they lie.
TEST(ValidateParts, APlacementIsTheDeclaredSurfaces) {
  std::mt19937_64 random(63);
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16});
  Mesh other = cap(0.3, 0.2, 0.4);
  place(other, random_pose(random, 3));
  append(mesh, other);
  AssessOptions options;
  options.surface = parse_specification("torus");
  options.placement = Eigen::Isometry3d::Identity();
  for (const bool there : {true, false}) {
    if (!there) options.placement->translation().x() = 1;
    const std::vector<Assessment> assessments = assess_parts(mesh, options);
    if (!there) {
      ASSERT_EQ(assessments.size(), 1u);
      EXPECT_TRUE(has(assessments[0].report, "SURFACE_MISMATCH"));
      continue;
    }
    ASSERT_EQ(assessments.size(), 2u);
    EXPECT_EQ(assessments[0].fit->surface.surface.info().name, "torus");
    EXPECT_EQ(assessments[1].fit->surface.surface.info().name, "sphere");
    for (const Assessment& j : assessments) EXPECT_EQ(j.report.verdict, Verdict::pass);
  }
}

// A torus, two caps and a plane in one mesh: each is itself, corners add up, and what is wrong in one is
// found there.
TEST(ValidateParts, EachSurfaceOfAMeshIsItself) {
  std::mt19937_64 random(62);
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16});
  for (const double turn : {0.4, 2.0}) {
    Mesh one = cap(0.3, 0.2, turn);
    place(one, random_pose(random, 3));
    append(mesh, one);
  }
  append(mesh, sample_mesh(make_surface("plane"), {.columns = 8, .rows = 8}));
  const std::size_t of_cap = 33 * 17 + 17 * 8 + 8;  // a vertex inside the first cap
  std::vector<Assessment> assessments = assess_parts(mesh);
  ASSERT_EQ(assessments.size(), 4u);
  std::size_t corners = 0;
  const char* names[] = {"torus", "sphere", "sphere", "plane"};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(assessments[k].part, k);
    ASSERT_TRUE(assessments[k].fit && assessments[k].fit->fits) << k;
    EXPECT_EQ(assessments[k].fit->surface.surface.info().name, names[k]);
    EXPECT_EQ(assessments[k].report.verdict, Verdict::pass) << k;
    corners += assessments[k].report.corners;
  }
  EXPECT_EQ(corners, mesh.corners());
  mesh.normals[of_cap] = unit(mesh.normals[of_cap] + Vec3<double>{0.3, -0.2, 0.1});
  assessments = assess_parts(mesh);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(assessments[k].report.verdict, k == 1 ? Verdict::fail : Verdict::pass) << k;
  ASSERT_TRUE(interior_of(assessments[1].report).worst.has_value());
  EXPECT_GT(interior_of(assessments[1].report).normal_deg->max, 5);
  // A declared surface holds where it fits; the others are recognised.
  AssessOptions options;
  options.surface = parse_specification("torus");
  EXPECT_EQ(assess_parts(mesh, options).size(), 4u);
  options.surface = parse_specification("helicoid");
  assessments = assess_parts(mesh, options);
  ASSERT_EQ(assessments.size(), 1u);
  EXPECT_TRUE(has(assessments[0].report, "SURFACE_MISMATCH"));
}

// A box whose corners share vertices between faces: sharp edges cut it, and the shared vertices are not
// assessed.
TEST(ValidateParts, SharpEdgesWithSharedVertices) {
  Mesh mesh = sample_mesh(make_surface("plane"), {.columns = 8, .rows = 8});
  // The right half folded down along x = 0; its vertices stay shared.
  for (auto& p : mesh.positions)
    if (p.x > 0) p = {0, p.y, -p.x};
  const std::vector<Assessment> assessments = assess_parts(mesh);
  ASSERT_EQ(assessments.size(), 2u);
  ASSERT_TRUE(assessments[0].fit && assessments[0].fit->fits);
  EXPECT_EQ(assessments[0].fit->surface.surface.info().name, "plane");
  EXPECT_TRUE(has(assessments[0].report, "CREASE_SHARED"));
  EXPECT_EQ(assessments[0].report.verdict, Verdict::pass);
  EXPECT_FALSE(assessments[1].fit && assessments[1].fit->fits)
      << "normals that were not folded are not a plane's";
  EXPECT_TRUE(has(assessments[1].report, "NORMAL_ANGLE"));
  EXPECT_EQ(assessments[1].report.verdict, Verdict::fail);
}

// More parts than anybody would read: one assessment, that says so.
TEST(ValidateParts, ManyPartsAreNotLookedAt) {
  Mesh mesh;
  std::mt19937_64 random(63);
  for (int k = 0; k < 257; ++k) {
    Mesh one = sample_mesh(make_surface("plane"), {.columns = 1, .rows = 1});
    place(one, random_pose(random, 9));
    append(mesh, one);
  }
  const std::vector<Assessment> assessments = assess_parts(mesh);
  ASSERT_EQ(assessments.size(), 1u);
  EXPECT_TRUE(has(assessments[0].report, "PARTS_TOO_MANY"));
}

// ---- files of others --------------------------------------------------------------------------------------

class OtherPeople : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder))
      GTEST_SKIP() << "SKIPPED: " << folder << " is absent, its meshes are not judged";
  }
  static std::vector<Assessment> assessed(const std::string& file) {
    return assess_parts(read_asset(folder + file).primitives.at(0).data);
  }
  static inline const std::string folder = std::string(DARBOUX_SHARED) + "/meshes/";
};

TEST_F(OtherPeople, MirrorTestFollowsMikkTSpaceAndItsCapsAreSpheres) {
  std::map<std::string, int> kinds;
  double equal = 0, corners = 0;
  for (const Assessment& j : assessed("khronos/NormalTangentMirrorTest.glb")) {
    EXPECT_EQ(j.report.verdict, Verdict::pass);
    EXPECT_EQ(j.report.handedness.convention, HandednessConvention::gltf);
    ASSERT_TRUE(j.report.mikktspace.has_value());
    for (const ClassReport& c : j.report.mikktspace->classes) {
      ASSERT_TRUE(c.tangent_deg.has_value());
      EXPECT_LT(c.tangent_deg->max, 0.003);  // the evidence prints .0029
    }
    equal += j.report.mikktspace->equal_bits * static_cast<double>(j.report.corners);
    corners += static_cast<double>(j.report.corners);
    if (!j.fit || !j.fit->fits) continue;  // the frames about the caps
    ++kinds[std::string(j.fit->surface.surface.info().name)];
    EXPECT_NEAR(j.fit->surface.surface.parameters()[0].value, 0.1, 1e-5);
    EXPECT_EQ(j.fit->chart, UvChart::projected);
    // The evidence: T 0.34 max, 0.23 rms; normals 0.34, 0.28, each over all caps and other classes.
    EXPECT_NEAR(interior_of(j.report).tangent_deg->max, 0.34, 0.01);
    EXPECT_NEAR(interior_of(j.report).tangent_deg->rms, 0.23, 0.02);
    EXPECT_NEAR(interior_of(j.report).normal_deg->max, 0.34, 0.01);
    EXPECT_NEAR(interior_of(j.report).normal_deg->rms, 0.27, 0.02);
  }
  EXPECT_EQ(kinds["sphere"], 10);
  EXPECT_EQ(corners, 15720);
  std::cout << "equal bits " << equal / corners << '\n';
}

TEST_F(OtherPeople, DefectsOfSampleModels) {
  for (const Assessment& j : assessed("khronos/AnimatedMorphSphere.glb")) {
    EXPECT_EQ(j.report.verdict, Verdict::fail);
    EXPECT_TRUE(has(j.report, "TANGENT_NOT_ORTHOGONAL"));
  }
  const std::vector<Assessment> suzanne = assessed("khronos/Suzanne_geometry.glb");
  ASSERT_EQ(suzanne.size(), 1u);
  EXPECT_TRUE(has(suzanne[0].report, "TANGENT_HANDEDNESS_CONVENTION"));
  EXPECT_TRUE(has(suzanne[0].report, "TANGENT_NOT_MIKKTSPACE"));
  EXPECT_TRUE(has(suzanne[0].report, "TANGENT_NOT_ORTHOGONAL"));
  EXPECT_FALSE(has(suzanne[0].report, "TANGENT_STALE"));
  EXPECT_EQ(suzanne[0].report.mikktspace->equal_bits, 0);
}

TEST_F(OtherPeople, ACappedCylinderIsOneAndTwoDisks) {
  std::map<std::string, int> kinds;
  for (const Assessment& j : assessed("three/capped_016.three.glb")) {
    ASSERT_TRUE(j.fit && j.fit->fits);
    ++kinds[std::string(j.fit->surface.surface.info().name)];
    EXPECT_EQ(j.report.verdict, Verdict::pass);
  }
  EXPECT_EQ(kinds["cylinder"], 1);
  EXPECT_EQ(kinds["plane"], 2);
}

}  // namespace
}  // namespace darboux::parts_test
