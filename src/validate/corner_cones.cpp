#include "corner_cones.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <darboux/frame.h>
#include <darboux/triangle.h>

#include "angles.h"
#include "base/degrees.h"
#include "mesh/area_vector.h"
#include "mesh/frames/corner.h"
#include "rounding.h"

namespace darboux {
namespace {

constexpr double one_sided = 3;            // times the limit
constexpr double most_turned_on_deg = 45;  // from the next triangles to a border
// A baked scale of up to 3 : 1 turns the former normal direction away from the new normal, by an angle whose
// tangent is at most (3 - 1/3) / 2. How large a turn is allowed is a choice.
constexpr double lean_of_scale = 4.0 / 3, most_lean_deg = 45;
constexpr double uniform_deg = 0.1;
// Normals at one place within this angle count as one. assimp joins dot products of 0.9999.
constexpr double alike_deg = 0.9;

constexpr double half_turn = std::numbers::pi;  // radians

constexpr std::ptrdiff_t most_at_a_place = 256;  // corners
constexpr std::ptrdiff_t kept_from = 16;         // corners at a position: from here on directions are cached
constexpr std::ptrdiff_t most_at_an_edge = 64;   // triangles; beyond, the cone is uncertain
constexpr std::ptrdiff_t most_next = 16;         // triangles at a position; further neighbours are ignored

// \param n unit
bool are_alike(const Vec3<double>& a, const Vec3<double>& n) {
  static const double least = std::cos(alike_deg / degrees_per_radian);
  const double along = dot(a, n);
  return along > 0 && along * along >= least * least * dot(a, a);
}

std::array<Vec3<double>, 3> positions_of(const Mesh& mesh, const Triangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}
std::array<Vec2<double>, 3> uvs_of(const Mesh& mesh, const Triangle& t) {
  return {mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]};
}
double uv_area2(const Mesh& mesh, const Triangle& t) {
  return signed_uv_area2(mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]);
}

// The smallest arc that contains all arcs; its half is half a turn or more where they leave no gap of 180
// degrees.
Arc hull(std::vector<Arc>& arcs) {
  double reached = 0;
  for (Arc& arc : arcs) {
    const double low = arc.middle - arc.half;
    arc.middle -= 2 * half_turn * std::floor(low / (2 * half_turn));
    reached = std::fmax(reached, arc.middle + arc.half);
  }
  std::sort(arcs.begin(), arcs.end(),
            [](const Arc& a, const Arc& b) { return a.middle - a.half < b.middle - b.half; });
  // Each gap ends where an arc begins; the gap before the first arc began in the previous turn.
  reached -= 2 * half_turn;
  double widest = -1, from = 0, to = 0;
  for (const Arc& arc : arcs) {
    if (const double low = arc.middle - arc.half; low - reached > widest)
      widest = low - reached, from = low, to = reached + 2 * half_turn;
    reached = std::fmax(reached, arc.middle + arc.half);
  }
  if (!(widest > half_turn)) return {0, half_turn};
  return {(from + to) / 2, (to - from) / 2};
}

}  // namespace

CornerCones::CornerCones(const Mesh& mesh, std::span<const signed char> raw_sign, const VertexJoins& joins,
                         const std::vector<bool>& vertices, double max_angle_deg)
    : mesh_(mesh), raw_sign_(raw_sign), joins_(joins), max_angle_deg_(max_angle_deg) {
  const std::size_t n = mesh.positions.size();
  std::vector<bool> group(n, false), near(n, false);
  for (std::uint32_t v = 0; v < n; ++v)
    if (vertices[v]) group[joins.position[v]] = true;
  const auto in_group = [&](std::uint32_t v) { return group[joins.position[v]]; };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    bool any = false;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      if (!in_group(v)) continue;
      corners_.push_back({joins.position[v], joins.position_and_normal[v], t, k});
      any = true;
    }
    if (any)
      for (const std::uint32_t v : mesh.triangles[t]) near[joins.position[v]] = true;
  }
  std::sort(corners_.begin(), corners_.end());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k)
      if (const std::uint32_t a = place(t, k), b = place(t, k + 1); near[a] && near[b] && a != b)
        edges_.push_back({a, b, t, k});
  std::sort(edges_.begin(), edges_.end());
}

CornerCones::Assessed CornerCones::assess(std::uint32_t v, int sign, double limit_deg) {
  const Directions* found = directions_of(v, sign, true);
  const std::optional<Arc> cone = cone_of(v, found);
  if (!cone) return {Claim::none, std::nullopt};
  const Directions directions = *found;  // the next call overwrites *found
  if (cone->half >= half_turn / 2) return {Claim::none, cone_of_chart(v, sign, directions)};
  const double outside = outside_deg(v, *cone);
  if (outside <= limit_deg) {
    const std::optional<Arc> of_chart = cone_of_chart(v, sign, directions);
    return {Claim::within, of_chart && outside_deg(v, *of_chart) > limit_deg ? of_chart : std::nullopt};
  }
  if (directions.uncertain) return {Claim::none, std::nullopt};
  if (is_left_open(v, sign, directions, *cone, outside, limit_deg))
    return {Claim::none, cone_of_chart(v, sign, directions)};
  return {Claim::beyond, cone, outside <= limit_deg + directions.lean_deg};
}

double CornerCones::outside_deg(std::uint32_t v, const Arc& cone) const {
  const double away = std::fabs(std::remainder(cone.middle, 2 * half_turn)) - cone.half;
  return degrees_per_radian * (away - tangent_rounding(mesh_, v));
}

CornerCones::Direction CornerCones::direction(std::uint32_t v, int sign) {
  const Directions* found = directions_of(v, sign, false);
  // A triangle whose uv area is within rounding may have drawn an average anywhere.
  const bool uncertain = found && found->uncertain;
  const std::optional<Arc> own = cone_of(v, found);
  if (!own) return {uncertain, false};
  if (own->half >= half_turn / 2) return {uncertain, true};
  if (uncertain) return {true, false};
  const std::optional<Arc> of_quads = cone_of(v, directions_of(v, sign, true));
  return {outside_deg(v, *own) <= 0 || (of_quads->half < half_turn / 2 && outside_deg(v, *of_quads) <= 0),
          false};
}

// The directions of the triangles of v with that sign, in the plane of its normal. Null where the normal
// has no direction or, where very many corners share the position, differs from that of its group.
// \param of_quads with the triangles of other diagonals
const CornerCones::Directions* CornerCones::directions_of(std::uint32_t v, int sign, bool of_quads) {
  const std::uint32_t own = joins_.position_and_normal[v], place_of_v = joins_.position[v];
  const auto from = [&](std::uint32_t place, std::uint32_t group) {
    return std::lower_bound(corners_.begin(), corners_.end(), Corner{place, group, 0, 0});
  };
  Corners at{from(place_of_v, 0), from(place_of_v + 1, 0)};
  const std::ptrdiff_t many = at.last - at.first;
  Vec3<double> n = unit(mesh_.normals[v]);
  if (!has_direction(n)) return nullptr;
  // Where very many corners meet, use only those of its own normal: comparing all pairs would take long.
  if (many > most_at_a_place) {
    at = {from(place_of_v, own), from(place_of_v, own + 1)};
    if (!are_alike(mesh_.normals[v], unit(mesh_.normals[own]))) return nullptr;
    n = unit(mesh_.normals[own]);
  }
  if (many < kept_from) return &(last_ = directions(at, own, n, sign, of_quads));
  const Key key{own, sign, of_quads, n.x, n.y, n.z};
  const auto kept = kept_.find(key);
  return &(kept != kept_.end() ? kept : kept_.emplace(key, directions(at, own, n, sign, of_quads)).first)
              ->second;
}

CornerCones::Directions CornerCones::directions(const Corners& at, std::uint32_t own, const Vec3<double>& n,
                                                int sign, bool of_quads) {
  Directions result;
  result.at = at;
  result.x = any_perpendicular(n), result.y = cross(n, result.x);
  arcs_.clear();
  rim_.clear();
  fan_.clear();
  uncertain_ = false;
  lean_ = 0;
  x_ = result.x, y_ = result.y, n_ = n;
  std::optional<Vec3<double>> plane;
  for (auto c = at.first; c != at.last; ++c) {
    const Triangle& triangle = mesh_.triangles[c->triangle];
    if (raw_sign_[c->triangle] == sign) add_spokes(*c, fan_);
    if (c->group != own && !are_alike(mesh_.normals[triangle[c->k]], n)) continue;
    add(triangle, sign);
    if (raw_sign_[c->triangle] == sign) {
      add_spokes(*c, rim_);
      const Vec3<double> across = unit(area_vector(mesh_, triangle));
      if (!plane) plane = across;
      result.flat = result.flat && angle_between(*plane, across) <= uniform_deg / degrees_per_radian;
      for (const std::uint32_t w : triangle)
        if (const double turn = angle_between(mesh_.normals[w], n); turn > result.normals_turn)
          result.normals_turn = turn;
      result.pole_turn = std::fmax(result.pole_turn, 0.5 * angle_at(*c));
    }
    for (std::uint32_t k = 0; of_quads && k < 3; ++k) add_other_diagonal(*c, k, sign);
  }
  for (const Arc& arc : arcs_) result.widest = std::fmax(result.widest, arc.half);
  result.closed = goes_all_round();
  if (!is_collapsed_edge()) result.pole_turn = 0;
  result.uncertain = uncertain_;
  result.lean_deg = std::fmin(most_lean_deg, degrees_per_radian * lean_);
  if (!arcs_.empty()) result.cone = hull(arcs_);
  return result;
}

bool CornerCones::Directions::is_uniform() const {
  return normals_turn <= uniform_deg / degrees_per_radian &&
         cone->half <= widest + uniform_deg / degrees_per_radian;
}

// Whether the true direction may lie as far outside of the cone as the tangent, because the triangles lie on
// one side.
bool CornerCones::is_left_open(std::uint32_t v, int sign, const Directions& directions, const Arc& cone,
                               double outside, double limit_deg) {
  if (directions.pole_turn > 0 && outside <= limit_deg + degrees_per_radian * directions.pole_turn)
    return true;
  // Over a triangle, the frame turns about as much as the normals do.
  const double normals_turn = degrees_per_radian * directions.normals_turn;
  // Where a facet was cut into pieces and its frames were interpolated, frames turn though the facet is flat.
  if (directions.flat && outside <= limit_deg + normals_turn) return true;
  if (directions.closed) return false;
  if (outside <= one_sided * max_angle_deg_ + normals_turn && !directions.is_uniform()) return true;
  return outside <= limit_deg + most_turned_on_deg &&
         outside <= limit_deg + degrees_per_radian * turn_before(v, sign, directions, cone);
}

// How far the direction at v may lie from that of its own triangles, towards the tangent. The next triangles
// share a vertex with these and have none at this position. The result is half of the angle by which they
// turn on, less the width of the cone of v: where that is wide, its own triangles lie on both sides of v.
double CornerCones::turn_before(std::uint32_t v, int sign, const Directions& all, const Arc& cone) {
  if (all.at.last - all.at.first > most_next) return 0;
  const bool clockwise =
      std::remainder(cone.middle, 2 * half_turn) < 0;  // the way from the tangent to the cone
  const Directions* own = directions_of(v, sign, false);
  if (!own || !own->cone) return 0;
  const Arc from = *own->cone;
  sort_by_vertex();
  x_ = all.x, y_ = all.y, n_ = unit(mesh_.normals[v]);  // kept directions belong to another vertex's normal
  double most = 0;
  for (auto c = all.at.first; c != all.at.last; ++c) {
    if (raw_sign_[c->triangle] != sign || !are_alike(mesh_.normals[corner(c->triangle, c->k)], n_)) continue;
    for (const std::uint32_t k : {c->k + 1, c->k + 2}) {
      const std::uint32_t w = corner(c->triangle, k), group = joins_.position_and_normal[w];
      const auto first = std::lower_bound(by_vertex_.begin(), by_vertex_.end(), std::pair{group, 0U}),
                 last = std::lower_bound(first, by_vertex_.end(), std::pair{group + 1, 0U});
      if (last - first > most_next) continue;
      for (auto t = first; t != last; ++t) {
        const Triangle& next = mesh_.triangles[t->second];
        const auto is_here = [&](std::uint32_t i) { return joins_.position[i] == joins_.position[v]; };
        const auto goes_on = [&](std::uint32_t i) {
          return joins_.position_and_normal[i] == group && mesh_.uvs[i] == mesh_.uvs[w];
        };
        if (raw_sign_[t->second] != sign || std::any_of(next.begin(), next.end(), is_here) ||
            std::none_of(next.begin(), next.end(), goes_on))
          continue;
        arcs_.clear();
        add(next, sign);
        if (arcs_.empty()) continue;
        const double turn = std::remainder(arcs_[0].middle - from.middle, 2 * half_turn);
        if (std::fabs(turn) <= half_turn / 2) most = std::fmax(most, (clockwise ? -turn : turn) - from.half);
      }
    }
  }
  return std::fmax(0.5 * most - 2 * from.half, 0);
}

void CornerCones::sort_by_vertex() {
  if (!by_vertex_.empty()) return;
  by_vertex_.reserve(3 * mesh_.triangles.size());
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
    for (const std::uint32_t v : mesh_.triangles[t])
      by_vertex_.emplace_back(joins_.position_and_normal[v], t);
  std::sort(by_vertex_.begin(), by_vertex_.end());
}

// The cone, as seen from the tangent, of only those triangles that have v's uv; none where it goes all round.
std::optional<Arc> CornerCones::cone_of_chart(std::uint32_t v, int sign, Directions all) {
  if (all.at.last - all.at.first > most_next) return std::nullopt;
  x_ = all.x, y_ = all.y, n_ = unit(mesh_.normals[v]);
  arcs_.clear();
  for (auto c = all.at.first; c != all.at.last; ++c) {
    const Triangle& triangle = mesh_.triangles[c->triangle];
    const std::uint32_t w = triangle[c->k];
    if (mesh_.uvs[w] == mesh_.uvs[v] && are_alike(mesh_.normals[w], n_)) add(triangle, sign);
  }
  if (arcs_.empty()) return std::nullopt;
  all.cone = hull(arcs_);
  return all.cone->half < half_turn / 2 ? cone_of(v, &all) : std::nullopt;
}

// The cone as seen from the tangent, whose direction is 0.
std::optional<Arc> CornerCones::cone_of(std::uint32_t v, const Directions* directions) const {
  if (!directions || !directions->cone) return std::nullopt;
  const Vec3<double> t = mesh_.tangents[v].xyz();
  const double x = dot(t, directions->x), y = dot(t, directions->y);
  if (!std::isfinite(x) || !std::isfinite(y) || (x == 0 && y == 0)) return std::nullopt;
  return Arc{directions->cone->middle - std::atan2(y, x), directions->cone->half};
}

// Whether the triangles go all round the vertex. If they lie on one side of it, half of the directions of a
// curved surface are missing. A chart that is cut may continue, as at the seam of a sphere, or end, as where
// three faces of a cube meet.
bool CornerCones::goes_all_round() {
  constexpr double rounding = 1e-4;
  std::sort(rim_.begin(), rim_.end(), [](const Spoke& a, const Spoke& b) {
    return std::tuple(a.place, a.along().x, a.along().y) < std::tuple(b.place, b.along().x, b.along().y);
  });
  for (std::size_t i = 0; i < rim_.size(); i += 2)
    if (i + 1 == rim_.size() || rim_[i].place != rim_[i + 1].place ||
        norm(rim_[i].along() - rim_[i + 1].along()) >
            rounding * norm(rim_[i].along()) +
                8 * half_step(mesh_.half_steps.uv, std::fmax(rim_[i].size, rim_[i + 1].size)))
      return false;
  return true;
}

void CornerCones::add_spokes(const Corner& c, std::vector<Spoke>& to) const {
  const Triangle& triangle = mesh_.triangles[c.triangle];
  const double size = largest_coordinate(uvs_of(mesh_, triangle));
  for (const std::uint32_t k : {c.k + 1, c.k + 2})
    to.push_back({place(c.triangle, k), mesh_.uvs[corner(c.triangle, k)], mesh_.uvs[triangle[c.k]], size});
}

// The angle of a triangle at its corner, in the current plane.
double CornerCones::angle_at(const Corner& c) const {
  const Vec3<double>& at = mesh_.positions[corner(c.triangle, c.k)];
  const auto direction = [&](std::uint32_t k) {
    const Vec3<double> e = mesh_.positions[corner(c.triangle, k)] - at;
    return std::atan2(dot(e, y_), dot(e, x_));
  };
  return std::fabs(std::remainder(direction(c.k + 1) - direction(c.k + 2), 2 * half_turn));
}

// Whether the uvs of this position form a line, as at a pole: at least three times, two edges from here end
// at the same uv but begin at different ones. Along that line the direction of u turns, over each triangle by
// its angle.
bool CornerCones::is_collapsed_edge() {
  constexpr double alike = 1e-3;  // of the way between the two
  const auto order = [](const Spoke& s) {
    return std::tuple(s.place, s.there.x, s.there.y, s.here.x, s.here.y);
  };
  std::sort(fan_.begin(), fan_.end(), [&](const Spoke& a, const Spoke& b) { return order(a) < order(b); });
  int split = 0;
  for (std::size_t i = 0; i + 1 < fan_.size(); ++i) {
    const Spoke &a = fan_[i], &b = fan_[i + 1];
    const double apart = norm(a.here - b.here);
    split += a.place == b.place && apart > 0 && norm(a.there - b.there) <= alike * apart;
  }
  return split >= 3;
}

// Adds the direction of a triangle, with its interval, if its uvs wind as `sign` says.
void CornerCones::add(const Triangle& triangle, int sign) {
  const std::array<Vec3<double>, 3> p = positions_of(mesh_, triangle);
  const std::array<Vec2<double>, 3> uv = uvs_of(mesh_, triangle);
  double size = 0;
  for (std::size_t k = 0; k < 3; ++k)
    size = std::fmax(size, std::fmax(std::fabs(p[k].x), std::fmax(std::fabs(p[k].y), std::fabs(p[k].z))));
  if (is_degenerate(uv[0], uv[1], uv[2]) || p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) return;
  if (is_degenerate(p[0], p[1], p[2])) {  // three places on a line: MikkTSpace counts it, others do not
    uncertain_ = true;
    return;
  }
  const double hp = half_step(mesh_.half_steps.position, size),
               hu = half_step(mesh_.half_steps.uv, largest_coordinate(uv));
  const int winds = certain_sign(uv, hu);
  if (winds == -sign) return;
  if (winds == 0) {
    uncertain_ = true;
    return;
  }
  const Vec3<double> e1 = p[1] - p[0], e2 = p[2] - p[0];
  const double s = sign, dv1 = s * (uv[1].y - uv[0].y), dv2 = s * (uv[2].y - uv[0].y);
  const Vec3<double> t = dv2 * e1 - dv1 * e2;
  const double x = dot(t, x_), y = dot(t, y_), length = std::hypot(x, y), whole = norm(t);
  const double hn = half_step(mesh_.half_steps.normal, 1);
  const double error = 2 * std::numbers::sqrt3 * hp * (std::fabs(dv1) + std::fabs(dv2) + 4 * hu) +
                       2 * hu * (norm(e1) + norm(e2)) + std::numbers::sqrt3 * hn * std::fabs(dot(t, n_)) +
                       4 * single_roundoff * whole;
  if (!(error < length)) {
    uncertain_ = true;
    return;
  }
  arcs_.push_back({std::atan2(y, x), std::asin(error / length)});
  lean_ = std::fmax(lean_, std::asin(std::fmin(1, lean_of_scale * std::fabs(dot(t, n_)) / length)));
}

// Whether the triangle faces the side of the current normal.
bool CornerCones::faces(const Triangle& t) const {
  return dot(area_vector(mesh_, t), n_) > 0;
}

// Whether a triangle has no area in space, or none in uv beyond rounding.
bool CornerCones::is_open(const Triangle& t) const {
  const auto p = positions_of(mesh_, t);
  return is_degenerate(p[0], p[1], p[2]) || certain_sign(mesh_, t, mesh_.half_steps.uv) == 0;
}

// Whether the uvs of a triangle are collinear, and no two of its uvs or positions are equal. Two triangles of
// different quads, whose diagonals meet, look like a quad with such a half, but are not. Tools differ on a
// quad with a collapsed edge, or with three corners collinear only in space.
bool CornerCones::is_on_a_line(const Triangle& t) const {
  const auto meet = [&](std::uint32_t a, std::uint32_t b) {
    return mesh_.positions[a] == mesh_.positions[b] || mesh_.uvs[a] == mesh_.uvs[b];
  };
  return certain_sign(mesh_, t, mesh_.half_steps.uv) == 0 && !meet(t[0], t[1]) && !meet(t[1], t[2]) &&
         !meet(t[2], t[0]);
}

// Edge k of the corner's triangle may be the diagonal of quads. For each, adds the triangles at the corner
// that its other diagonal would make.
void CornerCones::add_other_diagonal(const Corner& c, std::uint32_t k, int sign) {
  const std::uint32_t t = c.triangle;
  if (raw_sign_[t] != sign) return;
  const std::uint32_t p = corner(t, k), q = corner(t, k + 1), r = corner(t, k + 2);
  // Edges that run the other way.
  const std::uint32_t from = joins_.position[q], to = joins_.position[p];
  const auto first_edge = std::lower_bound(edges_.begin(), edges_.end(), Edge{from, to, 0, 0}),
             last_edge = std::lower_bound(first_edge, edges_.end(), Edge{from, to + 1, 0, 0});
  if (last_edge - first_edge > most_at_an_edge) {
    uncertain_ = true;
    return;
  }
  const auto same = [&](std::uint32_t a, std::uint32_t b) {
    return joins_.position_and_normal[a] == joins_.position_and_normal[b] && mesh_.uvs[a] == mesh_.uvs[b];
  };
  for (auto e = first_edge; e != last_edge; ++e) {
    if (e->triangle == t || raw_sign_[e->triangle] == 0) continue;
    if (!same(corner(e->triangle, e->k), q) || !same(corner(e->triangle, e->k + 1), p)) continue;
    const std::uint32_t x = corner(e->triangle, e->k + 2);
    const Triangle first{p, x, r}, second{x, q, r};
    const double first_area = uv_area2(mesh_, first), second_area = uv_area2(mesh_, second);
    // Convex in space, as quads that people model are.
    const auto is_convex = [&] { return faces(first) && faces(second); };
    if (raw_sign_[e->triangle] != sign) {
      // If a quad that is concave in uv is cut along the diagonal outside it, its halves wind in opposite
      // ways. Tangents with one w belong to the diagonal inside. At a mirrored seam there are two values of
      // w.
      if (mesh_.tangents[x].w == mesh_.tangents[r].w && first_area * second_area > 0 && is_convex())
        uncertain_ = true;
      continue;
    }
    const bool first_is_open = is_open(first), second_is_open = is_open(second);
    if ((first_is_open && !is_on_a_line(first)) || (second_is_open && !is_on_a_line(second))) {
      uncertain_ = true;
      continue;
    }
    if (!(first_is_open || first_area * sign > 0) || !(second_is_open || second_area * sign > 0)) {
      // Not convex in uv. MikkTSpace cuts a quad along the shorter diagonal in uv, even if it lies outside.
      const auto apart = [&](std::uint32_t i, std::uint32_t k) { return norm(mesh_.uvs[i] - mesh_.uvs[k]); };
      if (apart(x, r) <= apart(p, q) && is_convex()) uncertain_ = true;
      continue;
    }
    for (const auto& [other, open] : {std::pair{first, first_is_open}, {second, second_is_open}})
      if (!open && std::find(other.begin(), other.end(), corner(t, c.k)) != other.end()) add(other, sign);
  }
}

}  // namespace darboux
