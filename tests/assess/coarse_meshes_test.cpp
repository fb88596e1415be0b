// What common methods make of coarse meshes is no error, though it is far from the surface that a mesh is
// recognised as; nor is a sign that the mesh leaves open.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/triangle.h>

#include "append_mesh.h"

namespace darboux::coarse_meshes_test {
namespace {

using V = Vec3<double>;

// ---- normals and tangents as tools make them

enum class Average { uniform, area, angle, both };

// Over all triangles at a place, across seams.
void average_normals(Mesh& mesh, Average average) {
  const auto near = [&](std::uint32_t a, std::uint32_t b) {
    return norm(mesh.positions[a] - mesh.positions[b]) < 1e-9;
  };
  std::vector<V> sums(mesh.positions.size(), V{0, 0, 0});
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const V a = mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]],
              b = mesh.positions[t[(k + 2) % 3]] - mesh.positions[t[k]], across = cross(a, b);
      if (!(norm(across) > 0)) continue;
      const double by_area = average == Average::area || average == Average::both ? norm(across) : 1,
                   by_angle = average == Average::angle || average == Average::both ? angle_between(a, b) : 1;
      for (std::uint32_t v = 0; v < sums.size(); ++v)
        if (near(v, t[k])) sums[v] = sums[v] + by_area * by_angle * unit(across);
    }
  for (std::size_t v = 0; v < sums.size(); ++v)
    if (norm(sums[v]) > 0) mesh.normals[v] = unit(sums[v]);
}

void store_tangents(Mesh& mesh, std::string_view method, SignConvention sign) {
  const MeshFrames frames = mesh_frames(mesh, find_frame_method(method));
  Mesh corners = mesh;
  corners.positions.clear(), corners.normals.clear(), corners.uvs.clear(), corners.tangents.clear();
  for (std::uint32_t c = 0; c < mesh.corners(); ++c) {
    const std::uint32_t v = mesh.triangles[c / 3][c % 3];
    const V& n = mesh.normals[v];
    const V t = unit(frames.corner(c).t - dot(frames.corner(c).t, n) * n);
    corners.positions.push_back(mesh.positions[v]);
    corners.normals.push_back(n);
    corners.uvs.push_back(mesh.uvs[v]);
    const double w = sign == SignConvention::raw ? frames.corner(c).sign : -frames.corner(c).sign;
    corners.tangents.push_back({t.x, t.y, t.z, w});
    corners.triangles[c / 3][c % 3] = c;
  }
  mesh = std::move(corners);
}

// A grid of cells [0, columns] x [0, 2] with a height, uvs (x, y), and tangents of the raw sign.
Mesh sheet(std::size_t columns, double (*height)(double, double)) {
  Mesh mesh;
  for (std::size_t j = 0; j <= 2; ++j)
    for (std::size_t i = 0; i <= columns; ++i) {
      const auto x = static_cast<double>(i), y = static_cast<double>(j);
      mesh.positions.push_back({x, y, height(x, y)});
      mesh.uvs.push_back({x, y});
      mesh.normals.push_back({0, 0, 1});
      mesh.tangents.push_back({1, 0, 0, 1});
    }
  const auto at = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(j * (columns + 1) + i);
  };
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

std::string errors(const MeshReport& report) {
  std::string text;
  for (const Finding& f : report.findings)
    if (f.severity == Severity::error) text += std::string(f.code) + ": " + f.message + '\n';
  return text;
}

std::size_t count_of(const MeshReport& report, std::string_view code, Severity severity) {
  std::size_t count = 0;
  for (const Finding& f : report.findings) count += f.code == code && f.severity == severity ? f.count : 0;
  return count;
}

TEST(CoarseMeshes, AveragesAreNoErrors) {
  constexpr std::uint64_t seed = 5;
  std::cout << "seed " << seed << '\n';
  std::size_t recognised = 0, beyond = 0, coarse_warnings = 0;
  std::uint64_t number = seed;
  for (const char* surface : {"sphere", "ellipsoid:semi_axis_x=0.8,semi_axis_y=1.1,semi_axis_z=0.95",
                              "ellipsoid:semi_axis_x=1,semi_axis_y=1,semi_axis_z=0.5",
                              "torus:major_radius=1,minor_radius=0.3", "cylinder", "cone"})
    for (const int columns : {6, 8, 16, 24})
      for (const Average average : {Average::uniform, Average::area, Average::angle, Average::both}) {
        Mesh coarse = sample_mesh(make_surface(surface), {.columns = columns,
                                                          .rows = std::max(4, columns / 2),
                                                          .random_diagonals = true,
                                                          .seed = ++number});
        average_normals(coarse, average);
        for (const char* method : {"mikktspace", "average", "unit", "area", "angle", "face"}) {
          Mesh mesh = coarse;
          store_tangents(mesh, method, number % 2 == 0 ? SignConvention::raw : SignConvention::gltf);
          const Assessment assessment = assess(mesh);
          EXPECT_EQ(errors(assessment.report), "") << surface << ", " << columns << " columns, normals "
                                                   << static_cast<int>(average) << ", " << method;
          // Nothing need be named that explains them.
          for (const char* mistake : {"NORMAL_STALE", "TANGENT_STALE", "TANGENT_AXES"})
            EXPECT_EQ(count_of(assessment.report, mistake, Severity::warning), 0U)
                << surface << ", " << columns << " columns, " << method << ' ' << mistake;
          // No advice to mend what is as good as the mesh allows.
          for (const Finding& f : assessment.report.findings)
            if (f.message.find("too coarse for the recognised surface") != std::string::npos) {
              EXPECT_TRUE(f.to_do.starts_with("nothing")) << f.message << ": " << f.to_do;
              ++coarse_warnings;
            }
          recognised += assessment.fit && assessment.fit->fits;
          beyond += count_of(assessment.report, "TANGENT_ANGLE", Severity::warning) +
                    count_of(assessment.report, "NORMAL_ANGLE", Severity::warning);
        }
      }
  // Else the test would say nothing.
  EXPECT_GT(recognised, 300U);
  EXPECT_GT(beyond, 1000U);
  EXPECT_GT(coarse_warnings, 0U);
}

// Flat triangles whose normals are nearly one share their tangents, as assimp has it: dot products of 0.9999.
TEST(CoarseMeshes, NormalsThatAreNearlyOneCountAsOne) {
  Mesh mesh = sheet(8, [](double x, double y) { return 0.004 * std::sin(5 * x + 3 * y * y); });
  for (auto& uv : mesh.uvs) uv = {uv.x, uv.y + 0.3 * std::sin(9 * uv.y + 2 * uv.x)};
  average_normals(mesh, Average::area);
  store_tangents(mesh, "face", SignConvention::raw);  // one vertex per corner
  for (const auto& [a, b, c] : mesh.triangles)
    for (const std::uint32_t v : {a, b, c})
      mesh.normals[v] =
          unit(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
  const std::vector<Vec4<double>> own = mesh.tangents;
  double most = 0;
  for (std::size_t v = 0; v < own.size(); ++v) {
    V sum{0, 0, 0};
    for (std::size_t w = 0; w < own.size(); ++w)
      if (mesh.positions[w] == mesh.positions[v] && dot(mesh.normals[w], mesh.normals[v]) > 0.9999)
        sum = sum + own[w].xyz();
    const V& n = mesh.normals[v];
    const V t = unit(sum - dot(sum, n) * n);
    most = std::fmax(most, angle_between(t, own[v].xyz()));
    mesh.tangents[v] = {t.x, t.y, t.z, own[v].w};
  }
  EXPECT_GT(most, 0.1);
  EXPECT_EQ(errors(assess(mesh).report), "");
}

// Of one vertex that is off where all others are right.
TEST(CoarseMeshes, OneThatIsNoAverageIsAnError) {
  const Mesh good =
      sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.4"), {.columns = 32, .rows = 16});
  constexpr std::size_t v = 33 * 8 + 11;
  Mesh mesh = good;
  const V n = good.normals[v], t = good.tangents[v].xyz();
  mesh.normals[v] = unit(n + 0.2 * cross(n, t));
  EXPECT_EQ(count_of(assess(mesh).report, "NORMAL_ANGLE", Severity::error), 6U);
  mesh = good;
  const V turned = unit(t + 0.3 * cross(n, t));
  mesh.tangents[v] = {turned.x, turned.y, turned.z, good.tangents[v].w};
  EXPECT_EQ(count_of(assess(mesh).report, "TANGENT_ANGLE", Severity::error), 6U);
}

// ---- normals far from their triangles

// Along a sharp edge the average of both sides is nearly perpendicular to either.
TEST(SharpEdges, AveragedNormalsAreNoErrors) {
  Mesh mesh = sheet(2, [](double x, double) { return -20 * std::fabs(x - 1); });
  mesh.tangents.clear();
  average_normals(mesh, Average::area);
  constexpr std::size_t on_edge = 4;  // (1, 1)
  EXPECT_GT(mesh.normals[on_edge].z, 0.99);
  EXPECT_EQ(errors(assess(mesh).report), "");
  mesh.normals[on_edge] = {0, 1, 0};
  EXPECT_EQ(count_of(assess(mesh).report, "NORMAL_ANGLE", Severity::error), 6U);
}

// Also where the sides are parts of their own: two planes.
TEST(SharpEdges, BetweenPartsAreNoErrors) {
  Mesh mesh = sheet(16, [](double x, double) { return -20 * std::fabs(x - 8); });
  mesh.tangents.clear();
  average_normals(mesh, Average::area);
  const std::vector<Assessment> parts = assess_parts(mesh);
  EXPECT_GT(parts.size(), 1U);
  for (const Assessment& part : parts) EXPECT_EQ(errors(part.report), "");
}

// Leaves and grass are lit as what they stand on.
TEST(Cards, NormalsMayBeThoseOfTheGround) {
  Mesh mesh = sheet(1, [](double, double) { return 0.0; });
  for (auto& n : mesh.normals) n = {0, 1, 0};
  for (auto& t : mesh.tangents) t = {1, 0, 0, 1};
  const MeshReport report = assess(mesh).report;
  EXPECT_EQ(errors(report), "");
  EXPECT_EQ(count_of(report, "NORMAL_ANGLE", Severity::warning), mesh.corners());
  for (const Finding& f : report.findings)
    if (f.code == "NORMAL_ANGLE") {
      EXPECT_TRUE(f.to_do.starts_with("nothing, where cards")) << f.to_do;
    }
}

// A sheet with its back.
Mesh two_sided(const Mesh& sheet, bool shared) {
  Mesh mesh = sheet;
  if (!shared) append(mesh, sheet);
  const auto shift = static_cast<std::uint32_t>(shared ? 0 : sheet.positions.size());
  mesh.triangles.resize(sheet.triangles.size());
  for (const auto& [a, b, c] : sheet.triangles) mesh.triangles.push_back({a + shift, c + shift, b + shift});
  return mesh;
}

// With a back they are at borders as well.
TEST(Cards, NormalsOfTheGroundOnBothSides) {
  Mesh one = sheet(1, [](double, double) { return 0.0; });
  for (auto& n : one.normals) n = {0, 1, 0};
  for (const bool shared : {true, false}) {
    const Mesh mesh = two_sided(one, shared);
    const MeshReport report = assess(mesh).report;
    EXPECT_EQ(errors(report), "") << shared;
    EXPECT_EQ(count_of(report, "NORMAL_ANGLE", Severity::warning), mesh.corners()) << shared;
  }
  // The back cut along the other diagonal, as a polygon that is turned over and cut anew.
  for (const double warp : {0.0, 0.1}) {
    Mesh other = two_sided(one, false);
    const auto back = static_cast<std::uint32_t>(one.positions.size());
    other.triangles.resize(one.triangles.size());
    for (std::uint32_t a = back; a < back + 4; a += 2) {  // a row of one quad: a + 1, a + 2, a + 3
      other.triangles.push_back({a, a + 2, a + 1});
      other.triangles.push_back({a + 1, a + 2, a + 3});
    }
    for (const std::uint32_t v : {3U, back + 3}) other.positions[v].z += warp;
    const MeshReport report = assess(other).report;
    EXPECT_EQ(errors(report), "") << warp;
    // Bent quads have normals of their own, between which and those of the back some lie.
    EXPECT_GE(count_of(report, "NORMAL_ANGLE", Severity::warning), warp == 0 ? other.corners() : 8) << warp;
  }
  // The ridge of a thin wedge is no border, though its sides are folded and joined by the base.
  Mesh wedge;
  wedge.positions = {{0, 0, 1}, {0, 1, 1}, {-0.05, 0, 0}, {-0.05, 1, 0}, {0.05, 0, 0}, {0.05, 1, 0}};
  wedge.triangles = {{0, 1, 2}, {1, 3, 2}, {1, 0, 4}, {1, 4, 5}, {2, 3, 4}, {3, 5, 4}, {0, 2, 4}, {1, 5, 3}};
  wedge.normals.resize(wedge.positions.size());
  average_normals(wedge, Average::area);
  wedge.normals[0] = wedge.normals[1] = {0, 0, -1};
  EXPECT_GT(count_of(assess(wedge).report, "NORMAL_ANGLE", Severity::error), 0U);
  // In the middle of a sheet nobody lights so.
  Mesh wide = sheet(3, [](double x, double y) { return 0.1 * std::sin(3 * x + y); });
  average_normals(wide, Average::area);
  EXPECT_EQ(errors(assess(two_sided(wide, false)).report), "");
  for (const std::size_t v : {5, 6, 9, 10}) wide.normals[v] = {0, 1, 0};
  for (const bool shared : {true, false})
    EXPECT_GT(count_of(assess(two_sided(wide, shared)).report, "NORMAL_ANGLE", Severity::error), 0U)
        << shared;
}

// ---- shells turned inside out

// A toon outline: the same mesh once more, a little larger, wound the other way.
Mesh with_hull(const Mesh& inner, double scale, const V& aside = {0, 0, 0}) {
  Mesh mesh = two_sided(inner, false);
  for (std::size_t v = inner.positions.size(); v < mesh.positions.size(); ++v)
    mesh.positions[v] = scale * mesh.positions[v] + aside;
  return mesh;
}

// With flat sides of n x n quads. \param texel whether all uvs of a side are one
Mesh box(int n, bool texel) {
  Mesh result;
  for (const auto& [x, y] : {std::pair{V{1, 0, 0}, V{0, 1, 0}}, std::pair{V{0, 1, 0}, V{0, 0, 1}},
                             std::pair{V{0, 0, 1}, V{1, 0, 0}}})
    for (const double side : {1.0, -1.0}) {
      const auto first = static_cast<std::uint32_t>(result.positions.size()),
                 row = static_cast<std::uint32_t>(n + 1);
      const V normal = side * cross(x, y);
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          const double a = 2.0 * i / n - 1, b = 2.0 * j / n - 1;
          result.positions.push_back(normal + a * side * x + b * y);
          result.normals.push_back(normal);
          result.uvs.push_back(texel ? Vec2<double>{0.5, 0.5} : Vec2<double>{0.5 * a, 0.5 * b});
        }
      for (std::uint32_t k = first; k + row < result.positions.size(); ++k) {
        if ((k - first) % row == row - 1) continue;
        result.triangles.push_back({k, k + 1, k + 1 + row});
        result.triangles.push_back({k, k + 1 + row, k + row});
      }
    }
  return result;
}

TEST(Hulls, AreNoErrors) {
  Mesh smooth =
      sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.3"), {.columns = 24, .rows = 12});
  for (auto& p : smooth.positions) p.z += 0.2 * p.x * p.x;  // no surface of the catalogue
  average_normals(smooth, Average::area);
  smooth.tangents.clear();
  for (const Mesh& inner : {smooth, box(1, false), box(12, true)}) {
    EXPECT_EQ(errors(assess(inner).report), "");
    const MeshReport report = assess(with_hull(inner, 1.05)).report;
    EXPECT_EQ(errors(report), "");
    EXPECT_EQ(count_of(report, "NORMALS_OPPOSE_WINDING", Severity::warning), inner.corners());
    // A copy that stands elsewhere or aside, an inner wall, or another shape, is none.
    for (const Mesh& other :
         {with_hull(inner, 1, {9, 0, 0}), with_hull(inner, 1, {0.05, 0, 0}), with_hull(inner, 0.95)})
      EXPECT_GT(count_of(assess(other).report, "NORMAL_ANGLE", Severity::error), 0U) << inner.corners();
    Mesh other = with_hull(inner, 1.05);
    for (std::size_t v = inner.positions.size(); v < other.positions.size(); ++v)
      other.normals[v] = unit(other.normals[v] + V{0.1, 0.2, 0});
    EXPECT_GT(count_of(assess(other).report, "NORMAL_ANGLE", Severity::error), 0U) << inner.corners();
  }
}

// ---- uvs

// Seven times round over eight columns: at the vertices the uvs are those of once round the other way.
TEST(CoarseMeshes, RepeatedUvsDoNotRunBackwards) {
  for (const double times : {7.0, 5.0, 15.0, -7.0, 1.0}) {
    Mesh mesh = sample_mesh(make_surface("cylinder:radius=0.5,height=2"), {.columns = 8, .rows = 2});
    for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
      mesh.uvs[v].x *= times;
      if (times < 0)
        mesh.tangents[v] = {-mesh.tangents[v].x, -mesh.tangents[v].y, -mesh.tangents[v].z,
                            -mesh.tangents[v].w};
    }
    const MeshReport report = assess(mesh).report;
    EXPECT_EQ(errors(report), "") << times;
    EXPECT_EQ(count_of(report, "TANGENT_AXES", Severity::warning), 0U) << times;
    EXPECT_EQ(count_of(report, "TANGENT_ANGLE", Severity::warning), 0U) << times;
  }
}

// A sphere seen along an edge of the mesh: its two triangles have no uv area, and nobody sees their tangents.
TEST(CoarseMeshes, TangentsWithoutUvAreaAreNotCompared) {
  Mesh mesh = sample_mesh(make_surface("sphere"), {.topology = MeshTopology::icosphere, .subdivisions = 4});
  const Triangle edge = mesh.triangles[100];
  const V d = unit(mesh.positions[edge[1]] - mesh.positions[edge[0]]), x = unit(cross(d, V{0.1, 0.2, 1})),
          y = cross(d, x);
  for (std::size_t v = 0; v < mesh.uvs.size(); ++v)
    mesh.uvs[v] = {dot(mesh.positions[v], x), dot(mesh.positions[v], y)};
  store_tangents(mesh, "mikktspace", SignConvention::gltf);
  std::size_t without = 0;
  for (const Triangle& t : mesh.triangles) {
    const double area = signed_uv_area2(mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]);
    if (std::fabs(area) > 1e-9) continue;
    ++without;
    for (const std::uint32_t v : t) {
      const V& n = mesh.normals[v];
      const V across = unit(cross(n, x - dot(x, n) * n));
      mesh.tangents[v] = {across.x, across.y, across.z, 1};
    }
  }
  EXPECT_GE(without, 2U);
  EXPECT_EQ(errors(assess(mesh).report), "");
}

// Low-poly parts lie on one texel of a palette: any tangent will do, also MikkTSpace's (1, 0, 0) along a
// normal.
TEST(CoarseMeshes, OneTexelLeavesTangentsOpen) {
  Mesh mesh = sheet(4, [](double x, double y) { return 0.3 * std::sin(3 * x + y); });
  average_normals(mesh, Average::area);
  for (auto& uv : mesh.uvs) uv = {0.3, 0.7};
  MeshReport report = assess(mesh).report;
  EXPECT_EQ(report.verdict, Verdict::pass) << errors(report);
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    const V& n = mesh.normals[v];
    mesh.tangents[v] = {n.x, n.y, n.z, 1};
  }
  report = assess(mesh).report;
  EXPECT_EQ(report.verdict, Verdict::pass) << errors(report);
  EXPECT_EQ(count_of(report, "TANGENT_NOT_ORTHOGONAL", Severity::warning), 0U) << "nobody sees them";
  // That none was judged is said.
  EXPECT_EQ(count_of(report, "UV_WITHOUT_AREA", Severity::info), mesh.corners());
  // Without uvs nothing says that nobody sees them.
  mesh.uvs.clear();
  EXPECT_EQ(count_of(assess(mesh).report, "TANGENT_NOT_ORTHOGONAL", Severity::error), mesh.corners());
  EXPECT_EQ(count_of(assess(mesh).report, "UV_WITHOUT_AREA", Severity::info), 0U);
  for (const auto& p : mesh.positions) mesh.uvs.push_back({p.x, p.y});
  EXPECT_EQ(count_of(assess(mesh).report, "UV_WITHOUT_AREA", Severity::info), 0U);
}

// A step of 8 bits per cell is uv area.
TEST(CoarseMeshes, CoarselyStoredUvsAreUvArea) {
  Mesh mesh = sheet(12, [](double x, double y) { return 0.3 * std::sin(3 * x + y); });
  average_normals(mesh, Average::area);
  for (auto& uv : mesh.uvs) uv = {uv.x / 255, uv.y / 255};
  mesh.half_steps.uv = 0.5 / 255;
  for (auto& t : mesh.tangents) t = {0, 0, 0, 1};
  EXPECT_EQ(count_of(assess(mesh).report, "TANGENT_ZERO", Severity::error), mesh.corners());
}

// Octahedral uvs fold at the octahedron's edges. Tangents are exact on the triangle's side of a fold, and a
// polynomial over both sides is none.
TEST(CoarseMeshes, UvsMayFold) {
  for (const std::uint32_t n : {4U, 8U, 16U, 32U}) {
    Mesh mesh;
    const auto sign = [](double x) { return x < 0 ? -1.0 : 1.0; };
    const auto on_octahedron = [&](double x, double y) {
      const double z = 1 - std::fabs(x) - std::fabs(y);
      return z < 0 ? V{(1 - std::fabs(y)) * sign(x), (1 - std::fabs(x)) * sign(y), z} : V{x, y, z};
    };
    const auto coordinate = [&](std::uint32_t i) { return 2.0 * i / n - 1; };
    const auto add = [&](std::array<std::array<std::uint32_t, 2>, 3> corners) {
      double x = 0, y = 0;
      for (const auto& [i, j] : corners) x += coordinate(i) / 3, y += coordinate(j) / 3;
      const bool lower = std::fabs(x) + std::fabs(y) > 1;
      const double s = sign(x), t = sign(y);
      const V along_x = lower ? V{0, -s * t, -s} : V{1, 0, -s},
              along_y = lower ? V{-s * t, 0, -t} : V{0, 1, -t};
      Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [i, j] = corners[k];
        const V p = unit(on_octahedron(coordinate(i), coordinate(j))),
                tangent = unit(along_x - dot(along_x, p) * p);
        triangle[k] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(p);
        mesh.normals.push_back(p);
        mesh.uvs.push_back({1.0 * i / n, 1.0 * j / n});
        mesh.tangents.push_back({tangent.x, tangent.y, tangent.z, -sign(dot(cross(p, tangent), along_y))});
      }
      const V &a = mesh.positions[triangle[0]], &b = mesh.positions[triangle[1]],
              &c = mesh.positions[triangle[2]];
      if (dot(cross(b - a, c - a), a + b + c) < 0) std::swap(triangle[1], triangle[2]);
      mesh.triangles.push_back(triangle);
    };
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        // Along the folds.
        if ((i < n / 2) != (j < n / 2)) {
          add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
          add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
        } else {
          add({{{i, j}, {i + 1, j}, {i, j + 1}}});
          add({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
        }
      }
    const MeshReport report = assess(mesh).report;
    EXPECT_EQ(report.verdict, Verdict::pass) << n;
    // Where folds meet, directions go all round, so that triangles do not speak for a tangent.
    EXPECT_LE(count_of(report, "TANGENT_ANGLE", Severity::warning), n == 8 ? 4U : 0U) << n;
    if (n < 16) continue;
    // One of them between folds, turned: a warning, as one corner may lie at a sliver.
    const auto between = static_cast<std::size_t>(
        std::find_if(mesh.uvs.begin(), mesh.uvs.end(),
                     [](const Vec2<double>& uv) { return uv.x == 0.625 && uv.y == 0.375; }) -
        mesh.uvs.begin());
    ASSERT_LT(between, mesh.uvs.size());
    const V t = cross(mesh.normals[between], mesh.tangents[between].xyz());
    mesh.tangents[between] = {t.x, t.y, t.z, mesh.tangents[between].w};
    EXPECT_EQ(count_of(assess(mesh).report, "TANGENT_ANGLE", Severity::warning), 1U) << n;
  }
}

// ---- signs

// Of any vertex of a coarse tube.
TEST(Signs, OfOneVertexAreErrors) {
  Mesh mesh = sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.3"),
                          {.columns = 24, .rows = 8, .random_diagonals = true});
  for (auto& p : mesh.positions) p.z += 0.2 * p.x * p.x;  // no surface of the catalogue
  for (auto& uv : mesh.uvs) uv.y *= 30;
  average_normals(mesh, Average::area);
  const MeshFrames frames = mesh_frames(mesh, find_frame_method("unit"));
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const V& t = frames.corner(c).t;
    mesh.tangents[mesh.triangles[c / 3][c % 3]] = {t.x, t.y, t.z, -frames.corner(c).sign};
  }
  AssessOptions options;
  options.references.analytic = false;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    Mesh flipped = mesh;
    flipped.tangents[v].w *= -1;
    EXPECT_GT(count_of(assess(flipped, options).report, "TANGENT_HANDEDNESS", Severity::error), 0U) << v;
  }
}

// Where a normal opposes its triangle, w follows the winding (MikkTSpace) or the side of n × t (Lengyel).
TEST(Signs, OfNormalsThatOpposeTheirTriangleAreOpen) {
  const auto wave = [](double x, double y) { return 0.3 * std::sin(2 * x) + 0.2 * std::cos(3 * y); };
  for (const double w : {1.0, -1.0}) {
    Mesh mesh = sheet(12, +wave);
    average_normals(mesh, Average::area);
    store_tangents(mesh, "unit", SignConvention::raw);
    const std::size_t c = 30;
    mesh.normals[c] = -mesh.normals[c];
    mesh.tangents[c].w = w;
    EXPECT_EQ(count_of(assess(mesh).report, "TANGENT_HANDEDNESS", Severity::error), 0U) << w;
    mesh.normals[c] = -mesh.normals[c];
    EXPECT_EQ(count_of(assess(mesh).report, "TANGENT_HANDEDNESS", Severity::error), w < 0 ? 1U : 0U) << w;
  }
}

// A triangle that the uvs flatten but for 1e-17, as the sine of a half turn does.
TEST(Signs, OfUvAreaByRoundingAreOpen) {
  for (const double area : {1e-17, 1e-2}) {
    Mesh mesh = sheet(6, [](double x, double y) { return 0.3 * std::sin(x) + 0.2 * y * y; });
    average_normals(mesh, Average::area);
    for (auto& uv : mesh.uvs) uv.y -= 1;
    store_tangents(mesh, "unit", SignConvention::raw);
    const std::uint32_t t = 2 * (6 + 3);  // its first edge lies on v = 0
    for (const std::uint32_t v : mesh.triangles[t]) mesh.tangents[v].w = -1;
    mesh.uvs[mesh.triangles[t][2]] = {mesh.uvs[mesh.triangles[t][0]].x, area};
    EXPECT_EQ(count_of(assess(mesh).report, "TANGENT_HANDEDNESS", Severity::error), area > 1e-3 ? 3U : 0U)
        << area;
  }
}

// At a tip that uvs go round, no w is right for all triangles.
TEST(Signs, OfTipsThatUvsGoRoundAreOpen) {
  constexpr std::uint32_t sides = 12;
  Mesh mesh;
  mesh.positions.push_back({0, 0, 1});
  mesh.uvs.push_back({0.5, 1});
  for (std::uint32_t i = 0; i <= sides; ++i) {  // a seam
    const double angle = 2 * M_PI * (i % sides) / sides;
    mesh.positions.push_back({std::cos(angle), std::sin(angle), 0});
    mesh.uvs.push_back({static_cast<double>(i) / sides, 0});
  }
  for (std::uint32_t i = 0; i < sides; ++i) mesh.triangles.push_back({0, 1 + i, 2 + i});
  mesh.normals.resize(mesh.positions.size());
  average_normals(mesh, Average::area);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const V& p = mesh.positions[v];
    const V t = v == 0 ? V{1, 0, 0} : unit(V{-p.y, p.x, 0});
    mesh.tangents.push_back({t.x, t.y, t.z, 1});
  }
  for (const std::uint32_t v : {0U, 3U}) {
    Mesh flipped = mesh;
    flipped.tangents[v].w = -1;
    const std::size_t n = count_of(assess(flipped).report, "TANGENT_HANDEDNESS", Severity::error);
    EXPECT_EQ(n > 0, v != 0) << v;
  }
}

}  // namespace
}  // namespace darboux::coarse_meshes_test
