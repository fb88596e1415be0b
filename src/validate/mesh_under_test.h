// A mesh with what is computed from it, once, before any surface is known.
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
  std::vector<std::uint32_t> equal{};   // of each vertex the first that is equal to the bit; empty in a part
  // Among triangles whose uv area exceeds what rounding their uvs to single precision makes: vertices shared
  // by some whose uvs wind differently, and vertices that any of them uses.
  std::vector<bool> across_mirror{};
  std::vector<bool> has_uv_area{};
  MikktspaceReference
      mikktspace{};  // empty where it is not asked for, or there are no tangents, normals, uvs or triangles
  std::vector<Truth>
      local{};  // at each vertex; empty where it is not asked for or there are no uvs and no normals
  MeshClasses classes{};
  std::vector<bool> between_parts{};  // vertices that no one frame is right for; empty: none
  NormalChecks normals{};
  Cones cones{};  // empty where they are not asked for or the mesh lacks tangents, normals or uvs

  // The sign of the triangles that the tangent of v may follow at its corners in triangles of `sign`: 0,
  // either, where triangles of both share v. They ask for two tangents, and it is one.
  int followed_sign(std::uint32_t v, int sign) const { return across_mirror[v] ? 0 : sign; }
};

// Its joins; those of a part are made here.
const VertexJoins& joins_of(const MeshUnderTest& under_test, VertexJoins& of_part);

// The signs and areas of its triangles and which of its vertices are the same. \param mesh consistent
// \throws MeshError where a uv set of the options has another number of uvs than the mesh vertices
MeshUnderTest prepare(const Mesh& mesh, const ValidateOptions& options);

// The same of a mesh that differs from another in its uvs alone.
MeshUnderTest prepare_with_uvs_of(const Mesh& mesh, MeshUnderTest other);

// The references that need no surface: MikkTSpace's tangents and local truth.
void add_references(MeshUnderTest& under_test, const ValidateOptions& options);

// The classes, and what needs them. \param is_pole of each vertex, or empty
void classify_vertices(MeshUnderTest& under_test, const std::vector<bool>& is_pole,
                       const ValidateOptions& options);

// The part under test, with what is known of the whole mesh. \param vertices, triangles which of the whole's
// the part's are
MeshUnderTest restrict_to(const MeshUnderTest& whole, const Mesh& part,
                          std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> triangles,
                          double max_angle_deg);

// Of each vertex whether the truth there is a pole's.
std::vector<bool> poles(std::span<const Truth> truth);

// validate() of what is prepared. \param truth at each vertex, or none \param basis of the truth
MeshReport validate(const MeshUnderTest& under_test, std::span<const Truth> truth, Basis basis,
                    const ValidateOptions& options);

}  // namespace darboux
