// A matrix of defects: each is found under its code, and nothing else is.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/assess.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/vertex_normals.h>

#include "append_mesh.h"
#include "finding_codes.h"
#include "random_meshes.h"
#include "thinning.h"

namespace darboux::planted_defects_test {
namespace {

using test::bake, test::Codes, test::codes, test::joined, test::turn_by;

std::size_t count_of(const std::vector<Assessment>& assessments, std::string_view code) {
  std::size_t count = 0;
  for (const Assessment& j : assessments)
    for (const Finding& f : j.report.findings) count += f.code == code ? f.count : 0;
  return count;
}

void retangent(Mesh& mesh, std::size_t v, const Vec3<double>& t) {
  mesh.tangents[v] = {t.x, t.y, t.z, mesh.tangents[v].w};
}

void turn_tangents(Mesh& mesh, double deg) {
  const double a = deg * std::numbers::pi / 180;
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    const Vec3<double> t = mesh.tangents[v].xyz();
    retangent(mesh, v, std::cos(a) * t + std::sin(a) * cross(mesh.normals[v], t));
  }
}

// A bent ellipsoid: no surface of the catalogue, so that MikkTSpace and local jets assess it.
Mesh unknown_surface(const SampleMeshOptions& options) {
  Mesh mesh = sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.4"), options);
  for (auto& p : mesh.positions) {
    p = p + Vec3<double>{0.1 * p.y * p.y, 0.12 * p.z * p.x, 0.15 * p.x * p.y};
  }
  return mesh;
}

constexpr SampleMeshOptions grid{.columns = 64, .rows = 32};
constexpr std::size_t v = 65 * 16 + 23;  // an interior vertex: six corners

struct Case {
  std::string name;
  std::function<void(Mesh&)> plant;
  Codes found;
  std::string code;         // whose count is known
  std::size_t corners = 6;  // of it
  std::optional<Severity> severity{};
};

std::vector<Case> cases(const Mesh& good, bool known) {
  const Vec4<double> t = good.tangents[v];
  const std::size_t all = good.corners();
  const double tilt = known ? 0.2 : std::tan(std::numbers::pi / 9);
  const auto each = [](auto f) {
    return [f](Mesh& m) {
      for (std::size_t i = 0; i < m.positions.size(); ++i) f(m, i);
    };
  };
  return {
      {"nothing", [](Mesh&) {}, {}, "", 0},
      {"NaN in a tangent",
       [](Mesh& m) { m.tangents[v].y = NAN; },
       {"TANGENT_NOT_FINITE"},
       "TANGENT_NOT_FINITE"},
      {"infinite w",
       [](Mesh& m) { m.tangents[v].w = INFINITY; },
       {"TANGENT_NOT_FINITE"},
       "TANGENT_NOT_FINITE"},
      {"zero",
       [](Mesh& m) {
         retangent(m, v, {0, 0, 0});
       },
       {"TANGENT_ZERO"},
       "TANGENT_ZERO"},
      {"long", [=](Mesh& m) { retangent(m, v, 1.1 * t.xyz()); }, {"TANGENT_NOT_UNIT"}, "TANGENT_NOT_UNIT"},
      {"short by a thousandth",
       [=](Mesh& m) { retangent(m, v, 0.999 * t.xyz()); },
       {"TANGENT_NOT_UNIT"},
       "TANGENT_NOT_UNIT"},
      {"w zero", [](Mesh& m) { m.tangents[v].w = 0; }, {"TANGENT_INVALID_SIGN"}, "TANGENT_INVALID_SIGN"},
      {"w interpolated",
       [](Mesh& m) { m.tangents[v].w = 0.5; },
       {"TANGENT_INVALID_SIGN"},
       "TANGENT_INVALID_SIGN"},
      {"one flipped w",
       [=](Mesh& m) { m.tangents[v].w = -t.w; },
       {"TANGENT_HANDEDNESS"},
       "TANGENT_HANDEDNESS"},
      {"leaning",
       [=](Mesh& m) { retangent(m, v, unit(t.xyz() + 0.3 * m.normals[v])); },
       {"TANGENT_NOT_ORTHOGONAL"},
       "TANGENT_NOT_ORTHOGONAL"},
      {"leaning a little",
       [=](Mesh& m) { retangent(m, v, unit(t.xyz() + 0.05 * m.normals[v])); },
       {"TANGENT_NOT_ORTHOGONAL"},
       "TANGENT_NOT_ORTHOGONAL",
       6,
       Severity::warning},
      {"one turned tangent",
       [=](Mesh& m) { retangent(m, v, unit(t.xyz() + 0.2 * cross(m.normals[v], t.xyz()))); },
       {"TANGENT_ANGLE", "TANGENT_NOT_MIKKTSPACE"},
       "TANGENT_ANGLE"},
      {"one negated tangent",
       [=](Mesh& m) { retangent(m, v, -t.xyz()); },
       {"TANGENT_ANGLE", "TANGENT_NOT_MIKKTSPACE"},
       "TANGENT_ANGLE"},
      {"NaN in a normal", [](Mesh& m) { m.normals[v].x = NAN; }, {"NORMAL_NOT_FINITE"}, "NORMAL_NOT_FINITE"},
      {"short normal",
       [](Mesh& m) { m.normals[v] = 0.5 * m.normals[v]; },
       {"NORMAL_NOT_UNIT"},
       "NORMAL_NOT_UNIT"},
      // Normals of an unknown surface are their author's: a tilt of 20 degrees is worth a warning there.
      {"tilted normal",
       [=](Mesh& m) { m.normals[v] = unit(m.normals[v] + tilt * cross(m.normals[v], t.xyz())); },
       {"NORMAL_ANGLE"},
       "NORMAL_ANGLE",
       6,
       known ? Severity::error : Severity::warning},
      {"NaN in a position",
       [](Mesh& m) { m.positions[v].z = NAN; },
       {"POSITION_NOT_FINITE"},
       "POSITION_NOT_FINITE"},
      {"infinite uv", [](Mesh& m) { m.uvs[v].x = INFINITY; }, {"UV_NOT_FINITE"}, "UV_NOT_FINITE"},
      {"raw sign",
       each([](Mesh& m, std::size_t i) { m.tangents[i].w *= -1; }),
       {"TANGENT_HANDEDNESS_CONVENTION"},
       "TANGENT_HANDEDNESS_CONVENTION",
       all},
      {"negated tangents",
       each([](Mesh& m, std::size_t i) { retangent(m, i, -m.tangents[i].xyz()); }),
       {"TANGENT_ANGLE", "TANGENT_NOT_MIKKTSPACE", "TANGENT_AXES"},
       "TANGENT_AXES",
       all},
      {"bitangents for tangents",
       each([](Mesh& m, std::size_t i) {
         retangent(m, i, -m.tangents[i].w * cross(m.normals[i], m.tangents[i].xyz()));
       }),
       {"TANGENT_ANGLE", "TANGENT_NOT_MIKKTSPACE", "TANGENT_AXES"},
       "TANGENT_AXES",
       all},
      {"negated bitangents for tangents",
       each([](Mesh& m, std::size_t i) {
         retangent(m, i, m.tangents[i].w * cross(m.normals[i], m.tangents[i].xyz()));
       }),
       {"TANGENT_ANGLE", "TANGENT_NOT_MIKKTSPACE", "TANGENT_AXES"},
       "TANGENT_AXES",
       all},
      {"normals turned over", each([](Mesh& m, std::size_t i) { m.normals[i] = -m.normals[i]; }),
       known ? Codes{"NORMAL_ANGLE", "NORMALS_OPPOSE_WINDING"} : Codes{"NORMALS_OPPOSE_WINDING"},
       "NORMALS_OPPOSE_WINDING", all},
      // w reads the other way round with the winding, which is no second cause.
      {"wound the other way",
       [](Mesh& m) {
         for (auto& triangle : m.triangles) std::swap(triangle[1], triangle[2]);
       },
       {"NORMALS_OPPOSE_WINDING"},
       "NORMALS_OPPOSE_WINDING",
       all},
      {"one triangle wound the other way",
       [](Mesh& m) { std::swap(m.triangles[700][1], m.triangles[700][2]); },
       {"NORMALS_OPPOSE_WINDING", "VERTEX_ACROSS_MIRROR"},
       "NORMALS_OPPOSE_WINDING",
       3},
  };
}

// With normals of its neighbours, and MikkTSpace's tangents.
Mesh baked_unknown() {
  Mesh mesh = unknown_surface(grid);
  const MeshFrames cubic = mesh_frames(mesh, find_frame_method("cubic"));
  for (std::size_t c = 0; c < mesh.corners(); ++c)
    mesh.normals[mesh.triangles[c / 3][c % 3]] = cubic.corner(c).n;
  bake(mesh);
  return mesh;
}

class PlantedOn : public testing::TestWithParam<bool> {};

TEST_P(PlantedOn, AreFoundAndNothingElse) {
  const bool known = GetParam();
  const Mesh good =
      known ? sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.4"), grid) : baked_unknown();
  for (const Case& c : cases(good, known)) {
    Mesh mesh = good;
    c.plant(mesh);
    AssessOptions options;
    options.references.analytic = known;  // what is unknown is not looked for each time
    const std::vector<Assessment> assessments = assess_parts(mesh, options);
    const Codes found = codes(assessments);
    EXPECT_EQ(joined(found), joined(c.found)) << c.name;
    EXPECT_EQ(c.code.empty() ? 0 : count_of(assessments, c.code), c.corners) << c.name;
    for (const Finding& f : assessments.front().report.findings)
      if (c.severity && f.code == c.code) {
        EXPECT_EQ(f.severity, *c.severity) << c.name;
      }
  }
}

// Tangents and normals of the mesh before it was scaled unevenly.
TEST(PlantedDefects, StaleAfterAScale) {
  Mesh mesh = baked_unknown();
  turn_by(mesh, Eigen::Vector3d(2, 1, 0.7).asDiagonal());
  AssessOptions options;
  options.references.analytic = false;
  const std::vector<Assessment> assessments = assess_parts(mesh, options);
  EXPECT_EQ(joined(codes(assessments)),
            "NORMAL_ANGLE NORMAL_STALE TANGENT_ANGLE TANGENT_NOT_MIKKTSPACE TANGENT_STALE ");
  for (const Finding& f : assessments.front().report.findings)
    if (f.code == "TANGENT_STALE" || f.code == "NORMAL_STALE") {
      EXPECT_NE(f.message.find("scales x : y : z as 2.8"), std::string::npos) << f.message;
      EXPECT_NE(f.message.find(" : 1.4"), std::string::npos) << f.message;
      EXPECT_TRUE(f.message.ends_with(" : 1")) << f.message;
    }
  // Transformed as they should be, they are right.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3<double>& n = mesh.normals[i];
    const Vec4<double>& t = mesh.tangents[i];
    mesh.normals[i] = unit(Vec3<double>{n.x / 2, n.y, n.z / 0.7});
    retangent(mesh, i, unit(Vec3<double>{2 * t.x, t.y, 0.7 * t.z}));
  }
  EXPECT_EQ(joined(codes(assess_parts(mesh, options))), "");
}

std::string message_of(const Mesh& mesh, std::string_view code) {
  AssessOptions options;
  options.references.analytic = false;
  const MeshReport report = assess_parts(mesh, options).front().report;
  for (const Finding& f : report.findings)
    if (f.code == code && f.severity == Severity::error)
      return f.message + "; to do: " + std::string(f.to_do);
  return "";
}

// How far off the worst are, and whether the normals may be what is wrong.
TEST(PlantedDefects, MessagesSayHowMuch) {
  const Mesh good = baked_unknown();
  Mesh mesh = good;
  retangent(mesh, v, 1.1 * good.tangents[v].xyz());
  EXPECT_NE(message_of(mesh, "TANGENT_NOT_UNIT").find("(length 1.1)"), std::string::npos);
  retangent(mesh, v + 1, 0.25 * good.tangents[v + 1].xyz());
  EXPECT_NE(message_of(mesh, "TANGENT_NOT_UNIT").find("(lengths 0.25 to 1.1)"), std::string::npos);
  mesh = good;
  mesh.normals[v] = 0.5 * good.normals[v];
  EXPECT_NE(message_of(mesh, "NORMAL_NOT_UNIT").find("(length 0.5)"), std::string::npos);
  EXPECT_NE(message_of(mesh, "NORMAL_NOT_UNIT").find("to do: normalise"), std::string::npos);
  mesh.normals[v + 1] = {};
  EXPECT_NE(message_of(mesh, "NORMAL_NOT_UNIT").find("(lengths 0 to 0.5)"), std::string::npos);
  EXPECT_NE(message_of(mesh, "NORMAL_NOT_UNIT").find("to do: recompute those of length 0"),
            std::string::npos);
  mesh.normals[v] = {};
  EXPECT_NE(message_of(mesh, "NORMAL_NOT_UNIT").find("to do: recompute them"), std::string::npos);
  mesh = good;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    retangent(mesh, i, unit(good.tangents[i].xyz() + good.normals[i]));
  const std::string leaning = message_of(mesh, "TANGENT_NOT_ORTHOGONAL");
  EXPECT_NE(leaning.find("|t.n| up to 0.707,"), std::string::npos) << leaning;
  EXPECT_EQ(leaning.find("normals may be"), std::string::npos) << leaning;
  EXPECT_NE(leaning.find("to do: project"), std::string::npos) << leaning;
  // Of normals that are no unit vectors the cosine counts.
  mesh = good;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.normals[i] = 10. * good.normals[i];
    retangent(mesh, i, unit(good.tangents[i].xyz() + 0.03 * good.normals[i]));
  }
  EXPECT_EQ(message_of(mesh, "TANGENT_NOT_ORTHOGONAL"), "");
  EXPECT_NE(message_of(mesh, "NORMAL_NOT_UNIT").find("(length 10)"), std::string::npos);
  // Positions, tangents and, wrongly, normals by one uneven scale.
  mesh = good;
  turn_by(mesh, Eigen::Vector3d(1, 1, 4).asDiagonal());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const auto scaled = [](const Vec3<double>& d) { return unit(Vec3<double>{d.x, d.y, 4 * d.z}); };
    mesh.normals[i] = scaled(good.normals[i]);
    retangent(mesh, i, scaled(good.tangents[i].xyz()));
  }
  const std::string scaled = message_of(mesh, "TANGENT_NOT_ORTHOGONAL");
  EXPECT_NE(scaled.find("normals may be"), std::string::npos) << scaled;
  EXPECT_NE(scaled.find("to do: if the normals are wrong, transform"), std::string::npos) << scaled;
}

// All turned about their normals by one angle, on a strip whose corners are all at its borders.
TEST(PlantedDefects, AllTurnedByOneAngle) {
  for (const int columns : {8, 16, 48})
    for (const double deg : {60.0, -45.0, 120.0})
      for (const bool known : {true, false}) {
        Mesh mesh = sample_mesh(make_surface("cylinder"), {.columns = columns, .rows = 1});
        if (!known)
          for (auto& p : mesh.positions) p.x += 0.3 * p.y * p.y;
        if (!known) mesh.normals = vertex_normals(mesh, NormalWeight::angle);
        if (!known) bake(mesh);
        EXPECT_EQ(joined(codes(assess_parts(mesh))), "");
        turn_tangents(mesh, deg);
        const std::vector<Assessment> assessments = assess_parts(mesh);
        SCOPED_TRACE(std::to_string(columns) + " columns by " + std::to_string(deg) +
                     (known ? ", known" : ", unknown"));
        EXPECT_EQ(assessments.front().report.verdict, Verdict::fail);
        EXPECT_EQ(count_of(assessments, "TANGENT_ANGLE"), mesh.corners());
        EXPECT_EQ(count_of(assessments, "TANGENT_UV_SET"), mesh.corners());
        EXPECT_EQ(count_of(assessments, "TANGENT_STALE"), 0u);
      }
}

// Also where it is one part of a mesh.
TEST(PlantedDefects, AllOfAPartTurnedByOneAngle) {
  Mesh mesh = sample_mesh(make_surface("cylinder"), {.columns = 12, .rows = 1});
  turn_tangents(mesh, 60);
  const std::size_t turned = mesh.corners();
  Mesh other = sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16});
  for (auto& p : other.positions) p.x += 5;
  append(mesh, other);
  const std::vector<Assessment> assessments = assess_parts(mesh);
  EXPECT_EQ(assessments.size(), 2u);
  EXPECT_EQ(count_of(assessments, "TANGENT_ANGLE"), turned);
  EXPECT_EQ(count_of(assessments, "TANGENT_UV_SET"), turned);
}

// The exact tangents of uvs that run askew round prisms of few sides are turned from what the facets tell, by
// up to 25 degrees, all the same way.
TEST(PlantedDefects, ExactTangentsOnPrismsAreNotTurned) {
  for (const int columns : {3, 4, 5, 6, 8})
    for (const double askew : {0.3, 1.0, 1.7, 3.0, 8.0, -1.7}) {
      Mesh mesh = sample_mesh(make_surface("cylinder:radius=1,height=6.28"), {.columns = columns, .rows = 1});
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        auto& uv = mesh.uvs[i];
        uv.y += askew * uv.x;
        const Vec3<double> t = mesh.tangents[i].xyz();
        retangent(mesh, i, unit(t - askew * Vec3<double>{0, 0, 1}));
      }
      for (const bool analytic : {true, false}) {
        AssessOptions options;
        options.references.analytic = analytic;
        for (const Assessment& a : assess_parts(mesh, options))
          EXPECT_NE(a.report.verdict, Verdict::fail)
              << columns << " columns, " << askew << ", " << a.report.findings.front().message;
      }
    }
}

// One cause is named, and the right one, on surfaces of all kinds, also where u and v are not at right
// angles, and where the surface is unknown.
TEST(PlantedDefects, OneCauseIsNamed) {
  std::size_t meshes = 0;
  int combination = 0;
  for (const char* surface : {"sphere", "torus:major_radius=1,minor_radius=0.4", "cylinder", "plane",
                              "ellipsoid", "hyperbolic-paraboloid", "monkey-saddle", "moebius-strip",
                              "klein-bottle", "bezier-patch", "ruled-surface", "disk", "extrusion"})
    for (const bool bent : {false, true}) {
      if (test::thinning() > 1 && combination++ % 3 == 0) continue;  // each surface in one form at least
      Mesh good = sample_mesh(make_surface(surface), {.columns = 32, .rows = 16});
      if (bent) {
        for (auto& p : good.positions)
          p = p + Vec3<double>{0.1 * p.y * p.y, 0.12 * p.z * p.x, 0.15 * p.x * p.y};
        good.normals = vertex_normals(good, NormalWeight::angle);
        bake(good);
      }
      const auto named = [&](const Mesh& mesh) {
        std::string text;
        const Codes found = codes(assess_parts(mesh));
        for (const char* code : {"TANGENT_AXES", "TANGENT_UV_SET", "TANGENT_STALE", "NORMAL_STALE"})
          if (found.contains(code)) text += std::string(code) + ' ';
        return text;
      };
      SCOPED_TRACE(std::string(surface) + (bent ? ", bent" : ""));
      EXPECT_EQ(named(good), "");
      Mesh mesh = good;
      for (auto& uv : mesh.uvs) std::swap(uv.x, uv.y);
      bake(mesh);
      mesh.uvs = good.uvs;
      EXPECT_EQ(named(mesh), "TANGENT_AXES ") << "swapped uvs";
      for (const double deg : {90.0, 180.0, -90.0, 50.0, -60.0}) {
        mesh = good;
        turn_tangents(mesh, deg);
        EXPECT_EQ(named(mesh), std::fmod(deg, 90) == 0 ? "TANGENT_AXES " : "TANGENT_UV_SET ") << deg;
      }
      ++meshes;
    }
  std::cout << meshes << " meshes\n";
}

// Of a surface that is known without its uvs, as a sphere under Mercator's, the triangles' own tangents name
// it.
TEST(PlantedDefects, OneCauseIsNamedWhereUvsAreUnknown) {
  for (const double deg : {90.0, 180.0, -90.0}) {
    Mesh mesh =
        sample_mesh(make_surface("sphere"), {.columns = 32, .rows = 16, .v_first = 0.1, .v_last = 0.9});
    for (auto& uv : mesh.uvs) uv.y = std::log(std::tan(std::numbers::pi / 2 * uv.y));
    turn_tangents(mesh, deg);
    const Assessment assessment = assess(mesh);
    EXPECT_TRUE(assessment.fit && assessment.fit->fits);
    const Codes found = codes(assess_parts(mesh));
    EXPECT_TRUE(found.contains("TANGENT_AXES") && !found.contains("TANGENT_UV_SET")) << deg;
  }
}

// Tangents that follow another uv set than the one that is read.
TEST(PlantedDefects, AnotherUvSet) {
  Mesh mesh = baked_unknown();
  std::vector<Vec2<double>> other;
  for (const Vec2<double>& uv : mesh.uvs) other.push_back({0.7 * uv.x - 0.7 * uv.y, 0.7 * uv.x + 0.7 * uv.y});
  std::swap(mesh.uvs, other);
  const std::vector<std::pair<int, std::vector<Vec2<double>>>> sets{{1, other}};
  AssessOptions options;
  options.references.analytic = false;
  options.other_uvs = sets;
  EXPECT_EQ(joined(codes(assess_parts(mesh, options))),
            "TANGENT_ANGLE TANGENT_NOT_MIKKTSPACE TANGENT_UV_SET ");
}

// One w of each vertex on the fold of mirrored uvs, where the triangles on both sides share it.
TEST(PlantedDefects, VerticesAcrossAMirror) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16});
  for (Vec2<double>& uv : mesh.uvs) uv.x = 1 - std::fabs(2 * uv.x - 1);
  bake(mesh);
  const std::vector<Assessment> assessments = assess_parts(mesh);
  EXPECT_TRUE(codes(assessments).contains("VERTEX_ACROSS_MIRROR")) << joined(codes(assessments));
  EXPECT_TRUE(codes(assessments).contains("TANGENT_HANDEDNESS"));
  // The fold at u = 1/2 has 17 vertices, of six corners each but for the first and the last, of three.
  EXPECT_EQ(count_of(assessments, "VERTEX_ACROSS_MIRROR"), 15u * 6 + 2 * 3);
}

// FBX and COLLADA store binormals, and have them along v.
TEST(PlantedDefects, BinormalsAgainstV) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16});
  AssessOptions options;
  options.sign = SignConvention::raw;
  EXPECT_EQ(joined(codes(assess_parts(mesh, options))), "BINORMAL_AGAINST_V ");
  EXPECT_EQ(count_of(assess_parts(mesh, options), "BINORMAL_AGAINST_V"), mesh.corners());
  for (Vec4<double>& t : mesh.tangents) t.w *= -1;
  EXPECT_EQ(joined(codes(assess_parts(mesh, options))), "");
  EXPECT_EQ(joined(codes(assess_parts(mesh))), "TANGENT_HANDEDNESS_CONVENTION ");
}

TEST(PlantedDefects, NegatedNormalsAreCalledSo) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 64, .rows = 32});
  for (Vec3<double>& n : mesh.normals) n = -n;
  bool found = false;
  for (const Finding& f : assess(mesh).report.findings)
    if (f.code == "NORMAL_ANGLE" && f.severity == Severity::error) {
      found = true;
      EXPECT_EQ(f.to_do, "negate the normals");
    }
  EXPECT_TRUE(found);
}

// One island among many, of less than a hundredth of the corners: the mesh follows its convention, the island
// does not.
TEST(PlantedDefects, TheSignOfOneSmallIsland) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 128, .rows = 64});
  Mesh leaf = sample_mesh(make_surface("plane"), {.columns = 4, .rows = 4});
  for (Vec3<double>& p : leaf.positions) p = p + Vec3<double>{5, 0, 0};
  for (Vec2<double>& uv : leaf.uvs) uv = {0.1 * uv.x + 2, 0.1 * uv.y};
  for (Vec4<double>& t : leaf.tangents) t.w *= -1;
  const std::size_t corners = leaf.corners();
  append(mesh, leaf);
  const MeshReport report = validate(mesh, std::nullopt);
  EXPECT_EQ(report.handedness.convention, HandednessConvention::gltf);
  EXPECT_EQ(count_of({Assessment{{}, report}}, "HANDEDNESS_MIXED"), corners);
}

// Islands under different conventions: the smaller half is named.
TEST(PlantedDefects, SignsThatDifferBetweenIslands) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16, .mirror = true});
  EXPECT_EQ(joined(codes({Assessment{{}, validate(mesh, std::nullopt)}})), "");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (mesh.tangents[i].w > 0) mesh.tangents[i].w = -1;
  const MeshReport report = validate(mesh, std::nullopt);
  EXPECT_EQ(report.handedness.convention, HandednessConvention::mixed);
  EXPECT_EQ(joined(codes({Assessment{{}, report}})), "HANDEDNESS_MIXED ");
}

// No false finding where the surface is hidden: what its neighbours tell of an exact mesh never contradicts
// it.
TEST(PlantedDefects, ExactMeshesHaveNoneByTheirNeighbours) {
  for (const AnySurface& surface : all_surfaces())
    for (const double jitter : {0.0, 0.25})
      for (const int columns : {16, 48}) {
        if (surface.info().name == "superellipsoid") continue;  // its edges are rounder than any grid
        const Mesh mesh = sample_mesh(surface, {.columns = columns, .rows = columns / 2, .jitter = jitter});
        AssessOptions options;
        options.references = {.analytic = false, .mikktspace = false, .local = true};
        const MeshReport report = assess(mesh, options).report;
        EXPECT_NE(report.verdict, Verdict::fail)
            << surface.info().name << " " << columns << " jitter " << jitter << ": "
            << (report.findings.empty() ? "" : report.findings.front().message);
      }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, PlantedOn, testing::Values(true, false),
                         [](const auto& p) { return p.param ? "Known" : "Unknown"; });

}  // namespace
}  // namespace darboux::planted_defects_test
