#include "transferred_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <darboux/frame.h>

#include "angles.h"
#include "base/degrees.h"
#include "base/disjoint_sets.h"
#include "mesh/area_vector.h"

namespace darboux {
namespace {

// Limit of the angle between normals at the ends of an edge. Normals turn by 30 degrees on spheres of twelve
// segments, by 45 on cards in a crown.
constexpr double smooth = 60 / degrees_per_radian;

// A connected piece; its vertices are places.
struct Piece {
  bool asked = false;
  std::size_t places = 0, at_border = 0, edges = 0, negated = 0;
  double turned = 0, surface_turns = 0;  // in radians, along all edges

  bool may_be_transferred() const {
    constexpr double least = 0.1, most = 0.6;  // of the surface's turn
    const bool is_curved = surface_turns * degrees_per_radian > static_cast<double>(edges);
    if (2 * at_border >= places) return !is_curved || negated < places;
    return is_curved && turned >= least * surface_turns && turned <= most * surface_turns;
  }
};

double angle(const Vec3<double>& a, const Vec3<double>& b) {
  return has_direction(a) && has_direction(b) ? angle_between(a, b) : 0;
}

}  // namespace

std::vector<bool> may_be_transferred(const Mesh& mesh, const std::vector<bool>& has_area,
                                     const VertexJoins& joins, const std::vector<bool>& unsupported,
                                     const std::vector<bool>& sheet_border) {
  const std::size_t n = mesh.positions.size();
  const std::vector<std::uint32_t>& place = joins.position;
  DisjointSets pieces(n);
  for (const auto& [a, b, c] : mesh.triangles)
    for (const std::uint32_t other : {b, c}) pieces.join(place[a], place[other]);
  const std::vector<std::uint32_t> piece_of = pieces.representatives();
  std::vector<Piece> piece(n);
  std::vector<bool> asked(n, false), border(n, false);  // of places
  for (std::uint32_t v = 0; v < n; ++v) {
    if (unsupported[v]) asked[place[v]] = piece[piece_of[place[v]]].asked = true;
    if (sheet_border[v]) border[place[v]] = true;
  }

  // Each edge of the requested pieces, once per triangle; and per place the sums of its triangles' areas and
  // of the normals at their corners.
  struct Edge {
    std::array<std::uint32_t, 2> places;  // sorted
    std::array<std::uint32_t, 2> vertices;
  };
  std::vector<Edge> edges;
  std::vector<Vec3<double>> plane(n), normal(n);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (!piece[piece_of[place[triangle[0]]]].asked) continue;
    const Vec3<double> area = has_area[t] ? area_vector(mesh, triangle) : Vec3<double>{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      plane[place[a]] = plane[place[a]] + area;
      if (has_area[t] && has_direction(mesh.normals[a]))
        normal[place[a]] = normal[place[a]] + unit(mesh.normals[a]);
      if (place[a] > place[b]) std::swap(a, b);
      edges.push_back({{place[a], place[b]}, {a, b}});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.places < b.places; });
  DisjointSets regions(n);  // of requested places
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].places == edges[i].places) ++end;
    const auto [a, b] = edges[i].places;
    if (end - i == 1) border[a] = border[b] = true;
    if (asked[a] && asked[b]) regions.join(a, b);
    Piece& of = piece[piece_of[a]];
    ++of.edges;
    of.turned += angle(normal[a], normal[b]);
    of.surface_turns += angle(plane[a], plane[b]);
  }
  std::vector<bool> rough(n, false), counted(n, false);
  for (const Edge& edge : edges) {
    const auto [a, b] = edge.vertices;
    const bool jumps = angle(mesh.normals[a], mesh.normals[b]) > smooth;
    for (const std::uint32_t v : edge.vertices) {
      const std::uint32_t p = place[v];
      // Normals at one place: half of that limit, measured to their mean.
      if (asked[p] && (jumps || angle(mesh.normals[v], normal[p]) > smooth / 2))
        rough[regions.find(p)] = true;
      if (counted[p]) continue;
      counted[p] = true;
      Piece& of = piece[piece_of[p]];
      ++of.places;
      of.at_border += border[p] ? 1 : 0;
      constexpr double near = 15 / degrees_per_radian;  // on smooth surfaces any average is this near
      of.negated += angle(-normal[p], plane[p]) < near ? 1 : 0;
    }
  }
  std::vector<bool> result(n, false);
  for (std::uint32_t v = 0; v < n; ++v)
    result[v] =
        unsupported[v] && !rough[regions.find(place[v])] && piece[piece_of[place[v]]].may_be_transferred();
  return result;
}

}  // namespace darboux
