// From a file to its verdict, one record per stage:
//
//   read_asset()       Primitive          a piece of a file: its mesh, other uv sets, nodes io.h
//   prepare()          MeshUnderTest      the mesh, with what is computed from it once  mesh_under_test.h
//   Cutter             MeshPart           some of its triangles, as a mesh of their own parts.h
//   recognise()        Recognition        the surface of mesh or part, and its truth    recognise.h
//   validate()         MeshReport         what is stored, against that truth            mesh_under_test.h
//   assess_parts()     Assessment         surface, evidence and report of mesh or part  assess.h
//   assess_file()      AssessedPrimitive  its assessments, under the policy of the options validate_files.h
//   print_text(), ...  AssessedFile       all of a file, as it is written               validate_files.h
//
// Only examined parts become meshes: the whole is not copied to be cut. A part's MeshUnderTest is the
// whole's, restricted by restrict_to(), so nothing is computed twice.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <darboux/assess.h>

namespace darboux {

// The surface that a mesh or part was taken for, and the truth at its vertices where it fits.
struct Recognition {
  std::optional<MeshFit> fit{};
  std::vector<Truth> truth{};
  std::string reason{};      // why nothing fits, for SURFACE_UNKNOWN
  bool identifiable = true;  // whether the data suffice to identify a surface
  bool declared = false;     // this is the declared surface
  std::optional<Evidence> evidence{};
  bool fits() const { return fit && fit->fits; }
};

// Triangles of a mesh with the vertices that they use.
struct MeshPart {
  Mesh mesh{};
  std::vector<std::uint32_t> vertices{}, triangles{};  // of the whole mesh
  std::vector<signed char> raw_sign{};                 // of its triangles
  Recognition recognition{};
};

}  // namespace darboux
