// Diagnoses tangents of which many are wrong: which single mistake explains them all?
#pragma once

#include <cstddef>
#include <functional>

#include "mesh_under_test.h"

namespace darboux {

// The directions of u and v that a reference gives a corner; NaN where it gives none.
struct Directions {
  Vec3<double> t, b;
};

// Compares the stored tangents with the reference's at some thousand corners, spread evenly over the mesh. If
// more than a fifth of them exceed the limit (three times that at seams, pole rings, creases and borders),
// and one of these causes leaves no more than a tenth beyond it, adds its finding. TANGENT_UV_SET:
// MikkTSpace's tangents of another uv set. TANGENT_AXES: swapped or negated axes. All turned about their
// normals by one angle, also where the cones alone say so: TANGENT_AXES for quarter turns, else
// TANGENT_UV_SET. TANGENT_STALE: a linear map. \param held whether most tangents lie in the cones of the
// mesh's own triangles: then only another uv set is tried. \returns whether one of these mistakes was found
bool diagnose_tangents(const MeshUnderTest& under_test,
                       const std::function<Directions(std::size_t corner)>& reference,
                       const ValidateOptions& options, bool held, MeshReport& report);

}  // namespace darboux
