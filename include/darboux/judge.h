/// \file judge.h
/// The whole verdict on a mesh in one call: recognise or fit its surface, then validate. Target darboux::fit.
#pragma once

#include <optional>

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
};

/// Adds to validate()'s findings: SURFACE_MISMATCH (error) where a declared surface does not fit,
/// SURFACE_UNKNOWN (info) where none of the catalogue does, UV_MISSING (info) without uvs. \throws
/// ParameterError for an unknown surface or parameter, MeshError for an inconsistent mesh
Judgement judge(const Mesh& mesh, const JudgeOptions& options = {});

}  // namespace darboux
