// The stored tangents of a mesh beside MikkTSpace's of its own positions, normals and uvs.
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
  std::size_t beyond = 0;  // corners that are off by more than the limit, poles left out
  double worst_deg = 0;    // of those
};

// \param corners_of how many corners each vertex has \param raw the sign convention of the stored w
MikktspaceComparison compare_with_mikktspace(const MeshUnderTest& under_test,
                                             std::span<const VertexChecks> checks,
                                             std::span<const std::uint32_t> corners_of, bool raw,
                                             const ValidateOptions& options);

// Of the stored tangent to m, MikkTSpace's, which there is: m.w != 0.
Angles angles_to_mikktspace(const Mesh& mesh, std::uint32_t v, const VertexChecks& checks,
                            const Vec4<float>& m, bool raw);

// For each entry that is asked about, by vertex and sign of its triangles as signed_index() numbers them:
// whether the stored tangent is within the limit of MikkTSpace's at a corner there, or MikkTSpace gives none
// at any of these. The weight of a triangle that is edge-on to the normal is made by roundings, or is none,
// though the triangle seems to tell a direction. \param mikktspace may be empty: all are false then
std::vector<bool> are_mikktspaces(const Mesh& mesh, std::span<const signed char> raw_sign,
                                  const MikktspaceReference& mikktspace, const std::vector<bool>& asked,
                                  std::span<const double> limit_deg);

// Whether the positions may have been scaled since the tangents were made. Not if half of the tangents that a
// scale would have moved, where a dpdu leans by 5 degrees or more from the plane of the normal, are
// MikkTSpace's of the mesh as it is. \param mikktspace may be empty
bool may_be_scaled(const Mesh& mesh, std::span<const signed char> raw_sign,
                   const MikktspaceReference& mikktspace);

}  // namespace darboux
