// Meshes that hardly are any, and surfaces that are declared wrongly: a verdict with numbers in it, never a
// crash or a NaN.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/error.h>
#include <darboux/sample_mesh.h>

#include "append_mesh.h"

namespace darboux::exotic_input_test {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

const Finding* finding_of(const MeshReport& report, std::string_view code) {
  const auto found = std::ranges::find(report.findings, code, &Finding::code);
  return found == report.findings.end() ? nullptr : &*found;
}

// ---- what holds of any report

void expect_numbers(const std::vector<ClassReport>& classes, const Mesh& mesh) {
  for (const ClassReport& c : classes) {
    EXPECT_GT(c.corners, 0u);
    for (const auto& s : {c.normal_deg, c.tangent_deg, c.bitangent_deg}) {
      if (!s) continue;
      EXPECT_TRUE(s->max >= 0 && s->max <= 180 * (1 + 1e-15)) << s->max;
      EXPECT_TRUE(s->rms >= 0 && s->rms <= s->max * (1 + 1e-12)) << s->rms;
      EXPECT_TRUE(s->p95 >= 0 && s->p95 <= s->max) << s->p95;
    }
    if (c.worst) {
      EXPECT_LT(c.worst->vertex, mesh.positions.size());
    }
  }
}

void expect_sound(const MeshReport& report, const Mesh& mesh) {
  std::size_t corners = 0;
  for (const ClassReport& c : report.classes) corners += c.corners;
  EXPECT_EQ(corners, report.corners);
  expect_numbers(report.classes, mesh);
  for (const std::size_t count : {report.zero_tangents, report.non_unit, report.non_orthogonal,
                                  report.non_finite, report.handedness.wrong})
    EXPECT_LE(count, report.corners);
  EXPECT_LE(3 * (report.degenerate_triangles + report.degenerate_uv_triangles), report.corners);
  EXPECT_TRUE(report.handedness.consistent >= 0 && report.handedness.consistent <= 1);
  if (report.local) {
    expect_numbers(report.local->classes, mesh);
    EXPECT_TRUE(report.local->agreement >= 0 && report.local->agreement <= 1);
  }
  if (report.mikktspace) {
    expect_numbers(report.mikktspace->classes, mesh);
    EXPECT_TRUE(report.mikktspace->equal_bits >= 0 && report.mikktspace->equal_bits <= 1);
  }
  bool error = false;
  for (const Finding& f : report.findings) {
    error = error || f.severity == Severity::error;
    EXPECT_GT(f.count, 0u) << f.code;
    EXPECT_TRUE(std::ranges::any_of(finding_kinds(), [&](const FindingKind& k) { return k.code == f.code; }));
    EXPECT_EQ(f.message.find("nan"), std::string::npos) << f.message;
    EXPECT_EQ(f.message.find("inf "), std::string::npos) << f.message;
  }
  EXPECT_TRUE(std::ranges::is_sorted(report.findings, std::ranges::greater{}, &Finding::severity));
  EXPECT_EQ(report.verdict == Verdict::fail, error);
}

// Every way of asking.
void expect_sound(const Mesh& mesh) {
  std::vector<AssessOptions> questions(5);
  questions[1].surface = parse_specification("sphere");
  questions[2].surface = parse_specification("sphere:radius=1");
  questions[2].placement = Eigen::Isometry3d::Identity();
  questions[3].references = {.analytic = false, .mikktspace = false, .local = true};
  questions[4].references = {.analytic = false, .mikktspace = true, .local = false, .triangles = false};
  for (std::size_t q = 0; q < questions.size(); ++q) {
    SCOPED_TRACE("question " + std::to_string(q));
    const Assessment whole = assess(mesh, questions[q]);
    EXPECT_EQ(whole.report.corners, mesh.corners());
    expect_sound(whole.report, mesh);
    std::size_t corners = 0;
    for (const Assessment& part : assess_parts(mesh, questions[q])) {
      expect_sound(part.report, mesh);
      corners += part.report.corners;
    }
    EXPECT_EQ(corners, mesh.corners());
  }
  if (!mesh.uvs.empty()) expect_sound(validate(mesh, PlacedSurface{make_surface("sphere")}), mesh);
}

// ---- meshes that hardly are any

Mesh ball() {
  return sample_mesh(make_surface("sphere"), {.columns = 12, .rows = 7});
}

struct Exotic {
  std::string name;
  Mesh mesh;
  Verdict verdict;        // of assess(), with nothing declared
  std::string_view code;  // that is among its findings, at all corners unless there are none
};

std::vector<Exotic> exotic_meshes() {
  std::vector<Exotic> list;
  const auto add = [&](const std::string& name, Verdict verdict, std::string_view code, auto change) {
    Mesh mesh = ball();
    change(mesh);
    list.push_back({name, std::move(mesh), verdict, code});
  };
  using enum Verdict;
  add("no triangles", nothing, "TRIANGLES_MISSING", [](Mesh& m) { m.triangles.clear(); });
  add("one triangle", pass, "SURFACE_UNKNOWN", [](Mesh& m) { m.triangles = {m.triangles[60]}; });
  add("no uvs", pass, "UV_MISSING", [](Mesh& m) { m.uvs.clear(); });
  add("no normals", pass, "NORMAL_MISSING", [](Mesh& m) { m.normals.clear(); });
  add("positions alone", nothing, "TANGENT_MISSING",
      [](Mesh& m) { m.uvs.clear(), m.normals.clear(), m.tangents.clear(); });
  add("NaN for positions", fail, "POSITION_NOT_FINITE", [](Mesh& m) {
    for (auto& p : m.positions) p.y = NAN;
  });
  add("NaN for uvs", fail, "UV_NOT_FINITE", [](Mesh& m) {
    for (auto& uv : m.uvs) uv.x = NAN;
  });
  add("NaN for normals", fail, "NORMAL_NOT_FINITE", [](Mesh& m) {
    for (auto& n : m.normals) n.z = NAN;
  });
  add("NaN for tangents", fail, "TANGENT_NOT_FINITE", [](Mesh& m) {
    for (auto& t : m.tangents) t.x = NAN;
  });
  add("all at one place", undetermined, "SURFACE_UNKNOWN", [](Mesh& m) {
    for (auto& p : m.positions) p = {3, 2, 1};
  });
  add("all at one uv", pass, "", [](Mesh& m) {
    for (auto& uv : m.uvs) uv = {0.5, 0.5};
  });
  add("on one line", undetermined, "SURFACE_UNKNOWN", [](Mesh& m) {
    for (auto& p : m.positions) p = {p.x, 2 * p.x, 0};
  });
  add("one index", undetermined, "SURFACE_UNKNOWN", [](Mesh& m) {
    for (auto& t : m.triangles) t = {20, 20, 20};
  });
  add("so large that squares overflow", pass, "", [](Mesh& m) {
    for (auto& p : m.positions) p = 1e300 * p;
  });
  add("so small that squares vanish", pass, "", [](Mesh& m) {
    for (auto& p : m.positions) p = 1e-300 * p;
  });
  add("uvs so large that they have no fraction", pass, "", [](Mesh& m) {
    for (auto& uv : m.uvs) uv = {1e300 * uv.x, -1e300 * uv.y};
  });
  return list;
}

TEST(ValidateExoticInput, HasAVerdict) {
  for (const Exotic& e : exotic_meshes()) {
    SCOPED_TRACE(e.name);
    expect_sound(e.mesh);
    const MeshReport report = assess(e.mesh).report;
    std::string all;
    for (const Finding& f : report.findings)
      all += std::string(f.code) + " " + std::to_string(f.count) + ", ";
    EXPECT_EQ(report.verdict, e.verdict) << all;
    if (e.code.empty()) continue;
    ASSERT_TRUE(finding_of(report, e.code)) << all;
    EXPECT_EQ(finding_of(report, e.code)->count, std::max<std::size_t>(e.mesh.corners(), 1)) << all;
  }
}

// Small meshes of numbers that are seldom met, attributes left out at random.
TEST(ValidateExoticInput, OfRandomNumbersHasAVerdict) {
#ifdef DARBOUX_SHORT_TESTS
  constexpr std::uint64_t seeds = 10;
#else
  constexpr std::uint64_t seeds = 30;
#endif
  constexpr std::array numbers{0.0,   -0.0,   1.0,    -1.0, 0.5,  3e-8,
                               1e300, 1e-300, 5e-324, inf,  -inf, std::numeric_limits<double>::quiet_NaN()};
  std::cout << "seeds 1 to " << seeds << '\n';
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    // The first seeds have finite numbers alone, the others any.
    const std::size_t kinds = seed % 3 == 0 ? 6 : seed % 3 == 1 ? 9 : numbers.size();
    const auto number = [&] { return numbers[random() % kinds]; };
    const auto n = static_cast<std::uint32_t>(1 + random() % 12);
    const bool uvs = random() % 4 != 0, normals = random() % 4 != 0, tangents = random() % 4 != 0;
    Mesh mesh;
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.positions.push_back({number(), number(), number()});
      if (uvs) mesh.uvs.push_back({number(), number()});
      if (normals) mesh.normals.push_back({number(), number(), number()});
      if (tangents) mesh.tangents.push_back({number(), number(), number(), number()});
    }
    const auto index = [&] { return static_cast<std::uint32_t>(random() % n); };
    for (std::size_t t = random() % 16; t > 0; --t) mesh.triangles.push_back({index(), index(), index()});
    expect_sound(mesh);
  }
}

TEST(ValidateExoticInput, InconsistentMeshesAreRefused) {
  std::vector<Mesh> meshes(4, ball());
  meshes[0].triangles[3][1] = static_cast<std::uint32_t>(meshes[0].positions.size());
  meshes[1].uvs.pop_back();
  meshes[2].tangents.push_back({});
  meshes[3].normals.resize(1);
  for (const Mesh& mesh : meshes) {
    EXPECT_THROW(assess(mesh), MeshError);
    EXPECT_THROW(assess_parts(mesh), MeshError);
    EXPECT_THROW(validate(mesh, std::nullopt), MeshError);
  }
  AssessOptions options;
  for (const double limit : {0.0, -1.0, 181.0, std::nan("")}) {
    options.max_angle_deg = limit;
    EXPECT_THROW(assess(ball(), options), ParameterError);
    EXPECT_THROW(validate(ball(), std::nullopt, options), ParameterError);
  }
}

// ---- surfaces that are declared wrongly

// Of a sphere whose radius is too small by a tenth every vertex strays by that tenth.
TEST(ValidateExoticInput, AMismatchSaysHowFarItIs) {
  Mesh mesh = sample_mesh(make_surface("sphere"), {.columns = 12, .rows = 6});
  for (const double size : {1e-3, 1.0, 1e3}) {
    Mesh scaled = mesh;
    for (auto& p : scaled.positions) p = 1.1 * size * p;
    AssessOptions options;
    options.surface = SurfaceSpecification{"sphere", {{"radius", size}}};
    options.placement = Eigen::Isometry3d::Identity();
    const MeshReport report = assess(scaled, options).report;
    EXPECT_EQ(report.verdict, Verdict::fail);
    const Finding* mismatch = finding_of(report, "SURFACE_MISMATCH");
    ASSERT_TRUE(mismatch);
    EXPECT_EQ(mismatch->count, scaled.corners());
    // 0.1 over the diagonal of a cube of edge 2.2: 0.02624.
    EXPECT_NE(mismatch->message.find("rms distance of 0.026 "), std::string::npos) << mismatch->message;
    EXPECT_NE(mismatch->message.find("expected at most 0.0001"), std::string::npos) << mismatch->message;
  }
}

// Without uvs a declared surface is looked for by the positions, with the values and the placement that are
// given; where it is not found, that is said, and nothing else is taken instead.
TEST(ValidateExoticInput, ADeclaredSurfaceIsFoundWithoutUvs) {
  Mesh mesh = sample_mesh(make_surface("sphere:radius=2"), {.columns = 24, .rows = 13});
  mesh.uvs.clear();
  mesh.tangents.clear();
  const Eigen::Isometry3d there = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d elsewhere = there;
  elsewhere.translation().x() = 0.1;
  struct Case {
    const char* surface;
    std::optional<Eigen::Isometry3d> placement;
    bool found;
  };
  for (const auto& [surface, placement, found] :
       {Case{"sphere", {}, true}, Case{"sphere:radius=2", {}, true}, Case{"sphere:radius=2", there, true},
        Case{"sphere", there, true}, Case{"sphere:radius=2.1", {}, false}, Case{"sphere", elsewhere, false},
        Case{"torus", {}, false}, Case{"cylinder", {}, false}}) {
    SCOPED_TRACE(surface);
    AssessOptions options;
    options.surface = parse_specification(surface);
    options.placement = placement;
    for (const Assessment& assessment : {assess(mesh, options), assess_parts(mesh, options).at(0)}) {
      EXPECT_EQ(assessment.report.verdict, found ? Verdict::pass : Verdict::undetermined);
      EXPECT_EQ(assessment.report.reference, found ? ReferenceKind::analytic : ReferenceKind::local);
      EXPECT_EQ(finding_of(assessment.report, "SURFACE_UNKNOWN") != nullptr, !found);
      EXPECT_FALSE(finding_of(assessment.report, "SURFACE_MISMATCH"));
    }
  }
  // What is given is known exactly, what is fitted is not.
  AssessOptions options;
  options.surface = parse_specification("sphere:radius=2");
  const MeshFit free = *assess(mesh, options).fit;
  options.placement = there;
  const MeshFit held = *assess(mesh, options).fit;
  EXPECT_EQ(free.surface.surface.parameters()[0].value, 2);
  EXPECT_EQ(free.covariance(6, 6), 0);
  EXPECT_EQ(held.covariance.norm(), 0);
  EXPECT_TRUE(held.surface.placement.isApprox(there, 0));
}

// Exact meshes without uvs, declared in any way, have no error: where the surface is not found, that is said.
// At an apex and on the one side of a strip nothing is known.
TEST(ValidateExoticInput, DeclaredExactMeshesWithoutUvsNeverFail) {
  for (const std::string_view kind : fitted_kinds()) {
    const AnySurface surface = make_surface(kind);
    Mesh mesh = sample_mesh(surface, {.columns = 24, .rows = 13});
    mesh.uvs.clear();
    mesh.tangents.clear();
    for (const bool values : {false, true})
      for (const bool placed : {false, true}) {
        SCOPED_TRACE(std::string(kind) + (values ? " with its values" : "") + (placed ? " placed" : ""));
        AssessOptions options;
        options.surface = parse_specification(values ? surface.specification(17) : std::string(kind));
        if (placed) options.placement = Eigen::Isometry3d::Identity();
        for (const Assessment& j : {assess(mesh, options), assess_parts(mesh, options).at(0)}) {
          EXPECT_NE(j.report.verdict, Verdict::fail);
          const bool found = std::ranges::count(found_kinds(), kind) > 0 || (kind == "disk" && !values);
          EXPECT_EQ(j.report.reference == ReferenceKind::analytic, found);
        }
      }
  }
}

// Two spheres, neither of which is the declared one.
TEST(ValidateExoticInput, NothingElseIsTakenForTheDeclaredSurface) {
  Mesh mesh = sample_mesh(make_surface("sphere:radius=1"), {.columns = 24, .rows = 13});
  append(mesh, sample_mesh(make_surface("sphere:radius=3"), {.columns = 24, .rows = 13}));
  for (const bool uvs : {true, false}) {
    if (!uvs) mesh.uvs.clear(), mesh.tangents.clear();
    AssessOptions options;
    options.surface = parse_specification("sphere:radius=2");
    const std::vector<Assessment> assessments = assess_parts(mesh, options);
    ASSERT_EQ(assessments.size(), 1u);
    EXPECT_EQ(assessments[0].report.verdict, uvs ? Verdict::fail : Verdict::undetermined);
    EXPECT_TRUE(finding_of(assessments[0].report, uvs ? "SURFACE_MISMATCH" : "SURFACE_UNKNOWN"));
    options.surface = parse_specification("sphere:radius=3");  // and then the other is one of its own
    EXPECT_EQ(assess_parts(mesh, options).size(), 2u);
  }
}

// Of a small cap the radius is hardly identifiable: where it is given, the rest moves with it.
TEST(ValidateExoticInput, WhatIsNotGivenFollowsWhatIs) {
  Mesh mesh =
      sample_mesh(make_surface("sphere:radius=2"), {.columns = 32, .rows = 16, .v_first = 0.97, .v_last = 1});
  mesh.uvs.clear();
  mesh.tangents.clear();
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, 1e-5);
  for (auto& p : mesh.positions) p = p + Vec3<double>{noise(random), noise(random), noise(random)};
  AssessOptions options;
  options.surface = parse_specification("sphere");
  const MeshFit free = *assess(mesh, options).fit;
  const double radius = free.surface.surface.parameters()[0].value,
               deviation = std::sqrt(free.covariance(6, 6));
  EXPECT_GT(deviation, 1e-4);
  EXPECT_LT(std::fabs(radius - 2), 4 * deviation);
  options.surface = parse_specification("sphere:radius=2");
  const MeshFit held = *assess(mesh, options).fit;
  ASSERT_TRUE(held.fits);
  EXPECT_LT(held.rms, 1.05 * free.rms);
  // The centre is known as well as the cap's height then, and is at 0.
  EXPECT_LT(std::sqrt(held.covariance(5, 5)), 0.1 * std::sqrt(free.covariance(5, 5)));
  EXPECT_LT(held.surface.placement.translation().norm(), 5e-5);
}

// Too little to tell is no mismatch.
TEST(ValidateExoticInput, ADeclaredSurfaceOfATriangleIsUndetermined) {
  Mesh mesh = ball();
  mesh.triangles = {mesh.triangles[60]};
  AssessOptions options;
  options.surface = parse_specification("sphere");
  const MeshReport report = assess(mesh, options).report;
  EXPECT_EQ(report.verdict, Verdict::undetermined);
  EXPECT_TRUE(finding_of(report, "SURFACE_UNKNOWN"));
  EXPECT_FALSE(finding_of(report, "SURFACE_MISMATCH"));
}

// What is no surface of the catalogue is none of those that are declared, whichever it is.
TEST(ValidateExoticInput, NoDeclarationFitsABentMesh) {
  Mesh mesh = sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.4"), {.columns = 16, .rows = 9});
  for (auto& p : mesh.positions) p = p + Vec3<double>{0.1 * p.y * p.y, 0.12 * p.z * p.x, 0.15 * p.x * p.y};
  for (const std::string_view kind : fitted_kinds()) {
    AssessOptions options;
    options.surface = parse_specification(kind);
    for (const Assessment& j : {assess(mesh, options), assess_parts(mesh, options).front()}) {
      EXPECT_EQ(j.report.verdict, Verdict::fail) << kind;
      const Finding* mismatch = finding_of(j.report, "SURFACE_MISMATCH");
      ASSERT_TRUE(mismatch) << kind;
      EXPECT_EQ(mismatch->severity, Severity::error);
      EXPECT_NE(mismatch->message.find(kind), std::string::npos) << mismatch->message;
    }
  }
}

}  // namespace
}  // namespace darboux::exotic_input_test
