// Fits through uvs for callers that know the signs of the mesh's triangles, in the sense of triangle_signs().
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <darboux/fit_mesh.h>

namespace darboux {

enum class UvMaps { plain, affine, any };  // flips and swaps; affine maps; plain ones, then affine ones

// The first of fitted_kinds() among `kinds` that fits under one of the maps, plain ones before affine ones;
// else the nearest, with `fits` false; none if no fit could start. About 10 passes over the vertices if one
// fits. \param mesh consistent \throws UndeterminedError where it has no uvs, or too few usable vertices
std::optional<MeshFit> fit_kinds(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement,
                                 std::span<const std::string_view> kinds, UvMaps maps,
                                 std::span<const signed char> signs);

// The result of fit_surface(), and the largest rms_relative that counts as a fit.
struct DeclaredFit {
  MeshFit fit;
  double limit;
};
DeclaredFit fit_declared(const Mesh& mesh, const SurfaceSpecification& given,
                         const std::optional<Eigen::Isometry3d>& placement,
                         std::span<const signed char> signs);
DeclaredFit fit_declared(const Mesh& mesh, const AnySurface& exact,
                         const std::optional<Eigen::Isometry3d>& placement,
                         std::span<const signed char> signs);
// truths() of fit_mesh.h, given these signs.
std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit, std::span<const signed char> signs);

}  // namespace darboux
