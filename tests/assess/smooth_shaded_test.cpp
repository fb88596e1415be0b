// Edges that are shaded smooth: their normals are averages of two surfaces, and right for neither. Correct
// files have them, with one vertex for all that meet there, with vertices split by uvs, or with one per
// corner.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/sample_mesh.h>

#include "append_mesh.h"
#include "random_meshes.h"

namespace darboux::smooth_shaded_test {
namespace {

constexpr double pi = std::numbers::pi;

std::size_t count_of(const std::vector<Assessment>& assessments, std::string_view code, Severity severity) {
  std::size_t count = 0;
  for (const Assessment& j : assessments)
    for (const Finding& f : j.report.findings)
      count += f.code == code && f.severity == severity ? f.count : 0;
  return count;
}
bool has(const std::vector<Assessment>& assessments, std::string_view code) {
  return count_of(assessments, code, Severity::info) > 0;
}
std::string errors(const std::vector<Assessment>& assessments) {
  std::string text;
  for (const Assessment& j : assessments)
    for (const Finding& f : j.report.findings)
      if (f.severity == Severity::error)
        text += std::string(f.code) + " (" + std::to_string(f.count) + ") " + f.message + '\n';
  return text;
}
Verdict verdict(const std::vector<Assessment>& assessments) {
  Verdict worst = Verdict::nothing;
  for (const Assessment& j : assessments) worst = std::max(worst, j.report.verdict);
  return worst;
}
std::size_t recognised(const std::vector<Assessment>& assessments) {
  std::size_t count = 0;
  for (const Assessment& j : assessments) count += j.fit && j.fit->fits;
  return count;
}

// ---- shapes, of patches with uvs of their own
// ---------------------------------------------------------------

using test::add_grid;
using test::on_ring;

Mesh hemisphere(int sides, int rows) {
  Mesh mesh;
  test::add_dome(mesh, sides, rows);
  test::add_disk(mesh, 1, 0, sides, 4, false);
  return mesh;
}

// Two pages that meet at a right angle.
Mesh book(int n) {
  Mesh mesh;
  add_grid(mesh, n, n, [](double u, double v) { return Vec3<double>{u - 1, v, u - 1}; });
  add_grid(mesh, n, n, [](double u, double v) { return Vec3<double>{u, v, -u}; });
  return mesh;
}

struct Shape {
  std::string name;
  Mesh mesh;
  int columns;           // of its first patch
  std::size_t surfaces;  // that are recognised at least
};
std::vector<Shape> shapes() {
  return {{"cube, 12x12", test::box_of_patches({1, 1, 1}, 12), 12, 6},
          {"cube, 20x20", test::box_of_patches({1, 1, 1}, 20), 20, 6},
          {"tabletop", test::box_of_patches({2, 1, 0.05}, 20), 20, 6},
          {"prism, 16x10", test::capped_cylinder(16, 10, 4, 3), 16, 1},
          {"prism, 32x16", test::capped_cylinder(32, 16, 4, 2), 32, 1},
          {"coin", test::capped_cylinder(48, 3, 4, 0.15), 48, 1},
          {"hemisphere", hemisphere(32, 10), 32, 1},
          {"book", book(10), 10, 2}};
}

// A vase of few rings: its profile turns by up to a right angle at one, where a polynomial through the
// neighbours knows nothing of it.
Mesh vase(int sides) {
  constexpr std::array<std::array<double, 2>, 10> profile{{{0, 0},
                                                           {0.5, 0},
                                                           {0.55, 0.05},
                                                           {0.6, 0.5},
                                                           {0.3, 1},
                                                           {0.25, 1.3},
                                                           {0.3, 1.35},
                                                           {0.27, 1.35},
                                                           {0.22, 1.3},
                                                           {0.22, 1}}};
  std::array<double, 10> length{};
  for (std::size_t k = 1; k < profile.size(); ++k)
    length[k] =
        length[k - 1] + std::hypot(profile[k][0] - profile[k - 1][0], profile[k][1] - profile[k - 1][1]);
  const auto ring = [](double v) { return static_cast<std::size_t>(std::lround(9 * v)); };
  Mesh mesh;
  add_grid(mesh, sides, 9, [&](double u, double v) {
    const auto& [r, z] = profile[ring(v)];
    return on_ring(r, u, z);
  });
  for (Vec2<double>& uv : mesh.uvs) uv.y = length[ring(uv.y)] / length[9];
  return mesh;
}

// Averages of the triangles' normals are what every tool writes.
TEST(SmoothShaded, NothingIsSaidAgainstAveragedNormals) {
  for (const int sides : {8, 12, 24}) {
    Mesh mesh = test::with_averaged_normals(vase(sides), NormalWeight::area);
    test::bake(mesh);
    const std::vector<Assessment> assessments = assess_parts(mesh);
    EXPECT_EQ(verdict(assessments), Verdict::pass);
    EXPECT_EQ(count_of(assessments, "NORMAL_ANGLE", Severity::warning), 0U) << sides;
  }
}

// ---- one mesh, stored in several ways
// -----------------------------------------------------------------------

enum class Stored { shared, by_uvs, by_corner };

Mesh stored(const Mesh& shape, Stored how, bool tangents) {
  Mesh mesh = test::with_averaged_normals(shape);
  if (how == Stored::shared) mesh = test::welded(mesh);
  if (tangents) test::bake(mesh);
  if (how == Stored::by_corner) mesh = test::one_vertex_per_corner(mesh);
  test::round_to_floats(mesh);
  return mesh;
}

TEST(SmoothShaded, SolidsPassHoweverTheyAreStored) {
  for (const Shape& shape : shapes())
    for (const Stored how : {Stored::shared, Stored::by_uvs, Stored::by_corner})
      for (const bool tangents : {false, true}) {
        if (tangents && how == Stored::shared) continue;  // it has no uvs
        const std::vector<Assessment> assessments = assess_parts(stored(shape.mesh, how, tangents));
        EXPECT_EQ(verdict(assessments), Verdict::pass)
            << shape.name << " stored " << static_cast<int>(how) << (tangents ? " with tangents" : "") << '\n'
            << errors(assessments);
        EXPECT_GE(recognised(assessments), shape.surfaces)
            << shape.name << " stored " << static_cast<int>(how);
        EXPECT_TRUE(has(assessments, "CREASE_SHARED")) << shape.name << " stored " << static_cast<int>(how);
        EXPECT_EQ(count_of(assessments, "NORMAL_ANGLE", Severity::warning), 0u) << shape.name;
      }
}

// Errors, warnings, and what is not assessed.
std::vector<Finding> grave(const MeshReport& report) {
  std::vector<Finding> result;
  for (const Finding& f : report.findings)
    if (f.severity != Severity::info || f.code == "CREASE_SHARED") result.push_back(f);
  return result;
}

// Vertices or corners: the same findings, with the same counts.
TEST(SmoothShaded, OneVertexPerCornerIsTheSame) {
  for (const Shape& shape : shapes())
    for (const bool planted : {false, true}) {
      Mesh mesh = stored(shape.mesh, Stored::by_uvs, true);
      const auto v = static_cast<std::size_t>(2 * (shape.columns + 1) + 5);  // inside the first patch
      if (planted) mesh.normals[v] = unit(mesh.normals[v] + 0.3 * mesh.tangents[v].xyz());
      const std::vector<Assessment> one = assess_parts(mesh),
                                    other = assess_parts(test::one_vertex_per_corner(mesh));
      ASSERT_EQ(one.size(), other.size()) << shape.name;
      EXPECT_EQ(verdict(one), planted ? Verdict::fail : Verdict::pass) << shape.name;
      for (std::size_t k = 0; k < one.size(); ++k) {
        const auto a = grave(one[k].report), b = grave(other[k].report);
        EXPECT_EQ(one[k].report.verdict, other[k].report.verdict) << shape.name << " part " << k;
        ASSERT_EQ(a.size(), b.size()) << shape.name << " part " << k;
        for (std::size_t i = 0; i < a.size(); ++i) {
          EXPECT_EQ(a[i].code, b[i].code) << shape.name;
          EXPECT_EQ(a[i].count, b[i].count) << shape.name << ' ' << a[i].code;
        }
      }
    }
}

// ---- borders whose normals are their author's
// ---------------------------------------------------------------

// A dome whose rim leans towards the floor it stands on.
Mesh dome(int sides, int rows) {
  Mesh mesh;
  test::add_dome(mesh, sides, rows);
  for (const Vec3<double>& p : mesh.positions)
    mesh.normals.push_back(unit(p.z < 1e-9 ? p + Vec3<double>{0, 0, 1} : p));
  test::bake(mesh);
  return mesh;
}

TEST(Authored, BlendedBordersAreWarnings) {
  constexpr int sides = 32, rows = 12;
  Mesh mesh = dome(sides, rows);
  std::vector<Assessment> assessments = assess_parts(mesh);
  EXPECT_EQ(verdict(assessments), Verdict::pass) << errors(assessments);
  ASSERT_EQ(recognised(assessments), 1u);
  // Each of the rim's vertices leans by 45 degrees and has three corners.
  EXPECT_EQ(count_of(assessments, "NORMAL_ANGLE", Severity::warning), 3u * sides);

  // Somebody who declares the surface means its normals.
  AssessOptions declared;
  declared.surface = parse_specification("sphere");
  EXPECT_EQ(verdict(assess_parts(mesh, declared)), Verdict::fail);

  // In the interior, and more than 80 degrees from its own triangles, it is an error.
  const std::size_t v = 5 * (sides + 1) + 3;
  Mesh tilted = mesh;
  tilted.normals[v] = unit(mesh.normals[v] + 0.5 * mesh.tangents[v].xyz());
  tilted.tangents.clear();
  EXPECT_EQ(count_of(assess_parts(tilted), "NORMAL_ANGLE", Severity::error), 6u);
  Mesh inside_out = mesh;
  inside_out.normals[3] = -mesh.normals[3];
  inside_out.tangents.clear();
  EXPECT_EQ(count_of(assess_parts(inside_out), "NORMAL_ANGLE", Severity::error), 3u);
  // And so is a tangent that is none of its own triangles'.
  Mesh turned = mesh;
  const Vec3<double> b = cross(mesh.normals[3], mesh.tangents[3].xyz());
  turned.tangents[3] = {b.x, b.y, b.z, mesh.tangents[3].w};
  EXPECT_EQ(count_of(assess_parts(turned), "TANGENT_ANGLE", Severity::error), 3u);
}

// ---- normals that oppose their own triangles
// ----------------------------------------------------------------

TEST(Opposed, NormalsOnAPlaneAreErrors) {
  Mesh plane;
  add_grid(plane, 12, 12, [](double u, double v) { return Vec3<double>{u, v, 0}; });
  plane.normals.assign(plane.positions.size(), {0, 0, 1});
  for (const int flipped : {1, 2, 60}) {
    Mesh mesh = plane;
    std::vector<bool> is_flipped(mesh.positions.size(), false);
    for (int i = 0; i < flipped; ++i) is_flipped[static_cast<std::size_t>(30 + i)] = true;
    std::size_t corners = 0;
    for (std::size_t v = 0; v < mesh.normals.size(); ++v)
      if (is_flipped[v]) mesh.normals[v] = {0, 0, -1};
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) corners += is_flipped[v];
    const std::vector<Assessment> assessments = assess_parts(mesh);
    EXPECT_EQ(recognised(assessments), 1u);
    EXPECT_EQ(count_of(assessments, "NORMAL_ANGLE", Severity::error), corners) << flipped;
    EXPECT_EQ(errors(assessments).find("limit 5"), std::string::npos) << errors(assessments);
  }
  // All of them: the winding may be meant.
  for (auto& n : plane.normals) n = {0, 0, -1};
  EXPECT_EQ(verdict(assess_parts(plane)), Verdict::pass);
}

TEST(Opposed, OneFaceOfABoxIsAnError) {
  constexpr int n = 8;
  Mesh mesh = test::box_of_patches({1, 1, 1}, n);
  const std::size_t of_face = mesh.positions.size() / 6;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const std::size_t face = v / of_face;
    Vec3<double> normal{};
    (face / 2 == 0 ? normal.x : face / 2 == 1 ? normal.y : normal.z) = face % 2 == 0 ? -1 : 1;
    mesh.normals.push_back(face == 3 ? -normal : normal);
  }
  EXPECT_EQ(count_of(assess_parts(mesh), "NORMAL_ANGLE", Severity::error), 6u * n * n);
}

// ---- what is not looked at
// ----------------------------------------------------------------------------------

// All tangents turned about their normals. \param by_sign the other way where w is -1
Mesh turned_by(Mesh mesh, double deg, bool by_sign = false) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec4<double>& stored = mesh.tangents[v];
    const double angle = (by_sign ? stored.w : 1) * deg * pi / 180;
    const Vec3<double> t = stored.xyz(),
                       d = std::cos(angle) * t + std::sin(angle) * cross(mesh.normals[v], t);
    mesh.tangents[v] = {d.x, d.y, d.z, stored.w};
  }
  return mesh;
}

// A tube of six sides: at each vertex two triangles' planes turn by 60 degrees, on one side of it only.
TEST(OneSided, WhatTheTrianglesCannotTellIsNotWithin) {
  Mesh mesh;
  add_grid(mesh, 6, 1, [](double u, double v) { return on_ring(1, u, 3 * v); });
  mesh = test::with_averaged_normals(mesh);
  test::bake(mesh);
  AssessOptions options;
  options.references.analytic = false;
  const auto assessed = [&](double deg) { return assess(turned_by(mesh, deg), options).report; };
  EXPECT_EQ(assessed(0).verdict, Verdict::pass);
  EXPECT_EQ(assessed(0).triangles->compared, mesh.corners());
  EXPECT_EQ(assessed(0).triangles->open, 0u);
  for (const double deg : {20., 40., 70.}) {
    const MeshReport report = assessed(deg);
    EXPECT_EQ(report.verdict, Verdict::undetermined) << deg;
    EXPECT_EQ(report.triangles->compared, 0u) << deg;
    EXPECT_EQ(report.triangles->open, mesh.corners()) << deg;
  }
  EXPECT_EQ(assessed(85).verdict, Verdict::fail);
}

// A cube of smooth normals whose faces have charts of their own: the dpdu of three faces go all round its
// corners, or nearly, so that a tangent there may be anyone's average. Not where all lie one way to their own
// face.
TEST(OneSided, ChartsThatMeetDoNotExplainOneTurnOfAll) {
  const AssessOptions options;
  for (const int n : {1, 2}) {
    Mesh mesh = test::with_averaged_normals(test::box_of_patches({1, 1, 1}, n));
    test::bake(mesh);
    for (const double deg : {0., 90., 180., 270.}) {
      const MeshReport report = assess(turned_by(mesh, deg), options).report;
      EXPECT_EQ(report.verdict, deg == 0 ? Verdict::pass : Verdict::fail) << n << ", " << deg;
      ASSERT_TRUE(report.triangles);
      EXPECT_TRUE(deg != 180 || report.triangles->outside == report.triangles->compared) << n;
    }
  }
}

// A polygon with a chart of its own, whose u lies at an angle to the first edge; its v may be mirrored.
void add_polygon(Mesh& mesh, const std::vector<Vec3<double>>& points,
                 const std::vector<Vec3<double>>& normals, double angle, bool mirrored) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const Vec3<double> edge = unit(points[1] - points[0]),
                     across = cross(unit(cross(edge, points[2] - points[0])), edge),
                     x = std::cos(angle) * edge + std::sin(angle) * across,
                     y = (mirrored ? -1. : 1.) * (std::cos(angle) * across - std::sin(angle) * edge);
  for (std::size_t k = 0; k < points.size(); ++k) {
    mesh.positions.push_back(points[k]);
    mesh.normals.push_back(normals[k]);
    mesh.uvs.push_back({dot(points[k] - points[0], x) + 3 * first, dot(points[k] - points[0], y)});
  }
  for (std::uint32_t k = 2; k < points.size(); ++k)
    mesh.triangles.push_back({first, first + k - 1, first + k});
}

// A cube from -1 to 1 with bevels of one segment, each polygon a chart, half of them mirrored if asked for;
// normals are those of the six faces.
Mesh bevelled_cube(double bevel, bool mirrored, std::mt19937_64& random) {
  Mesh mesh;
  const double inner = 1 - bevel;
  const auto axis = [](int k, double length) {
    Vec3<double> v{};
    (k == 0 ? v.x : k == 1 ? v.y : v.z) = length;
    return v;
  };
  // The corner of the face along axis k, with the signs of all three axes.
  const auto corner = [&](int k, const std::array<double, 3>& s) {
    Vec3<double> p{};
    for (int j = 0; j < 3; ++j) p = p + axis(j, s[static_cast<std::size_t>(j)] * (j == k ? 1 : inner));
    return p;
  };
  const auto add = [&](std::vector<Vec3<double>> points, std::vector<Vec3<double>> normals) {
    if (dot(cross(points[1] - points[0], points[2] - points[0]), points[0] + points[1] + points[2]) < 0) {
      std::reverse(points.begin(), points.end());
      std::reverse(normals.begin(), normals.end());
    }
    add_polygon(mesh, points, normals, pi / 2 * static_cast<double>(random() % 4),
                mirrored && random() % 2 == 0);
  };
  for (int k = 0; k < 3; ++k)
    for (const double s : {-1., 1.}) {
      const auto with = [&](double a, double b) {
        std::array<double, 3> signs{};
        signs[static_cast<std::size_t>(k)] = s;
        signs[static_cast<std::size_t>((k + 1) % 3)] = a, signs[static_cast<std::size_t>((k + 2) % 3)] = b;
        return signs;
      };
      const int next = (k + 1) % 3;
      add({corner(k, with(-1, -1)), corner(k, with(1, -1)), corner(k, with(1, 1)), corner(k, with(-1, 1))},
          std::vector(4, axis(k, s)));
      for (const double a : {-1., 1.}) {
        add({corner(k, with(a, -1)), corner(next, with(a, -1)), corner(next, with(a, 1)),
             corner(k, with(a, 1))},
            {axis(k, s), axis(next, a), axis(next, a), axis(k, s)});
        for (const double b : {-1., 1.})
          if (k == 0)
            add({corner(0, with(a, b)), corner(1, with(a, b)), corner(2, with(a, b))},
                {axis(0, s), axis(1, a), axis(2, b)});
      }
    }
  return mesh;
}

// Tangents averaged over the vertices of one position, normal and sign, as by tools that know no charts.
// Where they cancel, they stay.
Mesh averaged_over_charts(const Mesh& mesh) {
  Mesh result = mesh;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    Vec3<double> sum{};
    for (std::size_t w = 0; w < mesh.positions.size(); ++w)
      if (norm(mesh.positions[w] - mesh.positions[v]) < 1e-9 &&
          norm(mesh.normals[w] - mesh.normals[v]) < 1e-9 && mesh.tangents[w].w == mesh.tangents[v].w)
        sum = sum + mesh.tangents[w].xyz();
    if (norm(sum) < 0.1) continue;
    const Vec3<double> d = unit(sum);
    result.tangents[v] = {d.x, d.y, d.z, mesh.tangents[v].w};
  }
  return result;
}

// Bevels with charts of their own: the dpdu of the others at a vertex hold nearly any direction, and tools
// that average over them are right; but not where all tangents are turned in one sense.
TEST(OneSided, BevelsDoNotExplainOneTurnOfAll) {
  std::mt19937_64 random(20261128);
  for (const double bevel : {0.05, 0.2, 0.5})
    for (int i = 0; i < 8; ++i) {
      Mesh mesh = bevelled_cube(bevel, i >= 4, random);
      test::bake(mesh);
      EXPECT_EQ(verdict(assess_parts(mesh)), Verdict::pass) << bevel;
      EXPECT_EQ(verdict(assess_parts(averaged_over_charts(mesh))), Verdict::pass) << bevel;
      for (const double deg : {45., 90., 135., 180., 270.})
        EXPECT_EQ(verdict(assess_parts(turned_by(mesh, deg))), Verdict::fail) << bevel << ", " << deg;
      EXPECT_EQ(verdict(assess_parts(turned_by(mesh, 90, true))), Verdict::fail) << bevel;
      std::string cause;
      const std::vector<Assessment> by_sign = assess_parts(turned_by(mesh, 45, true));
      for (const Finding& f : by_sign.front().report.findings)
        if (f.code == "TANGENT_UV_SET") cause = f.message;
      EXPECT_NE(cause.find(i >= 4 ? "45 deg, in mirrored charts the other way" : "45 deg, as those of uvs"),
                std::string::npos)
          << cause;
    }
}

// A smooth tube of eight sides, one vertex per corner, whose tangents are those of the triangles, not made
// perpendicular to the normals: the normals are right, though each leans on its own triangle.
TEST(OneSided, NormalsAreNotBlamedForTrianglesThatLean) {
  Mesh mesh;
  add_grid(mesh, 6, 1, [](double u, double v) { return on_ring(1, u, v); });
  mesh = test::one_vertex_per_corner(test::with_averaged_normals(mesh));
  mesh.tangents.clear();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec2<double> d = mesh.uvs[b] - mesh.uvs[a], e = mesh.uvs[c] - mesh.uvs[a];
    const Vec3<double> t =
        unit((d.x * e.y - d.y * e.x > 0 ? 1. : -1.) *
             (e.y * (mesh.positions[b] - mesh.positions[a]) - d.y * (mesh.positions[c] - mesh.positions[a])));
    for (int k = 0; k < 3; ++k) mesh.tangents.push_back({t.x, t.y, t.z, -1});
  }
  AssessOptions options;
  options.references.analytic = false;
  std::size_t found = 0;
  const MeshReport report = assess(mesh, options).report;
  for (const Finding& f : report.findings)
    if (f.code == "TANGENT_NOT_ORTHOGONAL" && f.severity == Severity::error) {
      found = f.count;
      EXPECT_TRUE(f.to_do.starts_with("project")) << f.message << ": " << f.to_do;
    }
  EXPECT_EQ(found, mesh.corners());
}

// Strips side by side, each a chart, of a mesh that is taken apart at their seams: the averages of a strip
// between two alike ones lie one way from its own uvs, and are right.
TEST(OneSided, AveragesOfAPartLieOneWay) {
  for (const double deg : {60., 90.})
    for (const bool round : {false, true}) {
      Mesh mesh;
      for (int strip = 0; strip < 3; ++strip) {
        const std::size_t first = mesh.positions.size();
        add_grid(mesh, 12, 1, [&](double u, double v) {
          return round ? on_ring(1, u, 0.5 * (strip + v)) : Vec3<double>{6 * u, 0.5 * (strip + v), 0};
        });
        const double angle = strip == 1 ? deg * pi / 180 : 0;
        for (std::size_t k = first; k < mesh.uvs.size(); ++k) {
          const double x = 6 * mesh.uvs[k].x, y = 0.5 * mesh.uvs[k].y;
          mesh.uvs[k] = {std::cos(angle) * x - std::sin(angle) * y + 20 * strip,
                         std::sin(angle) * x + std::cos(angle) * y};
        }
      }
      mesh = test::with_averaged_normals(mesh);
      test::bake(mesh);
      const std::vector<Assessment> assessments = assess_parts(averaged_over_charts(mesh));
      EXPECT_GT(assessments.size(), 1U) << deg << round;
      EXPECT_EQ(errors(assessments), "") << deg << round;
    }
}

TEST(Budget, IsSpentOnlyWhereSomethingIsLeftOut) {
  AssessOptions options;
  options.budget = 1e-9;
  Mesh plane;
  add_grid(plane, 4, 4, [](double u, double v) { return Vec3<double>{u, v, 0}; });
  plane.normals.assign(plane.positions.size(), {0, 0, 1});
  EXPECT_FALSE(has(assess_parts(plane, options), "BUDGET_SPENT"));
  const Mesh sphere = sample_mesh(make_surface("sphere"), {.columns = 16, .rows = 8});
  EXPECT_TRUE(has(assess_parts(sphere, options), "BUDGET_SPENT"));
  options.budget = 1e6;
  EXPECT_FALSE(has(assess_parts(sphere, options), "BUDGET_SPENT"));
}

// Behind forty parts that are no surface.
TEST(Brief, ASphereAmongManyUnknownPartsIsFound) {
  Mesh mesh;
  for (int k = 0; k < 40; ++k)
    add_grid(mesh, 12, 12, [k](double u, double v) {
      return Vec3<double>{3.0 * k + u, v,
                          0.2 * std::sin((3 + 0.37 * k) * u + k) * std::cos((4 - 0.05 * k) * v)};
    });
  mesh = test::with_averaged_normals(mesh);
  Mesh sphere = sample_mesh(make_surface("sphere"), {.columns = 12, .rows = 8});
  sphere.tangents.clear();
  for (auto& p : sphere.positions) p.y += 5;
  append(mesh, sphere);
  const std::vector<Assessment> assessments = assess_parts(mesh);
  ASSERT_EQ(recognised(assessments), 1u);
  for (const Assessment& j : assessments)
    if (j.fit && j.fit->fits) {
      EXPECT_EQ(j.fit->surface.surface.info().name, "sphere");
    }
  EXPECT_TRUE(has(assessments, "PARTS_IN_BRIEF"));
}

}  // namespace
}  // namespace darboux::smooth_shaded_test
