// Question 2, consistent: are the stored tangents those of the mesh's own triangles?
//
// What it may claim. The dpdu of a corner's triangles, each made square to the stored normal, span a cone of
// directions in the plane of that normal. Every average of them with positive weights lies inside:
// MikkTSpace's, area's, angle's, anybody's. A tangent farther outside than the limit is no such average, and
// that is an error, unless a known surface or, of a coarse mesh, the neighbours (smooth.h) allow it.
//
// From what evidence. The triangles are all that share the corner's position and, within 0.9 degrees, its
// normal (assimp joins dot products of 0.9999), and whose uv area has the sign of the corner's own. Where two
// of them form a quad that is convex in uv, those of its other diagonal count too: nobody knows along which
// one the tool that made the tangents cut it. Of the corners of a quad that is convex in space and concave
// in uv nothing is claimed where that other diagonal would be the one inside, or is the shorter one in uv,
// along which MikkTSpace cuts. Each dpdu carries the interval that half a rounding step of positions, uvs
// and normal allows. Where directions span 180 degrees or more, or a triangle that tells no direction may
// have drawn the tangent outside, nothing is claimed. Nor is it where the triangles lie on one side of a
// curved vertex only, as at creases, tips, folds of the uvs and where charts meet that do not go on, and the
// tangent is outside by no more than three times the limit and the turn of the normals over them: the true
// direction may lie half a triangle beyond them. Nor, on one side of any vertex, flat or curved, where it is
// outside by no more than the limit and half of what the next triangles turn on, 45 degrees at most: at the
// end of a bend of few columns the exact tangent is half a column outside. Nor at a collapsed edge of the
// uvs, a pole, of a tangent that is outside by no more than the limit and half of the triangle's angle there:
// each column has a vertex of its own, which lies on one side of it. Nor of a tangent that is
// MikkTSpace's, or where MikkTSpace gives none. Nor where it is outside by no more than the limit and 4/3 of
// what the dpdu of a triangle leans from the plane of the normal, 45 degrees at most, if at most 3 % of a
// mesh's tangents are outside and fewer than half of those that lean are MikkTSpace's: where a scale was
// baked into the positions, tangents moved with them and normals by the inverse transpose, which takes few
// averages out of the cone that the scaled triangles span. But where one turn about the normals, by 30
// degrees or more, would bring nine tenths of a mesh's or a part's tangents from outside their cones to
// within the limit of them, that explains what is left open, and no shape does: those are beyond, too. Of
// what is left open, and where several charts meet, the cone is then that of the triangles that have the
// vertex's uv: charts that meet, as at the corners of a smooth cube or at bevels, may be averaged, but not
// all in one sense.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "claim.h"
#include "mesh/vertex_joins.h"
#include "mikktspace_reference.h"

namespace darboux {

// Where vectors with two entries per vertex have that of its triangles of one raw sign: clockwise first.
inline std::size_t place_of(std::uint32_t v, int sign) {
  return 2 * std::size_t{v} + (sign > 0 ? 1 : 0);
}

// A multiple of a triangle's dpdu in its direction, of ordinary size; zero or NaN where there is none.
// \param sign its raw sign
Vec3<double> direction_of_dpdu(const Mesh& mesh, const Triangle& t, int sign);

class Cones {
 public:
  Cones() = default;
  // \param raw_sign of each triangle, 0 without uv area \param has_area triangles with area in space
  // \param mikktspace may be empty
  // \param limit_deg of each vertex: how far outside a tangent may lie
  Cones(const Mesh& mesh, std::span<const signed char> raw_sign, const std::vector<bool>& has_area,
        const VertexJoins& joins, const MikktspaceReference& mikktspace, std::span<const double> limit_deg,
        double max_angle_deg);

  bool empty() const { return claims_.empty(); }
  // Of the corners of v whose triangles have that sign; those without uv area take the better of the two
  // others.
  Claim claim(std::uint32_t v, int sign) const;
  // How far outside those beyond are, in degrees; 0 elsewhere.
  double outside_deg(std::uint32_t v, int sign) const;
  struct Turn {
    double deg;    // from -180 to 180
    bool by_sign;  // of uvs that wind counter-clockwise, and the other way of the others
  };
  // By how much nearly all tangents are turned about their normals, if they are.
  const std::optional<Turn>& turn() const { return turn_; }
  // \param vertices those of a part, in its order
  Cones restricted_to(std::span<const std::uint32_t> vertices, double max_angle_deg) const;

 private:
  // Of a tangent outside a cone that is known, or outside its own chart's, judged or not, in degrees: by how
  // much, and the cone's middle, as seen from the tangent, and half of its width.
  struct Outside {
    std::uint32_t place;  // in claims_
    float deg, middle, half;
  };
  // Claims nothing of those that are MikkTSpace's.
  void leave_out_mikktspaces(const Mesh& mesh, std::span<const signed char> raw_sign,
                             const MikktspaceReference& mikktspace, std::span<const double> limit_deg);
  // Looks for one turn of all.
  void hold_if_turned(double max_angle_deg);

  std::vector<Claim> claims_;     // of vertex v: clockwise at 2 v, counter-clockwise behind it
  std::vector<Outside> outside_;  // by place, ascending
  std::optional<Turn> turn_;
};

// Of vertices that are asked about and the sign of their triangles, clockwise at 2 v, counter-clockwise
// behind it, as Cones has them; false of others. average: the tangent is an average of its own triangles'
// dpdu with positive weights, which a coarse mesh cannot do better. all_round: these span 180 degrees or
// more, as at a cone's tip, so that no tangent is right for all.
struct OwnDirections {
  std::vector<bool> average, all_round;
};
OwnDirections own_directions(const Mesh& mesh, std::span<const signed char> raw_sign,
                             const VertexJoins& joins, const std::vector<bool>& vertices);

}  // namespace darboux
