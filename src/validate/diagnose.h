// Diagnosis of normals and tangents of which most are off: which one mistake makes all of them.
#pragma once

#include <functional>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

// The directions of u and v that a reference gives a corner; NaN where it gives none.
struct Directions {
  Vec3<double> t, b;
};

// Compares the stored tangents with the reference's at some thousand corners, spread evenly over the mesh.
// Where more than a fifth of them is off by more than the limit (three times that at seams, pole rings,
// creases and borders), and no more than a tenth is under one of these, adds TANGENT_UV_SET: MikkTSpace's
// under another uv set; TANGENT_AXES: swapped or negated; either, for quarter turns the latter: turned about
// the normals by one angle, also where the cones alone say so; TANGENT_STALE: after a linear map. \param
// held whether the mesh's own triangles hold most tangents: only another uv set is then looked for. \returns
// whether it is one of these mistakes
bool diagnose_tangents(const MeshUnderTest& under_test,
                       const std::function<Directions(std::size_t corner)>& reference,
                       const ValidateOptions& options, bool held, MeshReport& report);

// The same of normals that are off the surface: they all oppose it, while the winding does not; or
// NORMAL_STALE, after a linear map. Where no surface is known, NORMAL_STALE against the planes of facets.
bool diagnose_normals(const MeshUnderTest& under_test, const Accurate& accurate,
                      const ValidateOptions& options, MeshReport& report);

}  // namespace darboux
