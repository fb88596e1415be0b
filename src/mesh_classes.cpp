#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include <darboux/frame.h>
#include <darboux/mesh_classes.h>
#include <darboux/mesh_frames.h>
#include <darboux/weld.h>

#include "disjoint_sets.h"

namespace darboux {
namespace {

constexpr double same = 1e-6;  // of the range

// Numbers the distinct keys within each group of vertices. `group[v]` is a representative vertex.
// Vertices of one group with keys closer than `tolerance` (to the first of their cluster) get one number. A
// group with more than `most` distinct keys (the fan of a pole) lumps the rest together: callers ask only
// "one or several".
template <class Near>
std::vector<std::uint32_t> cluster(const std::vector<std::uint32_t>& group, Near near) {
  constexpr std::size_t most = 64;
  std::vector<std::uint32_t> order(group.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return group[a] < group[b]; });
  std::vector<std::uint32_t> first_of_cluster(group.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::vector<std::uint32_t> representatives;
    std::size_t end = begin;
    for (; end < order.size() && group[order[end]] == group[order[begin]]; ++end) {
      const std::uint32_t v = order[end];
      auto found = std::find_if(representatives.begin(), representatives.end(),
                                [&](std::uint32_t r) { return near(r, v); });
      if (found == representatives.end()) {
        if (representatives.size() < most) representatives.push_back(v);
        found = std::prev(representatives.end());
      }
      first_of_cluster[v] = *found;
    }
    begin = end;
  }
  return first_of_cluster;
}

// An edge between two welded places, with the triangle it belongs to.
struct Edge {
  std::uint64_t key;
  std::uint32_t triangle;
};

template <class Id>
std::vector<Edge> sorted_edges(const Mesh& mesh, Id id) {
  std::vector<Edge> edges;
  edges.reserve(mesh.corners());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t a = id(mesh.triangles[t][k]), b = id(mesh.triangles[t][(k + 1) % 3]);
      if (a != b) edges.push_back({std::min(a, b) << 32 | std::max(a, b), t});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
  });
  return edges;
}

// Calls f(begin, end) for each run of edges between the same two places.
template <class F>
void for_each_edge(const std::vector<Edge>& edges, F f) {
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].key == edges[begin].key) ++end;
    f(begin, end);
    begin = end;
  }
}

}  // namespace

MeshClasses classify(const Mesh& mesh, const std::vector<bool>& is_pole) {
  const std::size_t n = mesh.positions.size();
  std::vector<bool> referenced(n, false);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) referenced[v] = true;
  // What counts as the same is a share of the range over vertices that triangles use and whose data are finite. The
  // others stand alone: weld leaves NaN by itself.
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox2d uv_box;
  std::vector<Vec3<double>> points(n, detail::nan_vector<double>());
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!referenced[v] || !detail::finite(mesh.positions[v])) continue;
    points[v] = mesh.positions[v];
    box.extend(to_eigen(points[v]));
    if (!mesh.uvs.empty() && std::isfinite(mesh.uvs[v].x) && std::isfinite(mesh.uvs[v].y))
      uv_box.extend(Eigen::Vector2d(mesh.uvs[v].x, mesh.uvs[v].y));
  }
  const double tolerance = box.isEmpty() ? 0 : same * box.diagonal().norm();
  const double uv_tolerance = uv_box.isEmpty() ? 0 : same * uv_box.sizes().maxCoeff();
  const std::vector<std::uint32_t> place = weld(points, tolerance);

  // The sign of uv area around each vertex: +1, -1, or 0 where no triangle has any. A vertex shared by both
  // signs counts as +1; its defect is found by the handedness of its island.
  std::vector<int> triangle_sign(mesh.triangles.size(), 0), vertex_sign(n, 0);
  if (!mesh.uvs.empty())
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      if (is_degenerate(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c])) continue;
      triangle_sign[t] = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) > 0 ? 1 : -1;
      for (const std::uint32_t v : {a, b, c})
        if (vertex_sign[v] != 1) vertex_sign[v] = triangle_sign[t];
    }

  const auto same_uv = [&](std::uint32_t a, std::uint32_t b) {
    return mesh.uvs.empty() || (std::fabs(mesh.uvs[a].x - mesh.uvs[b].x) <= uv_tolerance &&
                                std::fabs(mesh.uvs[a].y - mesh.uvs[b].y) <= uv_tolerance);
  };
  const auto same_normal = [&](std::uint32_t a, std::uint32_t b) {
    if (mesh.normals.empty()) return true;
    const Vec3<double> d = mesh.normals[a] - mesh.normals[b];
    return std::fabs(d.x) <= 2 * same && std::fabs(d.y) <= 2 * same && std::fabs(d.z) <= 2 * same;
  };

  const auto normal_cluster = cluster(place, same_normal);
  const auto chart_cluster = cluster(normal_cluster, [&](std::uint32_t a, std::uint32_t b) {
    return same_uv(a, b) && (vertex_sign[a] == vertex_sign[b] || vertex_sign[a] == 0 || vertex_sign[b] == 0);
  });
  std::vector<bool> several_charts(n, false), several_normals(n, false), ring(n, false), border(n, false);
  for (std::uint32_t v = 0; v < n; ++v) {
    if (chart_cluster[v] != chart_cluster[normal_cluster[v]]) several_charts[normal_cluster[v]] = true;
    if (normal_cluster[v] != normal_cluster[place[v]]) several_normals[place[v]] = true;
  }
  const auto pole = [&](std::uint32_t v) { return !is_pole.empty() && is_pole[v]; };
  for (const Triangle& triangle : mesh.triangles)
    if (pole(triangle[0]) || pole(triangle[1]) || pole(triangle[2]))
      for (const std::uint32_t v : triangle) ring[place[v]] = true;
  const auto edges = sorted_edges(mesh, [&](std::uint32_t v) { return place[v]; });
  for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
    if (end - begin == 1) border[edges[begin].key >> 32] = border[edges[begin].key & 0xffffffffu] = true;
  });

  MeshClasses classes;
  classes.of_vertex.resize(n);
  for (std::uint32_t v = 0; v < n; ++v)
    classes.of_vertex[v] = pole(v)                             ? VertexClass::pole
                           : several_charts[normal_cluster[v]] ? VertexClass::seam
                           : several_normals[place[v]]         ? VertexClass::crease
                           : ring[place[v]]                    ? VertexClass::pole_ring
                           : border[place[v]]                  ? VertexClass::border
                                                               : VertexClass::interior;

  // Places told apart by uv as well: a third coordinate that sets places further apart than the tolerance.
  const double apart = std::fmax(1, 4 * uv_tolerance);
  for (std::uint32_t v = 0; v < n; ++v)
    points[v] = mesh.uvs.empty() ? Vec3<double>{place[v] * apart, 0, 0}
                                 : Vec3<double>{place[v] * apart, mesh.uvs[v].x, mesh.uvs[v].y};
  const std::vector<std::uint32_t> uv_place = weld(points, uv_tolerance);
  DisjointSets islands(mesh.triangles.size());
  const auto uv_edges = sorted_edges(mesh, [&](std::uint32_t v) { return uv_place[v]; });
  for_each_edge(uv_edges, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = i + 1; j < end; ++j) {
        if (triangle_sign[uv_edges[i].triangle] != triangle_sign[uv_edges[j].triangle]) continue;
        islands.join(uv_edges[i].triangle, uv_edges[j].triangle);
        break;  // the rest of the run is joined through j
      }
  });
  classes.island_of_triangle.assign(mesh.triangles.size(), -1);
  std::vector<std::int32_t> number(mesh.triangles.size(), -1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (triangle_sign[t] == 0) continue;
    std::int32_t& island = number[islands.find(t)];
    if (island < 0) island = classes.islands++;
    classes.island_of_triangle[t] = island;
  }
  return classes;
}

}  // namespace darboux
