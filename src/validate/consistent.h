// Question 2, consistent: are the stored tangents those of the mesh's own triangles?
//
// What it may claim. The dpdu of a corner's triangles, each made perpendicular to the stored normal, span a
// cone of directions in the plane of that normal. Every average of them with positive weights lies inside:
// MikkTSpace's, by area, by angle, any other. A tangent farther outside than the limit is no such average.
// That is an error, unless a known surface or, on a coarse mesh, the neighbours (smooth.h) excuse it.
//
// Evidence: the triangles of a corner are all that share its position and, within 0.9 degrees, its normal
// (assimp joins dot products of 0.9999), and whose uv area has the sign of the corner's own. Where two of
// them form a quad that is convex in uv, the triangles of its other diagonal count too: the tool that made
// the tangents may have cut it along either one. Each dpdu carries the interval that half a rounding step of
// positions, uvs and normal allows.
//
// Nothing is claimed of a tangent
// - that is MikkTSpace's, or where MikkTSpace gives none
// - outside the cone, where a triangle without a known direction may have drawn it there
// - outside the cone at a corner of a quad that is convex in space and concave in uv, if its other diagonal
//   lies inside in uv, or is the shorter one in uv, along which MikkTSpace cuts
//
// A tangent is left open where directions span 180 degrees or more, and where it is outside by no more than
// - three times the limit of the interior plus the turn of the normals over the triangles, where these lie on
//   one side of a vertex of a curved surface: at creases, tips, folds of the uvs, and where charts meet that
//   do not continue one another. The true direction may lie half a triangle beyond them
// - the limit plus half of the angle by which the next triangles turn on, less the width of the cone, 45
//   degrees at most, on one side of any vertex, flat or curved: at the end of a bend of few columns the exact
//   tangent is half a column outside
// - the limit plus half of the triangle's angle at a collapsed edge of the uvs, a pole: each column has a
//   vertex of its own there, which lies on one side of it
// - the limit plus about 4/3 of the angle by which the dpdu of a triangle leans from the plane of the normal,
//   45 degrees at most, if at most 3 % of a mesh's tangents are outside and fewer than half of those that
//   lean are MikkTSpace's. A scale may have been baked into the positions, with tangents scaled alike and
//   normals by the inverse transpose: this moves few averages out of the cone that the scaled triangles span
//
// A scale that was baked in, with tangents and normals scaled as they should be, is undone where the tangents
// tell it (baked_scale.h): the claims are those of the mesh before it.
//
// One turn of all overrides this. Suppose one turn about the normals, by 30 degrees or more, would bring nine
// tenths of a mesh's or a part's tangents from outside their cones to within the limit of them. No shape
// explains that, but a turn does, so the tangents left open are beyond the limit, too. For tangents left
// open, and where several charts meet, the cone of this test is that of the triangles with the vertex's own
// uv: tangents may be averages over charts that meet, as at the corners of a smooth cube or at bevels, but
// such averages do not all turn the same way.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "angles.h"
#include "claim.h"
#include "mesh/vertex_joins.h"
#include "mikktspace_reference.h"

namespace darboux {

// The index into vectors with two entries per vertex, one per raw sign of its triangles, clockwise first.
inline std::size_t signed_index(std::uint32_t v, int sign) {
  return 2 * std::size_t{v} + (sign > 0 ? 1 : 0);
}

// A vector along a triangle's dpdu, scaled to ordinary size; zero or NaN where there is none. \param sign its
// raw sign
Vec3<double> direction_of_dpdu(const Mesh& mesh, const Triangle& t, int sign);

// Whether the direction leans by 5 degrees or more from the plane perpendicular to n, so that a scale would
// turn its projection.
inline bool leans(const Vec3<double>& direction, const Vec3<double>& n) {
  constexpr double least = 0.09;  // the tangent of 5 degrees
  return std::fabs(dot(direction, unit(n))) >= least * norm(square_to(direction, n));
}

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
  // The claim on the corners of v in triangles of that sign. For sign 0 (no uv area) it is the better of the
  // other two.
  Claim claim(std::uint32_t v, int sign) const;
  // How far outside the tangent lies, in degrees, where the claim is beyond; 0 elsewhere.
  double outside_deg(std::uint32_t v, int sign) const;
  struct Turn {
    double deg;    // from -180 to 180
    bool by_sign;  // by deg where uvs wind counter-clockwise, by -deg elsewhere
  };
  // By how much nearly all tangents are turned about their normals, if they are.
  const std::optional<Turn>& turn() const { return turn_; }
  // \param vertices those of a part, in its order
  Cones restricted_to(std::span<const std::uint32_t> vertices, double max_angle_deg) const;

 private:
  // A tangent outside a known cone, or outside the cone of its own chart, judged or not. In degrees: how far
  // outside it is, the cone's middle as seen from the tangent, and half of the cone's width.
  struct Outside {
    std::uint32_t place;  // in claims_
    float deg, middle, half;
  };
  // Sets the claims, without looking for one turn of all.
  void assess(const Mesh& mesh, std::span<const signed char> raw_sign, const std::vector<bool>& has_area,
              const VertexJoins& joins, const MikktspaceReference& mikktspace,
              std::span<const double> limit_deg, double max_angle_deg);
  std::ptrdiff_t count(Claim claim) const;
  // Null where there is none.
  const Outside* outside_at(std::uint32_t place) const;
  // Withdraws claims on tangents that are MikkTSpace's.
  void leave_out_mikktspaces(const Mesh& mesh, std::span<const signed char> raw_sign,
                             const MikktspaceReference& mikktspace, std::span<const double> limit_deg);
  // Looks for one turn of all.
  void hold_if_turned(double max_angle_deg);

  std::vector<Claim> claims_;     // of vertex v: clockwise at 2 v, counter-clockwise at 2 v + 1
  std::vector<Outside> outside_;  // by place, ascending
  std::optional<Turn> turn_;
};

// For each requested vertex, an entry per sign of its triangles, indexed as in Cones; false for other
// vertices. average: the tangent is an average of its own triangles' dpdu with positive weights; a coarse
// mesh cannot do better. all_round: these dpdu span 180 degrees or more, as at a cone's tip, so no tangent is
// right for all.
struct OwnDirections {
  std::vector<bool> average, all_round;
};
OwnDirections own_directions(const Mesh& mesh, std::span<const signed char> raw_sign,
                             const VertexJoins& joins, const std::vector<bool>& vertices);

}  // namespace darboux
