// Question 4, smooth: do normals and tangents follow the mesh's own positions and uvs?
//
// What it may claim. Normals of an unknown surface are their author's choice: smoothed bevels, and normals
// taken from a finer model, are intended. So a vector that is farther from the polynomial through the
// neighbours than three times the limit, and than three standard deviations, is a warning, never an error. A
// tangent within the cone of its own triangles gets none, nor does a normal that is an average of theirs.
// Where no surface is known, this question may also excuse a tangent: triangles of a coarse mesh are chords,
// and an exact tangent may lie outside their cone.
//
// Evidence: local_truth() at each vertex.
#pragma once

#include <span>
#include <vector>

#include "accurate.h"

namespace darboux {

// The claims on each vertex, and its angles to the local truth; empty without one. Vertices fully decided by
// `accurate` get angles only. If all normals oppose their winding, that is a finding of its own, and angles
// are measured on the side of the normals.
struct Smooth {
  std::vector<Angles> angles{};
  std::vector<Claim> normals{}, tangents{};
  std::vector<bool> may_be_exact{};  // within the limit and three deviations, each 15 degrees at most
  bool known() const { return !angles.empty(); }
};
Smooth check_smooth(const MeshUnderTest& under_test, const Accurate& accurate,
                    std::span<const VertexChecks> checks, bool raw, double max_angle_deg);

}  // namespace darboux
