#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/io.h>
#include <darboux/sample_mesh.h>

#include "random_pose.h"

namespace darboux::assess_test {
namespace {

std::vector<AnySurface> fitted_surfaces() {
  std::vector<AnySurface> list;
  for (const std::string_view kind : fitted_kinds()) list.push_back(make_surface(kind));
  return list;
}

const ClassReport& class_of(const MeshReport& report, VertexClass wanted) {
  for (const ClassReport& c : report.classes)
    if (c.vertex_class == wanted) return c;
  throw std::runtime_error("no such class in the report");
}

std::vector<std::string> errors(const MeshReport& report) {
  std::vector<std::string> codes;
  for (const Finding& f : report.findings)
    if (f.severity == Severity::error) codes.push_back(std::string(f.code) + " " + std::to_string(f.count));
  return codes;
}

// No false finding: exact meshes of every surface pass, in any pose, scale and sign convention.
TEST(Validate, ExactTangentsPass) {
  std::mt19937_64 random(21);
  for (const AnySurface& surface : fitted_surfaces())
    for (const double scale : {1e-6, 1.0, 1e6})
      for (const SignConvention sign : {SignConvention::gltf, SignConvention::raw}) {
        Mesh mesh = sample_mesh(surface, {.columns = 24, .rows = 13, .jitter = 0.25, .sign = sign});
        for (auto& p : mesh.positions) p = scale * p;
        place(mesh, random_pose(random, scale));
        const MeshReport report = assess(mesh).report;
        EXPECT_EQ(report.verdict, Verdict::pass) << surface.info().name << " x " << scale;
        EXPECT_TRUE(errors(report).empty()) << errors(report).front();
        EXPECT_EQ(report.reference, ReferenceKind::analytic);
        EXPECT_EQ(report.handedness.convention,
                  sign == SignConvention::raw ? HandednessConvention::raw : HandednessConvention::gltf);
        EXPECT_EQ(report.handedness.consistent, 1);
        std::size_t corners = 0;
        for (const ClassReport& c : report.classes) {
          corners += c.corners;
          // Positions carry roundings of the offset, 1e-15; tangents near a pole amplify them by the ring's
          // 1/h.
          EXPECT_LE(c.tangent_deg->max, 1e-10);
          EXPECT_LE(c.normal_deg->max, 1e-10);
          // w · cross(n, t) is along dpdv only where the chart is orthogonal.
          const Jet2<double> jet = surface.jet(0.3, 0.4);
          if (std::fabs(dot(unit(jet.dpdu), unit(jet.dpdv))) < 1e-12) {
            EXPECT_LE(c.bitangent_deg->max, 1e-10);
          }
        }
        EXPECT_EQ(corners, mesh.corners());
      }
}

// A known error comes out as itself: tangents turned about the normal by one angle.
TEST(Validate, MeasuresAKnownAngle) {
  for (const double degrees : {0.001, 1.0, 4.9, 60.0, 179.0}) {
    Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 16, .rows = 8});
    for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
      const Eigen::AngleAxisd turn(degrees / 180 * std::numbers::pi, to_eigen(mesh.normals[v]));
      const auto t = from_eigen(turn * to_eigen(mesh.tangents[v].xyz()));
      mesh.tangents[v] = {t.x, t.y, t.z, mesh.tangents[v].w};
    }
    const MeshReport report = assess(mesh).report;
    for (const ClassReport& c : report.classes) {
      EXPECT_NEAR(c.tangent_deg->max, degrees, 1e-11);
      EXPECT_NEAR(c.tangent_deg->rms, degrees, 1e-11);
      EXPECT_NEAR(c.tangent_deg->p95, degrees, 1e-11);
      EXPECT_NEAR(c.bitangent_deg->max, degrees, 1e-11);
      EXPECT_LE(c.normal_deg->max, 1e-11);
    }
    // 5 degrees are permitted in the interior, 15 at the seam.
    EXPECT_EQ(report.verdict, degrees < 5 ? Verdict::pass : Verdict::fail);
  }
}

// Each planted defect is found under its code with its count of corners, and nothing else is.
TEST(Validate, NamesPlantedDefects) {
  const Mesh good = sample_mesh(Torus{1.0, 0.4}, {.columns = 32, .rows = 16});
  constexpr std::size_t v = 33 * 8 + 11;  // an interior vertex: six corners
  const auto t = good.tangents[v];
  struct Case {
    const char* code;
    std::function<void(Mesh&)> plant;
    std::size_t corners = 6;
  };
  const Case cases[] = {
      {"TANGENT_NOT_FINITE", [&](Mesh& m) { m.tangents[v].y = NAN; }},
      {"TANGENT_NOT_FINITE", [&](Mesh& m) { m.tangents[v].w = INFINITY; }},
      {"TANGENT_ZERO",
       [&](Mesh& m) {
         m.tangents[v] = {0, 0, 0, t.w};
       }},
      {"TANGENT_NOT_UNIT",
       [&](Mesh& m) {
         m.tangents[v] = {1.1 * t.x, 1.1 * t.y, 1.1 * t.z, t.w};
       }},
      {"TANGENT_INVALID_SIGN", [&](Mesh& m) { m.tangents[v].w = 0; }},
      {"TANGENT_INVALID_SIGN", [&](Mesh& m) { m.tangents[v].w = 0.5; }},
      {"TANGENT_HANDEDNESS", [&](Mesh& m) { m.tangents[v].w = -t.w; }},
      {"TANGENT_NOT_ORTHOGONAL",
       [&](Mesh& m) {
         const auto leaning = unit(t.xyz() + 0.3 * m.normals[v]);
         m.tangents[v] = {leaning.x, leaning.y, leaning.z, t.w};
       }},
      {"TANGENT_ANGLE",
       [&](Mesh& m) {
         const auto turned = unit(t.xyz() + 0.2 * cross(m.normals[v], t.xyz()));
         m.tangents[v] = {turned.x, turned.y, turned.z, t.w};
       }},
      {"TANGENT_ANGLE",
       [&](Mesh& m) {
         m.tangents[v] = {-t.x, -t.y, -t.z, t.w};
       }},
      {"NORMAL_NOT_FINITE", [&](Mesh& m) { m.normals[v].x = NAN; }},
      {"NORMAL_NOT_UNIT", [&](Mesh& m) { m.normals[v] = 0.5 * m.normals[v]; }},
      // Tilted about the tangent, which stays perpendicular to it.
      {"NORMAL_ANGLE",
       [&](Mesh& m) { m.normals[v] = unit(m.normals[v] + 0.2 * cross(m.normals[v], t.xyz())); }},
      {"POSITION_NOT_FINITE", [&](Mesh& m) { m.positions[v].z = NAN; }},
      {"UV_NOT_FINITE", [&](Mesh& m) { m.uvs[v].x = INFINITY; }},
  };
  for (const Case& c : cases) {
    Mesh mesh = good;
    c.plant(mesh);
    const MeshReport report = assess(mesh).report;
    EXPECT_EQ(errors(report),
              std::vector<std::string>{std::string(c.code) + " " + std::to_string(c.corners)});
    EXPECT_EQ(report.verdict, Verdict::fail) << c.code;
  }
}

TEST(Validate, CountsWhatItCounts) {
  Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 32, .rows = 16});
  constexpr std::size_t v = 33 * 8 + 11;
  mesh.tangents[v] = {0, 0, 0, 1};
  mesh.tangents[v + 2] = {NAN, 0, 0, 1};
  mesh.tangents[v + 4].x *= 3, mesh.tangents[v + 4].y *= 3, mesh.tangents[v + 4].z *= 3;
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({40, 41, 41});
  const MeshReport report = assess(mesh).report;
  EXPECT_EQ(report.zero_tangents, 6u);
  EXPECT_EQ(report.non_finite, 6u);
  EXPECT_EQ(report.non_unit, 6u);
  EXPECT_EQ(report.degenerate_triangles, 2u);
  EXPECT_EQ(report.corners, 3u * 1026u);
  // Zero and non-finite tangents are in `corners`, not in the statistics.
  EXPECT_LE(class_of(report, VertexClass::interior).tangent_deg->max, 1e-10);
}

TEST(Validate, HandednessConventions) {
  Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 32, .rows = 16});
  EXPECT_EQ(assess(mesh).report.handedness.convention, HandednessConvention::gltf);
  // Half of the vertices flipped: mixed, and an error within the one island.
  for (std::size_t v = 0; v < mesh.tangents.size(); v += 2) mesh.tangents[v].w *= -1;
  const MeshReport mixed = assess(mesh).report;
  EXPECT_EQ(mixed.handedness.convention, HandednessConvention::mixed);
  EXPECT_EQ(errors(mixed).size(), 1u);
  EXPECT_EQ(errors(mixed).front().substr(0, 18), "TANGENT_HANDEDNESS");
  // A mirrored mesh has two islands of opposite w, which is right.
  const Mesh mirrored = sample_mesh(Torus{1.0, 0.4}, {.columns = 32, .rows = 16, .mirror = true});
  const MeshReport report = validate(mirrored, std::nullopt);
  EXPECT_EQ(report.handedness.convention, HandednessConvention::gltf);
  EXPECT_EQ(report.handedness.consistent, 1);
  EXPECT_TRUE(errors(report).empty());
}

TEST(Validate, WithoutTruthTheVerdictIsUndetermined) {
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 16, .rows = 9});
  for (auto& p : mesh.positions) p.x += 0.3 * p.z * p.z;  // bent: none that can be fitted
  AssessOptions analytic;
  analytic.references = {.analytic = true, .mikktspace = false, .local = false, .triangles = false};
  EXPECT_EQ(assess(mesh, analytic).report.verdict, Verdict::undetermined);
  EXPECT_EQ(assess(mesh, analytic).report.reference, ReferenceKind::none);
  // Its neighbours tell that the normals are not those of the bent surface: they may be meant so, a warning.
  AssessOptions local;
  local.references = {.analytic = false, .mikktspace = false, .local = true, .triangles = false};
  EXPECT_EQ(assess(mesh, local).report.reference, ReferenceKind::local);
  EXPECT_EQ(assess(mesh, local).report.verdict, Verdict::undetermined);
  EXPECT_TRUE(errors(assess(mesh, local).report).empty());
  EXPECT_EQ(assess(mesh).report.reference, ReferenceKind::triangles);
  mesh.uvs.clear();
  EXPECT_EQ(assess(mesh).report.verdict, Verdict::undetermined);
  // A declared surface that does not fit is an error, and an error fails in any case.
  mesh = sample_mesh(Sphere{1.0}, {.columns = 16, .rows = 9});
  AssessOptions options;
  options.surface = parse_specification("torus");
  const MeshReport mismatch = assess(mesh, options).report;
  EXPECT_EQ(mismatch.verdict, Verdict::fail);
  ASSERT_EQ(errors(mismatch).size(), 1u);
  EXPECT_EQ(errors(mismatch).front().substr(0, 16), "SURFACE_MISMATCH");
  EXPECT_EQ(assess(Mesh{}).report.verdict, Verdict::nothing);
}

TEST(Validate, WithoutTangentsTheNormalsAreAssessed) {
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 16, .rows = 9});
  mesh.tangents.clear();
  EXPECT_EQ(assess(mesh).report.verdict, Verdict::pass);
  EXPECT_EQ(assess(mesh).report.handedness.convention, HandednessConvention::none);
  mesh.normals[40] = unit(mesh.normals[40] + Vec3<double>{0.3, -0.2, 0.4});
  EXPECT_EQ(assess(mesh).report.verdict, Verdict::fail);
  mesh.normals.clear();
  EXPECT_EQ(assess(mesh).report.verdict, Verdict::nothing) << "nothing is stored to compare";
}

TEST(Validate, AnInsideOutMeshIsComparedWithTheInwardNormal) {
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 16, .rows = 9});
  for (auto& n : mesh.normals) n = -n;
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const MeshReport report = assess(mesh).report;
  EXPECT_TRUE(report.inward);
  EXPECT_EQ(report.verdict, Verdict::pass);
  EXPECT_LE(class_of(report, VertexClass::interior).normal_deg->max, 1e-12);
}

// A plane has no inside: which way it should face, nobody knows.
TEST(Validate, APlaneFacesEitherWay) {
  Mesh mesh = sample_mesh(make_surface("plane"), {.columns = 4, .rows = 4});
  EXPECT_EQ(assess(mesh).report.inward, 0U);
  for (auto& n : mesh.normals) n = -n;
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(assess(mesh).report.inward, 0U);
}

// Normals alone turned over are wrong, not a mesh seen from inside.
TEST(Validate, InvertedNormalsAreFound) {
  Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 16, .rows = 9});
  for (auto& n : mesh.normals) n = -n;
  const MeshReport report = assess(mesh).report;
  EXPECT_FALSE(report.inward);
  EXPECT_EQ(report.verdict, Verdict::fail);
  ASSERT_EQ(errors(report).size(), 1u);
  EXPECT_EQ(errors(report).front().substr(0, 12), "NORMAL_ANGLE");
  // Vertices that no triangle uses have no vote.
  mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 16, .rows = 9});
  for (std::size_t v = 0; v < 170; ++v) {
    mesh.positions.push_back(mesh.positions[v]);
    mesh.normals.push_back(-mesh.normals[v]);
    mesh.uvs.push_back(mesh.uvs[v]);
    mesh.tangents.push_back(mesh.tangents[v]);
  }
  EXPECT_EQ(assess(mesh).report.verdict, Verdict::pass);
}

// A triangle wound against its normals is found, be it one or all.
TEST(Validate, CountsTrianglesWoundAgainstTheirNormals) {
  Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 16, .rows = 9});
  std::swap(mesh.triangles[7][1], mesh.triangles[7][2]);
  const MeshReport report = assess(mesh).report;
  const auto found = std::find_if(report.findings.begin(), report.findings.end(),
                                  [](const Finding& f) { return f.code == "NORMALS_OPPOSE_WINDING"; });
  ASSERT_NE(found, report.findings.end());
  EXPECT_EQ(found->count, 3u);
}

TEST(Validate, RefusesAnInconsistentMesh) {
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 16, .rows = 9});
  mesh.triangles[3][1] = 100000;
  EXPECT_THROW(assess(mesh), MeshError);
}

// --- meshes made by other tools
// ------------------------------------------------------------------------------

struct Expected {
  const char* file;
  VertexClass vertex_class;
  const char *max, *rms;  // degrees as printed by an independent measurement; "" where none was published
};

std::string printed(double x, const char* like) {  // with as many decimals as `like`
  const std::string_view text(like);
  const std::size_t point = text.find('.');
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.*f",
                point == text.npos ? 0 : static_cast<int>(text.size() - point - 1), x);
  return buffer;
}

class OtherTools : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder))
      GTEST_SKIP() << "SKIPPED: " << folder << " is absent, its meshes are not compared";
  }
  static MeshReport report(const std::string& file, MeshFit* fit = nullptr) {
    const Asset asset = read_asset(folder + file);
    Assessment assessment = assess(asset.primitives.at(0).data);
    if (fit && assessment.fit) *fit = *assessment.fit;
    return assessment.report;
  }
  static inline const std::string folder = std::string(DARBOUX_SHARED) + "/meshes/three/";
};

// The published figures: torus interior and seam, sphere interior, n = 16 and 32, to their printed digits.
TEST_F(OtherTools, StatisticsAgreeWithTheEvidence) {
  using enum VertexClass;
  const Expected table[] = {
      {"torus_016.three.glb", interior, "0.29", "0.19"},
      {"torus_032.three.glb", interior, "0.076", "0.048"},
      {"torus_016.assimp.glb", interior, "0.81", "0.59"},
      {"torus_032.assimp.glb", interior, "0.40", "0.29"},
      {"torus_016.three.glb", seam, "5.6", ""},
      {"torus_032.three.glb", seam, "2.8", ""},
      {"torus_016.mikk.glb", seam, "5.6", ""},
      {"torus_032.mikk.glb", seam, "2.8", ""},
      {"sphere_016.three.glb", interior, "0.82", "0.39"},
      {"sphere_032.three.glb", interior, "0.45", "0.16"},
      {"sphere_016.assimp.glb", interior, "0.74", "0.50"},
      {"sphere_032.assimp.glb", interior, "0.39", "0.27"},
      {"jittertorus_016.mikk.glb", interior, "1.7", "0.50"},
  };
  for (const Expected& e : table) {
    const Statistics s = *class_of(report(e.file), e.vertex_class).tangent_deg;
    EXPECT_EQ(printed(s.max, e.max), e.max) << e.file;
    if (*e.rms) {
      EXPECT_EQ(printed(s.rms, e.rms), e.rms) << e.file;
    }
  }
  // MikkTSpace is exact inside a regular grid of a surface of revolution, to float rounding.
  for (const char* file :
       {"torus_016.mikk.glb", "torus_032.mikk.glb", "sphere_016.mikk.glb", "sphere_032.mikk.glb"})
    EXPECT_LT(class_of(report(file), interior).tangent_deg->max, 1e-4) << file;
}

TEST_F(OtherTools, SurfaceAndConventionAreRecognised) {
  struct Case {
    std::string shape;
    std::vector<double> parameters;
  };
  for (const Case& c : {Case{"torus", {1, 0.4}}, Case{"sphere", {1}}, Case{"cylinder", {1, 2}}})
    for (const char* size : {"_016", "_032"})
      for (const char* tool : {".three.glb", ".mikk.glb", ".assimp.glb", ".none.glb"}) {
        const std::string file = c.shape + size + tool;
        MeshFit fit{{}, {Sphere{1.0}}};
        const MeshReport r = report(file, &fit);
        ASSERT_TRUE(fit.fits) << file;
        EXPECT_EQ(fit.surface.surface.info().name, c.shape) << file;
        const auto parameters = fit.surface.surface.parameters();
        for (std::size_t k = 0; k < c.parameters.size(); ++k)
          EXPECT_NEAR(parameters[k].value, c.parameters[k], 1e-6) << file;
        EXPECT_EQ(fit.surface.uv.name, "as stored") << file;
        using enum HandednessConvention;
        const HandednessConvention w = std::string_view(tool) == ".three.glb"  ? raw
                                       : std::string_view(tool) == ".none.glb" ? none
                                                                               : gltf;
        EXPECT_EQ(r.handedness.convention, w) << file;
        EXPECT_EQ(r.verdict, Verdict::pass) << file;
      }
}

TEST_F(OtherTools, GenuineDefectsAreFound) {
  const MeshReport three = report("plainsphere_016.three.glb");
  EXPECT_EQ(three.zero_tangents, 2u);
  EXPECT_EQ(errors(three), std::vector<std::string>{"TANGENT_ZERO 2"});
  const MeshReport assimp = report("plainsphere_016.assimp.glb");
  EXPECT_GT(assimp.zero_tangents, 0u);
  EXPECT_EQ(assimp.verdict, Verdict::fail);
  EXPECT_EQ(report("ellipsoid_016.mikk.glb").verdict, Verdict::pass);
  // A frustum is a cone with an affine v.
  MeshFit frustum{{}, {Sphere{1.0}}};
  EXPECT_EQ(report("cone_016.three.glb", &frustum).verdict, Verdict::pass);
  EXPECT_EQ(frustum.surface.surface.info().name, "cone");
  EXPECT_EQ(frustum.surface.uv.name, "affine");
}

// An independent computation in long double on one file: the torus' tangent straight from atan2 of the
// position, without fit, uv or class code of the library. Vertices strictly inside the uv square are the
// interior of this mesh.
TEST_F(OtherTools, EqualAnIndependentComputation) {
  const Mesh mesh = read_asset(folder + "torus_032.three.glb").primitives.at(0).data;
  long double largest = 0, sum = 0;
  std::size_t corners = 0;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      const auto uv = mesh.uvs[v];
      if (uv.x == 0 || uv.x == 1 || uv.y == 0 || uv.y == 1) continue;
      const long double a = 2 * std::numbers::pi_v<long double> * uv.x;
      const long double tx = -std::sin(a), ty = std::cos(a);
      const auto& t = mesh.tangents[v];
      const long double c = tx * t.x + ty * t.y;
      const long double s = std::hypot(std::hypot(ty * t.z, tx * t.z), tx * t.y - ty * t.x);
      const long double degrees = std::atan2(s, c) * 180 / std::numbers::pi_v<long double>;
      largest = std::max(largest, degrees);
      sum += degrees * degrees;
      ++corners;
    }
  AssessOptions options;
  options.surface = parse_specification("torus:major_radius=1,minor_radius=0.4");
  options.placement = Eigen::Isometry3d::Identity();
  const MeshReport r = assess(mesh, options).report;
  const ClassReport& interior = class_of(r, VertexClass::interior);
  ASSERT_EQ(interior.corners, corners);
  EXPECT_NEAR(interior.tangent_deg->max, static_cast<double>(largest), 1e-6 * static_cast<double>(largest));
  EXPECT_NEAR(interior.tangent_deg->rms,
              static_cast<double>(std::sqrt(sum / static_cast<long double>(corners))),
              1e-6 * interior.tangent_deg->rms);
}

}  // namespace
}  // namespace darboux::assess_test
