// Vertices and facets that say less than a smooth mesh does: wrapped seams whose vertices are shared, slivers
// of no uv area, facets that were cut into pieces.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>
#include <darboux/sample_mesh.h>

#include "mesh/frames/corner.h"

namespace darboux::shared_vertices_test {
namespace {

using V = Vec3<double>;

std::string errors(const MeshReport& report) {
  std::string text;
  for (const Finding& f : report.findings)
    if (f.severity == Severity::error) text += std::string(f.code) + ": " + f.message + '\n';
  return text;
}

// Per vertex the sum of its triangles' dpdu, each as long as it is (E. Lengyel, as three.js has it), in the
// vertex's plane; w by the sum of dpdv.
void store_sums(Mesh& mesh) {
  std::vector<V> along(mesh.positions.size(), V{0, 0, 0}), across = along;
  for (const Triangle& t : mesh.triangles) {
    const V a = mesh.positions[t[1]] - mesh.positions[t[0]], b = mesh.positions[t[2]] - mesh.positions[t[0]];
    const Vec2<double> p = mesh.uvs[t[1]] - mesh.uvs[t[0]], q = mesh.uvs[t[2]] - mesh.uvs[t[0]];
    const double area = p.x * q.y - p.y * q.x;
    if (area == 0) continue;
    for (const std::uint32_t v : t) {
      along[v] = along[v] + (q.y / area) * a - (p.y / area) * b;
      across[v] = across[v] + (p.x / area) * b - (q.x / area) * a;
    }
  }
  mesh.tangents.clear();
  for (std::size_t v = 0; v < along.size(); ++v) {
    const V& n = mesh.normals[v];
    const V s = along[v] - dot(along[v], n) * n;
    const V t = norm(s) > 0 ? unit(s) : any_perpendicular(n);
    mesh.tangents.push_back({t.x, t.y, t.z, dot(cross(n, t), across[v]) < 0 ? -1.0 : 1.0});
  }
}

// The triangles of the last column run back through all uvs. Their vertices in the first column serve the
// others, as their other corners show: 36 of the torus's corners were errors.
TEST(SharedVertices, WrappedSeamsAreWarnings) {
  for (const char* surface : {"cylinder", "torus:major_radius=1,minor_radius=0.4"}) {
    constexpr int columns = 32;
    Mesh mesh = sample_mesh(make_surface(surface), {.columns = columns, .rows = 16, .shared_seam = true});
    store_sums(mesh);
    const MeshReport report = assess(mesh).report;
    EXPECT_EQ(errors(report), "") << surface;
    std::size_t across = 0;
    for (const Finding& f : report.findings) across += f.code == "VERTEX_ACROSS_MIRROR" ? f.count : 0;
    EXPECT_GT(across, 0U) << surface;
    // A vertex there that serves neither is still wrong.
    std::size_t v = 0;
    while (v + 1 < mesh.uvs.size() && !(mesh.uvs[v].x == 0 && mesh.uvs[v].y > 0.4 && mesh.uvs[v].y < 0.6))
      ++v;
    const V n = mesh.normals[v], t = mesh.tangents[v].xyz(),
            turned = std::cos(0.7) * t + std::sin(0.7) * cross(n, t);
    mesh.tangents[v] = {turned.x, turned.y, turned.z, mesh.tangents[v].w};
    EXPECT_NE(errors(assess(mesh).report).find("TANGENT_ANGLE"), std::string::npos) << surface;
  }
}

// Each triangle in `parts` squared, positions linear, normals and tangents interpolated and made unit.
Mesh cut(const Mesh& mesh, int parts) {
  Mesh result;
  std::map<std::array<std::uint32_t, 6>, std::uint32_t> vertices;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](int i, int j) {
      const std::array<int, 3> weight{parts - i - j, i, j};
      std::array<std::pair<std::uint32_t, std::uint32_t>, 3> by{};
      V p{0, 0, 0}, n = p, s = p;
      Vec2<double> uv{0, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        const double w = static_cast<double>(weight[k]) / parts;
        p = p + w * mesh.positions[t[k]];
        n = n + w * mesh.normals[t[k]];
        s = s + w * mesh.tangents[t[k]].xyz();
        uv = uv + w * mesh.uvs[t[k]];
        by[k] = {weight[k] > 0 ? t[k] : 0, static_cast<std::uint32_t>(weight[k])};
      }
      std::sort(by.begin(), by.end());
      const auto [found, is_new] = vertices.try_emplace(
          {by[0].first, by[0].second, by[1].first, by[1].second, by[2].first, by[2].second},
          static_cast<std::uint32_t>(result.positions.size()));
      if (is_new) {
        n = unit(n);
        s = unit(s - dot(s, n) * n);
        result.positions.push_back(p);
        result.normals.push_back(n);
        result.uvs.push_back(uv);
        result.tangents.push_back({s.x, s.y, s.z, mesh.tangents[t[0]].w});
      }
      return found->second;
    };
    for (int i = 0; i < parts; ++i)
      for (int j = 0; i + j < parts; ++j) {
        result.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 2 <= parts) result.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  return result;
}

// A tessellator that interpolates shades as the coarse mesh did: 36 corners of the cone were errors, 8
// degrees outside of their facets' directions.
TEST(SharedVertices, PiecesOfFacetsHaveInterpolatedFrames) {
  const std::array<std::pair<const char*, SampleMeshOptions>, 2> coarse{
      {{"cone", {.columns = 8, .rows = 4}}, {"sphere", {.columns = 12, .rows = 6}}}};
  for (const auto& [surface, options] : coarse) {
    Mesh mesh = cut(sample_mesh(make_surface(surface), options), 4);
    EXPECT_EQ(errors(assess(mesh).report), "") << surface;
    for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
      const V n = mesh.normals[v], t = mesh.tangents[v].xyz(),
              turned = std::cos(0.7) * t + std::sin(0.7) * cross(n, t);
      mesh.tangents[v] = {turned.x, turned.y, turned.z, mesh.tangents[v].w};
    }
    EXPECT_NE(errors(assess(mesh).report), "") << surface << ", all turned";
  }
}

// A triangle whose uv area is rounding may draw a sum of dpdu anywhere.
TEST(SharedVertices, SliversOfNoUvAreaMayDrawAverages) {
  Mesh mesh = sample_mesh(make_surface("sphere"), {.columns = 48, .rows = 24});
  // A vertex in the middle of a triangle moves to an edge, so that the uvs of one of three pieces have no
  // area but what rounding leaves.
  const std::size_t first = mesh.triangles.size() / 2 + 10;
  const Triangle t = mesh.triangles[first];
  const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
  const auto at = [&](double x, double y) {
    return (1 - x - y) * mesh.uvs[t[0]] + x * mesh.uvs[t[1]] + y * mesh.uvs[t[2]];
  };
  const Vec2<double> uv = at(0, 0.5), place = at(0.04, 0.48);
  const Sample<double> s = make_surface("sphere").sample(place.x, place.y);
  mesh.positions.push_back(s.jet.position);
  mesh.normals.push_back(s.frame.n);
  mesh.uvs.push_back(uv);
  mesh.triangles[first] = {t[0], t[1], middle};
  mesh.triangles.push_back({t[1], t[2], middle});
  mesh.triangles.push_back({t[2], t[0], middle});
  for (auto& p : mesh.uvs) p = {static_cast<float>(p.x), static_cast<float>(p.y)};
  mesh.uvs[middle].x = std::nextafter(static_cast<float>(mesh.uvs[middle].x), 1.0F);
  store_sums(mesh);
  EXPECT_EQ(errors(assess(mesh).report), "");
}

}  // namespace
}  // namespace darboux::shared_vertices_test
