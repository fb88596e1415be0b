// The cones of corners whose tangents lie along none of their triangles' directions: the rules of
// consistent.h on cones, quads, borders and poles.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <darboux/mesh.h>

#include "claim.h"
#include "mesh/vertex_joins.h"

namespace darboux {

// An arc of directions in a plane, radians.
struct Arc {
  double middle, half;
};

class CornerCones {
 public:
  // \param raw_sign of each triangle, 0 without uv area \param vertices those that assess() will be called
  // for
  CornerCones(const Mesh& mesh, std::span<const signed char> raw_sign, const VertexJoins& joins,
              const std::vector<bool>& vertices, double max_angle_deg);

  // The claim, and the known cone that the tangent lies outside of, if any. For a tangent that is left open,
  // or that lies within the joint cone of several charts, this is the cone of its own chart.
  struct Assessed {
    Claim claim;
    std::optional<Arc> left;
    bool by_scale = false;  // beyond, but a scale may have moved an average there
  };
  // Assesses the tangent of v at its corners in triangles of that sign.
  Assessed assess(std::uint32_t v, int sign, double limit_deg);
  // How far outside of a cone the tangent is, less the effect of rounding, in degrees; negative: inside.
  double outside_deg(std::uint32_t v, const Arc& cone) const;

  struct Direction {
    bool average, all_round;
  };
  // The entry of OwnDirections.
  Direction direction(std::uint32_t v, int sign);

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
  // Directions of the triangles of one place and sign, in the plane of one normal.
  struct Directions {
    Vec3<double> x, y;        // the plane's axes
    std::optional<Arc> cone;  // of their directions, angles from x to y; none: no directions
    double widest = 0;        // half of the widest arc of them
    double normals_turn = 0;  // largest angle from the normal to others of its triangles
    double lean_deg = 0;      // most by which another projection may turn a direction
    double pole_turn = 0;     // where an edge of the uvs is collapsed, half of the widest angle of a triangle
    bool closed = false;      // the triangles go all round the vertex, and their charts continue
    bool flat = true;         // the triangles lie in one plane: pieces of one facet
    bool uncertain = false;   // a triangle has no known direction, and may have drawn the tangent anywhere
    Corners at;               // the corners they are of

    // Whether neither directions nor normals turn, as on a flat face with its uvs laid flat.
    bool is_uniform() const;
  };
  // An edge of a triangle from its corner here.
  struct Spoke {
    std::uint32_t place;       // of its other end
    Vec2<double> there, here;  // uvs
    double size;               // of the triangle's uvs
    Vec2<double> along() const { return there - here; }
  };
  using Key = std::tuple<std::uint32_t, int, bool, double, double, double>;

  const Directions* directions_of(std::uint32_t v, int sign, bool of_quads);
  Directions directions(const Corners& at, std::uint32_t own, const Vec3<double>& n, int sign, bool of_quads);
  bool is_left_open(std::uint32_t v, int sign, const Directions& directions, const Arc& cone, double outside,
                    double limit_deg);
  double turn_before(std::uint32_t v, int sign, const Directions& all, const Arc& cone);
  void sort_by_vertex();
  std::optional<Arc> cone_of_chart(std::uint32_t v, int sign, Directions all);
  std::optional<Arc> cone_of(std::uint32_t v, const Directions* directions) const;
  std::uint32_t corner(std::uint32_t t, std::uint32_t k) const { return mesh_.triangles[t][k % 3]; }
  std::uint32_t place(std::uint32_t t, std::uint32_t k) const { return joins_.position[corner(t, k)]; }
  bool goes_all_round();
  void add_spokes(const Corner& c, std::vector<Spoke>& to) const;
  double angle_at(const Corner& c) const;
  bool is_collapsed_edge();
  void add(const Triangle& triangle, int sign);
  bool faces(const Triangle& t) const;
  bool is_open(const Triangle& t) const;
  bool is_on_a_line(const Triangle& t) const;
  void add_other_diagonal(const Corner& c, std::uint32_t k, int sign);

  const Mesh& mesh_;
  std::span<const signed char> raw_sign_;
  const VertexJoins& joins_;
  double max_angle_deg_;
  std::vector<Corner> corners_;
  std::vector<Edge> edges_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_vertex_;  // groups and triangles, on first use
  std::map<Key, Directions> kept_;
  Directions last_;
  // State while Directions are computed: their plane, and what was found so far.
  Vec3<double> x_{}, y_{}, n_{};
  std::vector<Arc> arcs_;
  std::vector<Spoke> rim_;  // the edges at the vertex; each twice where the triangles go all round
  std::vector<Spoke> fan_;  // the same, and those with other normals
  bool uncertain_ = false;
  double lean_ = 0;
};

}  // namespace darboux
