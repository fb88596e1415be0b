// A mesh with the data that are computed from it once, before any surface is known.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <darboux/validate.h>

#include "consistent.h"
#include "mesh/vertex_joins.h"
#include "mikktspace_reference.h"
#include "sound.h"

namespace darboux {

struct MeshUnderTest {
  const Mesh& mesh;
  std::vector<signed char> raw_sign{};  // of each triangle, 0 without uv area
  std::vector<bool> has_area{};         // triangles with area in space
  VertexJoins joins{};                  // of its vertices; empty in a part
  std::vector<std::uint32_t> equal{};   // per vertex, the first that is equal to the bit; empty in a part
  // Only triangles count whose uv area exceeds the effect of rounding uvs to single precision. Vertices
  // shared by such triangles whose uvs wind differently, and vertices of any such triangle.
  std::vector<bool> across_mirror{};
  std::vector<bool> has_uv_area{};
  MikktspaceReference mikktspace{};  // empty if not requested, or without tangents, normals, uvs or triangles
  std::vector<Truth> local{};  // at each vertex; empty if not requested, or without both uvs and normals
  MeshClasses classes{};
  std::vector<bool> between_parts{};  // vertices for which no single frame is right; empty: none
  NormalChecks normals{};
  Cones cones{};  // empty if not requested, or if the mesh lacks tangents, normals or uvs

  // The sign of the triangles that the tangent of v may follow at its corners in triangles of `sign`. 0
  // (either) if triangles of both signs share v: they need two tangents, and v has one.
  int followed_sign(std::uint32_t v, int sign) const { return across_mirror[v] ? 0 : sign; }
};

// The joins of the mesh; those of a part are computed into `of_part`.
const VertexJoins& joins_of(const MeshUnderTest& under_test, VertexJoins& of_part);

// Computes the signs and areas of the triangles and which vertices are the same. \param mesh consistent
// \throws MeshError where a uv set of the options has another number of uvs than the mesh vertices
MeshUnderTest prepare(const Mesh& mesh, const ValidateOptions& options);

// The same for a mesh that differs from another only in its uvs.
MeshUnderTest prepare_with_uvs_of(const Mesh& mesh, MeshUnderTest other);

// The references that need no surface: MikkTSpace's tangents and local truth.
void add_references(MeshUnderTest& under_test, const ValidateOptions& options);

// Computes the classes and everything that needs them. \param is_pole per vertex, or empty
void classify_vertices(MeshUnderTest& under_test, const std::vector<bool>& is_pole,
                       const ValidateOptions& options);

// The part under test, with what is known of the whole mesh. \param vertices, triangles the part's, as
// indices into the whole
MeshUnderTest restrict_to(const MeshUnderTest& whole, const Mesh& part,
                          std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> triangles,
                          double max_angle_deg);

// Whether the truth is that of a pole, per vertex.
std::vector<bool> poles(std::span<const Truth> truth);

// validate() for a prepared mesh. \param truth at each vertex, or none \param basis of the truth
MeshReport validate(const MeshUnderTest& under_test, std::span<const Truth> truth, Basis basis,
                    const ValidateOptions& options);

}  // namespace darboux
