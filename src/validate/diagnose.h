// Diagnoses normals and tangents most of which are off: which single mistake explains all of them.
#pragma once

#include <functional>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

// Of corners: one cause is named that explains so many.
inline constexpr double explains_most = 0.9;

// The directions of u and v that a reference gives a corner; NaN where it gives none.
struct Directions {
  Vec3<double> t, b;
};

// Compares the stored tangents with the reference's at some thousand corners, spread evenly over the mesh.
// Where more than a fifth of them are off by more than the limit (three times that at seams, pole rings,
// creases and borders), and one of these causes leaves no more than a tenth off, adds its finding.
// TANGENT_UV_SET: MikkTSpace's tangents of another uv set. TANGENT_AXES: swapped or negated axes. All turned
// about their normals by one angle, also where the cones alone say so: TANGENT_AXES for quarter turns, else
// TANGENT_UV_SET. TANGENT_STALE: a linear map. \param held whether the mesh's own triangles hold most
// tangents: only another uv set is then looked for. \returns whether it is one of these mistakes
bool diagnose_tangents(const MeshUnderTest& under_test,
                       const std::function<Directions(std::size_t corner)>& reference,
                       const ValidateOptions& options, bool held, MeshReport& report);

// The same for normals that are off the surface: all oppose it while the winding does not, or NORMAL_STALE,
// after a linear map. Where no surface is known, NORMAL_STALE against the planes of facets, else against the
// neighbours.
bool diagnose_normals(const MeshUnderTest& under_test, const Accurate& accurate,
                      const ValidateOptions& options, MeshReport& report);

}  // namespace darboux
