// Compares the stored tangents of a mesh with MikkTSpace's of its own positions, normals and uvs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <darboux/validate.h>

#include "angles.h"
#include "mesh_under_test.h"

namespace darboux {

struct MikktspaceComparison {
  MikkReport report;
  std::size_t beyond = 0;  // corners beyond the limit, except poles
  double worst_deg = 0;    // of those
};

// \param corners_of how many corners each vertex has \param raw the sign convention of the stored w
MikktspaceComparison compare_with_mikktspace(const MeshUnderTest& under_test,
                                             std::span<const VertexChecks> checks,
                                             std::span<const std::uint32_t> corners_of, bool raw,
                                             const ValidateOptions& options);

// Angles from the stored tangent to m, MikkTSpace's, which must exist: m.w != 0.
Angles angles_to_mikktspace(const Mesh& mesh, std::uint32_t v, const VertexChecks& checks,
                            const Vec4<float>& m, bool raw);

// For each requested entry (vertex and sign of its triangles, numbered by signed_index()): whether the stored
// tangent is within the limit of MikkTSpace's at one of these corners, or MikkTSpace gives none at any of
// them. This matters for a triangle that is edge-on to the normal: it seems to have a direction, but its
// weight is mere rounding, or zero. \param mikktspace may be empty: all are false then
std::vector<bool> are_mikktspaces(const Mesh& mesh, std::span<const signed char> raw_sign,
                                  const MikktspaceReference& mikktspace, const std::vector<bool>& asked,
                                  std::span<const double> limit_deg);

// The share of MikkTSpace's, up to rounding, among the tangents where a dpdu leans by 5 degrees or more from
// the plane of the normal. Those a scale of the positions would have moved since they were made. 1 where none
// leans. \param mikktspace may be empty: 0
double share_unmoved(const Mesh& mesh, std::span<const signed char> raw_sign,
                     const MikktspaceReference& mikktspace);

}  // namespace darboux
