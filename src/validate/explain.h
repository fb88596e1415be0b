// What would explain tangents of which most are off.
#pragma once

#include <functional>

#include "subject.h"

namespace darboux {

// The directions of u and v that a reference gives a corner; NaN where it gives none.
struct Directions {
  Vec3<double> t, b;
};

// Compares the stored tangents with the reference's at some thousand corners, spread evenly over the mesh. Where more than a fifth of
// them is off by more than permitted, and no more than a tenth is under one of these, adds TANGENT_UV_SET: MikkTSpace's under
// another uv set; TANGENT_AXES: swapped or negated; TANGENT_STALE: after a linear map.
void explain(const Subject& subject, std::span<const signed char> raw_sign,
             const std::function<Directions(std::size_t corner)>& reference, const ValidateOptions& options,
             MeshReport& report);

}  // namespace darboux
