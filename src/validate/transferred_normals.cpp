#include "transferred_normals.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include <darboux/frame.h>

#include "angles.h"
#include "base/degrees.h"
#include "base/disjoint_sets.h"
#include "sound.h"

namespace darboux {
namespace {

struct Edge {
  std::array<std::uint32_t, 2> places;  // sorted
  std::array<std::uint32_t, 2> vertices;
};

// A vertex per place, a record per piece.
struct Piece {
  std::size_t places = 0, at_border = 0;
  double turned = 0, surface_turns = 0;  // in radians, along all edges
  bool may_be_transferred() const {
    constexpr double least = 0.1, most = 0.6;  // of the surface's turn
    return 2 * at_border >= places || (turned >= least * surface_turns && turned <= most * surface_turns);
  }
};

}  // namespace

std::vector<bool> may_be_transferred(const Mesh& mesh, const std::vector<bool>& has_area,
                                     const VertexJoins& joins, const std::vector<bool>& unsupported,
                                     const std::vector<bool>& sheet_border) {
  // Between normals at the ends of an edge. Spheres of twelve segments turn by 30 degrees, cards in a crown
  // by 45.
  constexpr double smooth = 60 / degrees_per_radian;
  const std::size_t n = mesh.positions.size();
  const std::vector<std::uint32_t>& place = joins.position;
  std::vector<Edge> edges;  // each as often as it has triangles
  DisjointSets pieces(n), regions(n);
  for (std::uint32_t v = 0; v < n; ++v) regions.join(v, joins.position_and_normal[v]);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area[t]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      if (place[a] > place[b]) std::swap(a, b);
      edges.push_back({{place[a], place[b]}, {a, b}});
      pieces.join(place[a], place[b]);
      if (unsupported[a] && unsupported[b]) regions.join(a, b);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.places < b.places; });
  std::vector<bool> border = sheet_border;
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].places == edges[i].places) ++end;
    if (end - i == 1)
      for (const std::uint32_t v : edges[i].places) border[v] = true;
  }
  const std::vector<Vec3<double>> planes = planes_of_vertices(mesh, joins);
  std::vector<Piece> piece(n);
  std::vector<bool> rough(n, false), counted(n, false);
  for (const Edge& edge : edges) {
    const auto [a, b] = edge.vertices;
    Piece& of = piece[pieces.find(place[a])];
    for (const std::uint32_t p : edge.places)
      if (!counted[p]) {
        counted[p] = true;
        ++of.places;
        of.at_border += border[p];
      }
    if (!has_direction(mesh.normals[a]) || !has_direction(mesh.normals[b])) continue;
    const double turned = angle_between(mesh.normals[a], mesh.normals[b]);
    of.turned += turned;
    if (has_direction(planes[a]) && has_direction(planes[b]))
      of.surface_turns += angle_between(planes[a], planes[b]);
    if (turned > smooth)
      for (const std::uint32_t v : {a, b})
        if (unsupported[v]) rough[regions.find(v)] = true;
  }
  std::vector<bool> result(n, false);
  for (std::uint32_t v = 0; v < n; ++v)
    result[v] =
        unsupported[v] && !rough[regions.find(v)] && piece[pieces.find(place[v])].may_be_transferred();
  return result;
}

}  // namespace darboux
