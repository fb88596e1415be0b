/// \file judge.h
/// The whole verdict on a mesh in one call: recognise or fit its surface, then validate. Target darboux::fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <darboux/fit.h>
#include <darboux/validate.h>

namespace darboux {

struct JudgeOptions : ValidateOptions {
  std::optional<SurfaceSpecification> surface;  ///< the kind with its fixed parameters; nothing: recognise it
  std::optional<Eigen::Isometry3d> placement;   ///< where the surface lies; nothing: fit it
};

struct Judgement {
  std::optional<MeshFit> fit;  ///< the nearest surface; nothing where no fit could start
  MeshReport report;           ///< against fit's surface where it fits
  /// Which of the parts it is, counted from 0; nothing: the whole mesh.
  std::optional<std::size_t> part{};
  /// Of a part: which triangles of the mesh the report's corners are those of, in order. Empty for the whole mesh.
  std::vector<std::uint32_t> triangles{};
};

/// Judges the mesh as one surface: fit_surface() or fit_any_surface(), else fit_positions(), else the other references.
/// Adds to validate()'s findings: SURFACE_MISMATCH (error) where a declared surface is farther off than fits_below,
/// SURFACE_UNKNOWN (info) where none of the catalogue is recognised, UV_MISSING (info) without uvs. \throws
/// ParameterError for an unknown surface or parameter, MeshError for an inconsistent mesh
Judgement judge(const Mesh& mesh, const JudgeOptions& options = {});

/// The same, but where the whole mesh is no surface of the catalogue, each of its parts is looked at: triangles joined over edges
/// whose vertices agree in position, normal and uv, those whose uvs wind differently apart; and where such a part is none, those that
/// edges cut off it where faces meet at more than 50 degrees. Those that are recognised, or fit the declared surface, have a judgement
/// each, in the order of the mesh; all the rest shares one, the last. Where none is, or there are more than 256 parts, there is one
/// judgement of the whole. Vertices are numbered as in the mesh.
std::vector<Judgement> judge_parts(const Mesh& mesh, const JudgeOptions& options = {});

}  // namespace darboux
