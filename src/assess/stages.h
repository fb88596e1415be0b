// From a file to its verdict, one record a stage:
//
//   read_asset()      Primitive          a piece of a file: its mesh, other uv sets, nodes          io.h
//   prepare()         MeshUnderTest      the mesh, with what is computed from it once   mesh_under_test.h
//   Cutter            MeshPart           some of its triangles, as a mesh of their own          this header
//   recognise()       Recognition        the surface of mesh or part, the truth at its vertices   recognise.h
//   validate()        MeshReport         what is stored, against that truth            mesh_under_test.h
//   assess_parts()    Assessment         surface, evidence and report of mesh or part           assess.h
//   assess_file()     AssessedPrimitive  assessments under the options' policy, without data    cli
//   assess_file()     AssessedFile       all of a file; print_text(), report_json() and others write it
//
// Only parts that are looked at become meshes: the whole is never copied to be cut. Of a part the records are
// those of the whole, restricted (restrict_to()), so that nothing is computed twice.
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
  std::string reason{};      // of what does not fit, for SURFACE_UNKNOWN
  bool identifiable = true;  // whether there is enough to identify a surface
  bool declared = false;     // it is the declared surface
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
