/// \file assess.h
/// The whole verdict on a mesh in one call: recognise or fit its surface, then validate. Target darboux::fit.
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

/// The parts in which no surface was found, kept for all meshes of a file. A copy of such a part, wherever it
/// lies, is not searched again. After a dozen parts the search in the others is brief; PARTS_IN_BRIEF reports
/// this. assess() and assess_parts() add to the history: use it in one thread at a time.
struct SearchHistory {
  std::vector<std::array<std::size_t, 7>> failed{};  ///< outlines of parts in which no surface was found
};

struct AssessOptions : ValidateOptions {
  std::optional<SurfaceSpecification> surface;  ///< kind and known parameters; none: recognise it
  std::optional<AnySurface>
      exact_surface;  ///< or the surface itself, of any kind, whose parameters are all known
  std::optional<Eigen::Isometry3d> placement;  ///< surface space to mesh space; none: fit it
  /// Seconds after which no further surface is looked for; the report then depends on the machine. Nothing:
  /// no limit.
  std::optional<double> budget;
  /// KHR_texture_transform of the texture that reads the tangents, as Primitive has it. Tangents of the plain
  /// uvs and of the transformed uvs are both accepted. TANGENT_TEXTURE_TRANSFORM reports the latter.
  std::optional<std::array<double, 6>> texture_transform{};
  /// Whether it is known that the tangents belong to the mesh's uv set. If not, tangents of another set are
  /// accepted, and TANGENT_UV_SET_USED names that set.
  bool names_uv_set = true;

  SearchHistory* history = nullptr;  ///< shared by the meshes of a file; null: of this mesh alone

  bool declares_surface() const { return surface || exact_surface; }
};

/// Why a surface was recognised, or not: how much better it explains the data than its rivals do.
struct Evidence {
  double log10_odds =
      0;              ///< of the surface against its rivals; recognised where it is at least evidence_needed
  std::string rival;  ///< the best other explanation: "polygon", "polyhedron", "faceted",
                      ///< "authored normals", "chance" or a kind of surface
  std::string text;   ///< one sentence for people: what speaks for it, what against
};
/// log10 odds from which a surface is claimed: about one wrong claim in 10^4 meshes.
inline constexpr double evidence_needed = 4;

struct Assessment {
  std::optional<MeshFit> fit;          ///< the nearest surface; nothing where no fit could start
  MeshReport report;                   ///< against fit's surface where it fits
  std::optional<int> uv_set{};         ///< the set its tangents follow, where that is not the mesh's own
  std::optional<Evidence> evidence{};  ///< where a surface was looked for, none declared
  /// The part's number, from 0. Empty for the whole mesh.
  std::optional<std::size_t> part{};
  /// The part's triangles in the mesh, in the order of the report's corners. Empty for the whole mesh.
  std::vector<std::uint32_t> triangles{};
};

/// Assesses the mesh as one surface: the declared one through uvs or positions, else any that the evidence
/// supports (docs/theory/recognition.md), else the other references. Adds to validate()'s findings:
/// SURFACE_MISMATCH (error) where a declared surface is farther off than fits_below, SURFACE_UNKNOWN (info)
/// where none is recognised, UV_MISSING (info) without uvs. \throws ParameterError for an unknown surface or
/// parameter, MeshError for an inconsistent mesh
Assessment assess(const Mesh& mesh, const AssessOptions& options = {});

/// The same, but if the whole mesh is no surface of the catalogue, each of its parts is assessed. A part is a
/// set of triangles joined over edges whose vertices agree in position, normal and uv; triangles whose uvs
/// wind differently are in different parts. A part that is no surface is cut further, along edges where faces
/// meet at more than 50 degrees. Each part that is recognised, or fits the declared surface, has an
/// assessment of its own, in the order of the mesh. All other parts share one assessment, the last. If no
/// part is recognised, there is one assessment of the whole mesh. Of more than 256 parts only the largest 256
/// are searched; the others count among the rest. Vertices are numbered as in the mesh. All parts share the
/// budget. \throws as assess() does
std::vector<Assessment> assess_parts(const Mesh& mesh, const AssessOptions& options = {});

}  // namespace darboux
