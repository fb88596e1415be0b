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

/// What was looked for in vain, kept from mesh to mesh of a file: copies of such parts, wherever they lie,
/// are not searched again, and after a dozen parts the others are looked at briefly, as PARTS_IN_BRIEF says.
/// assess() and assess_parts() add to it: one thread at a time.
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
  /// and of the transformed uvs are both accepted: TANGENT_TEXTURE_TRANSFORM says so.
  std::optional<std::array<double, 6>> texture_transform{};
  /// Whether the mesh's uv set is the one that its tangents belong to. Where it is not, tangents of another
  /// are accepted, and TANGENT_UV_SET_USED names it.
  bool names_uv_set = true;

  SearchHistory* history = nullptr;  ///< shared by the meshes of a file; null: of this mesh alone

  bool declares_surface() const { return surface || exact_surface; }
};

/// Why a surface was recognised, or not: how far the data over-determine it against what else they may be.
struct Evidence {
  double log10_odds =
      0;              ///< of the surface against its rivals; recognised where it is at least evidence_needed
  std::string rival;  ///< the best other explanation: "polyhedron", "faceted", "authored normals", "chance",
                      ///< a kind of surface
  std::string text;   ///< one sentence for people: what speaks for it, what against
};
/// log10 odds from which a surface is claimed: about one wrong claim in 10^4 meshes.
inline constexpr double evidence_needed = 4;

struct Assessment {
  std::optional<MeshFit> fit;          ///< the nearest surface; nothing where no fit could start
  MeshReport report;                   ///< against fit's surface where it fits
  std::optional<int> uv_set{};         ///< the set its tangents follow, where that is not the mesh's own
  std::optional<Evidence> evidence{};  ///< where a surface was looked for, none declared
  /// Which of the parts it is, counted from 0; nothing: the whole mesh.
  std::optional<std::size_t> part{};
  /// Of a part: which triangles of the mesh the report's corners are those of, in order. Empty for the whole
  /// mesh.
  std::vector<std::uint32_t> triangles{};
};

/// Assesses the mesh as one surface: fit_surface() or fit_any_surface(), else fit_positions(), else the other
/// references. Adds to validate()'s findings: SURFACE_MISMATCH (error) where a declared surface is farther
/// off than fits_below, SURFACE_UNKNOWN (info) where none is recognised, UV_MISSING (info)
/// without uvs. \throws ParameterError for an unknown surface or parameter, MeshError for an inconsistent
/// mesh
Assessment assess(const Mesh& mesh, const AssessOptions& options = {});

/// The same, but where the whole mesh is no surface of the catalogue, each of its parts is looked at:
/// triangles joined over edges whose vertices agree in position, normal and uv, those whose uvs wind
/// differently apart; and where such a part is none, those that edges cut off it where faces meet at more
/// than 50 degrees. Those that are recognised, or fit the declared surface, have an assessment each, in the
/// order of the mesh; all the rest shares one, the last. Where none is, there is one assessment of the whole;
/// of more than 256 parts the largest 256 are looked at, the others belong to the rest. Vertices are numbered
/// as in the mesh. All parts share the budget. \throws as assess() does
std::vector<Assessment> assess_parts(const Mesh& mesh, const AssessOptions& options = {});

}  // namespace darboux
