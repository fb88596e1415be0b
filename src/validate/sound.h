// Question 1, sound: can the stored vectors be used at all, whatever the surface?
//
// What it may claim. Numbers that are not finite, tangents that are zero where the uvs have area, lengths off
// by more than rounding explains, signs other than +1 and -1 or that differ within a uv island, tangents
// along the normal, normals far from every triangle at the vertex and from their averages: no reader can use
// these, so they are errors. The exception is such normals at borders of unknown surfaces: they may be
// deliberate.
//
// Evidence: the stored numbers, their rounding (Mesh::half_steps), and the triangles' own planes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/vertex_joins.h"

namespace darboux {

// The limit of |t.n| for unit vectors.
inline constexpr double orthogonal_tolerance = 0.02;
inline constexpr double along_normal_tolerance = 0.26;  // 75 degrees

// Checks that are the same for every corner of a vertex; bits, to save memory.
struct VertexChecks {
  bool position_finite : 1 = true, uv_finite : 1 = true, normal_finite : 1 = true, normal_unit : 1 = true;
  bool has_normal : 1 = false;   // finite and not zero
  bool has_tangent : 1 = false;  // likewise
  bool tangent_finite : 1 = true, tangent_zero : 1 = false, tangent_unit : 1 = true, sign_valid : 1 = true;
  bool orthogonal : 1 = true;     // |t.n| <= orthogonal_tolerance
  bool leans : 1 = false;         // beyond orthogonal_tolerance plus rounding
  bool along_normal : 1 = false;  // |t.n| > along_normal_tolerance plus rounding
};
VertexChecks check_vertex(const Mesh& mesh, std::uint32_t v);

// |t.n| after normalising both; 0 if either is zero.
double cosine_between(const Vec3<double>& t, const Vec3<double>& n);

// Per vertex, the area-weighted mean of the normals of all triangles that share its position and normal; not
// normalised.
std::vector<Vec3<double>> planes_of_vertices(const Mesh& mesh, const VertexJoins& joins);

constexpr double supported_deg = 80;  // how far a normal may be from all triangles that share it
constexpr double in_front_deg = 100;  // beyond, it is on the triangles' back
constexpr double near_deg = 60;       // away from borders exact normals of coarse meshes are nearer

// Compares the stored normals with the planes of the triangles.
struct NormalChecks {
  std::vector<bool> unsupported;  // vertices whose normal is more than supported_deg from every triangle that
                                  // shares it, no usual average of these, and not on a hull turned inside
                                  // out around the same mesh
  // At the borders of triangles that lie back to back, as of leaves on cards, or as transferred_normals.h has
  // it; or all unsupported ones, if at most 24, fewer than a tenth of the normals are beyond near_deg and
  // none is beyond in_front_deg.
  std::vector<bool> may_be_meant;
  std::vector<bool> departing;  // more than near_deg from every triangle that shares it, no usual average,
                                // and not unsupported
  // As far as the positions are certain: -1 if most triangles that share the normal lie on the other side; 1
  // if not, and one is within 80 degrees; else 0.
  std::vector<signed char> side;
  std::vector<bool> drawn;  // vertices of a triangle whose area does not vanish; others are not visible
  std::vector<bool>
      faceted;  // triangles whose normals are their own, beside one in another plane with other normals
  std::vector<bool> faceted_vertices;  // vertices whose triangles with area are all faceted
  std::vector<bool> opposes;           // triangles whose three normals all oppose the winding
  std::size_t opposing = 0;            // number of their corners
  bool all_oppose = false;  // at least 99 % of corners oppose the winding; then none is unsupported
};
// \param has_area triangles with area \param joins of vertices that triangles use \returns an empty result if
// the mesh has no normals
NormalChecks check_normals(const Mesh& mesh, const std::vector<bool>& has_area, const VertexJoins& joins);

}  // namespace darboux
