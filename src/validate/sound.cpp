#include "sound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include <darboux/mesh_frames.h>

#include "angles.h"
#include "base/bounds.h"
#include "base/degrees.h"
#include "base/flatten.h"
#include "mesh/area_vector.h"
#include "mesh/frames/creases.h"
#include "mesh/largest_coordinate.h"
#include "normal_cones.h"
#include "rounding.h"
#include "transferred_normals.h"

namespace darboux {
namespace {

constexpr double faceted_deg = 0.1;
constexpr double most_against = 0.99;

// The plane of a triangle with area, and how much rounding of its positions may turn it.
struct Plane {
  Vec3<double> normal;  // unit
  double uncertain;     // the sine of that angle; 1: the plane is unknown
  // Invisible: the area is below a thousandth of its rounding error, so corners were meant to coincide or to
  // be collinear; or it is within that error, and the triangle is a hundred times as long as high.
  bool vanishes;
};

class Planes {
 public:
  explicit Planes(const Mesh& mesh) : mesh_(mesh), scale_(1) {
    if (const double largest = largest_coordinate(mesh.positions); largest > 0)
      scale_ = std::ldexp(1.0, -std::clamp(std::ilogb(largest) + 1, -1000, 1000));
  }

  DARBOUX_FLATTEN Plane operator()(std::uint32_t t) const {
    const auto& [i, j, k] = mesh_.triangles[t];
    const std::array<Vec3<double>, 3> p{scale_ * mesh_.positions[i], scale_ * mesh_.positions[j],
                                        scale_ * mesh_.positions[k]};
    const Vec3<double> e1 = p[1] - p[0], e2 = p[2] - p[0], across = cross(e1, e2);
    const double twice_area = norm(across);
    double size = 0;
    for (const Vec3<double>& q : p) size = std::max({size, std::fabs(q.x), std::fabs(q.y), std::fabs(q.z)});
    const double step = half_step(scale_ * mesh_.half_steps.position, size);
    const double error = 2 * std::numbers::sqrt3 * step * (norm(e1) + norm(e2) + 2 * step);
    const Vec3<double> e3 = p[2] - p[1];
    const double longest = std::max({dot(e1, e1), dot(e2, e2), dot(e3, e3)});
    constexpr double sliver = 100;
    return {across / twice_area, std::min(error / twice_area, 1.0),
            twice_area < 1e-3 * error || (twice_area <= error && sliver * twice_area <= longest)};
  }

 private:
  const Mesh& mesh_;
  double scale_;
};

// Keeps the candidates that have a neighbour in another plane with other normals at their common edge.
void keep_faceted(const Mesh& mesh, const std::vector<bool>& has_area, const VertexJoins& joins,
                  const Planes& planes, std::vector<bool>& candidates) {
  // Only triangles that touch a candidate matter.
  std::vector<bool> near(mesh.positions.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (candidates[t])
      for (const std::uint32_t v : mesh.triangles[t]) near[joins.position[v]] = true;
  std::vector<std::uint32_t> about;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    int touching = 0;
    for (const std::uint32_t v : mesh.triangles[t]) touching += near[joins.position[v]];
    if (touching >= 2) about.push_back(t);
  }
  std::vector<bool> result(candidates.size(), false);
  const double rounding = std::numbers::sqrt3 * half_step(mesh.half_steps.normal, 1);
  for_each_shared_edge(
      about.size(), mesh.positions.size(),
      [&](std::uint32_t i, std::uint32_t k) { return joins.position[mesh.triangles[about[i]][k]]; },
      [&](const SharedEdge& e) {
        const std::uint32_t a = about[e.triangle[0]], b = about[e.triangle[1]];
        if (!(candidates[a] && !result[a]) && !(candidates[b] && !result[b])) return;
        const auto normal_at = [&](std::uint32_t t, std::uint32_t place) {
          for (const std::uint32_t v : mesh.triangles[t])
            if (joins.position[v] == place) return joins.position_and_normal[v];
          return place;
        };
        if (normal_at(a, e.node[0]) == normal_at(b, e.node[0]) &&
            normal_at(a, e.node[1]) == normal_at(b, e.node[1]))
          return;
        if (!has_area[a] || !has_area[b]) return;
        const Plane p = planes(a), q = planes(b);
        const double turn = angle_between(p.normal, q.normal),
                     allowed = faceted_deg / degrees_per_radian + p.uncertain + q.uncertain + rounding;
        if (!(turn > allowed)) return;
        result[a] = result[a] || candidates[a];
        result[b] = result[b] || candidates[b];
      });
  candidates = std::move(result);
}

// Triangles that lie on the back of another: at the same places, wound the other way.
std::vector<bool> backs_of_sheets(const Mesh& mesh, const std::vector<bool>& has_area,
                                  const std::vector<std::uint32_t>& place) {
  struct Places {
    Triangle sorted;
    bool odd;  // whether sorting the places was an odd permutation
    std::uint32_t triangle;
    auto operator<=>(const Places&) const = default;
  };
  std::vector<Places> list;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area[t]) continue;
    auto [a, b, c] = mesh.triangles[t];
    a = place[a], b = place[b], c = place[c];
    Places places{{a, b, c}, ((a > b) != (b > c)) != (a > c), t};
    std::sort(places.sorted.begin(), places.sorted.end());
    list.push_back(places);
  }
  std::sort(list.begin(), list.end());
  std::vector<bool> result(mesh.triangles.size(), false);
  for (std::size_t i = 1; i < list.size(); ++i)
    if (list[i].sorted == list[i - 1].sorted &&
        (list[i].odd != list[i - 1].odd || result[list[i - 1].triangle]))
      result[list[i].triangle] = true;
  return result;
}

// Vertices at the borders of sheets that lie back to back and thus have no open edges. They lie on edges that
// have one triangle, not counting triangles on the back of another. Or the edge has two triangles that are
// folded onto each other, halves of a quad that is cut along one diagonal in front and along the other
// behind. Larger polygons that are cut in two ways are not found.
std::vector<bool> borders_of_sheets(const Mesh& mesh, const std::vector<bool>& has_area, const Planes& planes,
                                    const std::vector<std::uint32_t>& place) {
  static const double folded = -std::cos(15 / degrees_per_radian);
  std::vector<bool> result(mesh.positions.size(), false);
  const std::vector<bool> back = backs_of_sheets(mesh, has_area, place);
  using Places = std::array<std::uint32_t, 3>;
  const auto sorted = [](Places places) {
    std::sort(places.begin(), places.end());
    return places;
  };
  struct Edge {
    std::array<std::uint32_t, 2> ends;  // places
    std::uint32_t third, triangle;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  std::vector<Places> triangles;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area[t] || back[t]) continue;
    const auto at = [&](std::size_t k) { return place[mesh.triangles[t][k % 3]]; };
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back({{std::min(at(k), at(k + 1)), std::max(at(k), at(k + 1))}, at(k + 2), t});
    triangles.push_back(sorted({at(0), at(1), at(2)}));
  }
  std::sort(edges.begin(), edges.end());
  std::sort(triangles.begin(), triangles.end());
  const auto are_cut_both_ways = [&](const Edge& a, const Edge& b) {
    return dot(planes(a.triangle).normal, planes(b.triangle).normal) < folded &&
           std::all_of(a.ends.begin(), a.ends.end(), [&](std::uint32_t end) {
             return std::binary_search(triangles.begin(), triangles.end(), sorted({a.third, b.third, end}));
           });
  };
  // A mesh without backs has open edges at its borders.
  const bool any_back = std::find(back.begin(), back.end(), true) != back.end();
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].ends == edges[i].ends) ++end;
    if (end - i == 1 ? any_back : end - i == 2 && are_cut_both_ways(edges[i], edges[i + 1]))
      for (const std::uint32_t v : edges[i].ends) result[v] = true;
  }
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = result[place[v]];
  return result;
}

// Triangles with requested vertices that belong to a shell turned inside out around the same mesh, as toon
// outlines do. They oppose their normals, and near each is a triangle that does not, with the same normals
// and uvs in the opposite order. As a whole they lie outside these, or coincide with them; an inner wall does
// not, nor does a moved copy.
std::vector<bool> insides_of_hulls(const Mesh& mesh, const std::vector<bool>& has_area,
                                   const std::vector<bool>& opposes, const std::vector<bool>& asked) {
  constexpr double near = 0.1;  // of the mesh's size
  // Of the longest edge, if the three normals are equal: the next tile of a floor is farther away.
  constexpr double near_flat = 0.5;
  constexpr std::ptrdiff_t most_tried = 1024;
  constexpr double outwards = 0.1;       // of the way from one to the other, on average
  using Corner = std::array<double, 5>;  // normal and uv
  struct Oriented {
    std::array<Corner, 3> corners;
    Triangle vertices;
    std::uint32_t triangle;
    double along;  // of its first vertex, in a direction that few meshes have
  };
  // Corners in order, starting with the least. \param reversed in the opposite order
  const auto oriented = [&](std::uint32_t t, bool reversed) {
    Triangle vertices = mesh.triangles[t];
    if (reversed) std::swap(vertices[1], vertices[2]);
    const auto corner = [&](std::uint32_t v) {
      const Vec3<double>& n = mesh.normals[v];
      const Vec2<double> uv = mesh.uvs.empty() ? Vec2<double>{0, 0} : mesh.uvs[v];
      return Corner{n.x, n.y, n.z, uv.x, uv.y};
    };
    Oriented least{{}, {}, t, 0};
    for (int turn = 0; turn < 3; ++turn) {
      const std::array<Corner, 3> corners{corner(vertices[0]), corner(vertices[1]), corner(vertices[2])};
      if (turn == 0 || corners < least.corners) least.corners = corners, least.vertices = vertices;
      std::rotate(vertices.begin(), vertices.begin() + 1, vertices.end());
    }
    least.along = dot(mesh.positions[least.vertices[0]], Vec3<double>{0.36, 0.48, 0.8});
    return least;
  };
  // Whether its numbers can be ordered.
  const auto is_finite = [&](std::uint32_t t) {
    return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](std::uint32_t v) {
      return detail::finite(mesh.normals[v]) && (mesh.uvs.empty() || detail::finite(mesh.uvs[v]));
    });
  };
  std::vector<bool> result(mesh.triangles.size(), false);
  std::vector<Oriented> insides;
  Bounds box;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area[t]) continue;
    bool any = false;
    for (const std::uint32_t v : mesh.triangles[t]) {
      box.add(mesh.positions[v]);
      any = any || asked[v];
    }
    if (any && opposes[t] && is_finite(t)) insides.push_back(oriented(t, true));
  }
  if (insides.empty()) return result;
  std::sort(insides.begin(), insides.end(), [](const Oriented& a, const Oriented& b) {
    return std::tie(a.corners, a.along) < std::tie(b.corners, b.along);
  });
  const double size = box.diagonal();
  const auto reach = [&](const Oriented& o) {
    const auto& [a, b, c] = o.vertices;
    double edge = 0;
    for (const auto& [v, w] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      edge = std::fmax(edge, norm(mesh.positions[v] - mesh.positions[w]));
    const bool flat = mesh.normals[a] == mesh.normals[b] && mesh.normals[b] == mesh.normals[c];
    return flat ? std::fmin(near * size, near_flat * edge) : near * size;
  };
  double away = 0, outside_by = 0;  // sums over all that are found
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area[t] || opposes[t] || !is_finite(t)) continue;
    const Oriented outside = oriented(t, false);
    const double radius = reach(outside);
    auto inside = std::lower_bound(insides.begin(), insides.end(), outside.along - radius,
                                   [&](const Oriented& a, double along) {
                                     return std::tie(a.corners, a.along) < std::tie(outside.corners, along);
                                   });
    for (std::ptrdiff_t tried = 0;
         tried < most_tried && inside != insides.end() && inside->corners == outside.corners &&
         inside->along <= outside.along + radius;
         ++inside, ++tried) {
      double farthest = 0, by = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = outside.vertices[k];
        const Vec3<double> d = mesh.positions[inside->vertices[k]] - mesh.positions[v];
        farthest = std::fmax(farthest, norm(d));
        by += dot(d, mesh.normals[v]) / 3;
      }
      if (farthest > radius) continue;
      result[inside->triangle] = true;
      away += farthest, outside_by += by;
    }
  }
  if (outside_by < outwards * away) result.assign(result.size(), false);
  return result;
}

bool has_any(const std::vector<bool>& list) {
  return std::find(list.begin(), list.end(), true) != list.end();
}

// NormalChecks::side. \param agreeing at the first vertex of each position and normal: triangles on its side
// minus the others \param agrees vertices whose normals a triangle certainly supports
std::vector<signed char> sides_of(const VertexJoins& joins, const std::vector<std::int32_t>& agreeing,
                                  std::vector<bool> agrees) {
  const std::vector<std::uint32_t>& group = joins.position_and_normal;
  for (std::size_t v = 0; v < agrees.size(); ++v)
    if (agrees[v]) agrees[group[v]] = true;
  std::vector<signed char> side(agrees.size(), 0);
  for (std::size_t v = 0; v < side.size(); ++v)
    side[v] = agreeing[group[v]] < 0 ? -1 : agrees[group[v]] ? 1 : 0;
  return side;
}

// Sets a flag for all vertices of one position and normal if it is set for any.
void share(const VertexJoins& joins, std::vector<bool>& of) {
  for (std::uint32_t v = 0; v < of.size(); ++v)
    if (of[v]) of[joins.position_and_normal[v]] = true;
  for (std::uint32_t v = 0; v < of.size(); ++v) of[v] = of[joins.position_and_normal[v]];
}

// Requested normals that are near no triangle that shares them, and no usual average of these: at sharp edges
// and tips no average is nearer.
std::vector<bool> far_from_all(const Mesh& mesh, const VertexJoins& joins, const std::vector<bool>& asked,
                               const std::vector<bool>& near) {
  std::vector<bool> result(asked.size(), false);
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = asked[v] && !near[v];
  if (!has_any(result)) return result;
  const std::vector<bool> average = are_average_normals(mesh, joins, result);
  for (std::size_t v = 0; v < result.size(); ++v)
    if (average[v]) result[v] = false;
  return result;
}

// NormalChecks::unsupported. \param opposes triangles that oppose all their normals \param asked vertices of
// triangles with area whose normals have a direction \param supported those whose own triangle supports them
std::vector<bool> unsupported_normals(const Mesh& mesh, const std::vector<bool>& has_area,
                                      const VertexJoins& joins, const std::vector<bool>& opposes,
                                      const std::vector<bool>& asked, const std::vector<bool>& supported) {
  std::vector<bool> result = far_from_all(mesh, joins, asked, supported);
  if (!has_any(result)) return result;
  const std::vector<bool> inside = insides_of_hulls(mesh, has_area, opposes, result);
  std::vector<bool> elsewhere(result.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (has_area[t] && !inside[t]) elsewhere[v] = true;
  for (std::size_t v = 0; v < result.size(); ++v)
    if (!elsewhere[v]) result[v] = false;
  return result;
}

// Corners whose normals oppose the winding.
struct OpposedCorners {
  std::size_t corners = 0, against = 0;
  bool all() const {
    return corners > 0 && static_cast<double>(against) >= most_against * static_cast<double>(corners);
  }
};

// A bent quad cut the other way, or a sliver, tilts a triangle away from a few normals, but hardly turns it
// over. \param far vertices whose normal is beyond near_deg
bool are_slivers(const std::vector<bool>& unsupported, const std::vector<bool>& far,
                 const std::vector<bool>& asked, const std::vector<bool>& in_front) {
  constexpr std::size_t most = 24;
  std::size_t those = 0, off = 0, all = 0;
  for (std::size_t v = 0; v < asked.size(); ++v) {
    if (unsupported[v] && !in_front[v]) return false;
    all += asked[v];
    off += far[v];
    those += unsupported[v];
  }
  return 10 * off < all && those <= most;
}

// Marks all triangles that oppose their normals, however uncertain their planes are.
void oppose_all(const Mesh& mesh, const std::vector<bool>& has_area, NormalChecks& result) {
  result.opposing = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3<double> plane = area_vector(mesh, mesh.triangles[t]);
    result.opposes[t] = has_area[t];
    for (const std::uint32_t v : mesh.triangles[t])
      result.opposes[t] = result.opposes[t] && dot(mesh.normals[v], plane) < 0;
    result.opposing += result.opposes[t] ? 3 : 0;
  }
}

}  // namespace

double cosine_between(const Vec3<double>& t, const Vec3<double>& n) {
  const double squares = dot(t, t) * dot(n, n);
  return squares > 0 ? std::fabs(dot(t, n)) / std::sqrt(squares) : 0;
}

std::vector<Vec3<double>> planes_of_vertices(const Mesh& mesh, const VertexJoins& joins) {
  const std::vector<std::uint32_t>& group = joins.position_and_normal;
  std::vector<Vec3<double>> sums(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3<double> plane = area_vector(mesh, t);
    for (const std::uint32_t v : t) sums[group[v]] = sums[group[v]] + plane;
  }
  std::vector<Vec3<double>> result;
  for (const std::uint32_t g : group) result.push_back(sums[g]);
  return result;
}

VertexChecks check_vertex(const Mesh& mesh, std::uint32_t v) {
  VertexChecks c{.position_finite = detail::finite(mesh.positions[v])};
  if (!mesh.uvs.empty()) c.uv_finite = detail::finite(mesh.uvs[v]);
  if (!mesh.normals.empty()) {
    c.normal_finite = detail::finite(mesh.normals[v]);
    c.normal_unit = is_unit(mesh.normals[v], mesh.half_steps.normal);
    c.has_normal = c.normal_finite && mesh.normals[v] != Vec3<double>{};
  }
  if (mesh.tangents.empty()) return c;
  const Vec4<double>& t = mesh.tangents[v];
  c.tangent_finite = detail::finite(t.xyz()) && std::isfinite(t.w);
  c.tangent_zero = t.xyz() == Vec3<double>{};
  c.has_tangent = c.tangent_finite && !c.tangent_zero;
  c.tangent_unit = is_unit(t.xyz(), mesh.half_steps.tangent);
  c.sign_valid = std::fabs(std::fabs(t.w) - 1) <= mesh.half_steps.tangent;
  if (!mesh.normals.empty() && c.normal_finite && c.tangent_finite) {
    const double along = cosine_between(t.xyz(), mesh.normals[v]),
                 rounding = std::numbers::sqrt3 * (mesh.half_steps.normal + mesh.half_steps.tangent);
    c.orthogonal = along <= orthogonal_tolerance;
    c.along_normal = along > along_normal_tolerance + rounding;
    c.leans = !c.along_normal && along > orthogonal_tolerance + rounding;
  }
  return c;
}

NormalChecks check_normals(const Mesh& mesh, const std::vector<bool>& has_area, const VertexJoins& joins) {
  NormalChecks result;
  if (mesh.normals.empty()) return result;
  const std::size_t n = mesh.positions.size();
  const Planes planes(mesh);
  const double least = std::cos(supported_deg / degrees_per_radian),
               least_near = std::cos(near_deg / degrees_per_radian),
               least_in_front = std::cos(in_front_deg / degrees_per_radian),
               rounding = std::numbers::sqrt3 * half_step(mesh.half_steps.normal, 1);
  std::vector<bool> asked(n, false), supported(n, false), near(n, false), in_front(n, false),
      agrees(n, false);
  // Triangles on the side of a position and normal, less the others.
  std::vector<std::int32_t> agreeing(n, 0);
  result.drawn.assign(n, false);
  result.faceted.assign(mesh.triangles.size(), false);
  result.opposes.assign(mesh.triangles.size(), false);
  bool any_candidate = false;
  OpposedCorners certain, any;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area[t]) continue;
    const Plane plane = planes(t);
    int opposing = 0, opposing_at_all = 0;
    // The sine of the largest angle at which a normal counts as the plane's own. The squared cosine is then
    // at least 1 - own², and nearly always that decides.
    const double own = std::min(faceted_deg / degrees_per_radian + plane.uncertain + rounding, 1.0);
    bool candidate = plane.uncertain < 1;
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (!plane.vanishes) result.drawn[v] = true;
      const Vec3<double>& m = mesh.normals[v];
      const double along = dot(m, plane.normal), square = dot(m, m);
      if (!(square > 0) || !std::isfinite(square)) {
        candidate = false;
        continue;
      }
      const bool is_certain = along * along > plane.uncertain * plane.uncertain * square;
      opposing_at_all += along < 0;
      opposing += is_certain && along < 0;
      certain.corners += is_certain;
      ++any.corners;
      asked[v] = true;
      if (plane.uncertain < 1) agreeing[joins.position_and_normal[v]] += along < 0 ? -1 : 1;
      const auto is_within = [&](double cosine) {
        return plane.uncertain >= 1 ||
               (along >= 0 && (cosine <= 0 || along * along >= cosine * cosine * square)) ||
               (along < 0 && cosine < 0 && along * along <= cosine * cosine * square);
      };
      // cos(80° + the uncertainty) |m|, to first order.
      if (is_within(least - plane.uncertain))
        supported[v] = true, agrees[v] = agrees[v] || plane.uncertain < 1;
      if (is_within(least_in_front - plane.uncertain)) in_front[v] = true;
      // At most cos(60° + asin(the uncertainty) + the rounding).
      if (is_within(least_near - 2 * (plane.uncertain + rounding))) near[v] = true;
      candidate = candidate && along > 0 && along * along >= (1 - own * own) * square;
    }
    certain.against += static_cast<std::size_t>(opposing);
    any.against += static_cast<std::size_t>(opposing_at_all);
    result.opposes[t] = opposing == 3;
    result.opposing += opposing == 3 ? 3 : 0;
    if (!candidate) continue;
    const double cosine = std::cos(own);
    if (std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](std::uint32_t v) {
          const double along = dot(mesh.normals[v], plane.normal);
          return along * along >= cosine * cosine * dot(mesh.normals[v], mesh.normals[v]);
        }))
      result.faceted[t] = any_candidate = true;
  }
  // On a mesh so fine that rounding leaves its planes uncertain, the signs are still evidence in total.
  result.all_oppose = (2 * certain.corners >= any.corners ? certain : any).all();
  if (result.all_oppose && 2 * certain.corners < any.corners) oppose_all(mesh, has_area, result);
  result.side = sides_of(joins, agreeing, std::move(agrees));
  result.unsupported.assign(n, false);
  result.may_be_meant.assign(n, false);
  result.departing.assign(n, false);
  if (!result.all_oppose) {
    for (std::vector<bool>* those : {&supported, &near, &in_front}) share(joins, *those);
    const std::vector<bool> far = far_from_all(mesh, joins, asked, near);
    result.departing = far;
    for (std::uint32_t v = 0; v < n; ++v)
      if (!supported[v]) result.departing[v] = false;
    result.unsupported = unsupported_normals(mesh, has_area, joins, result.opposes, asked, supported);
    if (has_any(result.unsupported)) {
      result.may_be_meant = borders_of_sheets(mesh, has_area, planes, joins.position);
      const std::vector<bool> transferred =
          may_be_transferred(mesh, has_area, joins, result.unsupported, result.may_be_meant);
      for (std::uint32_t v = 0; v < n; ++v)
        if (transferred[v]) result.may_be_meant[v] = true;
      if (are_slivers(result.unsupported, far, asked, in_front)) result.may_be_meant = result.unsupported;
    }
  }
  result.faceted_vertices.assign(n, false);
  if (!any_candidate) return result;
  keep_faceted(mesh, has_area, joins, planes, result.faceted);
  for (const bool faceted : {true, false})
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (has_area[t] && result.faceted[t] == faceted)
        for (const std::uint32_t v : mesh.triangles[t]) result.faceted_vertices[v] = faceted;
  return result;
}

}  // namespace darboux
