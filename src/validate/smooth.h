// Question 4, smooth: do normals and tangents follow the mesh's own positions and uvs?
//
// What it may claim. Normals of an unknown surface are their author's: smoothed bevels and normals taken from
// a finer model are meant so. So what is farther from the polynomial through the neighbours than three times
// the limit, and than three standard deviations, is worth a look, a warning, never an error; nothing is said
// against a tangent within the cone of its own triangles, nor against a normal that is an average of theirs.
// Where no surface is known it may also excuse a tangent: triangles of a coarse mesh are chords, and an exact
// tangent may lie outside their cone. From what evidence: local_truth() at each vertex.
#pragma once

#include <span>
#include <vector>

#include "accurate.h"

namespace darboux {

// What it claims of each vertex, and its angles to the local truth; empty without that. Vertices that
// `accurate` knows all of have angles alone. Where all normals oppose their winding, that is a finding of its
// own, and the others' side is taken.
struct Smooth {
  std::vector<Angles> angles{};
  std::vector<Claim> normals{}, tangents{};
  std::vector<bool> may_be_exact{};  // a tangent within the limit and three deviations, of 15 degrees at most
  bool known() const { return !angles.empty(); }
};
Smooth check_smooth(const MeshUnderTest& under_test, const Accurate& accurate,
                    std::span<const VertexChecks> checks, bool raw, double max_angle_deg);

}  // namespace darboux
