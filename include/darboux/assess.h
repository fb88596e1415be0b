/// \file assess.h
/// Assesses a mesh in one call: recognises or fits its surface, then validates. Target darboux::fit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <darboux/fit_mesh.h>
#include <darboux/validate.h>

namespace darboux {

/// The parts in which no surface was found, shared by all meshes of a file. Copies of such a part, at any
/// placement, are not searched again. After a dozen such parts, the search in further parts is shortened, and
/// PARTS_IN_BRIEF is reported. assess() and assess_parts() add to the history, so use it in one thread at a
/// time.
struct SearchHistory {
  std::vector<std::array<std::size_t, 7>> failed{};  ///< outlines of parts in which no surface was found
};

struct AssessOptions : ValidateOptions {
  std::optional<SurfaceSpecification> surface;  ///< kind and known parameters; empty: recognise the surface
  std::optional<AnySurface>
      exact_surface;  ///< alternatively the surface itself, of any kind, with all parameters known
  std::optional<Eigen::Isometry3d> placement;  ///< surface space to mesh space; empty: fitted
  /// Time limit of the search for surfaces, in seconds; with a limit the report depends on the machine.
  /// Empty: no limit.
  std::optional<double> budget;
  /// KHR_texture_transform of the texture that uses the tangents, as in Primitive. Tangents for the plain uvs
  /// and for the transformed uvs are both accepted; TANGENT_TEXTURE_TRANSFORM reports the latter.
  std::optional<std::array<double, 6>> texture_transform{};
  /// Whether it is known that the tangents belong to the mesh's uv set. If not, tangents of another set are
  /// accepted, and TANGENT_UV_SET_USED names that set.
  bool names_uv_set = true;

  SearchHistory* history = nullptr;  ///< shared by the meshes of a file; null: for this mesh only

  bool declares_surface() const { return surface || exact_surface; }
};

/// Why a surface was recognised or not: how much better it explains the data than its rivals do.
struct Evidence {
  double log10_odds =
      0;              ///< of the surface against its rivals; recognised if this is at least evidence_needed
  std::string rival;  ///< the best other explanation: "polygon", "polyhedron", "faceted",
                      ///< "authored normals", "chance" or a kind of surface
  std::string text;   ///< one sentence: the evidence for and against
};
/// The log10 odds required to recognise a surface: about one wrong recognition in 10^4 meshes.
inline constexpr double evidence_needed = 4;

struct Assessment {
  std::optional<MeshFit> fit;          ///< the nearest surface; empty if no fit could start
  MeshReport report;                   ///< against the surface of `fit`, if it fits
  std::optional<int> uv_set{};         ///< the uv set that its tangents follow, if not the mesh's own
  std::optional<Evidence> evidence{};  ///< if a surface was searched for, none being declared
  /// The index of the part, from 0. Empty for the whole mesh.
  std::optional<std::size_t> part{};
  /// The triangles of the part, as indices into the mesh, in the order of the report's corners. Empty for the
  /// whole mesh.
  std::vector<std::uint32_t> triangles{};
};

/// Assesses the mesh as one surface: the declared one, fitted by uvs or positions; else any that the evidence
/// supports (docs/theory/recognition.md); else against the other references. Adds to validate()'s findings:
/// SURFACE_MISMATCH (error) if a declared surface is farther off than fits_below, SURFACE_UNKNOWN (info) if
/// none is recognised, UV_MISSING (info) without uvs. \throws ParameterError for an unknown surface or
/// parameter, MeshError for an inconsistent mesh
Assessment assess(const Mesh& mesh, const AssessOptions& options = {});

/// The same, but if the whole mesh is not a surface of the catalogue, its parts are assessed separately. A
/// part is a set of triangles connected through edges whose vertices agree in position, normal and uv;
/// triangles whose uvs wind differently are in different parts. A part that is not a surface is cut further,
/// along edges where faces meet at more than 50 degrees. Each part that is recognised, or fits the declared
/// surface, has an assessment of its own, in the order of the mesh. All other parts share one assessment,
/// which comes last. If no part is recognised, there is one assessment of the whole mesh. If there are more
/// than 256 parts, only the largest 256 are searched; the others belong to the rest. Vertices are numbered as
/// in the mesh. All parts share the time budget. \throws as assess()
std::vector<Assessment> assess_parts(const Mesh& mesh, const AssessOptions& options = {});

}  // namespace darboux
