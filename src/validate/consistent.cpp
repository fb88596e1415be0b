#include "consistent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include <darboux/frame.h>
#include <darboux/mesh_frames.h>

#include "angles.h"
#include "base/degrees.h"
#include "mesh/frames/corner.h"
#include "mikktspace_comparison.h"
#include "normal_cones.h"
#include "rounding.h"

namespace darboux {
namespace {

constexpr double one_sided = 3;            // times the limit
constexpr double most_turned_on_deg = 45;  // from the next triangles to a border
// A baked scale of up to 3 : 1 turns the direction that was the normal's away from the new normal, by an
// angle whose tangent is at most (3 - 1/3) / 2. How far such a turn is allowed, and for what share of a
// mesh's tangents, are choices.
constexpr double lean_of_scale = 4.0 / 3, most_lean_deg = 45, most_scaled = 0.03;
constexpr double uniform_deg = 0.1;
// Normals at one place that count as one. assimp's dot product is 0.9999.
constexpr double alike_deg = 0.9;

constexpr double pi = std::numbers::pi;

// Turned tangents. The facets of a prism with three sides, square to normals that stand between them, turn
// what its uvs say by 25 degrees, and more sides by less.
constexpr double foreshortened_deg = 30;
constexpr double nearly_all = 0.9;
constexpr std::size_t least_turned = 8;  // corners of vertices

constexpr std::ptrdiff_t most_at_a_place = 256;  // corners
constexpr std::ptrdiff_t kept_from = 16;         // corners at a position: from here on directions are cached
constexpr std::ptrdiff_t most_at_an_edge = 64;   // triangles that each make a quad with each of the others
constexpr std::ptrdiff_t most_next = 16;         // triangles at a position: beyond, the next ones are ignored

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

// An arc of directions in a plane, radians.
struct Arc {
  double middle, half;
};

// The smallest arc that holds all; half is pi or more where they leave no gap of 180 degrees.
Arc hull(std::vector<Arc>& arcs) {
  double reached = 0;
  for (Arc& arc : arcs) {
    const double low = arc.middle - arc.half;
    arc.middle -= 2 * pi * std::floor(low / (2 * pi));
    reached = std::fmax(reached, arc.middle + arc.half);
  }
  std::sort(arcs.begin(), arcs.end(),
            [](const Arc& a, const Arc& b) { return a.middle - a.half < b.middle - b.half; });
  // Each gap ends where an arc begins, that of the first began a turn before.
  reached -= 2 * pi;
  double widest = -1, from = 0, to = 0;
  for (const Arc& arc : arcs) {
    if (const double low = arc.middle - arc.half; low - reached > widest)
      widest = low - reached, from = low, to = reached + 2 * pi;
    reached = std::fmax(reached, arc.middle + arc.half);
  }
  if (!(widest > pi)) return {0, pi};
  return {(from + to) / 2, (to - from) / 2};
}

// Judges the tangents that lie along no triangle of their own vertex.
class Closely {
 public:
  Closely(const Mesh& mesh, std::span<const signed char> raw_sign, const VertexJoins& joins,
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

  // What is claimed, and the known cone that the tangent lies outside of, if any. For a tangent that is left
  // open, or that lies within the cone of several charts together, it is the cone of its own chart.
  struct Assessed {
    Claim claim;
    std::optional<Arc> left;
    bool by_scale = false;  // beyond, but a scale may have taken an average there
  };
  Assessed assess(std::uint32_t v, int sign, double limit_deg) {
    const Directions* found = directions_of(v, sign, true);
    const std::optional<Arc> cone = cone_of(v, found);
    if (!cone) return {Claim::none, std::nullopt};
    const Directions directions = *found;  // the next that are asked for take its place
    if (cone->half >= pi / 2) return {Claim::none, cone_of_chart(v, sign, directions)};
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

  double outside_deg(std::uint32_t v, const Arc& cone) const {
    const double away = std::fabs(std::remainder(cone.middle, 2 * pi)) - cone.half;
    return degrees_per_radian * (away - tangent_rounding(mesh_, v));
  }

  struct Direction {
    bool average, all_round;
  };
  // As OwnDirections has them.
  Direction direction(std::uint32_t v, int sign) {
    const std::optional<Arc> own = cone_of(v, directions_of(v, sign, false));
    if (!own) return {false, false};
    if (own->half >= pi / 2) return {false, true};
    const std::optional<Arc> of_quads = cone_of(v, directions_of(v, sign, true));
    return {outside_deg(v, *own) <= 0 || (of_quads->half < pi / 2 && outside_deg(v, *of_quads) <= 0), false};
  }

 private:
  struct Corner {
    std::uint32_t place, group, triangle, k;  // one position; one position and normal
    auto operator<=>(const Corner&) const = default;
  };
  struct Edge {
    std::uint32_t from, to, triangle, k;  // places; from corner k to the next
    auto operator<=>(const Edge&) const = default;
  };
  struct Corners {
    std::vector<Corner>::const_iterator first, last;
  };
  // What the triangles of one place and sign say in the plane of one normal.
  struct Directions {
    Vec3<double> x, y;        // the plane's axes
    std::optional<Arc> cone;  // of their directions, from x to y; nothing: they have none
    double widest = 0;        // half of the widest of them
    double normals_turn = 0;  // from the normal to others of its triangles, the most
    double lean_deg = 0;      // by which another projection may turn one of them, the most
    double pole_turn = 0;     // where an edge of the uvs is collapsed, half of the widest angle of a triangle
    bool closed = false;      // the triangles go all round the vertex, and their charts go on
    bool uncertain = false;   // a triangle tells no direction, and may have drawn the tangent anywhere
    Corners at;               // the corners they are of

    // Whether neither directions nor normals turn, as on a flat face with its uvs laid flat.
    bool is_uniform() const {
      return normals_turn <= uniform_deg / degrees_per_radian &&
             cone->half <= widest + uniform_deg / degrees_per_radian;
    }
  };
  // An edge of a triangle from its corner here.
  struct Spoke {
    std::uint32_t place;       // of its other end
    Vec2<double> there, here;  // uvs
    double size;               // of the triangle's uvs
    Vec2<double> along() const { return there - here; }
  };
  using Key = std::tuple<std::uint32_t, int, bool, double, double, double>;

  // The directions of the triangles of v with that sign, in the plane of its normal. Null where the normal
  // has no direction or, where very many corners share the position, differs from that of its group.
  // \param of_quads with the triangles of other diagonals
  const Directions* directions_of(std::uint32_t v, int sign, bool of_quads) {
    const std::uint32_t own = joins_.position_and_normal[v], place_of_v = joins_.position[v];
    const auto from = [&](std::uint32_t place, std::uint32_t group) {
      return std::lower_bound(corners_.begin(), corners_.end(), Corner{place, group, 0, 0});
    };
    Corners at{from(place_of_v, 0), from(place_of_v + 1, 0)};
    const std::ptrdiff_t many = at.last - at.first;
    Vec3<double> n = unit(mesh_.normals[v]);
    if (!has_direction(n)) return nullptr;
    // Where very many meet, only those of its own normal: comparing each with each would take long.
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

  Directions directions(const Corners& at, std::uint32_t own, const Vec3<double>& n, int sign,
                        bool of_quads) {
    Directions result;
    result.at = at;
    result.x = any_perpendicular(n), result.y = cross(n, result.x);
    arcs_.clear();
    rim_.clear();
    fan_.clear();
    uncertain_ = false;
    lean_ = 0;
    x_ = result.x, y_ = result.y, n_ = n;
    for (auto c = at.first; c != at.last; ++c) {
      const Triangle& triangle = mesh_.triangles[c->triangle];
      if (raw_sign_[c->triangle] == sign) add_spokes(*c, fan_);
      if (c->group != own && !are_alike(mesh_.normals[triangle[c->k]], n)) continue;
      add(positions_of(mesh_, triangle), uvs_of(mesh_, triangle), sign);
      if (raw_sign_[c->triangle] == sign) {
        add_spokes(*c, rim_);
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

  // Whether the true direction may be so far outside of the cone, as the triangles lie on one side.
  bool is_left_open(std::uint32_t v, int sign, const Directions& directions, const Arc& cone, double outside,
                    double limit_deg) {
    if (directions.pole_turn > 0 && outside <= limit_deg + degrees_per_radian * directions.pole_turn)
      return true;
    if (directions.closed) return false;
    // The frame turns over a triangle about as its normals do.
    const double normals_turn = degrees_per_radian * directions.normals_turn;
    if (outside <= one_sided * max_angle_deg_ + normals_turn && !directions.is_uniform()) return true;
    return outside <= limit_deg + most_turned_on_deg &&
           outside <= limit_deg + degrees_per_radian * turn_before(v, sign, directions, cone);
  }

  // How far the direction at v may lie from that of its own triangles, towards the tangent: half of the angle
  // by which the next triangles turn on, which share a vertex with them and have none at this position, less
  // the width of its own cone, as its own triangles then lie on both sides of v.
  double turn_before(std::uint32_t v, int sign, const Directions& all, const Arc& cone) {
    if (all.at.last - all.at.first > most_next) return 0;
    const bool clockwise = std::remainder(cone.middle, 2 * pi) < 0;  // from the tangent to the cone, and on
    const Directions* own = directions_of(v, sign, false);
    if (!own || !own->cone) return 0;
    const Arc from = *own->cone;
    sort_by_vertex();
    x_ = all.x, y_ = all.y, n_ = unit(mesh_.normals[v]);  // those of what was kept are another vertex's
    double most = 0;
    for (auto c = all.at.first; c != all.at.last; ++c) {
      if (raw_sign_[c->triangle] != sign || !are_alike(mesh_.normals[corner(c->triangle, c->k)], n_))
        continue;
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
          add(positions_of(mesh_, next), uvs_of(mesh_, next), sign);
          if (arcs_.empty()) continue;
          const double turn = std::remainder(arcs_[0].middle - from.middle, 2 * pi);
          if (std::fabs(turn) <= pi / 2) most = std::fmax(most, (clockwise ? -turn : turn) - from.half);
        }
      }
    }
    return std::fmax(0.5 * most - 2 * from.half, 0);
  }
  void sort_by_vertex() {
    if (!by_vertex_.empty()) return;
    by_vertex_.reserve(3 * mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (const std::uint32_t v : mesh_.triangles[t])
        by_vertex_.emplace_back(joins_.position_and_normal[v], t);
    std::sort(by_vertex_.begin(), by_vertex_.end());
  }

  // The cone, as seen from the tangent, of those triangles alone that have v's uv; nothing where it goes all
  // round.
  std::optional<Arc> cone_of_chart(std::uint32_t v, int sign, Directions all) {
    if (all.at.last - all.at.first > most_next) return std::nullopt;
    x_ = all.x, y_ = all.y, n_ = unit(mesh_.normals[v]);
    arcs_.clear();
    for (auto c = all.at.first; c != all.at.last; ++c) {
      const Triangle& triangle = mesh_.triangles[c->triangle];
      const std::uint32_t w = triangle[c->k];
      if (mesh_.uvs[w] == mesh_.uvs[v] && are_alike(mesh_.normals[w], n_))
        add(positions_of(mesh_, triangle), uvs_of(mesh_, triangle), sign);
    }
    if (arcs_.empty()) return std::nullopt;
    all.cone = hull(arcs_);
    return all.cone->half < pi / 2 ? cone_of(v, &all) : std::nullopt;
  }

  // The cone as seen from the tangent, which is the direction 0.
  std::optional<Arc> cone_of(std::uint32_t v, const Directions* directions) const {
    if (!directions || !directions->cone) return std::nullopt;
    const Vec3<double> t = mesh_.tangents[v].xyz();
    const double x = dot(t, directions->x), y = dot(t, directions->y);
    if (!std::isfinite(x) || !std::isfinite(y) || (x == 0 && y == 0)) return std::nullopt;
    return Arc{directions->cone->middle - std::atan2(y, x), directions->cone->half};
  }
  std::uint32_t corner(std::uint32_t t, std::uint32_t k) const { return mesh_.triangles[t][k % 3]; }
  std::uint32_t place(std::uint32_t t, std::uint32_t k) const { return joins_.position[corner(t, k)]; }

  // Whether the triangles go all round the vertex. On one side of a curved surface half of the directions are
  // missing. A chart that is cut may continue, as at the seam of a sphere, or end, as where three faces of a
  // cube meet.
  bool goes_all_round() {
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
  void add_spokes(const Corner& c, std::vector<Spoke>& to) const {
    const Triangle& triangle = mesh_.triangles[c.triangle];
    const double size = largest_coordinate(uvs_of(mesh_, triangle));
    for (const std::uint32_t k : {c.k + 1, c.k + 2})
      to.push_back({place(c.triangle, k), mesh_.uvs[corner(c.triangle, k)], mesh_.uvs[triangle[c.k]], size});
  }
  // The angle of a triangle at its corner, in the plane at hand.
  double angle_at(const Corner& c) const {
    const Vec3<double>& at = mesh_.positions[corner(c.triangle, c.k)];
    const auto direction = [&](std::uint32_t k) {
      const Vec3<double> e = mesh_.positions[corner(c.triangle, k)] - at;
      return std::atan2(dot(e, y_), dot(e, x_));
    };
    return std::fabs(std::remainder(direction(c.k + 1) - direction(c.k + 2), 2 * pi));
  }
  // Whether the uvs of this position form a line, as at a pole: at least three times, edges from here that
  // end at one uv begin at two. Along that line the direction of u turns, for each triangle by its angle.
  bool is_collapsed_edge() {
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
  // Adds the direction of a triangle, with its interval, if its uvs wind as asked.
  void add(const std::array<Vec3<double>, 3>& p, const std::array<Vec2<double>, 3>& uv, int sign) {
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

  double uv_area2(const Triangle& t) const {
    return signed_uv_area2(mesh_.uvs[t[0]], mesh_.uvs[t[1]], mesh_.uvs[t[2]]);
  }
  // As the normal at hand does.
  bool faces(const Triangle& t) const {
    const auto p = positions_of(mesh_, t);
    return dot(cross(p[1] - p[0], p[2] - p[0]), n_) > 0;
  }

  // Whether a triangle has no area in space, or none in uv as far as its uvs are known.
  bool is_open(const Triangle& t) const {
    const auto p = positions_of(mesh_, t);
    return is_degenerate(p[0], p[1], p[2]) || certain_sign(mesh_, t, mesh_.half_steps.uv) == 0;
  }

  // Whether the uvs of a triangle lie on a line, and no two of its uvs or positions are equal. Triangles of
  // two quads, whose diagonals meet, make such a half of a "quad", which tells nothing. Of a quad with a
  // collapsed edge, or with three corners on a line only in space, tools make what they like.
  bool is_on_a_line(const Triangle& t) const {
    const auto meet = [&](std::uint32_t a, std::uint32_t b) {
      return mesh_.positions[a] == mesh_.positions[b] || mesh_.uvs[a] == mesh_.uvs[b];
    };
    return certain_sign(mesh_, t, mesh_.half_steps.uv) == 0 && !meet(t[0], t[1]) && !meet(t[1], t[2]) &&
           !meet(t[2], t[0]);
  }

  // Adds, for each quad that edge k of the corner's triangle cuts, the triangles of its other diagonal that
  // have the corner.
  void add_other_diagonal(const Corner& c, std::uint32_t k, int sign) {
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
      const double first_area = uv_area2(first), second_area = uv_area2(second);
      // In space, as the quads that people model are.
      const auto is_convex = [&] { return faces(first) && faces(second); };
      if (raw_sign_[e->triangle] != sign) {
        // A quad that is concave in uv, cut along the diagonal outside it, has halves that wind in two ways.
        // Its tangents, of one side, are those of the diagonal inside. At a mirrored seam there are two
        // sides.
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
        // Not convex in uv. MikkTSpace cuts a quad along the shorter diagonal in uv, though it lies outside.
        const auto apart = [&](std::uint32_t i, std::uint32_t k) {
          return norm(mesh_.uvs[i] - mesh_.uvs[k]);
        };
        if (apart(x, r) <= apart(p, q) && is_convex()) uncertain_ = true;
        continue;
      }
      for (const auto& [other, open] : {std::pair{first, first_is_open}, {second, second_is_open}})
        if (!open && std::find(other.begin(), other.end(), corner(t, c.k)) != other.end())
          add(positions_of(mesh_, other), uvs_of(mesh_, other), sign);
    }
  }

  const Mesh& mesh_;
  std::span<const signed char> raw_sign_;
  const VertexJoins& joins_;
  double max_angle_deg_;
  std::vector<Corner> corners_;
  std::vector<Edge> edges_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_vertex_;  // groups and triangles, once asked for
  std::map<Key, Directions> kept_;
  Directions last_;
  // Of the directions at hand: their plane, and what the triangles say so far.
  Vec3<double> x_{}, y_{}, n_{};
  std::vector<Arc> arcs_;
  std::vector<Spoke> rim_;  // the edges at the vertex, twice each where the triangles go all round
  std::vector<Spoke> fan_;  // the same, and those of other normals
  bool uncertain_ = false;
  double lean_ = 0;
};

}  // namespace

Vec3<double> direction_of_dpdu(const Mesh& mesh, const Triangle& t, int sign) {
  const std::array<Vec3<double>, 3> p = positions_of(mesh, t);
  const std::array<Vec2<double>, 3> uv = uvs_of(mesh, t);
  const double s = sign, dv1 = s * (uv[1].y - uv[0].y), dv2 = s * (uv[2].y - uv[0].y);
  const Vec3<double> along = dv2 * (p[1] - p[0]) - dv1 * (p[2] - p[0]);
  return along / std::fmax(std::fabs(along.x), std::fmax(std::fabs(along.y), std::fabs(along.z)));
}

Cones::Cones(const Mesh& mesh, std::span<const signed char> raw_sign, const std::vector<bool>& has_area,
             const VertexJoins& joins, const MikktspaceReference& mikktspace,
             std::span<const double> limit_deg, double max_angle_deg) {
  const std::size_t n = mesh.positions.size();
  claims_.assign(2 * n, Claim::none);
  std::vector<bool> asked(2 * n, false), vertices(n, false);
  bool any = false;
  double limit_of_cosine = 0, cosine = 1;  // nearly all vertices have the same
  // Most tangents lie near the direction of some triangle of their own vertex, and so within its cone widened
  // by the limit.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (raw_sign[t] == 0 || !has_area[t]) continue;
    const Triangle& triangle = mesh.triangles[t];
    const Vec3<double> along = direction_of_dpdu(mesh, triangle, raw_sign[t]);
    for (const std::uint32_t v : triangle) {
      const std::size_t place = place_of(v, raw_sign[t]);
      if (claims_[place] == Claim::within) continue;
      asked[place] = true;
      const Vec3<double>&n = mesh.normals[v], a = square_to(along, n),
            b = square_to(mesh.tangents[v].xyz(), n);
      if (limit_deg[v] != limit_of_cosine) {
        limit_of_cosine = limit_deg[v];
        cosine = std::cos(std::fmin(limit_of_cosine, 90) / degrees_per_radian);
      }
      const double product = dot(a, b);
      if (product > 0 && product * product > cosine * cosine * dot(a, a) * dot(b, b))
        claims_[place] = Claim::within;
    }
  }
  for (std::uint32_t v = 0; v < n; ++v)
    for (const int sign : {-1, 1})
      if (const std::size_t place = place_of(v, sign); asked[place] && claims_[place] != Claim::within)
        vertices[v] = any = true;
  if (!any) return;
  Closely closely(mesh, raw_sign, joins, vertices, max_angle_deg);
  std::vector<std::size_t> scaled;  // places
  for (std::uint32_t v = 0; v < n; ++v)
    for (const int sign : {-1, 1}) {
      const std::size_t place = place_of(v, sign);
      if (!asked[place] || claims_[place] == Claim::within) continue;
      const auto [claim, left, by_scale] = closely.assess(v, sign, limit_deg[v]);
      claims_[place] = claim;
      if (by_scale) scaled.push_back(place);
      if (left)
        outside_.push_back({static_cast<std::uint32_t>(place),
                            static_cast<float>(closely.outside_deg(v, *left)),
                            static_cast<float>(std::remainder(degrees_per_radian * left->middle, 360)),
                            static_cast<float>(degrees_per_radian * left->half)});
    }
  leave_out_mikktspaces(mesh, raw_sign, mikktspace, limit_deg);
  const auto beyond = std::count(claims_.begin(), claims_.end(), Claim::beyond),
             within = std::count(claims_.begin(), claims_.end(), Claim::within);
  if (!scaled.empty() && static_cast<double>(beyond) <= most_scaled * static_cast<double>(beyond + within) &&
      may_be_scaled(mesh, raw_sign, mikktspace))
    for (const std::size_t place : scaled) claims_[place] = Claim::none;
  hold_if_turned(max_angle_deg);
}

void Cones::leave_out_mikktspaces(const Mesh& mesh, std::span<const signed char> raw_sign,
                                  const MikktspaceReference& mikktspace, std::span<const double> limit_deg) {
  std::vector<bool> beyond(claims_.size());
  for (std::size_t place = 0; place < claims_.size(); ++place)
    beyond[place] = claims_[place] == Claim::beyond;
  const std::vector<bool> out = are_mikktspaces(mesh, raw_sign, mikktspace, beyond, limit_deg);
  for (std::size_t place = 0; place < claims_.size(); ++place)
    if (out[place]) claims_[place] = Claim::none;
  std::erase_if(outside_, [&](const Outside& o) { return out[o.place]; });
}

void Cones::hold_if_turned(double max_angle_deg) {
  turn_.reset();
  auto within = std::count(claims_.begin(), claims_.end(), Claim::within);
  for (const Outside& o : outside_) within -= claims_[o.place] == Claim::within ? 1 : 0;
  const double known = static_cast<double>(within) + static_cast<double>(outside_.size());
  if (outside_.size() < least_turned || static_cast<double>(outside_.size()) < nearly_all * known) return;
  // All in one sense, or in the opposite one where uvs are mirrored, as with bitangents in place of tangents.
  for (const bool by_sign : {false, true}) {
    const auto middle = [&](const Outside& o) {
      return by_sign && o.place % 2 == 0 ? -double{o.middle} : double{o.middle};
    };
    double x = 0, y = 0;
    for (const Outside& o : outside_)
      x += std::cos(middle(o) / degrees_per_radian), y += std::sin(middle(o) / degrees_per_radian);
    const double turn = degrees_per_radian * std::atan2(y, x);
    if (!(std::fabs(turn) >= foreshortened_deg)) continue;
    const auto is_turned = [&](const Outside& o) {
      return std::fabs(std::remainder(middle(o) - turn, 360)) - o.half <= max_angle_deg;
    };
    const auto turned = std::count_if(outside_.begin(), outside_.end(), is_turned);
    if (static_cast<double>(turned) < nearly_all * known) continue;
    turn_ = Turn{-turn, by_sign};
    for (const Outside& o : outside_)
      if (is_turned(o)) claims_[o.place] = Claim::beyond;
    return;
  }
}

OwnDirections own_directions(const Mesh& mesh, std::span<const signed char> raw_sign,
                             const VertexJoins& joins, const std::vector<bool>& vertices) {
  Closely closely(mesh, raw_sign, joins, vertices, 0);
  const std::size_t n = 2 * vertices.size();
  OwnDirections result{std::vector<bool>(n, false), std::vector<bool>(n, false)};
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    for (const int sign : {-1, 1}) {
      if (!vertices[v]) continue;
      const auto [average, all_round] = closely.direction(v, sign);
      result.average[place_of(v, sign)] = average;
      result.all_round[place_of(v, sign)] = all_round;
    }
  return result;
}

Claim Cones::claim(std::uint32_t v, int sign) const {
  if (sign != 0) return claims_[place_of(v, sign)];
  const Claim a = claims_[place_of(v, -1)], b = claims_[place_of(v, 1)];
  if (a == Claim::within || b == Claim::within) return Claim::within;
  return a == Claim::beyond || b == Claim::beyond ? Claim::beyond : Claim::none;
}

const Cones::Outside* Cones::outside_at(std::uint32_t place) const {
  const auto at = std::lower_bound(outside_.begin(), outside_.end(), place,
                                   [](const Outside& o, std::uint32_t p) { return o.place < p; });
  return at == outside_.end() || at->place != place ? nullptr : &*at;
}

double Cones::outside_deg(std::uint32_t v, int sign) const {
  const auto of = [&](int s) {
    const auto place = static_cast<std::uint32_t>(place_of(v, s));
    if (claims_[place] != Claim::beyond) return 0.0;
    return double{outside_at(place)->deg};
  };
  if (sign != 0) return of(sign);
  if (claim(v, 0) != Claim::beyond) return 0;
  const double a = of(-1), b = of(1);
  return a == 0 ? b : b == 0 ? a : std::fmin(a, b);
}

Cones Cones::restricted_to(std::span<const std::uint32_t> vertices, double max_angle_deg) const {
  Cones result;
  if (empty()) return result;
  result.claims_.reserve(2 * vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i)
    for (const int sign : {-1, 1}) {
      const auto place = static_cast<std::uint32_t>(place_of(vertices[i], sign));
      result.claims_.push_back(claims_[place]);
      const Outside* at = outside_at(place);
      // A part that ends at its charts' seams on one side alone has averages that lie one way.
      if (at == nullptr || claims_[place] == Claim::within) continue;
      result.outside_.push_back(*at);
      result.outside_.back().place = static_cast<std::uint32_t>(place_of(i, sign));
    }
  result.hold_if_turned(max_angle_deg);
  return result;
}

}  // namespace darboux
