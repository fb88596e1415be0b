// Question 1, sound: is what is stored fit to be used at all, whatever the surface?
//
// What it may claim. Numbers that are not finite, tangents that are zero where the uvs have area, lengths
// beyond what rounding explains, signs other than +1 and -1 or that differ within a uv island, tangents along
// the normal, normals far from every triangle at the vertex and from their averages: no reader can use these,
// so they are errors. Only such normals at borders of unknown surfaces are not: they may be deliberate. From
// what evidence: the stored numbers, their rounding (Mesh::half_steps), and the triangles' own planes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/vertex_joins.h"

namespace darboux {

// Of |t.n|, of both as unit vectors.
inline constexpr double orthogonal_tolerance = 0.02;
inline constexpr double along_normal_tolerance = 0.26;  // 75 degrees

// What is the same for every corner of a vertex; bits, as there are many.
struct VertexChecks {
  bool position_finite : 1 = true, uv_finite : 1 = true, normal_finite : 1 = true, normal_unit : 1 = true;
  bool has_normal : 1 = false;   // finite and not zero
  bool has_tangent : 1 = false;  // likewise
  bool tangent_finite : 1 = true, tangent_zero : 1 = false, tangent_unit : 1 = true, sign_valid : 1 = true;
  bool orthogonal : 1 = true;     // |t.n| <= orthogonal_tolerance
  bool leans : 1 = false;         // beyond what rounding adds to that
  bool along_normal : 1 = false;  // |t.n| > along_normal_tolerance, likewise
};
VertexChecks check_vertex(const Mesh& mesh, std::uint32_t v);

// |t.n| of both as unit vectors; 0 where either is zero.
double cosine_between(const Vec3<double>& t, const Vec3<double>& n);

// At each vertex the mean by area of the normals of all triangles that share its position and normal, of any
// length.
std::vector<Vec3<double>> planes_of_vertices(const Mesh& mesh, const VertexJoins& joins);

constexpr double supported_deg = 80;  // how far a normal may be from all triangles that share it
constexpr double in_front_deg = 100;  // beyond, it is on the triangles' back
constexpr double near_deg = 60;       // away from borders exact normals of coarse meshes are nearer

// The stored normals beside the planes of the triangles.
struct NormalChecks {
  std::vector<bool> unsupported;  // vertices whose normal is more than supported_deg from every triangle that
                                  // shares it, no common average of these, and not on a hull turned inside
                                  // out around the same mesh
  // At the borders of triangles that lie back to back, as of leaves on cards, or as transferred_normals.h has
  // it; or all unsupported ones, if fewer than a tenth of the normals are and none is beyond in_front_deg.
  std::vector<bool> may_be_meant;
  std::vector<bool> departing;  // more than near_deg from every triangle that shares it, no common average,
                                // and not unsupported
  // As far as positions tell for certain: -1: most triangles that share it lie on the other side; 1: they do
  // not, and one is within 80 degrees; 0: neither.
  std::vector<signed char> side;
  std::vector<bool> drawn;  // vertices of a triangle whose area does not vanish; others are not seen
  std::vector<bool>
      faceted;  // triangles whose three normals are their own, beside one that turns and has others
  std::vector<bool> faceted_vertices;  // of which all triangles with area are faceted
  std::vector<bool> opposes;           // triangles whose three normals all oppose the winding
  std::size_t opposing = 0;            // corners of these
  bool all_oppose = false;  // at least 99 % of corners oppose the winding; then none is unsupported
};
// \param has_area triangles with area \param joins of vertices that triangles use; the result is empty where
// the mesh has no normals
NormalChecks check_normals(const Mesh& mesh, const std::vector<bool>& has_area, const VertexJoins& joins);

}  // namespace darboux
