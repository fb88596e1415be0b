#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <darboux/error.h>
#include <darboux/mesh_classes.h>
#include <darboux/triangle.h>
#include <darboux/weld.h>

#include "base/disjoint_sets.h"
#include "base/text.h"
#include "edges.h"
#include "triangle_signs.h"
#include "vertex_joins.h"

namespace darboux {
namespace {

constexpr double same = 1e-6;  // of the range

// For each vertex, the first that counts as the same.
using First = std::vector<std::uint32_t>;

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void extend(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double size() const { return std::max(high - low, 0.0); }
};

std::vector<bool> vertices_in_use(const Mesh& mesh) {
  std::vector<bool> in_use(mesh.positions.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) in_use[v] = true;
  return in_use;
}

// A share of the range, taken over used vertices with finite data.
double position_tolerance(const Mesh& mesh, const std::vector<bool>& in_use) {
  Range x, y, z;
  for (std::size_t i = 0; i < in_use.size(); ++i) {
    const Vec3<double>& p = mesh.positions[i];
    if (in_use[i] && detail::finite(p)) x.extend(p.x), y.extend(p.y), z.extend(p.z);
  }
  return same * norm(Vec3<double>{x.size(), y.size(), z.size()});
}

double uv_tolerance(const Mesh& mesh) {
  if (mesh.uvs.empty()) return 0;
  const std::vector<bool> in_use = vertices_in_use(mesh);
  Range u, v;
  for (std::size_t i = 0; i < in_use.size(); ++i) {
    const Vec2<double>& uv = mesh.uvs[i];
    if (!in_use[i] || !detail::finite(mesh.positions[i]) || !std::isfinite(uv.x) || !std::isfinite(uv.y))
      continue;
    u.extend(uv.x), v.extend(uv.y);
  }
  return same * std::max(u.size(), v.size());
}

// Groups by position. Vertices that no triangle uses stay single: they become NaN, which weld() leaves
// single.
First places(const Mesh& mesh, const std::vector<bool>& in_use, double tolerance) {
  if (std::find(in_use.begin(), in_use.end(), false) == in_use.end()) return weld(mesh.positions, tolerance);
  std::vector<Vec3<double>> points = mesh.positions;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (!in_use[v]) points[v] = detail::nan_vector<double>();
  return weld(points, tolerance);
}

// Groups by place and normal. At a place with more than `most` normals (the fan of a pole) the rest form one
// group: only "one or several" matters.
First normals(const Mesh& mesh, const First& place) {
  if (mesh.normals.empty()) return place;
  constexpr int most = 64;
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  const auto near = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3<double> d = mesh.normals[a] - mesh.normals[b];
    return std::fabs(d.x) <= 2 * same && std::fabs(d.y) <= 2 * same && std::fabs(d.z) <= 2 * same;
  };
  First normal = place;
  std::vector<std::uint32_t> next(place.size(), none);  // the first vertex of the place's next normal
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    std::uint32_t& first = normal[v];
    for (int count = 1; first != v && !near(first, v); ++count) {
      if (next[first] == none && count < most) next[first] = v;
      if (next[first] == none) break;
      first = next[first];
    }
  }
  return normal;
}

// Groups by place and uv.
First uv_places(const Mesh& mesh, const First& place, double tolerance) {
  if (mesh.uvs.empty()) return place;
  // Nearly all places have only one uv.
  std::vector<bool> one(place.size(), true);
  for (std::uint32_t v = 0; v < place.size(); ++v)
    if (mesh.uvs[v] != mesh.uvs[place[v]]) one[place[v]] = false;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < place.size(); ++v)
    if (!one[place[v]]) vertices.push_back(v);
  // The place as a third coordinate, in which different places are farther apart than the tolerance.
  const double apart = std::max(1.0, 4 * tolerance);
  std::vector<Vec3<double>> points(vertices.size());
  std::transform(vertices.begin(), vertices.end(), points.begin(), [&](std::uint32_t v) {
    return Vec3<double>{place[v] * apart, mesh.uvs[v].x, mesh.uvs[v].y};
  });
  const std::vector<std::uint32_t> first = weld(points, tolerance);
  First uv_place = place;
  for (std::size_t i = 0; i < vertices.size(); ++i) uv_place[vertices[i]] = vertices[first[i]];
  return uv_place;
}

// The sign of the triangles around each vertex: +1, -1, or 0 if none has a sign. A vertex shared by both
// signs counts as +1; its defect is found by the handedness of its island.
std::vector<std::int8_t> signs_of_vertices(const Mesh& mesh, std::span<const signed char> triangle_sign) {
  std::vector<std::int8_t> signs(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < triangle_sign.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (triangle_sign[t] != 0 && signs[v] != 1) signs[v] = triangle_sign[t];
  return signs;
}

// Marks seams and creases, except at poles; other vertices are interior.
std::vector<VertexClass> seams_and_creases(const Mesh& mesh, const First& place, const First& normal,
                                           std::span<const signed char> triangle_sign, double uv_tolerance) {
  std::vector<std::int8_t> sign = signs_of_vertices(mesh, triangle_sign);
  const auto same_chart = [&](std::uint32_t a, std::uint32_t b) {
    return mesh.uvs.empty() ||
           (std::fabs(mesh.uvs[a].x - mesh.uvs[b].x) <= uv_tolerance &&
            std::fabs(mesh.uvs[a].y - mesh.uvs[b].y) <= uv_tolerance && sign[a] * sign[b] >= 0);
  };
  std::vector<bool> several_normals(place.size(), false), several_charts(place.size(), false);
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    const std::uint32_t first = normal[v];
    if (first != place[v]) several_normals[place[v]] = true;
    if (first != v && !same_chart(first, v)) several_charts[first] = true;
    if (sign[first] == 0) sign[first] = sign[v];  // the first nonzero sign
  }
  std::vector<VertexClass> classes(place.size(), VertexClass::interior);
  for (std::uint32_t v = 0; v < place.size(); ++v)
    if (several_charts[normal[v]])
      classes[v] = VertexClass::seam;
    else if (several_normals[place[v]])
      classes[v] = VertexClass::crease;
  return classes;
}

// Marks places on edges with one triangle, and joins triangles of one sign over edges that share position and
// uv.
void walk_edges(const Mesh& mesh, const First& place, const First& uv_place,
                std::span<const signed char> sign, std::vector<bool>& border, DisjointSets& islands) {
  struct Edge {
    std::uint64_t greater_and_low, high_and_sign;  // its greater place; its two uvs; the triangle's sign
    std::uint32_t triangle;
    std::uint32_t greater() const { return static_cast<std::uint32_t>(greater_and_low >> 32); }
    bool same(const Edge& b) const {
      return greater_and_low == b.greater_and_low && high_and_sign == b.high_and_sign;
    }
    bool operator<(const Edge& b) const {
      return greater_and_low != b.greater_and_low ? greater_and_low < b.greater_and_low
                                                  : high_and_sign < b.high_and_sign;
    }
  };
  const EdgesByNode by_place(mesh.triangles.size(), place.size(),
                             [&](std::uint32_t t, std::uint32_t k) { return place[mesh.triangles[t][k]]; });
  std::vector<Edge> edges;
  for (std::uint32_t smaller = 0; smaller < place.size(); ++smaller) {
    edges.clear();
    for (const std::uint32_t edge : by_place[smaller]) {
      const std::uint32_t t = edge / 3, v = mesh.triangles[t][edge % 3],
                          w = mesh.triangles[t][(edge + 1) % 3];
      const auto [low, high] = std::minmax(uv_place[v], uv_place[w]);
      if (low == high) continue;
      edges.push_back({std::uint64_t{std::max(place[v], place[w])} << 32 | low,
                       std::uint64_t{high} << 2 | static_cast<std::uint64_t>(sign[t] + 1), t});
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Edge& edge = edges[i];
      const std::uint32_t greater = edge.greater();
      const auto shared = [&](std::size_t j) { return j < edges.size() && edges[j].greater() == greater; };
      if (greater != smaller && !shared(i - 1) && !shared(i + 1)) border[smaller] = border[greater] = true;
      if (i > 0 && edges[i - 1].same(edge)) islands.join(edges[i - 1].triangle, edge.triangle);
    }
  }
}

// Places with one normal where islands of one sign meet. Their uvs may be equal there, as at the corner of
// three faces of a cube with the same texture.
std::vector<bool> meeting_places(const Mesh& mesh, const First& normal, std::span<const signed char> sign,
                                 const MeshClasses& classes) {
  std::vector<bool> several(normal.size(), false);
  if (classes.islands < 2) return several;
  std::vector<std::array<int, 2>> first(normal.size(), {-1, -1});
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const int island = classes.island_of_triangle[t];
    if (island < 0) continue;
    for (const std::uint32_t v : mesh.triangles[t]) {
      int& there = first[normal[v]][sign[t] > 0 ? 1 : 0];
      if (there < 0) there = island;
      if (there != island) several[normal[v]] = true;
    }
  }
  return several;
}

}  // namespace

MeshClasses classify(const Mesh& mesh, const std::vector<bool>& is_pole) {
  check_consistent(mesh, "mesh");
  if (!is_pole.empty() && is_pole.size() != mesh.positions.size())
    throw MeshError(
        "mesh", expected_got("no poles or one entry per position, " + std::to_string(mesh.positions.size()),
                             std::to_string(is_pole.size())));
  return classify(mesh, is_pole, triangle_signs(mesh), join_vertices(mesh));
}

VertexJoins join_vertices(const Mesh& mesh) {
  const std::vector<bool> in_use = vertices_in_use(mesh);
  VertexJoins joins;
  joins.position = places(mesh, in_use, position_tolerance(mesh, in_use));
  joins.position_and_normal = normals(mesh, joins.position);
  return joins;
}

MeshClasses classify(const Mesh& mesh, const std::vector<bool>& is_pole, std::span<const signed char> sign,
                     const VertexJoins& joins) {
  const std::size_t n = mesh.positions.size();
  const double tolerance = uv_tolerance(mesh);
  const First& place = joins.position;
  MeshClasses classes;
  classes.of_vertex = seams_and_creases(mesh, place, joins.position_and_normal, sign, tolerance);
  std::vector<bool> ring(n, false), border(n, false);
  const auto pole = [&](std::uint32_t v) { return !is_pole.empty() && is_pole[v]; };
  for (const Triangle& triangle : mesh.triangles)
    if (pole(triangle[0]) || pole(triangle[1]) || pole(triangle[2]))
      for (const std::uint32_t v : triangle) ring[place[v]] = true;
  DisjointSets islands(mesh.triangles.size());
  walk_edges(mesh, place, uv_places(mesh, place, tolerance), sign, border, islands);
  classes.island_of_triangle.assign(mesh.triangles.size(), -1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (sign[t] == 0) continue;
    const std::uint32_t first = islands.find(t);
    classes.island_of_triangle[t] = first == t ? classes.islands++ : classes.island_of_triangle[first];
  }
  const std::vector<bool> several = meeting_places(mesh, joins.position_and_normal, sign, classes);
  for (std::uint32_t v = 0; v < n; ++v) {
    VertexClass& of_vertex = classes.of_vertex[v];
    of_vertex = pole(v)                                 ? VertexClass::pole
                : of_vertex != VertexClass::interior    ? of_vertex
                : ring[place[v]]                        ? VertexClass::pole_ring
                : border[place[v]]                      ? VertexClass::border
                : several[joins.position_and_normal[v]] ? VertexClass::seam
                                                        : VertexClass::interior;
  }
  return classes;
}

}  // namespace darboux
