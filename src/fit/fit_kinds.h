// Fits through uvs for callers that know the signs of the mesh's triangles, in the sense of triangle_signs().
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <darboux/fit_mesh.h>

namespace darboux {

enum class UvMaps { plain, affine, any };  // flips and swaps; affine maps; the first, then the others

// The first of fitted_kinds() among `kinds` that fits under one of the maps, plain ones before affine ones;
// else the nearest, `fits` false; nothing where none could start. About 10 passes over the vertices where one
// fits. \param mesh consistent \throws UndeterminedError where it has no uvs, or too few usable vertices
std::optional<MeshFit> fit_kinds(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement,
                                 std::span<const std::string_view> kinds, UvMaps maps,
                                 std::span<const signed char> signs);

// fit_surface(), and the rms_relative up to which it fits.
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
// truths() of fit_mesh.h, for these signs.
std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit, std::span<const signed char> signs);

}  // namespace darboux
